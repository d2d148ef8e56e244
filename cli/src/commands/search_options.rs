//! How networks are searched: the words that `prove` and `gen` take.

use clap::ValueEnum;
use hrdsl_ir::suite::{DelayChoice, WitnessKind};
use hrdsl_runtime::prove::SearchOrder;

/// With more, storing what they find takes longer than finding it.
const MOST_THREADS: usize = 4;

/// `--threads`.
#[derive(clap::Args)]
pub struct SearchThreadsArgs {
    /// Threads that search at once; answers do not depend on it [default: one for each core, of up to four].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=256))]
    threads: Option<u16>,
}

impl SearchThreadsArgs {
    pub fn count(&self) -> usize {
        let cores = || std::thread::available_parallelism().map_or(1, |n| n.get().min(MOST_THREADS));
        self.threads.map_or_else(cores, usize::from)
    }
}

/// What `--witness` takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum WitnessArg {
    /// The first that is found.
    Any,
    /// As few transitions as any.
    Shortest,
    /// Ends as early as any.
    Fastest,
}

impl From<WitnessArg> for WitnessKind {
    fn from(kind: WitnessArg) -> Self {
        match kind {
            WitnessArg::Any => Self::Any,
            WitnessArg::Shortest => Self::Shortest,
            WitnessArg::Fastest => Self::Fastest,
        }
    }
}

/// What `--delays` takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DelayArg {
    /// As early as possible.
    Earliest,
    /// As late as possible.
    Latest,
    /// Drawn from the seed.
    Sampled,
}

impl From<DelayArg> for DelayChoice {
    fn from(when: DelayArg) -> Self {
        match when {
            DelayArg::Earliest => Self::Earliest,
            DelayArg::Latest => Self::Latest,
            DelayArg::Sampled => Self::Sampled,
        }
    }
}

/// What `--order` takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SearchOrderArg {
    /// First all states near the start.
    Breadth,
    /// First what follows the latest state.
    Depth,
    /// As `depth`, with the paths in a random order.
    Random,
    /// First what comes first in the order of the locations.
    Topological,
}

impl From<SearchOrderArg> for SearchOrder {
    fn from(way: SearchOrderArg) -> Self {
        match way {
            SearchOrderArg::Breadth => Self::Breadth,
            SearchOrderArg::Depth => Self::Depth,
            SearchOrderArg::Random => Self::RandomDepth,
            SearchOrderArg::Topological => Self::Topological,
        }
    }
}
