//! The arm: reaches its places in time, keeps its speed, refuses what it cannot do.

mod common;
use common::*;
use hrdsl_ir::Expr;
use hrdsl_ir::{device::DeviceBody, device_state::DeviceState, world::*};
use hrdsl_sim::{
    ArmTarget, CommandError, CommandId, MotionPlanRequest, MotorCommand, PlannedTrajectory, WorldSimulation,
};
use proptest::prelude::*;

fn speeds() -> Vec<Signal> {
    vec![number("speed", SignalTerm::JointSpeed(ARM))]
}

/// The places of the interaction with a leg, in an order that occurs.
fn tour(leg: Vec3) -> [Vec3; 6] {
    let above = [leg[0], leg[1], leg[2] + 0.15];
    [above, leg, above, OFFER, DISCARD, REST]
}

/// The table when the legs before this one have been taken away.
fn table_at(leg: usize) -> World {
    let mut world = table();
    for n in 1..=leg {
        let body = named(&world, &format!("leg{n}"));
        world.bodies[usize::from(body.0)].position = [1.5, 0.2 * n as f64, 0.125];
    }
    world
}

#[test]
fn reaches_all_places_within_the_limit_of_speed() {
    let (mut fastest, mut moved): (f64, f64) = (0.0, 0.0);
    for (n, leg) in LEGS.into_iter().enumerate() {
        let mut sim = WorldSimulation::new(&table_at(n), &speeds()).unwrap();
        let mut before = sim.joint_positions(ARM);
        for target in tour(leg) {
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
            assert!((0.5..=15.0).contains(&time), "{target:?}: {time} s");
        }
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

/// A wall between the arm and the place, and too wide to go round.
fn walled() -> World {
    let mut world = table();
    let wall = body("wall", BodyMotion::Fixed, cuboid(0.05, 3.0, 1.6), [0.56, 0.0, 0.8], 1.0);
    world.bodies.push(wall);
    world
}

#[test]
fn a_place_without_a_free_way_is_refused_with_what_is_in_the_way() {
    let mut sim = WorldSimulation::new(&walled(), &[]).unwrap();
    match sim.command(move_to([0.7, 0.1, 0.75])) {
        Err(CommandError::Obstructed { by, .. }) => assert_eq!(by, "wall"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn an_arm_goes_round_what_is_in_its_way() {
    let world = posted();
    let post = BodyRef::Body(named(&world, "post"));
    let parts = ["palm", "forearm", "elbow", "upper_arm"];
    let terms: Vec<_> = parts.map(|part| BodyRef::Body(named(&world, &format!("robot.{part}")))).into();
    let signals: Vec<_> = terms.iter().map(|t| number("gap", SignalTerm::Distance(*t, post))).collect();
    let mut sim = WorldSimulation::new(&world, &signals).unwrap();
    let id = sim.command(move_to(OFFER)).unwrap();
    let (_, result) = wait(&mut sim, id, |sim| (0..4).for_each(|i| assert!(float(sim, i) > 1e-3, "{i}")));
    result.unwrap();
}

/// The way to a place within the speed, and the acceleration to that in half a second or another one.
fn timed(sim: &WorldSimulation, target: Vec3, speed: f64, rise: f64) -> PlannedTrajectory {
    let limits = |limit: f64| Some(vec![limit; 9]);
    let (speeds, accelerations) = (limits(speed), limits(speed / rise));
    sim.plan(ARM, &MotionPlanRequest { to: ArmTarget::Place(target), from: None, speeds, accelerations })
        .unwrap()
}

/// Begins to go along a plan.
fn follow(sim: &mut WorldSimulation, way: &PlannedTrajectory) -> CommandId {
    let positions = way.points.iter().flat_map(|point| point.positions.clone()).collect();
    let times = way.points.iter().map(|point| point.time).collect();
    sim.command(MotorCommand::FollowJoints { arm: ARM, positions, times }).unwrap()
}

/// A world with a post in the way of the arm.
fn posted() -> World {
    let mut world = table();
    let post = body("post", BodyMotion::Fixed, cuboid(0.06, 0.06, 0.9), [0.48, -0.05, 0.45], 1.0);
    world.bodies.push(post);
    world
}

#[test]
fn a_plan_takes_the_time_and_goes_the_way_of_the_arms_own_motion() {
    let mut corners = Vec::new();
    for (world, target) in [(table(), LEGS[0]), (table(), DISCARD), (posted(), OFFER)] {
        let [mut own, mut planned] = [&world, &world].map(|w| WorldSimulation::new(w, &[]).unwrap());
        let way = timed(&planned, target, 0.2, 0.5);
        corners.push(way.corners.len());
        let mut ways = [Vec::new(), Vec::new()];
        let id = own.command(move_to(target)).unwrap();
        let (time, result) = wait(&mut own, id, |sim| ways[0].push(sim.joint_positions(ARM)));
        result.unwrap();
        let id = follow(&mut planned, &way);
        let (again, result) = wait(&mut planned, id, |sim| ways[1].push(sim.joint_positions(ARM)));
        result.unwrap();
        println!("{target:?}: {time} s, {again} s, {} corners", way.corners.len());
        assert!((time - again).abs() < 1.5 * STEP as f64 / 1e9, "{target:?}: {time} s, and {again} s");
        let [own, planned] = &ways;
        for (a, b) in own.iter().flatten().zip(planned.iter().flatten()) {
            assert!((a - b).abs() < 2e-3, "{target:?}: {a}, {b}");
        }
    }
    assert!(corners[1] == 2 && corners[2] > 2, "one is straight, and one goes round the post: {corners:?}");
}

#[test]
fn the_points_of_a_plan_keep_its_speeds_and_fit_each_other() {
    let sim = WorldSimulation::new(&posted(), &[]).unwrap();
    for (speed, rise) in [(0.2, 0.5), (0.05, 0.5), (0.2, 0.25), (1.0, 0.5)] {
        let way = timed(&sim, OFFER, speed, rise);
        let (first, last) = (&way.points[0], &way.points[way.points.len() - 1]);
        assert!(first.time == 0.0 && first.velocities.iter().chain(&last.velocities).all(|v| *v == 0.0));
        for pair in way.points.windows(2) {
            let (a, b) = (&pair[0], &pair[1]);
            let h = b.time - a.time;
            assert!((0.0..=0.05 + 1e-9).contains(&h), "{h}");
            for joint in 0..9 {
                assert!(b.velocities[joint].abs() <= speed * 1.001, "{} rad/s", b.velocities[joint]);
                let mean = (a.velocities[joint] + b.velocities[joint]) / 2.0;
                let moved = b.positions[joint] - a.positions[joint];
                assert!((moved - mean * h).abs() < 0.1 * speed * h, "at {} s: {moved}, {mean}", a.time);
            }
        }
    }
    // On a straight way, ramps of half the length take a quarter of a second off.
    let sim = WorldSimulation::new(&table(), &[]).unwrap();
    let length = |rise| timed(&sim, DISCARD, 0.2, rise).points.last().unwrap().time;
    assert!((length(0.5) - length(0.25) - 0.25).abs() < 1e-9);
}

#[test]
fn a_plan_may_begin_elsewhere_and_refuses_numbers_that_make_no_sense() {
    let sim = WorldSimulation::new(&table(), &[]).unwrap();
    let mut from = vec![0.0; 9];
    from[2] = 0.3;
    let to = ArmTarget::Posture(vec![0.0; 9]);
    let wanted = MotionPlanRequest { to, from: Some(from.clone()), speeds: None, accelerations: None };
    let way = sim.plan(ARM, &wanted).unwrap();
    assert_eq!((&way.corners[0], &way.points[0].positions), (&from, &from));
    assert_eq!(way.points.last().unwrap().positions, vec![0.0; 9]);
    let asks = |change: &dyn Fn(&mut MotionPlanRequest)| {
        let mut wanted = wanted.clone();
        change(&mut wanted);
        sim.plan(ARM, &wanted).unwrap_err()
    };
    let short = asks(&|w| w.from = Some(vec![0.0; 3]));
    assert_eq!(short, CommandError::WrongJointCount { expected: 9, given: 3 });
    assert_eq!(asks(&|w| w.from = Some(vec![f64::NAN; 9])), CommandError::NotFinite);
    assert_eq!(asks(&|w| w.speeds = Some(vec![0.0; 9])), CommandError::BadSpeed);
    let few = CommandError::WrongLimitCount { expected: 9, given: 1 };
    assert_eq!(asks(&|w| w.accelerations = Some(vec![1.0])), few);
}

/// The links are told what hangs on them, and the solver finds the rest: it left the shoulder 0.4 mm apart.
#[test]
fn the_links_of_an_arm_hang_together() {
    let mut sim = WorldSimulation::new(&table(), &[]).unwrap();
    settle(&mut sim);
    assert_eq!(sim.accuracy().joint_gap, None);
    run(&mut sim, move_to(OFFER));
    let (apart, joint) = sim.accuracy().joint_gap.unwrap_or_default();
    println!("{joint}: {:.3} mm", 1e3 * apart);
    assert!(apart < 5e-5, "{joint} is {apart} m apart");
}

/// What the planner does not know of, since nobody is where they will be: the arm pushes no harder than its motors can, gives up,
/// and does not leap when the way is free again.
#[test]
fn a_blocked_arm_gives_up_and_stays() {
    let mut world = table();
    let head = named(&world, "person.head");
    world.bodies[usize::from(head.0)].position = [0.48, 0.0, 0.75];
    let mut sim = WorldSimulation::new(&world, &speeds()).unwrap();
    let id = sim.command(move_to(OFFER)).unwrap();
    let (_, result) = wait(&mut sim, id, |_| {});
    assert_eq!(result, Err(CommandError::Blocked { by: Some("person.head".into()) }));
    // Off the arm, and not along it, which it would be drawn with.
    let away = WorldAction::Move { body: head, to: at(None, [0.48, 2.0, 0.75]), over: Expr::float(0.1) };
    sim.act(&away, &none).unwrap();
    let start = sim.now();
    while sim.now() - start < SECOND {
        sim.advance(sim.now() + STEP);
        assert!(float(&sim, 0) < 0.5, "{}", float(&sim, 0));
    }
}

/// Lets the motors aim at one posture after the other, a step each.
fn stream<'a>(sim: &mut WorldSimulation, postures: impl Iterator<Item = &'a Vec<f64>>) {
    for posture in postures {
        for (joint, to) in posture.iter().enumerate() {
            sim.command(MotorCommand::AimJoint { arm: ARM, joint: joint as f64, to: *to }).unwrap();
        }
        sim.advance(sim.now() + STEP);
    }
}

/// Set-points that lead it into a head and back again: it presses, and comes free, and so it does by a motion of its own.
#[test]
fn an_arm_that_presses_is_freed_by_what_leads_it_away() {
    let way = way_to_the_offer();
    let mut world = table();
    let head = named(&world, "person.head");
    world.bodies[usize::from(head.0)].position = [0.48, 0.0, 0.75];
    let press = number("press", SignalTerm::ForceOn(BodyRef::Body(head)));
    for own_motion in [false, true] {
        let mut sim = WorldSimulation::new(&world, std::slice::from_ref(&press)).unwrap();
        // Farther, and it may slip past.
        let presses = |posture: &Vec<f64>| {
            stream(&mut sim, std::iter::once(posture));
            float(&sim, 0) > 50.0
        };
        let reached = way.iter().position(presses).expect("it presses");
        if own_motion {
            let positions = way[0].clone();
            run(&mut sim, MotorCommand::ReachJoints { arm: ARM, positions, max_speed: None });
        } else {
            stream(&mut sim, way[..=reached].iter().rev());
            settle(&mut sim);
        }
        assert_eq!(float(&sim, 0), 0.0, "it presses still");
        for (is, should) in sim.joint_positions(ARM).iter().zip(&way[0]) {
            assert!((is - should).abs() < 0.01, "{is} {should}");
        }
    }
}

/// Set-points that it never gets to: it slips along a head that does not give way, until it gets no farther, and presses for ever; the
/// world rests nevertheless.
#[test]
fn an_arm_that_something_keeps_from_its_set_points_rests_as_it_presses() {
    let mut world = table();
    let head = named(&world, "person.head");
    let at = &mut world.bodies[usize::from(head.0)];
    (at.position, at.motion) = ([0.48, 0.0, 0.75], BodyMotion::Fixed);
    let press = number("press", SignalTerm::ForceOn(BodyRef::Body(head)));
    let way = way_to_the_offer();
    let mut sim = WorldSimulation::new(&world, &[press]).unwrap();
    stream(&mut sim, way.iter());
    sim.advance(sim.now() + 30 * SECOND);
    assert_eq!(sim.next_wake(), None, "nothing moves any more");
    let (force, stood) = (float(&sim, 0), sim.joint_positions(ARM).to_vec());
    assert!(force > 20.0, "{force} N");
    sim.advance(sim.now() + 60 * SECOND);
    assert_eq!((float(&sim, 0), sim.joint_positions(ARM).to_vec()), (force, stood));
    stream(&mut sim, way.iter().take(1));
    settle(&mut sim);
    assert_eq!(float(&sim, 0), 0.0, "it goes away when it is told to");
}

#[test]
fn an_arm_that_feels_contacts_stops_at_them() {
    let mut world = table();
    let head = named(&world, "person.head");
    world.bodies[usize::from(head.0)].position = [0.48, 0.0, 0.75];
    world.arms[0].contact_limit = Some(20.0);
    let mut sim = WorldSimulation::new(&world, &speeds()).unwrap();
    let id = sim.command(move_to(OFFER)).unwrap();
    let (_, result) = wait(&mut sim, id, |_| {});
    match result {
        Err(CommandError::Pressed { by, force }) => {
            assert!(by == "person.head" && force > 20.0, "{by} {force}")
        }
        other => panic!("{other:?}"),
    }
}

/// A head is in the straight way: an arm that is told to goes round it, another is held up by it.
#[test]
fn a_way_goes_round_people_by_choice() {
    for avoids_people in [false, true] {
        let mut world = table();
        let head = named(&world, "person.head");
        world.bodies[usize::from(head.0)].position = [0.45, -0.1, 0.65];
        world.arms[0].avoids_people = avoids_people;
        let palm = BodyRef::Body(named(&world, "robot.palm"));
        let near = number("near", SignalTerm::Distance(palm, BodyRef::Body(head)));
        let press = number("press", SignalTerm::ForceOn(BodyRef::Body(head)));
        let mut sim = WorldSimulation::new(&world, &[near, press]).unwrap();
        let id = sim.command(move_to(OFFER)).unwrap();
        let (mut least, mut most) = (f64::INFINITY, 0.0f64);
        let (time, result) = wait(&mut sim, id, |sim| {
            (least, most) = (least.min(float(sim, 0)), most.max(float(sim, 1)));
        });
        println!(
            "avoids people: {avoids_people}: {time:.1} s, {result:?}, palm {least:.3} m off, {most:.1} N"
        );
        if avoids_people {
            result.unwrap();
            assert!(least > 0.003 && most == 0.0, "{least} m, {most} N");
        } else {
            assert!(matches!(result, Err(CommandError::Blocked { .. })), "{result:?}");
            assert!(most > 1.0, "{most}");
        }
    }
}

/// The hand would be free to go there straight; the leg in it would come down on those that stand on the table.
#[test]
fn what_is_held_is_carried_round_what_is_in_its_way() {
    let world = table();
    let mut sim = WorldSimulation::new(&world, &[]).unwrap();
    offer(&mut sim);
    let before: Vec<_> = (2..=4).map(|n| sim.pose(named(&world, &format!("leg{n}"))).unwrap().0).collect();
    run(&mut sim, move_to([0.25, -0.364_991_916_910_975_4, 0.863_797_002_890_894_4]));
    run(&mut sim, move_to([0.25, -0.376_013_335_522_837_94, 0.75]));
    assert!(sim.holding(GRIP).is_some());
    for (n, before) in (2..=4).zip(before) {
        let moved = distance(before, sim.pose(named(&world, &format!("leg{n}"))).unwrap().0);
        assert!(moved < 0.003, "leg {n} moved {moved}");
    }
}

/// A ball that bounces on somebody's head, far away, divides the steps; the arm goes as if it did not.
#[test]
fn a_blow_elsewhere_does_not_jolt_the_arm() {
    let fastest = |with_ball: bool| {
        let mut world = table();
        if with_ball {
            let mut head =
                body("head", BodyMotion::Guided, BodyShape::Sphere { radius: 0.1 }, [3.0, 3.0, 1.0], 4.4);
            head.stiffness = Some(75e3);
            world.bodies.push(head);
            let ball = BodyShape::Sphere { radius: 0.05 };
            world.bodies.push(body("ball", BodyMotion::Dynamic, ball, [3.0, 3.0, 1.4], 0.5));
        }
        let mut sim = WorldSimulation::new(&world, &speeds()).unwrap();
        let (mut fastest, mut ways) = (0.0f64, Vec::new());
        let id = sim.command(move_to(LEGS[0])).unwrap();
        let (_, result) = wait(&mut sim, id, |sim| {
            fastest = fastest.max(float(sim, 0));
            ways.push(sim.told(DeviceBody::Arm(ARM), DeviceState::JointAngles).unwrap());
        });
        result.unwrap();
        (fastest, ways)
    };
    let (alone, beside) = (fastest(false), fastest(true));
    let off =
        |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let off = alone.1.iter().zip(&beside.1).map(off).fold(0.0, f64::max);
    println!("{} {} rad/s, {off} rad", alone.0, beside.0);
    assert!((alone.0 - beside.0).abs() < 2e-3 && alone.1.len() == beside.1.len() && off < 2e-3);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn the_limit_holds_whatever_is_asked_and_however_soon(
        places in proptest::collection::vec(
            (0.25f64..0.55, -0.4f64..0.4, 0.75f64..1.0, 200_000_000i64..8_000_000_000), 1..8),
    ) {
        let world = table();
        let mut sim = WorldSimulation::new(&world, &speeds()).unwrap();
        offer(&mut sim);
        for (x, y, z, time) in places {
            match sim.command(move_to([x, y, z])) {
                Ok(_) | Err(CommandError::Unreachable { .. } | CommandError::Obstructed { .. }) => {}
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
            let fits = matches!(result, Ok(()) | Err(CommandError::Replaced));
            prop_assert!(fits, "{id:?} {result:?}");
        }
    }
}
