//! Shows the steps of a trace to people.

use hrdsl_ir::{EventId, Nanos, Program, Type, Unit, Value, world::SignalId};

use crate::{TraceStep, TraceStepKind};

/// What stands in the column of the actors when a signal is sampled.
const SIGNAL: &str = "signal";
/// What stands there when a state machine moves.
const MACHINE: &str = "machine";

/// One step as a line: the time to the millisecond, who did it, and what.
///
/// ```text
///   12.500 s  robot   decided(ready: true)
///   12.550 s  signal  gaze = 0.25 m
/// ```
#[must_use]
pub fn line(program: &Program, step: &TraceStep) -> String {
    let names = program.actors.iter().map(|a| a.name.as_str());
    let width = names.chain([SIGNAL]).map(|n| n.chars().count()).max().unwrap_or(0);
    let (who, what) = who_did_what(program, &step.what);
    format!("{:>8} s  {who:<width$}  {what}", milliseconds(step.time))
}

/// The line's last two columns: the actor (or `signal`, or `machine`), and what it did (or its value).
#[must_use]
pub fn who_did_what<'p>(program: &'p Program, what: &TraceStepKind) -> (&'p str, String) {
    match what {
        TraceStepKind::Event { event, args } => (maker(program, *event), event_text(program, *event, args)),
        TraceStepKind::Sample { signal, value } => (SIGNAL, sample(program, *signal, *value)),
        TraceStepKind::Machine(step) => (MACHINE, step.to_string()),
    }
}

/// An event with its arguments: `sensed(gaze: true, distance: 0.25 m)`.
#[must_use]
pub fn event_text(program: &Program, event: EventId, args: &[Value]) -> String {
    let declared = program.event(event);
    if args.is_empty() {
        return declared.name.clone();
    }
    let shown = |(index, arg): (u16, &Value)| {
        let param = declared.param(index);
        format!("{}: {}", param.name, value(*arg, unit_of(param.ty)))
    };
    let shown: Vec<String> = (0u16..).zip(args).map(shown).collect();
    format!("{}({})", declared.name, shown.join(", "))
}

/// A value with the symbol of its unit; a float to five significant digits.
#[must_use]
pub fn value(value: Value, unit: Unit) -> String {
    let number = match value {
        Value::Float(x) => format!("{x:.4e}").parse().map_or(value, Value::Float),
        Value::Bool(_) | Value::Int(_) | Value::Symbol(_) | Value::Text(_) | Value::List(_) => value,
    };
    match unit.symbol() {
        "" => number.to_string(),
        symbol => format!("{number} {symbol}"),
    }
}

fn maker(program: &Program, event: EventId) -> &str {
    &program.actor(program.event(event).from).name
}

fn sample(program: &Program, signal: SignalId, sampled: Value) -> String {
    let signal = program.signal(signal);
    format!("{} = {}", signal.name, value(sampled, unit_of(signal.ty)))
}

/// That of the numbers of a type.
#[must_use]
pub fn unit_of(ty: Type) -> Unit {
    match ty {
        Type::Float(unit) => unit,
        Type::Bool | Type::Int { .. } | Type::Enum(_) | Type::Text | Type::List(_) => Unit::None,
    }
}

/// Seconds, rounded to the nearest millisecond.
fn milliseconds(time: Nanos) -> String {
    let rounded = time.unsigned_abs().saturating_add(500_000) / 1_000_000;
    let sign = if time < 0 { "-" } else { "" };
    format!("{sign}{}.{:03}", rounded / 1000, rounded % 1000)
}
