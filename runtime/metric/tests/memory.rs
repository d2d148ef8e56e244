//! The memory of an evaluator is that of its windows: a run that is ten times as long takes no more.

mod dice;

use dice::Dice;
use hrdsl_ir::{Nanos, value::SECOND};
use hrdsl_metric::{FutureWindow, MetricEvaluator, MetricFormula, MetricGoal, PastWindow, Robustness};

/// The most bytes that there were at once, for so many samples at irregular times.
fn most_bytes(goal: &MetricGoal, samples: usize) -> u64 {
    let run = || {
        let mut dice = Dice(5);
        let value = |dice: &mut Dice| Robustness::of(dice.below(1_000) as f64 - 100.0, true).unwrap();
        let mut evaluator = MetricEvaluator::new(goal, 0, &[Robustness::TRUE, Robustness::FALSE]);
        let mut time = 0;
        for _ in 0..samples {
            time += (1 + dice.below(1_000)) as Nanos * (SECOND / 1_000);
            evaluator.change(0, time, value(&mut dice));
            evaluator.change(1, time, value(&mut dice));
            evaluator.advance(time + 1);
        }
        std::hint::black_box(evaluator.finish(time));
    };
    allocation_counter::measure(run).bytes_max
}

#[test]
fn memory_does_not_grow_with_the_run() {
    let atom = |n| Box::new(MetricFormula::Atom(n));
    let past =
        |from: Nanos, to: Option<Nanos>| PastWindow::new(from * SECOND, to.map(|to| to * SECOND)).unwrap();
    let future = FutureWindow::new(SECOND, 100 * SECOND).unwrap();
    let always = MetricGoal::Always;
    for goal in [
        always(*atom(0)),
        always(MetricFormula::Once(past(1, Some(100)), atom(0))),
        always(MetricFormula::Historically(past(0, None), atom(0))),
        always(MetricFormula::Since(past(1, Some(100)), atom(0), atom(1))),
        always(MetricFormula::Since(past(0, None), atom(0), atom(1))),
        always(MetricFormula::Until(future, atom(0), atom(1))),
        always(MetricFormula::Implies(atom(0), Box::new(MetricFormula::Eventually(future, atom(1))))),
        MetricGoal::Until(*atom(0), MetricFormula::Always(future, atom(1))),
    ] {
        let (short, long) = (most_bytes(&goal, 20_000), most_bytes(&goal, 200_000));
        assert!(long <= short + short / 2, "{goal:?}: {short} bytes, and then {long}");
    }
}

#[test]
fn memory_grows_with_the_window_alone() {
    let of = |seconds: Nanos| {
        let window = PastWindow::new(0, Some(seconds * SECOND)).unwrap();
        let [a, b] = [0, 1].map(|n| Box::new(MetricFormula::Atom(n)));
        most_bytes(&MetricGoal::Always(MetricFormula::Since(window, a, b)), 100_000)
    };
    let (short, long) = (of(100), of(10_000));
    assert!(long > 10 * short, "the measure sees what there is: {short} bytes, and {long}");
}
