//! What hangs on joints without motors: damping and friction, doors and drawers, and hands that hold them by their handles.

#[path = "common/scene.rs"]
mod scene;

use hrdsl_ir::world::{ArmId, BaseId, GripperId, Vec3};
use hrdsl_sim::MotorCommand;
use scene::Scene;

const FLOOR: &str = "body floor: fixed box(10 m, 10 m, 10 cm) at (0 m, 0 m, -5 cm)";

/// A weight of 2 kg on a vertical rail, 1 m above its end.
fn rail(losses: &str) -> Scene {
    let members = format!(
        "body post: fixed box(10 cm, 10 cm, 3 m) at (0 m, 0 m, 1.5 m)
        body weight1: dynamic box(10 cm, 10 cm, 10 cm) at (20 cm, 0 m, 2 m) mass 2 kg
        joint rail: post -> weight1 at (10 cm, 0 m, 2 m) axis (0, 0, 1) limits -1 m .. 0 m {losses}
        signal way: length to robot = joint_position(rail)
        signal pace: speed to robot = joint_speed(rail)"
    );
    Scene::new(&members, &[])
}

#[test]
fn damping_and_friction_are_as_said() {
    // 2 kg at 40 Ns/m come to 0.4905 m/s.
    let mut damped = rail("damping 40 Ns/m");
    damped.go_on(1.0, |_| {});
    assert!((damped.read("pace") + 0.4905).abs() < 0.02, "{}", damped.read("pace"));
    // Of 19.62 N friction takes 10: half as fast as a free fall, and a little less.
    let mut rubbed = rail("friction 10 N");
    rubbed.go_on(0.3, |_| {});
    assert!((rubbed.read("pace") + 0.3 * 9.62 / 2.0).abs() < 0.05, "{}", rubbed.read("pace"));
}

fn desk(more: &str, stimuli: &[(&str, &str)]) -> Scene {
    let members = format!(
        "{FLOOR}
        part desk = drawer(50 cm, 90 cm) at (0 m, 0 m, 0 m)
        body cup: dynamic cylinder(3 cm, 8 cm) at (0 m, 0 m, 76.01 cm) mass 200 g
        signal open: length to robot = joint_position(desk.rail)
        {more}"
    );
    Scene::with("use std.furniture", &members, stimuli)
}

/// What hangs on a joint without losses swings on, however slowly.
#[test]
fn a_slow_door_goes_on() {
    let members = "body post: fixed box(10 cm, 10 cm, 2 m) at (0 m, 0 m, 1 m)
        body leaf: dynamic box(4 cm, 80 cm, 1 m) at (0 m, -50 cm, 1 m) mass 10 kg
        body ram: kinematic box(10 cm, 10 cm, 10 cm) at (-12 cm, -80 cm, 1 m)
        joint hinge: post -> leaf at (0 m, -10 cm, 1 m) axis (0, 0, 1) limits -10 deg .. 110 deg
        signal open: angle to robot = joint_position(hinge)
        signal swing: angular_speed to robot = joint_speed(hinge)";
    let mut scene = Scene::new(members, &[("push", "ram.move_to((-4 cm, -80 cm, 1 m), 500 ms)")]);
    scene.act("push");
    scene.go_on(1.0, |_| {});
    let (before, swing) = (scene.read("open"), scene.read("swing"));
    assert!((0.01..0.4).contains(&swing), "{swing} rad/s");
    scene.go_on(2.0, |_| {});
    let way = scene.read("open") - before;
    assert!((way - 2.0 * swing).abs() < 0.1 * swing, "{way} rad at {swing} rad/s");
}

/// A crank that stands nearly upright, and falls over: it would come round nearly whole, and swing to and fro.
fn crank(lo: f64, hi: f64) -> Scene {
    let members = format!(
        "body post: fixed box(10 cm, 10 cm, 2 m) at (0 m, 0 m, 1 m)
        body weight: dynamic box(10 cm, 10 cm, 10 cm) at (2 cm, 30 cm, 240 cm) mass 2 kg
        joint crank: post -> weight at (0 m, 30 cm, 2 m) axis (0, 1, 0) limits {lo} deg .. {hi} deg
        signal turned: angle to robot = joint_position(crank)"
    );
    Scene::new(&members, &[])
}

/// Farther than half round, and farther than a turn from end to end.
#[test]
fn a_hinge_ends_where_it_ends_however_far_it_turns() {
    // The last is met at full speed, 9 rad/s.
    for (lo, hi) in [(-20.0, 250.0), (-250.0, 20.0), (-200.0, 300.0), (-300.0, 300.0), (-20.0, 170.0)] {
        let mut scene = crank(lo, hi);
        let mut farthest: f64 = 0.0;
        scene.go_on(4.0, |scene| farthest = farthest.max(scene.read("turned").to_degrees()));
        // Falling forwards, it meets the upper end: less what it goes in a part of a step, and never more.
        assert!(farthest < hi + 0.03, "{lo} .. {hi}: {farthest}°");
        assert!(farthest > hi - 0.5, "{lo} .. {hi}: {farthest}°");
    }
}

#[test]
fn a_drawer_stays_shut_by_itself() {
    let mut scene = desk("", &[]);
    scene.go_on(2.0, |scene| assert!(scene.read("open").abs() < 1e-3, "{}", scene.read("open")));
    assert_eq!(scene.sim.next_wake(), None, "it rests");
}

