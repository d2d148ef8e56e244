//! Formulas as requirements: what is written in a scenario, the same text on the command line, and the definitions of `spec/metric.md` judge random
//! traces alike, as they come and from a recording.
//!
//! `HRDSL_SOAK=1 cargo test --workspace --test formula_requirements` tries thirty times as many.

#![allow(
    clippy::disallowed_methods,
    reason = "the test reads the page, and the environment says how many traces are tried"
)]

#[path = "../../runtime/metric/tests/definition/mod.rs"]
#[allow(dead_code, reason = "another test asks it of single moments")]
mod definition;
#[path = "../../runtime/metric/tests/dice/mod.rs"]
mod dice;
#[path = "../../runtime/metric/tests/watched/mod.rs"]
#[allow(dead_code, reason = "another test has its program without a compiler")]
mod watched;

use std::path::Path;

use definition::goal_bounds;
use dice::Dice;
use hrdsl_compiler::{
    InputFile, compile,
    reading::{RequirementReading, readings},
};
use hrdsl_ir::{
    EventId, Nanos, Program, Value,
    formula::{MetricFormula, MetricGoal},
    world::SignalId,
};
use hrdsl_metric::{
    CheckedFormula, FormulaSpan, FormulaStory, MetricRunner, Robustness, SignalPiece, read_formula,
};
use hrdsl_monitor::{MonitorOutcome, MonitorRunner, MonitorVerdict};
use hrdsl_runtime::{conformance::ConformanceOptions, judge::judge_recording, results::VerdictOutcome};
use hrdsl_trace::{
    RunEnd, Trace, TraceStep, TraceStepKind,
    record::{self, RecordingEnd, RecordingHeader},
};

/// Signals `x` and `y`, numbers, and `p` and `q`, truths; events `a` and `b`.
const SCENARIO: &str = "scenario many
actor robot : system
actor guest : environment
event a, b from robot
event asked from guest
world {
  body one: fixed box(1 m, 1 m, 1 m) at (0 m, 0 m, 0 m)
  signal x: length to robot = one.x
  signal y: length to robot = one.y
  signal p: bool to robot = one.z > 0 m
  signal q: bool to robot = one.z > 1 m
}
";

/// A formula's atoms, as they are written here and on the command line.
const ATOMS: [&str; 8] = ["x < 2 m", "y >= 1 m", "x + y > 3 m", "x - y == 0 m", "p", "q", "a", "b"];

fn window(dice: &mut Dice) -> String {
    let from = [0_usize, 0, 1, 2, 5][dice.below(5)];
    let least = usize::from(from == 0);
    let to = from + least + [0, 0, 1, 3, 8][dice.below(5)];
    format!("[{from} ns, {to} ns]")
}

/// Past windows may be left out.
fn past(dice: &mut Dice) -> String {
    if dice.below(4) == 0 { String::new() } else { window(dice) }
}

/// The text of a formula that is asked of every moment, in parentheses unless it is an atom.
fn formula(dice: &mut Dice, depth: usize) -> String {
    if depth == 0 || dice.below(8) == 0 {
        return match dice.below(20) {
            0 => "true".to_owned(),
            1 => "false".to_owned(),
            _ => ATOMS[dice.below(ATOMS.len())].to_owned(),
        };
    }
    let one = formula(dice, depth - 1);
    let of = |dice: &mut Dice| formula(dice, depth - 1);
    match dice.below(10) {
        0 => format!("(not {one})"),
        1 => format!("({one} and {})", of(dice)),
        2 => format!("({one} or {})", of(dice)),
        3 => format!("({one} implies {})", of(dice)),
        4 => format!("(once{} {one})", past(dice)),
        5 => format!("(historically{} {one})", past(dice)),
        6 => format!("({one} since{} {})", past(dice), of(dice)),
        7 => format!("(eventually{} {one})", window(dice)),
        8 => format!("(always{} {one})", window(dice)),
        _ => format!("({one} until{} {})", window(dice), of(dice)),
    }
}

