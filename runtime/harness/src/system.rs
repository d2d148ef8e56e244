//! The seam to the system: what plays the system actor, be it a process in lock-step or a robot outside.
//!
//! A system asks, and is answered. A request need not be answered before the next one comes: each has a [`RequestTicket`], and
//! whoever waits for nothing goes on asking. A process in lock-step is a system that has at most one request open.

use std::{collections::BTreeMap, fmt};

use hrdsl_ir::{Nanos, Value};

use crate::{argument::SystemArgument, command::CommandRequest};

/// Whatever plays the system actor.
pub trait SystemActor {
    /// Whether it may ask something now: if not, it is not asked before it was answered, or time has passed.
    fn is_ready(&self) -> bool;

    /// What it asks next at this instant; `None`: nothing more.
    ///
    /// # Errors
    /// What it did that no system should.
    fn next(&mut self, now: Nanos) -> Result<Option<(RequestTicket, SystemRequest)>, SystemFault>;

    /// The answer to one of its requests.
    ///
    /// # Errors
    /// What it did that no system should.
    fn answer(&mut self, ticket: RequestTicket, now: Nanos, answer: SystemAnswer) -> Result<(), SystemFault>;
}

/// Tells the open requests of a system apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct RequestTicket(pub u64);

/// What a system asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum SystemRequest {
    /// What time is it?
    Now,
    /// Make an event of the scenario happen.
    Emit { event: String, args: BTreeMap<String, SystemArgument> },
    /// Tell it when this time has passed.
    Sleep { time: Nanos },
    /// Take the first of these events out of the mailbox, or tell it when one comes.
    WaitFor { events: Vec<String>, timeout: Option<Nanos> },
    /// Forget these events in the mailbox; none named: all.
    Drop { events: Vec<String> },
    /// The present value of a signal.
    Read { signal: String },
    /// Let a device do something, and tell it when that has ended.
    Command(CommandRequest),
    /// It has come to its normal end.
    Done,
}

/// What the harness answers.
#[derive(Clone, Debug, PartialEq)]
pub enum SystemAnswer {
    /// To now, emit, sleep and drop.
    Ok,
    /// To a wait: the event that came, and when it happened.
    Event { name: String, args: BTreeMap<String, Value>, time: Nanos },
    /// To a wait: its time is over.
    TimedOut,
    /// To read.
    Value(Value),
    /// To a command: it ended, well or for this reason not.
    Ended(Result<(), String>),
    /// To any request: it makes no sense.
    Refused {
        error: String,
        /// What to write instead.
        help: Option<String>,
    },
}

impl fmt::Display for SystemArgument {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SystemArgument::Text(text) => write!(f, "{text:?}"),
            SystemArgument::Scalar(value) => write!(f, "{value}"),
            SystemArgument::Numbers(numbers) => write!(f, "{numbers:?}"),
        }
    }
}

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
