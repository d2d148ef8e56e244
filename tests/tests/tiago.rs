//! TIAGo of the standard library: it drives as it is told, the push that topples it is the one that its masses ask for, and, with
//! `HRDSL_TIAGO=FOLDER`, it does what its manufacturer's description does.
//!
//! FOLDER is the `share` of the package `example-robot-data`, in which `example-robot-data/robots/tiago_description` lies (`pip install
//! --target D example-robot-data`: `D/cmeel.prefix/share`). `HRDSL_TIAGO=FOLDER cargo test -p hrdsl-tests --test tiago -- --nocapture`
//! says what it compared.

#![allow(clippy::disallowed_methods, reason = "the test reads a folder that is named by the environment")]

use std::{env, fs, path::Path};

use hrdsl_compiler::{InputFile, ModuleLoader, ModuleText, RobotEntry, RobotReader, compile_with};
use hrdsl_ir::{
    Expr, Program,
    value::SECOND,
    world::{ArmId, BaseId, SignalId, World, WorldAction, WorldPoint},
};
use hrdsl_sim::{MotorCommand, WorldSimulation};

const BASE: BaseId = BaseId(0);
const G: f64 = 9.81;

struct Scene {
    program: Program,
    sim: WorldSimulation,
}

struct WholeDisk;

impl ModuleLoader for WholeDisk {
    fn load(&self, _from: &str, _path: &str) -> Result<ModuleText, String> {
        Err("there are no modules here".to_owned())
    }

    fn robots(&self) -> Option<Box<dyn RobotReader + '_>> {
        Some(Box::new(WholeDisk))
    }
}

impl RobotReader for WholeDisk {
    fn bytes(&self, file: &str) -> Result<Vec<u8>, String> {
        fs::read(file).map_err(|error| error.to_string())
    }

    fn entries(&self, folder: &str) -> Result<Vec<RobotEntry>, String> {
        let entries = fs::read_dir(folder).map_err(|error| error.to_string())?;
        let entry = |e: fs::DirEntry| RobotEntry {
            name: e.file_name().to_string_lossy().into_owned(),
            is_folder: e.path().is_dir(),
        };
        Ok(entries.flatten().map(entry).collect())
    }

    fn is_file(&self, file: &str) -> bool {
        Path::new(file).is_file()
    }
}

impl Scene {
    fn new(parts: &str, members: &str) -> Scene {
        let text = format!(
            "scenario scene\nuse std.robots.tiago\nactor robot : system\n{parts}\nworld {{\n  body floor: fixed box(20 m, 20 m, 10 cm) at \
             (0 m, 0 m, -5 cm)\n{members}\n}}\n"
        );
        let compiled = compile_with(InputFile { name: "scene.hri", text: &text }, &[], &WholeDisk);
        let said: Vec<String> =
            compiled.diagnostics.iter().filter(|d| d.is_error()).map(|d| format!("{d:?}")).collect();
        let program = compiled.program.unwrap_or_else(|| panic!("{text}\n{}", said.join("\n")));
        let sim = WorldSimulation::new(program.world.as_ref().unwrap(), &program.signals).unwrap();
        Scene { program, sim }
    }

    fn world(&self) -> &World {
        self.program.world.as_ref().unwrap()
    }

    fn read(&self, name: &str) -> f64 {
        let at = self.program.signals.iter().position(|s| s.name == name).unwrap();
        self.sim.read(SignalId(u16::try_from(at).unwrap())).as_f64().unwrap()
    }

    fn go_on(&mut self, seconds: f64, mut each: impl FnMut(&Scene)) {
        let end = self.sim.now() + (seconds * 1e9) as hrdsl_ir::Nanos;
        while self.sim.now() < end {
            self.sim.advance(self.sim.now() + SECOND / 100);
            each(self);
        }
    }

    fn send(&mut self, body: &str, to: [f64; 3], over: f64) {
        let body = self.sim.body_named(body).unwrap();
        let to = WorldPoint::free(None, to.map(Expr::float));
        self.sim.act(&WorldAction::Move { body, to, over: Expr::float(over) }, &|_| None).unwrap();
    }

    /// Lets the ram push slowly, until what it pushes lies, or the ram is past; gives the force as that begins to tip, N.
    fn push_over(&mut self) -> f64 {
        self.go_on(1.0, |_| {});
        self.send("ram", [0.5, 0.0, 0.75], 40.0);
        // On the mean: the force of a single step tells of the solver, too.
        let (mut sum, mut steps) = (0.0, 0.0);
        self.go_on(42.0, |scene| {
            if (0.005..0.03).contains(&scene.read("tipped")) {
                sum += scene.read("push");
                steps += 1.0;
            }
        });
        sum / steps
    }

