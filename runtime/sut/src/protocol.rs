//! The lock-step protocol, version 1, as data (`spec/protocol.md`): one JSON line each way.

use std::{collections::BTreeMap, fmt};

use hrdsl_ir::{Nanos, Value};
use serde::{Deserialize, Serialize, Serializer, ser::SerializeMap};

/// The version that this crate speaks.
pub const PROTOCOL_VERSION: u32 = 1;

/// What the program asks for. Durations are in seconds, finite and not negative ([`Process::next`](crate::Process::next)
/// refuses others).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "request", rename_all = "snake_case")]
pub enum ProgramRequest {
    /// The first request; may come again with another name.
    Hello { version: u32, name: String },
    /// What time is it?
    Now,
    /// Make an event of the scenario happen.
    Emit {
        event: String,
        #[serde(default)]
        args: BTreeMap<String, ProtocolArgument>,
    },
    /// Let simulated time pass.
    Sleep { seconds: f64 },
    /// Take the first of these events out of the mailbox, or wait for one.
    WaitFor {
        events: Vec<String>,
        /// No timeout: wait until the end of the test.
        #[serde(default)]
        timeout: Option<f64>,
    },
    /// Forget these events in the mailbox; none named: all.
    Drop { events: Vec<String> },
    /// The present value of a signal.
    Read { signal: String },
    /// Let a device do something.
    Act {
        /// The device: `robot.arm`.
        on: String,
        /// One of its commands: `move_to`.
        #[serde(rename = "do")]
        command: String,
        #[serde(default)]
        args: BTreeMap<String, ProtocolArgument>,
        /// Whether the reply comes when the command has ended; version 1 always waits.
        #[serde(default = "yes")]
        wait: bool,
    },
    /// The program has come to its normal end.
    Done,
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
    /// Why the request makes no sense whatever the scenario, if it does not.
    pub(crate) fn fault(&self) -> Option<String> {
        let bad = |s: f64| (!s.is_finite() || s < 0.0).then(|| format!("{s} is no duration"));
        match self {
            ProgramRequest::Hello { version, .. } => (*version != PROTOCOL_VERSION)
                .then(|| format!("protocol version {version} is not spoken here, only {PROTOCOL_VERSION}")),
            ProgramRequest::Sleep { seconds } => bad(*seconds),
            ProgramRequest::WaitFor { events, .. } if events.is_empty() => {
                Some("wait_for without events".to_owned())
            }
            ProgramRequest::WaitFor { timeout, .. } => timeout.and_then(bad),
            ProgramRequest::Act { wait: false, .. } => Some("version 1 has no act without wait".to_owned()),
            ProgramRequest::Now
            | ProgramRequest::Emit { .. }
            | ProgramRequest::Drop { .. }
            | ProgramRequest::Read { .. }
            | ProgramRequest::Act { .. }
            | ProgramRequest::Done => None,
        }
    }
}

/// What the harness answers.
#[derive(Clone, Debug, PartialEq)]
pub struct HarnessReply {
    /// Simulated time.
    pub time: Nanos,
    pub answer: ReplyAnswer,
}

/// The part of a reply that depends on the request.
#[derive(Clone, Debug, PartialEq)]
pub enum ReplyAnswer {
    /// To hello, now, emit, sleep, drop, done.
    Ok,
    /// To wait_for: the event that came, and when it happened.
    Event { name: String, args: BTreeMap<String, Value>, time: Nanos },
    /// To wait_for: the timeout passed.
    TimedOut,
    /// To read.
    Value(Value),
    /// To act: it ended, well or for this reason not.
    Acted(Result<(), String>),
    /// To any request: it was refused; the program gets an exception.
    Error {
        error: String,
        /// What to write instead.
        help: Option<String>,
    },
    /// To any request: the test is over.
    Stop,
}

impl Serialize for HarnessReply {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct EventOccurrence<'a> {
            name: &'a str,
            args: &'a BTreeMap<String, Value>,
            time: Nanos,
        }
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("t", &self.time)?;
        match &self.answer {
            ReplyAnswer::Ok => {}
            ReplyAnswer::Event { name, args, time } => {
                map.serialize_entry("event", &EventOccurrence { name, args, time: *time })?;
            }
            ReplyAnswer::TimedOut => map.serialize_entry("event", &None::<()>)?,
            ReplyAnswer::Value(value) => map.serialize_entry("value", value)?,
            ReplyAnswer::Acted(Ok(())) => map.serialize_entry("ok", &true)?,
            ReplyAnswer::Acted(Err(error)) => {
                map.serialize_entry("ok", &false)?;
                map.serialize_entry("error", error)?;
            }
            ReplyAnswer::Error { error, help } => {
                map.serialize_entry("error", error)?;
                if let Some(help) = help {
                    map.serialize_entry("help", help)?;
                }
            }
            ReplyAnswer::Stop => map.serialize_entry("stop", &true)?,
        }
        map.end()
    }
}

