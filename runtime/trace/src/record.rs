//! Writes a trace as a recording: JSON Lines, by names, so that it outlives the numbering of its scenario.

use std::fmt::Write as _;

use hrdsl_ir::{Nanos, Program, Value};

use crate::{
    MachineDeclaration, MachineEdge, MachineStep, RunEnd, Trace, TraceStep, TraceStepKind, decimal,
    vocabulary,
};

/// What kind of file this is: the header's `hrdsl`.
pub const KIND: &str = "trace";
/// The newest version of the format; [`parse`](crate::parse) reads it and those before it.
pub const VERSION: u64 = 3;
/// The version of recordings without steps of state machines, which older readers can read, too.
const WITHOUT_MACHINES: u64 = 2;

/// Where a recording comes from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordingHeader {
    pub scenario: String,
    /// The digest of the scenario's [`vocabulary`]; recordings by other programs may lack it.
    pub vocabulary: Option<String>,
    /// The test that was run; none: a recording of something else.
    pub test: Option<String>,
    pub seed: Option<u64>,
}

impl RecordingHeader {
    /// The header of a recording of this scenario.
    #[must_use]
    pub fn of(program: &Program) -> Self {
        let vocabulary = Some(vocabulary::digest(program));
        Self { scenario: program.name.clone(), vocabulary, ..Self::default() }
    }
}

/// How the run of a recording ended.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordingEnd {
    pub kind: RunEnd,
    /// What happened to a run that broke off.
    pub error: Option<String>,
}

/// The whole recording of a trace; every line ends with a line break.
#[must_use]
pub fn write(program: &Program, header: &RecordingHeader, trace: &Trace, ending: &RecordingEnd) -> String {
    let has_machines = trace.steps.iter().any(|step| matches!(step.what, TraceStepKind::Machine(_)));
    let mut text = header_line(header, if has_machines { VERSION } else { WITHOUT_MACHINES }) + "\n";
    for step in &trace.steps {
        text.push_str(&step_line(program, step));
        text.push('\n');
    }
    text.push_str(&end_line(trace.end, ending));
    text.push('\n');
    text
}

/// The first line, without a line break.
fn header_line(header: &RecordingHeader, version: u64) -> String {
    let mut line = format!("{{\"hrdsl\":{},\"version\":{version},\"scenario\":", text(KIND));
    line.push_str(&text(&header.scenario));
    for (key, value) in [("vocabulary", &header.vocabulary), ("test", &header.test)] {
        if let Some(value) = value {
            // Writing to a string cannot fail.
            let _ = write!(line, ",\"{key}\":{}", text(value));
        }
    }
    if let Some(seed) = header.seed {
        let _ = write!(line, ",\"seed\":{seed}");
    }
    line.push('}');
    line
}

/// The line of one step, without a line break.
fn step_line(program: &Program, step: &TraceStep) -> String {
    let mut line = format!("{{\"t\":{}", decimal::seconds(step.time));
    match &step.what {
        TraceStepKind::Event { event, args } => {
            line.push_str(",\"event\":");
            line.push_str(&text(&program.event(*event).name));
            if !args.is_empty() {
                line.push_str(",\"args\":{");
                for (index, arg) in (0u16..).zip(args) {
                    let comma = if index == 0 { "" } else { "," };
                    let name = text(&program.event(*event).param(index).name);
                    let _ = write!(line, "{comma}{name}:{}", value(*arg));
                }
                line.push('}');
            }
        }
        TraceStepKind::Sample { signal, value: sampled } => {
            let name = text(&program.signal(*signal).name);
            let _ = write!(line, ",\"signal\":{name},\"value\":{}", value(*sampled));
        }
        TraceStepKind::Machine(step) => line.push_str(&machine_text(step)),
    }
    line.push('}');
    line
}

/// What a step of a state machine has besides its time.
fn machine_text(step: &MachineStep) -> String {
    match step {
        MachineStep::Declared(MachineDeclaration { machine, states, transitions, outcomes }) => {
            let edge = |e: &MachineEdge| texts([&e.from, &e.outcome, &e.to]);
            let edges: Vec<String> = transitions.iter().map(edge).collect();
            let (machine, edges) = (text(machine), edges.join(","));
            let (states, outcomes) = (texts(states), texts(outcomes));
            format!(
                ",\"machine\":{machine},\"states\":{states},\"transitions\":[{edges}],\"outcomes\":{outcomes}"
            )
        }
        MachineStep::Begun { machine, state } => {
            format!(",\"machine\":{},\"to\":{}", text(machine), text(state))
        }
        MachineStep::Moved { machine, edge: MachineEdge { from, outcome, to } } => {
            let (machine, from, outcome, to) = (text(machine), text(from), text(outcome), text(to));
            format!(",\"machine\":{machine},\"from\":{from},\"outcome\":{outcome},\"to\":{to}")
        }
    }
}

fn texts<'t>(all: impl IntoIterator<Item = &'t String>) -> String {
    let all: Vec<String> = all.into_iter().map(|one| text(one)).collect();
    format!("[{}]", all.join(","))
}

/// The last line, without a line break.
fn end_line(time: Nanos, ending: &RecordingEnd) -> String {
    let mut line = format!("{{\"end\":{},\"ended\":{}", decimal::seconds(time), text(ending.kind.word()));
    if let Some(error) = &ending.error {
        line.push_str(",\"error\":");
        line.push_str(&text(error));
    }
    line.push('}');
    line
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
