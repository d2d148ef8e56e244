//! The arm: reaches its places in time, keeps its speed, refuses what it cannot do.

mod common;
use common::*;
use hrdsl_ir::world::*;
use hrdsl_sim::{CommandError, MotorCommand, WorldSimulation};
use proptest::prelude::*;

fn speeds() -> Vec<Signal> {
    vec![number("speed", SignalTerm::JointSpeed(ARM))]
}

/// Every place of the interaction, in an order that occurs.
fn tour() -> Vec<Vec3> {
    let mut places = Vec::new();
    for leg in LEGS {
        let above = [leg[0], leg[1], leg[2] + 0.15];
        places.extend([above, leg, above, OFFER, DISCARD, REST]);
    }
    places
}

#[test]
fn reaches_all_places_within_the_limit_of_speed() {
    let world = table();
    let mut sim = WorldSimulation::new(&world, &speeds()).unwrap();
    let (mut fastest, mut moved): (f64, f64) = (0.0, 0.0);
    let mut before = sim.joint_positions(ARM);
    for target in tour() {
        let id = sim.command(move_to(target)).unwrap_or_else(|e| panic!("{target:?}: {e}"));
        let (time, result) = wait(&mut sim, id, |sim| {
            fastest = fastest.max(float(sim, 0));
            let now = sim.joint_positions(ARM);
            for (a, b) in now.iter().zip(&before) {
                moved = moved.max((a - b).abs() / (STEP as f64 / 1e9));
            }
            before = now;
        });
        let error = distance(sim.tool(ARM).unwrap(), target);
        println!("{target:?}: {time:.2} s, {:.2} mm off, at most {fastest:.3} rad/s", error * 1e3);
        result.unwrap();
        assert!(error <= 0.005, "{target:?}: {error}");
        assert!((0.5..=12.0).contains(&time), "{target:?}: {time} s");
    }
    assert!(fastest > 0.15 && fastest < 0.25, "{fastest}");
    assert!(moved > 0.15 && moved < 0.25, "{moved}");
}

#[test]
fn the_physics_step_may_be_finer_or_coarser() {
    for step in [2_000_000, 5_000_000, 20_000_000] {
        let mut world = table();
        world.step = step;
        let mut sim = WorldSimulation::new(&world, &speeds()).unwrap();
        for target in [LEGS[0], OFFER] {
            let id = sim.command(move_to(target)).unwrap();
            let mut fastest: f64 = 0.0;
            let (_, result) = wait(&mut sim, id, |s| fastest = fastest.max(float(s, 0)));
            println!("{step}: {fastest} {:?}", sim.tool(ARM));
            result.unwrap();
            assert!(fastest > 0.15 && fastest < 0.25, "{step}: {fastest}");
        }
    }
}

#[test]
fn what_is_out_of_reach_is_refused_with_the_distance() {
    let world = table();
    let mut sim = WorldSimulation::new(&world, &[]).unwrap();
    match sim.command(move_to([3.0, 0.0, 1.0])) {
        Err(CommandError::Unreachable { distance }) => assert!((1.7..2.3).contains(&distance), "{distance}"),
        other => panic!("{other:?}"),
    }
    assert!(sim.finished().is_empty());
}

#[test]
fn joints_go_where_they_are_told_together() {
    let world = table();
    let mut sim = WorldSimulation::new(&world, &speeds()).unwrap();
    let mut goal = vec![0.0; 9];
    goal[0] = 0.5;
    goal[3] = 0.25;
    goal[5] = -0.4;
    let command = MotorCommand::ReachJoints { arm: ARM, positions: goal.clone(), max_speed: Some(0.1) };
    let id = sim.command(command).unwrap();
    let mut fastest: f64 = 0.0;
    let (time, result) = wait(&mut sim, id, |s| fastest = fastest.max(float(s, 0)));
    result.unwrap();
    assert!((5.4..6.0).contains(&time), "0.5 rad at 0.1 rad/s, and half a second: {time}");
    assert!(fastest < 0.125, "{fastest}");
    for (is, should) in sim.joint_positions(ARM).iter().zip(&goal) {
        assert!((is - should).abs() < 0.005, "{is} {should}");
    }
}