    /// The mass of the robot, and its centre.
    fn weight(&self) -> (f64, [f64; 3]) {
        let own = self.world().bodies.iter().filter(|b| b.name.starts_with("robot."));
        own.fold((0.0, [0.0; 3]), |(mass, centre), b| {
            let sum = mass + b.mass;
            (sum, std::array::from_fn(|i| (centre[i] * mass + b.position[i] * b.mass) / sum))
        })
    }
}

fn tiago(members: &str) -> Scene {
    Scene::new(
        "",
        &format!(
            "  part robot = tiago at (0 m, 0 m, 0 m)\n  signal tipped: angle to robot = tilt(robot.chassis)\n{members}"
        ),
    )
}

#[test]
fn it_drives_as_it_is_told() {
    let mut scene = tiago("");
    let mut off: f64 = 0.0;
    scene.go_on(1.0, |_| {});
    for at in 0..50 {
        scene
            .sim
            .command(MotorCommand::DriveWheels { base: BASE, forward: 0.25, sideways: 0.0, turn: 0.0 })
            .unwrap();
        scene.go_on(0.1, |scene| {
            let [forward, _, turn] = scene.sim.base_velocity(BASE).unwrap();
            if at >= 5 {
                off = off.max((forward - 0.25).abs()).max(turn.abs());
            }
        });
    }
    println!("within {off} m/s and rad/s");
    assert!(off < 0.002, "{off}");
    scene.go_on(3.0, |_| {});
    assert_eq!(scene.sim.next_wake(), None, "it rests");
    assert!(scene.read("tipped") < 0.01);
}

/// A push that is slow enough turns it about its front casters when its moment is greater than that of its weight, F h > m g r; but the
/// back that is pushed rises, and friction holds it down: F (h - 0.8 b) > m g r, where b is how far behind the casters it is.
#[test]
fn the_push_that_topples_it_is_that_of_its_masses() {
    let ram = "  body ram: kinematic box(10 cm, 30 cm, 2 cm) at (-30 cm, 0 m, 75 cm)\n  signal push: force to robot = force(robot.column, ram)";
    let mut scene = tiago(ram);
    let (mass, centre) = scene.weight();
    let lever = 0.1535 - centre[0];
    let behind = 0.1535 + 0.062 + 0.115;
    let needed = mass * G * lever / (0.75 - 0.8 * behind);
    let took = scene.push_over();
    println!(
        "{mass:.1} kg, {:.3} m high, lever {lever:.3} m: {needed:.0} N at 75 cm; it took {took:.0} N",
        centre[2]
    );
    assert!((took / needed - 1.0).abs() < 0.2, "{took} N, and not {needed} N");
    assert!(scene.read("tipped") > 1.0, "it lies: {}", scene.read("tipped"));
}

/// At the height of the axles it takes more than its wheels grip: it slides.
#[test]
fn a_low_push_moves_it() {
    let ram = "  body ram: kinematic box(10 cm, 30 cm, 2 cm) at (-40 cm, 0 m, 10 cm)";
    let mut scene = tiago(ram);
    let (mass, centre) = scene.weight();
    assert!(mass * G * (0.1535 - centre[0]) / 0.1 > 0.8 * mass * G);
    scene.go_on(1.0, |_| {});
    scene.send("ram", [0.6, 0.0, 0.1], 10.0);
    let mut most: f64 = 0.0;
    scene.go_on(12.0, |scene| most = most.max(scene.read("tipped")));
    assert!(
        most < 0.1 && scene.sim.base_pose(BASE).unwrap()[0] > 0.5,
        "{most} {:?}",
        scene.sim.base_pose(BASE)
    );
}

