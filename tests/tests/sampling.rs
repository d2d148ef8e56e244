//! Requirements see every physics step, and a recording that keeps few of them gives the same verdicts.

use std::collections::BTreeMap;

use hrdsl_compiler::{InputFile, compile};
use hrdsl_harness::{
    ActorPlayer, HarnessLoop, HarnessRun, SystemPlayer, SystemRequest, WorldBackend, WorldStage,
    doubles::{ToldStep, ToldSystem, ToldWorld},
};
use hrdsl_ir::{Nanos, Program, Value, value::SECOND, world::SignalId};
use hrdsl_monitor::{MonitorOutcome, MonitorRunner, MonitorVerdict};
use hrdsl_runtime::{conformance::ConformanceOptions, judge::judge_recording};
use hrdsl_sim::SimulatedWorld;
use hrdsl_trace::{
    RunEnd, Trace, TraceStepKind,
    record::{self, RecordingEnd, RecordingHeader},
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const MILLISECOND: Nanos = SECOND / 1000;

fn program(text: &str) -> Program {
    let c = compile(InputFile { name: "sampling.hri", text }, &[]);
    c.program.unwrap_or_else(|| panic!("{:#?}", c.diagnostics))
}

fn run(program: &Program, world: impl WorldBackend, system: ToldSystem, everything: bool) -> HarnessRun {
    let robot = program.actor_named("robot").unwrap();
    let players: Vec<Box<dyn ActorPlayer + '_>> = vec![Box::new(SystemPlayer::new(program, robot, system))];
    let stage = WorldStage::new(program, Box::new(world));
    let stage = if everything { stage.recording_everything() } else { stage };
    HarnessLoop::new(program, players, Some(stage), 60 * SECOND).run()
}

fn verdicts(program: &Program, trace: &Trace) -> Vec<MonitorVerdict> {
    let mut runner = MonitorRunner::new(program);
    trace.replay(&mut runner);
    runner.verdicts()
}

/// What of a verdict does not say which step of the recording it is.
fn said(v: &MonitorVerdict) -> impl PartialEq + std::fmt::Debug + use<> {
    let first = v.first_failure.as_ref();
    let values = first.map(|f| format!("{:?}", f.values));
    (
        v.outcome,
        (v.triggered, v.discharged, v.failures),
        first.map(|f| (f.time, f.trigger_time, f.step.is_none())),
        values,
        v.worst_margin,
        v.pending_since,
        v.unvalued,
    )
}

fn samples(trace: &Trace) -> usize {
    trace.steps.iter().filter(|s| matches!(s.what, TraceStepKind::Sample { .. })).count()
}

const MANY: &str = r#"scenario many

actor robot : system

event tick from robot

world {
  body one: fixed box(1 m, 1 m, 1 m) at (0 m, 0 m, 0 m)
  signal a: length to robot = one.x
  signal b: length to robot = one.y
  signal flag: bool to robot = one.z > 0 m
}

require A safety globally a < 50 cm
require B safety globally a - b < 20 cm || flag
require C safety globally not (b > 90 cm && flag)
require D safety globally a / b > -10
require E functional globally flag
require F safety globally min(a, b) > 1 cm
require G safety never tick while a < b
require H safety never tick while flag
require I safety globally (if flag { a } else { b }) < 95 cm

system robot { run "python3 robot.py" }
"#;

/// Signals that change at some physics steps, by leaps and in small steps, and sometimes have no value.
fn told(rng: &mut ChaCha8Rng) -> ToldWorld {
    let mut signals = Vec::new();
    let mut last = [0.3, 0.4];
    let unmeasured = rng.random();
    for step in 0..rng.random_range(20..200i64) {
        let time = step * 10 * MILLISECOND;
        for (at, value) in last.iter_mut().enumerate() {
            match rng.random_range(0..8) {
                0 => *value = rng.random_range(0.0..1.0),
                1..=4 => *value = f64::clamp(*value + rng.random_range(-0.05..0.05), 0.0, 1.0),
                5 => *value = if unmeasured && rng.random_range(0..9) == 0 { f64::NAN } else { 0.0 },
                _ => {}
            }
            signals.push((time, SignalId(at as u16), Value::Float(*value)));
        }
        if step == 0 || rng.random_range(0..5) == 0 {
            signals.push((time, SignalId(2), Value::Bool(rng.random())));
        }
    }
    ToldWorld::new(signals, Vec::new())
}

fn ticking(rng: &mut ChaCha8Rng) -> ToldSystem {
    let mut steps = Vec::new();
    for _ in 0..rng.random_range(0..12) {
        steps.push(ToldStep::Then(SystemRequest::Sleep { time: rng.random_range(0..400) * MILLISECOND / 2 }));
        steps.push(ToldStep::Then(SystemRequest::Emit { event: "tick".into(), args: BTreeMap::new() }));
    }
    steps.push(ToldStep::Then(SystemRequest::Sleep { time: 3 * SECOND }));
    steps.push(ToldStep::Then(SystemRequest::Done));
    ToldSystem::new(steps)
}

#[test]
fn few_samples_give_the_verdicts_of_all() {
    let program = program(MANY);
    let (mut kept, mut all) = (0, 0);
    for seed in 0..500 {
        let rng = || ChaCha8Rng::seed_from_u64(seed);
        let play = |everything: bool| {
            let mut rng = rng();
            let world = told(&mut rng);
            run(&program, world, ticking(&mut rng), everything).trace
        };
        let (few, every) = (play(false), play(true));
        let (of_few, of_every) = (verdicts(&program, &few), verdicts(&program, &every));
        for (a, b) in of_few.iter().zip(&of_every) {
            assert!(said(a) == said(b), "seed {seed}, {}: {a:#?} {b:#?}", program.monitors[a.monitor].name);
        }
        let times = |trace: &Trace| trace.steps.windows(2).all(|w| w[0].time <= w[1].time);
        assert!(times(&few) && times(&every), "time goes forward");
        kept += samples(&few);
        all += samples(&every);
    }
    assert!(kept < all, "{kept} of {all}");
}

/// A ball falls on a table, in less time than passes between two points of the grid.
const BLOW: &str = r#"scenario blow

actor robot : system

event done from robot

world {
  body ball: dynamic sphere(5 cm) at (0 m, 0 m, 52 cm) mass 1 kg
  body table: fixed box(1 m, 1 m, 44 cm) at (0 m, 0 m, 22 cm)
}

require A safety "the ball does not fall" globally ball.z > 50 cm
require B safety "it is slow" globally speed(ball) < 0.1 m/s

system robot { run "python3 robot.py" }
"#;

#[test]
fn what_lasts_less_than_the_grid_is_found_and_the_recording_says_the_same() {
    let program = program(BLOW);
    let system = || {
        let sleep = ToldStep::Then(SystemRequest::Sleep { time: 2 * SECOND });
        ToldSystem::new(vec![sleep, ToldStep::Then(SystemRequest::Done)])
    };
    let world = || SimulatedWorld::new(&program, 0).unwrap().unwrap();
    let ended = run(&program, world(), system(), false);
    let judged = verdicts(&program, &ended.trace);
    let every = verdicts(&program, &run(&program, world(), system(), true).trace);
    assert_eq!(judged.iter().map(said).collect::<Vec<_>>(), every.iter().map(said).collect::<Vec<_>>());
    let failure = |at: usize| judged[at].first_failure.as_ref().unwrap().time;
    assert_eq!(judged[0].outcome, MonitorOutcome::Fail);
    let grid: Nanos = 50 * MILLISECOND;
    assert!(failure(0) % grid != 0 || failure(1) % grid != 0, "between two points of the grid");

    let (header, ending) =
        (RecordingHeader::of(&program), RecordingEnd { kind: RunEnd::Quiescent, error: None });
    let text = record::write(&program, &header, &ended.trace, &ending);
    let read = judge_recording(&program, text.as_bytes(), false, &ConformanceOptions::default()).unwrap();
    let results: Vec<_> =
        read.judgement.verdicts.iter().map(|v| (v.failures, v.worst_margin.clone())).collect();
    let expected: Vec<_> = judged.iter().map(|v| (v.failures, v.worst_margin.map(|(m, _)| m))).collect();
    for ((failures, margin), (expected_failures, expected_margin)) in results.iter().zip(expected) {
        assert_eq!((*failures, margin.as_ref().map(|(m, _)| *m)), (expected_failures, expected_margin));
    }
    assert!(text.lines().count() < 120, "{}", text.lines().count());
}

const FORMULAS: &str = r#"scenario formulas

actor robot : system

event tick from robot

world {
  body one: fixed box(1 m, 1 m, 1 m) at (0 m, 0 m, 0 m)
  signal a: length to robot = one.x
  signal b: length to robot = one.y
  signal flag: bool to robot = one.z > 0 m
}

require A safety formula always (a < 90 cm or once[0 s, 300 ms] b > 50 cm)
require B functional formula always (tick implies historically[50 ms, 150 ms] a > 5 cm)
require C functional formula always (rising(flag) implies b > 10 cm until[0 s, 700 ms] tick)
require D safety formula not flag since[0 s, 1 s] a - b < 20 cm
require E functional formula eventually (flag and a / b > 5)
require F safety formula always (flag implies eventually[0 s, 400 ms] a + b > 1 m)

system robot { run "python3 robot.py" }
"#;

#[test]
fn formulas_see_every_step_in_few_samples() {
    let program = program(FORMULAS);
    let mut met = BTreeMap::new();
    let (mut kept, mut all) = (0, 0);
    for seed in 0..200 {
        let play = |everything: bool| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let world = told(&mut rng);
            run(&program, world, ticking(&mut rng), everything).trace
        };
        let (few, every) = (play(false), play(true));
        for (a, b) in verdicts(&program, &few).iter().zip(&verdicts(&program, &every)) {
            assert!(said(a) == said(b), "seed {seed}, {}: {a:#?} {b:#?}", program.monitors[a.monitor].name);
            *met.entry(a.outcome).or_insert(0) += 1;
        }
        kept += samples(&few);
        all += samples(&every);
    }
    assert!(met.len() == 4 && kept <= all, "{met:?}, {kept} of {all}");
}
