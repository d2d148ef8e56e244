//! Exit codes, defined once; `--help` lists them.

use std::process::ExitCode;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    Ok = 0,
    /// The scenario has errors.
    Errors = 1,
    /// The command line is wrong, or a file cannot be read or written.
    Usage = 2,
    /// A requirement was violated, or a test broke off.
    Findings = 3,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        ExitCode::from(exit as u8)
    }
}