fn goal(dice: &mut Dice, depth: usize) -> String {
    let one = formula(dice, 2);
    match dice.below(if depth == 0 { 7 } else { 10 }) {
        0 => one,
        1 => format!("always {one}"),
        2 => format!("always ({one} implies {})", formula(dice, 2)),
        3 => format!("eventually {one}"),
        4 => format!("{one} until {}", formula(dice, 2)),
        5 => format!("not ({one} until {})", formula(dice, 2)),
        6 => format!("not eventually {one}"),
        7 => format!("({}) and ({})", goal(dice, depth - 1), goal(dice, depth - 1)),
        8 => format!("({}) or ({})", goal(dice, depth - 1), goal(dice, depth - 1)),
        _ => format!("({}) implies ({})", goal(dice, depth - 1), goal(dice, depth - 1)),
    }
}

/// A scenario with these formulas as requirements.
fn program(formulas: &[String]) -> Program {
    read_out(formulas).0
}

/// The same, with what is said of each in English.
fn read_out(formulas: &[String]) -> (Program, Vec<RequirementReading>) {
    let mut text = SCENARIO.to_owned();
    for (number, formula) in formulas.iter().enumerate() {
        text += &format!("require R{number} functional formula {formula}\n");
    }
    let compiled = compile(InputFile { name: "many.hri", text: &text }, &[]);
    let readings = compiled.scenario.as_ref().map(|s| readings(s, &compiled.files)).unwrap_or_default();
    (compiled.program.unwrap_or_else(|| panic!("{text}{:#?}", compiled.diagnostics)), readings)
}

fn named(program: &Program, name: &str) -> SignalId {
    let place = program.signals.iter().position(|s| s.name == name).unwrap();
    SignalId(u16::try_from(place).unwrap())
}

/// Numbers, truths and events; many at the same instant, some signals without a value for a while, or always.
fn trace(dice: &mut Dice, program: &Program) -> Trace {
    let (mut steps, mut time) = (Vec::new(), 0);
    let signal = ["x", "y", "p", "q"].map(|name| named(program, name));
    let sample = |dice: &mut Dice, place: usize| {
        let value = if place < 2 {
            Value::Float([0.0, 0.5, 1.0, 1.5, 2.0, 3.0][dice.below(6)])
        } else {
            Value::Bool(dice.below(2) == 0)
        };
        TraceStepKind::Sample { signal: signal[place], value }
    };
    let late = dice.below(6) == 0;
    for place in 0..4 {
        if !late || dice.below(2) == 0 {
            steps.push(TraceStep { time, what: sample(dice, place) });
        }
    }
    for _ in 0..dice.below(24) {
        time += [0, 0, 1, 1, 2, 3, 6][dice.below(7)];
        let what = if dice.below(3) == 0 {
            let event = program.event_named(["a", "b"][dice.below(2)]).unwrap();
            TraceStepKind::Event { event, args: Vec::new() }
        } else {
            let place = dice.below(4);
            sample(dice, place)
        };
        steps.push(TraceStep { time, what });
    }
    Trace { steps, end: time + [0, 1, 4][dice.below(3)] }
}

/// Numbers and truths of the signals at a moment; the last of several samples at one instant counts.
fn at(trace: &Trace, signal: SignalId, time: Nanos) -> Option<Value> {
    trace.steps.iter().filter(|step| step.time <= time).rev().find_map(|step| match &step.what {
        TraceStepKind::Sample { signal: of, value } if *of == signal => Some(*value),
        TraceStepKind::Sample { .. } | TraceStepKind::Event { .. } | TraceStepKind::Machine(_) => None,
    })
}

