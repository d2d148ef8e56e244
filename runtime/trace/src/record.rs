//! Writes a trace as a recording: JSON Lines, by names, so that it outlives the numbering of its scenario.

use std::fmt::Write as _;

use hrdsl_ir::{EventId, Nanos, Program, Value, world::SignalId};
use serde::{Deserialize, Serialize};

use crate::{Observer, Step, Trace, What, decimal};

/// What kind of file this is: the header's `hrdsl`.
pub const KIND: &str = "trace";
/// The version of the format that this module writes and [`parse`](crate::parse) reads.
pub const VERSION: u64 = 1;

/// Where a recording comes from.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    pub scenario: String,
    /// The test that was run; none: a recording of something else.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub test: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
}

/// The whole recording of a trace; every line ends with a line break.
#[must_use]
pub fn write(program: &Program, header: &Header, trace: &Trace) -> String {
    let mut recorder = Recorder::new(program, header);
    trace.replay(&mut recorder);
    recorder.take()
}

/// Records a run while it goes on.
#[derive(Clone, Debug)]
pub struct Recorder<'a> {
    program: &'a Program,
    text: String,
}

impl<'a> Recorder<'a> {
    #[must_use]
    pub fn new(program: &'a Program, header: &Header) -> Self {
        Self { program, text: header_line(header) + "\n" }
    }

    /// The lines written since the last call; to be called now and then, so that the memory stays bounded.
    #[must_use]
    pub fn take(&mut self) -> String {
        std::mem::take(&mut self.text)
    }
}

impl Observer for Recorder<'_> {
    fn step(&mut self, _: usize, step: &Step) {
        self.text.push_str(&step_line(self.program, step));
        self.text.push('\n');
    }

    fn end(&mut self, time: Nanos) {
        self.text.push_str(&end_line(time));
        self.text.push('\n');
    }
}

/// The first line, without a line break.
#[must_use]
pub fn header_line(header: &Header) -> String {
    let mut line = format!("{{\"hrdsl\":{},\"version\":{VERSION},\"scenario\":", text(KIND));
    line.push_str(&text(&header.scenario));
    if let Some(test) = &header.test {
        line.push_str(",\"test\":");
        line.push_str(&text(test));
    }
    if let Some(seed) = header.seed {
        // Writing to a string cannot fail.
        let _ = write!(line, ",\"seed\":{seed}");
    }
    line.push('}');
    line
}

/// The line of one step, without a line break.
#[must_use]
pub fn step_line(program: &Program, step: &Step) -> String {
    let mut line = format!("{{\"t\":{}", decimal::seconds(step.time));
    match &step.what {
        What::Event { event, args } => {
            line.push_str(",\"event\":");
            line.push_str(&text(event_name(program, *event)));
            if !args.is_empty() {
                line.push_str(",\"args\":{");
                for (index, arg) in args.iter().enumerate() {
                    let comma = if index == 0 { "" } else { "," };
                    let name = text(param_name(program, *event, index));
                    let _ = write!(line, "{comma}{name}:{}", value(*arg));
                }
                line.push('}');
            }
        }
        What::Sample { signal, value: sampled } => {
            let name = text(signal_name(program, *signal));
            let _ = write!(line, ",\"signal\":{name},\"value\":{}", value(*sampled));
        }
    }
    line.push('}');
    line
}

/// The last line, without a line break.
#[must_use]
pub fn end_line(time: Nanos) -> String {
    format!("{{\"end\":{}}}", decimal::seconds(time))
}

/// What stands for a name that the program does not have; a reader will refuse it.
const UNKNOWN: &str = "?";

pub(crate) fn event_name(program: &Program, event: EventId) -> &str {
    program.events.get(usize::from(event.0)).map_or(UNKNOWN, |e| &e.name)
}

pub(crate) fn param_name(program: &Program, event: EventId, index: usize) -> &str {
    let event = program.events.get(usize::from(event.0));
    event.and_then(|e| e.params.get(index)).map_or(UNKNOWN, |p| &p.name)
}

pub(crate) fn signal_name(program: &Program, signal: SignalId) -> &str {
    program.signals.get(usize::from(signal.0)).map_or(UNKNOWN, |s| &s.name)
}

fn text(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// A float has the shortest digits that read back as the same number, and always a point or an exponent.
fn value(value: Value) -> String {
    match value {
        Value::Bool(b) => b.to_string(),
        Value::Int(n) => n.to_string(),
        Value::Float(x) => match serde_json::Number::from_f64(x) {
            Some(number) => number.to_string(),
            None if x.is_nan() => "\"nan\"".to_owned(),
            None if x > 0.0 => "\"inf\"".to_owned(),
            None => "\"-inf\"".to_owned(),
        },
        Value::Symbol(s) => text(s.name()),
        Value::Text(t) => text(t.as_str()),
        Value::List(list) => {
            let elements: Vec<String> = list.iter().map(self::value).collect();
            format!("[{}]", elements.join(", "))
        }
    }
}
