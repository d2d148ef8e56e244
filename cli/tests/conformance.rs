//! The conformance suite of the protocol, run on the drivers that come with it and on a driver that is wrong.
#![allow(clippy::disallowed_methods, reason = "tests start processes and read files")]

mod support;

use support::{expect_code, folder, hrdsl_in, root, stderr, stdout};

fn conformance(words: &str) -> std::process::Output {
    hrdsl_in(&root().join("spec/protocol"), &format!("conformance {words}"))
}

#[test]
fn the_sdk_for_python_conforms() {
    let out = conformance("-- python3 driver.py");
    expect_code(&out, 0);
    assert!(stdout(&out).ends_with("24 cases: 24 passed, 0 skipped, 0 failed\n"), "{}", stdout(&out));
}

/// In another language, and with nothing but the page.
#[test]
fn a_driver_in_javascript_without_any_library_conforms() {
    let out = conformance("-- node driver.js");
    expect_code(&out, 0);
    assert!(stdout(&out).ends_with("24 cases: 24 passed, 0 skipped, 0 failed\n"), "{}", stdout(&out));
}

#[test]
fn a_driver_of_version_1_runs_the_cases_of_version_1() {
    let out = conformance("--protocol 1 -- node driver.js 1");
    expect_code(&out, 0);
    assert!(stdout(&out).ends_with("7 cases: 7 passed, 0 skipped, 0 failed\n"), "{}", stdout(&out));
    let out = conformance("--case actions --protocol 1 -- node driver.js 1");
    expect_code(&out, 2);
    assert!(stderr(&out).contains("need version 2 of the protocol"), "{}", stderr(&out));
}

/// What a wrong driver is told: the case, the first line that differs, and what it should have been.
#[test]
fn the_first_difference_is_named() {
    let driver = std::fs::read_to_string(root().join("spec/protocol/driver.js")).unwrap();
    let wrong = driver.replace("seconds: step.seconds", "seconds: 2 * step.seconds");
    assert_ne!(driver, wrong);
    let silent = "process.exit(0);\n";
    let partial = "console.log(JSON.stringify({ skip: \"no actions\" }));\nprocess.exit(0);\n";
    let folder = folder(&[("wrong.js", &wrong), ("silent.js", silent), ("partial.js", partial)]);
    let told = |words: &str| hrdsl_in(folder.path(), &format!("conformance --case time {words}"));

    let out = told("-- node wrong.js");
    expect_code(&out, 3);
    insta::assert_snapshot!("conformance_wrong_driver", stdout(&out));
    let out = told("-- node silent.js");
    expect_code(&out, 3);
    insta::assert_snapshot!("conformance_silent_driver", stdout(&out));
    let out = told("-- node partial.js");
    expect_code(&out, 0);
    assert!(stdout(&out).starts_with("time: skipped (no actions)\n"), "{}", stdout(&out));
    let out = told("-- ./absent");
    expect_code(&out, 2);
    assert_eq!(stderr(&out), "error: there is no driver ./absent\n");
}

/// A run that breaks off as the case has it, and one that should have and does not.
#[test]
fn an_error_that_a_case_expects_has_to_come() {
    let driver = std::fs::read_to_string(root().join("spec/protocol/driver.js")).unwrap();
    let silent =
        driver.replace("failed: (step) => told(about(step, \"node\", \"text\"))", "failed: () => ({})");
    assert_ne!(driver, silent);
    let folder = folder(&[("silent.js", &silent)]);
    let out = hrdsl_in(folder.path(), "conformance --case failed -- node silent.js");
    expect_code(&out, 3);
    assert!(
        stdout(&out).contains("the run had to break off: the node /driver has failed: "),
        "{}",
        stdout(&out)
    );
    assert!(stdout(&out).contains("got      a run that did not break off\n"), "{}", stdout(&out));
}

#[test]
fn cases_are_listed_and_chosen_by_name() {
    let out = conformance("--list");
    expect_code(&out, 0);
    assert_eq!(stdout(&out).lines().count(), 24);
    assert!(stdout(&out).starts_with("time           Simulated time passes"), "{}", stdout(&out));
    let out = conformance("--case act -- node driver.js");
    expect_code(&out, 2);
    assert!(stderr(&out).contains("no case is called `act`; there are time, events,"), "{}", stderr(&out));
}
