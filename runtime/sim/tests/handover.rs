//! A table leg on its way: picked up, carried, handed over, let go, lost, thrown away.

mod common;
use common::*;
use hrdsl_ir::device::DeviceBody;
use hrdsl_ir::device_state::DeviceState;
use hrdsl_ir::world::*;
use hrdsl_ir::{Expr, Type};
use hrdsl_sim::{CommandError, MotorCommand, SimulationError, WorldSimulation};

const LEG: BodyRef = BodyRef::Current(CurrentId(0));

fn leg(world: &World, n: usize) -> BodyId {
    named(world, &format!("leg{n}"))
}

fn place(sim: &WorldSimulation, body: BodyId) -> Vec3 {
    sim.pose(body).unwrap().0
}

fn reach_for(world: &World, of: BodyRef, offset: Vec3) -> WorldAction {
    let body = named(world, "person.hand");
    WorldAction::Move { body, to: at(Some(of), offset), over: Expr::float(1.0) }
}

#[test]
fn a_leg_is_fetched_and_held_out_and_nothing_else_moves() {
    let world = table();
    let mut sim = WorldSimulation::new(&world, &[]).unwrap();
    offer(&mut sim);
    settle(&mut sim);
    assert_eq!(sim.holding(GRIP), Some(leg(&world, 1)));
    let error = distance(place(&sim, leg(&world, 1)), OFFER);
    assert!(error < 0.01, "{error}");
    let (_, q) = sim.pose(leg(&world, 1)).unwrap();
    let tilt = (q[0].powi(2) + q[1].powi(2)).sqrt() * 2.0;
    assert!(tilt < 0.15, "carried upright: {tilt} rad");
    for n in 2..=4 {
        let moved = distance(place(&sim, leg(&world, n)), LEGS[n - 1]);
        assert!(moved < 0.003, "leg {n} moved {moved}");
    }
}

#[test]
fn four_legs_go_over_to_the_person() {
    let world = table();
    let signals =
        [truth("robot", SignalTerm::Holds(GRIP, LEG)), truth("person", SignalTerm::Holds(GRASP, LEG))];
    let mut sim = WorldSimulation::new(&world, &signals).unwrap();
    for n in 1..=4 {
        let [x, y, z] = LEGS[n - 1];
        run(&mut sim, move_to([x, y, z]));
        run(&mut sim, MotorCommand::CloseFingers { gripper: GRIP });
        assert_eq!(sim.holding(GRIP), Some(leg(&world, n)), "the nearest");
        run(&mut sim, move_to([x, y, z + 0.15]));
        run(&mut sim, move_to(OFFER));
        sim.act(&reach_for(&world, LEG, [0.05, -0.1, -0.05]), &none).unwrap();
        sim.act(&WorldAction::Grasp { gripper: GRASP }, &none).unwrap();
        settle(&mut sim);
        assert!(boolean(&sim, 0) && boolean(&sim, 1), "both hold leg {n}");
        let before = place(&sim, leg(&world, n));
        run(&mut sim, MotorCommand::OpenFingers { gripper: GRIP });
        settle(&mut sim);
        assert_eq!((sim.holding(GRIP), sim.holding(GRASP)), (None, Some(leg(&world, n))));
        assert!(distance(before, place(&sim, leg(&world, n))) < 0.01, "it stays in the person's hand");
        let away = at(None, [1.0, 0.2, 0.9]);
        let hand = named(&world, "person.hand");
        sim.act(&WorldAction::Move { body: hand, to: away, over: Expr::float(1.0) }, &none).unwrap();
        settle(&mut sim);
        assert!(distance(place(&sim, leg(&world, n)), [1.0, 0.2, 0.9]) < 0.15, "and goes with it");
        sim.act(&WorldAction::LetGo { gripper: GRASP }, &none).unwrap();
        settle(&mut sim);
        assert!(place(&sim, leg(&world, n))[2] < 0.3, "until it is let go of");
    }
}

#[test]
fn a_leg_is_thrown_away() {
    let world = table();
    let mut sim = WorldSimulation::new(&world, &[]).unwrap();
    offer(&mut sim);
    run(&mut sim, move_to(DISCARD));
    run(&mut sim, MotorCommand::OpenFingers { gripper: GRIP });
    settle(&mut sim);
    assert_eq!(sim.holding(GRIP), None);
    let [x, y, z] = place(&sim, leg(&world, 1));
    assert!((x - DISCARD[0]).abs() < 0.3 && (y - DISCARD[1]).abs() < 0.3 && z < 0.2, "{x} {y} {z}");
    run(&mut sim, move_to(REST));
}

