//! State machines of the system under test: what they consist of, and how they move.

use std::fmt;

/// Something that a program told of one of its state machines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MachineStep {
    Declared(MachineDeclaration),
    /// It is begun, in this state.
    Begun {
        machine: String,
        state: String,
    },
    /// It has gone from a state to another, or has ended with an outcome of its own.
    Moved {
        machine: String,
        edge: MachineEdge,
    },
}

/// What a state machine consists of.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MachineDeclaration {
    /// One within another by the labels that lead to it: `SM_ROOT/GRASP`.
    pub machine: String,
    /// The labels of its states.
    pub states: Vec<String>,
    pub transitions: Vec<MachineEdge>,
    /// Its own.
    pub outcomes: Vec<String>,
}

/// A transition: which outcome of a state leads where.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct MachineEdge {
    pub from: String,
    pub outcome: String,
    /// A state, or an outcome of the machine.
    pub to: String,
}

impl fmt::Display for MachineEdge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} -{}-> {}", self.from, self.outcome, self.to)
    }
}

impl fmt::Display for MachineStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MachineStep::Declared(MachineDeclaration { machine, states, transitions, .. }) => {
                write!(f, "{machine} has {} states and {} transitions", states.len(), transitions.len())
            }
            MachineStep::Begun { machine, state } => write!(f, "{machine} begins in {state}"),
            MachineStep::Moved { machine, edge } => write!(f, "{machine}: {edge}"),
        }
    }
}
