//! `hrdsl check` on many files: what is found, which tests belong where, what is denied, what is fixed.

mod support;

use std::fs;

use support::{expect_code, folder, hrdsl_in, hrdsl_reading, scenario, stderr, stdout, tree};

const WARNED: &str = "agent Guest plays guest { goal !rest\n plan +!rest { }\n plan +!rset { } }\n";

/// The lines of stdout up to the colon: the scenarios that are well formed.
fn well_formed(out: &std::process::Output) -> Vec<String> {
    stdout(out).lines().map(|l| l.split(':').next().unwrap().to_owned()).collect()
}

#[test]
fn folders_are_searched_and_tests_go_to_the_nearest_scenario() {
    let (a, b) = (scenario("a", "ask"), scenario("b", "shout"));
    let folder = folder(&[
        ("a/scenario.hri", &a),
        ("a/tests/deep/t.hri", "test t { ask }\n"),
        ("a/tests/unfinished.hri", "test u { ask; wait 1 s }\n"),
        ("b/only.hri", &b),
        ("b/t.hri", "test t { shout }\n"),
        ("b/named.hri", "scenario b\ntest n { shout }\n"),
        ("b/.hidden/x.hri", "scenario"),
        ("target/x.hri", "scenario"),
        ("b/node_modules/x.hri", "scenario"),
        ("hrdsl-out/x.hri", "scenario"),
        ("b/notes.txt", "scenario"),
    ]);
    let out = hrdsl_in(folder.path(), "check .");
    expect_code(&out, 0);
    assert_eq!(well_formed(&out), ["a/scenario.hri", "b/only.hri"]);
    let tests: Vec<String> =
        stdout(&out).lines().map(|l| l.rsplit(", ").next().unwrap().to_owned()).collect();
    assert_eq!(tests, ["2 tests", "2 tests"]);

    fs::write(folder.path().join("b/t.hri"), "test t { ask }\n").unwrap();
    let out = hrdsl_in(folder.path(), "check a b");
    expect_code(&out, 1);
    assert_eq!(well_formed(&out), ["a/scenario.hri"]);
    assert!(stderr(&out).contains("b/t.hri:1:10") && stderr(&out).contains("1 error"), "{}", stderr(&out));
}

#[test]
fn files_of_other_kinds_are_named_with_what_to_do_with_them() {
    let others = [
        ("r.urdf.xacro", "part NAME from \"r.urdf.xacro\""),
        ("house.mas2j", "hrdsl import agentspeak house.mas2j"),
        ("gate.xml", "hrdsl import uppaal gate.xml"),
        ("run.mcap", "hrdsl view SCENARIO run.mcap"),
        ("robot.py", "run \"python3 robot.py\""),
    ];
    let scenario = scenario("a", "ask");
    let files: Vec<(&str, &str)> = others.iter().map(|(name, _)| (*name, "<robot/>")).collect();
    let folder = folder(&[&files[..], &[("a.hri", &scenario)]].concat());
    for (name, advice) in others {
        for command in ["check", "fmt", "gen", "prove", "sim", "check a.hri", "sim a.hri"] {
            let out = hrdsl_in(folder.path(), &format!("{command} {name}"));
            expect_code(&out, 2);
            let said = stderr(&out);
            assert!(
                said.starts_with(&format!("error: {name} ")) && said.contains(advice),
                "{command}: {said}"
            );
        }
    }
    // What is not there is not looked at.
    assert_eq!(stderr(&hrdsl_in(folder.path(), "check gone.urdf")), "error: no such file: gone.urdf\n");
}

#[test]
fn systems_are_checked_with_their_scenario() {
    let folder = folder(&[
        ("a/scenario.hri", &scenario("a", "ask")),
        ("a/ros/system.hri", "system with_ros plays robot { run \"python3 a.py\" }\n"),
        ("a/ros/wrong.txt", "system with_ros plays robto { run \"python3 a.py\" }\n"),
    ]);
    expect_code(&hrdsl_in(folder.path(), "check ."), 0);
    expect_code(&hrdsl_in(folder.path(), "check a/scenario.hri a/ros/system.hri"), 0);
    let out = hrdsl_in(folder.path(), "check --format json a/ros/system.hri a/scenario.hri");
    let document: serde_json::Value = serde_json::from_str(&stdout(&out)).unwrap();
    let file = &document["files"][1];
    assert_eq!((file["kind"].as_str(), file["with"].as_str()), (Some("system"), Some("a/scenario.hri")));

    let alone = hrdsl_in(folder.path(), "check a/ros/system.hri");
    expect_code(&alone, 2);
    assert!(stderr(&alone).contains("`hrdsl check scenario.hri a/ros/system.hri`"), "{}", stderr(&alone));

    fs::copy(folder.path().join("a/ros/wrong.txt"), folder.path().join("a/ros/system.hri")).unwrap();
    let out = hrdsl_in(folder.path(), "check a");
    expect_code(&out, 1);
    assert!(
        stderr(&out).contains("a/ros/system.hri:1:23") && stderr(&out).contains("`robot`"),
        "{}",
        stderr(&out)
    );
}

