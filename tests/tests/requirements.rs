//! Requirements of every pattern in every scope against what the pages say of whole traces, on random traces.
//!
//! `HRDSL_SOAK=1 cargo test --workspace --test requirements` tries a million of them; `HRDSL_TRACES` says how many else.

#[path = "requirements/dice.rs"]
mod dice;
#[path = "requirements/naive.rs"]
mod naive;
#[path = "requirements/sentence.rs"]
mod sentence;
#[path = "requirements/verdicts.rs"]
mod verdicts;

use std::collections::BTreeMap;

use hrdsl_compiler::{InputFile, compile};
use hrdsl_ir::{EventId, Nanos, Program, Value, value::SECOND, world::SignalId};
use hrdsl_monitor::{MonitorOutcome, MonitorRunner, MonitorVerdict};
use hrdsl_trace::{Trace, TraceStep, TraceStepKind};

use dice::Dice;
use naive::judge;
use sentence::Sentence;

/// Requirements of one scenario: below the number from which pairs are no longer compared.
const TOGETHER: usize = 200;

/// So many of them judge each trace.
const JUDGES: usize = 4;

/// A scenario with what the sentences name.
pub(crate) fn scenario(requirements: &str) -> String {
    format!(
        "scenario watched\nactor guest : environment\nactor robot : system\nevent a, b, c, d from robot\n{requirements}\n\
         world {{\n  body cup: dynamic cylinder(3 cm, 10 cm) at (0 m, 0 m, 1 m) mass 200 g\n  \
         body hand: kinematic sphere(5 cm) at (1 m, 0 m, 1 m)\n  \
         signal p: bool to robot = distance(cup, hand) < 1 m\n  signal q: bool to robot = speed(cup) < 1 m/s\n}}\n"
    )
}

pub(crate) fn program(requirements: &str) -> Program {
    let text = scenario(requirements);
    let compilation = compile(InputFile { name: "watched.hri", text: &text }, &[]);
    let errors: Vec<_> = compilation.diagnostics.iter().filter(|d| d.is_error()).collect();
    compilation.program.unwrap_or_else(|| panic!("{text}\n{errors:#?}"))
}

/// Many steps at one instant, and many at the very deadlines.
fn trace(dice: &mut Dice) -> Trace {
    let (mut steps, mut time) = (Vec::new(), 0);
    for _ in 0..dice.below(24) {
        time += [0, 0, 0, 1, SECOND / 2, SECOND, SECOND, 2 * SECOND][dice.below(8)];
        let what = if dice.below(2) == 0 {
            TraceStepKind::Event { event: EventId(dice.below(4) as u16), args: Vec::new() }
        } else {
            let signal = SignalId(dice.below(2) as u16);
            TraceStepKind::Sample { signal, value: Value::Bool(dice.below(2) == 0) }
        };
        steps.push(TraceStep { time, what });
    }
    Trace { steps, end: time + [0, SECOND, 3 * SECOND][dice.below(3)] }
}

pub(crate) fn verdicts_of(program: &Program, trace: &Trace) -> Vec<MonitorVerdict> {
    let mut runner = MonitorRunner::new(program);
    trace.replay(&mut runner);
    runner.verdicts()
}

fn shown(trace: &Trace) -> String {
    let step = |s: &TraceStep| {
        let what = match &s.what {
            TraceStepKind::Event { event, .. } => ["a", "b", "c", "d"][usize::from(event.0)].to_owned(),
            TraceStepKind::Sample { signal, value } => {
                format!("{}={value}", ["p", "q"][usize::from(signal.0)])
            }
            TraceStepKind::Machine(step) => step.to_string(),
        };
        format!("{} {what}", seconds(s.time))
    };
    let steps: Vec<String> = trace.steps.iter().map(step).collect();
    format!("{}; end {}", steps.join("; "), seconds(trace.end))
}

fn seconds(time: Nanos) -> f64 {
    time as f64 / SECOND as f64
}

/// How many traces are tried.
fn traces() -> usize {
    let usual = if std::env::var_os("HRDSL_SOAK").is_some() { 1_000_000 } else { 60_000 };
    std::env::var("HRDSL_TRACES").ok().and_then(|n| n.parse().ok()).unwrap_or(usual)
}

#[test]
fn monitors_say_what_the_pages_say() {
    let mut dice = Dice(1);
    let (all, each) = (traces(), 1_000);
    let mut met: BTreeMap<String, [usize; 4]> = BTreeMap::new();
    for _ in 0..all.div_ceil(each) {
        let sentences: Vec<Sentence> = (0..TOGETHER).map(|n| Sentence::random(&mut dice, n)).collect();
        let texts: Vec<String> =
            sentences.iter().enumerate().map(|(n, s)| format!("require R{n} safety {s}")).collect();
        let program = program(&texts.join("\n"));
        let groups: Vec<Program> = program
            .monitors
            .chunks(JUDGES)
            .map(|few| Program { monitors: few.to_vec(), ..program.clone() })
            .collect();
        for _ in 0..each {
            let (trace, group) = (trace(&mut dice), dice.below(groups.len()));
            let judged = &sentences[group * JUDGES..];
            for (verdict, sentence) in verdicts_of(&groups[group], &trace).iter().zip(judged) {
                let expected = judge(sentence, &trace);
                let found = (
                    verdict.outcome,
                    verdict.triggered as usize,
                    verdict.failures as usize,
                    verdict.first_failure.as_ref().map(|v| v.time),
                );
                let wanted = (expected.outcome(), expected.triggered, expected.failures, expected.first);
                assert_eq!(found, wanted, "{sentence}\n{}\nthe monitor, then the page", shown(&trace));
                met.entry(sentence.form()).or_default()[verdict.outcome as usize] += 1;
            }
        }
    }
    every_verdict_is_met(&met);
}

/// Each form of sentence has had each verdict that it can have.
fn every_verdict_is_met(met: &BTreeMap<String, [usize; 4]>) {
    let outcomes =
        [MonitorOutcome::Pass, MonitorOutcome::Fail, MonitorOutcome::Vacuous, MonitorOutcome::Inconclusive];
    let all = met.iter().flat_map(|(form, counts)| outcomes.map(|outcome| (form, outcome, counts)));
    let wrong: Vec<String> = all
        .filter(|(form, outcome, counts)| (counts[*outcome as usize] > 0) != sentence::can_be(form, *outcome))
        .map(|(form, outcome, counts)| format!("{form}: {outcome}, of {counts:?}"))
        .collect();
    assert!(wrong.is_empty(), "these verdicts were not met, or cannot be:\n{}", wrong.join("\n"));
}