/// What an atom is at a moment, word for word from the page.
fn atom(program: &Program, trace: &Trace, which: usize, time: Nanos) -> Option<Robustness> {
    let number = |name| at(trace, named(program, name), time).and_then(|v| v.as_f64());
    let truth = |name| at(trace, named(program, name), time).and_then(|v| v.as_bool());
    let happens = |event: EventId| {
        trace.steps.iter().any(|step| {
            step.time == time && matches!(&step.what, TraceStepKind::Event { event: e, .. } if *e == event)
        })
    };
    match which {
        0 => Robustness::of(2.0 - number("x")?, true),
        1 => Robustness::of(number("y")? - 1.0, false),
        2 => Robustness::of(number("x")? + number("y")? - 3.0, true),
        3 => Some(!Robustness::of((number("x")? - number("y")?).abs(), true)?),
        4 => Some(Robustness::of_truth(truth("p")?)),
        5 => Some(Robustness::of_truth(truth("q")?)),
        6 => Some(Robustness::of_truth(happens(program.event_named("a").unwrap()))),
        _ => Some(Robustness::of_truth(happens(program.event_named("b").unwrap()))),
    }
}

/// An atom is written with the parentheses around it.
fn without_parentheses(atom: &str) -> &str {
    atom.trim_start_matches('(').trim_end_matches(')')
}

/// The bounds that the page gives a formula, whose atoms are these; `None`: it has no first moment.
fn bounds(program: &Program, trace: &Trace, text: &str) -> Option<[Robustness; 2]> {
    let checked = read_formula(program, text).unwrap_or_else(|e| panic!("{text}: {e}"));
    let order: Vec<usize> = (0..)
        .map_while(|n| ATOMS.iter().position(|atom| *atom == without_parentheses(checked.atom_text(n))))
        .collect();
    let is_known = |time: &Nanos| checked.signals().iter().all(|s| at(trace, *s, *time).is_some());
    let start = (0..=trace.end).find(is_known)?;
    let pieces = |which: usize| {
        let mut pieces: Vec<SignalPiece> = Vec::new();
        for time in start..=trace.end {
            let value = atom(program, trace, which, time).unwrap();
            if pieces.last().is_none_or(|last| last.value != value) {
                pieces.push(SignalPiece { start: time, value });
            }
        }
        pieces
    };
    let signals: Vec<Vec<SignalPiece>> = order.into_iter().map(pieces).collect();
    Some([false, true].map(|upper| goal_bounds(&checked.goal, &signals, (start, trace.end), upper)))
}

fn recording(program: &Program, trace: &Trace) -> String {
    record::write(
        program,
        &RecordingHeader::of(program),
        trace,
        &RecordingEnd { kind: RunEnd::Quiescent, error: None },
    )
}

/// What is told alike of a requirement and of a formula of the command line.
type ToldVerdict = (MonitorOutcome, u32, u32, Option<Nanos>, Option<u64>);

fn on_the_command_line(program: &Program, trace: &Trace, text: &str) -> ToldVerdict {
    let formula = read_formula(program, text).unwrap();
    let mut runner = MetricRunner::new(&formula);
    trace.replay(&mut runner);
    let found = runner.outcome();
    let margin = found.margin().filter(|_| formula.unit.is_some()).map(f64::to_bits);
    (found.outcome, found.triggered, found.failures, found.first_failure, margin)
}

fn told(verdict: &MonitorVerdict) -> ToldVerdict {
    let first = verdict.first_failure.as_ref().map(|failure| failure.time);
    let margin = verdict.worst_margin.map(|(margin, _)| margin.to_bits());
    (verdict.outcome, verdict.triggered, verdict.failures, first, margin)
}

fn outcome(lower: Robustness, upper: Robustness, triggered: u32) -> MonitorOutcome {
    match (lower.holds(), upper.holds()) {
        (_, false) => MonitorOutcome::Fail,
        (false, true) => MonitorOutcome::Inconclusive,
        (true, true) if triggered == 0 => MonitorOutcome::Vacuous,
        (true, true) => MonitorOutcome::Pass,
    }
}

