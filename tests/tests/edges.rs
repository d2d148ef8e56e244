//! Rules on conditions, from the text to the event.

use hrdsl_compiler::{InputFile, compile};
use hrdsl_harness::{
    ActorPlayer, HarnessLoop, SystemPlayer, SystemRequest, WorldBackend, WorldStage,
    doubles::{ToldStep, ToldSystem, ToldWorld},
};
use hrdsl_ir::{Nanos, Program, Value, value::SECOND, world::SignalId};
use hrdsl_sim::SimulatedWorld;
use hrdsl_trace::{TraceStepKind, print};

const MILLISECOND: Nanos = SECOND / 1000;

fn program(text: &str) -> Program {
    let c = compile(InputFile { name: "edges.hri", text }, &[]);
    c.program.unwrap_or_else(|| panic!("{:#?}", c.diagnostics))
}

/// The events of a run of so many seconds: at which millisecond, and what.
fn events(program: &Program, world: impl WorldBackend, seconds: Nanos) -> Vec<String> {
    let robot = program.actor_named("robot").unwrap();
    let sleep = ToldStep::Then(SystemRequest::Sleep { time: seconds * SECOND });
    let system = ToldSystem::new(vec![sleep, ToldStep::Then(SystemRequest::Done)]);
    let players: Vec<Box<dyn ActorPlayer + '_>> = vec![Box::new(SystemPlayer::new(program, robot, system))];
    let stage = WorldStage::new(program, Box::new(world));
    let run = HarnessLoop::new(program, players, Some(stage), 60 * SECOND).run();
    let of_events = run.trace.steps.iter().filter(|s| matches!(s.what, TraceStepKind::Event { .. }));
    of_events
        .map(|s| format!("{} {}", s.time / MILLISECOND, print::who_did_what(program, &s.what).1))
        .collect()
}

const TOLD: &str = r#"scenario told

actor guest : environment
actor robot : system

event up(far: length), down, stays, over, quiet from guest

world {
  body one: fixed box(1 m, 1 m, 1 m) at (0 m, 0 m, 0 m)
  signal near: bool to robot = one.x > 0 m
  signal far: length to robot = one.y
  on rising(near) emit up(far)
  on falling(near) when far < 1 m emit down
  on rising(near, 100 ms) emit stays
  on falling(near, 100 ms) emit over
  on rising(not near && 1 m / far > 0, 1 s) emit quiet
}

system robot { run "python3 robot.py" }
"#;

fn told(near: &[(Nanos, bool)], far: &[(Nanos, f64)]) -> ToldWorld {
    let nears = near.iter().map(|(t, v)| (t * MILLISECOND, SignalId(0), Value::Bool(*v)));
    let fars = far.iter().map(|(t, v)| (t * MILLISECOND, SignalId(1), Value::Float(*v)));
    let mut all: Vec<_> = nears.chain(fars).collect();
    all.sort_by_key(|(time, ..)| *time);
    ToldWorld::new(all, Vec::new())
}

#[test]
fn an_edge_fires_once_and_what_is_true_at_the_start_is_none() {
    let program = program(TOLD);
    let near = [(0, true), (10, false), (20, true), (40, false), (300, true), (420, false)];
    let seen = events(&program, told(&near, &[(0, 0.5)]), 2);
    let expected = [
        "10 down",
        "20 up(far: 0.5 m)",
        "40 down",
        "300 up(far: 0.5 m)",
        "400 stays",
        "420 down",
        "420 over",
        "1420 quiet",
    ];
    assert_eq!(seen, expected, "40 ms are no 100 ms, and nothing moves when the 100 ms are over");
}

#[test]
fn what_holds_from_the_start_has_held_since_then() {
    let program = program(TOLD);
    let seen = events(&program, told(&[(0, true), (500, false)], &[(0, 2.0)]), 1);
    assert_eq!(seen, ["100 stays", "500 over"], "`down` has a guard");
}

/// A robot's arm is not needed: a ball falls past a mark, in two steps of physics, and lies there.
const FALLS: &str = r#"scenario falls

actor guest : environment
actor robot : system

event passed, gone, lies from guest

world {
  body ground: fixed box(9 m, 9 m, 10 cm) at (0 m, 0 m, -5 cm)
  body ball: dynamic sphere(5 cm) at (0 m, 0 m, 2 m) mass 1 kg
  on rising(ball.z < 60 cm && ball.z > 50 cm) emit passed
  on falling(ball.z < 60 cm && ball.z > 50 cm) emit gone
  on rising(speed(ball) < 1 mm/s && ball.z < 10 cm, 5 s) emit lies
}

system robot { run "python3 robot.py" }
"#;

#[test]
fn every_step_of_the_physics_is_looked_at_and_time_counts_at_rest() {
    let program = program(FALLS);
    let seen = events(&program, SimulatedWorld::new(&program, 0).unwrap().unwrap(), 10);
    let times: Vec<Nanos> = seen.iter().map(|s| s.split(' ').next().unwrap().parse().unwrap()).collect();
    let names: Vec<&str> = seen.iter().map(|s| s.split(' ').nth(1).unwrap()).collect();
    assert_eq!(names, ["passed", "gone", "lies"], "{seen:?}");
    assert!(times[1] - times[0] < 50 && times[2] > 5000, "{seen:?}");
}
