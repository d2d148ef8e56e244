//! The engine against the definitions of `spec/metric.md`, taken word for word, on random formulas and random traces.
//!
//! `HRDSL_SOAK=1 cargo test --workspace --test naive_formulas` tries a million of them; `HRDSL_TRACES` says how many else.

#![allow(clippy::disallowed_methods, reason = "how many traces are tried is told by the environment")]

mod definition;
mod dice;
#[allow(dead_code, reason = "runs as the pages write them are those of other tests")]
mod watched;

use definition::{at, goal_bounds};
use dice::Dice;
use hrdsl_ir::{Nanos, Value, monitor::MonitorOutcome, value::SECOND, world::SignalId};
use hrdsl_metric::{
    CheckedFormula, FutureWindow, MetricEvaluator, MetricFormula, MetricGoal, MetricOutcome, MetricRunner,
    PastWindow, Robustness, SignalPiece, read_formula, robustness_over_time,
};
use hrdsl_trace::{Trace, TraceStep, TraceStepKind};

const ATOMS: usize = 3;

fn value(dice: &mut Dice) -> Robustness {
    let numbers = [-2.0, -1.0, -0.5, 0.0, 0.0, 0.5, 1.0, 3.0, f64::INFINITY, f64::NEG_INFINITY];
    Robustness::of(numbers[dice.below(numbers.len())], dice.below(2) == 0).unwrap()
}

/// Signals from `start` to an end, with pieces of any length.
fn trace(dice: &mut Dice) -> (Vec<Vec<SignalPiece>>, (Nanos, Nanos)) {
    let start = dice.below(4) as Nanos;
    let end = start + dice.below(24) as Nanos;
    let mut signals = Vec::new();
    for _ in 0..ATOMS {
        let mut pieces = vec![SignalPiece { start, value: value(dice) }];
        let mut time = start + 1 + dice.below(4) as Nanos;
        while time <= end {
            pieces.push(SignalPiece { start: time, value: value(dice) });
            time += 1 + [0, 0, 1, 3, 7][dice.below(5)];
        }
        signals.push(pieces);
    }
    (signals, (start, end))
}

fn past(dice: &mut Dice) -> PastWindow {
    let from = [0, 0, 1, 2, 5][dice.below(5)];
    let to = from + [0, 1, 2, 4, 9][dice.below(5)];
    PastWindow::new(from, (dice.below(4) > 0).then_some(to)).unwrap()
}

fn future(dice: &mut Dice) -> FutureWindow {
    let from = [0, 0, 1, 2, 5][dice.below(5)];
    FutureWindow::new(from, from + [0, 1, 2, 4, 9][dice.below(5)]).unwrap()
}

fn formula(dice: &mut Dice, depth: usize) -> MetricFormula {
    let inner = |dice: &mut Dice| Box::new(formula(dice, depth.saturating_sub(1)));
    if depth == 0 {
        return match dice.below(8) {
            0 => MetricFormula::Constant(dice.below(2) == 0),
            _ => MetricFormula::Atom(dice.below(ATOMS)),
        };
    }
    match dice.below(11) {
        0 => MetricFormula::Atom(dice.below(ATOMS)),
        1 => MetricFormula::Not(inner(dice)),
        2 => MetricFormula::And(inner(dice), inner(dice)),
        3 => MetricFormula::Or(inner(dice), inner(dice)),
        4 => MetricFormula::Implies(inner(dice), inner(dice)),
        5 => MetricFormula::Once(past(dice), inner(dice)),
        6 => MetricFormula::Historically(past(dice), inner(dice)),
        7 => MetricFormula::Since(past(dice), inner(dice), inner(dice)),
        8 => MetricFormula::Eventually(future(dice), inner(dice)),
        9 => MetricFormula::Always(future(dice), inner(dice)),
        _ => MetricFormula::Until(future(dice), inner(dice), inner(dice)),
    }
}

fn goal(dice: &mut Dice, depth: usize) -> MetricGoal {
    let inner = |dice: &mut Dice| formula(dice, 2);
    match dice.below(if depth == 0 { 6 } else { 8 }) {
        0 => MetricGoal::Now(inner(dice)),
        1 | 2 => MetricGoal::Always(inner(dice)),
        3 => MetricGoal::Eventually(inner(dice)),
        4 => MetricGoal::Until(inner(dice), inner(dice)),
        5 => MetricGoal::Release(inner(dice), inner(dice)),
        6 => MetricGoal::And(Box::new(goal(dice, depth - 1)), Box::new(goal(dice, depth - 1))),
        _ => MetricGoal::Or(Box::new(goal(dice, depth - 1)), Box::new(goal(dice, depth - 1))),
    }
}

fn held(pieces: &[SignalPiece], time: Nanos) -> Robustness {
    pieces.iter().rev().find(|p| p.start <= time).unwrap().value
}

