//! Contacts, joints and the past, measured.

mod common;
use common::*;
use hrdsl_ir::world::*;
use hrdsl_ir::{Expr, Value};
use hrdsl_sim::{MotorCommand, WorldSimulation};

/// A table of 44 cm, on it a box of 2 kg, on that one of 1 kg; a ball that somebody moves about.
fn stack() -> World {
    let mut world = empty();
    world.bodies = vec![
        body("table", BodyMotion::Fixed, cuboid(1.0, 1.0, 0.44), [0.0, 0.0, 0.22], 1.0),
        body("box", BodyMotion::Dynamic, cuboid(0.2, 0.2, 0.2), [0.0, 0.0, 0.545], 2.0),
        body(
            "lid",
            BodyMotion::Dynamic,
            BodyShape::Cylinder { radius: 0.05, length: 0.1 },
            [0.0, 0.0, 0.70],
            1.0,
        ),
        body("ball", BodyMotion::Kinematic, BodyShape::Sphere { radius: 0.05 }, [0.0, 2.0, 1.0], 1.0),
    ];
    world
}

const TABLE: BodyRef = BodyRef::Body(BodyId(0));
const BOX: BodyRef = BodyRef::Body(BodyId(1));
const LID: BodyRef = BodyRef::Body(BodyId(2));
const BALL: BodyRef = BodyRef::Body(BodyId(3));

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 0.02 * expected.abs().max(0.05), "{found} instead of {expected}");
}

#[test]
fn what_rests_presses_with_its_weight() {
    let mut sim = WorldSimulation::new(&stack(), &[]).unwrap();
    let measured = |sim: &WorldSimulation, term| sim.measure(&term).as_f64().unwrap();
    let check = |sim: &WorldSimulation| {
        near(measured(sim, SignalTerm::Force(BOX, TABLE)), 29.43);
        near(measured(sim, SignalTerm::Force(TABLE, BOX)), 29.43);
        near(measured(sim, SignalTerm::Force(LID, BOX)), 9.81);
        near(measured(sim, SignalTerm::ForceOn(BOX)), 39.24);
        near(measured(sim, SignalTerm::Weight(BOX)), 9.81);
        near(measured(sim, SignalTerm::Weight(TABLE)), 29.43);
        for free in [SignalTerm::Weight(LID), SignalTerm::ForceOn(BALL), SignalTerm::Force(LID, TABLE)] {
            assert_eq!(measured(sim, free), 0.0, "{free:?}");
        }
        let touching = |a, b| sim.measure(&SignalTerm::Touches(a, b)) == Value::Bool(true);
        assert!(touching(BOX, TABLE) && touching(LID, BOX) && touching(BOX, LID));
        assert!(!touching(LID, TABLE) && !touching(BALL, BOX));
    };
    assert_eq!(measured(&sim, SignalTerm::ForceOn(BOX)), 0.0, "it has not fallen yet");
    settle(&mut sim);
    check(&sim);
    // Something else moves, for so long that what rests is asleep.
    let to = WorldPoint::free(None, [0.0, -2.0, 2.0].map(Expr::float));
    let away = WorldAction::Move { body: BodyId(3), to, over: Expr::float(10.0) };
    sim.act(&away, &|_| None).unwrap();
    sim.advance(sim.now() + 9 * SECOND);
    check(&sim);
    settle(&mut sim);
    check(&sim);
}

#[test]
fn a_blow_is_a_force_of_a_few_steps() {
    let mut world = stack();
    world.bodies[1].position[2] = 1.0;
    world.bodies.truncate(2);
    let mut sim = WorldSimulation::new(&world, &[]).unwrap();
    let (mut most, mut impulse) = (0.0f64, 0.0);
    while let Some(next) = sim.next_wake() {
        sim.advance(next);
        let force = sim.measure(&SignalTerm::Force(BOX, TABLE)).as_f64().unwrap();
        most = most.max(force);
        impulse += force * 0.01;
    }
    assert!(most > 200.0, "{most} N");
    // All that the box fell with, and its weight for as long as it lay there.
    near(impulse, 2.0 * 9.81 * sim.now() as f64 / SECOND as f64);
}

