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
mod tests {
    use hrdsl_ir::Symbol;

    use super::*;

    fn request(line: &str) -> ProgramRequest {
        match parse(line.as_bytes(), PROTOCOL_VERSION) {
            ProtocolLine::Request(request) => request,
            other => panic!("{line}: {other:?}"),
        }
    }

    #[test]
    fn every_request_of_the_specification_is_understood() {
        assert_eq!(request(r#"{"request":"now"}"#), ProgramRequest::Now);
        let wait = |until, give_up| ProgramRequest::Wait { until, give_up };
        assert_eq!(request(r#"{"request":"wait"}"#), wait(None, None));
        assert_eq!(request(r#"{"request":"wait","until":7,"more":1}"#), wait(Some(7), None));
        assert_eq!(request(r#"{"until":null,"give_up":8,"request":"w\u0061it"}"#), wait(None, Some(8)));
        assert_eq!(request(r#"{"request":"sleep","seconds":2}"#), ProgramRequest::Sleep { seconds: 2.0 });
        assert_eq!(
            request(r#"{"request":"wait_for","events":["a","b"]}"#),
            ProgramRequest::WaitFor { events: vec!["a".into(), "b".into()], timeout: None }
        );
        assert_eq!(
            request(r#"{"request":"emit","event":"decided","args":{"ready":true,"n":3,"x":1.5}}"#),
            ProgramRequest::Emit {
                event: "decided".into(),
                args: BTreeMap::from([
                    ("n".into(), ProtocolArgument::Scalar(Value::Int(3))),
                    ("ready".into(), ProtocolArgument::Scalar(Value::Bool(true))),
                    ("x".into(), ProtocolArgument::Scalar(Value::Float(1.5))),
                ])
            }
        );
        let ProgramRequest::Act { on, command, args, wait, call: None } = request(
            r#"{"request":"act","on":"robot.arm","do":"move_to","args":{"to":[0,1,2.5],"speed":0.2}}"#,
        ) else {
            panic!()
        };
        assert_eq!((on.as_str(), command.as_str(), wait), ("robot.arm", "move_to", true));
        assert_eq!(args["to"], ProtocolArgument::Numbers(vec![0.0, 1.0, 2.5]));
        assert_eq!(args["speed"], ProtocolArgument::Scalar(Value::Float(0.2)));
    }

    #[test]
    fn what_is_told_without_a_reply_is_understood() {
        let edges = r#"[["A","go","B"]]"#;
        let line = format!(
            r#"{{"request":"machine","name":"M","states":["A","B"],"transitions":{edges},"outcomes":[]}}"#
        );
        let machine = ProgramRequest::Machine {
            name: "M".into(),
            states: vec!["A".into(), "B".into()],
            transitions: vec![("A".into(), "go".into(), "B".into())],
            outcomes: Vec::new(),
        };
        let begun =
            ProgramRequest::Transition { machine: "M".into(), label: None, outcome: None, next: "A".into() };
        let waits = ProgramRequest::Await {
            kind: WrittenPortKind::Client,
            name: "/plan".into(),
            type_name: None,
            give_up: Some(5),
        };
        for (line, expected) in [
            (line.as_str(), machine),
            (r#"{"request":"transition","machine":"M","next":"A"}"#, begun),
            (r#"{"request":"await","kind":"client","name":"/plan","give_up":5}"#, waits),
            (
                r#"{"request":"failed","node":"/brain","text":"no"}"#,
                ProgramRequest::Failed { text: "no".into(), node: "/brain".into() },
            ),
            (
                r#"{"request":"failed","text":"no"}"#,
                ProgramRequest::Failed { text: "no".into(), node: String::new() },
            ),
            (
                r#"{"request":"log","level":"warn","node":"/brain","text":"low"}"#,
                ProgramRequest::Log {
                    level: WrittenLogLevel::Warn,
                    node: "/brain".into(),
                    text: "low".into(),
                },
            ),
        ] {
            let found = request(line);
            assert!(found.is_one_way(), "{line}");
            assert_eq!(found, expected);
        }
        for wrong in [r#"{"request":"machine","name":"M"}"#, r#"{"request":"log","level":"loud","text":"a"}"#]
        {
            assert!(
                matches!(parse(wrong.as_bytes(), 2), ProtocolLine::Refused { waits: false, .. }),
                "{wrong}"
            );
        }
    }

    #[test]
    fn parameters_are_asked_for_and_their_values_stay_text() {
        let get = request(r#"{"request":"get_parameter","name":"/a"}"#);
        let set = request(r#"{"request":"set_parameter","name":"/a","value": {"b": 1.50} }"#);
        let delete = request(r#"{"request":"delete_parameter","name":"/a"}"#);
        assert_eq!(get, ProgramRequest::GetParameter { name: "/a".into() });
        let (name, value) = ("/a".into(), r#"{"b": 1.50}"#.into());
        assert_eq!(set, ProgramRequest::Message(MessageRequest::SetParameter { name, value }));
        assert_eq!(delete, ProgramRequest::DeleteParameter { name: "/a".into() });
        assert!([get, set, delete].iter().all(|request| !request.is_one_way()));
        let wrong = parse(br#"{"request":"set_parameter","name":"/a"}"#, 2);
        assert!(matches!(wrong, ProtocolLine::Refused { waits: true, .. }), "{wrong:?}");
        let reply = HarnessReply { time: 5, answer: ReplyAnswer::Json("[1.50]".into()) };
        let line = ReplyLine { reply: &reply, refused: &[] };
        assert_eq!(serde_json::to_string(&line).unwrap(), r#"{"t":5,"value":[1.50]}"#);
    }

    #[test]
    fn symbols_go_there_and_back_as_text() {
        let ProgramRequest::Emit { args, .. } =
            request(r#"{"request":"emit","event":"paced","args":{"pace":"fast","odd":"\u00e4 \"b\""}}"#)
        else {
            panic!()
        };
        assert_eq!(args["pace"], ProtocolArgument::Text("fast".into()));
        assert_eq!(args["odd"], ProtocolArgument::Text("ä \"b\"".into()));
        let symbol = Value::Symbol(Symbol::intern("fast"));
        let wire = |answer| {
            let reply = HarnessReply { time: 5, answer };
            serde_json::to_string(&ReplyLine { reply: &reply, refused: &[] }).unwrap()
        };
        assert_eq!(wire(ReplyAnswer::Value(symbol)), r#"{"t":5,"value":"fast"}"#);
        let event = ReplyAnswer::Event {
            name: "paced".into(),
            args: BTreeMap::from([("pace".into(), symbol)]),
            time: 4,
        };
        assert_eq!(wire(event), r#"{"t":5,"event":{"name":"paced","args":{"pace":"fast"},"time":4}}"#);
        // What is written as a value is read as the argument of the same name.
        let text = serde_json::to_string(&symbol).unwrap();
        assert_eq!(
            serde_json::from_str::<ProtocolArgument>(&text).unwrap(),
            ProtocolArgument::Text("fast".into())
        );
    }

    #[test]
    fn arguments_are_shown_as_they_were_written() {
        let shown = |arg: ProtocolArgument| arg.to_string();
        assert_eq!(shown(ProtocolArgument::Text("fast".into())), "\"fast\"");
        assert_eq!(shown(ProtocolArgument::Scalar(Value::Int(3))), "3");
        assert_eq!(shown(ProtocolArgument::Numbers(vec![1.0, 2.5])), "[1.0, 2.5]");
    }

    #[test]
    fn what_is_no_request_is_refused_or_rubbish() {
        for (line, refused) in [
            (r#"{"request":"fly"}"#, true),
            (r#"{"request":"sleep"}"#, true),
            (r#"{"request":"sleep","seconds":-1}"#, true),
            (r#"{"request":"sleep","seconds":"long"}"#, true),
            (r#"{"request":"hello","version":3,"name":"x"}"#, true),
            (r#"{"request":"wait"}"#, true),
            (r#"{"request":"publish","port":1,"message":2}"#, true),
            (r#"{"request":"wait_for","events":[]}"#, true),
            (r#"{"request":"wait_for","events":["a"],"timeout":-0.1}"#, true),
            (r#"{"request":"act","on":"a","do":"b","wait":false}"#, true),
            (r#"{"request":1}"#, false),
            ("{}", false),
            ("[]", false),
            (r#"["now"]"#, false),
            ("", false),
            ("Hello, world", false),
            ("\u{fffd}{", false),
        ] {
            match parse(line.as_bytes(), 1) {
                ProtocolLine::Refused { why, waits } => assert!(refused && waits, "{line}: {why}"),
                ProtocolLine::Rubbish(why) => assert!(!refused, "{line}: {why}"),
                ProtocolLine::Request(request) => panic!("{line}: {request:?}"),
            }
        }
    }

    #[test]
    fn replies_are_written_as_specified() {
        let wire = |answer| {
            let reply = HarnessReply { time: 5, answer };
            serde_json::to_string(&ReplyLine { reply: &reply, refused: &[] }).unwrap()
        };
        assert_eq!(wire(ReplyAnswer::Ok), r#"{"t":5}"#);
        assert_eq!(wire(ReplyAnswer::TimedOut), r#"{"t":5,"event":null}"#);
        assert_eq!(wire(ReplyAnswer::Value(Value::Bool(true))), r#"{"t":5,"value":true}"#);
        let numbers = ReplyAnswer::Numbers(vec![0.5, f64::INFINITY, f64::NEG_INFINITY, f64::NAN]);
        assert_eq!(wire(numbers), r#"{"t":5,"value":[0.5,"inf","-inf","nan"]}"#);
        assert_eq!(wire(ReplyAnswer::Acted(Ok(()))), r#"{"t":5,"ok":true}"#);
        assert_eq!(wire(ReplyAnswer::Acted(Err("far".into()))), r#"{"t":5,"ok":false,"error":"far"}"#);
        assert_eq!(
            wire(ReplyAnswer::Stop { reason: "it is late".into() }),
            r#"{"t":5,"stop":true,"reason":"it is late"}"#
        );
        assert_eq!(
            wire(ReplyAnswer::Error { error: "no".into(), help: Some("yes".into()) }),
            r#"{"t":5,"error":"no","help":"yes"}"#
        );
        assert_eq!(
            wire(ReplyAnswer::Event {
                name: "go".into(),
                args: BTreeMap::from([("far".into(), Value::Float(2.0))]),
                time: 4
            }),
            r#"{"t":5,"event":{"name":"go","args":{"far":2.0},"time":4}}"#
        );
    }
}
