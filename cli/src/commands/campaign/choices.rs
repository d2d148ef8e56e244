//! How tests are kept apart, by words.

/// How tests are kept apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum IsolationArg {
    /// Namespaces of the kernel: everything that a test writes is its own.
    Namespaces,
    /// A copy of the scenario's folder for each test.
    Copies,
}