fn result_of(outcome: MonitorOutcome) -> VerdictOutcome {
    match outcome {
        MonitorOutcome::Pass => VerdictOutcome::Pass,
        MonitorOutcome::Fail => VerdictOutcome::Fail,
        MonitorOutcome::Vacuous => VerdictOutcome::Vacuous,
        MonitorOutcome::Inconclusive => VerdictOutcome::Inconclusive,
    }
}

#[test]
fn a_requirement_is_judged_as_its_formula_is_defined() {
    let rounds = if std::env::var_os("HRDSL_SOAK").is_some() { 300 } else { 10 };
    let mut dice = Dice(7);
    let mut met = [0_usize; 4];
    for _ in 0..rounds {
        let formulas: Vec<String> = (0..40).map(|_| goal(&mut dice, 1)).collect();
        let (program, readings) = read_out(&formulas);
        for _ in 0..20 {
            let trace = trace(&mut dice, &program);
            let mut runner = MonitorRunner::new(&program);
            trace.replay(&mut runner);
            let online = runner.verdicts();
            let text = recording(&program, &trace);
            let judged =
                judge_recording(&program, text.as_bytes(), false, &ConformanceOptions::default()).unwrap();
            for ((text, verdict), offline) in formulas.iter().zip(&online).zip(&judged.judgement.verdicts) {
                let shown = || format!("{text}\n{trace:?}");
                assert_eq!(told(verdict), on_the_command_line(&program, &trace, text), "{}", shown());
                let wanted = match bounds(&program, &trace, text) {
                    Some([lower, upper]) => outcome(lower, upper, verdict.triggered),
                    None => MonitorOutcome::Vacuous,
                };
                assert_eq!(verdict.outcome, wanted, "{}", shown());
                assert_eq!(offline.outcome, result_of(wanted), "{}", shown());
                let failure = verdict.first_failure.as_ref();
                let steps = failure.map(|f| f.counterexample.iter().map(|s| s.index).collect::<Vec<_>>());
                let told = offline.failure.as_ref();
                let recorded = told.map(|f| f.counterexample.iter().map(|s| s.step).collect::<Vec<_>>());
                assert_eq!(recorded, steps, "{}", shown());
                met[wanted as usize] += 1;
                let reading = &readings[verdict.monitor];
                let told = match wanted {
                    MonitorOutcome::Pass => reading.pass.is_some(),
                    MonitorOutcome::Fail => reading.fail.is_some(),
                    MonitorOutcome::Vacuous => reading.vacuous.is_some(),
                    MonitorOutcome::Inconclusive => reading.inconclusive.is_some(),
                };
                assert!(told, "{wanted}, which it cannot be: {reading:?}\n{}", shown());
            }
        }
    }
    assert!(met.iter().all(|n| *n > 100), "{met:?}");
}

/// Whether a goal has an alternative, of which only the first violation is told.
fn has_alternatives(goal: &MetricGoal) -> bool {
    match goal {
        MetricGoal::And(a, b) => has_alternatives(a) || has_alternatives(b),
        other => matches!(other, MetricGoal::Or(..)),
    }
}

fn story(formula: &CheckedFormula, trace: &Trace) -> FormulaStory {
    let mut runner = MetricRunner::new(formula).taping();
    trace.replay(&mut runner);
    runner.tape().map(|atoms| FormulaStory::of(&formula.goal, &atoms)).unwrap_or_default()
}

