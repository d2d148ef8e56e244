//! Phases: in which one a declaration is checked, and what it can speak of.

use hrdsl_syntax::ast::{ItemKind, Sort};

/// The phases in their order: each uses the names of those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Phase {
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

impl Phase {
    /// In which phase the body of a declaration is checked.
    pub fn of(kind: &ItemKind) -> Self {
        match kind {
            ItemKind::Use(_)
            | ItemKind::Allow(_)
            | ItemKind::Enum { .. }
            | ItemKind::Record { .. }
            | ItemKind::Actor { .. }
            | ItemKind::Const { .. }
            | ItemKind::Event(_)
            | ItemKind::Var(_)
            | ItemKind::Channel(_)
            | ItemKind::Error => Phase::Vocabulary,
            ItemKind::Part(_) | ItemKind::Device(_) | ItemKind::World(_) => Phase::World,
            ItemKind::Stimulus(_) => Phase::Stimuli,
            ItemKind::Agent(_) => Phase::Agents,
            ItemKind::Automaton(_) | ItemKind::Function(_) | ItemKind::Network { .. } => Phase::Automata,
            ItemKind::Query(_) => Phase::Queries,
            ItemKind::Require(_) | ItemKind::Assume(_) => Phase::Requirements,
            ItemKind::Cover(_) | ItemKind::Cross(_) => Phase::Coverage,
            ItemKind::Suite(_) => Phase::Suites,
            ItemKind::System(_) => Phase::Systems,
            ItemKind::Test(_) => Phase::Tests,
            ItemKind::Instance(instance) => match instance.sort {
                Sort::Agent => Phase::Agents,
                Sort::Automaton => Phase::Automata,
                Sort::Require => Phase::Requirements,
                Sort::Cover | Sort::Cross => Phase::Coverage,
            },
        }
    }

    /// Whether something of this phase can speak of what is checked in the other, beyond its name.
    pub fn speaks_of(self, other: Phase) -> bool {
        match other {
            Phase::Vocabulary | Phase::World => true,
            Phase::Queries | Phase::Requirements => self == Phase::Suites,
            Phase::Coverage => matches!(self, Phase::Coverage | Phase::Suites | Phase::Tests),
            Phase::Stimuli => matches!(self, Phase::Automata | Phase::Tests),
            Phase::Agents | Phase::Automata | Phase::Suites | Phase::Systems | Phase::Tests => false,
        }
    }
}
