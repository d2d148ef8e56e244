//! Which tests are worth looking at: of each requirement the first that violates it in each suite, and the passing test that is most like it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{CampaignResults, RequirementName, SuiteName, TestName, TestResult, VerdictOutcome};

/// A test that was to be recorded, and of which there is no recording with a picture.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct UnreplayedTest {
    pub test: TestName,
    /// Why it could not be made or written.
    pub why: String,
}

/// A test that violates a requirement, and one beside which it can be looked at.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ReplayPair {
    pub requirement: RequirementName,
    pub suite: SuiteName,
    /// The first test of the suite that violates the requirement.
    pub test: TestName,
    /// The test of the suite that passes the requirement and is most like it; none if no test of the suite does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beside: Option<TestName>,
}

impl CampaignResults {
    /// A pair for each requirement and each suite that violates it: first the first suite of each requirement, then the second ones, and so on.
    ///
    /// The passing test is the one whose steps take the fewest changes to become those of the failing one (numbers aside, so that tests that were
    /// made from the same abstract one are alike); of several, the one with the longest common beginning, numbers included; then the first.
    #[must_use]
    pub fn replay_pairs(&self) -> Vec<ReplayPair> {
        let mut pairs: Vec<(usize, ReplayPair)> = Vec::new();
        for requirement in &self.requirements {
            let mut place = 0;
            for suite in &self.suites {
                let own: Vec<&TestResult> = self.tests.iter().filter(|t| t.suite == suite.name).collect();
                let is = |test: &&&TestResult, outcome| outcome_of(test, &requirement.name) == Some(outcome);
                let Some(failing) = own.iter().find(|test| is(test, VerdictOutcome::Fail)) else { continue };
                let passing =
                    own.iter().filter(|test| is(test, VerdictOutcome::Pass) && test.error.is_none());
                let nearest = passing.min_by_key(|test| distance(failing, test));
                let pair = ReplayPair {
                    requirement: requirement.name.clone(),
                    suite: suite.name.clone(),
                    test: failing.name.clone(),
                    beside: nearest.map(|test| test.name.clone()),
                };
                pairs.push((place, pair));
                place += 1;
            }
        }
        pairs.sort_by_key(|(place, _)| *place);
        pairs.into_iter().map(|(_, pair)| pair).collect()
    }

    /// The command that makes a page of a test, as it is typed in the folder of the results; `None` if its campaign recorded nothing to look at.
    #[must_use]
    pub fn view_of(&self, test: &TestResult) -> Option<String> {
        let is_recorded = !self.view.is_empty() && self.unreplayed.iter().all(|u| u.test != test.name);
        is_recorded.then(|| format!("{} {}", self.view, self.quoted_name(test)))
    }
}

fn outcome_of(test: &TestResult, requirement: &RequirementName) -> Option<VerdictOutcome> {
    test.judgement.verdicts.iter().find(|v| v.requirement == *requirement).map(|v| v.outcome)
}

/// How unlike two tests are: less is nearer.
fn distance(a: &TestResult, b: &TestResult) -> (usize, usize) {
    let forms = |test: &TestResult| test.steps.iter().map(|step| without_numbers(step)).collect::<Vec<_>>();
    let alike = a.steps.iter().zip(&b.steps).take_while(|(a, b)| a == b).count();
    (changes(&forms(a), &forms(b)), a.steps.len() - alike)
}

/// A step with a `#` for each number.
fn without_numbers(step: &str) -> String {
    let mut form = String::with_capacity(step.len());
    let mut before = ' ';
    for c in step.chars() {
        // A digit of a name, such as that of `leg2`, stays.
        let is_number = c.is_ascii_digit() && !before.is_alphabetic() && before != '_';
        let goes_on = form.ends_with('#') && matches!(c, '.' | '0'..='9');
        if !goes_on {
            form.push(if is_number { '#' } else { c });
            before = c;
        }
    }
    form.replace("-#", "#")
}

