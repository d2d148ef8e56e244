//! Parts that are made from descriptions of robots, and walls from maps: what becomes of them, and what is said of their faults.

use std::collections::BTreeMap;

use hrdsl_compiler::{
    CompilationResult, InputFile, ModuleLoader, ModuleText, RobotEntry, RobotReader, compile_with,
};
use hrdsl_ir::{
    solid::SolidGeometry,
    world::{BodyMotion, JointMotion, World},
};

/// Files by their paths.
#[derive(Clone, Default)]
struct Files(BTreeMap<&'static str, String>);

impl ModuleLoader for Files {
    fn load(&self, _from: &str, _path: &str) -> Result<ModuleText, String> {
        Err("there are no modules here".to_owned())
    }

    fn robots(&self) -> Option<Box<dyn RobotReader + '_>> {
        Some(Box::new(self.clone()))
    }
}

impl RobotReader for Files {
    fn bytes(&self, file: &str) -> Result<Vec<u8>, String> {
        self.0
            .get(file)
            .map(|text| text.clone().into_bytes())
            .ok_or_else(|| "there is no such file".to_owned())
    }

    fn entries(&self, _folder: &str) -> Result<Vec<RobotEntry>, String> {
        Err("there is no such folder".to_owned())
    }
}

const URDF: &str = r#"<robot name="r">
  <link name="base"/>
  <link name="arm-1"><inertial><mass value="2"/><origin xyz="0 0 0.1" rpy="0 0 1.5707963267948966"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.04"/></inertial>
    <collision><geometry><box size="0.1 0.1 0.2"/></geometry></collision>
    <collision><origin xyz="0 0 0.2"/><geometry><mesh filename="part.obj" scale="2 2 2"/></geometry></collision></link>
  <link name="in"><inertial><mass value="1"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
  <link name="tool"/>
  <joint name="turn" type="revolute"><parent link="base"/><child link="arm-1"/><origin xyz="0 0 0.5"/><axis xyz="0 0 2"/>
    <limit lower="1" upper="2" effort="40" velocity="3"/><dynamics damping="0.5" friction="0.1"/></joint>
  <joint name="roll" type="continuous"><parent link="arm-1"/><child link="in"/><origin xyz="0 0 0.4"/><axis xyz="0 0 1"/>
    <limit effort="5" velocity="2"/></joint>
  <joint name="weld" type="fixed"><parent link="in"/><child link="tool"/><origin xyz="0.1 0 0"/></joint>
</robot>
"#;
const SRDF: &str = r#"<robot name="r">
  <group name="all"><chain base_link="base" tip_link="tool"/></group>
  <group_state name="up" group="all"><joint name="turn" value="1.25"/><joint name="roll" value="-3"/></group_state>
  <disable_collisions link1="base" link2="in" reason="Never"/>
</robot>
"#;
const OBJ: &str = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
const PART: &str =
    "semantics \"r.srdf\"\n  arm arm: group \"all\" tip tool tool (0 m, 0 m, 0 m) speed 1 rad/s";

fn files() -> Files {
    Files(BTreeMap::from([
        ("r.urdf", URDF.to_owned()),
        ("r.srdf", SRDF.to_owned()),
        ("part.obj", OBJ.to_owned()),
    ]))
}

fn scenario(members: &str, world: &str) -> String {
    format!(
        "scenario made\nactor robot : system\npart made from \"r.urdf\" {{\n  {members}\n}}\nworld {{\n  part robot = made at (1 m, 0 m, 0 m)\n{world}}}\n"
    )
}

fn compiled(text: &str, files: &Files) -> CompilationResult {
    compile_with(InputFile { name: "made.hri", text }, &[], files)
}

fn world(members: &str) -> World {
    let result = compiled(&scenario(members, ""), &files());
    let world = result.program.and_then(|program| program.world);
    world.unwrap_or_else(|| panic!("{:#?}", result.diagnostics))
}

/// Of each diagnostic: where, and what.
fn said(result: &CompilationResult) -> Vec<String> {
    let line =
        |d: &hrdsl_source::Diagnostic| format!("{} {} {}", result.files.place(d.span()), d.code, d.message);
    result.diagnostics.iter().map(line).collect()
}

#[test]
fn links_are_bodies_and_joints_are_joints_under_names_that_the_language_has() {
    let world = world(PART);
    let names: Vec<&str> = world.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, ["robot.base", "robot.arm_1", "robot.in_", "robot.tool"]);
    let joints: Vec<&str> = world.joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(joints, ["robot.turn", "robot.roll", "robot.weld"]);
    let motions: Vec<BodyMotion> = world.bodies.iter().map(|body| body.motion).collect();
    assert_eq!(motions, [BodyMotion::Fixed, BodyMotion::Dynamic, BodyMotion::Dynamic, BodyMotion::Dynamic]);
    let ghosts: Vec<bool> = world.bodies.iter().map(|body| body.ghost).collect();
    assert_eq!(ghosts, [true, false, true, true]);
    let solid = world.bodies[1].solid.as_ref().unwrap();
    let SolidGeometry::Mesh(mesh) = &solid.shapes[1].geometry else { panic!("a mesh") };
    assert_eq!((mesh.points.len(), mesh.triangles.len(), mesh.points[1]), (4, 4, [0.0, 0.2, 0.0]));
    let mass = solid.mass.unwrap();
    assert_eq!((mass.mass, mass.centre), (2.0, [0.0, 0.0, 0.1]));
    for (row, want) in mass.inertia.iter().zip([[0.03, 0.0, 0.0], [0.0, 0.02, 0.0], [0.0, 0.0, 0.04]]) {
        assert!(row.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-12), "{:?}", mass.inertia);
    }
    assert_eq!(world.bodies[0].solid.as_ref().unwrap().exempt.len(), 1);
}

