//! `hrdsl explain`, `new`, `completions`, `man`, `--color`, and what `spec/cli.md` says of the command line.

mod support;

use std::fs;

use hrdsl_source::REGISTRY;
use serde_json::Value;
use support::{command, expect_code, folder, hrdsl, hrdsl_in, root, stderr, stdout, tree};

#[test]
fn every_code_is_explained() {
    for info in REGISTRY {
        let out = hrdsl(["explain", &info.code.to_string()]);
        expect_code(&out, 0);
        let text = stdout(&out);
        assert!(text.starts_with(&format!("{}: {}\n\n", info.code, info.title)), "{text}");
        assert!(
            text.contains("\n    scenario ") && !text.contains("```") && !text.contains('\u{1b}'),
            "{text}"
        );
    }
}

#[test]
fn where_a_requirement_comes_from_is_told() {
    let folder = folder(&[(
        "lamp.hri",
        "scenario lamp\nactor robot : system\nevent asked, lit from robot\n\
         /// ISO 13482:2014, 5.10.8\nrequire R1 functional asked causes lit\n",
    )]);
    let read = hrdsl_in(folder.path(), "explain lamp.hri R1");
    expect_code(&read, 0);
    assert!(
        stdout(&read).starts_with("R1\n  ISO 13482:2014, 5.10.8\n  asked causes lit\n"),
        "{}",
        stdout(&read)
    );
    let read: Value =
        serde_json::from_slice(&hrdsl_in(folder.path(), "explain lamp.hri --json").stdout).unwrap();
    assert_eq!(read[0]["doc"], "ISO 13482:2014, 5.10.8");
}

#[test]
fn codes_are_listed_by_hundreds() {
    let text = stdout(&hrdsl(["explain"]));
    let [names, types] = ["HR01xx: names\n", "HR02xx: types and units\n"].map(|h| text.find(h).unwrap());
    let unknown = text.find("  HR0101  a name that is not declared\n").unwrap();
    assert!(names < unknown && unknown < types);
    let list: Value = serde_json::from_slice(&hrdsl(["explain", "--json"]).stdout).unwrap();
    assert_eq!(list.as_array().unwrap().len(), REGISTRY.len());
    assert_eq!(list[0]["group"], "characters and syntax");
}

#[test]
fn a_page_as_json_is_the_file() {
    let out = hrdsl(["explain", "hr101", "--json"]);
    expect_code(&out, 0);
    let page: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(page["code"], "HR0101");
    let path = root().join(page["page"].as_str().unwrap());
    assert_eq!(page["text"], fs::read_to_string(path).unwrap());
}

#[test]
fn codes_that_do_not_exist_have_neighbours() {
    let out = hrdsl(["explain", "HR0199"]);
    expect_code(&out, 2);
    assert!(stderr(&out).contains("HR0109 (an allowance for nothing)"), "{}", stderr(&out));
    let out = hrdsl(["explain", "typo"]);
    expect_code(&out, 2);
    assert!(stderr(&out).contains("`hrdsl explain` lists them"), "{}", stderr(&out));
}

const LAMP: &str = "\
scenario lamp
actor person : environment
actor robot  : system
event asked  from person to robot
event lit(bright: bool) from robot
stimulus ask by person { emit asked }
require R1 functional \"it is lit\" asked causes lit(true) not before 1 s within 3 s
require R2 safety at most 2 lit between asked and lit(false)
require R3 safety never asked
";

