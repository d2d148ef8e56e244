//! The sensors: true and false where the case study's ranges say so, and each term by itself.

mod common;
use common::*;
use hrdsl_ir::expr::{BinaryOp, NumberFunction};
use hrdsl_ir::world::*;
use hrdsl_ir::{Enumeration, Expr, Span, Symbol, Type, Value};
use hrdsl_sim::{MotorCommand, WorldSimulation};

const LEG: BodyRef = BodyRef::Current(CurrentId(0));

fn le(a: Expr, b: f64) -> Expr {
    Expr::binary(BinaryOp::Le, a, Expr::float(b))
}

fn and(a: Expr, b: Expr) -> Expr {
    Expr::binary(BinaryOp::And, a, b)
}

fn apart(a: u16, b: u16) -> Expr {
    Expr::Call(NumberFunction::Abs, vec![Expr::binary(BinaryOp::Sub, Expr::Var(a), Expr::Var(b))])
}

/// Line of sight: offset at most 0.2 m, distance at most 0.6 m, angle below 40°.
fn gaze(head: BodyRef) -> Signal {
    let terms = vec![
        SignalTerm::Coordinate(head, Axis::Y),
        SignalTerm::Coordinate(LEG, Axis::Y),
        SignalTerm::Range(head, LEG),
        SignalTerm::Angle(head, LEG),
        SignalTerm::Visible(head, LEG),
    ];
    let near = and(le(apart(0, 1), 0.2), le(Expr::Var(2), 0.6));
    let value = and(and(near, le(Expr::Var(3), 40f64.to_radians())), Expr::Var(4));
    signal("gaze", Type::Bool, terms, value)
}

fn pressure() -> Signal {
    let terms = vec![SignalTerm::Holds(GRIP, LEG), SignalTerm::Holds(GRASP, LEG)];
    signal("pressure", Type::Bool, terms, and(Expr::Var(0), Expr::Var(1)))
}

/// The hand within 0.3 m of the leg along each axis.
fn location(hand: BodyRef) -> Signal {
    let mut terms = Vec::new();
    for axis in [Axis::X, Axis::Y, Axis::Z] {
        terms.extend([SignalTerm::Coordinate(hand, axis), SignalTerm::Coordinate(LEG, axis)]);
    }
    let value = and(le(apart(0, 1), 0.3), and(le(apart(2, 3), 0.3), le(apart(4, 5), 0.3)));
    signal("location", Type::Bool, terms, value)
}

fn look(head: BodyId, offset: f64, distance: f64, angle: f64) -> WorldAction {
    WorldAction::Look {
        body: head,
        at: LEG,
        offset: Expr::float(offset),
        distance: Expr::float(distance),
        angle: Expr::float(angle.to_radians()),
    }
}

#[test]
fn gaze_pressure_and_location_follow_the_person() {
    let world = table();
    let (head, hand) = (named(&world, "person.head"), named(&world, "person.hand"));
    let (h, p) = (BodyRef::Body(head), BodyRef::Body(hand));
    let angle = number("angle", SignalTerm::Angle(h, LEG));
    let range = number("range", SignalTerm::Range(h, LEG));
    let mut sim = WorldSimulation::new(&world, &[gaze(h), pressure(), location(p), angle, range]).unwrap();
    offer(&mut sim);
    assert_eq!([0, 1, 2].map(|i| boolean(&sim, i)), [false; 3]);
    let good =
        [(0.1, 0.5, 15.0), (0.19, 0.59, 39.0), (0.1, 0.59, 15.0), (0.19, 0.5, 30.0), (0.15, 0.55, 20.0)];
    let bad = [(0.21, 0.61, 41.0), (0.5, 0.8, 50.0), (0.3, 0.7, 45.0), (0.1, 0.61, 20.0), (0.15, 0.55, 45.0)];
    for (looks, expected) in [(good, true), (bad, false), (good, true)] {
        for (offset, distance, degrees) in looks {
            sim.act(&look(head, offset, distance, degrees), &none).unwrap();
            sim.advance(sim.now() + SECOND);
            assert_eq!(boolean(&sim, 0), expected, "{offset} {distance} {degrees}");
            assert!((float(&sim, 3).to_degrees() - degrees).abs() < 0.1, "{}", float(&sim, 3));
            assert!((float(&sim, 4) - distance).abs() < 1e-3, "{}", float(&sim, 4));
        }
    }
    let reach = |sim: &mut WorldSimulation, offset: Vec3| {
        let action = WorldAction::Move { body: hand, to: at(Some(LEG), offset), over: Expr::float(1.0) };
        sim.act(&action, &none).unwrap();
        sim.advance(sim.now() + 2 * SECOND);
    };
    reach(&mut sim, [0.05, -0.1, -0.05]);
    assert!(boolean(&sim, 2) && !boolean(&sim, 1));
    sim.act(&WorldAction::Grasp { gripper: GRASP }, &none).unwrap();
    sim.advance(sim.now() + SECOND);
    assert!(boolean(&sim, 2) && boolean(&sim, 1));
    for (offset, distance, degrees) in good {
        sim.act(&look(head, offset, distance, degrees), &none).unwrap();
        sim.advance(sim.now() + SECOND);
        assert!(boolean(&sim, 0), "{offset} {distance} {degrees}: past the hand");
    }
    for offset in [[0.5, -0.5, 0.5], [0.75, -0.75, 0.75]] {
        reach(&mut sim, offset);
        assert!(!boolean(&sim, 2) && !boolean(&sim, 1));
    }
}

