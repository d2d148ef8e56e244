//! The lock-step protocol, versions 1 and 2, as data (`spec/protocol.md`): one JSON line each way.

mod open;
mod plan;
mod ports;
mod reply;

use std::{borrow::Cow, collections::BTreeMap, fmt};

use hrdsl_harness::ProgramLogLevel;
use hrdsl_ir::{Nanos, Value};
use serde::{Deserialize, Serialize};

pub use open::{OpenRequest, WrittenPortKind};
pub use plan::PlanRequest;
pub use ports::MessageRequest;
pub(crate) use reply::ReplyLine;
pub use reply::{HarnessReply, RefusedLine, ReplyAnswer};

/// The newest version that this crate speaks; it speaks the older ones, too.
pub const PROTOCOL_VERSION: u32 = 2;

/// What the program asks for. Durations are in seconds, finite and not negative ([`Process::next`](crate::Process::next)
/// refuses others).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "request", rename_all = "snake_case")]
pub enum ProgramRequest {
    /// The first request; may come again with another name.
    Hello {
        version: u32,
        name: String,
    },
    /// What time is it?
    Now,
    /// Make an event of the scenario happen.
    Emit {
        event: String,
        #[serde(default)]
        args: BTreeMap<String, ProtocolArgument>,
    },
    /// Let simulated time pass.
    Sleep {
        seconds: f64,
    },
    /// Take the first of these events out of the mailbox, or wait for one.
    WaitFor {
        events: Vec<String>,
        /// No timeout: wait until the end of the test.
        #[serde(default)]
        timeout: Option<f64>,
    },
    /// Forget these events in the mailbox; none named: all.
    Drop {
        events: Vec<String>,
    },
    /// The present value of a signal.
    Read {
        signal: String,
    },
    /// Let a device do something.
    Act {
        /// The device: `robot.arm`.
        on: String,
        /// One of its commands: `move_to`.
        #[serde(rename = "do")]
        command: String,
        #[serde(default)]
        args: BTreeMap<String, ProtocolArgument>,
        /// Whether the reply comes when the command has ended.
        #[serde(default = "yes")]
        wait: bool,
        /// If not: the program's number for the command, by which it is told of the end. From version 2 on.
        #[serde(default)]
        call: Option<u64>,
    },
    /// What has arrived, or what arrives until one of these times. From version 2 on, as all below but done.
    Wait {
        #[serde(default)]
        until: Option<Nanos>,
        #[serde(default)]
        give_up: Option<Nanos>,
    },
    /// Be a publisher, subscriber, server or client.
    Open(OpenRequest),
    Close {
        port: u64,
    },
    /// What is open in the system.
    List,
    /// The program waits until somebody serves this name, or publishes there.
    Await {
        kind: WrittenPortKind,
        name: String,
        #[serde(default, rename = "type")]
        type_name: Option<String>,
        #[serde(default)]
        give_up: Option<Nanos>,
    },
    /// Ask for the end of a goal, or of all goals at an action: one of the two.
    Cancel {
        #[serde(default)]
        call: Option<u64>,
        #[serde(default)]
        port: Option<u64>,
    },
    /// Take a goal on.
    Accept {
        call: u64,
        #[serde(default)]
        text: String,
    },
    /// Say whether a goal will be canceled.
    AnswerCancel {
        call: u64,
        granted: bool,
        #[serde(default)]
        text: String,
    },
    /// What a device tells of itself, as numbers.
    State {
        device: String,
        what: String,
    },
    /// The posture in which an arm's tool would be at a place, or the way to it or to a posture.
    Plan(PlanRequest),
    /// A state machine has gone from the state `label` to the state `next`; without `label` it begins there.
    Transition {
        machine: String,
        #[serde(default)]
        label: Option<String>,
        #[serde(default)]
        outcome: Option<String>,
        next: String,
    },
    /// What a state machine consists of.
    Machine {
        name: String,
        states: Vec<String>,
        transitions: Vec<(String, String, String)>,
        outcomes: Vec<String>,
    },
    /// Something of it has failed where nobody else is told: a callback that throws, in a library that goes on.
    Failed {
        text: String,
        #[serde(default)]
        node: String,
    },
    /// The value of a parameter of the system.
    GetParameter {
        name: String,
    },
    /// There is to be no such parameter any more.
    DeleteParameter {
        name: String,
    },
    /// The program logs something.
    Log {
        level: WrittenLogLevel,
        #[serde(default)]
        node: String,
        text: String,
    },
    /// With a message in it.
    #[serde(skip)]
    Message(MessageRequest),
    /// The program has come to its normal end.
    Done,
}

