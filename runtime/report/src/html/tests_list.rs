//! Every test with its verdicts, its origin and its steps.

use hrdsl_results::{BinName, CampaignResults, RunEnd, TestResult, VerdictOutcome as Outcome, VerdictResult};
use serde::Serialize;

use super::{
    replays::{PageReplays, ReplayButton, buttons},
    violations::{CounterexampleTimeline, counterexample},
};
use crate::{
    facts::{self, ShownOutcome},
    text,
};

/// More requirements than this have no column each.
const COLUMNS: usize = 12;

#[derive(Serialize)]
pub struct TestList {
    suites: Vec<String>,
    requirements: Vec<String>,
    has_columns: bool,
    tests: Vec<TestEntry>,
}

#[derive(Serialize)]
struct TestEntry {
    place: usize,
    class: char,
    symbol: &'static str,
    /// In words, for those who do not see the symbols.
    says: String,
    name: String,
    full_name: String,
    suite: usize,
    suite_name: String,
    method: &'static str,
    seed: u64,
    ended: &'static str,
    duration: String,
    /// One letter for each requirement.
    letters: String,
    marks: Vec<OutcomeMark>,
    error: String,
    failures: Vec<FailedVerdict>,
    others: Vec<OutcomeGroup>,
    because: Vec<String>,
    bins: Vec<TestBin>,
    bins_hit: usize,
    coverage: String,
    steps: Vec<String>,
    /// The command that runs it again; empty unless something is wrong.
    again: String,
    /// The command that makes a page that replays it; empty unless something is wrong.
    view: String,
    /// What opens its replays on this page.
    replays: Vec<ReplayButton>,
    /// What must be known to trust it.
    notes: Vec<String>,
    /// What its programs have logged, as counts of levels; empty if they have not.
    log: String,
    /// The first that warn, in lines; and how many more there were.
    logged: Vec<String>,
    more_logged: u64,
    /// The last lines that the program complained.
    stderr: String,
    /// Where its output is; empty if there was none.
    output: String,
}

#[derive(Serialize)]
struct OutcomeMark {
    class: char,
    symbol: &'static str,
}

#[derive(Serialize)]
struct FailedVerdict {
    requirement: String,
    title: String,
    counterexample: Option<CounterexampleTimeline>,
}

/// The requirements with one outcome.
#[derive(Serialize)]
struct OutcomeGroup {
    class: char,
    symbol: &'static str,
    word: &'static str,
    verdicts: Vec<String>,
}

#[derive(Serialize)]
struct TestBin {
    class: char,
    symbol: &'static str,
    name: String,
    word: &'static str,
}

/// All tests.
pub fn list(results: &CampaignResults, replays: Option<&PageReplays<'_>>) -> TestList {
    TestList {
        suites: results.suites.iter().map(|s| s.name.to_string()).collect(),
        requirements: results.requirements.iter().map(|r| r.name.to_string()).collect(),
        has_columns: results.requirements.len() <= COLUMNS,
        tests: results.tests.iter().enumerate().map(|(i, t)| test(results, replays, (i, t))).collect(),
    }
}

/// What a test did to a requirement; nothing, if it says nothing.
fn outcome(test: &TestResult, requirement: &str) -> Outcome {
    test.judgement
        .verdicts
        .iter()
        .find(|v| v.requirement == *requirement)
        .map_or(Outcome::Vacuous, |v| v.outcome)
}

fn test(
    results: &CampaignResults,
    replays: Option<&PageReplays<'_>>,
    (index, test): (usize, &TestResult),
) -> TestEntry {
    let suite = results.suites.iter().position(|s| s.name == test.suite);
    let outcomes: Vec<Outcome> = results.requirements.iter().map(|r| outcome(test, &r.name)).collect();
    let overall = overall(test, &outcomes);
    TestEntry {
        place: index + 1,
        class: overall.letter(),
        symbol: overall.symbol(),
        says: says(results, test, &outcomes),
        name: facts::short(results, &test.name).to_owned(),
        full_name: test.name.to_string(),
        suite: suite.unwrap_or(results.suites.len()),
        suite_name: test.suite.to_string(),
        method: test.method.word(),
        seed: test.seed,
        ended: match test.ended {
            RunEnd::Quiescent => "when nothing more could happen",
            RunEnd::Limit => "at the time limit",
            RunEnd::Error => "in error",
        },
        duration: text::stretch(test.duration),
        letters: outcomes.iter().map(|o| o.letter()).collect(),
        marks: outcomes.iter().map(|o| OutcomeMark { class: o.letter(), symbol: o.symbol() }).collect(),
        error: test.error.as_deref().map(|e| text::ends(&text::clean(e))).unwrap_or_default(),
        failures: test
            .judgement
            .verdicts
            .iter()
            .filter(|v| v.outcome == Outcome::Fail)
            .map(|v| failed(results, v))
            .collect(),
        others: groups(test),
        because: test.because.clone(),
        bins: bins(test),
        bins_hit: test.judgement.bins.len(),
        coverage: if test.code.lines_total > 0 {
            format!("{:.1} %", test.code.line_percent())
        } else {
            String::new()
        },
        steps: test.steps.clone(),
        again: results
            .rerun_of(test)
            .filter(|_| test.error.is_some() || test.has_failed())
            .unwrap_or_default(),
        view: results.view_of(test).filter(|_| test.error.is_some() || test.has_failed()).unwrap_or_default(),
        replays: buttons(results, replays, &test.name),
        notes: facts::notes(test),
        log: test.log.in_short(),
        logged: test.log.first.iter().map(|logged| text::line(&logged.line())).collect(),
        more_logged: test.log.warnings().saturating_sub(test.log.first.len() as u64),
        stderr: text::clean(&test.output.stderr_end),
        output: if test.output.stdout_bytes + test.output.stderr_bytes > 0 {
            format!("output/{}.txt", test.name.file_stem())
        } else {
            String::new()
        },
    }
}

