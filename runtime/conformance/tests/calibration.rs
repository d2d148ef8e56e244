//! Recordings of code that is faster or slower than its model, and the bounds that they give.

mod common;

use common::{scenario, trace};
use hrdsl_conformance::{ConformanceOptions, ModelCalibration, RecordedRun, calibrate};
use hrdsl_ir::{Program, ta::ClockOp, value::SECOND};
use hrdsl_results::{ConformanceOutcome, RunEnd};

/// Fetches for 20 s to 30 s without a sound, and gives; then takes 2 s to 5 s to drop.
fn model() -> Program {
    scenario(
        "automaton Robot plays sys { clock x\n init location idle\n location move { invariant x <= 30 s }\n\
         committed location send\n location rest { invariant x <= 5 s }\n idle -> move on ask do x = 0\n\
         move -> send when x >= 20 s\n send -> rest do give; x = 0\n rest -> idle when x >= 2 s do drop }",
    )
}

fn of(program: &Program, runs: &[&[(&str, f64)]]) -> ModelCalibration {
    let run = |events: &&[(&str, f64)]| -> RecordedRun {
        (trace(program, events, events.last().map_or(0.0, |e| e.1)), RunEnd::Limit)
    };
    let runs: Vec<RecordedRun> = runs.iter().map(run).collect();
    let mut all = calibrate(program, &runs, &ConformanceOptions::default());
    assert_eq!(all.len(), 1);
    all.remove(0)
}

fn conforming(found: &ModelCalibration) -> usize {
    found.after.iter().filter(|v| v.outcome == ConformanceOutcome::Conforms).count()
}

#[test]
fn a_model_that_fits_has_no_bound_that_is_contradicted() {
    let found = of(&model(), &[&[("ask", 0.0), ("give", 20.0), ("drop", 25.0)]]);
    assert_eq!((found.contradicted.len(), conforming(&found)), (0, 1));
}

#[test]
fn the_bound_of_who_is_early_is_found_behind_a_committed_location() {
    let program = model();
    let found = of(
        &program,
        &[
            &[("ask", 1.0), ("give", 14.4), ("drop", 17.0), ("ask", 18.0), ("give", 37.9), ("drop", 40.5)],
            &[("ask", 0.0), ("give", 22.0), ("drop", 24.0)],
        ],
    );
    assert_eq!(found.contradicted.len(), 1, "{found:?}");
    let bound = &found.contradicted[0];
    assert_eq!((bound.place.name.as_str(), bound.clock.as_str()), ("Robot: move -> send", "x"));
    assert_eq!((bound.bound, bound.count), ((ClockOp::Ge, 20 * SECOND), 3));
    assert_eq!(bound.observed, Some((13_400_000_000, 22 * SECOND)));
    assert_eq!(bound.fits, [(ClockOp::Ge, 13_400_000_000)]);
    assert_eq!(conforming(&found), 2);
}

#[test]
fn late_and_early_bounds_are_told_apart() {
    let found = of(
        &model(),
        &[&[("ask", 0.0), ("give", 31.234), ("drop", 32.5)], &[("ask", 0.0), ("give", 25.0), ("drop", 28.0)]],
    );
    let told: Vec<_> =
        found.contradicted.iter().map(|b| (b.place.name.as_str(), b.bound.0, b.fits.clone())).collect();
    assert_eq!(
        told,
        [
            ("Robot.move", ClockOp::Le, vec![(ClockOp::Le, 31_240_000_000)]),
            ("Robot: rest -> idle", ClockOp::Ge, vec![(ClockOp::Ge, 1_260_000_000)])
        ]
    );
    assert_eq!(conforming(&found), 2);
}

#[test]
fn an_equality_is_loosened_together_with_the_invariant_that_says_the_same() {
    let program = scenario(
        "automaton Timer plays sys { clock x\n init location run { invariant x <= 3 s }\n\
         run -> run when x == 3 s do give; x = 0 }",
    );
    let found = of(&program, &[&[("give", 3.0), ("give", 6.05), ("give", 9.0)]]);
    let told: Vec<_> = found.contradicted.iter().map(|b| (b.bound.0, b.fits.clone())).collect();
    assert_eq!(
        told,
        [
            (ClockOp::Le, vec![(ClockOp::Le, 3_050_000_000)]),
            (ClockOp::Eq, vec![(ClockOp::Ge, 2_950_000_000), (ClockOp::Le, 3_050_000_000)])
        ]
    );
    assert_eq!(conforming(&found), 1);
}