/// A ball, a long box beyond it, and a board that may be between them.
fn scene(board: Option<f64>, ghost: bool) -> World {
    let mut world = table();
    world.bodies = vec![
        body("eye", BodyMotion::Kinematic, BodyShape::Sphere { radius: 0.1 }, [0.0, 0.0, 1.0], 1.0),
        body("box", BodyMotion::Fixed, cuboid(0.1, 0.1, 0.9), [2.0, 0.0, 1.0], 1.0),
    ];
    if let Some(height) = board {
        let mut b = body("board", BodyMotion::Fixed, cuboid(0.02, 2.0, height), [1.0, 0.0, 1.0], 1.0);
        b.ghost = ghost;
        world.bodies.push(b);
    }
    world.joints.clear();
    world.arms.clear();
    world.grippers.clear();
    world.currents.clear();
    world
}

const EYE: BodyRef = BodyRef::Body(BodyId(0));
const BOX: BodyRef = BodyRef::Body(BodyId(1));

#[test]
fn a_line_of_sight_is_broken_by_bodies_but_not_by_ghosts() {
    let seen = |world: &World| {
        let sim = WorldSimulation::new(world, &[truth("visible", SignalTerm::Visible(EYE, BOX))]).unwrap();
        boolean(&sim, 0)
    };
    assert!(seen(&scene(None, false)));
    assert!(seen(&scene(Some(0.1), false)), "a third of the way to an end is seen over the board");
    assert!(!seen(&scene(Some(0.5), false)));
    assert!(seen(&scene(Some(0.5), true)));
}

#[test]
fn distance_is_between_surfaces_and_range_between_centres() {
    let world = scene(None, false);
    let signals = [
        number("distance", SignalTerm::Distance(EYE, BOX)),
        number("range", SignalTerm::Range(EYE, BOX)),
        number("z", SignalTerm::Coordinate(BOX, Axis::Z)),
        number("angle", SignalTerm::Angle(EYE, BOX)),
        number("speed", SignalTerm::Speed(EYE)),
    ];
    let mut sim = WorldSimulation::new(&world, &signals).unwrap();
    for (i, expected) in [1.85, 2.0, 1.0, 0.0, 0.0].into_iter().enumerate() {
        assert!((float(&sim, i as u16) - expected).abs() < 1e-5, "{i}: {}", float(&sim, i as u16));
    }
    let action = WorldAction::Move { body: BodyId(0), to: at(None, [0.0, 2.0, 1.0]), over: Expr::float(2.0) };
    sim.act(&action, &none).unwrap();
    sim.advance(SECOND);
    assert!((float(&sim, 4) - 1.5).abs() < 0.02, "the fastest of a smooth step: {}", float(&sim, 4));
    settle(&mut sim);
    assert!((float(&sim, 3) - 45f64.to_radians()).abs() < 1e-4);
    assert_eq!(float(&sim, 4), 0.0);
    let action = WorldAction::Move { body: BodyId(0), to: at(None, [1.9, 0.0, 1.0]), over: Expr::float(0.0) };
    sim.act(&action, &none).unwrap();
    settle(&mut sim);
    assert_eq!(float(&sim, 0), 0.0, "they overlap");
}

