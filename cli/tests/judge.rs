//! Results read back: `hrdsl report` and `hrdsl judge`, against what `hrdsl sim` wrote.

mod support;

use std::{fs, path::Path};

use serde_json::Value;
use support::{expect_code, folder, handover, hrdsl, hrdsl_in, root, stderr, stdout};

/// The results of a small campaign of the hand-over.
fn campaign(out: &Path, more: &[&str]) -> String {
    let scenario = handover();
    let args = ["sim", scenario.to_str().unwrap(), "-o", out.to_str().unwrap(), "-n", "6", "--exit-zero"];
    let run = hrdsl(args.iter().chain(more));
    expect_code(&run, 0);
    stdout(&run)
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// The text of each test from its verdicts to the end of its bins, by the test's name.
fn judgements(document: &str) -> Vec<(String, &str)> {
    let (_, tests) = document.split_once("\n  \"tests\": [").unwrap();
    let test = |text: &'_ str| {
        let name = text.split('"').nth(3).unwrap().to_owned();
        let from = document.len() - tests.len() + (text.as_ptr() as usize - tests.as_ptr() as usize);
        let text = &document[from..from + text.len()];
        let from = text.find("\n      \"verdicts\": [").unwrap();
        let bins = from + text[from..].find("\n      \"bins\": [").unwrap();
        let line = bins + 1 + text[bins + 1..].find('\n').unwrap();
        let is_empty = text[bins..line].trim_end_matches(',').ends_with("[]");
        let to = if is_empty { line } else { bins + text[bins..].find("\n      ]").unwrap() + 8 };
        (name, text[from..to].trim_end_matches(','))
    };
    let mut all: Vec<(String, &str)> = tests.split("\n    {").skip(1).map(test).collect();
    all.sort();
    all
}

#[test]
fn recordings_have_the_verdicts_failures_and_bins_of_their_runs() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    campaign(&out, &[]);
    let results = fs::read_to_string(out.join("results.json")).unwrap();
    let scenario = handover();
    let judged = hrdsl(["judge", scenario.to_str().unwrap(), out.to_str().unwrap(), "--json"]);
    expect_code(&judged, 3);
    let judged = stdout(&judged);
    let (before, after) = (judgements(&results), judgements(&judged));
    assert_eq!(before.len(), 18);
    assert_eq!(before, after, "byte for byte");
    assert!(before.iter().any(|(_, text)| text.contains("\"counterexample\": [\n")));
    let (results, judged) = (json(&results), json(&judged));
    for key in ["name", "seed", "ended", "error", "duration"] {
        let of = |document: &Value| {
            let mut all: Vec<String> =
                document["tests"].as_array().unwrap().iter().map(|t| t[key].to_string()).collect();
            all.sort();
            all
        };
        assert_eq!(of(&results), of(&judged), "{key}");
    }
    let sum = |numbers: &Value| numbers.as_array().unwrap().iter().map(|n| n.as_u64().unwrap()).sum::<u64>();
    for (bin, again) in results["bins"].as_array().unwrap().iter().zip(judged["bins"].as_array().unwrap()) {
        assert_eq!(
            (&bin["name"], sum(&bin["hits"]), &bin["first"]),
            (&again["name"], sum(&again["hits"]), &again["first"])
        );
    }
}

#[test]
fn runs_that_broke_off_are_judged_as_such() {
    let program =
        "import hrdsl\nn = hrdsl.Node('robot')\nn.emit('timed_out')\nn.sleep(3)\nraise SystemExit(3)\n";
    let text = fs::read_to_string(handover()).unwrap();
    let folder = folder(&[("robot.py", program), ("scenario.hri", &text)]);
    let run = hrdsl_in(folder.path(), "sim scenario.hri --suite random_tests -n 2 -o out");
    expect_code(&run, 3);
    let judged = hrdsl_in(folder.path(), "judge scenario.hri out --json");
    expect_code(&judged, 3);
    let results = fs::read_to_string(folder.path().join("out/results.json")).unwrap();
    assert_eq!(judgements(&results), judgements(&stdout(&judged)));
    let tests = json(&stdout(&judged));
    assert_eq!(tests["tests"][0]["ended"], "error");
    assert_eq!(tests["tests"][0]["error"], json(&results)["tests"][0]["error"]);
    assert!(tests["tests"][0]["verdicts"].as_array().unwrap().iter().all(|v| v["outcome"] == "error"));
    expect_code(&hrdsl_in(folder.path(), "judge scenario.hri out --exit-zero"), 0);
}

