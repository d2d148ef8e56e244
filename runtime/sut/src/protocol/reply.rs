//! What the harness answers, as lines of the protocol.

use std::collections::BTreeMap;

use hrdsl_harness::{MessageText, PlannedPoint, PortListing, QosPolicy, SystemArrival};
use hrdsl_ir::{Nanos, Value};
use serde::{Serialize, Serializer, ser::SerializeMap};
use serde_json::value::RawValue;

use super::ports::end_word;

/// What the harness answers.
#[derive(Clone, Debug, PartialEq)]
pub struct HarnessReply {
    /// Simulated time.
    pub time: Nanos,
    pub answer: ReplyAnswer,
}

/// A reply as it is written, with the one-way requests that were refused since the last one.
pub(crate) struct ReplyLine<'r> {
    pub reply: &'r HarnessReply,
    pub refused: &'r [RefusedLine],
}

/// A request without a reply of its own that was refused.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RefusedLine {
    /// The line of the program, counted from 1.
    pub line: u64,
    pub error: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub help: Option<String>,
}

/// The part of a reply that depends on the request.
#[derive(Clone, Debug, PartialEq)]
pub enum ReplyAnswer {
    /// To now, emit, sleep, drop, open, done, and to act that does not wait.
    Ok,
    /// To hello, from version 2 on: the version that is spoken, and the program's name in the scenario.
    Hello { version: u32, program: String },
    /// To wait_for: the event that came, and when it happened.
    Event { name: String, args: BTreeMap<String, Value>, time: Nanos },
    /// To wait_for: the timeout passed.
    TimedOut,
    /// To read.
    Value(Value),
    /// To state and plan.
    Numbers(Vec<f64>),
    /// To plan with `timed`.
    Way(Vec<PlannedPoint>),
    /// To get_parameter: the text of the value.
    Json(MessageText),
    /// To act and delete_parameter, and to get_parameter if there is none: it ended, well or for this reason not.
    Acted(Result<(), String>),
    /// To wait.
    Arrived { arrivals: Vec<SystemArrival>, gave_up: bool },
    /// To list.
    Listed(Vec<PortListing>),
    /// To any request: it was refused; the program gets an exception.
    Error {
        error: String,
        /// What to write instead.
        help: Option<String>,
    },
    /// To any request: the test is over, and why.
    Stop { reason: String },
}

#[derive(Serialize)]
struct WrittenEvent<'a> {
    name: &'a str,
    args: &'a BTreeMap<String, Value>,
    time: Nanos,
}

/// JSON has no infinite numbers, and none that is no number: they are words, as in messages.
#[derive(Serialize)]
#[serde(untagged)]
enum WrittenNumber {
    Finite(f64),
    Word(&'static str),
}

impl WrittenNumber {
    fn of(x: f64) -> Self {
        if x.is_finite() {
            Self::Finite(x)
        } else if x.is_nan() {
            Self::Word("nan")
        } else {
            Self::Word(if x > 0.0 { "inf" } else { "-inf" })
        }
    }
}

impl Serialize for ReplyLine<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("t", &self.reply.time)?;
        match &self.reply.answer {
            ReplyAnswer::Ok => {}
            ReplyAnswer::Hello { version, program } => {
                map.serialize_entry("version", version)?;
                map.serialize_entry("program", program)?;
            }
            ReplyAnswer::Event { name, args, time } => {
                map.serialize_entry("event", &WrittenEvent { name, args, time: *time })?;
            }
            ReplyAnswer::TimedOut => map.serialize_entry("event", &None::<()>)?,
            ReplyAnswer::Value(value) => map.serialize_entry("value", value)?,
            ReplyAnswer::Numbers(numbers) => {
                let written: Vec<WrittenNumber> = numbers.iter().map(|x| WrittenNumber::of(*x)).collect();
                map.serialize_entry("value", &written)?;
            }
            ReplyAnswer::Json(text) => map.serialize_entry("value", raw(text)?)?,
            ReplyAnswer::Way(points) => way(&mut map, points)?,
            ReplyAnswer::Acted(Ok(())) => map.serialize_entry("ok", &true)?,
            ReplyAnswer::Acted(Err(error)) => {
                map.serialize_entry("ok", &false)?;
                map.serialize_entry("error", error)?;
            }
            ReplyAnswer::Arrived { arrivals, gave_up } => {
                let written: Vec<WrittenArrival<'_>> = arrivals.iter().map(WrittenArrival).collect();
                map.serialize_entry("arrivals", &written)?;
                if *gave_up {
                    map.serialize_entry("gave_up", &true)?;
                }
            }
            ReplyAnswer::Listed(ports) => {
                let written: Vec<WrittenPort<'_>> = ports.iter().map(WrittenPort).collect();
                map.serialize_entry("ports", &written)?;
            }
            ReplyAnswer::Error { error, help } => {
                map.serialize_entry("error", error)?;
                if let Some(help) = help {
                    map.serialize_entry("help", help)?;
                }
            }
            ReplyAnswer::Stop { reason } => {
                map.serialize_entry("stop", &true)?;
                map.serialize_entry("reason", reason)?;
            }
        }
        if !self.refused.is_empty() {
            map.serialize_entry("refused", self.refused)?;
        }
        map.end()
    }
}

