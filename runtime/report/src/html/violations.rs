//! Violated requirements, each with a few tests that show it and their counterexamples.

use hrdsl_results::{
    CampaignResults, FirstFailure, RequirementResult, SuiteName, TestName, TestResult, VerdictResult,
};
use serde::Serialize;

use super::{
    pieces::TestLink,
    replays::{PageReplays, ReplayButton, button},
};
use crate::{facts, text};

/// Tests that are shown with their counterexample for each requirement, at least; of each suite there is one.
const SHOWN: usize = 3;
/// Steps of a counterexample at its start and at its end; the middle is left out.
const START: usize = 3;
const END: usize = 9;

#[derive(Serialize)]
pub struct ViolatedRequirement {
    name: String,
    kind: &'static str,
    title: String,
    text: String,
    tests: usize,
    /// `random_tests 31, …`
    per_suite: Vec<(String, usize)>,
    shown: Vec<ViolatingTest>,
    others: Vec<TestLink>,
}

/// A test with its first violation.
#[derive(Serialize)]
pub struct ViolatingTest {
    test: TestLink,
    counterexample: Option<CounterexampleTimeline>,
    /// The command that runs the test again.
    again: String,
    /// What opens its replay on this page.
    replay: Option<ReplayButton>,
    /// The command that makes a page that replays it.
    view: String,
}

/// How a verdict came about.
#[derive(Serialize)]
pub struct CounterexampleTimeline {
    how: String,
    time: String,
    margin: String,
    /// Further violations in the same test.
    more: u32,
    points: Vec<TimelinePoint>,
}

/// A point of a counterexample's line of time.
#[derive(Serialize)]
pub struct TimelinePoint {
    /// `gap`: steps left out; `end`: the violation.
    class: &'static str,
    time: String,
    text: String,
    /// Its line in the recording of the test; 0 for none.
    line: usize,
}

/// One for each violated requirement.
pub fn all(
    results: &CampaignResults,
    replays: Option<&PageReplays<'_>>,
    link: &dyn Fn(&TestName) -> TestLink,
) -> Vec<ViolatedRequirement> {
    let of = |requirement: &RequirementResult| {
        let failing = facts::failing(results, requirement);
        (!failing.is_empty()).then(|| violated(results, replays, (requirement, &failing), link))
    };
    results.requirements.iter().filter_map(of).collect()
}

fn violated(
    results: &CampaignResults,
    replays: Option<&PageReplays<'_>>,
    (requirement, failing): (&RequirementResult, &[(usize, &TestResult)]),
    link: &dyn Fn(&TestName) -> TestLink,
) -> ViolatedRequirement {
    let chosen = choose(failing);
    let shown = |(_, test): &(usize, &TestResult)| ViolatingTest {
        test: link(&test.name),
        counterexample: facts::failure(test, &requirement.name)
            .map(|(verdict, failure)| counterexample(verdict, failure)),
        again: results.rerun_of(test).unwrap_or_default(),
        replay: button(results, replays, (&test.name, &requirement.name)),
        view: results.view_of(test).unwrap_or_default(),
    };
    let number = |suite: &SuiteName| failing.iter().filter(|(_, t)| t.suite == *suite).count();
    let others = failing.iter().filter(|(i, _)| chosen.iter().all(|(c, _)| c != i));
    ViolatedRequirement {
        name: requirement.name.to_string(),
        kind: facts::kind(requirement),
        title: requirement.title.clone(),
        text: requirement.text.clone(),
        tests: failing.len(),
        per_suite: results
            .suites
            .iter()
            .map(|s| (s.name.to_string(), number(&s.name)))
            .filter(|(_, n)| *n > 0)
            .collect(),
        others: others.map(|(_, t)| link(&t.name)).collect(),
        shown: chosen.iter().map(shown).collect(),
    }
}

/// The first failing test of each suite, then the next ones, in order: different methods often fail differently.
fn choose<'a>(failing: &[(usize, &'a TestResult)]) -> Vec<(usize, &'a TestResult)> {
    let is_first = |at: usize| failing[..at].iter().all(|(_, t)| t.suite != failing[at].1.suite);
    let (mut chosen, rest): (Vec<usize>, Vec<usize>) = (0..failing.len()).partition(|at| is_first(*at));
    let shown = SHOWN.max(chosen.len());
    chosen.extend(rest);
    chosen.truncate(shown);
    chosen.sort_unstable();
    chosen.into_iter().map(|at| failing[at]).collect()
}

/// The counterexample of a failure as a line of time that ends with the violation.
pub fn counterexample(verdict: &VerdictResult, failure: &FirstFailure) -> CounterexampleTimeline {
    let steps = &failure.counterexample;
    let point = |i: usize| TimelinePoint {
        class: if i + 1 == steps.len() && !failure.deadline { "end" } else { "" },
        time: text::moment(steps[i].time),
        text: steps[i].text.clone(),
        line: steps[i].step + 2,
    };
    let mut points: Vec<TimelinePoint> = if steps.len() <= START + END + 1 {
        (0..steps.len()).map(point).collect()
    } else {
        let left_out = text::count(steps.len() - START - END, "step");
        let gap = TimelinePoint {
            class: "gap",
            time: String::new(),
            text: format!("{left_out} left out"),
            line: 0,
        };
        (0..START).map(point).chain([gap]).chain((steps.len() - END..steps.len()).map(point)).collect()
    };
    if failure.deadline {
        let text = "the deadline passed".to_owned();
        points.push(TimelinePoint { class: "end", time: text::moment(failure.time), text, line: 0 });
    }
    CounterexampleTimeline {
        how: facts::how(failure),
        time: text::moment(failure.time),
        margin: verdict
            .worst_margin
            .as_ref()
            .map(|(value, unit)| text::margin(*value, unit))
            .unwrap_or_default(),
        more: verdict.failures.saturating_sub(1),
        points,
    }
}
