//! The networks of the examples in TChecker's format: read again, they give the same answers to the same goals.

mod support;

use std::{collections::BTreeMap, fs, path::Path};

use support::{command, expect_code, hrdsl_in, root, stderr, stdout};

/// Copies a folder with all that its scenario uses.
fn copied(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let there = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copied(&path, &there);
        } else {
            fs::copy(&path, there).unwrap();
        }
    }
}

/// A location in the scenario, and in what came back: `A.l` in both.
struct ReturnedLocation {
    automaton: String,
    there: String,
    back: String,
}

/// The locations that the scenario names, by the labels of the file and the queries that the import makes of them.
fn locations(texts: &str, exported: &str, back: &str) -> Vec<ReturnedLocation> {
    let asked = back.lines().filter_map(|line| line.strip_prefix("query label_"));
    let asked: BTreeMap<&str, &str> = asked
        .filter_map(|line| {
            let label = line.split('"').nth(1)?;
            Some((label, line.split("E<> ").nth(1)?.trim()))
        })
        .collect();
    let mut all = Vec::new();
    for line in exported.lines().filter_map(|line| line.strip_prefix("location:")) {
        let (automaton, rest) = line.split_once(':').unwrap();
        let name = rest.split('{').next().unwrap();
        let label = line.split("labels: ").nth(1).unwrap().trim_end_matches('}');
        let word = format!("location {name}");
        let said =
            |at: usize| !texts[at + word.len()..].starts_with(|c: char| c.is_alphanumeric() || c == '_');
        // The others stand between the parts of one edge.
        if texts.match_indices(&word).any(|(at, _)| said(at)) {
            let there = format!("{automaton}.{name}");
            all.push(ReturnedLocation {
                automaton: automaton.to_owned(),
                there,
                back: asked[label].to_owned(),
            });
        }
    }
    all
}

/// The verdicts of these queries, in their order; nothing else is asked.
fn verdicts(folder: &Path, file: &str, network: &str, asked: &[String]) -> Vec<bool> {
    let mut command = command();
    command.current_dir(folder).args(["prove", file, "--json", "--network", network]);
    asked.iter().for_each(|query| {
        command.args(["--ask", query]);
    });
    let out = command.output().unwrap();
    let document: serde_json::Value = serde_json::from_str(&stdout(&out))
        .unwrap_or_else(|e| panic!("{e}: {}{}", stdout(&out), stderr(&out)));
    let queries = document["networks"][0]["queries"].as_array().unwrap();
    let verdict = |q: &serde_json::Value| match q["verdict"].as_str() {
        Some("satisfied") => true,
        Some("not_satisfied") => false,
        other => panic!("{other:?}: {q}"),
    };
    queries.iter().map(verdict).collect()
}

/// Exports, imports, and asks both of the pairs of locations of these automata, and of what else is said: there, and back.
fn same_answers(example: &str, network: &str, pairs: impl Fn(&str) -> bool, more: &[(&str, &str)]) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    copied(&root().join("examples").join(example), path);
    expect_code(&hrdsl_in(path, &format!("export tchecker scenario.hri --network {network} -o out.txt")), 0);
    expect_code(&hrdsl_in(path, "import tchecker out.txt -o back.hri"), 0);
    let read = |name: &str| fs::read_to_string(path.join(name)).unwrap();
    let texts: String = fs::read_dir(path)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "hri") && !p.ends_with("back.hri"))
        .map(|p| fs::read_to_string(p).unwrap())
        .collect();
    let mut all = locations(&texts, &read("out.txt"), &read("back.hri"));
    all.retain(|l| pairs(&l.automaton));
    let mut asked = (Vec::new(), Vec::new());
    for (n, a) in all.iter().enumerate() {
        for b in all[n + 1..].iter().filter(|b| b.automaton != a.automaton) {
            asked.0.push(format!("E<> {} && {}", a.there, b.there));
            asked.1.push(format!("E<> {} && {}", a.back, b.back));
        }
    }
    for (there, back) in more {
        asked.0.push(format!("E<> {there}"));
        asked.1.push(format!("E<> {back}"));
    }
    let back = read("back.hri");
    let renamed = back.split("\nnetwork ").nth(1).and_then(|rest| rest.split_whitespace().next()).unwrap();
    let there = verdicts(path, "scenario.hri", network, &asked.0);
    let back = verdicts(path, "back.hri", renamed, &asked.1);
    assert_eq!(there.len(), asked.0.len());
    let differ: Vec<_> = (0..there.len()).filter(|n| there[*n] != back[*n]).map(|n| &asked.0[n]).collect();
    assert!(differ.is_empty(), "{example}: {differ:?}");
    assert!(there.contains(&true) && there.contains(&false), "{example}: goals of one kind tell nothing");
}

#[test]
fn the_corridor_keeps_its_answers() {
    same_answers("corridor", "meeting", |_| true, &[("Robot.piece == 4", "Robot_piece == 4")]);
}

/// The robot hears of cancelled calls under a guard, and has committed locations.
#[test]
fn the_delivery_keeps_its_answers() {
    let more = [
        ("Clerks_.left == 0 && Robot.back", "Clerks__left == 0 && Robot_back == 1"),
        ("Robot.told && Robot.back", "Robot.told && Robot_back == 1"),
        (
            "Robot.drives && not Robot.free && Robot.x > 20 s",
            "Robot.drives_ && Robot_free == 0 && Robot.Robot_x > 20 s",
        ),
        ("Robot.held && Robot.back && Robot.x > 2 s", "Robot.held && Robot_back == 1 && Robot.Robot_x > 2 s"),
    ];
    same_answers("delivery", "corridor", |_| true, &more);
}

/// So do the sensors and the robot; some of the guards are over clocks.
#[test]
fn the_handover_keeps_its_answers() {
    let more = [
        ("heard == 4", "heard == 4"),
        ("heard == 2 && busy && untidy == 1", "heard == 2 && busy == 1 && untidy == 1"),
        ("Robot.listen && busy", "Robot.listen && busy == 1"),
        ("Robot.legs == 4 && Person.left > 0", "Robot_legs == 4 && Person_left > 0"),
        ("Robot.done && Robot.legs < 4 && untidy == 0", "Robot.done && Robot_legs < 4 && untidy == 0"),
    ];
    same_answers("handover", "table", |_| true, &more);
}

/// Some values belong to two enumerations. All pairs would take minutes: these are goals of which each tells something.
#[test]
fn home_care_keeps_its_answers() {
    let same = [
        "Robot.blocked && Sensors_.free",
        "Robot.placing && Sensors_.taste",
        "Robot.off && Sensors_.taste",
        "Robot.driving && Sensors_.close",
        "Robot.ready && Dog_.beside",
    ];
    let values = [
        ("Person_.left == 0 && Robot.ready", "Person__left == 0 && Robot.ready"),
        ("Robot.blocked && Robot.goal == fridge", "Robot.blocked && Robot_goal == 1"),
        ("Robot.blocked && Robot.goal == table", "Robot.blocked && Robot_goal == 3"),
        ("Robot.grabbing && Robot.order == fridge", "Robot.grabbing && Robot_order == 2"),
        ("Robot.order == sink && Robot.goal == sink", "Robot_order == 3 && Robot_goal == 2"),
    ];
    let more: Vec<(&str, &str)> = same.into_iter().map(|goal| (goal, goal)).chain(values).collect();
    same_answers("homecare", "flat", |_| false, &more);
}
