//! Each instance in the examples of `std.requirements` judges small traces: some keep it, some break it, some say nothing.

use std::collections::{BTreeMap, BTreeSet};

use MonitorOutcome::{Fail, Inconclusive, Pass, Vacuous};
use hrdsl_ir::{EventId, Program, Value, world::SignalId};
use hrdsl_monitor::{MonitorOutcome, MonitorRunner, MonitorVerdict};
use hrdsl_trace::{Trace, TraceStep, TraceStepKind};

/// Short names of the measurements in the traces below.
const SHORT: &[(&str, &str)] = &[
    ("v", "speed(robot.palm)"),
    ("hand", "distance(person.hand, robot.palm)"),
    ("head", "distance(person.head, robot.palm)"),
    ("chest", "distance(person.head, robot.chest)"),
    ("joints", "joint_speed(robot.arm)"),
    ("shelf", "distance(robot.palm, shelf)"),
    ("sees", "visible(person.head, robot.palm)"),
    ("holds", "holds(person.grasp)"),
    ("has_cup", "holds(person.grasp, cup)"),
    ("x", "robot.palm.x"),
    ("y", "robot.palm.y"),
    ("z", "robot.palm.z"),
];

/// The requirement, a trace of 100 s (a time in s, then an event or `signal=value`), and what it must say of it.
const CASES: &[(&str, &str, MonitorOutcome)] = &[
    ("never_opened", "1 closing", Vacuous),
    ("never_opened", "1 opening", Fail),
    ("no_blind_closing", "0 sees=false; 1 opening", Vacuous),
    ("no_blind_closing", "0 sees=true; 1 closing; 2 sees=false", Pass),
    ("no_blind_closing", "0 sees=true; 1 sees=false; 2 closing", Fail),
    ("hands_off", "1 closing; 2 reset_pressed; 3 opening", Vacuous),
    ("hands_off", "1 stop_pressed; 2 reset_pressed; 3 opening", Pass),
    ("hands_off", "1 stop_pressed; 2 opening; 3 reset_pressed", Fail),
    ("hands_off", "1 stop_pressed; 2 closing", Fail),
    ("arm_in_front", "", Vacuous),
    ("arm_in_front", "0 x=0.3; 1 x=0.1", Pass),
    ("arm_in_front", "0 x=0.3; 1 x=-0.1", Fail),
    ("opened_once", "1 asked", Vacuous),
    ("opened_once", "1 opening; 2 asked; 3 opening", Pass),
    ("opened_once", "1 opening; 2 opening", Fail),
    ("one_question_at_a_time", "1 told", Vacuous),
    ("one_question_at_a_time", "1 asked; 2 told; 3 told; 4 asked", Pass),
    ("one_question_at_a_time", "1 asked; 2 asked", Fail),
    ("one_answer_a_question", "1 asked; 2 asked", Vacuous),
    ("one_answer_a_question", "1 told; 2 asked; 3 told", Pass),
    ("one_answer_a_question", "1 asked; 2 told; 3 told", Fail),
    ("asked_first", "1 told", Vacuous),
    ("asked_first", "1 reset_pressed; 2 asked; 3 told; 4 told", Pass),
    ("asked_first", "1 reset_pressed; 2 told; 3 asked", Fail),
    ("nothing_unasked", "1 pulled", Vacuous),
    ("nothing_unasked", "1 reset_pressed; 2 pulled; 3 opening; 4 pulled; 5 opening", Pass),
    ("nothing_unasked", "1 reset_pressed; 2 opening", Fail),
    ("nothing_unasked", "1 reset_pressed; 2 pulled; 3 opening; 4 opening", Fail),
    ("answered", "1 told", Vacuous),
    ("answered", "1 asked; 2 asked; 99 halted", Pass),
    ("answered", "1 asked; 2 told; 3 asked", Inconclusive),
    ("answered_soon", "1 told", Vacuous),
    ("answered_soon", "1 asked; 11 told", Pass),
    ("answered_soon", "1 asked; 2 asked; 11.1 told", Fail),
    ("answered_soon", "95 asked", Inconclusive),
    ("stop_in_time", "1 halted", Vacuous),
    ("stop_in_time", "1 stop_pressed; 1.5 halted", Pass),
    ("stop_in_time", "1 stop_pressed; 1.6 halted", Fail),
    ("halted_is_true", "0 v=0.5", Vacuous),
    ("halted_is_true", "0 v=0.5; 1 v=0.005; 2 halted; 3 v=0.5", Pass),
    ("halted_is_true", "0 v=0.5; 2 halted", Fail),
    ("no_restart", "1 started", Vacuous),
    ("no_restart", "1 started; 2 stop_pressed; 3 reset_pressed; 4 started", Pass),
    ("no_restart", "1 stop_pressed; 2 started", Fail),
    ("palm_slow", "", Vacuous),
    ("palm_slow", "0 v=0; 1 v=0.4", Pass),
    ("palm_slow", "0 v=0; 1 v=0.41; 2 v=0", Fail),
    ("palm_taught", "0 v=0.25", Pass),
    ("palm_taught", "0 v=0.26", Fail),
    ("palm_reduced", "0 v=0.25", Pass),
    ("palm_reduced", "0 v=0.1; 1 v=0.26", Fail),
    ("arm_slow", "0 joints=0.25", Pass),
    ("arm_slow", "0 joints=0.1; 1 joints=0.3", Fail),
    ("head_free", "0 head=0.5; 1 head=0.1", Pass),
    ("head_free", "0 head=0.5; 1 head=0.09", Fail),
    ("slow_near_head", "0 head=0.6; 0 v=0.4; 1 head=0.4; 1 v=0.25", Pass),
    ("slow_near_head", "0 head=0.6; 0 v=0.4; 1 head=0.4", Fail),
    // 0.5 m/s · 300 ms + v · 50 ms + 7 cm: 22 cm, and 5 mm for each 10 cm/s.
    ("keeps_its_distance", "0 hand=0.01; 0 v=0", Pass),
    ("keeps_its_distance", "0 hand=0.25; 0 v=0.4", Pass),
    ("keeps_its_distance", "0 hand=0.235; 0 v=0.2; 1 v=0.4", Fail),
    ("walk_in_time", "0 head=0.9; 0 v=0.5", Pass),
    ("walk_in_time", "0 head=0.8; 0 v=0.5", Fail),
    ("stop_near_hand", "0 hand=1; 0 v=0.5; 1 hand=0.2; 1 v=0.01", Pass),
    ("stop_near_hand", "0 hand=1; 0 v=0.5; 1 hand=0.2", Fail),
    ("stop_near_cup", "0 hand=0.06; 0 v=0.5", Pass),
    ("stop_near_cup", "0 hand=0.05; 0 v=0.02", Fail),
    ("arm_stops", "0 chest=0.5; 0 joints=0.2; 1 chest=0.3; 1 joints=0", Pass),
    ("arm_stops", "0 chest=0.3; 0 joints=0.2", Fail),
    ("starts_alone", "0 hand=0.1", Vacuous),
    ("starts_alone", "0 hand=0.2; 1 started; 2 hand=0.1", Pass),
    ("starts_alone", "0 hand=0.1; 1 started", Fail),
    ("palm_at_work", "0 x=1; 0 y=-1; 0 z=0", Pass),
    ("palm_at_work", "0 x=1; 0 y=-1; 0 z=0; 1 z=2.1", Fail),
    ("palm_at_work", "0 x=-1.1; 0 y=-1; 0 z=0", Fail),
    ("shelf_untouched", "0 shelf=0.01", Pass),
    ("shelf_untouched", "0 shelf=0.01; 1 shelf=0", Fail),
    ("guided", "0 holds=false; 0 joints=0; 1 holds=true; 1 joints=0.2", Pass),
    ("guided", "0 holds=true; 0 joints=0.2; 1 holds=false", Fail),
    ("no_pinching", "0 hand=0.01", Vacuous),
    ("no_pinching", "0 hand=0.05; 1 closing", Pass),
    ("no_pinching", "0 hand=0.04; 1 closing", Fail),
    ("nothing_dropped", "0 has_cup=false", Vacuous),
    ("nothing_dropped", "0 has_cup=true; 1 opening", Pass),
    ("nothing_dropped", "0 has_cup=false; 1 opening", Fail),
];

