//! From single tests to a campaign: tallies, bins, accumulated code coverage.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_ir::{
    Program,
    coverage::BinName,
    monitor::{Monitor, RequirementKind},
};
use hrdsl_results::{
    BinResult, CampaignResults, CodeFile, CoverageRatios, FORMAT, FileCoverage, GeneratedSuite, GoalStatus,
    InterfaceWarning, RequirementResult, SmallestMargin, SuiteGoalId, SuiteInfo, SuiteName, TestMethod,
    TestResult, TriggerTotal, VERSION, VerdictOutcome, VerdictTally,
};

use hrdsl_trace::MachineDeclaration;

use crate::{formula::NamedFormula, machines::machines};

/// A finished test, with the code of the system under test that it executed.
#[derive(Clone, Debug, Default)]
pub struct FinishedTest {
    pub result: TestResult,
    pub executed: Vec<FileCoverage>,
    /// What their state machines consist of.
    pub machines: Vec<MachineDeclaration>,
}

/// What a campaign came to.
#[derive(Clone, Debug, Default)]
pub struct CampaignOutcome {
    /// The tests that ended, in the order in which they were given.
    pub tests: Vec<FinishedTest>,
    pub planned: usize,
    pub interrupted: bool,
    /// Names of the middleware at which somebody was alone in every test.
    pub warnings: Vec<InterfaceWarning>,
    /// What judged the tests beside the requirements, in the order of the verdicts behind theirs.
    pub formulas: Vec<NamedFormula>,
}

/// Puts the results of a campaign together. `sources` are the texts of the measured files, by name; `rerun` is the command that
/// runs one test again, up to its name.
#[must_use]
pub fn tally(
    program: &Program,
    seed: u64,
    generated: &[GeneratedSuite],
    outcome: CampaignOutcome,
    sources: &BTreeMap<String, String>,
    rerun: String,
) -> CampaignResults {
    let CampaignOutcome { tests, planned, interrupted, warnings, formulas } = outcome;
    let suites = suites(generated, &tests);
    let place: SuiteOrder<'_> = suites.iter().enumerate().map(|(i, s)| (&s.name, i)).collect();
    CampaignResults {
        format: FORMAT.to_owned(),
        version: VERSION,
        hrdsl: env!("CARGO_PKG_VERSION").to_owned(),
        scenario: program.name.clone(),
        seed,
        interrupted,
        planned,
        rerun,
        view: String::new(),
        unreplayed: Vec::new(),
        requirements: requirements((program, &formulas), &tests, &place),
        bins: bins(program, generated, &tests, &place),
        code: code(&tests, sources, &place),
        machines: machines(&tests, suites.len(), |t| place.get(&t.result.suite).copied().unwrap_or(0)),
        suites,
        warnings,
        tests: tests.into_iter().map(|t| t.result).collect(),
    }
}

/// Where each suite stands.
type SuiteOrder<'a> = BTreeMap<&'a SuiteName, usize>;

fn requirements(
    (program, formulas): (&Program, &[NamedFormula]),
    tests: &[FinishedTest],
    place: &SuiteOrder<'_>,
) -> Vec<RequirementResult> {
    let empty = |m: &Monitor| RequirementResult {
        name: m.name.as_str().into(),
        kind: m.kind,
        title: m.title.clone(),
        doc: m.doc.clone(),
        text: m.text.clone(),
        tally: vec![VerdictTally::default(); place.len()],
        failing: Vec::new(),
        triggered: TriggerTotal::default(),
        worst_margin: None,
    };
    let besides = |formula: &NamedFormula| RequirementResult {
        name: formula.name.as_str().into(),
        kind: RequirementKind::Functional,
        // It has no other words.
        title: formula.text.clone(),
        doc: String::new(),
        text: formula.text.clone(),
        tally: vec![VerdictTally::default(); place.len()],
        failing: Vec::new(),
        triggered: TriggerTotal::default(),
        worst_margin: None,
    };
    let mut requirements: Vec<RequirementResult> =
        program.monitors.iter().map(empty).chain(formulas.iter().map(besides)).collect();
    for test in tests.iter().map(|t| &t.result) {
        let suite = place.get(&test.suite).copied().unwrap_or(0);
        for (requirement, verdict) in requirements.iter_mut().zip(&test.judgement.verdicts) {
            if let Some(tally) = requirement.tally.get_mut(suite) {
                tally.add(verdict.outcome);
            }
            requirement.triggered.add(verdict.triggered);
            if verdict.outcome == VerdictOutcome::Fail {
                requirement.failing.push(test.name.clone());
            }
            if let Some((value, unit)) = &verdict.worst_margin
                && requirement.worst_margin.as_ref().is_none_or(|m| *value < m.value)
            {
                let (unit, test) = (unit.clone(), test.name.clone());
                requirement.worst_margin = Some(SmallestMargin { value: *value, unit, test });
            }
        }
    }
    requirements
}

/// The suites in the order of their first test, with their code coverage.
fn suites(generated: &[GeneratedSuite], tests: &[FinishedTest]) -> Vec<SuiteInfo> {
    let mut names: Vec<(&SuiteName, TestMethod)> = Vec::new();
    for test in tests.iter().map(|t| &t.result) {
        if names.iter().all(|(n, _)| **n != test.suite) {
            names.push((&test.suite, test.method));
        }
    }
    let info = |(suite, method): &(&SuiteName, TestMethod)| {
        let own: Vec<&FinishedTest> = tests.iter().filter(|t| t.result.suite == **suite).collect();
        let made = generated.iter().find(|g| **suite == *g.suite);
        let (code, code_accumulated) = accumulate(&own);
        SuiteInfo {
            name: (*suite).clone(),
            method: *method,
            abstract_tests: made.map(|g| g.abstract_tests),
            tests: count(own.len()),
            errors: count(own.iter().filter(|t| t.result.error.is_some()).count()),
            goals: made.map_or_else(Vec::new, |g| g.goals.clone()),
            model: made.and_then(|g| g.coverage.clone()),
            explanation: made.and_then(|g| g.explanation.clone()),
            notes: made.map_or_else(Vec::new, |g| g.notes.clone()),
            code,
            code_accumulated,
            code_per_test: own.iter().map(|t| t.result.code.line_percent()).collect(),
        }
    };
    names.iter().map(info).collect()
}

