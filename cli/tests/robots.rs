//! Robots that are made from descriptions, and a map, from end to end: nothing in Rust knows of them.

mod support;

use std::{collections::BTreeMap, fs, path::Path};

use serde_json::Value;
use support::{command, expect_code, hrdsl_in, root, stdout, tree};

/// A copy of the robots' files.
fn copy(folder: &Path) {
    for (name, bytes) in tree(&root().join("cli/tests/robots")) {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
}

/// Of each requirement the outcome.
fn outcomes(folder: &Path, out: &str) -> BTreeMap<String, String> {
    let results: Value =
        serde_json::from_slice(&fs::read(folder.join(out).join("results.json")).unwrap()).unwrap();
    let test = &results["tests"][0];
    assert!(test["error"].is_null(), "{test}");
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let verdicts = test["verdicts"].as_array().unwrap().iter();
    verdicts.map(|v| (text(&v["requirement"]), text(&v["outcome"]))).collect()
}

#[test]
fn an_arm_from_xacro_picks_a_box_with_fingers_that_follow_each_other() {
    let folder = tempfile::tempdir().unwrap();
    copy(folder.path());
    expect_code(&hrdsl_in(folder.path(), "sim pick.hri --check-determinism -o out"), 0);
    let outcomes = outcomes(folder.path(), "out");
    assert!(["R1", "R2", "R3"].iter().all(|r| outcomes[*r] == "pass"), "{outcomes:?}");
}

#[test]
fn a_base_drives_through_the_door_of_a_map_with_the_laser_of_its_description() {
    let folder = tempfile::tempdir().unwrap();
    copy(folder.path());
    expect_code(&hrdsl_in(folder.path(), "sim door.hri --check-determinism -o out"), 0);
    let outcomes = outcomes(folder.path(), "out");
    assert!(["R1", "R2", "R3"].iter().all(|r| outcomes[*r] == "pass"), "{outcomes:?}");
}

#[test]
fn hulls_from_the_cache_give_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    copy(folder.path());
    let cache = folder.path().join("cache");
    // Python's packages need not be installed again.
    let known = root().join("target/hrdsl-cache");
    for (name, bytes) in tree(&known).into_iter().filter(|(name, _)| !name.starts_with("hulls")) {
        let path = cache.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    for out in ["cold", "warm"] {
        let mut sim = command();
        sim.args(["sim", "pick.hri", "-o", out]).env("HRDSL_CACHE", &cache).current_dir(folder.path());
        expect_code(&sim.output().unwrap(), 0);
    }
    assert!(fs::read_dir(cache.join("hulls")).unwrap().count() == 2, "two meshes");
    let recordings = |out: &str| -> BTreeMap<String, Vec<u8>> {
        tree(&folder.path().join(out)).into_iter().filter(|(name, _)| name.ends_with(".jsonl")).collect()
    };
    assert!(recordings("cold") == recordings("warm") && !recordings("cold").is_empty());
}

#[test]
fn what_is_wrong_in_a_description_is_shown_there() {
    let folder = tempfile::tempdir().unwrap();
    copy(folder.path());
    let urdf = folder.path().join("rover.urdf");
    let text = fs::read_to_string(&urdf).unwrap();
    fs::write(&urdf, text.replace("<mass value=\"12\"/>", "<mass value=\"heavy\"/>")).unwrap();
    let out = hrdsl_in(folder.path(), "check door.hri --format json");
    expect_code(&out, 1);
    assert!(stdout(&out).contains("rover.urdf") && stdout(&out).contains("HR0807"), "{}", stdout(&out));
}