#[test]
fn what_no_bound_explains_is_left_and_is_no_witness_of_times() {
    let found = of(
        &model(),
        &[&[("ask", 0.0), ("drop", 4.0), ("give", 6.0)], &[("ask", 0.0), ("give", 15.0), ("drop", 17.0)]],
    );
    assert_eq!(found.contradicted.len(), 1, "{found:?}");
    assert_eq!(found.contradicted[0].fits, [(ClockOp::Ge, 15 * SECOND)]);
    let outcomes: Vec<_> = found.after.iter().map(|v| v.outcome).collect();
    assert_eq!(outcomes, [ConformanceOutcome::Departs, ConformanceOutcome::Conforms]);
}

/// Fetches without a sound for 2 s to 5 s, and holds for up to 2 s.
fn counter() -> Program {
    scenario(
        "automaton Waiter plays sys { clock x\n init location idle\n location fetching { invariant x <= 5 s }\n\
         location holding { invariant x <= 2 s }\n idle -> fetching on ask do x = 0\n\
         fetching -> holding when x >= 2 s do x = 0\n holding -> idle do give }",
    )
}

/// The bounds that fit, and with them how many of the recordings conform.
fn fits(program: &Program, runs: &[&[(&str, f64)]]) -> (Vec<(ClockOp, f64)>, usize) {
    let found = of(program, runs);
    let fits = found.contradicted.iter().flat_map(|bound| bound.fits.clone());
    (fits.map(|(op, time)| (op, time as f64 / SECOND as f64)).collect(), conforming(&found))
}

#[test]
fn what_a_silent_edge_hides_is_bounded_as_tightly_as_all_recordings_let_it() {
    let late: &[(&str, f64)] = &[("ask", 1.0), ("give", 10.5)];
    let again: &[(&str, f64)] = &[("ask", 1.0), ("ask", 11.0), ("give", 13.0)];
    let later_again: &[(&str, f64)] = &[("ask", 1.0), ("ask", 8.5), ("give", 11.0)];
    let latest: &[(&str, f64)] = &[("ask", 1.0), ("give", 13.0)];
    let late_by = |time| (vec![(ClockOp::Le, time)], 1);
    let counter = counter();
    assert_eq!(fits(&counter, &[late]), late_by(7.5));
    assert_eq!(fits(&counter, &[again]), late_by(10.0));
    assert_eq!(fits(&counter, &[later_again]), late_by(8.0));
    assert_eq!(fits(&counter, &[latest]), late_by(10.0));
    assert_eq!(fits(&counter, &[late, again, later_again, latest]), (vec![(ClockOp::Le, 10.0)], 4));
    let early: &[(&str, f64)] = &[("ask", 1.0), ("give", 1.0)];
    assert_eq!(fits(&counter, &[early, late]), (vec![(ClockOp::Le, 7.5), (ClockOp::Ge, 0.0)], 2));
    let found = of(&counter, &[late, again]);
    let bound = &found.contradicted[0];
    assert_eq!((bound.known, bound.observed), (0, None), "the silent edge hides when it was taken");
}

#[test]
fn bounds_that_are_of_no_use_alone_are_loosened_together() {
    let program = scenario(
        "automaton Relay plays sys { clock x, y\n init location a { invariant x <= 1 s }\n\
         location b { invariant y <= 1 s }\n location c\n a -> b when y <= 1 s\n b -> c when x <= 1 s do give }",
    );
    let found = of(&program, &[&[("give", 3.0)]]);
    assert_eq!(conforming(&found), 1, "{found:?}");
    assert_eq!(found.explicable, [true]);
}

#[test]
fn times_that_are_finer_than_hundredths_get_bounds_as_fine() {
    let program = scenario(
        "automaton Quick plays sys { clock x\n init location idle\n location busy { invariant x <= 5 ms }\n\
         idle -> busy on ask do x = 0\n busy -> idle do give }",
    );
    assert_eq!(fits(&program, &[&[("ask", 1.0), ("give", 1.0072)]]), (vec![(ClockOp::Le, 0.008)], 1));
}
