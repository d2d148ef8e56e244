//! Robots from descriptions in the physics: beside a whole person, and with light links and rotors that nobody knows.

use std::fmt::Write;

use hrdsl_compiler::{InputFile, ModuleLoader, ModuleText, RobotEntry, RobotReader, compile_with};
use hrdsl_ir::{
    Expr, Value,
    value::SECOND,
    world::{
        ArmId, BaseId, BodyId, BodyRef, FigureId, GripperId, JointId, SignalTerm, World, WorldAction,
        WorldPoint,
    },
};
use hrdsl_sim::{MotorCommand, WorldSimulation};

/// Drives, has an arm of two joints, and frames on what is fixed to the base and on what moves.
const HELPER: &str = r#"<robot name="helper">
  <link name="footprint"/>
  <link name="base"><inertial><mass value="30"/><origin xyz="0 0 0.2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
    <collision><origin xyz="0 0 0.3"/><geometry><box size="0.4 0.4 0.6"/></geometry></collision></link>
  <link name="laser"/>
  <link name="upper"><inertial><mass value="2"/><origin xyz="0.2 0 0"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.03"/></inertial>
    <collision><origin xyz="0.2 0 0" rpy="0 1.5708 0"/><geometry><cylinder radius="0.04" length="0.4"/></geometry></collision></link>
  <link name="lower"><inertial><mass value="1"/><origin xyz="0.15 0 0"/><inertia ixx="0.005" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
    <collision><origin xyz="0.15 0 0" rpy="0 1.5708 0"/><geometry><cylinder radius="0.03" length="0.3"/></geometry></collision></link>
  <link name="tool"/>
  <joint name="stand" type="fixed"><parent link="footprint"/><child link="base"/></joint>
  <joint name="mount" type="fixed"><parent link="base"/><child link="laser"/><origin xyz="0.2 0 0.4"/></joint>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0.25 0 0.7"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="60" velocity="2"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0.42 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-2.4" upper="2.4" effort="30" velocity="2"/></joint>
  <joint name="flange" type="fixed"><parent link="lower"/><child link="tool"/><origin xyz="0.3 0 0"/></joint>
</robot>
"#;

const TOGETHER: &str = r#"scenario together
use std.person
actor person : environment
actor robot  : system
part helper from "robot.urdf" {
  arm arm: shoulder, elbow tip tool tool (0 m, 0 m, 0 m) speed 1 rad/s
  base wheels: base speed 0.5 m/s turn 1 rad/s acceleration 1 m/s^2
  laser eye: laser at (0 m, 0 m, 0 m) angles -90 deg .. 90 deg beams 91 range 5 cm .. 10 m
}
world {
  body floor: fixed box(10 m, 10 m, 10 cm) at (0 m, 0 m, -5 cm)
  part robot = helper at (0 m, 0 m, 1 mm)
  part guest = adult(172 cm) at (1.6 m, 0 m, 0 m) rotated (0 deg, 0 deg, 180 deg)
}
"#;

/// The one file that there is, `robot.urdf`.
struct OneRobot(String);

impl ModuleLoader for OneRobot {
    fn load(&self, _from: &str, _path: &str) -> Result<ModuleText, String> {
        Err("there are no modules here".to_owned())
    }

    fn robots(&self) -> Option<Box<dyn RobotReader + '_>> {
        Some(Box::new(OneRobot(self.0.clone())))
    }
}

impl RobotReader for OneRobot {
    fn bytes(&self, file: &str) -> Result<Vec<u8>, String> {
        if file == "robot.urdf" {
            Ok(self.0.clone().into_bytes())
        } else {
            Err("there is no such file".to_owned())
        }
    }

    fn entries(&self, _folder: &str) -> Result<Vec<RobotEntry>, String> {
        Err("there is no such folder".to_owned())
    }
}

fn world_of(urdf: &str, scenario: &str) -> World {
    let robot = OneRobot(urdf.to_owned());
    let compiled = compile_with(InputFile { name: "described.hri", text: scenario }, &[], &robot);
    let world = compiled.program.and_then(|program| program.world);
    world.unwrap_or_else(|| panic!("{:#?}", compiled.diagnostics))
}

/// Ten seconds, every tenth of which the world is looked at.
fn ten_seconds(sim: &mut WorldSimulation, mut each: impl FnMut(&WorldSimulation)) {
    for tenth in 1..=100 {
        sim.advance(tenth * SECOND / 10);
        assert_eq!(sim.fault(), None, "after {tenth} tenths of a second");
        each(sim);
    }
}