#[test]
fn tests_go_to_the_only_scenario_that_was_named() {
    let folder = folder(&[
        ("a/scenario.hri", &scenario("a", "ask")),
        ("b/scenario.hri", &scenario("b", "shout")),
        ("b/t.hri", "test t { ask }\n"),
    ]);
    expect_code(&hrdsl_in(folder.path(), "check a/scenario.hri b/t.hri"), 0);
    // Found in a folder and named is named.
    expect_code(&hrdsl_in(folder.path(), "check b a/scenario.hri"), 0);
    expect_code(&hrdsl_in(folder.path(), "check . a/scenario.hri"), 0);
    expect_code(&hrdsl_in(folder.path(), "check a b"), 1);
    // With two it is the nearest again.
    expect_code(&hrdsl_in(folder.path(), "check a/scenario.hri b/scenario.hri b/t.hri"), 1);
}

#[test]
fn tests_without_a_scenario_are_refused() {
    let (a, b) = (scenario("a", "ask"), scenario("b", "ask"));
    let folder = folder(&[
        ("x/a.hri", &a),
        ("x/b.hri", &b),
        ("x/t.hri", "test t { ask }\n"),
        ("y/t.hri", "test t { ask }\n"),
    ]);
    let out = hrdsl_in(folder.path(), "check y");
    expect_code(&out, 2);
    assert!(stderr(&out).contains("y/t.hri holds tests, and their scenario is not among the files"));
    assert!(stderr(&out).contains("hrdsl check scenario.hri y/t.hri"), "{}", stderr(&out));
    let out = hrdsl_in(folder.path(), "check x");
    expect_code(&out, 2);
    assert!(stderr(&out).contains("not clear of which scenario: x/a.hri, x/b.hri"), "{}", stderr(&out));
    expect_code(&hrdsl_in(folder.path(), "check x/a.hri x/t.hri"), 0);
    fs::rename(folder.path().join("x/b.hri"), folder.path().join("x/scenario.hri")).unwrap();
    expect_code(&hrdsl_in(folder.path(), "check x"), 0);
}

#[test]
fn a_folder_without_scenarios_is_named() {
    let folder = folder(&[("a/x.txt", "")]);
    let out = hrdsl_in(folder.path(), "check a");
    expect_code(&out, 2);
    assert_eq!(stderr(&out), "error: no .hri file in a or the folders in it\n");
}

#[test]
fn standard_input_is_a_file_like_others() {
    let folder = folder(&[("scenario.hri", &scenario("a", "ask"))]);
    let out = hrdsl_reading(folder.path(), "check -", &scenario("typed", "ask"));
    expect_code(&out, 0);
    assert!(stdout(&out).starts_with("<stdin>: scenario `typed` is well formed"), "{}", stdout(&out));
    let out = hrdsl_reading(folder.path(), "check scenario.hri -", "test t { aks }\n");
    expect_code(&out, 1);
    assert!(stderr(&out).contains("<stdin>:1:10"), "{}", stderr(&out));
    let out = hrdsl_reading(folder.path(), "check - --fix", &scenario("typed", "ask"));
    expect_code(&out, 2);
    assert!(stderr(&out).contains("`--fix` cannot change standard input"), "{}", stderr(&out));
}

/// Declarations without a `scenario` line are compiled, whatever the compiler makes of them, and not taken for tests.
#[test]
fn a_module_is_no_file_of_tests() {
    let folder = folder(&[("m.hri", "const N = 3\nconst M = 2 s + 3 m\ntest t { ask }\n")]);
    let out = hrdsl_in(folder.path(), "check m.hri --format json");
    expect_code(&out, 1);
    let document: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(document["files"][0]["kind"], "module");
    assert!(document["diagnostics"].as_array().unwrap().iter().any(|d| d["code"] == "HR0203"));
}