fn overall(test: &TestResult, outcomes: &[Outcome]) -> Outcome {
    if test.error.is_some() {
        Outcome::Error
    } else {
        let worst = [Outcome::Fail, Outcome::Error, Outcome::Pass, Outcome::Inconclusive];
        worst.into_iter().find(|o| outcomes.contains(o)).unwrap_or(Outcome::Vacuous)
    }
}

fn says(results: &CampaignResults, test: &TestResult, outcomes: &[Outcome]) -> String {
    let named = |outcome: Outcome| -> Vec<String> {
        let such = results.requirements.iter().zip(outcomes).filter(|(_, o)| **o == outcome);
        such.map(|(r, _)| r.name.to_string()).collect()
    };
    let mut says = Vec::new();
    if test.error.is_some() {
        says.push("broke off".to_owned());
    }
    for outcome in [Outcome::Fail, Outcome::Pass, Outcome::Inconclusive] {
        let names = named(outcome);
        if !names.is_empty() {
            says.push(format!("{}: {}", outcome.word(), names.join(" ")));
        }
    }
    says.join("; ")
}

fn failed(results: &CampaignResults, verdict: &VerdictResult) -> FailedVerdict {
    let requirement = results.requirements.iter().find(|r| r.name == verdict.requirement);
    FailedVerdict {
        requirement: verdict.requirement.to_string(),
        title: requirement.map(|r| r.title.clone()).unwrap_or_default(),
        counterexample: verdict.failure.as_ref().map(|failure| counterexample(verdict, failure)),
    }
}

fn groups(test: &TestResult) -> Vec<OutcomeGroup> {
    let group = |outcome: Outcome| {
        let such = test.judgement.verdicts.iter().filter(|v| v.outcome == outcome);
        let verdicts: Vec<String> = such.map(|v| in_words(v, outcome)).collect();
        let group = OutcomeGroup {
            class: outcome.letter(),
            symbol: outcome.symbol(),
            word: outcome.word(),
            verdicts,
        };
        (!group.verdicts.is_empty()).then_some(group)
    };
    [Outcome::Pass, Outcome::Inconclusive, Outcome::Vacuous, Outcome::Error]
        .into_iter()
        .filter_map(group)
        .collect()
}

/// `R6 3×, margin +0.0312 rad/s`
fn in_words(verdict: &VerdictResult, outcome: Outcome) -> String {
    let mut text = verdict.requirement.to_string();
    if outcome == Outcome::Pass || outcome == Outcome::Inconclusive {
        text += &format!(" {}×", verdict.triggered);
    }
    match &verdict.worst_margin {
        Some((value, unit)) => format!("{text} (margin {})", text::margin(*value, unit)),
        None => text,
    }
}

/// First what was hit, then what was predicted in vain.
fn bins(test: &TestResult) -> Vec<TestBin> {
    let bin = |name: &BinName, outcome: Outcome, word| TestBin {
        class: outcome.letter(),
        symbol: outcome.symbol(),
        name: name.to_string(),
        word,
    };
    let is_guided = !test.predicted.is_empty();
    let hit = test.judgement.bins.iter().map(|name| match (test.predicted.contains(name), is_guided) {
        (true, _) => bin(name, Outcome::Pass, "hit as predicted"),
        (false, true) => bin(name, Outcome::Pass, "hit, not predicted"),
        (false, false) => bin(name, Outcome::Pass, "hit"),
    });
    let missed = test.predicted.iter().filter(|name| !test.judgement.bins.contains(name));
    hit.chain(missed.map(|name| bin(name, Outcome::Vacuous, "predicted, not hit"))).collect()
}