/// How many traces are tried.
fn traces() -> usize {
    let usual = if std::env::var_os("HRDSL_SOAK").is_some() { 1_000_000 } else { 30_000 };
    std::env::var("HRDSL_TRACES").ok().and_then(|n| n.parse().ok()).unwrap_or(usual)
}

#[test]
fn the_engine_says_at_every_moment_what_the_page_says() {
    let mut dice = Dice(1);
    let mut unknown = 0;
    for _ in 0..traces() {
        let depth = 1 + dice.below(3);
        let (formula, (signals, (start, end))) = (formula(&mut dice, depth), trace(&mut dice));
        let found = robustness_over_time(&formula, &signals, (start, end));
        for time in start..=end {
            for (upper, pieces) in [(false, &found.lower), (true, &found.upper)] {
                let wanted = at(&formula, &signals, (start, end), (time, upper));
                assert_eq!(
                    held(pieces, time),
                    wanted,
                    "{formula:?}\n{signals:?}\nat {time} of {start}..={end}, upper: {upper}"
                );
            }
            unknown += usize::from(held(&found.lower, time) != held(&found.upper, time));
        }
        for pieces in [&found.lower, &found.upper] {
            let is_change =
                |pair: &[SignalPiece]| pair[0].start < pair[1].start && pair[0].value != pair[1].value;
            assert!(pieces.windows(2).all(is_change), "{formula:?}: {pieces:?}");
        }
    }
    assert!(unknown > 1_000, "windows beyond the end leave robustness open: {unknown}");
}

/// What the evaluator finds when it is told changes one by one, and is asked to go on at random times.
fn evaluated(
    dice: &mut Dice,
    goal: &MetricGoal,
    signals: &[Vec<SignalPiece>],
    span: (Nanos, Nanos),
) -> [Robustness; 2] {
    let (start, end) = span;
    let opening: Vec<Robustness> = signals.iter().map(|s| s[0].value).collect();
    let mut evaluator = MetricEvaluator::new(goal, start, &opening);
    for time in start + 1..=end {
        for (atom, pieces) in signals.iter().enumerate() {
            if let Some(piece) = pieces.iter().find(|p| p.start == time) {
                evaluator.change(atom, time, piece.value);
            }
        }
        if dice.below(3) == 0 {
            evaluator.advance_now(time + 1);
        }
    }
    let outcome = evaluator.finish(end);
    let expected = match (outcome.lower.holds(), outcome.upper.holds()) {
        (_, false) => MonitorOutcome::Fail,
        (false, true) => MonitorOutcome::Inconclusive,
        (true, true) if outcome.triggered == 0 => MonitorOutcome::Vacuous,
        (true, true) => MonitorOutcome::Pass,
    };
    assert_eq!(outcome.outcome, expected);
    assert_eq!(outcome.failures > 0, expected == MonitorOutcome::Fail);
    [outcome.lower, outcome.upper]
}

#[test]
fn verdicts_are_those_of_the_page_however_the_run_comes_in() {
    let mut dice = Dice(2);
    let mut met = [0_usize; 4];
    for _ in 0..traces() / 2 {
        let (goal, (signals, span)) = (goal(&mut dice, 2), trace(&mut dice));
        let found = evaluated(&mut dice, &goal, &signals, span);
        let wanted = [false, true].map(|upper| goal_bounds(&goal, &signals, span, upper));
        assert_eq!(found, wanted, "{goal:?}\n{signals:?}\n{span:?}");
        assert!(found[0] <= found[1], "{goal:?}");
        met[usize::from(found[0].holds()) + 2 * usize::from(found[1].holds())] += 1;
        let opposite = goal.clone().negated();
        let found = evaluated(&mut dice, &opposite, &signals, span);
        let wanted = [false, true].map(|upper| goal_bounds(&opposite, &signals, span, upper));
        assert_eq!(found, wanted, "{opposite:?}\n{signals:?}\n{span:?}");
    }
    assert!(met[0] > 0 && met[2] > 0 && met[3] > 0 && met[1] == 0, "{met:?}");
}

#[test]
fn first_failures_are_the_first_moments_that_do_not_hold() {
    let mut dice = Dice(3);
    for _ in 0..traces() / 10 {
        let (body, (signals, (start, end))) = (formula(&mut dice, 2), trace(&mut dice));
        let opening: Vec<Robustness> = signals.iter().map(|s| s[0].value).collect();
        let mut evaluator = MetricEvaluator::new(&MetricGoal::Always(body.clone()), start, &opening);
        for time in start + 1..=end {
            for (atom, pieces) in signals.iter().enumerate() {
                evaluator.change(atom, time, held(pieces, time));
            }
        }
        let outcome = evaluator.finish(end);
        let holds = |time| at(&body, &signals, (start, end), (time, true)).holds();
        assert_eq!(outcome.first_failure, (start..=end).find(|time| !holds(*time)), "{body:?}\n{signals:?}");
        let falls = (start..=end).filter(|t| !holds(*t) && (*t == start || holds(*t - 1))).count();
        assert_eq!(outcome.failures as usize, falls, "{body:?}\n{signals:?}");
    }
}