#[test]
fn a_persons_hand_opens_a_drawer_by_its_handle() {
    let host = "part host = adult(172 cm) at (95 cm, -20 cm, 0 m) rotated (0 deg, 0 deg, 180 deg)
        signal held: bool to robot = holds(host.grasp, desk.handle)";
    let stimuli = [
        ("reach", "host.hand.move_to(desk.handle, 1500 ms)"),
        ("take", "host.grasp.grasp()"),
        ("pull", "host.hand.move_to(desk.handle + (25 cm, 0 m, 0 m), 2 s)"),
        ("leave", "host.grasp.let_go()"),
    ];
    let mut scene = desk(host, &stimuli);
    scene.act("reach");
    scene.go_on(2.5, |_| {});
    scene.act("take");
    scene.go_on(1.0, |_| {});
    assert_eq!(scene.read("held"), 1.0, "the hand is at {:?}", scene.at("host.hand"));
    scene.act("pull");
    scene.go_on(4.0, |_| {});
    let open = scene.read("open");
    println!("open by {open} m");
    assert!(open > 0.18, "{open}");
    // What lies in the drawer comes along.
    assert!((scene.at("cup")[0] - open).abs() < 0.03, "{:?}", scene.at("cup"));
    scene.act("leave");
    scene.go_on(2.0, |_| {});
    assert_eq!(scene.read("held"), 0.0);
    assert!((scene.read("open") - open).abs() < 0.02, "it stays open");
    assert_eq!(scene.sim.fault(), None);
}

#[test]
fn a_gripper_opens_a_drawer_by_its_handle() {
    let robot = "body stand: fixed box(10 cm, 10 cm, 1 m) at (1 m, 0 m, 50 cm)
        body palm: dynamic box(4 cm, 8 cm, 8 cm) at (36 cm, 0 m, 79.5 cm) mass 4 kg
        joint slide: stand -> palm at (50 cm, 0 m, 79.5 cm) axis (1, 0, 0) limits -10 cm .. 45 cm effort 200 N
        arm arm: slide tip palm tool (-4 cm, 0 m, 0 m) speed 0.5 rad/s
        gripper grip: palm tool (-4 cm, 0 m, 0 m) reach 4 cm delay 200 ms force 60 N
        signal held: bool to robot = holds(grip, desk.handle)
        signal push: force to robot = joint_effort(slide)";
    let mut scene = desk(robot, &[]);
    scene.sim.command(MotorCommand::CloseFingers { gripper: GripperId(0) }).expect("a gripper");
    scene.go_on(0.5, |_| {});
    assert_eq!(scene.read("held"), 1.0);
    let pull = MotorCommand::ReachJoints { arm: ArmId(0), positions: vec![0.3], max_speed: None };
    let id = scene.sim.command(pull).expect("the drawer goes along, and is in nobody's way");
    let mut hardest = 0.0f64;
    scene.go_on(4.0, |scene| hardest = hardest.max(scene.read("push")));
    let ended = scene.sim.finished();
    assert!(ended.iter().any(|(ended, result)| *ended == id && result.is_ok()), "{ended:?}");
    assert!((scene.read("open") - 0.3).abs() < 0.02, "{}", scene.read("open"));
    assert!(hardest > 4.0, "friction is to be overcome: {hardest} N");
    // Farther than it goes it does not come, and the hand slips off, or stays.
    let more = MotorCommand::FollowJoints { arm: ArmId(0), positions: vec![0.45], times: vec![1.0] };
    scene.sim.command(more).expect("an arm");
    scene.go_on(3.0, |scene| assert!(scene.read("open") < 0.385, "{}", scene.read("open")));
    assert_eq!(scene.sim.fault(), None);
}

fn corridor(motion: &str, mass: &str) -> Scene {
    let members = format!(
        "{FLOOR}
        part way = door(90 cm, 2 m) at (0 m, 0 m, 0 m)
        body chassis: {motion} cylinder(20 cm, 30 cm) at (-80 cm, -10 cm, 15 cm) {mass}
        base wheels: chassis speed 0.3 m/s turn 90 deg/s acceleration 0.5 m/s^2
        signal open: angle to robot = joint_position(way.hinge)
        signal swing: angular_speed to robot = joint_speed(way.hinge)
        signal push: force to robot = force(chassis, way.leaf)"
    );
    Scene::with("use std.furniture", &members, &[])
}

#[test]
fn a_base_pushes_a_door_open_and_drives_through() {
    for (motion, mass) in [("kinematic", ""), ("dynamic", "mass 30 kg")] {
        let mut scene = corridor(motion, mass);
        scene.go_on(1.0, |scene| assert!(scene.read("open").abs() < 1e-2, "it is shut"));
        let drive = MotorCommand::DriveWheels { base: BaseId(0), forward: 0.3, sideways: 0.0, turn: 0.0 };
        scene.sim.command(drive).expect("a base");
        let mut widest = 0.0f64;
        scene.go_on(6.0, |scene| {
            assert_eq!(scene.sim.fault(), None);
            widest = widest.max(scene.read("open"));
        });
        let at: Vec3 = scene.at("chassis");
        println!(
            "{motion}: at {at:?}, open by {} deg, at most {}",
            scene.read("open").to_degrees(),
            widest.to_degrees()
        );
        assert!(at[0] > 0.5, "{motion}: {at:?}");
        assert!((1.0..111f64.to_radians()).contains(&widest), "{motion}: {widest} rad");
    }
}