#[test]
fn reports_are_made_again_byte_for_byte() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let printed = campaign(&out, &["--suite", "bdi_tests", "--suite", "ta_tests"]);
    let reports = ["report.html", "junit.xml"];
    let before = reports.map(|name| fs::read(out.join(name)).unwrap());
    for name in reports {
        fs::remove_file(out.join(name)).unwrap();
    }
    let again = hrdsl(["report", out.to_str().unwrap()]);
    expect_code(&again, 0);
    assert!(before == reports.map(|name| fs::read(out.join(name)).unwrap()));
    let (summary, _) =
        stdout(&again).rsplit_once("report: ").map(|(a, b)| (a.to_owned(), b.to_owned())).unwrap();
    assert!(summary.starts_with("handover   seed 0") && printed.contains(&summary), "{summary}");
    for (name, which) in reports.iter().zip(["html", "junit"]) {
        let file = out.join("results.json");
        let printed = hrdsl(["report", file.to_str().unwrap(), "--print", which]);
        assert!(printed.stdout == fs::read(out.join(name)).unwrap(), "{name}");
    }
    // Results are read to their end, even where a scenario may not be so long.
    let mut long = fs::read(out.join("results.json")).unwrap();
    long.resize(long.len() + (65 << 20), b' ');
    let last = long.len() - 1;
    long[last] = b'\n';
    fs::write(folder.path().join("long.json"), &long).unwrap();
    let printed = hrdsl(["report", folder.path().join("long.json").to_str().unwrap(), "--print", "junit"]);
    assert!(printed.stdout == fs::read(out.join("junit.xml")).unwrap());
    // One byte more behind the end, and it is said: nothing is left unread.
    long[last] = b'}';
    fs::write(folder.path().join("long.json"), &long).unwrap();
    expect_code(&hrdsl(["report", folder.path().join("long.json").to_str().unwrap()]), 2);
    let elsewhere = folder.path().join("public");
    expect_code(&hrdsl(["report", out.to_str().unwrap(), "-o", elsewhere.to_str().unwrap()]), 0);
    assert!(before == reports.map(|name| fs::read(elsewhere.join(name)).unwrap()));
}

#[test]
fn results_are_what_their_schema_says() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    campaign(&out, &[]);
    let printed = stdout(&hrdsl(["report", "--schema"]));
    let path = root().join("spec/results.schema.json");
    if std::env::var_os("HRDSL_UPDATE").is_some() {
        fs::write(&path, &printed).unwrap();
    }
    assert_eq!(printed, fs::read_to_string(path).unwrap(), "update with HRDSL_UPDATE=1");
    let schema = jsonschema::validator_for(&json(&printed)).unwrap();
    let mut results = json(&fs::read_to_string(out.join("results.json")).unwrap());
    let faults: Vec<String> = schema.iter_errors(&results).map(|e| e.to_string()).collect();
    assert_eq!(faults, Vec::<String>::new());
    results["tests"][0]["ended"] = "well".into();
    assert!(!schema.is_valid(&results));
}