fn named(world: &World, name: &str) -> BodyId {
    let at = world.bodies.iter().position(|body| body.name == name).unwrap();
    BodyId(u16::try_from(at).unwrap())
}

#[test]
fn they_stand_side_by_side_for_ten_seconds() {
    let world = world_of(HELPER, TOGETHER);
    let mut sim = WorldSimulation::new(&world, &[]).unwrap();
    let start = sim.joint_positions(ArmId(0));
    ten_seconds(&mut sim, |_| {});
    let off =
        sim.joint_positions(ArmId(0)).iter().zip(&start).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-3, "the arm is off by {off} rad");
}

#[test]
fn the_robot_drives_up_to_a_person_who_comes_near_and_pushes_with_its_arm_for_ten_seconds() {
    let world = world_of(HELPER, TOGETHER);
    let mut sim = WorldSimulation::new(&world, &[]).unwrap();
    let place = WorldPoint::free(None, [1.4, 0.1, 0.0].map(Expr::float));
    let walk = WorldAction::Walk { figure: FigureId(0), along: vec![place], speed: Expr::float(0.5) };
    sim.act(&walk, &|_| None).unwrap();
    let drive = MotorCommand::DriveWheels { base: BaseId(0), forward: 0.1, sideways: 0.0, turn: 0.0 };
    sim.command(drive).unwrap();
    sim.command(MotorCommand::FollowJoints { arm: ArmId(0), positions: vec![0.2, -0.3], times: vec![3.0] })
        .unwrap();
    let bodies = world.bodies.iter().filter(|body| body.name.starts_with("guest."));
    let guest: Vec<BodyId> = bodies.map(|body| named(&world, &body.name)).collect();
    let links = ["robot.upper", "robot.lower", "robot.base"].map(|name| named(&world, name));
    let mut met = false;
    ten_seconds(&mut sim, |sim| {
        met |= links.iter().any(|link| {
            guest.iter().any(|part| {
                let touch = SignalTerm::Touches(BodyRef::Body(*link), BodyRef::Body(*part));
                sim.measure(&touch) == Value::Bool(true)
            })
        });
    });
    assert!(met, "the robot never touches the person: the test shows nothing");
}

/// Seven joints, as arms with a wrist have them, of 3 kg each and thin: so the inertias of what hangs on a joint and of the link next to
/// it differ a hundredfold.
fn light_arm() -> String {
    let mut urdf = String::from("<robot name=\"light\">\n  <link name=\"l0\"/>\n");
    let places = ["0 0 0.33", "0 0 0", "0 0 0.32", "0.08 0 0", "-0.08 0 0.38", "0 0 0", "0.09 0 0"];
    let axes = ["0 0 1", "0 1 0", "0 0 1", "0 -1 0", "0 0 1", "0 -1 0", "0 0 1"];
    for (at, (place, axis)) in places.iter().zip(axes).enumerate() {
        let (child, effort) = (at + 1, if at < 4 { 87 } else { 12 });
        let _ = writeln!(
            urdf,
            "  <link name=\"l{child}\"><inertial><mass value=\"3\"/><origin xyz=\"0 0 0.05\"/><inertia ixx=\"0.01\" ixy=\"0\" \
             ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.005\"/></inertial></link>\n  <joint name=\"j{child}\" type=\"revolute\">\
             <parent link=\"l{at}\"/><child link=\"l{child}\"/><origin xyz=\"{place}\"/><axis xyz=\"{axis}\"/>\
             <limit lower=\"-2.8\" upper=\"2.8\" effort=\"{effort}\" velocity=\"2\"/></joint>"
        );
    }
    urdf + "</robot>\n"
}

const ALONE: &str = r#"scenario alone
actor robot : system
part light from "robot.urdf" {
  arm arm: j1, j2, j3, j4, j5, j6, j7 tip l7 tool (0 m, 0 m, 10 cm) speed 1 rad/s
}
world { part robot = light at (0 m, 0 m, 0 m) }
"#;

