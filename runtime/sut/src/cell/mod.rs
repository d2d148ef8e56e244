//! A cell: where the program of one test runs, apart from every other test, and which ends whole.
//!
//! # Steps
//!
//! 1. [`CellHandle::start`](handle::CellHandle::start) starts a *supervisor* (this program, or another that calls
//!    [`supervise`]) and hands it a [`CellOrder`](message::CellOrder) with the program's descriptors.
//! 2. The supervisor makes the cell. With [`CellIsolation::Namespaces`] it enters namespaces of its own
//!    (`supervisor.rs`) and mounts a private view of the file system (`view.rs`); with [`CellIsolation::Copies`] it copies the
//!    project's folder (`copies.rs`). Either way it has a process outside, to which the program is no child, and which
//!    cleans up whatever the program does to its parent.
//! 3. It starts the program under its limits and without rights over the machine (`rights.rs`), and answers
//!    [`CellRequest`](message::CellRequest)s with [`CellReport`](message::CellReport)s; processor time and sleep of
//!    everything that runs in the cell are read from the kernel's process tree (`descendants.rs`).
//! 4. When the program ends, when it is told to, or when the harness is gone, it kills every process of the cell, keeps the
//!    changed files if they were asked for (`keep.rs`), and ends.
//!
//! A *fork server* has a cell of its own (`supervisor.rs`, with the word of `SERVER`), which can be read only. It forks the first
//! process of each program's cell and the program, and the first process becomes the supervisor: so steps 3 and 4 are the same.
//!
//! The harness's death closes the supervisor's only connection, so nothing has to be cleaned up by who was killed.

pub(crate) mod cells;
mod control;
mod copies;
mod descendants;
pub(crate) mod handle;
mod keep;
mod limits;
pub(crate) mod message;
mod namespaces;
mod rights;
mod supervisor;
mod view;
mod watch;

pub use cells::CellSettings;
pub use handle::SupervisorCommand;
pub use message::{CELL_FOLDER, CellEnding, CellIsolation, CellUsage, KeptFiles};
pub use supervisor::supervise;
