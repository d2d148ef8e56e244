//! `hrdsl check` and `hrdsl emit`, as a user types them.

mod support;

use std::fs;

use support::{expect_code, handover, hrdsl, stderr, stdout};

#[test]
fn the_example_is_well_formed() {
    let out = hrdsl([std::ffi::OsStr::new("check"), handover().as_os_str()]);
    expect_code(&out, 0);
    assert!(stdout(&out).contains("scenario `handover` is well formed"));
    assert_eq!(stderr(&out), "");
}

#[test]
fn every_stop_of_the_way_can_be_printed() {
    for stage in ["ast", "scenario", "bdi", "ta", "monitors", "coverage", "world"] {
        let out = hrdsl(["emit", stage, handover().to_str().unwrap()]);
        expect_code(&out, 0);
        let value: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
        assert!(!value.is_null(), "{stage}");
    }
}

#[test]
fn a_missing_file_is_named() {
    let out = hrdsl(["check", "nowhere.hri"]);
    expect_code(&out, 2);
    assert_eq!(stderr(&out), "error: no such file: nowhere.hri\n");
}

#[test]
fn a_file_that_is_no_text_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("bytes.hri");
    fs::write(&file, [0x73, 0xff, 0xfe, 0x00]).unwrap();
    let out = hrdsl([std::ffi::OsStr::new("check"), file.as_os_str()]);
    expect_code(&out, 2);
    assert!(stderr(&out).contains("is not UTF-8 text (byte 1)"), "{}", stderr(&out));
}

/// Several errors at once, each at its place with the right name.
#[test]
fn misspelt_names_are_found_and_fixed() {
    let folder = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(handover()).unwrap();
    let text = text
        .replace("after decided(_)", "after decide(_)")
        .replace("-+asked(N + 1)", "-+aksed(N + 1)")
        .replace("agent Sensors plays sensors", "agent Sensors plays sensor")
        .replace("DEADLINE = 10 s ", "DEADLINE = 10 sec ");
    let file = folder.path().join("broken.hri");
    fs::write(&file, text).unwrap();
    let out = hrdsl([std::ffi::OsStr::new("check"), file.as_os_str()]);
    expect_code(&out, 1);
    for name in ["`decided`", "`asked`", "`sensors`", "`s`"] {
        let help = stderr(&out).lines().any(|l| l.contains("help:") && l.contains(name));
        assert!(help, "no help names {name}:\n{}", stderr(&out));
    }
}

#[test]
fn wrong_arguments_are_exit_code_2() {
    expect_code(&hrdsl(["check"]), 2);
    expect_code(&hrdsl(["emit", "nothing", "x.hri"]), 2);
    expect_code(&hrdsl(["fly"]), 2);
}