/// All violations of a formula are told, and of each time that it was asked what came of it, and no later than when that is certain.
#[test]
fn the_story_of_a_formula_has_all_its_violations() {
    let mut dice = Dice(23);
    let program = program(&[]);
    let mut met = [0_usize; 4];
    for round in 0..1_500 {
        let text = match round % 3 {
            0 => goal(&mut dice, 1),
            _ => format!("always ({} implies {})", formula(&mut dice, 1), formula(&mut dice, 2)),
        };
        let trace = trace(&mut dice, &program);
        let formula = read_formula(&program, &text).unwrap_or_else(|e| panic!("{text}: {e}"));
        let mut runner = MetricRunner::new(&formula);
        trace.replay(&mut runner);
        let (outcome, told) = (runner.outcome(), story(&formula, &trace));
        let shown = || format!("{text}\n{told:?}\n{trace:?}");
        if !has_alternatives(&formula.goal) {
            assert_eq!(told.violated.len(), usize::try_from(outcome.failures).unwrap(), "{}", shown());
        }
        assert_eq!(told.violated.first().map(|span| span.from), outcome.first_failure, "{}", shown());
        assert!(told.violated.iter().all(|span| span.from < span.until), "{}", shown());
        let MetricGoal::Always(MetricFormula::Implies(..)) = formula.goal else { continue };
        assert_eq!(told.asked.len(), usize::try_from(outcome.triggered).unwrap(), "{}", shown());
        for asked in &told.asked {
            let is_in = |span: &FormulaSpan| span.from < asked.span.until && asked.span.from < span.until;
            assert_eq!(asked.kept == Some(false), told.violated.iter().any(is_in), "{}", shown());
            met[asked.kept.map_or(0, |kept| 1 + usize::from(kept))] += 1;
            if asked.kept.is_none() || asked.known > trace.end {
                continue;
            }
            let steps = trace.steps.iter().filter(|step| step.time <= asked.known).cloned().collect();
            let earlier = story(&formula, &Trace { steps, end: asked.known });
            let same = earlier.asked.iter().find(|other| other.span.from == asked.span.from);
            assert_eq!(same.and_then(|same| same.kept), asked.kept, "{}", shown());
            met[3] += usize::from(asked.due.is_some_and(|due| asked.known < due));
        }
    }
    assert!(met.iter().all(|n| *n > 50), "{met:?}");
}

/// Long traces: what is kept of them for the counterexample is dropped in between, and the first failure is that of all.
#[test]
fn the_counterexample_is_what_the_formula_read() {
    let mut dice = Dice(11);
    let texts = [
        "always (p implies eventually[0 ns, 40 ns] a)",
        "(always x < 3 m) and always (q implies always[0 ns, 900 ns] y < 3 m)",
    ];
    let texts = texts.map(str::to_owned);
    let program = program(&texts);
    for _ in 0..20 {
        let mut long = Trace::default();
        let lift = dice.below(9_000) as Nanos;
        while long.end < 10_000 {
            let mut part = trace(&mut dice, &program);
            part.steps.iter_mut().for_each(|step| step.time += long.end);
            // Violations come late, if at all.
            part.steps.retain(|step| match &step.what {
                TraceStepKind::Sample { value, .. } => {
                    long.end > lift || !matches!(value, Value::Bool(true)) && value.as_f64() != Some(3.0)
                }
                TraceStepKind::Event { .. } | TraceStepKind::Machine(_) => true,
            });
            let end = long.end + part.end;
            long.steps.append(&mut part.steps);
            long.end = end;
        }
        let mut runner = MonitorRunner::new(&program);
        long.replay(&mut runner);
        for (verdict, text) in runner.verdicts().iter().zip(&texts) {
            let Some(failure) = &verdict.first_failure else { continue };
            let formula = read_formula(&program, text).unwrap();
            let reads = |what: &TraceStepKind| match what {
                TraceStepKind::Sample { signal, .. } => formula.signals().contains(signal),
                TraceStepKind::Event { event, args } => formula.events().any(|p| p.matches(*event, args)),
                TraceStepKind::Machine(_) => false,
            };
            let steps =
                long.steps.iter().enumerate().filter(|(_, s)| s.time <= failure.time && reads(&s.what));
            let mut wanted: Vec<usize> = Vec::new();
            for (index, step) in steps {
                let replaced = |known: &usize| match (&long.steps[*known].what, &step.what) {
                    (TraceStepKind::Sample { signal: a, .. }, TraceStepKind::Sample { signal: b, .. }) => {
                        a == b
                    }
                    _ => false,
                };
                wanted.retain(|known| !replaced(known));
                if matches!(step.what, TraceStepKind::Sample { .. }) || step.time == failure.time {
                    wanted.push(index);
                }
            }
            let found: Vec<usize> = failure.counterexample.iter().map(|s| s.index).collect();
            assert_eq!(found, wanted, "{text}");
        }
    }
}