/// The least number of steps that are put in, left out or replaced (Levenshtein's distance).
fn changes(a: &[String], b: &[String]) -> usize {
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.iter().enumerate() {
        let mut diagonal = i;
        let mut left = i + 1;
        let mut next = Vec::with_capacity(row.len());
        next.push(left);
        for (to, above) in b.iter().zip(row.iter().skip(1)) {
            left = (left + 1).min(above + 1).min(diagonal + usize::from(from != to));
            diagonal = *above;
            next.push(left);
        }
        row = next;
    }
    row.last().copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        CoverageRatios, FORMAT, RequirementKind, RequirementResult, SuiteInfo, TestMethod, TraceJudgement,
        TriggerTotal, VERSION, VerdictResult, VerdictTally,
    };

    fn test(name: &str, outcomes: [VerdictOutcome; 2], steps: &[&str]) -> TestResult {
        let verdict = |(requirement, outcome): (&str, VerdictOutcome)| VerdictResult {
            requirement: requirement.into(),
            outcome,
            triggered: 1,
            failures: 0,
            failure: None,
            worst_margin: None,
            unvalued: None,
        };
        TestResult {
            name: format!("s.{name}").into(),
            suite: name.split('.').next().unwrap().into(),
            judgement: TraceJudgement {
                verdicts: ["R1", "R2"].into_iter().zip(outcomes).map(verdict).collect(),
                ..TraceJudgement::default()
            },
            steps: steps.iter().map(|s| (*s).to_owned()).collect(),
            ..TestResult::default()
        }
    }

    fn results(tests: Vec<TestResult>) -> CampaignResults {
        let requirement = |name: &str| RequirementResult {
            name: name.into(),
            kind: RequirementKind::Safety,
            title: String::new(),
            doc: String::new(),
            text: String::new(),
            tally: vec![VerdictTally::default(); 2],
            failing: Vec::new(),
            triggered: TriggerTotal::default(),
            worst_margin: None,
        };
        let suite = |name: &str| SuiteInfo {
            name: name.into(),
            method: TestMethod::Hand,
            abstract_tests: None,
            tests: 1,
            errors: 0,
            goals: Vec::new(),
            model: None,
            explanation: None,
            notes: Vec::new(),
            code: CoverageRatios::default(),
            code_accumulated: Vec::new(),
            code_per_test: Vec::new(),
        };
        CampaignResults {
            format: FORMAT.into(),
            version: VERSION,
            hrdsl: "0.1.0".into(),
            scenario: "s".into(),
            seed: 0,
            interrupted: false,
            planned: tests.len(),
            rerun: String::new(),
            view: "hrdsl view s.hri --results .".into(),
            unreplayed: Vec::new(),
            requirements: vec![requirement("R1"), requirement("R2")],
            suites: vec![suite("a"), suite("b")],
            bins: Vec::new(),
            code: Vec::new(),
            machines: Vec::new(),
            warnings: Vec::new(),
            tests,
        }
    }

    use VerdictOutcome::{Fail, Pass, Vacuous};

    #[test]
    fn each_requirement_has_its_first_failure_in_each_suite_beside_the_most_similar_pass() {
        let found = results(vec![
            test("a.t001", [Pass, Vacuous], &["ask", "wait"]),
            test("a.t002", [Fail, Fail], &["ask", "reach with dx = 0.5 m", "look", "go"]),
            test("a.t003", [Fail, Vacuous], &["ask"]),
            test("a.t004", [Pass, Vacuous], &["ask", "reach with dx = -0.25 m", "look", "go"]),
            test("a.t005", [Pass, Vacuous], &["ask", "reach with dx = 0.5 m", "look", "go"]),
            test("b.t001", [Fail, Pass], &["go"]),
            test("b.t002", [Fail, Fail], &["go"]),
        ])
        .replay_pairs();
        let shown: Vec<[&str; 4]> = found
            .iter()
            .map(|p| [&*p.requirement, &*p.suite, &*p.test, p.beside.as_ref().map_or("none", |b| b.as_str())])
            .collect();
        assert_eq!(
            shown,
            [
                ["R1", "a", "s.a.t002", "s.a.t005"],
                ["R2", "a", "s.a.t002", "none"],
                ["R1", "b", "s.b.t001", "none"],
                ["R2", "b", "s.b.t002", "s.b.t001"],
            ]
        );
    }

    #[test]
    fn a_test_that_broke_off_is_beside_nobody() {
        let mut broken = test("a.t001", [Pass, Pass], &["go"]);
        broken.error = Some("gone".into());
        let found = results(vec![broken, test("a.t002", [Fail, Pass], &["go"])]).replay_pairs();
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].beside, None);
    }

    #[test]
    fn numbers_are_no_difference_and_names_are() {
        assert_eq!(
            without_numbers("look(false) with offset = -0.235598 m, n = 3"),
            "look(false) with offset = # m, n = #"
        );
        assert_eq!(without_numbers("leg2(17) r_5"), "leg2(#) r_5");
        let steps = |steps: &[&str]| steps.iter().map(|s| (*s).to_owned()).collect::<Vec<_>>();
        assert_eq!(changes(&steps(&["a", "b", "c"]), &steps(&["a", "c"])), 1);
        assert_eq!(changes(&steps(&["a", "b"]), &steps(&["x", "b", "y"])), 2);
        assert_eq!(changes(&[], &steps(&["a", "b"])), 2);
    }

    #[test]
    fn the_command_of_a_test_without_a_recording_is_not_told() {
        let mut found = results(vec![test("a.t001", [Fail, Pass], &[])]);
        let shown = found.view_of(&found.tests[0]).unwrap();
        assert_eq!(shown, "hrdsl view s.hri --results . a.t001");
        found.unreplayed.push(UnreplayedTest { test: "s.a.t001".into(), why: "no room".into() });
        assert_eq!(found.view_of(&found.tests[0]), None);
    }
}