#[test]
fn wrong_commands_are_refused() {
    let world = table();
    let mut sim = WorldSimulation::new(&world, &[]).unwrap();
    let joints = |positions: Vec<f64>| MotorCommand::ReachJoints { arm: ARM, positions, max_speed: None };
    assert_eq!(
        sim.command(joints(vec![0.0; 3])),
        Err(CommandError::WrongJointCount { expected: 9, given: 3 })
    );
    let mut far = vec![0.0; 9];
    far[5] = -3.0;
    assert_eq!(
        sim.command(joints(far)),
        Err(CommandError::OutOfLimits { joint: "robot.elbow_flexor".into() })
    );
    assert_eq!(sim.command(joints(vec![f64::NAN; 9])), Err(CommandError::NotFinite));
    assert_eq!(sim.command(move_to([f64::INFINITY, 0.0, 0.0])), Err(CommandError::NotFinite));
    let slow = MotorCommand::ReachPoint { arm: ARM, target: REST, max_speed: Some(0.0) };
    assert_eq!(sim.command(slow), Err(CommandError::BadSpeed));
    let nobody = MotorCommand::ReachPoint { arm: ArmId(7), target: REST, max_speed: None };
    assert_eq!(sim.command(nobody), Err(CommandError::NoSuchArm));
    assert_eq!(
        sim.command(MotorCommand::OpenFingers { gripper: GripperId(9) }),
        Err(CommandError::NoSuchGripper)
    );
}

#[test]
fn a_later_command_replaces_an_earlier_without_a_jerk() {
    let world = table();
    let mut sim = WorldSimulation::new(&world, &speeds()).unwrap();
    let first = sim.command(move_to(OFFER)).unwrap();
    sim.advance(2 * SECOND);
    let second = sim.command(move_to(LEGS[0])).unwrap();
    assert_eq!(sim.finished(), vec![(first, Err(CommandError::Replaced))]);
    let mut last = float(&sim, 0);
    let mut jerk: f64 = 0.0;
    let (_, result) = wait(&mut sim, second, |s| {
        jerk = jerk.max((float(s, 0) - last).abs());
        last = float(s, 0);
        assert!(last < 0.25, "{last}");
    });
    result.unwrap();
    assert!(jerk < 0.03, "{jerk} rad/s in a step");
}

#[test]
fn what_is_in_the_way_makes_the_command_fail_with_the_distance() {
    let mut world = table();
    let wall = body("wall", BodyMotion::Fixed, cuboid(0.05, 1.0, 0.8), [0.56, 0.2, 0.7], 1.0);
    world.bodies.push(wall);
    let mut sim = WorldSimulation::new(&world, &[]).unwrap();
    let id = sim.command(move_to([0.7, 0.1, 0.75])).unwrap();
    let (_, result) = wait(&mut sim, id, |_| {});
    match result {
        Err(CommandError::Missed { distance }) => assert!(distance > 0.02, "{distance}"),
        Ok(()) | Err(_) => panic!("{result:?}"),
    }
}

/// The table with the leg that the robot fetches, and no others beside it, which would stand where that one is to go.
fn table_with_one_leg() -> World {
    let mut world = table();
    let leg = named(&world, "leg1");
    world.bodies.truncate(usize::from(leg.0) + 1);
    for gripper in &mut world.grippers {
        gripper.holds = vec![leg];
    }
    for current in &mut world.currents {
        current.of = vec![leg];
    }
    world
}

/// The hand would be free to go there; the leg in it would come down beside those that stand on the table.
#[test]
fn what_is_held_is_stopped_by_what_is_in_its_way() {
    let last = |world: &World| {
        let mut sim = WorldSimulation::new(world, &[]).unwrap();
        offer(&mut sim);
        sim.command(move_to([0.25, -0.364_991_916_910_975_4, 0.863_797_002_890_894_4])).unwrap();
        sim.advance(sim.now() + 3_540_000_000);
        let id = sim.command(move_to([0.25, -0.376_013_335_522_837_94, 0.75])).unwrap();
        let (_, result) = wait(&mut sim, id, |_| {});
        assert!(sim.holding(GRIP).is_some());
        result
    };
    match last(&table()) {
        Err(CommandError::Missed { distance }) => assert!((0.01..0.1).contains(&distance), "{distance}"),
        other => panic!("{other:?}"),
    }
    assert_eq!(last(&table_with_one_leg()), Ok(()));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn the_limit_holds_whatever_is_asked_and_however_soon(
        places in proptest::collection::vec(
            (0.25f64..0.55, -0.4f64..0.4, 0.75f64..1.0, 200_000_000i64..8_000_000_000), 1..8),
    ) {
        let world = table_with_one_leg();
        let mut sim = WorldSimulation::new(&world, &speeds()).unwrap();
        offer(&mut sim);
        for (x, y, z, time) in places {
            match sim.command(move_to([x, y, z])) {
                Ok(_) | Err(CommandError::Unreachable { .. }) => {}
                Err(other) => prop_assert!(false, "{other}"),
            }
            let until = sim.now() + time;
            while sim.now() < until {
                sim.advance(sim.now() + STEP);
                prop_assert!(float(&sim, 0) < 0.25, "{}", float(&sim, 0));
            }
        }
        prop_assert!(sim.holding(GRIP).is_some());
        settle(&mut sim);
        for (id, result) in sim.finished() {
            prop_assert!(!matches!(result, Err(CommandError::Missed { .. })), "{id:?} {result:?}");
        }
    }
}
