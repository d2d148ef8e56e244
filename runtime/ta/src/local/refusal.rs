//! Why local time gives no report: it does not serve, or the search itself fails.

use super::zone;
use crate::witness::error::SearchError;

/// Why local time does not serve a network. The standard search does.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotApplicableError {
    /// Whether time may pass for one automaton depends on the others.
    #[error("channel `{0}` is urgent")]
    Urgent(String),
    /// Abstraction aLU does not know such bounds.
    #[error("`{0}` has a bound on a difference of clocks")]
    Difference(String),
    /// Whether time may pass for one automaton depends on what another does.
    #[error(
        "the invariant of `{location}` of `{automaton}` depends on `{shared}`, which other automata change or share"
    )]
    Invariant { automaton: String, location: String, shared: String },
    /// Its delays cannot be taken out of the differences of times.
    #[error("the clocks of `{0}` stand still in a location")]
    Stopped(String),
    /// Automata share it, and the options say that no medium may stand for it.
    #[error("automata share `{0}`")]
    Shared(String),
    /// The order of its witness would have to depend on the clocks at its end.
    #[error("a goal speaks of clocks")]
    ClockGoal,
    /// The constants, or the sums of them on some path, are too large for the matrices.
    #[error("the time constants are too far apart")]
    Constants,
}

impl From<zone::BoundOverflowError> for NotApplicableError {
    fn from(_: zone::BoundOverflowError) -> Self {
        NotApplicableError::Constants
    }
}

/// Why a search with local time gave no report.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LocalSearchError {
    #[error("local time does not serve this network: {0}")]
    NotApplicable(#[from] NotApplicableError),
    #[error(transparent)]
    Search(#[from] SearchError),
}
