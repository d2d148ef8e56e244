//! Bases on wheels: they drive as they are told, are pushed, slip, and topple.

mod common;
#[path = "common/scene.rs"]
mod scene;

use hrdsl_ir::world::BaseId;
use hrdsl_sim::MotorCommand;
use scene::Scene;

const FLOOR: &str = "body floor: fixed box(20 m, 20 m, 10 cm) at (0 m, 0 m, -5 cm)";
const BASE: BaseId = BaseId(0);

/// A rover of 20 kg, whose mast is so high and bears so much.
fn rover(motion: &str, mast: &str, load: &str, more: &str) -> Scene {
    let members = format!(
        "{FLOOR}
        body chassis: {motion} box(40 cm, 40 cm, 20 cm) at (0 m, 0 m, 10 cm) mass 20 kg
        body mast: dynamic box(6 cm, 6 cm, {mast}) at (0 m, 0 m, 20 cm + 0.5 * {mast}) mass {load}
        joint weld: chassis -> mast at (0 m, 0 m, 20 cm) axis (0, 0, 1) limits 0 deg .. 0 deg
        base wheels: chassis speed 1 m/s turn 2 rad/s acceleration 1 m/s^2
        signal tipped: angle to robot = tilt(chassis)
        signal pace: speed to robot = speed(chassis)
        {more}"
    );
    Scene::new(&members, &[])
}

fn drive(scene: &mut Scene, forward: f64, turn: f64) {
    let command = MotorCommand::DriveWheels { base: BASE, forward, sideways: 0.0, turn };
    scene.sim.command(command).expect("a base");
}

#[test]
fn a_free_way_is_that_of_a_kinematic_base() {
    let mut ends = Vec::new();
    for motion in ["dynamic", "kinematic"] {
        let mut scene = rover(motion, "40 cm", "2 kg", "");
        for (forward, turn, time) in
            [(0.5, 0.0, 2.0), (0.5, 1.0, 3.0), (0.0, -2.0, 1.0), (0.8, 0.3, 2.0), (0.0, 0.0, 2.0)]
        {
            drive(&mut scene, forward, turn);
            scene.go_on(time, |_| {});
        }
        ends.push(scene.sim.base_pose(BASE).expect("a base"));
        assert_eq!(scene.sim.next_wake(), None, "it rests");
    }
    let off = (ends[0][0] - ends[1][0]).hypot(ends[0][1] - ends[1][1]);
    println!("{ends:?}");
    assert!(off < 0.03 && (ends[0][2] - ends[1][2]).abs() < 0.02, "{ends:?}");
}

#[test]
fn a_wall_holds_it_and_it_does_not_climb() {
    let mut scene = rover(
        "dynamic",
        "40 cm",
        "2 kg",
        "body wall: fixed box(10 cm, 4 m, 1 m) at (1 m, 0 m, 50 cm)
        signal most: force to robot = force(chassis, wall)",
    );
    drive(&mut scene, 0.5, 0.0);
    scene.go_on(5.0, |_| {});
    let [x, y, _] = scene.sim.base_pose(BASE).expect("a base");
    assert!((x - 0.75).abs() < 5e-3 && y.abs() < 5e-3, "{x} {y}");
    // No harder than tyres grip.
    assert!(
        scene.read("most") < 0.8 * 22.0 * 9.81 * 1.1 && scene.read("tipped") < 0.1,
        "{}",
        scene.read("most")
    );
}

#[test]
fn a_top_heavy_one_falls_when_it_is_struck_and_stays_down() {
    let ram = "body ram: kinematic box(10 cm, 40 cm, 10 cm) at (-80 cm, 0 m, 1 m)";
    let mut scene = rover("dynamic", "1 m", "15 kg", ram);
    let to = hrdsl_ir::world::WorldPoint::free(None, [0.6, 0.0, 1.0].map(hrdsl_ir::Expr::float));
    let push =
        hrdsl_ir::world::WorldAction::Move { body: scene.body("ram"), to, over: hrdsl_ir::Expr::float(1.0) };
    scene.sim.act(&push, &|_| None).expect("kinematic");
    scene.go_on(4.0, |_| {});
    assert!(scene.read("tipped") > 1.2, "{}", scene.read("tipped"));
    let before = scene.sim.base_pose(BASE).expect("a base");
    drive(&mut scene, 1.0, 0.0);
    scene.go_on(2.0, |_| {});
    let after = scene.sim.base_pose(BASE).expect("a base");
    assert!((before[0] - after[0]).hypot(before[1] - after[1]) < 0.01, "{before:?} {after:?}");
}

