//! Steps a second of processor time: ten requirements over mixed events, and recordings from their lines to the verdicts.
//!
//! `cargo bench -p hrdsl-judge --bench judging -- [--steps N]`

#![allow(clippy::disallowed_methods, reason = "a bench reads what its process takes")]

use hrdsl_compiler::{InputFile, compile};
use hrdsl_conformance::ConformanceOptions;
use hrdsl_ir::{EventId, Nanos, Program, Value, value::SECOND, world::SignalId};
use hrdsl_judge::{NamedFormula, judge_by_formulas, judge_recording};
use hrdsl_monitor::MonitorRunner;
use hrdsl_trace::{
    Trace, TraceStep, TraceStepKind,
    record::{RecordingEnd, RecordingHeader, write},
};

/// So often each is measured; the best counts, as other processes only slow it down.
const ROUNDS: usize = 5;

/// Requirements name the first four events and the first two signals; a monitor is not asked about the others.
const SCENARIO: &str = "scenario watched
actor guest : environment
actor robot : system
event a, b, c, d, e, f, g, h from robot
require R0 functional a causes b within 10 s
require R1 safety a forbids c until b
require R2 safety a precedes d
require R3 safety never d while p
require R4 safety always gap < 3 m
require R5 functional eventually a within 100 s
require R6 safety at most 3 d
require R7 functional whenever p for at least 2 s
require R8 functional whenever p for at most 5 s
require R9 functional a causes b not before 1 s within 20 s after c until d
world {
  body cup: dynamic cylinder(3 cm, 10 cm) at (0 m, 0 m, 1 m) mass 200 g
  body hand: kinematic sphere(5 cm) at (1 m, 0 m, 1 m)
  signal p: bool to robot = distance(cup, hand) < 1 m
  signal gap: length to robot = distance(cup, hand)
}
";

/// Formulas over the same, in place of those requirements.
const FORMULAS: [&str; 10] = [
    "always (a implies eventually[0 s, 10 s] b)",
    "always (c implies not a since[0 s, 30 s] b)",
    "always (d implies once a)",
    "always not (d and p)",
    "always gap < 3 m",
    "always (rising(p) implies eventually[0 s, 100 s] a)",
    "always (d implies once[0 s, 50 s] c)",
    "always (rising(p) implies always[0 s, 2 s] p)",
    "always (c implies historically[0 s, 5 s] gap < 3.9 m)",
    "always (a implies not d until[0 s, 20 s] b)",
];

/// The scenario with the formulas for requirements.
fn of_formulas() -> Program {
    let others = SCENARIO.lines().filter(|line| !line.starts_with("require"));
    let mut text: String = others.map(|line| format!("{line}\n")).collect();
    for (number, formula) in FORMULAS.iter().enumerate() {
        text += &format!("require R{number} functional formula {formula}\n");
    }
    program(&text)
}

fn program(text: &str) -> Program {
    let compilation = compile(InputFile { name: "watched.hri", text }, &[]);
    let errors: Vec<_> = compilation.diagnostics.iter().filter(|d| d.is_error()).collect();
    assert!(errors.is_empty(), "{errors:#?}");
    compilation.program.expect("a program without errors")
}

/// Events, each as often as the others, and a sample for every fourth of them.
fn trace(count: usize) -> Trace {
    let mut state = 1_u64;
    let mut below = |n: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % n
    };
    let mut trace = Trace::default();
    for _ in 0..count {
        trace.end += below(500) as Nanos * (SECOND / 1000);
        let what = match below(5) {
            0 if below(2) == 0 => {
                TraceStepKind::Sample { signal: SignalId(0), value: Value::Bool(below(2) == 0) }
            }
            0 => {
                let value = Value::Float(below(4_000_000) as f64 / 1e6);
                TraceStepKind::Sample { signal: SignalId(1), value }
            }
            _ => TraceStepKind::Event { event: EventId(below(8) as u16), args: Vec::new() },
        };
        trace.steps.push(TraceStep { time: trace.end, what });
    }
    trace
}

/// Seconds that this process, which has one thread, has been on a processor.
fn processor_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/schedstat").unwrap_or_default();
    text.split_whitespace().next().and_then(|t| t.parse::<f64>().ok()).unwrap_or(0.0) / 1e9
}

fn measure<T>(name: &str, count: usize, mut what: impl FnMut() -> T) {
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        let before = processor_seconds();
        std::hint::black_box(what());
        best = best.min(processor_seconds() - before);
    }
    println!("{name:<52} {:>7.2} million steps a second", count as f64 / best / 1e6);
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let after = args.iter().position(|a| a == "--steps").and_then(|i| args.get(i + 1));
    let count = after.and_then(|n| n.parse().ok()).unwrap_or(1_000_000);
    let (program, trace) = (program(SCENARIO), trace(count));
    measure("ten requirements, steps in memory", count, || {
        let mut runner = MonitorRunner::new(&program);
        trace.replay(&mut runner);
        runner.verdicts()
    });
    let formulas = of_formulas();
    for (name, few) in [
        (
            "a response as a pattern, steps in memory",
            Program { monitors: program.monitors[..1].to_vec(), ..program.clone() },
        ),
        (
            "the same as a formula, steps in memory",
            Program { monitors: formulas.monitors[..1].to_vec(), ..formulas.clone() },
        ),
        ("ten formulas, steps in memory", formulas.clone()),
    ] {
        measure(name, count, || {
            let mut runner = MonitorRunner::new(&few);
            trace.replay(&mut runner);
            runner.verdicts()
        });
    }
    let header = RecordingHeader { scenario: program.name.clone(), ..RecordingHeader::default() };
    let text = write(&program, &header, &trace, &RecordingEnd::default());
    let options = ConformanceOptions::default();
    let few = Program { monitors: program.monitors[..1].to_vec(), ..program.clone() };
    measure("one requirement, from lines of JSON to the verdict", count, || {
        judge_recording(&few, text.as_bytes(), true, &options).expect("a recording")
    });
    measure("ten requirements, from lines of JSON to verdicts", count, || {
        judge_recording(&program, text.as_bytes(), true, &options).expect("a recording")
    });
    let none = Program { monitors: Vec::new(), ..program.clone() };
    let response = "always (a implies eventually[0 s, 10 s] b)";
    let formula = NamedFormula::read(&program, "formula".to_owned(), response).expect("a formula");
    let formulas = [formula];
    measure("a formula, from lines of JSON to the verdict", count, || {
        judge_by_formulas((&none, &formulas), text.as_bytes(), true, &options).expect("a recording")
    });
}
