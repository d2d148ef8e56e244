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
use hrdsl_ir::{EventId, Nanos, Program, Value, monitor::Monitor, value::SECOND, world::SignalId};
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
         signal p: bool to robot = distance(cup, hand) < 1 m\n  signal q: bool to robot = speed(cup) < 1 m/s\n  \
         signal far: length to robot = distance(cup, hand)\n  signal wide: length to robot = distance(cup, hand)\n}}\n"
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

/// A sentence over numbers: `p` and `q` are comparisons of two measurements.
fn over_numbers(sentence: &Sentence) -> String {
    let text = format!(" {sentence} ");
    let compared = |text: &str, truth: &str, number: &str| {
        let (before, after) = ([' ', '('], [' ', ')', ',']);
        before.iter().fold(text.to_owned(), |text, b| {
            let one = |text: String, a: &char| {
                text.replace(&format!("{b}{truth}{a}"), &format!("{b}({number} < 1 m){a}"))
            };
            after.iter().fold(text, one)
        })
    };
    compared(&compared(&text, "p", "far"), "q", "wide").trim().to_owned()
}

/// The same run, in which some samples are NaN, and as comparisons of its numbers with 1 m say it: one with a NaN is false.
fn measured(dice: &mut Dice, trace: &Trace, numbers: [SignalId; 2]) -> (Trace, Trace) {
    let (mut measured, mut compared) = (trace.clone(), trace.clone());
    for (number, truth) in measured.steps.iter_mut().zip(&mut compared.steps) {
        if let (TraceStepKind::Sample { signal, value }, TraceStepKind::Sample { value: truth, .. }) =
            (&mut number.what, &mut truth.what)
        {
            let less = value.as_bool() == Some(true);
            let metres = match dice.below(4) {
                0 => f64::NAN,
                _ if less => 0.5,
                _ => 1.5,
            };
            (*value, *truth) = (Value::Float(metres), Value::Bool(metres < 1.0));
            *signal = numbers[usize::from(signal.0)];
        }
    }
    (measured, compared)
}

/// Whether a comparison of the sentence is without a value when it is asked: when an instant is over, or before an event at it.
fn lacks_value(sentence: &Sentence, trace: &Trace, numbers: [SignalId; 2]) -> bool {
    let (mut values, mut unseen) = ([0.0_f64; 2], None);
    for step in &trace.steps {
        let event = match &step.what {
            TraceStepKind::Event { event, .. } => Some(event.0).filter(|event| sentence.names(*event)),
            TraceStepKind::Sample { .. } | TraceStepKind::Machine(_) => None,
        };
        let lacks = |place: usize| -> bool { values[place].is_nan() };
        if unseen.take_if(|time| step.time > *time || event.is_some()).is_some()
            && (0..2).any(|place| sentence.asks_at_samples(place) && lacks(place))
        {
            return true;
        }
        if event.and_then(|event| sentence.asks_at(event)).is_some_and(lacks) {
            return true;
        }
        if let TraceStepKind::Sample { signal, value: Value::Float(metres) } = &step.what
            && let Some(place) = numbers.iter().position(|number| number == signal)
            && sentence.reads(place)
        {
            (values[place], unseen) = (*metres, Some(step.time));
        }
    }
    unseen.is_some() && (0..2).any(|place| sentence.asks_at_samples(place) && values[place].is_nan())
}

#[test]
fn what_was_not_measured_is_no_pass() {
    let mut dice = Dice(7);
    let (all, each) = (traces() / 4, 2_000);
    let mut lacking = BTreeMap::new();
    for _ in 0..all.div_ceil(each) {
        let sentences: Vec<Sentence> = (0..TOGETHER).map(|n| Sentence::random(&mut dice, n)).collect();
        let texts: Vec<String> = sentences
            .iter()
            .enumerate()
            .map(|(n, s)| format!("require R{n} safety {}", over_numbers(s)))
            .collect();
        let program = program(&texts.join("\n"));
        let named = |name: &str| {
            let at = program.signals.iter().position(|s| s.name == name).unwrap();
            SignalId(at as u16)
        };
        let numbers = [named("far"), named("wide")];
        let empty = Program { monitors: Vec::new(), ..program.clone() };
        let one = |monitor: &Monitor| Program { monitors: vec![monitor.clone()], ..empty.clone() };
        let alone: Vec<Program> = program.monitors.iter().map(one).collect();
        for _ in 0..each {
            let (plain, n) = (trace(&mut dice), dice.below(TOGETHER));
            let (measured, compared) = measured(&mut dice, &plain, numbers);
            let one = &alone[n];
            let (found, expected) = (&verdicts_of(one, &measured)[0], judge(&sentences[n], &compared));
            let unvalued = lacks_value(&sentences[n], &measured, numbers);
            let wanted = match expected.outcome() {
                MonitorOutcome::Pass | MonitorOutcome::Vacuous if unvalued => MonitorOutcome::Inconclusive,
                outcome => outcome,
            };
            let context = format!("{}\n{}\n{measured:?}", texts[n], shown(&compared));
            assert_eq!((found.outcome, found.unvalued.is_some()), (wanted, unvalued), "{context}");
            assert_eq!(found.failures as usize, expected.failures, "{context}");
            *lacking.entry((unvalued, expected.outcome())).or_insert(0_usize) += 1;
        }
    }
    assert_eq!(lacking.len(), 8, "{lacking:?}");
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