#[test]
fn joints_have_the_limits_of_the_description_and_start_within_them() {
    let world = world(PART);
    let [turn, roll, weld] = world.joints.as_slice() else { panic!("three joints") };
    assert_eq!((turn.motion, turn.lo, turn.hi, turn.drive.start), (JointMotion::Hinge, 1.0, 2.0, 1.5));
    assert_eq!((turn.drive.effort, turn.drive.speed), (Some(40.0), Some(3.0)));
    assert_eq!((turn.drive.damping, turn.drive.friction, turn.axis), (0.5, 0.1, [0.0, 0.0, 1.0]));
    assert_eq!((turn.anchor, roll.anchor), ([1.0, 0.0, 0.5], [1.0, 0.0, 0.9]));
    assert!(roll.is_endless() && weld.is_rigid() && !roll.is_rigid());
    let arm = &world.arms[0];
    assert_eq!((arm.joints.len(), arm.postures[0].name.as_str()), (2, "up"));
    assert_eq!(arm.postures[0].angles, [1.25, -3.0]);
}

#[test]
fn a_start_is_a_state_of_a_group_or_a_value() {
    let start = |members: &str| world(&format!("{PART}\n  {members}")).joints[0].drive.start;
    assert_eq!(start("start \"up\""), 1.25);
    assert_eq!(start("start \"up\", turn = 1.75 rad"), 1.75);
}

#[test]
fn what_no_device_moves_is_held_and_what_turns_without_end_is_not() {
    let world = world("");
    assert!(world.joints[0].drive.held && world.joints[0].is_rigid() && !world.joints[1].drive.held);
}

#[test]
fn a_base_makes_the_root_drive() {
    let world = world("base wheels: base speed 1 m/s turn 1 rad/s acceleration 1 m/s^2");
    assert_eq!((world.bodies[0].motion, world.bases[0].body.0), (BodyMotion::Kinematic, 0));
}

#[test]
fn walls_of_a_map_are_one_body() {
    let mut files = files();
    files.0.insert("map.yaml", "image: map.pgm\nresolution: 0.5\norigin: [1, 0, 0]\n".to_owned());
    files.0.insert("map.pgm", "P2\n3 2\n255\n0 0 254\n254 254 0\n".to_owned());
    let text = "scenario hall\nworld {\n  walls hall from \"map.yaml\" height 2 m at (0 m, 0 m, 0 m)\n}\n";
    let result = compiled(text, &files);
    let world = result
        .program
        .and_then(|program| program.world)
        .unwrap_or_else(|| panic!("{:?}", result.diagnostics));
    let solid = world.bodies[0].solid.as_ref().unwrap();
    let places: Vec<[f64; 3]> = solid.shapes.iter().map(|shape| shape.position).collect();
    assert_eq!(places, [[1.5, 0.75, 1.0], [2.25, 0.25, 1.0]]);
    let broken = compiled(&text.replace("map.yaml", "no.yaml"), &files);
    assert_eq!(said(&broken), ["made.hri:3:19 HR0807 no.yaml cannot be read: there is no such file"]);
}

