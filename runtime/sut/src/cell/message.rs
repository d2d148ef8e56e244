//! What harness and supervisor say to each other: one JSON line each, over one socket.

use std::{ffi::OsString, time::Duration};

use serde::{Deserialize, Serialize};

use crate::exit::ProgramExit;

/// The folder of a cell's own home and temporary files: the same path in every cell.
pub const CELL_FOLDER: &str = "/tmp/.hrdsl-cell";

/// The word of a cell in which a fork server runs.
pub(crate) const SERVER: &str = "fork-server";

/// How a cell keeps its program apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CellIsolation {
    /// Namespaces of processes, files, network and inter-process communication: the program sees the machine's files,
    /// and what it writes is its own.
    Namespaces,
    /// A copy of the project's folder; the rest of the machine is shared.
    Copies,
}

/// All that the supervisor must know; sent once, with the program's descriptors.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct CellOrder {
    pub isolation: CellIsolation,
    /// The program and its arguments; empty: the cell is made and ends at once, to see whether it can be, unless the program is
    /// there already.
    pub command: Vec<OsString>,
    /// The program's whole environment, but for what the supervisor adds (`HOME`, `TMPDIR`, descriptors).
    pub env: Vec<(OsString, OsString)>,
    /// The project's folder, absolute; the program starts in it.
    pub dir: OsString,
    /// Folders that the program does not see: results of hrdsl.
    pub hidden: Vec<OsString>,
    /// The names of the variables that tell the numbers of the descriptors, in their order.
    pub descriptors: Vec<String>,
    /// Bytes of private memory for each process, and of files in memory for the cell.
    pub memory: u64,
    /// Whether the files that the program writes are kept: then the last descriptor is the folder for them.
    pub keep: bool,
    /// Whether the machine's network is the program's, too.
    pub network: bool,
    /// Whether the program keeps the terminal, for a debugger.
    pub terminal: bool,
}

/// What the harness asks for while the program runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum CellRequest {
    Usage,
    /// SIGTERM to everything in the cell.
    Terminate,
    /// The end of everything in the cell.
    Kill,
}

/// What the supervisor says.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum CellReport {
    /// The program runs, or could if there were one.
    Started {
        /// Whether its addresses are the same in every run.
        fixed_addresses: bool,
        /// What its paths begin with, and what they stand for; empty where they are the same.
        moved: Vec<(OsString, OsString)>,
        /// Folders that are not the cell's own and cannot be written to, since the kernel refused.
        read_only: Vec<OsString>,
    },
    /// The cell could not be made, or the program not be started.
    Refused {
        /// Whether it is the program that does not exist.
        absent: bool,
        what: String,
        why: String,
    },
    Usage(CellUsage),
    Ended(CellEnding),
}

/// What the processes of a cell have used so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CellUsage {
    /// Processor time of all of them, dead or alive.
    pub cpu: Duration,
    /// Whether every thread of every one waits for something that is no processor and no disk.
    pub asleep: bool,
}

/// How the program ended, and what became of its files.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CellEnding {
    pub exit: ProgramExit,
    /// Whether there was ever another process in the cell.
    pub others: bool,
    pub cpu: Duration,
    /// Whether and how files were kept, if they were to be.
    pub kept: Option<KeptFiles>,
}

/// The files that a program wrote, copied out of its cell.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeptFiles {
    pub files: u64,
    /// What could not be copied, and why.
    pub failures: Vec<String>,
}
