//! Phases: in which one a declaration is checked, and what it can speak of.

use hrdsl_syntax::ast::{ItemKind, Sort};

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
            | ItemKind::Error => CheckPhase::Vocabulary,
            ItemKind::Part(_) | ItemKind::Device(_) | ItemKind::World(_) => CheckPhase::World,
            ItemKind::Stimulus(_) => CheckPhase::Stimuli,
            ItemKind::Agent(_) => CheckPhase::Agents,
            ItemKind::Automaton(_) | ItemKind::Function(_) | ItemKind::Network { .. } => CheckPhase::Automata,
            ItemKind::Query(_) => CheckPhase::Queries,
            ItemKind::Require(_) | ItemKind::Assume(_) => CheckPhase::Requirements,
            ItemKind::Cover(_) | ItemKind::Cross(_) => CheckPhase::Coverage,
            ItemKind::Suite(_) => CheckPhase::Suites,
            ItemKind::System(_) => CheckPhase::Systems,
            ItemKind::Test(_) => CheckPhase::Tests,
            ItemKind::Instance(instance) => match instance.sort {
                Sort::Agent => CheckPhase::Agents,
                Sort::Automaton => CheckPhase::Automata,
                Sort::Require => CheckPhase::Requirements,
                Sort::Cover | Sort::Cross => CheckPhase::Coverage,
            },
        }
    }

    /// Whether something of this phase can speak of what is checked in the other, beyond its name.
    pub fn speaks_of(self, other: CheckPhase) -> bool {
        match other {
            CheckPhase::Vocabulary | CheckPhase::World => true,
            CheckPhase::Queries | CheckPhase::Requirements => self == CheckPhase::Suites,
            CheckPhase::Coverage => {
                matches!(self, CheckPhase::Coverage | CheckPhase::Suites | CheckPhase::Tests)
            }
            CheckPhase::Stimuli => matches!(self, CheckPhase::Automata | CheckPhase::Tests),
            CheckPhase::Agents
            | CheckPhase::Automata
            | CheckPhase::Suites
            | CheckPhase::Systems
            | CheckPhase::Tests => false,
        }
    }
}
