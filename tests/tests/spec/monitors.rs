//! The page on monitors is enough to write them again: a reference in Python, made from the page alone, gives the same verdicts
//! on random traces.

use std::{
    io::Write as _,
    process::{Command, Stdio},
};

use hrdsl_compiler::{InputFile, compile};
use hrdsl_ir::{EventId, Program, Type, Value, value::SECOND, world::SignalId};
use hrdsl_monitor::{MonitorOutcome, MonitorRunner, MonitorVerdict, Violation};
use hrdsl_trace::{Trace, TraceStep, TraceStepKind};
use serde_json::{Value as Json, json};

use crate::page::root;

const SCENARIO: &str = include_str!("monitors.hri");

/// A small generator of its own: the traces need to be many, not good.
struct Chance(u64);

impl Chance {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n
    }

    fn value(&mut self, ty: Type) -> Value {
        match ty {
            Type::Bool => Value::Bool(self.below(2) == 0),
            Type::Int { lo, hi } => Value::Int(lo + self.below((hi - lo + 1) as usize) as i64),
            Type::Float(_) => Value::Float([0.0, 0.1, 0.2, 0.3, 0.5, 0.75, 1.0, 1.5, 3.0][self.below(9)]),
            Type::Enum(e) => Value::Symbol(e.values()[0]),
            Type::Text | Type::List(_) => panic!("no event of the scenario has it"),
        }
    }

    /// Many steps at one instant, and many at the very deadlines.
    fn trace(&mut self, program: &Program) -> Trace {
        let (mut steps, mut time) = (Vec::new(), 0);
        for _ in 0..self.below(60) {
            time += [0, 0, 0, 1, SECOND / 2, SECOND, 2 * SECOND, 4 * SECOND][self.below(8)];
            let what = if self.below(2) == 0 {
                let event = EventId(self.below(program.events.len()) as u16);
                let params = &program.event(event).params;
                TraceStepKind::Event { event, args: params.iter().map(|p| self.value(p.ty)).collect() }
            } else {
                let signal = self.below(program.signals.len());
                let value = self.value(program.signals[signal].ty);
                TraceStepKind::Sample { signal: SignalId(signal as u16), value }
            };
            steps.push(TraceStep { time, what });
        }
        Trace { steps, end: time + [0, SECOND, 4 * SECOND][self.below(3)] }
    }
}

fn as_json(trace: &Trace) -> Json {
    let step = |s: &TraceStep| match &s.what {
        TraceStepKind::Event { event, args } => json!([s.time, event, args]),
        TraceStepKind::Sample { signal, value } => json!([s.time, { "signal": signal }, value]),
        TraceStepKind::Machine(step) => json!([s.time, step.to_string()]),
    };
    json!({ "steps": trace.steps.iter().map(step).collect::<Vec<_>>(), "end": trace.end })
}

/// A verdict as the reference says it.
fn in_words(verdict: &MonitorVerdict) -> Json {
    let violation = |v: &Violation| {
        let counterexample: Vec<usize> = v.counterexample.iter().map(|seen| seen.index).collect();
        json!({
            "time": v.time, "step": v.step, "trigger_time": v.trigger_time, "counterexample": counterexample, "values": v.values
        })
    };
    json!({
        "monitor": verdict.monitor,
        "outcome": match verdict.outcome {
            MonitorOutcome::Pass => "pass",
            MonitorOutcome::Fail => "fail",
            MonitorOutcome::Vacuous => "vacuous",
            MonitorOutcome::Inconclusive => "inconclusive",
        },
        "triggered": verdict.triggered,
        "discharged": verdict.discharged,
        "failures": verdict.failures,
        "first_failure": verdict.first_failure.as_ref().map(violation),
        "worst_margin": verdict.worst_margin,
        "pending_since": verdict.pending_since,
        "unvalued": verdict.unvalued,
    })
}

#[test]
fn the_reference_gives_the_same_verdicts() {
    let compilation = compile(InputFile { name: "monitors.hri", text: SCENARIO }, &[]);
    let said: Vec<_> = compilation.diagnostics.iter().filter(|d| d.is_error()).collect();
    let program = compilation.program.unwrap_or_else(|| panic!("{said:#?}"));
    let mut chance = Chance(1);
    let traces: Vec<Trace> = (0..400).map(|_| chance.trace(&program)).collect();
    let given =
        json!({ "monitors": program.monitors, "traces": traces.iter().map(as_json).collect::<Vec<_>>() });
    let mut child = Command::new("python3")
        .arg(root().join("tests/tests/spec/monitors.py"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("python3 is there");
    child.stdin.take().unwrap().write_all(given.to_string().as_bytes()).unwrap();
    let got = String::from_utf8(child.wait_with_output().unwrap().stdout).unwrap();
    assert_eq!(got.lines().count(), traces.len());
    let mut outcomes = std::collections::BTreeSet::new();
    for (number, (trace, got)) in traces.iter().zip(got.lines()).enumerate() {
        let mut checker = MonitorRunner::new(&program);
        trace.replay(&mut checker);
        let got: Vec<Json> = serde_json::from_str(got).unwrap();
        for (verdict, got) in checker.verdicts().iter().zip(got) {
            let expected = in_words(verdict);
            let name = &program.monitors[verdict.monitor].name;
            outcomes.insert((verdict.monitor, expected["outcome"].to_string()));
            assert_eq!(
                expected,
                got,
                "trace {number}, {name}: hrdsl, then the reference\n{}",
                as_json(trace)
            );
        }
    }
    assert!(outcomes.len() > 2 * program.monitors.len(), "{outcomes:?}");
}
