//! All robots of a folder, which is not part of the project: `HRDSL_ROBOTS=FOLDER cargo test -p hrdsl-robots --test zoo`.
//!
//! With `HRDSL_ROBOTS_OUT=FOLDER`, what was read is written there as JSON, a file each, so that another reader's can be compared.

#![allow(clippy::disallowed_methods, reason = "the test reads a folder that is named by the environment")]

mod common;

use std::{
    collections::BTreeMap,
    env,
    fmt::Write,
    fs,
    path::{Path, PathBuf},
};

use common::RobotFolder;
use hrdsl_robots::{
    MeshChoice, PackageTable, RobotReading, RobotRequest, UrdfRobot, expanded_text, read_robot,
};
use hrdsl_source::{SourceFiles, Span};

fn below(folder: &Path, endings: &[&str], found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path()).collect();
    entries.sort();
    for entry in entries {
        if entry.is_dir() {
            below(&entry, endings, found);
        } else if endings.iter().any(|ending| entry.to_string_lossy().ends_with(ending)) {
            found.push(entry);
        }
    }
}

/// A value for each joint from its number: the same in every language.
fn value_of(joint: usize) -> f64 {
    let n = joint as f64;
    (n * 0.618_033_988_749_895).fract() - 0.5
}

fn json(robot: &UrdfRobot) -> String {
    let mut out = String::from("{\n\"links\": {");
    let values: Vec<f64> = (0..robot.joints.len()).map(value_of).collect();
    let values = robot.followed(&values);
    for (at, (link, pose)) in robot.links.iter().zip(robot.link_poses(&values)).enumerate() {
        let comma = if at > 0 { "," } else { "" };
        let numbers =
            pose.rotation.iter().flatten().chain(&pose.translation).map(f64::to_string).collect::<Vec<_>>();
        let mass = link.inertial.map_or(0.0, |inertial| inertial.mass);
        let tensor = link.inertial.map_or([0.0; 6], |i| {
            [i.inertia.ixx, i.inertia.ixy, i.inertia.ixz, i.inertia.iyy, i.inertia.iyz, i.inertia.izz]
        });
        let (c, v) = (link.collisions.len(), link.visuals.len());
        write!(out, "{comma}\n{:?}: {{\"pose\": [{}], \"mass\": {mass}, \"inertia\": {tensor:?}, \"collisions\": {c}, \"visuals\": {v}}}", link.name, numbers.join(", ")).unwrap();
    }
    out.push_str("},\n\"joints\": {");
    for (at, joint) in robot.joints.iter().enumerate() {
        let comma = if at > 0 { "," } else { "" };
        let number = |n: Option<f64>| n.map_or("null".to_owned(), |n| n.to_string());
        let limits = joint.limits;
        let mimic = joint.mimic.map_or("null".to_owned(), |m| {
            format!("[{:?}, {}, {}]", robot.joint(m.joint).unwrap().name, m.multiplier, m.offset)
        });
        write!(
            out,
            "{comma}\n{:?}: {{\"type\": {:?}, \"lower\": {}, \"upper\": {}, \"effort\": {}, \"velocity\": {}, \"axis\": {:?}, \
             \"damping\": {}, \"friction\": {}, \"mimic\": {mimic}, \"value\": {}}}",
            joint.name,
            joint.kind.word(),
            number(limits.map(|l| l.lower)),
            number(limits.map(|l| l.upper)),
            number(limits.and_then(|l| l.effort)),
            number(limits.and_then(|l| l.velocity)),
            joint.axis,
            joint.dynamics.damping,
            joint.dynamics.friction,
            values[at],
        )
        .unwrap();
    }
    out.push_str("}}\n");
    out
}

fn mesh_json(reading: &RobotReading) -> String {
    let one = |(path, mesh): (&String, &hrdsl_robots::TriangleMesh)| {
        let (low, high) = mesh.bounds().unwrap();
        format!(
            "{path:?}: {{\"triangles\": {}, \"low\": {low:?}, \"high\": {high:?}, \"area\": {}, \"volume\": {}}}",
            mesh.triangles.len(),
            mesh.area(),
            mesh.volume()
        )
    };
    format!("{{{}}}\n", reading.meshes.iter().map(one).collect::<Vec<_>>().join(",\n"))
}

#[test]
fn the_robots_of_a_folder_are_read() {
    let Some(folder) = env::var_os("HRDSL_ROBOTS").map(PathBuf::from) else { return };
    let out = env::var_os("HRDSL_ROBOTS_OUT").map(PathBuf::from);
    let reader = RobotFolder(Path::new("/"));
    let root = folder.canonicalize().unwrap();
    let root = root.to_string_lossy();
    let mut files = SourceFiles::default();
    let place = Span::new(files.add("the test", ""), 0, 0);
    let mut packages = PackageTable::new();
    packages.search(&reader, &mut files, &root, place.into());
    let (mut found, mut words) = (Vec::new(), BTreeMap::<String, usize>::new());
    below(Path::new(&*root), &[".urdf", ".xacro"], &mut found);
    let mut refused = Vec::new();
    // `NAME:=VALUE NAME:=VALUE`
    let given = env::var("HRDSL_ROBOTS_ARGUMENTS").unwrap_or_default();
    let arguments: Vec<(String, String)> = given
        .split_whitespace()
        .filter_map(|pair| pair.split_once(":="))
        .map(|(name, value)| (name.to_owned(), value.to_owned()))
        .collect();
    for path in &found {
        let mut files = SourceFiles::default();
        let place = Span::new(files.add("the test", ""), 0, 0);
        let path = path.to_string_lossy();
        let request = RobotRequest {
            arguments: &arguments,
            meshes: MeshChoice::All,
            ..RobotRequest::new(&path, place, &packages)
        };
        let reading = read_robot(&request, &mut files, &reader);
        let short = path.strip_prefix(&*root).unwrap().trim_start_matches('/').replace('/', "__");
        for fault in &reading.faults {
            let grade = if fault.is_error() { "error" } else { "warning" };
            *words.entry(format!("{grade} {}", fault.kind.word())).or_default() += 1;
            println!(
                "{short}: {grade} {} {}: {} ({})",
                files.place(fault.place.span).rsplit('/').next().unwrap(),
                fault.kind.word(),
                fault.kind,
                fault.help
            );
        }
        if !reading.is_sound() {
            refused.push(short.clone());
        }
        if let (Some(out), Some(robot)) = (&out, &reading.robot) {
            fs::write(out.join(format!("{short}.json")), json(robot)).unwrap();
            fs::write(out.join(format!("{short}.meshes")), mesh_json(&reading)).unwrap();
        }
        if let (Some(out), true) = (&out, path.ends_with(".xacro"))
            && let Ok(text) = expanded_text(&request, &mut files, &reader)
        {
            fs::write(out.join(format!("{short}.expanded")), text).unwrap();
        }
    }
    println!(
        "{} descriptions, of which {} are refused: {refused:#?}\n{words:#?}",
        found.len(),
        refused.len()
    );
    assert!(!found.is_empty(), "there is no description in {root}");
}
