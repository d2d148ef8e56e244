//! The tables of `spec/conformance.md`: each trace has the verdict that stands beside it.

use hrdsl_compiler::{InputFile, compile};
use hrdsl_ir::{Nanos, Program, value::SECOND};
use hrdsl_runtime::{
    conformance::{ConformanceChecker, ConformanceOptions},
    results::RunEnd,
};
use hrdsl_trace::{Trace, TraceObserver, TraceStep, TraceStepKind};

use crate::page::{read, split};

fn nanos(text: &str) -> Nanos {
    (text.parse::<f64>().unwrap() * SECOND as f64).round() as Nanos
}

/// `ask 1, give 2.5, end 20`
fn trace(program: &Program, text: &str) -> Trace {
    let mut trace = Trace::default();
    for (index, words) in text.split(", ").enumerate() {
        let (name, time) = words.split_once(' ').unwrap();
        match program.event_named(name) {
            Some(event) => {
                let what = TraceStepKind::Event { event, args: Vec::new() };
                trace.step(index, &TraceStep { time: nanos(time), what });
            }
            None => trace.end(nanos(time)),
        }
    }
    trace
}

fn options(program: &Program, text: &str) -> ConformanceOptions {
    match text.split_once(' ') {
        Some(("--latency", seconds)) => {
            ConformanceOptions { latency: nanos(seconds), ..ConformanceOptions::default() }
        }
        Some(("--unobserved", name)) => {
            let unobserved = vec![program.event_named(name).unwrap()];
            ConformanceOptions { unobserved, ..ConformanceOptions::default() }
        }
        Some(_) | None => ConformanceOptions::default(),
    }
}

#[test]
fn traces_have_the_verdicts_of_the_page() {
    let page = read("spec/conformance.md");
    let (blocks, lines) = split(&page);
    let compiled = compile(InputFile { name: "counter.hri", text: &blocks[0].text }, &[]);
    let program = compiled.program.unwrap();
    let mut rows = 0;
    for (_, line) in lines {
        let cells: Vec<&str> = line.trim_matches('|').split(" | ").map(str::trim).collect();
        let (with, told, verdict) = match cells[..] {
            [told, verdict] if told.contains("end ") => ("", told, verdict),
            [with, told, verdict] if told.contains("end ") => (with, told, verdict),
            _ => continue,
        };
        let code = |text: &str| text.trim_matches('`').to_owned();
        let mut checker = ConformanceChecker::new(&program, &options(&program, &code(with)));
        trace(&program, &code(told)).replay(&mut checker);
        let found = checker.finish(RunEnd::Limit);
        let said = found[0].sentence().unwrap_or_else(|| "conforms".to_owned());
        assert_eq!(said, code(verdict), "{told} {with}");
        rows += 1;
    }
    assert_eq!(rows, 15);
}
