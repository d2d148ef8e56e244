//! Robots of a folder that is not part of the project, put into the world: `HRDSL_ROBOTS=FOLDER cargo test -p hrdsl-tests --test
//! robot_zoo -- --nocapture`. Its file `zoo.txt` has a line for each: its name, the path of its description, the folder of its
//! packages, and the link at the end of its arm; `-` for the link that the most joints move. Without one, `robot_zoo.txt` beside this
//! file is taken, which says where its robots come from.
//!
//! Of each is told how long it takes to read and to build, and a row of a table, as it is in spec/robots.md: of how many hulls it is,
//! what was said of it, what is lost, how much of its effort the weight needs where it needs most, how far the arm moves while it stands
//! for 5 s, how near it comes to a posture that it is sent to, and to how many others it comes.

#![allow(clippy::disallowed_methods, reason = "the test reads a folder that is named by the environment")]

use std::{
    collections::BTreeMap,
    env, fs,
    path::{Path, PathBuf},
    time::Instant,
};

use hrdsl_compiler::{InputFile, ModuleLoader, ModuleText, RobotEntry, RobotReader, compile_with};
use hrdsl_ir::{
    value::SECOND,
    world::{ArmId, BodyId, Joint, JointId, World},
};
use hrdsl_robots::{PackageTable, RobotRequest, UrdfJointKind, UrdfLinkId, UrdfRobot, read_robot};
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

/// Keeps hulls for the next time: with many robots, to find them takes longer than all the rest.
struct HullFolder(PathBuf);

impl HullStore for HullFolder {
    fn load(&self, key: &str) -> Option<Vec<u8>> {
        fs::read(self.0.join(key)).ok()
    }

    fn save(&self, key: &str, bytes: &[u8]) {
        // Whoever cannot keep them finds them again.
        let _ = fs::create_dir_all(&self.0).and_then(|()| fs::write(self.0.join(key), bytes));
    }
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

/// How long a step takes, in microseconds; and how far joints are off after 5 s, rad or m.
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

/// The robot in the world: what its joints are called there.
struct Placed<'a> {
    robot: &'a UrdfRobot,
    world: &'a World,
    tip: UrdfLinkId,
}

