//! How networks are searched: the words that `prove` and `gen` take.

use clap::ValueEnum;
use hrdsl_ir::suite::{Delays, WitnessKind};
use hrdsl_runtime::prove::SearchOrder;

/// What `--witness` takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Witness {
    /// The first that is found.
    Any,
    /// As few transitions as any.
    Shortest,
    /// Ends as early as any.
    Fastest,
}

impl From<Witness> for WitnessKind {
    fn from(kind: Witness) -> Self {
        match kind {
            Witness::Any => Self::Any,
            Witness::Shortest => Self::Shortest,
            Witness::Fastest => Self::Fastest,
        }
    }
}

/// What `--delays` takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum When {
    /// As early as possible.
    Earliest,
    /// As late as possible.
    Latest,
    /// Drawn from the seed.
    Sampled,
}

impl From<When> for Delays {
    fn from(when: When) -> Self {
        match when {
            When::Earliest => Self::Earliest,
            When::Latest => Self::Latest,
            When::Sampled => Self::Sampled,
        }
    }
}

/// What `--order` takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Way {
    /// First all states near the start.
    Breadth,
    /// First what follows the latest state.
    Depth,
    /// As `depth`, with the paths in a random order.
    Random,
    /// First what comes first in the order of the locations.
    Topological,
}

impl From<Way> for SearchOrder {
    fn from(way: Way) -> Self {
        match way {
            Way::Breadth => Self::Breadth,
            Way::Depth => Self::Depth,
            Way::Random => Self::RandomDepth,
            Way::Topological => Self::Topological,
        }
    }
}
