//! Robots of a folder that is not part of the project, put into the world: `HRDSL_ROBOTS=FOLDER cargo test -p hrdsl-tests --test
//! robot_zoo -- --nocapture`. Its file `zoo.txt` has a line for each: its name, the path of its description, the folder of its
//! packages, and the link at the end of its arm; `-` for the link that the most joints move.
//!
//! Of each is told what was said of it, how long it takes to read and to build, of how many hulls it is, how far it moves while it
//! stands for 5 s, and how near it comes to a posture that it is sent to.

#![allow(clippy::disallowed_methods, reason = "the test reads a folder that is named by the environment")]

use std::{collections::BTreeMap, env, fs, path::Path, time::Instant};

use hrdsl_compiler::{InputFile, ModuleLoader, ModuleText, RobotEntry, RobotReader, compile_with};
use hrdsl_ir::{
    Program,
    value::SECOND,
    world::{ArmId, BodyId},
};
use hrdsl_robots::{PackageTable, RobotRequest, UrdfLinkId, UrdfRobot, read_robot};
use hrdsl_sim::{HullStore, MotorCommand, WorldSimulation, warm_hulls};
use hrdsl_source::{SourceFiles, Span};

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

/// Keeps nothing.
struct NoStore;

impl HullStore for NoStore {
    fn load(&self, _key: &str) -> Option<Vec<u8>> {
        None
    }

    fn save(&self, _key: &str, _bytes: &[u8]) {}
}

/// The joints to a link that move by themselves.
fn chain(robot: &UrdfRobot, tip: UrdfLinkId) -> Vec<String> {
    let joints = robot.chain(robot.root, tip).unwrap_or_default();
    let moves = joints.iter().filter_map(|id| robot.joint(*id));
    let moves = moves.filter(|j| j.kind.has_one_value() && j.mimic.is_none());
    moves.map(|joint| joint.name.clone()).collect()
}

/// As the language writes a name that has letters, digits, `_` and `-`.
fn spelled(name: &str) -> String {
    name.replace(|c: char| !c.is_ascii_alphanumeric() && c != '_', "_")
}

fn scenario(path: &str, packages: &str, tip: &str, joints: &[String]) -> String {
    let joints = joints.iter().map(|joint| spelled(joint)).collect::<Vec<_>>().join(", ");
    format!(
        "scenario zoo\nactor robot : system\npart it from {path:?} {{\n  packages {packages:?}\n  arm arm: {joints} tip {} \
         tool (0 m, 0 m, 0 m) speed 1 rad/s\n}}\nworld {{\n  step 10 ms\n  part robot = it at (0 m, 0 m, 1 m)\n}}\n",
        spelled(tip)
    )
}

/// How long a second of the world takes, in milliseconds; and how far joints are off after 5 s, rad or m.
fn stand(sim: &mut WorldSimulation, start: &[f64]) -> (f64, f64) {
    let began = Instant::now();
    sim.advance(5 * SECOND);
    let steps = sim.steps().max(1) as f64;
    let took = began.elapsed().as_secs_f64() * 1e6 / steps;
    (took, farthest(&sim.joint_positions(ArmId(0)), start))
}