#[test]
fn every_shape_has_distances_and_is_seen() {
    for (shape, near) in [
        (BodyShape::Sphere { radius: 0.2 }, 1.7),
        (BodyShape::Capsule { radius: 0.2, length: 0.5 }, 1.7),
        (BodyShape::Cylinder { radius: 0.2, length: 0.5 }, 1.7),
        (cuboid(0.4, 0.4, 0.5), 1.7),
    ] {
        let mut world = scene(None, false);
        world.bodies[1].shape = shape;
        let signals = [
            number("distance", SignalTerm::Distance(EYE, BOX)),
            truth("visible", SignalTerm::Visible(EYE, BOX)),
        ];
        let sim = WorldSimulation::new(&world, &signals).unwrap();
        assert!((float(&sim, 0) - near).abs() < 1e-4, "{shape:?}: {}", float(&sim, 0));
        assert!(boolean(&sim, 1), "{shape:?}");
    }
    // A cylinder stands along z.
    let mut world = scene(None, false);
    world.bodies[1].shape = BodyShape::Cylinder { radius: 0.1, length: 1.0 };
    world.bodies[1].position = [0.0, 0.0, 2.0];
    let sim = WorldSimulation::new(&world, &[number("distance", SignalTerm::Distance(EYE, BOX))]).unwrap();
    assert!((float(&sim, 0) - 0.4).abs() < 1e-4, "{}", float(&sim, 0));
}

#[test]
fn the_hand_near_the_closing_gripper_is_seen() {
    let world = table();
    let hand = named(&world, "person.hand");
    let palm = named(&world, "robot.palm");
    let near = number("near", SignalTerm::Distance(BodyRef::Body(hand), BodyRef::Body(palm)));
    let mut sim = WorldSimulation::new(&world, &[near]).unwrap();
    run(&mut sim, move_to(LEGS[0]));
    assert!(float(&sim, 0) > 0.3);
    let of = Some(BodyRef::Body(palm));
    sim.act(&WorldAction::Move { body: hand, to: at(of, [0.0, 0.1, 0.0]), over: Expr::float(1.0) }, &none)
        .unwrap();
    sim.advance(sim.now() + 2 * SECOND);
    assert!(float(&sim, 0) < 0.05, "{}", float(&sim, 0));
    run(&mut sim, MotorCommand::CloseFingers { gripper: GRIP });
}

#[test]
fn an_expression_without_a_value_reads_as_not_a_number_or_false_or_the_first_symbol() {
    let world = scene(None, false);
    let zero = Expr::binary(BinaryOp::Div, Expr::float(1.0), Expr::float(0.0));
    let number = Signal {
        name: "n".into(),
        ty: Type::Float(hrdsl_ir::Unit::None),
        to: Vec::new(),
        terms: Vec::new(),
        value: zero.clone(),
        recorded: true,
        origin: Span::default(),
    };
    let truth = signal("t", Type::Bool, Vec::new(), le(zero.clone(), 1.0));
    let pace = Type::Enum(Enumeration::intern("Pace", &["slow", "fast"]));
    let name = |s: &str| Box::new(Expr::Const(Value::Symbol(Symbol::intern(s))));
    let choice = |yes: Expr| Expr::If(Box::new(yes), name("fast"), name("slow"));
    let symbol = signal("s", pace, Vec::new(), choice(le(zero, 1.0)));
    let known = signal("k", pace, Vec::new(), choice(Expr::bool(true)));
    let sim = WorldSimulation::new(&world, &[number, truth, symbol, known]).unwrap();
    assert!(float(&sim, 0).is_nan());
    assert!(!boolean(&sim, 1));
    assert_eq!(sim.read(SignalId(2)).to_string(), "slow");
    assert_eq!(sim.read(SignalId(3)).to_string(), "fast");
}
