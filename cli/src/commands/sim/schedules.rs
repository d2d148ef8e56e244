//! `--schedules`: the same tests with other orders of the programs' threads, to find races.

use std::{
    collections::BTreeMap,
    fmt::Write as _,
    sync::{Mutex, PoisonError},
};

use hrdsl_ir::test::Test;
use hrdsl_runtime::{
    campaign::{CampaignRun, CampaignSetup},
    judge::CampaignOutcome,
    results::{TestResult, VerdictOutcome},
};

use crate::{commands::campaign::progress_bar, fault::CommandFault};

/// Findings that are listed, at most.
const LISTED: usize = 20;

/// The variable from which the order of threads follows.
pub const VARIABLE: &str = "HRDSL_SCHEDULE";

/// What other orders made different.
pub struct ScheduleDifferences {
    /// How many tests come to another verdict or end under some order.
    pub tests: usize,
    /// For people.
    pub text: String,
}

/// What a test came to, as far as a race may change it.
#[derive(Clone, Debug, PartialEq)]
struct TestVerdicts {
    ended: String,
    verdicts: Vec<(String, VerdictOutcome)>,
}

impl TestVerdicts {
    fn of(result: &TestResult) -> Self {
        let verdicts = result.judgement.verdicts.iter().map(|v| (v.requirement.to_string(), v.outcome));
        let ended = result.error.clone().unwrap_or_else(|| format!("it ends as {}", result.ended.word()));
        Self { ended, verdicts: verdicts.collect() }
    }

    /// In which way the other differs.
    fn difference(&self, other: &Self) -> Option<String> {
        let pairs = self.verdicts.iter().zip(&other.verdicts);
        let mut changed = pairs.filter(|(a, b)| a != b);
        if let Some(((name, before), (_, now))) = changed.next() {
            return Some(format!("{name} is {}, and {} in the usual order", word(*now), word(*before)));
        }
        let first = |text: &str| text.lines().next().unwrap_or_default().to_owned();
        (self.ended != other.ended)
            .then(|| format!("{}; in the usual order: {}", first(&other.ended), first(&self.ended)))
    }
}

/// Runs the tests under so many other orders, and compares what they come to with the first outcome.
pub fn compare(
    campaign: &CampaignSetup<'_>,
    tests: &[Test],
    first: &CampaignOutcome,
    schedules: u32,
) -> Result<ScheduleDifferences, CommandFault> {
    let known: BTreeMap<String, TestVerdicts> =
        first.tests.iter().map(|t| (t.result.name.to_string(), TestVerdicts::of(&t.result))).collect();
    let bar = progress_bar(tests.len() * schedules as usize, "tests");
    bar.set_message("in other orders of the threads");
    let found: Mutex<BTreeMap<String, (u32, String)>> = Mutex::default();
    let mut ran = 0;
    for schedule in 1..=schedules {
        let mut variables = campaign.variables.clone();
        variables.retain(|(name, _)| name != VARIABLE);
        variables.push((VARIABLE.into(), schedule.to_string().into()));
        // The files of the first run are the results.
        let other = CampaignSetup { keep: None, clocks: None, replays: false, variables, ..campaign.clone() };
        let CampaignRun { outcome, .. } = other.run(tests, |done| {
            let name = done.result.name.to_string();
            let difference = known.get(&name).and_then(|k| k.difference(&TestVerdicts::of(done.result)));
            if let Some(difference) = difference {
                let mut found = found.lock().unwrap_or_else(PoisonError::into_inner);
                found.entry(name).or_insert((schedule, difference));
            }
            bar.inc(1);
            Ok(())
        })?;
        ran = schedule;
        if outcome.interrupted {
            break;
        }
    }
    bar.finish_and_clear();
    let found = found.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(ScheduleDifferences { tests: found.len(), text: text(&found, tests.len(), ran) })
}

fn word(outcome: VerdictOutcome) -> &'static str {
    match outcome {
        VerdictOutcome::Pass => "passed",
        VerdictOutcome::Fail => "violated",
        VerdictOutcome::Vacuous => "vacuous",
        VerdictOutcome::Inconclusive => "inconclusive",
        VerdictOutcome::Error => "an error",
    }
}

fn text(found: &BTreeMap<String, (u32, String)>, tests: usize, schedules: u32) -> String {
    if found.is_empty() {
        return format!(
            "schedules: {tests} tests come to the same in {schedules} other orders of their threads\n"
        );
    }
    let count = found.len();
    let mut text = format!(
        "schedules: {count} of {tests} tests come to something else in another order of their threads\n"
    );
    for (name, (schedule, difference)) in found.iter().take(LISTED) {
        let _ = writeln!(text, "  {name}: with --schedule {schedule}, {difference}");
    }
    if count > LISTED {
        let _ = writeln!(text, "  and {} more", count - LISTED);
    }
    text
}
