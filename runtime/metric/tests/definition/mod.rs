//! The definitions of `spec/metric.md`, moment by moment, as slow as they are.

use hrdsl_ir::Nanos;
use hrdsl_metric::{MetricFormula, MetricGoal, Robustness, SignalPiece};

/// All that a definition speaks of beside the formula and the moment.
#[derive(Clone, Copy)]
struct Run<'a> {
    signals: &'a [Vec<SignalPiece>],
    start: Nanos,
    end: Nanos,
    /// Whether what comes after the end is as good as it can be for the whole.
    upper: bool,
}

fn greatest(values: impl Iterator<Item = Robustness>) -> Robustness {
    values.max().unwrap_or(Robustness::FALSE)
}

fn least(values: impl Iterator<Item = Robustness>) -> Robustness {
    values.min().unwrap_or(Robustness::TRUE)
}

fn rho(formula: &MetricFormula, run: Run<'_>, t: Nanos) -> Robustness {
    use MetricFormula::{
        Always, And, Atom, Constant, Eventually, Historically, Implies, Not, Once, Or, Since, Until,
    };
    let bounds = |w: &hrdsl_metric::PastWindow| {
        let (from, to) = w.bounds();
        (to.map_or(run.start, |to| (t - to).max(run.start)), t - from)
    };
    match formula {
        Constant(truth) => Robustness::of_truth(*truth),
        Atom(_) if t > run.end => Robustness::of_truth(run.upper),
        Atom(n) => run.signals[*n].iter().rev().find(|p| p.start <= t).unwrap().value,
        // What is best for the whole is worst for what it denies.
        Not(a) => !rho(a, Run { upper: !run.upper, ..run }, t),
        And(a, b) => rho(a, run, t).min(rho(b, run, t)),
        Or(a, b) => rho(a, run, t).max(rho(b, run, t)),
        Implies(a, b) => (!rho(a, Run { upper: !run.upper, ..run }, t)).max(rho(b, run, t)),
        Once(w, a) => {
            let (first, last) = bounds(w);
            greatest((first..=last).map(|s| rho(a, run, s)))
        }
        Historically(w, a) => {
            let (first, last) = bounds(w);
            least((first..=last).map(|s| rho(a, run, s)))
        }
        Since(w, a, b) => {
            let (first, last) = bounds(w);
            greatest((first..=last).map(|s| rho(b, run, s).min(least((s + 1..=t).map(|u| rho(a, run, u))))))
        }
        Eventually(w, a) => {
            let (from, to) = w.bounds();
            greatest((t + from..=t + to).map(|s| rho(a, run, s)))
        }
        Always(w, a) => {
            let (from, to) = w.bounds();
            least((t + from..=t + to).map(|s| rho(a, run, s)))
        }
        Until(w, a, b) => {
            let (from, to) = w.bounds();
            greatest((t + from..=t + to).map(|s| rho(b, run, s).min(least((t..s).map(|u| rho(a, run, u))))))
        }
    }
}

/// The bound of a formula's robustness at a moment.
pub fn at(
    formula: &MetricFormula,
    signals: &[Vec<SignalPiece>],
    (start, end): (Nanos, Nanos),
    (time, upper): (Nanos, bool),
) -> Robustness {
    rho(formula, Run { signals, start, end, upper }, time)
}

/// The bound of a goal's robustness.
pub fn goal_bounds(
    goal: &MetricGoal,
    signals: &[Vec<SignalPiece>],
    span: (Nanos, Nanos),
    upper: bool,
) -> Robustness {
    let (start, end) = span;
    let run = Run { signals, start, end, upper };
    let moments = || start..=end;
    // φ at all moments before s, and ψ at s.
    let until = |a: &dyn Fn(Nanos) -> Robustness, b: &dyn Fn(Nanos) -> Robustness| {
        greatest(moments().map(|s| b(s).min(least((start..s).map(a)))))
    };
    match goal {
        MetricGoal::And(a, b) => {
            goal_bounds(a, signals, span, upper).min(goal_bounds(b, signals, span, upper))
        }
        MetricGoal::Or(a, b) => {
            goal_bounds(a, signals, span, upper).max(goal_bounds(b, signals, span, upper))
        }
        MetricGoal::Now(a) => rho(a, run, start),
        MetricGoal::Always(a) => least(moments().map(|t| rho(a, run, t))),
        MetricGoal::Eventually(_) if upper => Robustness::TRUE,
        MetricGoal::Eventually(a) => greatest(moments().map(|t| rho(a, run, t))),
        MetricGoal::Until(a, b) => {
            let reached = until(&|t| rho(a, run, t), &|t| rho(b, run, t));
            // It may still come, as long as the first holds.
            if upper { reached.max(least(moments().map(|t| rho(a, run, t)))) } else { reached }
        }
        MetricGoal::Release(a, b) => !until(&|t| !rho(a, run, t), &|t| !rho(b, run, t)),
    }
}