#[test]
fn denied_warnings_fail() {
    let text = scenario("a", "ask") + WARNED;
    let folder = folder(&[("a.hri", &text)]);
    let out = hrdsl_in(folder.path(), "check a.hri");
    expect_code(&out, 0);
    assert!(stdout(&out).contains("is well formed") && stderr(&out).ends_with("1 warning\n"));
    for deny in ["warnings", "HR0403", "hr0403", "HR0101 --deny HR0403"] {
        let out = hrdsl_in(folder.path(), &format!("check a.hri --deny {deny}"));
        expect_code(&out, 1);
        assert_eq!(stdout(&out), "");
        assert!(stderr(&out).ends_with("1 error\n"), "{}", stderr(&out));
    }
    expect_code(&hrdsl_in(folder.path(), "check a.hri --deny HR0101"), 0);
    let out = hrdsl_in(folder.path(), "check a.hri --deny HR9999");
    expect_code(&out, 2);
    assert!(stderr(&out).contains("`hrdsl explain` lists them"), "{}", stderr(&out));
}

#[test]
fn gen_counts_warnings_and_shows_errors() {
    let suite = "suite s by random { stimuli ask; tests 2 }\n";
    let text = scenario("a", "ask") + suite + WARNED;
    let folder = folder(&[("a.hri", &text)]);
    let out = hrdsl_in(folder.path(), "gen a.hri");
    expect_code(&out, 0);
    assert_eq!(stderr(&out), "2 warnings (`hrdsl check a.hri` shows them)\n");
    fs::write(folder.path().join("a.hri"), text + "require R functional x causes called\n").unwrap();
    let out = hrdsl_in(folder.path(), "gen a.hri");
    expect_code(&out, 1);
    assert!(stderr(&out).contains("HR0101") && !stderr(&out).contains("HR0403"), "{}", stderr(&out));
    assert!(
        stderr(&out).ends_with("1 error\n1 warning (`hrdsl check a.hri` shows it)\n"),
        "{}",
        stderr(&out)
    );
}

/// Faults with a certain fix, the second `;` found only when the first is gone, and one whose fix is a guess.
const CROOKED: &str = "\
agent Guest plays guest {
  belief had(cups: 0..2) = had(0)
  goal !rest
  plan +!rest when had(N) && N ≤ 1 && N ≠ 0 { ;; wait 1 s }
  plan +!rset { }
}
";

#[test]
fn fixes_that_are_certain_are_applied() {
    let text = scenario("a", "ask") + CROOKED;
    let folder = folder(&[("a.hri", &text), ("b.hri", &scenario("b", "ask"))]);
    let before = tree(folder.path());

    let out = hrdsl_in(folder.path(), "check . --diff");
    expect_code(&out, 1);
    assert_eq!(
        stdout(&out),
        "\
--- a.hri
+++ a.hri
@@ -9,6 +9,6 @@
 agent Guest plays guest {
   belief had(cups: 0..2) = had(0)
   goal !rest
-  plan +!rest when had(N) && N ≤ 1 && N ≠ 0 { ;; wait 1 s }
+  plan +!rest when had(N) && N <= 1 && N != 0 {  wait 1 s }
   plan +!rset { }
 }
"
    );
    assert_eq!(tree(folder.path()), before, "--diff changes nothing");

    let out = hrdsl_in(folder.path(), "check . --fix");
    expect_code(&out, 0);
    let said = stderr(&out);
    assert!(said.contains("fixed a.hri:12:32: replace `≤` by `<=`\n"), "{said}");
    assert!(said.contains(": take the `;` away\n") && said.contains("4 fixes in 1 file\n"), "{said}");
    assert!(said.ends_with("1 warning\n"), "what is not certain stays: {said}");
    let after = tree(folder.path());
    let fixed = text.replace('≤', "<=").replace('≠', "!=").replace("{ ;;", "{ ");
    assert_eq!(String::from_utf8_lossy(&after["a.hri"]), fixed);
    assert_eq!(after.len(), 2, "nothing else is left behind");
    assert_eq!(after["b.hri"], before["b.hri"]);

    let out = hrdsl_in(folder.path(), "check . --fix");
    expect_code(&out, 0);
    assert!(stderr(&out).contains("nothing to fix\n"), "{}", stderr(&out));
    assert_eq!(tree(folder.path()), after);
    assert_eq!(stdout(&hrdsl_in(folder.path(), "check . --diff")), "");
}

