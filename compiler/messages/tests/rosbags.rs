//! The standard packages against those of rosbags, another reader of ROS's definitions: names, types, bounds, constants and sums.
//!
//! Python does the comparison (`rosbags_compare.py`), with a pinned version of rosbags that pip fetches once, into the target folder.

#![allow(clippy::disallowed_methods, reason = "the test runs Python on files that it writes")]

mod common;

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

use common::standard;
use hrdsl_messages::{InterfaceName, RosVersion};

const PINNED: &str = "rosbags==0.11.9";

fn run(command: &mut Command) -> Output {
    command
        .output()
        .unwrap_or_else(|error| panic!("{command:?} cannot be run: {error}; this test needs Python 3.10"))
}

/// The folder that holds rosbags, which is made once. What it depends on is for reading bags, and left out.
fn installed() -> PathBuf {
    let cache = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let place = cache.join(PINNED.replace("==", "-"));
    if place.exists() {
        return place;
    }
    let scratch = tempfile::tempdir_in(cache).unwrap();
    let target = scratch.path().join("packages");
    let install = |python: &Path| {
        let mut command = Command::new(python);
        command.args([
            "-I",
            "-m",
            "pip",
            "install",
            "--no-input",
            "--disable-pip-version-check",
            "--no-deps",
            "--target",
        ]);
        run(command.arg(&target).arg(PINNED).env("PIP_ROOT_USER_ACTION", "ignore").env("PIP_USER", "0"))
    };
    let mut output = install(Path::new("python3"));
    if String::from_utf8_lossy(&output.stderr).contains("No module named pip") {
        let environment = scratch.path().join("venv");
        run(Command::new("python3").args(["-m", "venv"]).arg(&environment));
        output = install(&environment.join("bin/python"));
    }
    assert!(
        output.status.success(),
        "pip could not install {PINNED}, with which the standard packages are compared; without a network, give pip a folder of \
         wheels by PIP_FIND_LINKS and PIP_NO_INDEX:\n{}",
        String::from_utf8_lossy(&output.stderr)
    );
    // Another run of the test may have been faster: then the folder is there.
    let moved = fs::rename(&target, &place);
    assert!(moved.is_ok() || place.exists(), "{} cannot be moved to {}", target.display(), place.display());
    place
}

/// The table of all that is known, as a file.
fn table(version: RosVersion, folder: &Path) -> PathBuf {
    let library = standard(version);
    let names: Vec<InterfaceName> = library
        .messages()
        .map(|(name, _)| name)
        .chain(library.services().map(|(name, _)| name))
        .cloned()
        .collect();
    let path = folder.join(format!("{version}.json"));
    fs::write(&path, serde_json::to_string(&library.closure(&names).unwrap()).unwrap()).unwrap();
    path
}

#[test]
fn they_are_those_of_rosbags() {
    let packages = installed();
    let folder = tempfile::tempdir().unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/rosbags_compare.py");
    for version in [RosVersion::Ros1, RosVersion::Ros2] {
        let mut command = Command::new("python3");
        command.arg("-I").arg(&script).arg(&packages).arg(table(version, folder.path()));
        let output = run(&mut command);
        let said = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{version}: {said}{}", String::from_utf8_lossy(&output.stderr));
        println!("{version}: {said}");
    }
}