fn step(program: &Program, text: &str) -> TraceStep {
    let (time, what) = text.split_once(' ').unwrap();
    let time = (time.parse::<f64>().unwrap() * 1e9).round() as i64;
    let what = match what.split_once('=') {
        Some((short, value)) => {
            let name = SHORT.iter().find(|(s, _)| *s == short).unwrap().1;
            let at =
                program.signals.iter().position(|s| s.name == name).unwrap_or_else(|| panic!("no {name}"));
            let value = value.parse().map_or_else(|_| Value::Bool(value == "true"), Value::Float);
            TraceStepKind::Sample { signal: SignalId(u16::try_from(at).unwrap()), value }
        }
        None => {
            let at =
                program.events.iter().position(|e| e.name == what).unwrap_or_else(|| panic!("no {what}"));
            TraceStepKind::Event { event: EventId(u16::try_from(at).unwrap()), args: Vec::new() }
        }
    };
    TraceStep { time, what }
}

fn judged(program: &Program, requirement: &str, trace: &str) -> MonitorVerdict {
    let steps = trace.split(';').map(str::trim).filter(|s| !s.is_empty()).map(|s| step(program, s));
    let trace = Trace { steps: steps.collect(), end: 100_000_000_000 };
    let mut checker = MonitorRunner::new(program);
    trace.replay(&mut checker);
    let at = program.monitors.iter().position(|m| m.name == requirement);
    let at = at.unwrap_or_else(|| panic!("no requirement `{requirement}`"));
    checker.verdicts().swap_remove(at)
}