#[test]
fn an_arm_of_seven_light_links_comes_to_postures_and_rests_in_them() {
    let world = world_of(&light_arm(), ALONE);
    let mut sim = WorldSimulation::new(&world, &[]).unwrap();
    let postures = [
        [0.4, 0.5, 0.1, -1.0, -0.1, 1.4, 0.8],
        [-0.6, 0.3, 0.5, -1.6, 0.4, 1.0, -0.5],
        [0.2, -0.4, -0.3, -0.6, 0.2, 0.9, 0.3],
    ];
    for (number, posture) in postures.iter().enumerate() {
        let command =
            MotorCommand::ReachJoints { arm: ArmId(0), positions: posture.to_vec(), max_speed: None };
        let id = sim.command(command).unwrap();
        sim.advance(sim.now() + 6 * SECOND);
        assert_eq!(sim.finished(), [(id, Ok(()))], "posture {number}");
        let fastest = sim.joint_speeds(ArmId(0)).iter().map(|v| v.abs()).fold(0.0, f64::max);
        assert!(fastest < 1e-3, "in posture {number} it still moves at {fastest} rad/s");
    }
}

/// A hand on the light arm, all of whose light fingers follow one joint, as linkages are described. Its efforts are large, so that they
/// limit nothing.
fn light_arm_with_hand() -> String {
    let mut urdf = light_arm().replace("</robot>\n", "");
    for (side, sign) in [("left", 1.0), ("right", -1.0)] {
        for (name, parent, y, z, factor) in [
            ("knuckle", "l7", 0.03, 0.05, 1),
            ("inner", "l7", 0.013, 0.06, 1),
            ("finger", "knuckle", 0.037, 0.043, -1),
        ] {
            let parent = if parent == "l7" { parent.to_owned() } else { format!("{side}_{parent}") };
            let is_leader = (side, name) == ("left", "knuckle");
            let mimic = format!("<mimic joint=\"left_knuckle_joint\" multiplier=\"{factor}\"/>");
            let (mimic, y) = (if is_leader { "" } else { &mimic }, sign * y);
            let _ = writeln!(
                urdf,
                "  <link name=\"{side}_{name}\"><inertial><mass value=\"0.02\"/><origin xyz=\"0 0 0.02\"/><inertia ixx=\"1e-5\" \
                 ixy=\"0\" ixz=\"0\" iyy=\"1e-5\" iyz=\"0\" izz=\"5e-6\"/></inertial></link>\n  <joint name=\"{side}_{name}_joint\" \
                 type=\"revolute\"><parent link=\"{parent}\"/><child link=\"{side}_{name}\"/><origin xyz=\"0 {y} {z}\"/>\
                 <axis xyz=\"{sign} 0 0\"/><limit lower=\"-0.8\" upper=\"0.8\" effort=\"1000\" velocity=\"2\"/>{mimic}</joint>"
            );
        }
    }
    urdf + "</robot>\n"
}

const WITH_HAND: &str = r#"scenario with_hand
actor robot : system
part light from "robot.urdf" {
  start j2 = 30 deg, j4 = -90 deg, j6 = 80 deg
  arm arm: j1, j2, j3, j4, j5, j6, j7 tip l7 tool (0 m, 0 m, 10 cm) speed 1 rad/s
  gripper hand: l7 fingers left_knuckle_joint tool (0 m, 0 m, 15 cm) reach 4 cm delay 500 ms force 40 N
}
world { part robot = light at (0 m, 0 m, 0 m) }
"#;

/// A hand's leading joint was driven against its end, and pushed back from there, which all that follow it followed; and each of them had
/// the rotor of a motor of 1000 N·m. The arm shook at 0.3 rad/s with them, and came to rest nowhere.
#[test]
fn a_hand_of_linked_fingers_shakes_no_arm() {
    let world = world_of(&light_arm_with_hand(), WITH_HAND);
    let joint = |name: &str| {
        let at = world.joints.iter().position(|joint| joint.name == format!("robot.{name}")).unwrap();
        JointId(u16::try_from(at).unwrap())
    };
    let leader = joint("left_knuckle_joint");
    let followers = [
        (joint("left_inner_joint"), 1.0),
        (joint("left_finger_joint"), -1.0),
        (joint("right_knuckle_joint"), 1.0),
        (joint("right_inner_joint"), 1.0),
        (joint("right_finger_joint"), -1.0),
    ];
    let angle =
        |sim: &WorldSimulation, of: JointId| sim.measure(&SignalTerm::JointPosition(of)).as_f64().unwrap();
    let mut sim = WorldSimulation::new(&world, &[]).unwrap();
    for (closed, end) in [(true, 0.8), (false, -0.8), (true, 0.8)] {
        let gripper = GripperId(0);
        sim.command(if closed {
            MotorCommand::CloseFingers { gripper }
        } else {
            MotorCommand::OpenFingers { gripper }
        })
        .unwrap();
        sim.advance(sim.now() + 2 * SECOND);
        let mut fastest: f64 = 0.0;
        for _ in 0..100 {
            sim.advance(sim.now() + SECOND / 100);
            fastest = sim.joint_speeds(ArmId(0)).iter().map(|v| v.abs()).fold(fastest, f64::max);
            let at = angle(&sim, leader);
            assert!((at - end).abs() < 1e-3, "the hand is at {at} rad");
            for (follower, factor) in followers {
                let behind = angle(&sim, follower) - factor * at;
                assert!(behind.abs() < 1e-3, "a finger is {behind} rad off");
            }
        }
        assert!(fastest < 1e-3, "the arm moves at {fastest} rad/s while the hand is at its end");
    }
}

