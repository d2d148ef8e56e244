//! A program to write formulas over, and runs as the pages write them.

use hrdsl_ir::{
    ActorId, Event, EventId, Nanos, Parameter, Program, Type, Unit, Value,
    value::SECOND,
    world::{Signal, SignalId},
};
use hrdsl_trace::{Trace, TraceStep, TraceStepKind};

const EVENTS: [&str; 4] = ["a", "b", "c", "d"];
const TRUTHS: [&str; 2] = ["p", "q"];
const NUMBERS: [&str; 2] = ["x", "y"];

fn event(name: &str, params: Vec<Parameter>) -> Event {
    let origin = hrdsl_source::Span::default();
    Event { name: name.to_owned(), params, from: ActorId(0), to: Vec::new(), stimulus: None, origin }
}

fn signal(name: &str, ty: Type) -> Signal {
    Signal {
        name: name.to_owned(),
        ty,
        to: vec![ActorId(0)],
        terms: Vec::new(),
        value: hrdsl_ir::Expr::bool(true),
        recorded: true,
        origin: hrdsl_source::Span::default(),
    }
}

/// Events `a`, `b`, `c`, `d` and `decided(ready: bool, legs: int 0..4)`; signals `p`, `q`, `x`, `y`, `speed`, `distance(hand, palm)`.
pub fn program() -> Program {
    let mut events: Vec<Event> = EVENTS.iter().map(|name| event(name, Vec::new())).collect();
    let parameter = |name: &str, ty| Parameter { name: name.to_owned(), ty };
    let decided = vec![parameter("ready", Type::Bool), parameter("legs", Type::Int { lo: 0, hi: 4 })];
    events.push(event("decided", decided));
    let mut signals: Vec<Signal> = TRUTHS.iter().map(|name| signal(name, Type::Bool)).collect();
    signals.extend(NUMBERS.iter().map(|name| signal(name, Type::Float(Unit::None))));
    signals.push(signal("speed", Type::Float(Unit::MetrePerSecond)));
    signals.push(signal("distance(hand, palm)", Type::Float(Unit::Metre)));
    Program { events, signals, ..Program::default() }
}

/// `1 a, 2 not p, 2.5 x=3, 4`
pub fn run(text: &str) -> Trace {
    let mut trace = Trace::default();
    for part in text.split(", ") {
        let mut words = part.split(' ');
        let time: f64 = words.next().and_then(|t| t.parse().ok()).unwrap_or_else(|| panic!("{text}"));
        let time = (time * SECOND as f64).round() as Nanos;
        trace.end = time;
        let Some(word) = words.next() else { continue };
        let sample = |place: usize, value| TraceStepKind::Sample { signal: SignalId(place as u16), value };
        let place = |of: &[&str], name: &str| of.iter().position(|n| *n == name);
        let what = if let Some((name, number)) = word.split_once('=') {
            let place = place(&NUMBERS, name).unwrap_or_else(|| panic!("{name} in {text}"));
            sample(TRUTHS.len() + place, Value::Float(number.parse().unwrap()))
        } else if let Some(event) = place(&EVENTS, word) {
            TraceStepKind::Event { event: EventId(event as u16), args: Vec::new() }
        } else {
            let name = if word == "not" { words.next().unwrap() } else { word };
            sample(place(&TRUTHS, name).unwrap_or_else(|| panic!("{text}")), Value::Bool(word != "not"))
        };
        trace.steps.push(TraceStep { time, what });
    }
    trace
}