#[test]
fn the_same_one_stands_when_it_brakes() {
    let mut scene = rover("dynamic", "1 m", "15 kg", "");
    drive(&mut scene, 1.0, 0.0);
    scene.go_on(3.0, |_| {});
    assert!((scene.read("pace") - 1.0).abs() < 0.01, "{}", scene.read("pace"));
    scene.sim.command(MotorCommand::StopWheels { base: BASE }).expect("a base");
    scene.go_on(3.0, |_| {});
    assert!(
        scene.read("tipped") < 0.01 && scene.read("pace") < 1e-3,
        "{} {}",
        scene.read("tipped"),
        scene.read("pace")
    );
}

#[test]
fn a_person_it_runs_into_feels_its_weight() {
    let person = "part host = adult(172 cm) at (1.5 m, 0 m, 0 m) rotated (0 deg, 0 deg, 180 deg)
        signal shin: force to robot = transient_force(host.lower_leg) + quasistatic_force(host.lower_leg)
          + transient_force(host.left_lower_leg) + quasistatic_force(host.left_lower_leg)";
    let mut found = Vec::new();
    for step in [10_000_000, 5_000_000, 2_000_000, 1_000_000] {
        let mut scene = rover("dynamic", "40 cm", "2 kg", person);
        scene.at_step(step);
        drive(&mut scene, 0.5, 0.0);
        let mut most = 0.0f64;
        scene.go_on(4.0, |s| most = most.max(s.read("shin")));
        found.push(most);
    }
    // Two legs of 75 kg each on 60 N/mm, and 22 kg at 0.5 m/s; the tyres go on pushing as hard as they grip, but are told so at their
    // next control period: up to 10 ms late, which is a quarter of such a blow.
    let expected =
        |late: f64| common::two_masses_pushed_late(22.0, 150.0, 120e3, 0.5, 0.8 * 22.0 * 9.81, late);
    let (least, largest) = (expected(10e-3), expected(0.0));
    println!("{found:?} N, by the formula {least:.0} to {largest:.0} N");
    let finest = found.last().expect("steps");
    for most in &found {
        assert!(
            *most > 0.95 * least && *most < 1.05 * largest && (most / finest - 1.0).abs() < 0.1,
            "{found:?} for {least} to {largest}"
        );
    }
}

/// The motors of the arm know of no base that gives way, and the base of no arm: each would make good what the other did, and more.
#[test]
fn an_arm_as_heavy_as_its_base_does_not_set_it_swinging() {
    let arm = "body lift: dynamic box(10 cm, 10 cm, 30 cm) at (0 m, 0 m, 75 cm) mass 4 kg
        body beam: dynamic box(70 cm, 8 cm, 8 cm) at (40 cm, 0 m, 80 cm) mass 8 kg
        joint rise: mast -> lift at (0 m, 0 m, 60 cm) axis (0, 0, 1) limits -10 cm .. 10 cm effort 2000 N
        joint swing: lift -> beam at (0 m, 0 m, 80 cm) axis (0, 0, 1) limits -90 deg .. 90 deg effort 60 Nm rotor 0.05 kgm^2
        arm arm: rise, swing tip beam tool (35 cm, 0 m, 0 m) speed 1 rad/s";
    let mut scene = rover("dynamic", "60 cm", "2 kg", arm);
    drive(&mut scene, 0.25, 0.0);
    let mut turn: f64 = 0.0;
    scene.go_on(4.0, |scene| turn = turn.max(scene.sim.base_velocity(BASE).expect("a base")[2].abs()));
    let [x, y, heading] = scene.sim.base_pose(BASE).expect("a base");
    println!("{x} {y} {heading} {turn}");
    assert!(
        (x - 0.97).abs() < 0.01 && y.abs() < 0.005 && heading.abs() < 0.005 && turn < 0.01,
        "{x} {y} {heading} {turn}"
    );
    scene.sim.command(MotorCommand::StopWheels { base: BASE }).expect("a base");
    scene.go_on(3.0, |_| {});
    assert_eq!(scene.sim.next_wake(), None, "it rests");
}
