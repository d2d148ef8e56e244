//! What can be chosen among of a campaign, by words.

/// Which tests can be looked at again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ReplaysArg {
    /// Those that violate a requirement or break off, and the passing ones beside which the report shows them.
    Failing,
    /// All.
    All,
    /// None: nothing is spent on it.
    None,
}
