//! Runs with as few transitions as any, and runs that end as early as any.

mod common;

use common::asked::{ask_with, at, model, x};
use common::{add, automaton, clock, edge, location, normal, program};
use hrdsl_ir::{
    suite::{DelayChoice, WitnessKind},
    ta::{ClockOp, LocationId, LocationKind, QueryFormula, QueryKind},
    value::SECOND,
};
use hrdsl_ta::{QueryOptions, RunEnding};

#[test]
fn the_fastest_way_may_have_more_transitions() {
    let mut p = program();
    let mut m = automaton("M", &["x"]);
    let l: Vec<LocationId> = ["a", "b", "c", "d"].map(|s| normal(&mut m, s)).into();
    edge(l[0], l[3]).clock(0, ClockOp::Ge, 10).to(&mut m);
    edge(l[0], l[1]).clock(0, ClockOp::Gt, 1).to(&mut m);
    edge(l[1], l[2]).clock(0, ClockOp::Gt, 1).to(&mut m);
    edge(l[2], l[3]).clock(0, ClockOp::Ge, 3).to(&mut m);
    add(&mut p, m);
    let go = |witness, delays, seed| {
        let options = QueryOptions { witness, delays, seed, ..QueryOptions::default() };
        let run = ask_with(&p, QueryKind::Possibly(at(0, l[3])), &options).run.unwrap();
        (run.steps.len(), run.end, run.steps.iter().map(|s| s.time).collect::<Vec<_>>())
    };
    let short = go(WitnessKind::Shortest, DelayChoice::Earliest, 0);
    assert_eq!((short.0, short.1), (1, 10 * SECOND));
    let fast = go(WitnessKind::Fastest, DelayChoice::Earliest, 0);
    assert_eq!((fast.0, fast.1), (3, 3 * SECOND));
    let late = go(WitnessKind::Fastest, DelayChoice::Latest, 0);
    assert_eq!(late.2, [3 * SECOND; 3]);
    let drawn: Vec<Vec<i64>> = (0..8).map(|s| go(WitnessKind::Fastest, DelayChoice::Sampled, s).2).collect();
    assert!(drawn.iter().all(|t| t[2] == 3 * SECOND && t[0] > SECOND && t[0] <= t[1]));
    assert!(drawn.iter().any(|t| t != &drawn[0]));
    assert_eq!(drawn[3], go(WitnessKind::Fastest, DelayChoice::Sampled, 3).2);
    // A goal with a clock: time passes after the last transition.
    let options = QueryOptions { witness: WitnessKind::Fastest, ..QueryOptions::default() };
    let f = QueryFormula::And(vec![at(0, l[2]), x(0, ClockOp::Gt, 2)]);
    let run = ask_with(&p, QueryKind::Possibly(f), &options).run.unwrap();
    assert_eq!((run.steps.len(), run.end), (2, 2 * SECOND + 1));
    assert!(run.steps[1].time <= run.end);
}

/// The way round comes to `b` by one transition more, with more values of the clock: breadth first it is stored while the first
/// state at `b` still waits, and covers it.
#[test]
fn what_came_by_fewer_transitions_is_not_driven_out() {
    let mut p = program();
    let mut m = automaton("M", &["x"]);
    let l: Vec<LocationId> = ["start", "round", "b", "c", "goal"].map(|s| normal(&mut m, s)).into();
    edge(l[0], l[1]).to(&mut m);
    edge(l[0], l[2]).clock(0, ClockOp::Ge, 5).to(&mut m);
    edge(l[1], l[2]).to(&mut m);
    edge(l[2], l[3]).to(&mut m);
    edge(l[3], l[4]).clock(0, ClockOp::Le, 7).to(&mut m);
    add(&mut p, m);
    let goal = hrdsl_ta::ReachabilityGoal {
        what: hrdsl_ta::GoalKind::Location { automaton: 0, location: l[4] },
        settled: false,
    };
    let length = |options| {
        let report = hrdsl_ta::explore(&model(&p), std::slice::from_ref(&goal), &options, &|_| true);
        let hrdsl_ta::GoalOutcome::Reached(run) = &report.unwrap().goals[0] else { panic!("not reached") };
        run.steps.len()
    };
    let shortest = hrdsl_ta::SearchOptions::shortest();
    assert_eq!(length(shortest), 3);
    assert_eq!(length(hrdsl_ta::SearchOptions { keep_shorter: false, ..shortest }), 4);
    let options = QueryOptions { witness: WitnessKind::Shortest, ..QueryOptions::default() };
    assert_eq!(ask_with(&p, QueryKind::Possibly(at(0, l[4])), &options).run.unwrap().steps.len(), 3);
}

#[test]
fn fastest_is_finite_where_a_goal_cannot_be_reached() {
    let mut p = program();
    let mut m = automaton("M", &["x", "y"]);
    let a = location(&mut m, "a", LocationKind::Normal, &[clock(0, ClockOp::Le, 3)]);
    let b = normal(&mut m, "b");
    edge(a, a).clock(0, ClockOp::Ge, 1).reset(0).to(&mut m);
    edge(a, a).clock(1, ClockOp::Ge, 2).reset(1).to(&mut m);
    edge(a, b).clock(0, ClockOp::Gt, 3).to(&mut m);
    add(&mut p, m);
    let goal = hrdsl_ta::ReachabilityGoal {
        what: hrdsl_ta::GoalKind::Location { automaton: 0, location: b },
        settled: false,
    };
    let model = model(&p);
    // As if a run were known that takes long.
    let known = hrdsl_ta::WitnessRun {
        network: String::new(),
        ticks: 1,
        steps: Vec::new(),
        end: 1000 * SECOND,
        ending: RunEnding::Reached,
    };
    let run = hrdsl_ta::fastest(
        &model,
        &goal,
        &known,
        hrdsl_ta::SearchBudget::default(),
        hrdsl_ta::ScheduleOptions::default(),
    );
    assert_eq!(run.unwrap(), None);
}
