//! The replays in a campaign's report, with the real binary: which recordings are kept, what is on the page, and what is said of the rest.
#![allow(
    clippy::disallowed_methods,
    reason = "tests start a browser, and another process beside the command"
)]

mod support;

use std::{
    fs,
    path::Path,
    process::Stdio,
    time::{Duration, Instant},
};

use serde_json::Value;
use support::{command, expect_code, handover, hrdsl, hrdsl_in, shown_by_chromium, stderr, stdout, tree};

fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

fn names(of: &Value, field: &str) -> Vec<String> {
    let names = of.as_array().unwrap().iter().filter_map(|one| one[field].as_str());
    names.map(str::to_owned).collect()
}

/// How a test fared by a requirement.
fn outcome<'r>(results: &'r Value, test: &str, requirement: &str) -> &'r str {
    let tests = results["tests"].as_array().unwrap();
    let test = tests.iter().find(|t| t["name"] == test).unwrap();
    let verdicts = test["verdicts"].as_array().unwrap();
    verdicts.iter().find(|v| v["requirement"] == requirement).unwrap()["outcome"].as_str().unwrap()
}

#[test]
fn the_report_replays_first_failures_beside_passing_tests() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let scenario = handover();
    let args = ["sim", scenario.to_str().unwrap(), "-o", out.to_str().unwrap(), "-n", "6", "--exit-zero"];
    expect_code(&hrdsl(args), 0);
    let (results, shown) = (json(&out.join("results.json")), json(&out.join("replays/shown.json")));
    each_pair_is_a_failure_beside_a_pass(&results, &shown);
    recordings_are_those_of_failures_and_of_tests_beside_them(&out, &results, &shown);
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.len() <= 8 << 20, "{} bytes", page.len());
    for run in shown["runs"].as_array().unwrap() {
        let data = run["data"].as_str().unwrap();
        assert!(data.len() <= 200 << 10 && page.contains(data), "{}", run["test"]);
    }
    the_report_is_made_again(&out, folder.path(), &page);
    commands_of_the_page_work(&out, &results);
    opened_in_a_browser(&out.join("report.html"), &shown);
}

fn each_pair_is_a_failure_beside_a_pass(results: &Value, shown: &Value) {
    let pairs = shown["pairs"].as_array().unwrap();
    assert!(pairs.len() >= 3, "{shown}");
    assert!(pairs.iter().any(|pair| pair["beside"].is_string()));
    for pair in pairs {
        let requirement = pair["requirement"].as_str().unwrap();
        let of = |test: &Value| outcome(results, test.as_str().unwrap(), requirement);
        assert_eq!(of(&pair["test"]), "fail");
        if pair["beside"].is_string() {
            assert_eq!(of(&pair["beside"]), "pass");
        }
        let suite = format!("handover.{}.", pair["suite"].as_str().unwrap());
        let earlier = names(&results["tests"], "name").into_iter().filter(|name| name.starts_with(&suite));
        let first = earlier.into_iter().find(|name| outcome(results, name, requirement) == "fail");
        assert_eq!(first.as_deref(), pair["test"].as_str(), "the first failure of the suite");
    }
}

fn recordings_are_those_of_failures_and_of_tests_beside_them(out: &Path, results: &Value, shown: &Value) {
    let mut wanted: Vec<String> =
        results["tests"].as_array().unwrap().iter().fold(Vec::new(), |mut all, test| {
            let fails = test["verdicts"].as_array().unwrap().iter().any(|v| v["outcome"] == "fail");
            all.extend(
                (fails || !test["error"].is_null()).then(|| test["name"].as_str().unwrap().to_owned()),
            );
            all
        });
    wanted.extend(names(&shown["pairs"], "beside"));
    wanted.sort();
    wanted.dedup();
    let there: Vec<String> = tree(&out.join("replays")).into_keys().collect();
    let there: Vec<&str> = there.iter().filter_map(|name| name.strip_suffix(".mcap")).collect();
    assert_eq!(there, wanted);
    assert!(there.len() < results["tests"].as_array().unwrap().len(), "others are not kept");
}

