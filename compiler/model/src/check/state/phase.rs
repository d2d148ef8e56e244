//! Phases: in which one a declaration is checked, and what it can speak of.

use hrdsl_syntax::ast::{ItemSyntaxKind, TemplateSyntaxKind};

/// The phases in their order: each uses the names of those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum CheckPhase {
    Vocabulary,
    World,
    Stimuli,
    Agents,
    Automata,
    Queries,
    Requirements,
    Coverage,
    Suites,
    Systems,
    Tests,
}

impl CheckPhase {
    /// In which phase the body of a declaration is checked.
    pub fn of(kind: &ItemSyntaxKind) -> Self {
        match kind {
            ItemSyntaxKind::Use(_)
            | ItemSyntaxKind::Allow(_)
            | ItemSyntaxKind::Enum { .. }
            | ItemSyntaxKind::Record { .. }
            | ItemSyntaxKind::Actor { .. }
            | ItemSyntaxKind::Const { .. }
            | ItemSyntaxKind::Event(_)
            | ItemSyntaxKind::Var(_)
            | ItemSyntaxKind::Channel(_)
            | ItemSyntaxKind::Error => CheckPhase::Vocabulary,
            ItemSyntaxKind::Part(_) | ItemSyntaxKind::Device(_) | ItemSyntaxKind::World(_) => {
                CheckPhase::World
            }
            ItemSyntaxKind::Stimulus(_) => CheckPhase::Stimuli,
            ItemSyntaxKind::Agent(_) => CheckPhase::Agents,
            ItemSyntaxKind::Automaton(_) | ItemSyntaxKind::Function(_) | ItemSyntaxKind::Network { .. } => {
                CheckPhase::Automata
            }
            ItemSyntaxKind::Query(_) => CheckPhase::Queries,
            ItemSyntaxKind::Require(_) | ItemSyntaxKind::Assume(_) => CheckPhase::Requirements,
            ItemSyntaxKind::Cover(_) | ItemSyntaxKind::Cross(_) => CheckPhase::Coverage,
            ItemSyntaxKind::Suite(_) => CheckPhase::Suites,
            ItemSyntaxKind::System(_) => CheckPhase::Systems,
            ItemSyntaxKind::Test(_) => CheckPhase::Tests,
            ItemSyntaxKind::Instance(instance) => match instance.sort {
                TemplateSyntaxKind::Agent => CheckPhase::Agents,
                TemplateSyntaxKind::Automaton => CheckPhase::Automata,
                TemplateSyntaxKind::Require => CheckPhase::Requirements,
                TemplateSyntaxKind::Cover | TemplateSyntaxKind::Cross => CheckPhase::Coverage,
            },
        }
    }

    /// Whether something of this phase can speak of what is checked in the other, beyond its name.
    pub fn speaks_of(self, other: CheckPhase) -> bool {
        match other {
            CheckPhase::Vocabulary | CheckPhase::World => true,
            CheckPhase::Automata | CheckPhase::Queries | CheckPhase::Requirements => {
                self == CheckPhase::Suites
            }
            CheckPhase::Coverage => {
                matches!(self, CheckPhase::Coverage | CheckPhase::Suites | CheckPhase::Tests)
            }
            CheckPhase::Stimuli => matches!(self, CheckPhase::Automata | CheckPhase::Tests),
            CheckPhase::Agents | CheckPhase::Suites | CheckPhase::Systems | CheckPhase::Tests => false,
        }
    }
}
