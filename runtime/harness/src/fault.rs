//! What a system did that no system should.

/// What a system did that no system should: the message, with its last output.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct SystemFault {
    pub message: String,
    pub kind: SystemFaultKind,
}

/// What a fault of the system says about another run of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SystemFaultKind {
    /// It would happen again.
    Program,
    /// Wall time ended the run: it may be the machine's load.
    WallTime,
    /// The campaign was interrupted: it says nothing about the system.
    Interrupted,
}
