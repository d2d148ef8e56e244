//! From single tests to a campaign: tallies, bins, accumulated code coverage.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_coverage::name;
use hrdsl_ir::Program;

use crate::{
    campaign::CampaignOutcome,
    results::{BinResult, CodeFile, Margin, Ratios, Results, SuiteInfo, TestResult, requirements},
    testgen::{Generated, GoalStatus, bin_goal},
};

/// Puts the results of a campaign together. `sources` are the texts of the measured files, by name.
#[must_use]
pub fn tally(
    program: &Program,
    seed: u64,
    generated: &[Generated],
    outcome: CampaignOutcome,
    sources: &BTreeMap<String, String>,
) -> Results {
    let CampaignOutcome { tests, planned, interrupted } = outcome;
    let suites = suites(generated, &tests);
    let place: BTreeMap<&str, usize> = suites.iter().enumerate().map(|(i, s)| (s.name.as_str(), i)).collect();
    let mut requirements = requirements(program, suites.len());
    for test in &tests {
        let suite = place.get(test.suite.as_str()).copied().unwrap_or(0);
        for (requirement, verdict) in requirements.iter_mut().zip(&test.verdicts) {
            let tally = &mut requirement.tally[suite];
            match verdict.outcome {
                "pass" => tally.pass += 1,
                "fail" => {
                    tally.fail += 1;
                    requirement.failing.push(test.name.clone());
                }
                "not_checked" => tally.not_checked += 1,
                "open" => tally.open += 1,
                _ => tally.error += 1,
            }
            if let Some((value, unit)) = verdict.worst_margin
                && requirement.worst_margin.as_ref().is_none_or(|m| value < m.value)
            {
                let test = test.name.clone();
                requirement.worst_margin = Some(Margin { value, unit, test });
            }
        }
    }
    let bins = bins(program, generated, &tests, &place);
    let code = code(&tests, sources);
    Results {
        scenario: program.name.clone(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        seed,
        interrupted,
        planned,
        requirements,
        bins,
        code,
        suites,
        tests,
        rerun: String::new(),
    }
}

/// The suites in the order of their first test, with their code coverage.
fn suites(generated: &[Generated], tests: &[TestResult]) -> Vec<SuiteInfo> {
    let mut names: Vec<(&str, &str)> = Vec::new();
    for test in tests {
        if names.iter().all(|(n, _)| *n != test.suite) {
            names.push((&test.suite, &test.method));
        }
    }
    let info = |(suite, method): &(&str, &str)| {
        let own: Vec<&TestResult> = tests.iter().filter(|t| t.suite == *suite).collect();
        let made = generated.iter().find(|g| g.suite == *suite);
        let (code, code_accumulated) = accumulate(&own);
        SuiteInfo {
            name: (*suite).to_owned(),
            method: (*method).to_owned(),
            abstract_tests: made.map(|g| g.abstract_tests),
            tests: count(own.len()),
            errors: count(own.iter().filter(|t| t.error.is_some()).count()),
            goals: made.map_or_else(Vec::new, |g| g.goals.clone()),
            model: made.and_then(|g| g.coverage.clone()),
            explanation: made.and_then(|g| g.explanation.clone()),
            notes: made.map_or_else(Vec::new, |g| g.notes.clone()),
            code,
            code_accumulated,
            code_per_test: own.iter().map(|t| t.code.line_percent()).collect(),
        }
    };
    names.iter().map(info).collect()
}

fn count(n: usize) -> u32 {
    u32::try_from(n).unwrap_or(u32::MAX)
}

type Lines<'a> = BTreeSet<(&'a str, u32)>;
type Branches<'a> = BTreeSet<(&'a str, (u32, i32))>;

/// What the tests executed together, and the percentage of lines after each.
fn accumulate(tests: &[&TestResult]) -> (Ratios, Vec<f64>) {
    let (mut all, mut hit): (Lines<'_>, Lines<'_>) = Default::default();
    let (mut ways, mut taken): (Branches<'_>, Branches<'_>) = Default::default();
    for file in tests.iter().flat_map(|t| &t.files) {
        all.extend(file.statements.iter().map(|l| (file.file.as_str(), *l)));
        ways.extend(file.branches.iter().map(|b| (file.file.as_str(), *b)));
    }
    let mut accumulated = Vec::new();
    let mut ratios =
        Ratios { lines_total: count(all.len()), branches_total: count(ways.len()), ..Ratios::default() };
    for test in tests {
        for file in &test.files {
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
    generated: &[Generated],
    tests: &[TestResult],
    place: &BTreeMap<&str, usize>,
) -> Vec<BinResult> {
    let mut out = Vec::new();
    for cross in &program.coverage.crosses {
        for bin in &cross.bins {
            let id = name::bin(&cross.name, &bin.name);
            let mut result = BinResult {
                name: id.clone(),
                cross: cross.name.clone(),
                bin: bin.name.clone(),
                hits: vec![0; place.len()],
                predicted: vec![0; place.len()],
                first: None,
                unreachable: unreachable(generated, &id),
            };
            for test in tests {
                let suite = place.get(test.suite.as_str()).copied().unwrap_or(0);
                if test.bins.contains(&id) {
                    result.hits[suite] += 1;
                    // By the alphabet: the same whatever the order of the tests.
                    if result.first.as_ref().is_none_or(|first| test.name < *first) {
                        result.first = Some(test.name.clone());
                    }
                }
                result.predicted[suite] += u32::from(test.predicted.contains(&id));
            }
            out.push(result);
        }
    }
    out
}

/// Why the search says that a bin cannot be reached.
fn unreachable(generated: &[Generated], bin: &str) -> Option<String> {
    let name = bin_goal(bin);
    let goals = generated.iter().flat_map(|g| &g.goals);
    goals.filter(|g| g.goal == name && g.status == GoalStatus::Unreachable).map(|g| g.reason.clone()).next()
}

fn code(tests: &[TestResult], sources: &BTreeMap<String, String>) -> Vec<CodeFile> {
    let names: BTreeSet<&str> = tests.iter().flat_map(|t| &t.files).map(|f| f.file.as_str()).collect();
    let file = |name: &&str| {
        let mut lines: BTreeMap<u32, u32> = BTreeMap::new();
        let (mut ways, mut taken) = (BTreeSet::new(), BTreeSet::new());
        for file in tests.iter().flat_map(|t| &t.files).filter(|f| f.file == *name) {
            for line in &file.statements {
                lines.entry(*line).or_default();
            }
            for line in &file.executed {
                *lines.entry(*line).or_default() += 1;
            }
            ways.extend(file.branches.iter().copied());
            taken.extend(file.executed_branches.iter().copied());
        }
        CodeFile {
            file: (*name).to_owned(),
            ratios: Ratios {
                lines: count(lines.values().filter(|n| **n > 0).count()),
                lines_total: count(lines.len()),
                branches: count(taken.len()),
                branches_total: count(ways.len()),
            },
            lines: lines.into_iter().collect(),
            missed_branches: ways.difference(&taken).copied().collect(),
            source: sources.get(*name).cloned().unwrap_or_default(),
        }
    };
    names.iter().map(file).collect()
}