/// A dog of 6 kg pushes with 60 N and 8 N for each kg at most; at its height of 30 cm that is too little. One that is set where
/// the robot stands has no such limit.
#[test]
fn a_dog_that_walks_does_not_topple_it_and_one_that_is_set_does() {
    let mut tipped = Vec::new();
    for (body, over) in [("guided", 0.2), ("kinematic", 0.0)] {
        let suffix = if body == "guided" { " mass 6 kg" } else { "" };
        let dog = format!("  body dog: {body} box(30 cm, 15 cm, 30 cm) at (-60 cm, 0 m, 15 cm){suffix}");
        let mut scene = tiago(&dog);
        let (mass, centre) = scene.weight();
        assert!(60.0 + 6.0 * 8.0 < mass * G * (0.1535 - centre[0]) / 0.3, "what a dog can do");
        scene.go_on(1.0, |_| {});
        let mut most: f64 = 0.0;
        for at in 1..=15 {
            scene.send("dog", [-0.6 + 0.1 * f64::from(at), 0.0, 0.15], over);
            scene.go_on(0.2, |scene| most = most.max(scene.read("tipped")));
        }
        scene.go_on(2.0, |scene| most = most.max(scene.read("tipped")));
        assert_eq!(scene.sim.fault(), None);
        tipped.push(most);
    }
    println!("tipped by {tipped:?} rad");
    assert!(tipped[0] < 0.1 && tipped[1] > 1.0, "{tipped:?}");
}

/// The points of the postures are the manufacturer's, and the bodies are ours: it must come through all of them.
#[test]
fn it_goes_through_the_points_of_its_postures() {
    let world = tiago("").world().clone();
    let mut played = 0;
    for (at, arm) in world.arms.iter().enumerate() {
        for posture in arm.postures.iter().filter(|posture| !posture.points.is_empty()) {
            let arm = ArmId(u16::try_from(at).unwrap());
            let (first, last) = (&posture.points[0], posture.points.last().unwrap());
            let mut scene = tiago("");
            let positions = first.angles.clone();
            scene.sim.command(MotorCommand::ReachJoints { arm, positions, max_speed: None }).unwrap();
            scene.go_on(12.0, |_| {});
            let arrived: Vec<_> = scene.sim.finished();
            assert!(matches!(arrived.as_slice(), [(_, Ok(()))]), "{}: {arrived:?}", posture.name);
            let times = posture.points.iter().map(|point| point.time - first.time).collect();
            let positions = posture.points.iter().flat_map(|point| point.angles.clone()).collect();
            scene.sim.command(MotorCommand::FollowJoints { arm, positions, times }).unwrap();
            // One of them asks for a joint that is faster than the arm may be.
            scene.go_on(last.time - first.time + 3.0, |_| {});
            let arrived: Vec<_> = scene.sim.finished();
            assert!(matches!(arrived.as_slice(), [(_, Ok(()))]), "{}: {arrived:?}", posture.name);
            let state = scene.sim.joint_positions(arm);
            let off = state.iter().zip(&last.angles).map(|(is, to)| (is - to).abs()).fold(0.0, f64::max);
            println!("{}: {:.1} mrad from its end, {:?}", posture.name, 1e3 * off, scene.sim.accuracy());
            assert!(off < 0.01, "{}: {state:?}", posture.name);
            assert!(
                scene.sim.accuracy().self_penetration.is_none(),
                "{}: {:?}",
                posture.name,
                scene.sim.accuracy()
            );
            played += 1;
        }
    }
    assert_eq!(played, 3);
}

/// The angles of the starting posture, as the description counts them.
const START: [(&str, f64); 8] = [
    ("torso_lift_joint", 0.33),
    ("arm_1_joint", 0.953),
    ("arm_2_joint", 0.727),
    ("arm_3_joint", 0.001),
    ("arm_4_joint", 2.3),
    ("arm_5_joint", 1.231),
    ("arm_6_joint", 0.002),
    ("arm_7_joint", -0.94),
];

/// Which bodies of the library stand for which links.
const LINKS: [(&str, &[&str]); 9] = [
    ("lift", &["torso_lift_link"]),
    ("torso", &["torso_fixed_link"]),
    ("neck", &["head_1_link"]),
    ("arm_1_link", &["arm_1_link"]),
    ("arm_2_link", &["arm_2_link"]),
    ("arm_3_link", &["arm_3_link"]),
    ("arm_4_link", &["arm_4_link"]),
    ("arm_5_link", &["arm_5_link"]),
    ("arm_6_link", &["arm_6_link"]),
];