fn count(n: usize) -> u32 {
    u32::try_from(n).unwrap_or(u32::MAX)
}

/// One more for the suite that stands there.
pub(crate) fn count_one(counts: &mut [u32], suite: usize) {
    if let Some(count) = counts.get_mut(suite) {
        *count += 1;
    }
}

type LineSet<'a> = BTreeSet<(&'a str, u32)>;
type BranchSet<'a> = BTreeSet<(&'a str, (u32, i32))>;

/// What the tests executed together, and the percentage of lines after each.
fn accumulate(tests: &[&FinishedTest]) -> (CoverageRatios, Vec<f64>) {
    let (mut all, mut hit): (LineSet<'_>, LineSet<'_>) = Default::default();
    let (mut branches, mut taken): (BranchSet<'_>, BranchSet<'_>) = Default::default();
    for file in tests.iter().flat_map(|t| &t.executed) {
        all.extend(file.statements.iter().map(|l| (file.file.as_str(), *l)));
        branches.extend(file.branches.iter().map(|b| (file.file.as_str(), *b)));
    }
    let mut accumulated = Vec::new();
    let mut ratios = CoverageRatios {
        lines_total: count(all.len()),
        branches_total: count(branches.len()),
        ..CoverageRatios::default()
    };
    for test in tests {
        for file in &test.executed {
            hit.extend(file.executed.iter().map(|l| (file.file.as_str(), *l)));
            taken.extend(file.executed_branches.iter().map(|b| (file.file.as_str(), *b)));
        }
        ratios.lines = count(hit.len());
        ratios.branches = count(taken.len());
        accumulated.push(ratios.line_percent());
    }
    (ratios, accumulated)
}

fn bins(
    program: &Program,
    generated: &[GeneratedSuite],
    tests: &[FinishedTest],
    place: &SuiteOrder<'_>,
) -> Vec<BinResult> {
    let mut out = Vec::new();
    for cross in &program.coverage.crosses {
        for bin in &cross.bins {
            let name = BinName::new(&cross.name, &bin.name);
            let mut result = BinResult {
                cross: cross.name.clone(),
                bin: bin.name.clone(),
                hits: vec![0; place.len()],
                predicted: vec![0; place.len()],
                first: None,
                unreachable: unreachable(generated, &name),
                name,
            };
            for test in tests.iter().map(|t| &t.result) {
                let suite = place.get(&test.suite).copied().unwrap_or(0);
                if test.judgement.bins.contains(&result.name) {
                    count_one(&mut result.hits, suite);
                    // By the alphabet: the same whatever the order of the tests.
                    if result.first.as_ref().is_none_or(|first| test.name < *first) {
                        result.first = Some(test.name.clone());
                    }
                }
                if test.predicted.contains(&result.name) {
                    count_one(&mut result.predicted, suite);
                }
            }
            out.push(result);
        }
    }
    out
}

/// Why the search says that a bin cannot be reached.
fn unreachable(generated: &[GeneratedSuite], bin: &BinName) -> Option<String> {
    let is_it = |goal: &SuiteGoalId| matches!(goal, SuiteGoalId::Bin(name) if name == bin);
    let mut goals = generated.iter().flat_map(|g| &g.goals);
    goals.find(|g| is_it(&g.goal) && g.status == GoalStatus::Unreachable).map(|g| g.reason.clone())
}

fn code(tests: &[FinishedTest], sources: &BTreeMap<String, String>, place: &SuiteOrder<'_>) -> Vec<CodeFile> {
    let names: BTreeSet<&str> = tests.iter().flat_map(|t| &t.executed).map(|f| f.file.as_str()).collect();
    let file = |name: &&str| {
        let mut lines: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        let (mut branches, mut taken) = (BTreeSet::new(), BTreeSet::new());
        for test in tests {
            let suite = place.get(&test.result.suite).copied().unwrap_or(0);
            for file in test.executed.iter().filter(|f| f.file == *name) {
                for line in &file.statements {
                    lines.entry(*line).or_insert_with(|| vec![0; place.len()]);
                }
                for line in &file.executed {
                    count_one(lines.entry(*line).or_insert_with(|| vec![0; place.len()]), suite);
                }
                branches.extend(file.branches.iter().copied());
                taken.extend(file.executed_branches.iter().copied());
            }
        }
        let lines: Vec<(u32, u32, Vec<u32>)> =
            lines.into_iter().map(|(line, suites)| (line, suites.iter().sum(), suites)).collect();
        CodeFile {
            file: (*name).to_owned(),
            ratios: CoverageRatios {
                lines: count(lines.iter().filter(|(_, tests, _)| *tests > 0).count()),
                lines_total: count(lines.len()),
                branches: count(taken.len()),
                branches_total: count(branches.len()),
            },
            lines: lines.iter().map(|(line, tests, _)| (*line, *tests)).collect(),
            suites: lines.into_iter().map(|(_, _, suites)| suites).collect(),
            missed_branches: branches.difference(&taken).copied().collect(),
            source: sources.get(*name).cloned().unwrap_or_default(),
        }
    };
    names.iter().map(file).collect()
}