#[cfg(unix)]
#[test]
fn a_fixed_file_keeps_its_rights_and_its_links() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = folder(&[("real/a.hri", &(scenario("a", "ask") + CROOKED))]);
    let real = folder.path().join("real/a.hri");
    fs::set_permissions(&real, fs::Permissions::from_mode(0o640)).unwrap();
    symlink(&real, folder.path().join("link.hri")).unwrap();
    expect_code(&hrdsl_in(folder.path(), "check link.hri --fix"), 0);
    assert!(folder.path().join("link.hri").is_symlink());
    assert!(fs::read_to_string(&real).unwrap().contains("N <= 1"));
    assert_eq!(fs::metadata(&real).unwrap().permissions().mode() & 0o777, 0o640);
}

#[test]
fn files_that_are_to_be_covered_are_there() {
    let system = "system robot { run \"python3 robot.py\"; coverage \"robot.py\", \"lib/move.py\", \"lib\", \"gone.py\", \"*.py\", \"*.cc\" }\n";
    let text = format!("{}{system}", scenario("a", "ask"));
    let folder =
        folder(&[("a/scenario.hri", &text), ("a/robot.py", ""), ("a/lib/move.py", ""), ("gone.py", "")]);
    let out = hrdsl_in(folder.path(), "check a/scenario.hri");
    expect_code(&out, 0);
    let said = stderr(&out);
    let line = text.lines().count();
    for name in ["lib", "gone.py", "*.cc"] {
        let column = system.rfind(&format!("\"{name}\"")).unwrap() + 1;
        assert!(said.contains(&format!("a/scenario.hri:{line}:{column}")), "{name}: {said}");
    }
    assert!(said.contains("HR0803") && said.contains("3 warnings"), "{said}");
    // From the scenario's folder, whatever the present one is; a plain name has that.
    let out = hrdsl_in(&folder.path().join("a"), "check scenario.hri");
    assert!(stderr(&out).contains("3 warnings"), "{}", stderr(&out));
    expect_code(&hrdsl_in(folder.path(), "check a/scenario.hri --deny HR0803"), 1);
    // Standard input has no folder.
    let out = hrdsl_reading(folder.path(), "check -", &text);
    assert!(!stderr(&out).contains("HR0803"), "{}", stderr(&out));
}

#[cfg(unix)]
#[test]
fn no_program_is_started_to_check() {
    use std::os::unix::fs::PermissionsExt;
    // All that is found on the path says that it was started.
    let programs = folder(&[]);
    let marker = programs.path().join("started");
    for name in ["python3", "python", "sh", "xacro", "rosmsg"] {
        let program = programs.path().join(name);
        fs::write(&program, format!("#!/bin/sh\necho {name} >> {}\n", marker.display())).unwrap();
        fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    }
    // Home care reads a workspace of messages.
    let mut check = support::command();
    check.env("PATH", programs.path()).arg("check").arg(support::root().join("examples"));
    let out = check.output().unwrap();
    expect_code(&out, 0);
    assert!(!marker.exists(), "{}", fs::read_to_string(&marker).unwrap());
    assert!(stdout(&out).contains("homecare"), "{}", stdout(&out));
}

#[test]
fn modules_of_scenarios_in_a_folder_are_checked_with_them() {
    let main =
        "scenario a\nuse \"people.hri\"\nactor guest : environment\nactor robot : system\nconst N = 3\n";
    let people = "use \"deep/calls.hri\"\nstimulus ask by guest { emit called(N) }\n";
    let calls = "event called(n: 0..9) from guest to robot\n";
    let alone = "event shouted from nobody\n";
    let at = folder(&[
        ("main.hri", main),
        ("people.hri", people),
        ("deep/calls.hri", calls),
        ("alone.hri", alone),
    ]);
    let out = hrdsl_in(at.path(), "check .");
    assert_eq!(well_formed(&out), ["main.hri"], "{}", stderr(&out));
    let said = stderr(&out);
    assert!(said.contains("no actor is called `nobody`") && !said.contains("guest"), "{said}");
    // One that is named is checked by itself.
    let out = hrdsl_in(at.path(), "check main.hri people.hri");
    assert!(stderr(&out).contains("no actor is called `guest`"), "{}", stderr(&out));
}