impl Placed<'_> {
    fn joint(&self, name: &str) -> &str {
        let own = self.robot.joints.iter().find(|j| format!("robot.{}", spelled(&j.name)) == name);
        own.map(|joint| joint.name.as_str()).unwrap()
    }

    /// The values of all joints when the arm's have these, as the description counts them.
    fn values(&self, aims: &[f64]) -> Vec<f64> {
        let arm = &self.world.arms[0].joints;
        let name = |id: &JointId| self.world.joints[usize::from(id.0)].name.as_str();
        let others = self.world.joints.iter().filter(|j| j.drive.mimic.is_none());
        let others = others.filter(|joint| !arm.iter().any(|id| name(id) == joint.name));
        let others = others.map(|joint| (self.joint(&joint.name), joint.drive.start));
        let given = arm.iter().zip(aims).map(|(id, aim)| (self.joint(name(id)), *aim)).chain(others);
        self.robot.joint_values(given).unwrap()
    }

    /// Of the arm's joints, the one of which weight and friction ask most for what it can do: what they need, and its effort, N·m or N.
    fn load(&self, aims: &[f64]) -> (String, f64, f64) {
        let poses = self.robot.link_poses(&self.values(aims));
        let mut carried: Vec<(f64, [f64; 3])> = (self.robot.links.iter().zip(&poses))
            .map(|(link, pose)| {
                let (mass, at) = link.inertial.map_or((0.0, [0.0; 3]), |i| (i.mass, i.origin.xyz));
                (mass, pose.place(at).map(|x| x * mass))
            })
            .collect();
        let mut most = (String::new(), 0.0, f64::INFINITY);
        for joint in self.robot.order.iter().rev().map(|id| &self.robot.joints[id.0]) {
            let (mass, moment) = carried[joint.child.0];
            let pose = &poses[joint.child.0];
            let (axis, at) = (pose.turned(joint.axis), pose.translation);
            let needs = match joint.kind {
                UrdfJointKind::Prismatic => 9.81 * mass * axis[2].abs(),
                _ => {
                    let way = [moment[0] - mass * at[0], moment[1] - mass * at[1]];
                    (9.81 * (axis[0] * way[1] - axis[1] * way[0])).abs()
                }
            };
            let needs = needs + joint.dynamics.friction;
            let effort = joint.limits.and_then(|limits| limits.effort);
            let is_of_arm = chain(self.robot, self.tip).contains(&joint.name);
            if let Some(effort) = effort.filter(|effort| is_of_arm && needs / effort > most.1 / most.2) {
                most = (joint.name.clone(), needs, effort);
            }
            let parent = &mut carried[joint.parent.0];
            parent.0 += mass;
            parent.1 = [0, 1, 2].map(|i| parent.1[i] + moment[i]);
        }
        most
    }

    /// A posture a part of a radian away from where the arm is.
    fn near(&self, now: &[f64]) -> Vec<f64> {
        let joints = self.world.arms[0].joints.iter().map(|id| &self.world.joints[usize::from(id.0)]);
        let aim = |(joint, at): (&Joint, &f64)| {
            let by = if joint.hi - joint.lo < 1.0 { (joint.hi - joint.lo) / 4.0 } else { 0.3 };
            if at + by <= joint.hi { at + by } else { at - by }
        };
        joints.zip(now).map(aim).collect()
    }

    /// Goes to a posture, and tells how far off the joints (rad) and the tool (mm) are when the command has ended.
    fn go(&self, sim: &mut WorldSimulation) -> String {
        let aims = self.near(&sim.joint_positions(ArmId(0)));
        let Some(came) = send(sim, &aims, 0.5) else { return "no way | –".to_owned() };
        let off = farthest(&sim.joint_positions(ArmId(0)), &aims);
        // Where the description says that the tip is then.
        let root = format!("robot.{}", spelled(&self.robot.link(self.robot.root).unwrap().name));
        let root = self.world.bodies.iter().position(|body| body.name == root).unwrap();
        let there = self.robot.link_poses(&self.values(&aims))[self.tip.0].translation;
        let (root, _) = sim.pose(BodyId(u16::try_from(root).unwrap())).unwrap();
        let tool = sim.tool(ArmId(0)).unwrap();
        let miss = (0..3).map(|i| (root[i] + there[i] - tool[i]).powi(2)).sum::<f64>().sqrt() * 1e3;
        format!("{}{off:.4} | {miss:.1}", if came { "" } else { "missed by " })
    }

    /// Postures within the middle of the limits, the same on every machine: to how many there was a way, how many the arm came to, and how
    /// many are too heavy for a motor.
    fn postures(&self, sim: &mut WorldSimulation) -> String {
        let (mut sent, mut came, mut heavy) = (0, 0, 0);
        let mut chance = 0.5;
        for _ in 0..12 {
            let joints = self.world.arms[0].joints.iter().map(|id| &self.world.joints[usize::from(id.0)]);
            let aims: Vec<f64> = joints
                .map(|joint| {
                    chance = (chance + 0.618_033_988_749_895_f64).fract();
                    let (lo, hi) = (joint.lo.max(-1.5), joint.hi.min(1.5));
                    lo + (hi - lo) * (0.2 + 0.6 * chance)
                })
                .collect();
            let Some(arrived) = send(sim, &aims, 1.0) else { continue };
            sent += 1;
            came += usize::from(arrived);
            let (_, needs, effort) = self.load(&aims);
            heavy += usize::from(!arrived && needs > effort);
        }
        let heavy = if heavy > 0 { format!(", {heavy} too heavy") } else { String::new() };
        format!("{came} of {sent}{heavy}")
    }
}

/// Sends the arm to a posture: whether it came there; nothing if there is no way.
fn send(sim: &mut WorldSimulation, aims: &[f64], speed: f64) -> Option<bool> {
    let command =
        MotorCommand::ReachJoints { arm: ArmId(0), positions: aims.to_vec(), max_speed: Some(speed) };
    let id = sim.command(command).ok()?;
    let (began, mut ended) = (sim.now(), None);
    while ended.is_none() && sim.now() < began + 30 * SECOND {
        sim.advance(sim.now() + SECOND / 10);
        ended = sim.finished().into_iter().find(|(known, _)| *known == id).map(|(_, result)| result);
    }
    Some(ended == Some(Ok(())))
}

