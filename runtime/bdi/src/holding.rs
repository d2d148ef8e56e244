//! Sorts of what one agent holds, and how much of each it may.

use std::fmt;

/// A sort of what an agent holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HoldingKind {
    /// Branches too.
    Intentions,
    Events,
    /// Each counts once for each of its annotations.
    Facts,
    /// That it has yet to take in, or to give out.
    Messages,
    /// On the stacks of all intentions.
    Plans,
    /// Arguments and variables on the stacks, and answers that a `for` has yet to use.
    Values,
}

impl HoldingKind {
    pub(crate) const ALL: [HoldingKind; 6] = [
        HoldingKind::Intentions,
        HoldingKind::Events,
        HoldingKind::Facts,
        HoldingKind::Messages,
        HoldingKind::Plans,
        HoldingKind::Values,
    ];

    /// How many an agent may hold.
    #[must_use]
    pub const fn most(self) -> usize {
        match self {
            HoldingKind::Intentions | HoldingKind::Events | HoldingKind::Facts | HoldingKind::Messages => {
                100_000
            }
            HoldingKind::Plans => 1_000_000,
            HoldingKind::Values => 5_000_000,
        }
    }
}

impl fmt::Display for HoldingKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            HoldingKind::Intentions => "intentions",
            HoldingKind::Events => "events",
            HoldingKind::Facts => "facts",
            HoldingKind::Messages => "messages",
            HoldingKind::Plans => "plans on its stacks",
            HoldingKind::Values => "values on its stacks",
        })
    }
}