/// Two wheels and a caster on joints without end, which touch the ground, as the descriptions of robots that drive have them; and what
/// spins on top of it.
const ROVER: &str = r#"<robot name="rover">
  <link name="base"><inertial><mass value="0.8"/><inertia ixx="1e-3" ixy="0" ixz="0" iyy="1e-3" iyz="0" izz="1e-3"/></inertial>
    <collision><origin xyz="0 0 0.06"/><geometry><box size="0.14 0.14 0.1"/></geometry></collision></link>
  <link name="left"><inertial><mass value="0.03"/><inertia ixx="1e-5" ixy="0" ixz="0" iyy="1e-5" iyz="0" izz="2e-5"/></inertial>
    <collision><geometry><cylinder radius="0.033" length="0.018"/></geometry></collision></link>
  <link name="right"><inertial><mass value="0.03"/><inertia ixx="1e-5" ixy="0" ixz="0" iyy="1e-5" iyz="0" izz="2e-5"/></inertial>
    <collision><geometry><cylinder radius="0.033" length="0.018"/></geometry></collision></link>
  <link name="swivel"><inertial><mass value="0.01"/><inertia ixx="1e-6" ixy="0" ixz="0" iyy="1e-6" iyz="0" izz="1e-6"/></inertial></link>
  <link name="ball"><inertial><mass value="0.005"/><inertia ixx="1e-6" ixy="0" ixz="0" iyy="1e-6" iyz="0" izz="1e-6"/></inertial>
    <collision><geometry><sphere radius="0.01"/></geometry></collision></link>
  <link name="scanner"><inertial><mass value="0.1"/><inertia ixx="1e-4" ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="1e-4"/></inertial></link>
  <joint name="left_joint" type="continuous"><parent link="base"/><child link="left"/><origin xyz="0 0.08 0.033" rpy="-1.57 0 0"/><axis xyz="0 0 1"/></joint>
  <joint name="right_joint" type="continuous"><parent link="base"/><child link="right"/><origin xyz="0 -0.08 0.033" rpy="-1.57 0 0"/><axis xyz="0 0 1"/></joint>
  <joint name="swivel_joint" type="continuous"><parent link="base"/><child link="swivel"/><origin xyz="-0.08 0 0.02"/><axis xyz="0 0 1"/></joint>
  <joint name="ball_joint" type="continuous"><parent link="swivel"/><child link="ball"/><origin xyz="-0.01 0 -0.01"/><axis xyz="0 1 0"/></joint>
  <joint name="scan_joint" type="continuous"><parent link="base"/><child link="scanner"/><origin xyz="0 0 0.15"/><axis xyz="0 0 1"/></joint>
</robot>
"#;

const DRIVING: &str = r#"scenario driving
actor robot : system
part rover from "robot.urdf" { base wheels: base speed 0.3 m/s turn 3 rad/s acceleration 1 m/s^2 }
world {
  body floor: fixed box(10 m, 10 m, 10 cm) at (0 m, 0 m, -5 cm)
  part robot = rover at (0 m, 0 m, 0 m)
}
"#;

