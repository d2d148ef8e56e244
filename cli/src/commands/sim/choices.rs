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

/// How tests are kept apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum IsolationArg {
    /// Namespaces of the kernel: everything that a test writes is its own.
    Namespaces,
    /// A copy of the scenario's folder for each test.
    Copies,
}
