//! Samples a second of processor time, from numbers to the verdict, of formulas over regular and irregular times, as they come in: one change after the other.
//!
//! `cargo bench -p hrdsl-metric --bench formulas -- [NAME] [--samples N]`

#![allow(clippy::disallowed_methods, reason = "a bench reads what its process takes")]

#[path = "../tests/dice/mod.rs"]
mod dice;

use dice::Dice;
use hrdsl_ir::{Nanos, value::SECOND};
use hrdsl_metric::{
    FutureWindow, MetricEvaluator, MetricFormula, MetricGoal, MetricOutcome, PastWindow, Robustness,
};

/// So often each is measured; the best counts, as other processes only slow it down.
const ROUNDS: usize = 7;

/// Times and the numbers of two signals.
struct Samples {
    times: Vec<Nanos>,
    a: Vec<f64>,
    b: Vec<f64>,
}

/// Samples each second, or after a hundredth of a second up to two.
fn samples(count: usize, is_regular: bool) -> Samples {
    let mut dice = Dice(7);
    let mut samples = Samples { times: Vec::new(), a: Vec::new(), b: Vec::new() };
    let mut time = 0;
    let number = |dice: &mut Dice| dice.below(2_000_000) as f64 / 1e6 - 1.0;
    for _ in 0..count {
        samples.times.push(time);
        samples.a.push(number(&mut dice));
        samples.b.push(number(&mut dice));
        time += if is_regular { SECOND } else { (1 + dice.below(200)) as Nanos * (SECOND / 100) };
    }
    samples
}

/// Whether a < 0.9, and b < 0.9, moment by moment, to the verdict.
fn judged(goal: &MetricGoal, samples: &Samples, atoms: usize) -> MetricOutcome {
    let atom = |x: f64| Robustness::of(0.9 - x, true).unwrap_or(Robustness::FALSE);
    let first = [atom(samples.a[0]), atom(samples.b[0])];
    let mut evaluator = MetricEvaluator::new(goal, samples.times[0], &first[..atoms]);
    for (index, &time) in samples.times.iter().enumerate().skip(1) {
        evaluator.change(0, time, atom(samples.a[index]));
        if atoms > 1 {
            evaluator.change(1, time, atom(samples.b[index]));
        }
        evaluator.advance(time + 1);
    }
    evaluator.finish(samples.times[samples.times.len() - 1])
}

/// Seconds that this process, which has one thread, has been on a processor.
fn processor_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/schedstat").unwrap_or_default();
    text.split_whitespace().next().and_then(|t| t.parse::<f64>().ok()).unwrap_or(0.0) / 1e9
}

/// Name, goal, its atoms, whether the times are regular.
type Row = (String, MetricGoal, usize, bool);

fn rows() -> Vec<Row> {
    let atom = |n| Box::new(MetricFormula::Atom(n));
    let past = |from: Nanos, to: Nanos| PastWindow::new(from * SECOND, Some(to * SECOND)).unwrap();
    let future = |from: Nanos, to: Nanos| FutureWindow::new(from * SECOND, to * SECOND).unwrap();
    let response = |to| {
        let eventually = MetricFormula::Eventually(future(0, to), atom(1));
        MetricGoal::Always(MetricFormula::Implies(atom(0), Box::new(eventually)))
    };
    let always = MetricGoal::Always;
    let mut rows: Vec<Row> = Vec::new();
    for is_regular in [true, false] {
        let times = if is_regular { "regular" } else { "irregular" };
        let mut add =
            |name: &str, goal, atoms| rows.push((format!("{name}, {times}"), goal, atoms, is_regular));
        add("G (a < c)", always(*atom(0)), 1);
        add("G (a -> F[0,10] b)", response(10), 2);
        for to in [10, 1_000, 100_000] {
            add(&format!("G once[0,{to}] a"), always(MetricFormula::Once(past(0, to), atom(0))), 1);
            add(
                &format!("G historically[2,{to}] a"),
                always(MetricFormula::Historically(past(2, to), atom(0))),
                1,
            );
            add(&format!("G F[2,{to}] a"), always(MetricFormula::Eventually(future(2, to), atom(0))), 1);
            add(
                &format!("G (a since[0,{to}] b)"),
                always(MetricFormula::Since(past(0, to), atom(0), atom(1))),
                2,
            );
            add(
                &format!("G (a since[2,{to}] b)"),
                always(MetricFormula::Since(past(2, to), atom(0), atom(1))),
                2,
            );
            add(
                &format!("G (a U[0,{to}] b)"),
                always(MetricFormula::Until(future(0, to), atom(0), atom(1))),
                2,
            );
            add(
                &format!("G (a U[2,{to}] b)"),
                always(MetricFormula::Until(future(2, to), atom(0), atom(1))),
                2,
            );
        }
    }
    rows
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let after = args.iter().position(|a| a == "--samples").and_then(|i| args.get(i + 1));
    let count = after.and_then(|n| n.parse().ok()).unwrap_or(2_000_000);
    let wanted = args.first().filter(|a| !a.starts_with("--"));
    let (regular, irregular) = (samples(count, true), samples(count, false));
    for (name, goal, atoms, is_regular) in rows() {
        if wanted.is_some_and(|w| !name.contains(w.as_str())) {
            continue;
        }
        let samples = if is_regular { &regular } else { &irregular };
        let mut best = f64::INFINITY;
        for _ in 0..ROUNDS {
            let before = processor_seconds();
            std::hint::black_box(judged(&goal, samples, atoms));
            best = best.min(processor_seconds() - before);
        }
        let rate = count as f64 / best / 1e6;
        println!("{name:<40} {rate:>8.1} million samples a second");
    }
}