/// What is in the text, or the description, of which the world has nothing.
fn lost(robot: &UrdfRobot, text: &str) -> String {
    let count = |word: &str| text.matches(word).count();
    let unmet =
        robot.links.iter().filter(|link| !link.visuals.is_empty() && link.collisions.is_empty()).count();
    let sensors = count("<sensor").saturating_sub(robot.range_sensors.len());
    let gears = robot.joints.iter().filter(|joint| joint.mimic.is_some()).count();
    let all = [
        (count("\"floating\""), "free root"),
        (robot.transmissions.len(), "transmissions"),
        (sensors, "sensors"),
        (count("<plugin"), "plugins"),
        (count("<safety_controller"), "soft limits"),
        (count("<calibration"), "calibrations"),
        (count("<texture"), "textures"),
        (unmet, "links only seen"),
        (gears, "gears felt one way"),
    ];
    let all = all.iter().filter(|(number, _)| *number > 0);
    let all: Vec<String> = all.map(|(number, what)| format!("{number} {what}")).collect();
    if all.is_empty() { "–".to_owned() } else { all.join(", ") }
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
    let store = HullFolder(Path::new(env!("CARGO_TARGET_TMPDIR")).join("hulls"));
    let (meshes, hulls, error) = warm_hulls(world, &store);
    let found = began.elapsed().as_secs_f64();
    let mut sim = WorldSimulation::new(world, &[]).map_err(|e| e.to_string())?;
    let placed = Placed { robot, world, tip };
    let start = sim.joint_positions(ArmId(0));
    let (joint, needs, effort) = placed.load(&start);
    let (step, drift) = stand(&mut sim, &start);
    let (near, several) = (placed.go(&mut sim), placed.postures(&mut sim));
    println!(
        "{name}: read in {read:.2} s; {meshes} meshes, which are off by {:.1} mm, in {found:.2} s; {step:.0} µs a step",
        error * 1e3
    );
    let load = if joint.is_empty() { "–".to_owned() } else { format!("{joint} {needs:.1} of {effort}") };
    let free = world.joints.iter().filter(|joint| !joint.is_rigid()).count();
    let said = said.iter().map(|(word, count)| format!("{count} {word}")).collect::<Vec<_>>().join(", ");
    Ok(format!(
        "| {name} | {}, {}, {free} | {hulls} | {} | {} | {load} | {drift:.4} | {near} | {several} |",
        robot.links.len(),
        robot.joints.len(),
        if said.is_empty() { "–" } else { &said },
        lost(robot, &fs::read_to_string(path).unwrap_or_default()),
    ))
}

const HEAD: &str = "\
| robot | links, joints, moving | hulls | said | lost | weight and friction, N·m or N | moved in 5 s, rad | off a posture, rad | mm | postures |
|---|---|---|---|---|---|---|---|---|---|";

#[test]
fn robots_of_a_folder_stand_and_move() {
    let Ok(folder) = env::var("HRDSL_ROBOTS") else { return };
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/robot_zoo.txt");
    let list = fs::read_to_string(Path::new(&folder).join("zoo.txt"));
    let list = list.or_else(|_| fs::read_to_string(own)).unwrap();
    let mut rows = vec![HEAD.to_owned()];
    for line in list.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#')) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [name, path, packages, tip] = words.as_slice() else { panic!("{line}: four words are needed") };
        let [path, packages] =
            [path, packages].map(|p| Path::new(&folder).join(p).to_string_lossy().into_owned());
        match show(name, &path, &packages, tip) {
            Ok(row) => rows.push(row),
            Err(why) => rows
                .push(format!("| {name} | | | {} | | | | | | not used |", why.replace(['{', '}', '"'], ""))),
        }
    }
    println!("{}", rows.join("\n"));
}