fn farthest(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Goes to a posture a part of a radian away, and tells how far off the joints (rad) and the tool (mm) are on the way's worst
/// moment at rest, 3 s after the last joint should have arrived.
fn go(sim: &mut WorldSimulation, program: &Program, robot: &UrdfRobot, tip: UrdfLinkId) -> String {
    let world = program.world.as_ref().unwrap();
    let arm = &world.arms[0];
    let now = sim.joint_positions(ArmId(0));
    let aims: Vec<f64> = arm
        .joints
        .iter()
        .zip(&now)
        .map(|(id, at)| {
            let joint = &world.joints[usize::from(id.0)];
            let by = if joint.hi - joint.lo < 1.0 { (joint.hi - joint.lo) / 4.0 } else { 0.3 };
            if at + by <= joint.hi { at + by } else { at - by }
        })
        .collect();
    let command = MotorCommand::ReachJoints { arm: ArmId(0), positions: aims.clone(), max_speed: Some(0.5) };
    let id = match sim.command(command) {
        Ok(id) => id,
        Err(why) => return format!("refused: {why}"),
    };
    let mut ended = None;
    let mut at = sim.now();
    while ended.is_none() && sim.now() < 30 * SECOND {
        at += SECOND / 10;
        sim.advance(at);
        ended = sim.finished().into_iter().find(|(known, _)| *known == id).map(|(_, result)| result);
    }
    let end = sim.joint_positions(ArmId(0));
    let off = farthest(&end, &aims);
    // Where the description says that the tip is then.
    let base = world
        .bodies
        .iter()
        .position(|b| b.name == format!("robot.{}", spelled(&robot.link(robot.root).unwrap().name)));
    let names = arm.joints.iter().map(|id| world.joints[usize::from(id.0)].name.clone()).collect::<Vec<_>>();
    let own =
        |name: &str| robot.joints.iter().find(|j| format!("robot.{}", spelled(&j.name)) == *name).unwrap();
    let others = world.joints.iter().filter(|j| j.drive.mimic.is_none() && !names.contains(&j.name));
    let others = others.map(|joint| (own(&joint.name).name.as_str(), joint.drive.start));
    let given = names.iter().zip(&aims).map(|(name, aim)| (own(name).name.as_str(), *aim)).chain(others);
    let values = robot.joint_values(given).unwrap();
    let there = robot.link_poses(&values)[tip.0].translation;
    let (root, _) = sim.pose(BodyId(u16::try_from(base.unwrap()).unwrap())).unwrap();
    let tool = sim.tool(ArmId(0)).unwrap();
    let miss = (0..3).map(|i| (root[i] + there[i] - tool[i]).powi(2)).sum::<f64>().sqrt() * 1e3;
    format!("{} {off:.4} rad {miss:.2} mm", if ended == Some(Ok(())) { "arrived" } else { "missed" })
}

fn show(name: &str, path: &str, packages: &str, wanted: &str) -> Result<String, String> {
    let mut table = PackageTable::new();
    let mut files = SourceFiles::default();
    let place = Span::new(files.add("zoo", ""), 0, 0);
    table.search(&WholeDisk, &mut files, packages, place.into());
    let reading = read_robot(&RobotRequest::new(path, place, &table), &mut files, &WholeDisk);
    let mut said: BTreeMap<&str, usize> = BTreeMap::new();
    reading.faults.iter().for_each(|fault| *said.entry(fault.kind.word()).or_default() += 1);
    let robot = reading.robot.as_ref().ok_or_else(|| format!("{said:?}"))?;
    let tip = match wanted {
        "-" => (0..robot.links.len()).rev().map(UrdfLinkId).max_by_key(|link| chain(robot, *link).len()),
        link => robot.link_named(link),
    };
    let tip = tip.ok_or("no such tip")?;
    let joints = chain(robot, tip);
    let text = scenario(path, packages, &robot.link(tip).unwrap().name, &joints);
    let began = Instant::now();
    let compiled = compile_with(InputFile { name: "zoo.hri", text: &text }, &[], &WholeDisk);
    let read = began.elapsed().as_secs_f64();
    let errors: Vec<String> =
        compiled.diagnostics.iter().filter(|d| d.is_error()).map(|d| d.message.clone()).take(12).collect();
    let program = compiled.program.ok_or_else(|| format!("{errors:?}"))?;
    let world = program.world.as_ref().unwrap();
    let began = Instant::now();
    let (meshes, hulls, error) = warm_hulls(world, &NoStore);
    let found = began.elapsed().as_secs_f64();
    let mut sim = WorldSimulation::new(world, &[]).map_err(|e| e.to_string())?;
    let start = sim.joint_positions(ArmId(0));
    let (step, drift) = stand(&mut sim, &start);
    let motion = go(&mut sim, &program, robot, tip);
    let free = world.joints.iter().filter(|joint| !joint.is_rigid()).count();
    Ok(format!(
        "{name} | {} links, {} joints, {free} move, {} of the arm | {said:?} | read {read:.2} s | {meshes} meshes, {hulls} hulls, \
         {:.1} mm, {found:.2} s | {step:.0} µs a step | drift {drift:.5} | {motion}",
        robot.links.len(),
        robot.joints.len(),
        joints.len(),
        error * 1e3,
    ))
}

#[test]
fn robots_of_a_folder_stand_and_move() {
    let Ok(folder) = env::var("HRDSL_ROBOTS") else { return };
    let Ok(list) = fs::read_to_string(Path::new(&folder).join("zoo.txt")) else { return };
    for line in list.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#')) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [name, path, packages, tip] = words.as_slice() else { panic!("{line}: four words are needed") };
        let [path, packages] =
            [path, packages].map(|p| Path::new(&folder).join(p).to_string_lossy().into_owned());
        match show(name, &path, &packages, tip) {
            Ok(told) => println!("{told}"),
            Err(why) => println!("{name} | not used: {why}"),
        }
    }
}
