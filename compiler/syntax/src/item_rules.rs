//! What is true of a kind of declarations, whatever one of them says.

use crate::ast::ItemSyntaxKind;

/// What holds for a kind of declarations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ItemRules {
    /// What it is called, if a scenario alone can have it, and no module.
    pub only_in_scenario: Option<&'static str>,
    /// Other declarations see no more of it than its name and its parameters.
    pub is_seen_by_name: bool,
}

impl ItemSyntaxKind {
    #[must_use]
    pub fn rules(&self) -> ItemRules {
        let whole = ItemRules::default();
        let named = ItemRules { is_seen_by_name: true, ..whole };
        match self {
            ItemSyntaxKind::World(_) => ItemRules { only_in_scenario: Some("a `world`"), ..whole },
            ItemSyntaxKind::Suite(_) => ItemRules { only_in_scenario: Some("a `suite`"), ..named },
            ItemSyntaxKind::Test(_) => ItemRules { only_in_scenario: Some("a `test`"), ..named },
            ItemSyntaxKind::Agent(_)
            | ItemSyntaxKind::Automaton(_)
            | ItemSyntaxKind::Stimulus(_)
            | ItemSyntaxKind::Require(_)
            | ItemSyntaxKind::Assume(_)
            | ItemSyntaxKind::Query(_)
            | ItemSyntaxKind::System(_) => named,
            ItemSyntaxKind::Use(_)
            | ItemSyntaxKind::Allow(_)
            | ItemSyntaxKind::Enum { .. }
            | ItemSyntaxKind::Record { .. }
            | ItemSyntaxKind::Actor { .. }
            | ItemSyntaxKind::Const { .. }
            | ItemSyntaxKind::Event(_)
            | ItemSyntaxKind::Var(_)
            | ItemSyntaxKind::Channel(_)
            | ItemSyntaxKind::Function(_)
            | ItemSyntaxKind::Network { .. }
            | ItemSyntaxKind::Cover(_)
            | ItemSyntaxKind::Cross(_)
            | ItemSyntaxKind::Part(_)
            | ItemSyntaxKind::Device(_)
            | ItemSyntaxKind::Instance(_)
            | ItemSyntaxKind::Error => whole,
        }
    }
}