#[test]
fn what_is_no_results_is_refused_with_a_reason() {
    let folder = folder(&[
        ("out/results.json", "{\"format\":\"hrdsl-results\",\"version\":9}"),
        ("run.json", "{}"),
        ("text", "a"),
    ]);
    for (what, says) in
        [("out", "version 9"), ("run.json", "`format`"), ("text", "not the results"), ("none", "none")]
    {
        let out = hrdsl_in(folder.path(), &format!("report {what}"));
        expect_code(&out, 2);
        assert!(stderr(&out).contains(says), "{what}: {}", stderr(&out));
    }
    fs::write(folder.path().join("out/report.html"), "mine").unwrap();
    let results = tempfile::tempdir().unwrap();
    campaign(results.path(), &["--suite", "ta_tests"]);
    fs::copy(results.path().join("results.json"), folder.path().join("out/results.json")).unwrap();
    let out = hrdsl_in(folder.path(), "report out");
    expect_code(&out, 2);
    assert!(stderr(&out).contains("report.html was not written by hrdsl"), "{}", stderr(&out));
    assert_eq!(fs::read_to_string(folder.path().join("out/report.html")).unwrap(), "mine");
}

const SCENARIO: &str = "scenario s

actor guest : environment
actor robot : system

event called(loud: bool) from guest to robot
event came from robot to guest

require R1 functional \"whoever calls is answered\" called(_) causes came within 5 s
";

#[test]
fn recordings_of_another_scenario_are_refused_and_the_others_judged() {
    let header =
        |scenario: &str| format!("{{\"hrdsl\":\"trace\",\"version\":1,\"scenario\":\"{scenario}\"}}\n");
    let call = "{\"t\":1,\"event\":\"called\",\"args\":{\"loud\":true}}\n";
    let recording = |scenario: &str, end: &str| format!("{}{call}{end}\n", header(scenario));
    let folder = folder(&[
        ("s.hri", SCENARIO),
        ("logs/late.jsonl", &recording("s", "{\"end\":9}")),
        ("logs/open.jsonl", &recording("s", "{\"end\":3}")),
        ("logs/other.jsonl", &recording("other", "{\"end\":9}")),
        ("logs/cut.jsonl", &recording("s", "")),
        (
            "logs/changed.jsonl",
            &recording("s", "{\"end\":3}").replace("\"s\"", "\"s\",\"vocabulary\":\"0000000000000000\""),
        ),
    ]);
    let out = hrdsl_in(folder.path(), "judge s.hri logs --json");
    expect_code(&out, 2);
    let said = stderr(&out);
    for says in [
        "logs/other.jsonl: this is a recording of the scenario `other`, not of `s`",
        "logs/cut.jsonl: line 2: the recording is cut off",
        "logs/changed.jsonl: this is a recording of `s` with other events or signals (vocabulary 0000000000000000",
    ] {
        assert!(said.contains(says), "{says}: {said}");
    }
    let outcomes = |text: &str| -> Vec<String> {
        let tests = json(text)["tests"].as_array().unwrap().clone();
        tests.iter().map(|t| format!("{} {}", t["name"], t["verdicts"][0]["outcome"])).collect()
    };
    assert_eq!(outcomes(&stdout(&out)), ["\"late\" \"fail\"", "\"open\" \"inconclusive\""]);
    let out = hrdsl_in(folder.path(), "judge s.hri logs/changed.jsonl logs/other.jsonl --changed --json");
    expect_code(&out, 3);
    assert_eq!(outcomes(&stdout(&out)), ["\"changed\" \"inconclusive\"", "\"other\" \"fail\""]);
    let out = hrdsl_in(folder.path(), "judge s.hri logs/late.jsonl");
    expect_code(&out, 3);
    assert!(
        stdout(&out).contains("✗ R1") && stdout(&out).contains("nothing within 5.00 s"),
        "{}",
        stdout(&out)
    );
    expect_code(&hrdsl_in(folder.path(), "judge s.hri s.hri"), 2);
    // A run that broke off counts as such, even if nobody says why.
    let broken = recording("s", "{\"end\":3,\"ended\":\"error\"}");
    fs::write(folder.path().join("broken.jsonl"), broken).unwrap();
    let out = hrdsl_in(folder.path(), "judge s.hri broken.jsonl");
    expect_code(&out, 3);
    assert!(stdout(&out).contains("1 recording, 0 with violations, 1 error,"), "{}", stdout(&out));
}
