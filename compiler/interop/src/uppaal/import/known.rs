//! What is known of the edge that is being written: which case of it, and what it does with clocks.

use indexmap::IndexSet;

use super::scope::ScenarioExprText;

/// The case that is being written.
#[derive(Clone, Debug, Default)]
pub struct EdgeCases {
    /// Of each decision in turn, which of how many.
    taken: Vec<(usize, usize)>,
    next: usize,
    /// What has been decided, by its text.
    pub known: Vec<(String, i64)>,
    /// What the guard asks for.
    pub conditions: Vec<ScenarioExprText>,
    pub in_updates: bool,
    /// Another edge may have changed shared variables just before.
    pub receives: bool,
    /// Variables that the updates so far have assigned, as the scenario calls them.
    pub assigned: IndexSet<String>,
}

impl EdgeCases {
    pub fn first(receives: bool) -> Self {
        Self { receives, ..Self::default() }
    }

    pub fn choose(&mut self, of: usize) -> usize {
        let at = self.next;
        self.next += 1;
        match self.taken.get(at) {
            Some((chosen, _)) => *chosen,
            None => {
                self.taken.push((0, of));
                0
            }
        }
    }

    /// The next case; none if this was the last.
    pub fn following(mut self) -> Option<Self> {
        while let Some((chosen, of)) = self.taken.pop() {
            if chosen + 1 < of {
                self.taken.push((chosen + 1, of));
                return Some(Self { taken: self.taken, receives: self.receives, ..Self::default() });
            }
        }
        None
    }
}

/// What happens to a clock, in the order in which an edge does it.
#[derive(Clone, Debug)]
pub struct ClockEvent {
    pub clock: String,
    /// It is set, to a number if that is constant; or else it is read.
    pub set: Option<Option<i64>>,
}