/// What is changed in which file, the part's members, and what is said first.
#[test]
fn faults_are_said_where_they_are() {
    let faults = [
        ("r.urdf", "</robot>", "", PART, "r.urdf:1:1 HR0807 this is no XML"),
        ("r.urdf", "<mass value=\"2\"/>", "<mass value=\"-2\"/>", PART, "r.urdf:3:"),
        ("r.urdf", "<child link=\"tool\"/>", "<child link=\"base\"/>", PART, "r.urdf:"),
        ("r.urdf", "part.obj", "gone.obj", PART, "r.urdf:5:65 HR0807 there is no file gone.obj"),
        ("r.urdf", "name=\"arm-1\"", "name=\"arm 2\"", PART, "r.urdf:"),
        (
            "r.srdf",
            "tip_link=\"tool\"",
            "tip_link=\"tol\"",
            PART,
            "r.srdf:2:55 HR0807 no link is called `tol`",
        ),
        ("r.urdf", "", "", "semantics \"no.srdf\"", "made.hri:4:13 HR0807 no.srdf cannot be read"),
        ("r.urdf", "", "", "packages \"ws\"", "made.hri:4:12 HR0807 ws cannot be read"),
        (
            "r.urdf",
            "",
            "",
            "arm arm: roll, turn tip tool tool (0 m, 0 m, 0 m) speed 1 rad/s",
            "made.hri:4:18 HR0801 the joint `turn` does not follow the one before it",
        ),
        (
            "r.urdf",
            "",
            "",
            "arm arm: group \"all\" tip tool tool (0 m, 0 m, 0 m) speed 1 rad/s",
            "made.hri:4:18 HR0801 groups are in the semantics of a description",
        ),
        (
            "r.urdf",
            "",
            "",
            "laser eye: tool",
            "made.hri:4:14 HR0801 the description has no planar range sensor",
        ),
        ("r.urdf", "", "", "start turn = 3 rad", "made.hri:4:16 HR0206 the start of `turn`"),
        ("r.urdf", "", "", "start \"up\"", "made.hri:4:9 HR0801 states of groups are in the semantics"),
        ("r.urdf", "", "", "start weld = 1 rad", "made.hri:4:9 HR0801 the joint `weld` does not move"),
    ];
    for (file, old, new, members, want) in faults {
        let mut files = files();
        if !old.is_empty() {
            let text = files.0.get_mut(file).unwrap();
            assert!(text.contains(old), "{old}");
            *text = text.replacen(old, new, 1);
        }
        let result = compiled(&scenario(members, ""), &files);
        let errors: Vec<String> = said(&result);
        assert!(
            result.program.is_none() && errors.iter().any(|e| e.starts_with(want)),
            "{want}: {errors:#?}"
        );
        // One cause, and nothing that follows from it.
        assert!(errors.len() <= 3, "{want}: {errors:#?}");
    }
}

#[test]
fn names_that_are_written_alike_are_a_fault() {
    let mut files = files();
    let text = files.0.get_mut("r.urdf").unwrap();
    *text = text.replace("name=\"tool\"", "name=\"arm_1\"").replace("link=\"tool\"", "link=\"arm_1\"");
    let errors = said(&compiled(&scenario("", ""), &files));
    assert!(errors[0].contains("`arm-1` and `arm_1` are both written `arm_1`"), "{errors:?}");
}

#[test]
fn words_of_descriptions_are_for_parts_that_are_made_from_one() {
    let text = "scenario s\nworld {\n  packages \"ws\"\n  start a = 1 rad\n}\n";
    let errors = said(&compiled(text, &files()));
    assert_eq!(errors.len(), 2, "{errors:?}");
    assert!(errors[0].starts_with("made.hri:3:3 HR0801 `packages` speaks of a description"), "{errors:?}");
}

#[test]
fn without_files_nothing_is_read() {
    let text = scenario("", "");
    let result = hrdsl_compiler::compile(InputFile { name: "made.hri", text: &text }, &[]);
    assert_eq!(said(&result), ["made.hri:3:16 HR0807 r.urdf cannot be read: there are no files here"]);
}

#[test]
fn joints_made_by_hand_follow_others() {
    let text = "scenario s\nworld {\n  body a: fixed box(1 m, 1 m, 1 m) at (0 m, 0 m, 0 m)\n  \
                body b: dynamic box(10 cm, 10 cm, 10 cm) at (1 m, 0 m, 0 m) mass 1 kg\n  \
                body c: dynamic box(10 cm, 10 cm, 10 cm) at (-1 m, 0 m, 0 m) mass 1 kg\n  \
                joint left: a -> b at (1 m, 0 m, 0 m) axis (1, 0, 0) limits 0 cm .. 5 cm\n  \
                joint right: a -> c at (-1 m, 0 m, 0 m) axis (1, 0, 0) limits -5 cm .. 0 cm mimic left times -1\n}\n";
    let result = compiled(text, &files());
    let world = result
        .program
        .and_then(|program| program.world)
        .unwrap_or_else(|| panic!("{:?}", result.diagnostics));
    let mimic = world.joints[1].drive.mimic.unwrap();
    assert_eq!((mimic.joint.0, mimic.factor, mimic.offset), (0, -1.0, 0.0));
    let errors = said(&compiled(&text.replace("mimic left", "mimic right"), &files()));
    assert!(errors[0].contains("cannot follow"), "{errors:?}");
}

/// A link's name is told as the frame of what is on it, whatever else the scenario declares.
#[test]
fn a_part_that_the_world_does_not_use_changes_no_frame() {
    let laser = "laser eye: arm_1 at (0 m, 0 m, 0 m) angles -90 deg .. 90 deg beams 3 range 5 cm .. 10 m";
    let system = "system robot {\n  run \"python3 robot.py\"\n  ros1 {\n    \
                  topic \"/scan\" : sensor_msgs/LaserScan in at 10 Hz from robot.eye\n  }\n}\n";
    let spare = "part spare { body ball: fixed sphere(10 cm) at (0 m, 0 m, 0 m) }\n";
    for more in ["", spare] {
        let result = compiled(&format!("{}{system}{more}", scenario(laser, "")), &files());
        let program = result.program.unwrap_or_else(|| panic!("{:#?}", result.diagnostics));
        let binding = program.systems[0].binding.as_ref().unwrap();
        let message = format!("{:?}", binding.inputs[0].message);
        assert!(message.contains("arm-1"), "{message}");
    }
}