struct WrittenArrival<'a>(&'a SystemArrival);

impl Serialize for WrittenArrival<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        match self.0 {
            SystemArrival::Event { name, args, time } => {
                map.serialize_entry("event", &WrittenEvent { name, args, time: *time })?;
            }
            SystemArrival::Ended { call, how } => {
                map.serialize_entry("ended", call)?;
                map.serialize_entry("ok", &how.is_ok())?;
                if let Err(error) = how {
                    map.serialize_entry("error", error)?;
                }
            }
            SystemArrival::Message { port, message } => {
                map.serialize_entry("port", port)?;
                map.serialize_entry("message", raw(message)?)?;
            }
            SystemArrival::Incompatible { port, policy } => {
                map.serialize_entry("incompatible", port)?;
                map.serialize_entry("policy", policy_word(*policy))?;
            }
            SystemArrival::Called { port, call, message } => {
                map.serialize_entry("called", call)?;
                map.serialize_entry("port", port)?;
                map.serialize_entry("message", raw(message)?)?;
            }
            SystemArrival::Answered { call, answer } => {
                map.serialize_entry("answered", call)?;
                match answer {
                    Ok(message) => map.serialize_entry("message", raw(message)?)?,
                    Err(error) => map.serialize_entry("error", error)?,
                }
            }
            SystemArrival::Accepted { call, text } => {
                map.serialize_entry("accepted", call)?;
                explanation(&mut map, text)?;
            }
            SystemArrival::Feedback { call, message } => {
                map.serialize_entry("feedback", call)?;
                map.serialize_entry("message", raw(message)?)?;
            }
            SystemArrival::CancelAnswered { call, granted, text } => {
                map.serialize_entry("cancel_answered", call)?;
                map.serialize_entry("granted", granted)?;
                explanation(&mut map, text)?;
            }
            SystemArrival::Finished { call, end, message, text } => {
                map.serialize_entry("finished", call)?;
                map.serialize_entry("end", end_word(*end))?;
                map.serialize_entry("message", raw(message)?)?;
                explanation(&mut map, text)?;
            }
            SystemArrival::Canceled { port, call } => {
                map.serialize_entry("canceled", call)?;
                map.serialize_entry("port", port)?;
            }
            SystemArrival::Changed => map.serialize_entry("changed", &true)?,
        }
        map.end()
    }
}

/// The points of a way, member by member.
fn way<M: SerializeMap>(map: &mut M, points: &[PlannedPoint]) -> Result<(), M::Error> {
    let flat = |of: fn(&PlannedPoint) -> &[f64]| points.iter().flat_map(of).copied().collect::<Vec<f64>>();
    map.serialize_entry("value", &flat(|point| &point.positions))?;
    map.serialize_entry("velocities", &flat(|point| &point.velocities))?;
    map.serialize_entry("accelerations", &flat(|point| &point.accelerations))?;
    map.serialize_entry("times", &points.iter().map(|point| point.time).collect::<Vec<f64>>())
}

/// What a server says about a goal, if it says something.
fn explanation<M: SerializeMap>(map: &mut M, text: &str) -> Result<(), M::Error> {
    if text.is_empty() { Ok(()) } else { map.serialize_entry("text", text) }
}

/// INVARIANT: a message came out of a line of JSON.
fn raw<E: serde::ser::Error>(message: &str) -> Result<&RawValue, E> {
    serde_json::from_str(message).map_err(E::custom)
}

fn policy_word(policy: QosPolicy) -> &'static str {
    match policy {
        QosPolicy::Reliability => "reliability",
        QosPolicy::Durability => "durability",
    }
}

struct WrittenPort<'a>(&'a PortListing);

impl Serialize for WrittenPort<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(4))?;
        map.serialize_entry("kind", &self.0.kind.to_string().replace(' ', "_"))?;
        map.serialize_entry("name", &self.0.name)?;
        map.serialize_entry("type", &self.0.type_name)?;
        map.serialize_entry("program", &self.0.program)?;
        map.end()
    }
}
