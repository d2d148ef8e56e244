//! The system under test: a process that runs in lock-step with simulated time; the only crate that starts processes.
//!
//! # Steps
//!
//! 1. [`PythonEnv::prepare`] installs, once, what robot code in Python needs: the SDK, coverage.py, its requirements.
//! 2. [`CellSettings::probe`] finds out how the machine can keep the programs of several tests apart.
//! 3. [`SutProcess::spawn`] starts the program of a [`LaunchSpec`] in a [`cell`] of its own, with its output captured in bounded
//!    memory, or [`SutProcess::fork`] lets a [`ForkServer`] fork it, which has imported beforehand what it will.
//!    [`SutProcess::next`] waits for the program's [`ProgramRequest`], within the [`ProgramLimits`].
//! 4. [`SutProcess::reply`] answers it with a [`HarnessReply`], which carries the simulated time.
//! 5. [`SutProcess::finish`] ends the program and gives its exit, output and code coverage ([`FileCoverage`](hrdsl_results::FileCoverage)).
//!
//! [`LockStep`] is such a process as the harness's system.
//!
//! Whatever the program does (die, hang, flood its output, write rubbish) is a [`SutError`], never a panic and never a
//! blocked harness. The protocol is `spec/protocol.md`.
#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod affinity;
pub mod cell;
mod coverage;
mod environment;
mod error;
mod exit;
mod fork_server;
mod launch;
mod limits;
mod lock_step;
mod mutants;
mod output;
mod patience;
mod pipes;
mod process;
mod processor;
mod protocol;
mod start;

pub use affinity::{PinnedCore, pin_to_free_core};
pub use cell::CellSettings;
pub use coverage::{ExecutedFile, ProgramLines, ThreadLines};
pub use environment::{EnvironmentNeeds, HookedPackage, PreparationStep, PythonEnv};
pub use error::{ProgramFailure, SutError};
pub use exit::ProgramExit;
pub use fork_server::ForkServer;
pub use launch::{DEFAULT_VARIABLES, LaunchMiddleware, LaunchSpec};
pub use limits::{LimitOverrun, ProgramLimits, StopFlag};
pub use lock_step::LockStep;
pub use mutants::{CompiledMutants, LaunchMutant, ListedMutant};
pub use output::{CapturedOutput, CapturedStream};
pub use process::{FinishedProcess, SutProcess};
pub use processor::ProcessorClocks;
pub use protocol::{
    HarnessReply, MessageRequest, OpenRequest, PROTOCOL_VERSION, PlanRequest, ProgramRequest,
    ProtocolArgument, RefusedLine, ReplyAnswer,
};