/// What a line from the program is.
#[derive(Debug)]
pub(crate) enum ProtocolLine {
    Request(ProgramRequest),
    /// JSON, but not a request that this version knows: the program is told so.
    Refused(String),
    /// No JSON object with a `request`: whoever wrote it does not speak the protocol.
    Rubbish(String),
}

pub(crate) fn parse(line: &[u8]) -> ProtocolLine {
    let why = match serde_json::from_slice::<ProgramRequest>(line) {
        Ok(request) => match request.fault() {
            None => return ProtocolLine::Request(request),
            Some(fault) => return ProtocolLine::Refused(fault),
        },
        Err(why) => why.to_string(),
    };
    match serde_json::from_slice::<serde_json::Value>(line) {
        Ok(value) if value.get("request").is_some_and(serde_json::Value::is_string) => {
            ProtocolLine::Refused(why)
        }
        Ok(_) => ProtocolLine::Rubbish("no request".to_owned()),
        Err(_) => ProtocolLine::Rubbish(why),
    }
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::Symbol;

    use super::*;

    fn request(line: &str) -> ProgramRequest {
        match parse(line.as_bytes()) {
            ProtocolLine::Request(request) => request,
            other => panic!("{line}: {other:?}"),
        }
    }

    #[test]
    fn every_request_of_the_specification_is_understood() {
        assert_eq!(request(r#"{"request":"now"}"#), ProgramRequest::Now);
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
        let ProgramRequest::Act { on, command, args, wait } = request(
            r#"{"request":"act","on":"robot.arm","do":"move_to","args":{"to":[0,1,2.5],"speed":0.2}}"#,
        ) else {
            panic!()
        };
        assert_eq!((on.as_str(), command.as_str(), wait), ("robot.arm", "move_to", true));
        assert_eq!(args["to"], ProtocolArgument::Numbers(vec![0.0, 1.0, 2.5]));
        assert_eq!(args["speed"], ProtocolArgument::Scalar(Value::Float(0.2)));
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
        let wire = |answer| serde_json::to_string(&HarnessReply { time: 5, answer }).unwrap();
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
            (r#"{"request":"hello","version":2,"name":"x"}"#, true),
            (r#"{"request":"wait_for","events":[]}"#, true),
            (r#"{"request":"wait_for","events":["a"],"timeout":-0.1}"#, true),
            (r#"{"request":"act","on":"a","do":"b","wait":false}"#, true),
            (r#"{"request":1}"#, false),
            ("{}", false),
            ("[]", false),
            ("", false),
            ("Hello, world", false),
            ("\u{fffd}{", false),
        ] {
            match parse(line.as_bytes()) {
                ProtocolLine::Refused(why) => assert!(refused, "{line}: {why}"),
                ProtocolLine::Rubbish(why) => assert!(!refused, "{line}: {why}"),
                ProtocolLine::Request(request) => panic!("{line}: {request:?}"),
            }
        }
    }

    #[test]
    fn replies_are_written_as_specified() {
        let wire = |answer| serde_json::to_string(&HarnessReply { time: 5, answer }).unwrap();
        assert_eq!(wire(ReplyAnswer::Ok), r#"{"t":5}"#);
        assert_eq!(wire(ReplyAnswer::TimedOut), r#"{"t":5,"event":null}"#);
        assert_eq!(wire(ReplyAnswer::Value(Value::Bool(true))), r#"{"t":5,"value":true}"#);
        assert_eq!(wire(ReplyAnswer::Acted(Ok(()))), r#"{"t":5,"ok":true}"#);
        assert_eq!(wire(ReplyAnswer::Acted(Err("far".into()))), r#"{"t":5,"ok":false,"error":"far"}"#);
        assert_eq!(wire(ReplyAnswer::Stop), r#"{"t":5,"stop":true}"#);
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