/// The levels of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WrittenLogLevel {
    Debug,
    Info,
    Warn,
    Error,
    Fatal,
}

impl From<WrittenLogLevel> for ProgramLogLevel {
    fn from(level: WrittenLogLevel) -> Self {
        match level {
            WrittenLogLevel::Debug => ProgramLogLevel::Debug,
            WrittenLogLevel::Info => ProgramLogLevel::Info,
            WrittenLogLevel::Warn => ProgramLogLevel::Warn,
            WrittenLogLevel::Error => ProgramLogLevel::Error,
            WrittenLogLevel::Fatal => ProgramLogLevel::Fatal,
        }
    }
}

fn yes() -> bool {
    true
}

/// An argument of an event or a command, as the program wrote it: what it means, its declaration tells.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ProtocolArgument {
    /// The name of a value of an enumeration, perhaps. First, so that no text becomes a symbol before it is known to be
    /// one: symbols are kept for ever.
    Text(String),
    /// A place (x, y, z; metres) or joint angles (radians). Before values, of which some are lists, too.
    Numbers(Vec<f64>),
    Scalar(Value),
}

impl fmt::Display for ProtocolArgument {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ProtocolArgument::Text(text) => write!(f, "{text:?}"),
            ProtocolArgument::Scalar(value) => write!(f, "{value}"),
            ProtocolArgument::Numbers(numbers) => write!(f, "{numbers:?}"),
        }
    }
}

impl ProgramRequest {
    /// Why the request makes no sense whatever the scenario, to a program that speaks this version, if it does not.
    pub(crate) fn fault(&self, version: u32) -> Option<String> {
        let bad = |s: f64| (!s.is_finite() || s < 0.0).then(|| format!("{s} is no duration"));
        if version < self.since() {
            return Some(format!(
                "this request is one of version {}, and `hello` said {version}",
                self.since()
            ));
        }
        match self {
            ProgramRequest::Hello { version, .. } => (!(1..=PROTOCOL_VERSION).contains(version)).then(|| {
                format!("protocol version {version} is not spoken here, only 1 to {PROTOCOL_VERSION}")
            }),
            ProgramRequest::Sleep { seconds } => bad(*seconds),
            ProgramRequest::WaitFor { events, .. } if events.is_empty() => {
                Some("wait_for without events".to_owned())
            }
            ProgramRequest::WaitFor { timeout, .. } => timeout.and_then(bad),
            ProgramRequest::Act { wait: false, call: None, .. } => {
                Some("act without wait needs the number of a `call`".to_owned())
            }
            ProgramRequest::Cancel { call: None, port: None }
            | ProgramRequest::Cancel { call: Some(_), port: Some(_) } => {
                Some("cancel needs either a `call` or a `port`".to_owned())
            }
            ProgramRequest::Open(open) => open.fault(),
            ProgramRequest::Plan(plan) => plan.fault(),
            ProgramRequest::Now
            | ProgramRequest::Emit { .. }
            | ProgramRequest::Drop { .. }
            | ProgramRequest::Read { .. }
            | ProgramRequest::Act { .. }
            | ProgramRequest::Wait { .. }
            | ProgramRequest::Close { .. }
            | ProgramRequest::List
            | ProgramRequest::Await { .. }
            | ProgramRequest::Cancel { .. }
            | ProgramRequest::Accept { .. }
            | ProgramRequest::AnswerCancel { .. }
            | ProgramRequest::State { .. }
            | ProgramRequest::Transition { .. }
            | ProgramRequest::Machine { .. }
            | ProgramRequest::Failed { .. }
            | ProgramRequest::GetParameter { .. }
            | ProgramRequest::DeleteParameter { .. }
            | ProgramRequest::Log { .. }
            | ProgramRequest::Message(_)
            | ProgramRequest::Done => None,
        }
    }

    /// The version that brought it.
    fn since(&self) -> u32 {
        match self {
            ProgramRequest::Act { wait: false, .. }
            | ProgramRequest::Wait { .. }
            | ProgramRequest::Open(_)
            | ProgramRequest::Close { .. }
            | ProgramRequest::List
            | ProgramRequest::Await { .. }
            | ProgramRequest::Cancel { .. }
            | ProgramRequest::Accept { .. }
            | ProgramRequest::AnswerCancel { .. }
            | ProgramRequest::State { .. }
            | ProgramRequest::Plan(_)
            | ProgramRequest::Transition { .. }
            | ProgramRequest::Machine { .. }
            | ProgramRequest::Failed { .. }
            | ProgramRequest::GetParameter { .. }
            | ProgramRequest::DeleteParameter { .. }
            | ProgramRequest::Log { .. }
            | ProgramRequest::Message(_) => 2,
            ProgramRequest::Hello { .. }
            | ProgramRequest::Now
            | ProgramRequest::Emit { .. }
            | ProgramRequest::Sleep { .. }
            | ProgramRequest::WaitFor { .. }
            | ProgramRequest::Drop { .. }
            | ProgramRequest::Read { .. }
            | ProgramRequest::Act { .. }
            | ProgramRequest::Done => 1,
        }
    }

