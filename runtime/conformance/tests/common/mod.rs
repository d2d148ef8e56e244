//! Scenarios and traces for the tests of conformance.
#![allow(dead_code, reason = "each test uses a part of it")]

use hrdsl_compiler::{InputFile, compile};
use hrdsl_conformance::{ConformanceChecker, ConformanceOptions};
use hrdsl_ir::{Nanos, Program, Value, value::SECOND};
use hrdsl_results::{ConformanceVerdict, RunEnd};
use hrdsl_trace::{Trace, TraceStep, TraceStepKind};

const HEAD: &str = "scenario small\nactor env : environment\nactor sys : system\n\
    event ask from env to sys\nevent stop from env to sys\nevent level(n: 0..9) from env to sys\n\
    event give from sys\nevent drop from sys\nevent said(n: 0..9) from sys\nevent other from sys\n";

/// A scenario with the events `ask`, `stop`, `level(n)` for the system, and `give`, `drop`, `said(n)`, `other` by it.
pub fn scenario(rest: &str) -> Program {
    let text = format!("{HEAD}{rest}");
    let compiled = compile(InputFile { name: "small.hri", text: &text }, &[]);
    match compiled.program {
        Some(program) => program,
        None => panic!("{:?}\n{text}", compiled.diagnostics),
    }
}

/// `give at 2.5`, `said 3 at 4`: the words of an event, and when.
pub fn trace(program: &Program, events: &[(&str, f64)], end: f64) -> Trace {
    let nanos = |t: f64| (t * SECOND as f64).round() as Nanos;
    let step = |(text, time): &(&str, f64)| {
        let mut words = text.split(' ');
        let event = program.event_named(words.next().unwrap()).unwrap();
        let args = words.map(|n| Value::Int(n.parse().unwrap())).collect();
        TraceStep { time: nanos(*time), what: TraceStepKind::Event { event, args } }
    };
    Trace { steps: events.iter().map(step).collect(), end: nanos(end) }
}

pub fn verdict_with(
    program: &Program,
    trace: &Trace,
    ended: RunEnd,
    options: &ConformanceOptions,
) -> ConformanceVerdict {
    let mut checker = ConformanceChecker::new(program, options);
    trace.replay(&mut checker);
    let mut all = checker.finish(ended);
    assert_eq!(all.len(), 1, "{all:?}");
    all.remove(0)
}

/// The verdict on a run that ended at its limit.
pub fn verdict(program: &Program, events: &[(&str, f64)], end: f64) -> ConformanceVerdict {
    verdict_with(program, &trace(program, events, end), RunEnd::Limit, &ConformanceOptions::default())
}
