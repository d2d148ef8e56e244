//! What ends a command and is no diagnostic.

/// A failure that is no diagnostic: a file, an argument.
pub type CommandFault = String;