fn the_report_is_made_again(out: &Path, folder: &Path, page: &str) {
    let report = |more: &str| hrdsl_in(folder, &format!("report out {more}"));
    expect_code(&report("-o elsewhere"), 0);
    assert!(fs::read_to_string(folder.join("elsewhere/report.html")).unwrap() == page, "other bytes");
    assert!(stdout(&report("--print html")) == page, "other bytes");
    // Without the file of replays it is a report without replays; with half of it, too, and that is said.
    let file = out.join("replays/shown.json");
    let text = fs::read_to_string(&file).unwrap();
    fs::write(&file, &text[..text.len() / 2]).unwrap();
    let cut = report("--print html");
    expect_code(&cut, 0);
    assert!(stderr(&cut).contains("the report is without replays: "), "{}", stderr(&cut));
    assert!(!stdout(&cut).contains("data-replay"));
    fs::remove_file(&file).unwrap();
    let none = report("--print html");
    assert!(stdout(&none) == stdout(&cut) && stderr(&none).is_empty());
    fs::write(&file, text).unwrap();
}

/// What the page says to type for a failure that is not on it, makes a page of that failure.
fn commands_of_the_page_work(out: &Path, results: &Value) {
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    let view = results["view"].as_str().unwrap();
    let shown = view.replace('/', "&#x2f;");
    let (_, rest) = page.split_once(&format!("<code>{shown} ")).expect("a command");
    let name = rest.split('<').next().unwrap();
    let words = view.strip_prefix("hrdsl ").unwrap();
    expect_code(&hrdsl_in(out, &format!("{words} {name} -o one.html")), 0);
    let one = fs::read_to_string(out.join("one.html")).unwrap();
    assert!(one.contains(&format!("\"open\":\"{name}\"")));
    fs::remove_file(out.join("one.html")).unwrap();
}

/// A replay inside the report opens in Chromium, if there is one: both runs side by side.
fn opened_in_a_browser(report: &Path, shown: &Value) {
    let pairs = shown["pairs"].as_array().unwrap();
    let place = pairs.iter().position(|pair| pair["beside"].is_string()).unwrap();
    let short =
        |field: &str| pairs[place][field].as_str().unwrap().trim_start_matches("handover.").to_owned();
    let opened = format!("data-opened=\"{} beside {} at ", short("test"), short("beside"));
    let address = format!("file://{}#replay-{}", report.display(), place + 1);
    let Some(dom) = shown_by_chromium(&address, &opened) else {
        eprintln!("no replay of the report is looked at: there is no Chromium");
        return;
    };
    let (_, dialog) = dom.split_once("<dialog id=\"replay\"").expect("the page has a dialog");
    assert!(dialog.contains(&opened), "no {opened} in {}", dialog.chars().take(500).collect::<String>());
}

/// A recording with a picture that cannot be written costs the replay, and nothing else.
#[test]
fn tests_count_without_their_replays() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let scenario = handover();
    let mut sim = command();
    sim.args(["sim", scenario.to_str().unwrap(), "-o", out.to_str().unwrap(), "-n", "2", "--exit-zero"]);
    let running = sim.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // Before the first test is over, a file lies where the folder of recordings belongs.
    let (staging, begun) = (out.join(".hrdsl-partial"), Instant::now());
    while !staging.is_dir() {
        assert!(begun.elapsed() < Duration::from_secs(60), "the campaign does not begin");
        std::thread::sleep(Duration::from_millis(1));
    }
    fs::write(staging.join("replays"), "in the way").unwrap();
    let done = running.wait_with_output().unwrap();
    expect_code(&done, 0);
    let said = stderr(&done);
    assert!(said.contains("cannot be replayed: its recording with a picture cannot be written"), "{said}");
    let results = json(&out.join("results.json"));
    let tests = results["tests"].as_array().unwrap();
    let unreplayed = results["unreplayed"].as_array().unwrap();
    assert_eq!(unreplayed.len(), tests.len());
    assert!(tests.iter().all(|test| test["error"].is_null()), "they count all the same");
    assert!(!unreplayed[0]["why"].as_str().unwrap().contains(folder.path().to_str().unwrap()));
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains(&format!("{} tests cannot be replayed", tests.len())));
    assert!(!page.contains("data-replay") && !page.contains("<code>hrdsl view"));
}
