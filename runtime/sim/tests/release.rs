//! A leg that goes over from the robot's hand to a person's, in the world of the hand-over: whatever each of them bears changes at once, and
//! the arm is not jolted by it.

mod common;
#[path = "common/scene.rs"]
mod scene;

use common::{STEP, boolean, float, number, truth};
use hrdsl_ir::{Expr, world::*};
use hrdsl_sim::{MotorCommand, WorldSimulation};
use scene::Scene;

const MEMBERS: &str = "part robot = bert2 at (0 m, 0 m, 0 m)
    part person = adult(172 cm) at (1.3 m, 20 cm, 0 m) rotated (0 deg, 0 deg, 180 deg)
    body floor: fixed box(8 m, 8 m, 10 cm) at (0 m, 0 m, -5 cm)
    body stand: fixed box(20 cm, 40 cm, 43.05 cm) at (30 cm, -42 cm, 21.525 cm)
    body leg: dynamic box(4 cm, 4 cm, 25 cm) at (30 cm, -30 cm, 55.55 cm) mass 500 g graspable";

#[test]
fn a_leg_that_is_let_go_of_does_not_jolt_the_arm() {
    let scene = Scene::with("use std.robots.bert2", MEMBERS, &[]);
    let world = scene.program.world.clone().expect("a world");
    let (arm, grip, grasp) = (ArmId(0), GripperId(0), GripperId(1));
    let named = |name: &str| common::named(&world, name);
    let leg = BodyRef::Body(named("leg"));
    let signals =
        [number("speed", SignalTerm::JointSpeed(arm)), truth("held", SignalTerm::Holds(grasp, leg))];
    let mut sim = WorldSimulation::new(&world, &signals).expect("a world");
    let to = |target| MotorCommand::ReachPoint { arm, target, max_speed: None };
    common::run(&mut sim, to([0.3, -0.3, 0.5555]));
    common::run(&mut sim, MotorCommand::CloseFingers { gripper: grip });
    common::run(&mut sim, to([0.3, -0.3, 0.72]));
    common::run(&mut sim, to([0.48, 0.17, 1.1]));
    let place = common::at(Some(leg), [0.05, -0.1, -0.12]);
    let reach = WorldAction::Move { body: named("person.hand"), to: place, over: Expr::float(0.8) };
    sim.act(&reach, &common::none).expect("a hand");
    let pass = |sim: &mut WorldSimulation, seconds: i64| {
        let (until, mut fastest) = (sim.now() + seconds * common::SECOND, 0.0f64);
        while sim.now() < until {
            sim.advance(sim.now() + STEP);
            fastest = fastest.max(float(sim, 0));
        }
        fastest
    };
    pass(&mut sim, 1);
    sim.act(&WorldAction::Grasp { gripper: grasp }, &common::none).expect("a hand");
    let grasped = pass(&mut sim, 4);
    assert!(boolean(&sim, 1), "the person has taken hold");
    sim.command(MotorCommand::OpenFingers { gripper: grip }).expect("a gripper");
    let released = pass(&mut sim, 2);
    println!("grasped {grasped} rad/s, released {released} rad/s");
    // The fingers, as they open, are struck by the leg that turns: 0.118 rad/s from 8 sweeps of the solver on.
    assert!(grasped < 0.1 && released < 0.13, "{grasped} {released}");
}
