//! What of agents' programs, and of crosses, a suite by agents can reach.

use crate::{
    bdi::{AgentId, TriggerOn},
    suite::CoverItemKind,
};

/// Something of an agent's program that a run reaches or does not. Plans are named by their place in the library, steps
/// by their site: the step in the order of [`each_step`](crate::bdi::each_step).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AgentCoverItem {
    /// The plan was selected.
    Selected(u16),
    /// It was finished.
    Completed(u16),
    Failed(u16),
    /// The plan's context was tried, and was so.
    Context {
        plan: u16,
        holds: bool,
    },
    /// An event came with so many applicable plans.
    Applicable {
        on: TriggerOn,
        plans: ApplicableCount,
    },
    /// The message of a step was sent.
    Message {
        plan: u16,
        site: u16,
    },
    /// A plan was selected for the goal of a step.
    Edge {
        plan: u16,
        site: u16,
        by: u16,
    },
    /// These plans lay on each other in an intention, the lowest first.
    Path([u16; 3]),
}

/// How many plans are applicable to an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ApplicableCount {
    None,
    One,
    Many,
}

impl AgentCoverItem {
    #[must_use]
    pub fn kind(self) -> CoverItemKind {
        match self {
            AgentCoverItem::Selected(_) => CoverItemKind::Selected,
            AgentCoverItem::Completed(_) => CoverItemKind::Completed,
            AgentCoverItem::Failed(_) => CoverItemKind::Failed,
            AgentCoverItem::Context { holds: true, .. } => CoverItemKind::ContextTrue,
            AgentCoverItem::Context { holds: false, .. } => CoverItemKind::ContextFalse,
            AgentCoverItem::Applicable { .. } => CoverItemKind::Applicable,
            AgentCoverItem::Message { .. } => CoverItemKind::Message,
            AgentCoverItem::Edge { .. } => CoverItemKind::Edge,
            AgentCoverItem::Path(_) => CoverItemKind::Path,
        }
    }
}

/// A goal of a suite by agents.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AgentGoal {
    Item(AgentId, AgentCoverItem),
    /// A bin of a cross, by their places.
    Bin(u16, u16),
}