/// A beam that a motor turns about the y axis, and perhaps 1 kg that lies on it, half a metre from the axis.
fn beam(loaded: bool) -> World {
    let mut world = empty();
    world.bodies = vec![
        body("post", BodyMotion::Fixed, cuboid(0.1, 0.1, 1.0), [-0.2, 0.0, 0.5], 1.0),
        body("beam", BodyMotion::Dynamic, cuboid(0.8, 0.3, 0.04), [0.4, 0.0, 1.0], 2.0),
    ];
    if loaded {
        world.bodies.push(body("load", BodyMotion::Dynamic, cuboid(0.1, 0.1, 0.1), [0.5, 0.0, 1.071], 1.0));
    }
    let (anchor, axis) = ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0]);
    let (parent, child) = (BodyId(0), BodyId(1));
    let (name, motion, drive) = ("hinge".into(), JointMotion::Hinge, JointDrive::default());
    world.joints = vec![Joint { name, parent, child, motion, anchor, axis, lo: -1.0, hi: 1.0, drive }];
    world.arms = vec![Arm {
        name: "arm".into(),
        joints: vec![JointId(0)],
        tip: BodyId(1),
        tool: [0.0; 3],
        contact_limit: None,
        avoids_people: false,
        max_speed: 0.5,
        postures: Vec::new(),
    }];
    world
}

const TORQUE: SignalTerm = SignalTerm::JointEffort(JointId(0));

#[test]
fn a_motor_holds_what_lies_on_the_beam() {
    let torque = |sim: &WorldSimulation| sim.measure(&TORQUE).as_f64().unwrap();
    let mut sim = WorldSimulation::new(&beam(true), &[]).unwrap();
    sim.advance(SECOND);
    near(torque(&sim), -9.81 * (0.5 + 2.0 * 0.4));
    near(sim.measure(&SignalTerm::Weight(BodyRef::Body(BodyId(1)))).as_f64().unwrap(), 9.81);
    let mut sim = WorldSimulation::new(&beam(false), &[]).unwrap();
    sim.advance(SECOND);
    near(torque(&sim), -9.81 * 2.0 * 0.4);
}

#[test]
fn a_difference_is_to_what_was_and_nothing_at_rest() {
    let turned = SignalTerm::JointPosition(JointId(0));
    let change = Signal { terms: vec![SignalTerm::Delta(SignalId(0), SECOND)], ..number("change", turned) };
    let mut sim = WorldSimulation::new(&beam(false), &[number("turned", turned), change]).unwrap();
    settle(&mut sim);
    assert!(sim.now() >= SECOND, "as long as anything changes");
    let lift = MotorCommand::ReachJoints { arm: ArmId(0), positions: vec![-0.2], max_speed: None };
    sim.command(lift).unwrap();
    let (mut fastest, mut history) = (0.0f64, Vec::new());
    while let Some(next) = sim.next_wake() {
        sim.advance(next);
        fastest = fastest.min(sim.measure(&SignalTerm::JointRate(JointId(0))).as_f64().unwrap());
        history.push(float(&sim, 0));
        let before = history.len().checked_sub(101).map_or(0.0, |at| history[at]);
        let rests = sim.next_wake().is_none();
        assert!(rests || (float(&sim, 1) - (float(&sim, 0) - before)).abs() < 1e-5, "at {next}");
    }
    assert!((float(&sim, 0) + 0.2).abs() < 0.01 && fastest < -0.2, "{} {fastest}", float(&sim, 0));
    assert_eq!(float(&sim, 1), 0.0, "at rest nothing has changed");
    near(sim.measure(&SignalTerm::Tilt(BodyRef::Body(BodyId(1)))).as_f64().unwrap(), 0.2);
}

#[test]
fn heights_and_tilts_are_of_the_shape_and_of_the_start() {
    let mut world = empty();
    let quarter = std::f64::consts::FRAC_PI_2;
    let shapes = [
        (cuboid(0.2, 0.4, 0.6), [0.0; 3], 0.3),
        (cuboid(0.2, 0.4, 0.6), [quarter, 0.0, 1.0], 0.2),
        (BodyShape::Sphere { radius: 0.1 }, [0.3; 3], 0.1),
        (BodyShape::Capsule { radius: 0.1, length: 0.4 }, [0.0, quarter, 0.0], 0.1),
        (BodyShape::Cylinder { radius: 0.1, length: 0.4 }, [0.0; 3], 0.2),
        (BodyShape::Cylinder { radius: 0.1, length: 0.4 }, [0.0, quarter, 0.5], 0.1),
    ];
    for (shape, rotation, _) in shapes {
        let body = body("b", BodyMotion::Kinematic, shape, [0.0, 0.0, 1.0], 1.0);
        world.bodies.push(Body { rotation, ..body });
    }
    let sim = WorldSimulation::new(&world, &[]).unwrap();
    for (at, (_, _, below)) in shapes.iter().enumerate() {
        let body = BodyRef::Body(BodyId(at as u16));
        let of = |term| sim.measure(&term).as_f64().unwrap();
        assert!((of(SignalTerm::Height(body)) - (1.0 - below)).abs() < 1e-6, "{at}");
        assert!(of(SignalTerm::Tilt(body)) < 1e-3, "{at}");
    }
}

