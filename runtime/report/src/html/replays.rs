//! Replays on the page: each run lies packed in it, and the viewer, too, until somebody opens one.

use hrdsl_results::{
    CampaignResults, ReplayPair, RequirementName, RunEnd, ShownReplays, ShownRun, TestName, VerdictResult,
};
use minijinja::Value;
use serde::Serialize;

use crate::{facts, text};

/// What is replayed on a page, and by which viewer.
#[derive(Clone, Copy, Debug)]
pub struct PageReplays<'a> {
    pub shown: &'a ShownReplays,
    /// The viewer's page without title and data, packed as its crate does it.
    pub viewer: &'a str,
}

/// The parts of the page that are there for replays.
#[derive(Serialize)]
pub struct ReplaySection {
    style: Value,
    script: Value,
    /// JSON in which nothing ends an element.
    index: Value,
    viewer: Value,
    assets: Value,
    runs: Vec<Value>,
    /// Tests that should be here, with the reason why they are not.
    left_out: Vec<(String, String)>,
}

/// What the script is told of the runs.
#[derive(Serialize)]
struct ReplayIndex {
    scenario: String,
    pairs: Vec<IndexedPair>,
    runs: Vec<IndexedReplay>,
}

#[derive(Serialize)]
struct IndexedPair {
    requirement: String,
    test: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    beside: Option<String>,
}

/// A run as the viewer's index has it.
#[derive(Serialize)]
struct IndexedReplay {
    id: String,
    ended: &'static str,
    verdicts: Vec<(String, &'static str)>,
}

/// A button that opens a replay.
#[derive(Serialize)]
pub struct ReplayButton {
    /// The place of its pair, from 1.
    place: usize,
    requirement: String,
    /// The passing test beside it; empty if there is none.
    beside: String,
}

/// The parts of the page that are there for replays; `None` if there are none.
pub fn section(results: &CampaignResults, replays: Option<&PageReplays<'_>>) -> Option<ReplaySection> {
    let PageReplays { shown, viewer } = replays?;
    let short = |name: &TestName| facts::short(results, name).to_owned();
    let left_out = shown.left_out.iter().map(|left| (short(&left.test), left.why.clone())).collect();
    let script = include_str!("replays.js");
    Some(ReplaySection {
        style: Value::from_safe_string(include_str!("replays.css").to_owned()),
        script: Value::from_safe_string(script.to_owned()),
        index: Value::from_safe_string(index(results, shown)),
        viewer: packed(viewer),
        assets: packed(&shown.assets),
        runs: shown.runs.iter().map(|run| packed(&run.data)).collect(),
        left_out,
    })
}

/// Base64 as it is; what is something else, such as in a file that somebody has changed, does not get into the page.
fn packed(text: &str) -> Value {
    let is_base64 = text.bytes().all(|b| b.is_ascii_alphanumeric() || matches!(b, b'+' | b'/' | b'='));
    Value::from_safe_string(if is_base64 { text.to_owned() } else { String::new() })
}

fn index(results: &CampaignResults, shown: &ShownReplays) -> String {
    let short = |name: &TestName| text::clean(facts::short(results, name));
    let pair = |pair: &ReplayPair| IndexedPair {
        requirement: text::clean(&pair.requirement),
        test: short(&pair.test),
        beside: pair.beside.as_ref().map(short),
    };
    let verdict = |v: &VerdictResult| (text::clean(&v.requirement), v.outcome.name());
    let run = |run: &ShownRun| {
        let test = results.tests.iter().find(|test| test.name == run.test);
        IndexedReplay {
            id: short(&run.test),
            ended: test.map_or(RunEnd::Error, |test| test.ended).word(),
            verdicts: test
                .map_or_else(Vec::new, |test| test.judgement.verdicts.iter().map(verdict).collect()),
        }
    };
    let index = ReplayIndex {
        scenario: text::clean(&results.scenario),
        pairs: shown.pairs.iter().map(pair).collect(),
        runs: shown.runs.iter().map(run).collect(),
    };
    serde_json::to_string(&index).unwrap_or_default().replace('<', "\\u003c")
}

/// The button of a test for a requirement.
pub fn button(
    results: &CampaignResults,
    replays: Option<&PageReplays<'_>>,
    (test, requirement): (&TestName, &RequirementName),
) -> Option<ReplayButton> {
    let pairs = &replays?.shown.pairs;
    let place = pairs.iter().position(|pair| pair.test == *test && pair.requirement == *requirement)?;
    let pair = pairs.get(place)?;
    let beside = pair.beside.as_ref().map(|beside| facts::short(results, beside).to_owned());
    Some(ReplayButton {
        place: place + 1,
        requirement: requirement.to_string(),
        beside: beside.unwrap_or_default(),
    })
}

/// All buttons of a test.
pub fn buttons(
    results: &CampaignResults,
    replays: Option<&PageReplays<'_>>,
    test: &TestName,
) -> Vec<ReplayButton> {
    results.requirements.iter().filter_map(|r| button(results, replays, (test, &r.name))).collect()
}