/// Pushed at 75 cm, both fall, and at as great a force: that of the greatest moment of each.
fn compare_pushes(part: &str) {
    let ram = "  body ram: kinematic box(10 cm, 30 cm, 2 cm) at (-35 cm, 0 m, 75 cm)";
    let members = |base: &str| {
        format!(
            "{ram}\n  signal push: force to robot = force(ram)\n  signal tipped: angle to robot = tilt(robot.{base})"
        )
    };
    let mut took = Vec::new();
    let here = Scene::new("", &format!("  part robot = tiago at (0 m, 0 m, 0 m)\n{}", members("chassis")));
    let there = format!("  part robot = described at (0 m, 0 m, 0 m)\n{}", members("base_link"));
    for mut scene in [here, Scene::new(part, &there)] {
        took.push(scene.push_over());
        assert!(scene.read("tipped") > 1.0, "it stands: {took:?} N");
    }
    println!("toppled by {:.0} N, and {:.0} N", took[0], took[1]);
    assert!((took[0] / took[1] - 1.0).abs() < 0.15, "{took:?}");
}

#[test]
#[expect(clippy::too_many_lines, reason = "one comparison after the other")]
fn the_description_is_the_same_robot() {
    let Some(folder) = env::var_os("HRDSL_TIAGO") else { return };
    let folder = folder.to_string_lossy();
    let urdf = format!("{folder}/example-robot-data/robots/tiago_description/robots/tiago_no_hand.urdf");
    let names: Vec<&str> = START.iter().map(|(name, _)| *name).collect();
    let start: Vec<String> = START
        .iter()
        .map(|(name, at)| format!("{name} = {at} {}", if name.starts_with("torso") { "m" } else { "rad" }))
        .collect();
    let part = format!(
        "part described from {urdf:?} {{\n  packages {folder:?}\n  start {}\n  base wheels: dynamic base_link speed 1 m/s turn 120 deg/s acceleration \
         1 m/s^2 timeout 250 ms\n  arm arm: {} tip wrist_ft_tool_link tool (12 cm, 0 m, 0 m) speed 1 rad/s\n}}",
        start.join(", "),
        names.join(", ")
    );
    let mut described = Scene::new(&part, "  part robot = described at (0 m, 0 m, 0 m)");
    let mut own = tiago("");
    compare_pushes(&part);
    let mass = |scene: &Scene, name: &str| {
        scene.world().bodies.iter().find(|b| b.name == format!("robot.{name}")).map(|b| b.mass)
    };
    for (body, links) in LINKS {
        let there: f64 = links.iter().map(|link| mass(&described, link).unwrap()).sum();
        let here = mass(&own, body).unwrap();
        assert!((here - there).abs() < 0.01, "{body}: {here} kg, and {there} kg in the description");
    }
    println!(
        "all: {:.2} kg, and {:.2} kg in the description, which has no gripper",
        own.weight().0,
        described.weight().0
    );
    // The same way from the same start.
    let arm = own.world().arms.iter().position(|a| a.name == "robot.arm").unwrap();
    let arms = [(ArmId(u16::try_from(arm).unwrap()), false), (ArmId(0), true)];
    for posture in ["carry", "prepare_grasp"] {
        let angles =
            own.world().arms[arm].postures.iter().find(|p| p.name == posture).unwrap().angles.clone();
        let mut tools = Vec::new();
        for (scene, (arm, is_described)) in [&mut own, &mut described].into_iter().zip(arms) {
            let positions: Vec<f64> = if is_described {
                let joints =
                    scene.world().arms[0].joints.iter().map(|id| &scene.world().joints[usize::from(id.0)]);
                let angles = angles.iter().zip(START).zip(joints);
                angles.map(|((angle, (_, start)), joint)| (angle + start).min(joint.hi)).collect()
            } else {
                angles.clone()
            };
            let command = MotorCommand::FollowJoints { arm, positions, times: vec![8.0] };
            scene.sim.command(command).unwrap();
            scene.go_on(12.0, |_| {});
            tools.push(scene.sim.tool(arm).unwrap());
        }
        let off = (0..3).map(|i| (tools[0][i] - tools[1][i]).powi(2)).sum::<f64>().sqrt();
        println!("{posture}: {:.1} mm apart", off * 1e3);
        assert!(off < 0.005, "{posture}: {tools:?}");
    }
    let mut ends = Vec::new();
    for scene in [&mut own, &mut described] {
        for _ in 0..40 {
            scene
                .sim
                .command(MotorCommand::DriveWheels { base: BASE, forward: 0.25, sideways: 0.0, turn: 0.2 })
                .unwrap();
            scene.go_on(0.1, |_| {});
        }
        scene.go_on(2.0, |_| {});
        ends.push(scene.sim.base_pose(BASE).unwrap());
    }
    println!("after 4 s: {ends:?}");
    assert!((0..3).all(|i| (ends[0][i] - ends[1][i]).abs() < 0.02), "{ends:?}");
}