/// Wheels that hung loose on a base that is led were rubbed by the ground until the run was at fault.
#[test]
fn wheels_that_touch_the_ground_are_one_with_their_base() {
    let world = world_of(ROVER, DRIVING);
    let held: Vec<(&str, bool)> =
        world.joints.iter().map(|joint| (joint.name.as_str(), joint.drive.held)).collect();
    let wheels =
        ["left_joint", "right_joint", "swivel_joint", "ball_joint"].map(|name| format!("robot.{name}"));
    for (name, held) in held {
        assert_eq!(held, wheels.iter().any(|wheel| wheel == name), "{name}");
    }
    let mut sim = WorldSimulation::new(&world, &[]).unwrap();
    for (forward, turn) in [(0.2, 0.0), (0.0, 0.2), (0.2, 1.0), (-0.2, -2.5)] {
        sim.command(MotorCommand::DriveWheels { base: BaseId(0), forward, sideways: 0.0, turn }).unwrap();
        sim.advance(sim.now() + 10 * SECOND);
        assert_eq!(sim.fault(), None, "at {forward} m/s and {turn} rad/s");
    }
}

/// A base on wheels of its own goes where one goes that is led, is pushed by what drives into it, and falls for good when that strikes it
/// high up.
#[test]
fn a_dynamic_base_of_a_description_drives_is_pushed_and_topples() {
    let rolling = DRIVING.replace("wheels: base", "wheels: dynamic base");
    let mut ends = Vec::new();
    for scenario in [DRIVING, &rolling] {
        let mut sim = WorldSimulation::new(&world_of(ROVER, scenario), &[]).unwrap();
        for (forward, turn) in [(0.2, 0.0), (0.2, 0.5), (0.1, -0.5), (0.0, 0.0)] {
            sim.command(MotorCommand::DriveWheels { base: BaseId(0), forward, sideways: 0.0, turn }).unwrap();
            sim.advance(sim.now() + 3 * SECOND);
        }
        assert_eq!(sim.fault(), None);
        ends.push(sim.base_pose(BaseId(0)).unwrap());
    }
    let off = (0..3).map(|i| (ends[0][i] - ends[1][i]).abs()).fold(0.0, f64::max);
    println!("it ends at {ends:?}");
    assert!(off < 0.01, "{ends:?}");
    // With a heavy head that is easily pushed over.
    let tall = ROVER
        .replace("<link name=\"scanner\"><inertial><mass value=\"0.1\"/>", "<link name=\"scanner\"><inertial><mass value=\"1\"/>")
        .replace("izz=\"1e-4\"/></inertial></link>", "izz=\"1e-4\"/></inertial>\n    <collision><geometry><box size=\"0.05 0.05 0.05\"/></geometry></collision></link>")
        .replace("<origin xyz=\"0 0 0.15\"/>", "<origin xyz=\"0 0 0.4\"/>");
    let mut came = Vec::new();
    for (rover, height) in [(ROVER, 0.02), (&tall, 0.4)] {
        let ram = format!("  body ram: kinematic box(10 cm, 20 cm, 1 cm) at (-40 cm, 0 m, {height} m)\n}}\n");
        let scenario = rolling.trim_end().trim_end_matches('}').to_owned() + &ram;
        let mut sim = WorldSimulation::new(&world_of(rover, &scenario), &[]).unwrap();
        sim.advance(SECOND);
        let body = sim.body_named("ram").unwrap();
        let to = WorldPoint::free(None, [0.1, 0.0, height].map(Expr::float));
        sim.act(&WorldAction::Move { body, to, over: Expr::float(0.3) }, &|_| None).unwrap();
        sim.advance(4 * SECOND);
        assert_eq!(sim.fault(), None);
        let [x, ..] = sim.base_pose(BaseId(0)).unwrap();
        sim.command(MotorCommand::DriveWheels { base: BaseId(0), forward: 0.2, sideways: 0.0, turn: 0.0 })
            .unwrap();
        sim.advance(6 * SECOND);
        came.push((x, sim.base_pose(BaseId(0)).unwrap()[0] - x));
    }
    println!("it was pushed to, and then drove by, m: {came:?}");
    assert!(came[0].0 > 0.1 && came[0].1 > 0.3, "it is pushed, and drives on: {came:?}");
    assert!(came[1].1 < 0.01, "it lies: {came:?}");
}

#[test]
fn only_a_base_of_a_description_says_how_it_moves() {
    let text = DRIVING.replace("wheels: base", "wheels: guided base");
    let compiled =
        compile_with(InputFile { name: "scene.hri", text: &text }, &[], &OneRobot(ROVER.to_owned()));
    let said: Vec<String> = compiled.diagnostics.iter().map(|d| format!("{d:?}")).collect();
    assert!(said.iter().any(|text| text.contains("guided")), "{said:?}");
}