#[test]
fn the_two_may_hold_at_once_without_a_fight() {
    let world = table();
    let mut sim = WorldSimulation::new(&world, &[number("speed", SignalTerm::JointSpeed(ARM))]).unwrap();
    offer(&mut sim);
    sim.act(&reach_for(&world, LEG, [0.05, -0.1, -0.05]), &none).unwrap();
    sim.act(&WorldAction::Grasp { gripper: GRASP }, &none).unwrap();
    sim.advance(sim.now() + 2 * SECOND);
    assert_eq!(sim.holding(GRASP), Some(leg(&world, 1)));
    let before = place(&sim, leg(&world, 1));
    // The hand goes on; the robot keeps the leg, and the hand loses it.
    sim.act(&reach_for(&world, LEG, [0.3, -0.3, 0.2]), &none).unwrap();
    let mut fastest: f64 = 0.0;
    for _ in 0..200 {
        sim.advance(sim.now() + STEP);
        fastest = fastest.max(float(&sim, 0));
    }
    assert!(fastest < 0.02, "the arm stands: {fastest}");
    assert_eq!((sim.holding(GRIP), sim.holding(GRASP)), (Some(leg(&world, 1)), None));
    assert!(distance(before, place(&sim, leg(&world, 1))) < 1e-3);
}

#[test]
fn a_grasp_waits_for_what_comes() {
    let world = table();
    let mut sim = WorldSimulation::new(&world, &[]).unwrap();
    sim.act(&WorldAction::Grasp { gripper: GRASP }, &none).unwrap();
    settle(&mut sim);
    assert_eq!(sim.holding(GRASP), None);
    sim.act(&reach_for(&world, BodyRef::Body(leg(&world, 1)), [0.0, 0.08, 0.0]), &none).unwrap();
    settle(&mut sim);
    assert_eq!(sim.holding(GRASP), Some(leg(&world, 1)));
}

#[test]
fn a_gripper_that_closes_on_nothing_holds_nothing_afterwards() {
    let world = table();
    let mut sim = WorldSimulation::new(&world, &[truth("any", SignalTerm::HoldsAny(GRIP))]).unwrap();
    let time = run(&mut sim, MotorCommand::CloseFingers { gripper: GRIP });
    assert!((0.4..0.55).contains(&time), "{time}");
    assert!(!boolean(&sim, 0));
    run(&mut sim, MotorCommand::OpenFingers { gripper: GRIP });
    run(&mut sim, move_to(LEGS[0]));
    assert_eq!(sim.holding(GRIP), None);
}

#[test]
fn the_current_leg_is_the_held_or_the_next_or_the_last() {
    let world = table();
    let x = SignalTerm::Coordinate(LEG, Axis::Y);
    let mut sim = WorldSimulation::new(&world, &[number("y", x)]).unwrap();
    let y = |sim: &WorldSimulation| float(sim, 0);
    assert!((y(&sim) - LEGS[0][1]).abs() < 1e-3);
    offer(&mut sim);
    assert!((y(&sim) - OFFER[1]).abs() < 0.01, "the held one");
    run(&mut sim, MotorCommand::OpenFingers { gripper: GRIP });
    assert!((y(&sim) - LEGS[1][1]).abs() < 1e-3, "the next");
}

#[test]
fn opening_while_closing_replaces_it() {
    let world = table();
    let mut sim = WorldSimulation::new(&world, &[]).unwrap();
    let close = sim.command(MotorCommand::CloseFingers { gripper: GRIP }).unwrap();
    sim.advance(SECOND / 4);
    let open = sim.command(MotorCommand::OpenFingers { gripper: GRIP }).unwrap();
    sim.advance(SECOND);
    assert_eq!(sim.finished(), vec![(close, Err(CommandError::Replaced)), (open, Ok(()))]);
}

#[test]
fn actions_that_cannot_be_are_refused() {
    let world = table();
    let mut sim = WorldSimulation::new(&world, &[]).unwrap();
    let leg1 = leg(&world, 1);
    let action = WorldAction::Move { body: leg1, to: at(None, REST), over: Expr::float(1.0) };
    assert_eq!(sim.act(&action, &none), Err(SimulationError::NotMoved { body: "leg1".into() }));
    let hand = named(&world, "person.hand");
    let action = WorldAction::Move { body: hand, to: at(None, REST), over: Expr::Var(0) };
    assert!(matches!(sim.act(&action, &none), Err(SimulationError::Eval { .. })));
    let action = WorldAction::Grasp { gripper: GripperId(9) };
    assert!(matches!(sim.act(&action, &none), Err(SimulationError::BadReference { .. })));
}