/// A plate that a motor lifts along the vertical, with a load on it.
fn lift() -> World {
    let mut world = empty();
    world.bodies = vec![
        body("post", BodyMotion::Fixed, cuboid(0.1, 0.1, 2.0), [0.0, 0.0, 1.0], 1.0),
        body("plate", BodyMotion::Dynamic, cuboid(0.2, 0.2, 0.04), [0.4, 0.0, 1.0], 3.0),
        body("load", BodyMotion::Dynamic, cuboid(0.1, 0.1, 0.1), [0.4, 0.0, 1.0751], 1.0),
    ];
    let (motion, drive) = (JointMotion::Slider, JointDrive::default());
    let (parent, child, anchor) = (BodyId(0), BodyId(1), [0.4, 0.0, 1.0]);
    let (name, axis) = ("lift".into(), [0.0, 0.0, 1.0]);
    world.joints = vec![Joint { name, parent, child, motion, anchor, axis, lo: -0.5, hi: 0.5, drive }];
    world.arms = vec![Arm { joints: vec![JointId(0)], ..beam(false).arms[0].clone() }];
    world
}

#[test]
fn what_slides_is_measured_along_its_axis() {
    let mut sim = WorldSimulation::new(&lift(), &[]).unwrap();
    let of = |sim: &WorldSimulation, term| sim.measure(&term).as_f64().unwrap();
    let joint = JointId(0);
    sim.advance(SECOND);
    near(of(&sim, SignalTerm::JointEffort(joint)), 4.0 * 9.81);
    let (plate, load) = (BodyRef::Body(BodyId(1)), BodyRef::Body(BodyId(2)));
    for by in [None, Some(load)] {
        near(of(&sim, SignalTerm::Pressure { body: plate, by, area: 1e-2 }), 981.0);
    }
    let up = MotorCommand::FollowJoints { arm: ArmId(0), positions: vec![0.3], times: vec![1.0] };
    sim.command(up).unwrap();
    let mut fastest = 0.0f64;
    while let Some(next) = sim.next_wake() {
        sim.advance(next);
        fastest = fastest.max(of(&sim, SignalTerm::JointRate(joint)));
    }
    assert!((of(&sim, SignalTerm::JointPosition(joint)) - 0.3).abs() < 0.01, "it is up");
    assert!((0.29..0.5).contains(&fastest), "0.3 m in a second: {fastest}");
}

/// A rod that stands falls from half a metre on the edge of one that lies: the nearest points of the two are beside each other until it
/// strikes. Neither ends up in the floor.
#[test]
fn what_falls_past_an_edge_strikes_it() {
    let rod = BodyShape::Cylinder { radius: 0.02, length: 0.25 };
    for beside in 0..8 {
        for higher in 0..4 {
            let mut world = empty();
            let offset = 0.024 + 0.002 * f64::from(beside);
            let height = 0.6 + 0.007 * f64::from(higher);
            world.bodies = vec![
                body("floor", BodyMotion::Fixed, cuboid(2.0, 2.0, 0.1), [0.0, 0.0, -0.05], 1.0),
                body("lying", BodyMotion::Dynamic, rod, [0.0, 0.0, 0.0201], 0.5),
                body("falling", BodyMotion::Dynamic, rod, [offset, 0.05, height], 0.5),
            ];
            world.bodies[1].rotation = [std::f64::consts::FRAC_PI_2, 0.0, 0.0];
            let mut sim = WorldSimulation::new(&world, &[]).expect("a world");
            sim.advance(SECOND);
            assert_eq!(sim.fault(), None);
            let (deep, bodies) = sim.accuracy().penetration.unwrap_or_default();
            assert!(
                deep < 3e-3,
                "{:.2} mm: {bodies:?}, {offset:.3} m beside, from {height:.3} m",
                1e3 * deep
            );
        }
    }
}
