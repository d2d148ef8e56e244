//! Random walks through random networks: the interpreter believes each, following it finds no fault, and a moment at which the zones do not
//! let its last transition happen is found out.

mod common;
#[path = "random_networks/dice.rs"]
mod dice;

use dice::{Flavour, network};
use hrdsl_ir::Program;
use hrdsl_ta::{
    FollowOutcome, RecordedPart, RecordedStep, RecordedTime, RecordedWalk, RunEnding, WalkSession,
    WitnessTrace, follow,
};

/// A told run as a record of it.
fn recorded(trace: &WitnessTrace, with_times: bool) -> RecordedWalk {
    let at = |text: &str, nanos: i64| {
        let time = if text.contains('+') { RecordedTime::After(nanos) } else { RecordedTime::At(nanos) };
        with_times.then_some(time)
    };
    let part = |p: &hrdsl_ta::TransitionParticipant| RecordedPart {
        member: p.member,
        from: Some(p.from.clone()),
        to: Some(p.to.clone()),
        edge: Some(p.edge),
        selected: Some(p.selected.clone()),
    };
    let step = |s: &hrdsl_ta::WitnessTransition| RecordedStep {
        time: at(&s.time, s.nanos),
        over: s.over.clone(),
        parts: s.parts.iter().map(part).collect(),
        variables: Some(s.variables.clone()),
    };
    RecordedWalk {
        steps: trace.steps.iter().map(step).collect(),
        end: at(&trace.end, trace.end_nanos),
        ending: Some(RunEnding::Reached),
    }
}

/// The walk's length, and whether a wrong moment could be tried.
fn walked(p: &Program, seed: u64) -> Option<(usize, bool)> {
    let mut session = WalkSession::new(p, &p.networks[0], seed).ok()?;
    let mut last = None;
    for _ in 0..12 {
        let Some(taken) = session.take_any() else { break };
        last = Some(taken);
    }
    let run = session
        .run()
        .unwrap_or_else(|e| panic!("seed {seed}: the interpreter does not believe the walk: {e}"));
    let trace = WitnessTrace::from_run(p, &p.networks[0], &run);
    for with_times in [true, false] {
        let record = recorded(&trace, with_times);
        match follow(&session.walk, &record).unwrap() {
            FollowOutcome::Run | FollowOutcome::Fault(_) => {}
            FollowOutcome::Leaves(left) => {
                panic!("seed {seed}: step {}: {}\n{}", left.step, left.why, trace.text())
            }
        }
        if let Some(left) = session.replay(&record).unwrap() {
            panic!("seed {seed}: step {}: {}", left.step, left.why);
        }
        session.run().unwrap_or_else(|e| panic!("seed {seed}: {e}"));
        assert_eq!(session.steps(), trace.steps.len());
    }
    let late = last.and_then(|option| option.time.until);
    let Some(late) = late else { return Some((session.steps(), false)) };
    let mut record = recorded(&trace, false);
    let steps = record.steps.len();
    record.steps[steps - 1].time = Some(RecordedTime::At(late + 1));
    match follow(&session.walk, &record).unwrap() {
        FollowOutcome::Leaves(left) => {
            assert_eq!(left.step, steps, "seed {seed}: {}", left.why);
            Some((steps, true))
        }
        // Another transition of the same edges lasts longer, if the interpreter believes it.
        FollowOutcome::Run | FollowOutcome::Fault(_) => {
            assert!(session.replay(&record).unwrap().is_none(), "seed {seed}");
            let run = session.run().unwrap_or_else(|e| panic!("seed {seed}: {e}"));
            assert_eq!(run.steps[steps - 1].time, (late + 1) * run.ticks, "seed {seed}");
            Some((steps, false))
        }
    }
}

#[test]
fn walks_are_runs_and_late_steps_are_found_out() {
    let (mut steps, mut late) = (0, 0);
    for flavour in [Flavour::Events, Flavour::Channels, Flavour::Whole, Flavour::Differences] {
        for seed in 0..500 {
            if let Some((taken, tried)) = walked(&network(seed, flavour), seed) {
                (steps, late) = (steps + taken, late + usize::from(tried));
            }
        }
    }
    assert!(steps > 5000 && late > 300, "{steps} steps, {late} late ones");
}