#[test]
fn a_world_that_makes_no_sense_is_refused() {
    let refuse = |change: &dyn Fn(&mut World)| {
        let mut world = table();
        change(&mut world);
        WorldSimulation::new(&world, &[]).err().map(|e| e.to_string()).unwrap_or_default()
    };
    assert!(refuse(&|w| w.step = 0).contains("physics step"));
    assert!(refuse(&|w| w.bodies[3].mass = -1.0).contains("mass of body `robot.waist"));
    assert!(
        refuse(&|w| w.bodies[0].shape = BodyShape::Sphere { radius: f64::NAN }).contains("measure of body")
    );
    assert!(refuse(&|w| w.joints[2].child = BodyId(99)).contains("body 99"));
    assert!(refuse(&|w| w.arms[0].joints.swap(0, 1)).contains("not a chain"));
    assert!(refuse(&|w| w.arms[0].joints.clear()).contains("tip of the arm"));
    assert!(refuse(&|w| w.arms[0].tip = BodyId(0)).contains("tip of the arm"));
    assert!(refuse(&|w| w.joints[2].child = BodyId(2)).contains("dynamic body"));
    assert!(refuse(&|w| w.grippers[0].palm = BodyId(77)).contains("body 77"));
    assert!(refuse(&|w| w.grippers[0].holds.push(BodyId(1))).contains("cannot hold `stand`"));
    assert!(refuse(&|w| w.currents[0].of.clear()).contains("current"));
    let signal = signal("far", Type::Bool, vec![SignalTerm::HoldsAny(GripperId(4))], Expr::Var(0));
    let error = WorldSimulation::new(&table(), &[signal]).err().unwrap();
    assert_eq!(error.to_string(), "signal `far` refers to gripper 4, which does not exist");
}

/// The table with legs of another mass.
fn legs_of(mass: f64) -> World {
    let mut world = table();
    world.bodies.iter_mut().filter(|b| b.name.starts_with("leg")).for_each(|leg| leg.mass = mass);
    world
}

#[test]
fn what_is_too_heavy_stays_where_it_is() {
    for mass in [50.0, 500.0] {
        let world = legs_of(mass);
        let mut sim = WorldSimulation::new(&world, &[]).unwrap();
        run(&mut sim, move_to(LEGS[0]));
        run(&mut sim, MotorCommand::CloseFingers { gripper: GRIP });
        let [x, y, z] = LEGS[0];
        if let Ok(id) = sim.command(move_to([x, y, z + 0.15])) {
            wait(&mut sim, id, |_| {}).1.ok();
        }
        settle(&mut sim);
        let there = place(&sim, leg(&world, 1));
        assert!(distance(there, LEGS[0]) < 0.03, "{mass} kg went to {there:?}");
    }
}

/// Friction of 0.8 on both sides and 40 N bear 64 N: 6.5 kg, less what the lift asks for.
#[test]
fn what_the_fingers_can_bear_comes_along_and_what_they_cannot_slips() {
    let lifted = |mass: f64, force: f64| {
        let mut world = legs_of(mass);
        world.grippers[0].force = force;
        let mut sim = WorldSimulation::new(&world, &[]).unwrap();
        run(&mut sim, move_to(LEGS[0]));
        run(&mut sim, MotorCommand::CloseFingers { gripper: GRIP });
        assert_eq!(sim.holding(GRIP), Some(leg(&world, 1)), "the fingers are around it");
        let [x, y, z] = LEGS[0];
        run(&mut sim, move_to([x, y, z + 0.15]));
        settle(&mut sim);
        place(&sim, leg(&world, 1))[2] - z
    };
    assert!((lifted(2.0, 40.0) - 0.15).abs() < 0.02);
    assert!(lifted(2.0, 8.0) < 0.05, "12.8 N are too little for 2 kg");
}

#[test]
fn a_gripper_tells_where_its_fingers_are() {
    let world = table();
    let mut sim = WorldSimulation::new(&world, &[]).unwrap();
    let fingers =
        |sim: &WorldSimulation| sim.told(DeviceBody::Gripper(GRIP), DeviceState::FingerPlaces).unwrap();
    let open = fingers(&sim);
    assert_eq!(open.len(), world.grippers[0].fingers.len());
    run(&mut sim, MotorCommand::CloseFingers { gripper: GRIP });
    let closed = fingers(&sim);
    assert!(
        open.iter().zip(&closed).all(|(open, closed)| (open - closed).abs() > 0.01),
        "{open:?} to {closed:?}"
    );
    run(&mut sim, MotorCommand::OpenFingers { gripper: GRIP });
    let again = fingers(&sim);
    assert!(
        open.iter().zip(&again).all(|(open, again)| (open - again).abs() < 0.002),
        "{open:?} to {again:?}"
    );
    assert_eq!(sim.told(DeviceBody::Gripper(GRIP), DeviceState::JointAngles), None);
}

#[test]
fn fingers_stop_at_what_they_hold_and_what_is_let_go_falls() {
    let world = table();
    let mut sim = WorldSimulation::new(&world, &[]).unwrap();
    offer(&mut sim);
    let before = place(&sim, leg(&world, 1));
    run(&mut sim, MotorCommand::OpenFingers { gripper: GRIP });
    settle(&mut sim);
    assert!(place(&sim, leg(&world, 1))[2] < before[2] - 0.3, "it fell");
}

#[test]
fn a_world_that_starts_in_collision_is_refused() {
    let mut world = table();
    let first = leg(&world, 1);
    world.bodies[usize::from(first.0)].position = [0.3, -0.3, 0.40];
    match WorldSimulation::new(&world, &[]) {
        Err(SimulationError::StartsInside { body, other, depth }) => {
            assert_eq!((body.as_str(), other.as_str()), ("stand", "leg1"));
            assert!(depth > 0.05, "{depth}");
        }
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("it was built"),
    }
}