#[test]
fn requirements_judge_as_they_say() {
    let program = crate::program("std.requirements", 0);
    let mut seen: BTreeMap<&str, BTreeSet<MonitorOutcome>> = BTreeMap::new();
    for (requirement, trace, outcome) in CASES {
        let verdict = judged(&program, requirement, trace);
        assert_eq!(verdict.outcome, *outcome, "{requirement}: {trace}");
        seen.entry(requirement).or_default().insert(*outcome);
    }
    for monitor in &program.monitors {
        let outcomes = seen.remove(monitor.name.as_str()).unwrap_or_default();
        let broken = outcomes.contains(&Fail) || outcomes.contains(&Inconclusive);
        let kept = outcomes.contains(&Pass) || outcomes.contains(&Vacuous);
        assert!(broken && kept, "{} needs a trace that keeps it and one that breaks it", monitor.name);
    }
}

#[test]
fn margins_are_by_how_much_a_requirement_holds() {
    let program = crate::program("std.requirements", 0);
    for (requirement, trace, want) in [
        ("palm_slow", "0 v=0; 1 v=0.3; 2 v=0.1", 0.1),
        ("head_free", "0 head=0.5; 1 head=0.25", 0.15),
        ("starts_alone", "0 hand=0.5; 1 started", 0.3),
        ("palm_at_work", "0 x=0.5; 0 y=-0.8; 0 z=1", 0.2),
    ] {
        let (margin, _) = judged(&program, requirement, trace).worst_margin.unwrap();
        assert!((margin - want).abs() < 1e-9, "{requirement}: {margin}, not {want}");
    }
    let mixed = judged(&program, "slow_near_head", "0 head=0.6; 0 v=0.4");
    assert!(mixed.worst_margin.is_none(), "a distance and a speed cannot be compared");
}