const COMPARISONS: [&str; 6] = ["x < 1", "x >= 1", "x == y", "x != y", "x + y > 1", "x / y < 1"];

/// What a comparison says of x and y: without a value it holds by no distance if it is `!=`, and else fails so; and whether it has one.
fn compared(text: &str, [x, y]: [f64; 2]) -> (Robustness, bool) {
    let (value, strict, negated, opposite) = match text.trim_matches(['(', ')']) {
        "x < 1" => (1.0 - x, true, false, false),
        "x >= 1" => (x - 1.0, false, false, false),
        "x == y" => ((x - y).abs(), true, false, true),
        "x != y" => ((x - y).abs(), true, true, false),
        "x + y > 1" => (x + y - 1.0, true, false, false),
        "x / y < 1" => (if y == 0.0 { f64::NAN } else { 1.0 - x / y }, true, false, false),
        _ => panic!("{text}"),
    };
    match Robustness::of(value, strict) {
        None => (Robustness::of_truth(negated), false),
        Some(known) => (if opposite { !known } else { known }, true),
    }
}

/// What the formula comes to, of its atoms at the end of each instant.
fn by_atoms(formula: &CheckedFormula, trace: &Trace) -> (MetricOutcome, bool) {
    let atoms: Vec<&str> = (0..).map(|n| formula.atom_text(n)).take_while(|text| *text != "?").collect();
    let reads = |place: u16| formula.signals().contains(&SignalId(place));
    let (mut values, mut evaluator, mut unvalued) = ([None; 2], None, false);
    for (at, step) in trace.steps.iter().enumerate() {
        if let TraceStepKind::Sample { signal: SignalId(place), value: Value::Float(value) } = step.what {
            values[usize::from(place) - 2] = Some(value);
        }
        let is_last = trace.steps.get(at + 1).is_none_or(|next| next.time > step.time);
        let missing = (0..2).any(|n: u16| reads(n + 2) && values[usize::from(n)].is_none());
        if !is_last || missing {
            continue;
        }
        let now = values.map(|value| value.unwrap_or(0.0));
        let readings: Vec<(Robustness, bool)> = atoms.iter().map(|text| compared(text, now)).collect();
        unvalued |= readings.iter().any(|(_, has_value)| !has_value);
        let known: Vec<Robustness> = readings.iter().map(|reading| reading.0).collect();
        let goal = evaluator.get_or_insert_with(|| MetricEvaluator::new(&formula.goal, step.time, &known));
        for (atom, value) in known.iter().enumerate() {
            goal.change(atom, step.time, *value);
        }
    }
    (evaluator.map_or(MetricOutcome::UNSEEN, |goal| goal.finish(trace.end)), unvalued)
}

#[test]
fn what_was_not_measured_is_false_and_no_pass() {
    let (mut dice, program) = (Dice(4), watched::program());
    let mut met = [[0_usize; 4]; 2];
    for _ in 0..traces() / 10 {
        let [a, b] = [(); 2].map(|()| COMPARISONS[dice.below(COMPARISONS.len())]);
        let text = match dice.below(6) {
            0 => format!("always {a}"),
            1 => format!("always not {a}"),
            2 => format!("always ({a} implies eventually[0 s, 2 s] {b})"),
            3 => format!("eventually ({a} and historically[0 s, 1 s] {b})"),
            4 => format!("always ({a} or once[0 s, 3 s] {b})"),
            _ => format!("always (({a}) since[0 s, 2 s] ({b}))"),
        };
        let formula = read_formula(&program, &text).unwrap_or_else(|e| panic!("{text}: {e}"));
        let (mut steps, mut time) = (Vec::new(), 0);
        for _ in 0..dice.below(10) {
            let value = Value::Float([0.0, 0.5, 1.0, 2.0, 2.0, f64::NAN][dice.below(6)]);
            let what = TraceStepKind::Sample { signal: SignalId(2 + dice.below(2) as u16), value };
            steps.push(TraceStep { time, what });
            time += [0, 1, SECOND, 2 * SECOND][dice.below(4)];
        }
        let trace = Trace { steps, end: time };
        let mut runner = MetricRunner::new(&formula);
        trace.replay(&mut runner);
        let (found, (expected, unvalued)) = (runner.outcome(), by_atoms(&formula, &trace));
        let outcome = match expected.outcome {
            MonitorOutcome::Pass | MonitorOutcome::Vacuous if unvalued => MonitorOutcome::Inconclusive,
            outcome => outcome,
        };
        let wanted = MetricOutcome { outcome, unvalued: found.unvalued, ..expected };
        assert_eq!((found, found.unvalued.is_some()), (wanted, unvalued), "{text}\n{trace:?}");
        met[usize::from(unvalued)][expected.outcome as usize] += 1;
    }
    assert!(met.iter().flatten().all(|n| *n > 0), "{met:?}");
}