    /// Whether it has no reply of its own.
    pub(crate) fn is_one_way(&self) -> bool {
        match self {
            ProgramRequest::Close { .. }
            | ProgramRequest::Await { .. }
            | ProgramRequest::Cancel { .. }
            | ProgramRequest::Accept { .. }
            | ProgramRequest::AnswerCancel { .. }
            | ProgramRequest::Transition { .. }
            | ProgramRequest::Machine { .. }
            | ProgramRequest::Failed { .. }
            | ProgramRequest::Log { .. } => true,
            ProgramRequest::Message(request) => request.is_one_way(),
            ProgramRequest::Hello { .. }
            | ProgramRequest::Now
            | ProgramRequest::Emit { .. }
            | ProgramRequest::Sleep { .. }
            | ProgramRequest::WaitFor { .. }
            | ProgramRequest::Drop { .. }
            | ProgramRequest::Read { .. }
            | ProgramRequest::Act { .. }
            | ProgramRequest::Wait { .. }
            | ProgramRequest::Open(_)
            | ProgramRequest::List
            | ProgramRequest::State { .. }
            | ProgramRequest::Plan(_)
            | ProgramRequest::GetParameter { .. }
            | ProgramRequest::DeleteParameter { .. }
            | ProgramRequest::Done => false,
        }
    }
}

/// What a line from the program is.
#[derive(Debug)]
pub(crate) enum ProtocolLine {
    Request(ProgramRequest),
    /// JSON, but not a request that this version knows: the program is told so; at once, if it waits for a reply.
    Refused {
        why: String,
        waits: bool,
    },
    /// No JSON object with a `request`: whoever wrote it does not speak the protocol.
    Rubbish(String),
}

/// The kind of a request; the rest of the line is looked at when that is known.
#[derive(Deserialize)]
struct RequestHead<'l> {
    #[serde(borrow)]
    request: Cow<'l, str>,
}

/// The kinds of requests that have no reply of their own, from version 2 on.
const ONE_WAY: [&str; 14] = [
    "publish",
    "call",
    "respond",
    "accept",
    "feedback",
    "answer_cancel",
    "finish",
    "close",
    "cancel",
    "await",
    "transition",
    "machine",
    "failed",
    "log",
];

/// What a line means to a program that speaks this version.
pub(crate) fn parse(line: &[u8], version: u32) -> ProtocolLine {
    // Of a list, serde would take the elements for the members.
    let is_object = line.trim_ascii_start().starts_with(b"{");
    let head: serde_json::Result<RequestHead<'_>> = if is_object {
        serde_json::from_slice(line)
    } else {
        Err(serde::de::Error::custom("no JSON object"))
    };
    let waits = version < 2 || !head.as_ref().is_ok_and(|head| ONE_WAY.contains(&&*head.request));
    let why = match head.and_then(|head| of_kind(&head.request, line)) {
        Ok(request) => match request.fault(version) {
            None => return ProtocolLine::Request(request),
            Some(why) => return ProtocolLine::Refused { why, waits },
        },
        Err(why) => why.to_string(),
    };
    match serde_json::from_slice::<serde_json::Value>(line) {
        Ok(value) if value.get("request").is_some_and(serde_json::Value::is_string) => {
            ProtocolLine::Refused { why, waits }
        }
        Ok(_) => ProtocolLine::Rubbish("no request".to_owned()),
        Err(error) => ProtocolLine::Rubbish(error.to_string()),
    }
}

/// What is asked for most is read without the detour by which serde finds out the kind again.
fn of_kind(kind: &str, line: &[u8]) -> serde_json::Result<ProgramRequest> {
    #[derive(Deserialize)]
    struct WaitLine {
        until: Option<Nanos>,
        give_up: Option<Nanos>,
    }
    match kind {
        "now" => Ok(ProgramRequest::Now),
        "wait" => serde_json::from_slice(line)
            .map(|WaitLine { until, give_up }| ProgramRequest::Wait { until, give_up }),
        _ => match ports::parse(kind, line) {
            Some(request) => request.map(ProgramRequest::Message),
            None => serde_json::from_slice(line),
        },
    }
}

#[cfg(test)]
mod tests;
