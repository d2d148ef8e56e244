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

/// What the program asks for. Durations are in seconds, finite and not negative ([`SutProcess::next`](crate::SutProcess::next)
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

/// What holds for a request whatever the scenario.
struct RequestRules {
    /// The version that brought it.
    since: u32,
    /// Whether it has no reply of its own.
    is_one_way: bool,
    /// Why it makes no sense, if it does not.
    fault: Option<String>,
}

impl RequestRules {
    /// One that has a reply, since this version.
    fn replied(since: u32) -> Self {
        Self { since, is_one_way: false, fault: None }
    }

    /// One that has none, as there are since version 2.
    fn one_way() -> Self {
        Self { is_one_way: true, ..Self::replied(2) }
    }

    fn with(self, fault: Option<String>) -> Self {
        Self { fault, ..self }
    }
}

fn no_duration(seconds: f64) -> Option<String> {
    (!seconds.is_finite() || seconds < 0.0).then(|| format!("{seconds} is no duration"))
}

impl ProgramRequest {
    /// Why the request makes no sense whatever the scenario, to a program that speaks this version, if it does not.
    pub(crate) fn fault(&self, version: u32) -> Option<String> {
        let RequestRules { since, fault, .. } = self.rules();
        if version < since {
            return Some(format!("this request is one of version {since}, and `hello` said {version}"));
        }
        fault
    }

    /// Whether it has no reply of its own.
    pub(crate) fn is_one_way(&self) -> bool {
        self.rules().is_one_way
    }

    fn rules(&self) -> RequestRules {
        match self {
            ProgramRequest::Hello { version, .. } => {
                let is_spoken = (1..=PROTOCOL_VERSION).contains(version);
                RequestRules::replied(1).with((!is_spoken).then(|| {
                    format!("protocol version {version} is not spoken here, only 1 to {PROTOCOL_VERSION}")
                }))
            }
            ProgramRequest::Sleep { seconds } => RequestRules::replied(1).with(no_duration(*seconds)),
            ProgramRequest::WaitFor { events, timeout } => {
                let none = events.is_empty().then(|| "wait_for without events".to_owned());
                RequestRules::replied(1).with(none.or_else(|| timeout.and_then(no_duration)))
            }
            ProgramRequest::Act { wait: false, call, .. } => {
                let unnumbered = || "act without wait needs the number of a `call`".to_owned();
                RequestRules::replied(2).with(call.is_none().then(unnumbered))
            }
            ProgramRequest::Now
            | ProgramRequest::Emit { .. }
            | ProgramRequest::Drop { .. }
            | ProgramRequest::Read { .. }
            | ProgramRequest::Act { wait: true, .. }
            | ProgramRequest::Done => RequestRules::replied(1),
            ProgramRequest::Open(open) => {
                RequestRules { is_one_way: !open.reply, ..RequestRules::replied(2) }.with(open.fault())
            }
            ProgramRequest::Plan(plan) => RequestRules::replied(2).with(plan.fault()),
            ProgramRequest::Wait { .. }
            | ProgramRequest::List
            | ProgramRequest::State { .. }
            | ProgramRequest::GetParameter { .. }
            | ProgramRequest::DeleteParameter { .. } => RequestRules::replied(2),
            ProgramRequest::Cancel { call, port } => {
                let either = || "cancel needs either a `call` or a `port`".to_owned();
                RequestRules::one_way().with((call.is_some() == port.is_some()).then(either))
            }
            ProgramRequest::Close { .. }
            | ProgramRequest::Await { .. }
            | ProgramRequest::Accept { .. }
            | ProgramRequest::AnswerCancel { .. }
            | ProgramRequest::Transition { .. }
            | ProgramRequest::Machine { .. }
            | ProgramRequest::Failed { .. }
            | ProgramRequest::Log { .. } => RequestRules::one_way(),
            ProgramRequest::Message(request) => {
                RequestRules { is_one_way: request.is_one_way(), ..RequestRules::replied(2) }
            }
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
            Some(why) => {
                return ProtocolLine::Refused { why, waits: waits && (version < 2 || !request.is_one_way()) };
            }
        },
        Err(why) => why.to_string(),
    };
    match serde_json::from_slice::<serde_json::Value>(line) {
        Ok(value) if value.get("request").is_some_and(serde_json::Value::is_string) => {
            let wants_none = version > 1 && value.get("reply") == Some(&serde_json::Value::Bool(false));
            ProtocolLine::Refused { why, waits: waits && !wants_none }
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