/// The signals and events of the runs on the page, in their order.
const WATCHED: &str = "scenario watched
actor robot : system
event a, b, c, d from robot
world {
  body one: fixed box(1 m, 1 m, 1 m) at (0 m, 0 m, 0 m)
  signal p: bool to robot = one.z > 0 m
  signal q: bool to robot = one.z > 1 m
  signal x: float to robot = one.x / 1 m
  signal y: float to robot = one.y / 1 m
}
";

#[test]
fn the_runs_on_the_page_have_their_verdicts_as_requirements() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../spec/metric.md");
    let page = std::fs::read_to_string(page).unwrap();
    let table = page.split("| formula | run | verdict | margin |").nth(1).expect("the table of runs");
    let (mut rows, mut formula) = (0, String::new());
    for line in table.lines().skip(2).take_while(|line| line.starts_with('|')) {
        let cells: Vec<&str> =
            line.trim_matches('|').split('|').map(|c| c.trim().trim_matches('`')).collect();
        let [text, run, verdict, margin] = cells.as_slice() else { panic!("{line}") };
        if !text.is_empty() {
            formula = (*text).to_owned();
        }
        let text = format!("{WATCHED}require R1 functional formula {formula}\n");
        let compiled = compile(InputFile { name: "watched.hri", text: &text }, &[]);
        let program = compiled.program.unwrap_or_else(|| panic!("{text}{:#?}", compiled.diagnostics));
        let mut runner = MonitorRunner::new(&program);
        watched::run(run).replay(&mut runner);
        let found = runner.verdicts().remove(0);
        let number = found.worst_margin.map(|(n, _)| n.to_string()).unwrap_or_default();
        assert_eq!(
            (found.outcome.to_string().as_str(), number.as_str()),
            (*verdict, *margin),
            "{formula}: {run}"
        );
        rows += 1;
    }
    assert!(rows >= 30, "{rows}");
}

/// An event of an edge is the instant at which a condition gets the other truth.
#[test]
fn edges_of_conditions_are_events() {
    let formulas =
        ["always (rising(p) implies x < 2 m)", "always (falling(x < 2 m) implies once[0 ns, 5 ns] a)"];
    let program = program(&formulas.map(str::to_owned));
    let sample = |time, name, value| TraceStep {
        time,
        what: TraceStepKind::Sample { signal: named(&program, name), value },
    };
    let judge = |steps: Vec<TraceStep>| {
        let mut runner = MonitorRunner::new(&program);
        Trace { steps, end: 50 }.replay(&mut runner);
        runner
            .verdicts()
            .iter()
            .map(|v| (v.outcome, v.first_failure.as_ref().map(|f| f.time)))
            .collect::<Vec<_>>()
    };
    let (no, yes, near, far) = (Value::Bool(false), Value::Bool(true), Value::Float(1.0), Value::Float(2.0));
    let held = judge(vec![sample(0, "p", yes), sample(0, "x", far)]);
    assert_eq!(held, [(MonitorOutcome::Vacuous, None), (MonitorOutcome::Vacuous, None)], "from the start");
    let fails =
        judge(vec![sample(0, "p", no), sample(0, "x", near), sample(7, "p", yes), sample(7, "x", far)]);
    assert_eq!(fails, [(MonitorOutcome::Fail, Some(7)), (MonitorOutcome::Fail, Some(7))]);
    let holds =
        judge(vec![sample(0, "p", no), sample(0, "x", near), sample(7, "p", yes), sample(9, "p", no)]);
    assert_eq!(holds[0], (MonitorOutcome::Pass, None));
}
