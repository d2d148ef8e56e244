//! What a physics step costs: with the arm moving, with nothing moving, at rest; and what sensors, lasers and the planner cost.

#[path = "../tests/common/mod.rs"]
mod common;

use common::{ARM, LEGS, OFFER, REST, STEP, cuboid, move_to, named, number, run, settle, table, truth};
use divan::Bencher;
use hrdsl_ir::world::{BodyId, BodyMotion, BodyRef, BodyShape, Laser, LaserId, SignalId, SignalTerm};
use hrdsl_sim::{MotorCommand, WorldSimulation};

fn main() {
    divan::main();
}

/// Ten physics steps of an arm on its way.
#[divan::bench]
fn ten_steps_moving(bencher: Bencher) {
    bencher
        .with_inputs(|| {
            let mut sim = WorldSimulation::new(&table(), &[]).expect("the world");
            sim.command(move_to(OFFER)).expect("in reach");
            sim.advance(2_000_000_000);
            sim
        })
        .bench_local_refs(|sim| sim.advance(sim.now() + 10 * STEP));
}

/// The same ten steps of the engine alone, with its motors as they were last driven: what no world of these bodies can do without. (Its
/// solver divides each of them as it does where an arm moves.)
#[divan::bench]
fn ten_bare_steps_moving(bencher: Bencher) {
    bencher
        .with_inputs(|| {
            let mut sim = WorldSimulation::new(&table(), &[]).expect("the world");
            sim.command(move_to(OFFER)).expect("in reach");
            sim.advance(2_000_000_000);
            sim
        })
        .bench_local_refs(|sim| (0..10).for_each(|_| sim.step_bare()));
}

/// Ten physics steps just before the world is found to be at rest.
#[divan::bench]
fn ten_steps_standing(bencher: Bencher) {
    bencher
        .with_inputs(|| {
            let mut sim = WorldSimulation::new(&table(), &[]).expect("the world");
            settle(&mut sim);
            sim.command(MotorCommand::OpenFingers { gripper: common::GRIP }).expect("a gripper");
            sim
        })
        .bench_local_refs(|sim| sim.advance(sim.now() + 10 * STEP));
}

/// A minute at rest.
#[divan::bench]
fn a_minute_at_rest(bencher: Bencher) {
    let mut sim = WorldSimulation::new(&table(), &[]).expect("the world");
    settle(&mut sim);
    bencher.bench_local(|| sim.advance(sim.now() + 60_000_000_000));
}

/// A whole hand-over: fetch, lift, offer, back.
#[divan::bench(sample_count = 10)]
fn hand_over(bencher: Bencher) {
    bencher.with_inputs(|| WorldSimulation::new(&table(), &[]).expect("the world")).bench_local_refs(|sim| {
        common::offer(sim);
        run(sim, MotorCommand::OpenFingers { gripper: common::GRIP });
        run(sim, move_to(REST));
    });
}

#[divan::bench]
fn plan_a_motion(bencher: Bencher) {
    let mut sim = WorldSimulation::new(&table(), &[]).expect("the world");
    settle(&mut sim);
    bencher.bench_local(|| sim.command(move_to(LEGS[3])));
}

#[divan::bench]
fn build_the_world(bencher: Bencher) {
    let world = table();
    bencher.bench_local(|| WorldSimulation::new(&world, &[]));
}

#[divan::bench(args = ["distance", "visible", "joint speed"])]
fn read_a_signal(bencher: Bencher, what: &str) {
    let world = table();
    let (leg, head) = (BodyRef::Body(named(&world, "leg1")), BodyRef::Body(named(&world, "person.head")));
    let signal = match what {
        "distance" => number(what, SignalTerm::Distance(head, leg)),
        "visible" => truth(what, SignalTerm::Visible(head, leg)),
        _ => number(what, SignalTerm::JointSpeed(ARM)),
    };
    let sim = WorldSimulation::new(&world, &[signal]).expect("the world");
    bencher.bench_local(|| sim.read(SignalId(0)));
}

/// One scan of 360 beams among thirty bodies: walls around, posts and boxes within.
#[divan::bench]
fn scan_with_a_laser(bencher: Bencher) {
    let mut world = table();
    world.joints.clear();
    world.arms.clear();
    world.grippers.clear();
    world.currents.clear();
    world.bodies = vec![
        common::body("ground", BodyMotion::Fixed, cuboid(12.0, 12.0, 0.1), [0.0, 0.0, -0.05], 1.0),
        common::body("robot", BodyMotion::Kinematic, cuboid(0.4, 0.4, 0.3), [0.0, 0.0, 0.15], 1.0),
    ];
    for (x, y) in [(5.0, 0.0), (-5.0, 0.0), (0.0, 5.0), (0.0, -5.0)] {
        let shape = if x == 0.0 { cuboid(10.0, 0.1, 1.0) } else { cuboid(0.1, 10.0, 1.0) };
        world.bodies.push(common::body("wall", BodyMotion::Fixed, shape, [x, y, 0.5], 1.0));
    }
    for i in 0..24 {
        let (sin, cos) = libm::sincos(f64::from(i) * 0.26);
        let away = 1.0 + f64::from(i % 4);
        let post = BodyShape::Cylinder { radius: 0.1, length: 1.0 };
        let shape = if i % 2 == 0 { post } else { cuboid(0.3, 0.2, 1.0) };
        world.bodies.push(common::body(
            "thing",
            BodyMotion::Fixed,
            shape,
            [away * cos, away * sin, 0.5],
            1.0,
        ));
    }
    world.lasers.push(Laser {
        name: "laser".into(),
        body: BodyId(1),
        at: [0.0; 3],
        lo: -std::f64::consts::PI,
        hi: std::f64::consts::PI,
        beams: 360,
        nearest: 0.05,
        farthest: 10.0,
    });
    let sim = WorldSimulation::new(&world, &[]).expect("the world");
    bencher.bench_local(|| sim.scan(LaserId(0)));
}