#[test]
fn requirements_are_read_out() {
    let here = tempfile::tempdir().unwrap();
    fs::write(here.path().join("lamp.hri"), LAMP).unwrap();
    let out = hrdsl_in(here.path(), "explain lamp.hri R1");
    expect_code(&out, 0);
    let text = stdout(&out);
    for part in [
        "R1 \"it is lit\"\n  asked causes lit(true) not before 1 s within 3 s\n",
        "In the whole run, each `asked` is answered by `lit(true)` not before 1 s and within 3 s",
        "  fail          `lit(true)` comes less than 1 s after `asked`; or no `lit(true)` has come 3 s after the first `asked`",
        "  vacuous       no `asked` happens\n",
        "  inconclusive  the run ends while `asked` waits for its answer\n",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    assert!(!text.contains("R2"), "{text}");
    let out = hrdsl_in(here.path(), "explain lamp.hri --json");
    let all: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(all.as_array().unwrap().len(), 3);
    assert_eq!(all[1]["vacuous"], "no such part of the run ends");
    assert_eq!((&all[2]["pass"], &all[2]["vacuous"]), (&Value::Null, &Value::from("no `asked` happens")));
    let out = hrdsl_in(here.path(), "explain lamp.hri R9");
    expect_code(&out, 2);
    assert!(stderr(&out).contains("no requirement is called `R9`; there are R1, R2, R3"), "{}", stderr(&out));
    expect_code(&hrdsl_in(here.path(), "explain HR0101 R1"), 2);
}

#[test]
fn monitors_are_drawn() {
    let here = tempfile::tempdir().unwrap();
    fs::write(here.path().join("lamp.hri"), LAMP).unwrap();
    let out = hrdsl_in(here.path(), "emit monitors lamp.hri --dot");
    expect_code(&out, 0);
    let text = stdout(&out);
    for part in [
        "label = \"R1: asked causes lit(true) not before 1 s within 3 s\"",
        "[label = \"pending\\nuntil 3 s\", peripheries = 2]",
        "[label = \"lit(true)\\nsooner than 1 s\\nfail\"]",
        "[label = \"lit(_)\\nsuspect\"]",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    expect_code(&hrdsl_in(here.path(), "emit ta lamp.hri --dot"), 2);
}

#[test]
fn colours_obey_the_option_and_the_environment() {
    let colourful = |args: &[&str], env: &[(&str, &str)]| {
        let mut command = command();
        command.env_remove("NO_COLOR").args(args).envs(env.iter().copied());
        let out = command.output().unwrap();
        stdout(&out).contains('\u{1b}')
    };
    let page = ["explain", "HR0101"];
    assert!(!colourful(&page, &[]), "a pipe is no terminal");
    assert!(colourful(&page, &[("CLICOLOR_FORCE", "1")]));
    assert!(!colourful(&page, &[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")]));
    assert!(colourful(&["explain", "HR0101", "--color", "always"], &[("NO_COLOR", "1")]));
    assert!(!colourful(&["--color=never", "explain", "HR0101"], &[("CLICOLOR_FORCE", "1")]));
    assert!(colourful(&["--color=always", "--help"], &[]), "help, too");
    assert!(!colourful(&["--color=never", "--help"], &[("CLICOLOR_FORCE", "1")]));
}

#[test]
fn every_shell_has_completions() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let out = hrdsl(["completions", shell]);
        expect_code(&out, 0);
        for word in ["hrdsl", "explain", "--deny", "--exit-zero"] {
            let word = if shell == "fish" { word.trim_start_matches('-') } else { word };
            assert!(stdout(&out).contains(word), "{shell}: {word}");
        }
    }
    expect_code(&hrdsl(["completions", "cmd"]), 2);
}

/// The commands, as their manual pages name them.
fn commands() -> Vec<(String, String)> {
    let folder = tempfile::tempdir().unwrap();
    let out = hrdsl_in(folder.path(), "man --dir pages/man1");
    expect_code(&out, 0);
    let pages = tree(&folder.path().join("pages/man1"));
    assert_eq!(stdout(&out).lines().count(), pages.len());
    let page = |(name, text): (String, Vec<u8>)| {
        let name =
            name.strip_suffix(".1").unwrap().trim_start_matches("hrdsl").trim_start_matches('-').to_owned();
        (name, String::from_utf8(text).unwrap())
    };
    pages.into_iter().map(page).collect()
}

#[test]
fn every_command_has_a_manual_page_with_examples() {
    let commands = commands();
    assert!(commands.len() >= 9, "{commands:?}");
    for (name, page) in &commands {
        assert!(page.contains(".TH hrdsl"), "{name}");
        let wanted = if name.is_empty() { "Exit codes:" } else { "Examples:" };
        assert!(page.contains(wanted), "{name} has no {wanted}");
    }
    let own = commands.iter().find(|(name, _)| name.is_empty()).unwrap();
    assert_eq!(stdout(&hrdsl(["man"])), own.1);
}

/// A document that could lie is a test: every command and option is on the page of the command line, and every exit code.
#[test]
fn the_specification_names_every_command_and_option() {
    let page = fs::read_to_string(root().join("spec/cli.md")).unwrap();
    for (name, _) in commands().iter().filter(|(name, _)| !name.is_empty()) {
        let start = page.find(&format!("\n## {name}\n")).unwrap_or_else(|| panic!("no heading for {name}"));
        let section = page[start + 1..].split("\n## ").next().unwrap();
        let help = stdout(&hrdsl([name, "--help"]));
        let words = help.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-'));
        let options = words.filter(|w| {
            w.starts_with("--") && w.len() > 2 && !["--help", "--color", "--allow-path"].contains(w)
        });
        for option in options {
            assert!(section.contains(option), "{name}: {option} is not described");
        }
    }
    assert!(page.contains("`--color") && page.contains("`--allow-path"));
    let help = stdout(&hrdsl(["--help"]));
    for code in 0..=3 {
        assert!(
            help.contains(&format!("\n  {code}  ")) && page.contains(&format!("\n| {code} | ")),
            "{code}"
        );
    }
}

// ── new ──

#[test]
fn a_new_project_checks_generates_and_runs() {
    let folder = tempfile::tempdir().unwrap();
    let out = hrdsl_in(folder.path(), "new greeter --dir robots");
    expect_code(&out, 0);
    let here = folder.path().join("robots/greeter");
    let files: Vec<String> = tree(&here).into_keys().collect();
    assert_eq!(files, [".gitignore", "README.md", "robot.py", "scenario.hri"]);

    let out = hrdsl_in(&here, "check --deny warnings .");
    expect_code(&out, 0);
    assert!(stdout(&out).starts_with("scenario.hri: scenario `greeter` is well formed"), "{}", stdout(&out));
    expect_code(&hrdsl_in(&here, "fmt --check ."), 0);

    let out = hrdsl_in(&here, "gen scenario.hri");
    expect_code(&out, 0);
    assert!(
        stdout(&out).contains(" 0 unreachable, 0 inconclusive"),
        "every goal is reached: {}",
        stdout(&out)
    );
    assert_eq!(tree(&here.join("hrdsl-tests")).len(), 4);
    expect_code(&hrdsl_in(&here, "check . --deny warnings"), 0);

    let out = hrdsl_in(&here, "sim scenario.hri -n 6");
    expect_code(&out, 0);
    let results = fs::read(here.join("hrdsl-out/greeter/results.json")).unwrap();
    let results: Value = serde_json::from_slice(&results).unwrap();
    let tests = results["tests"].as_array().unwrap();
    assert_eq!(tests.len(), 18);
    let verdicts = tests.iter().flat_map(|t| t["verdicts"].as_array().unwrap());
    assert!(
        verdicts.filter(|v| v["outcome"] == "pass").count() >= 18,
        "the requirements are put to the test"
    );
    // What git is to ignore is what hrdsl and Python make.
    let ignored = fs::read_to_string(here.join(".gitignore")).unwrap();
    assert!(ignored.contains("hrdsl-out/") && ignored.contains("hrdsl-tests/"));
}

#[test]
fn nothing_is_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let robot = folder.path().join("mine/robot.py");
    fs::create_dir(folder.path().join("mine")).unwrap();
    fs::write(&robot, "mine").unwrap();
    let out = hrdsl_in(folder.path(), "new mine");
    expect_code(&out, 2);
    assert!(stderr(&out).contains("mine/robot.py is there already"), "{}", stderr(&out));
    assert_eq!(tree(folder.path()).len(), 1, "nothing is written at all");
    fs::remove_file(&robot).unwrap();
    expect_code(&hrdsl_in(folder.path(), "new mine"), 0);
}

#[test]
fn names_that_are_no_names_are_refused_with_a_reason() {
    let folder = tempfile::tempdir().unwrap();
    for (name, reason) in [("or", "keyword"), ("my-robot", "`my_robot` is one"), ("../x", "no name")] {
        let out = hrdsl_in(folder.path(), &format!("new {name}"));
        expect_code(&out, 2);
        assert!(stderr(&out).contains(reason), "{}", stderr(&out));
    }
    assert!(tree(folder.path()).is_empty());
}
