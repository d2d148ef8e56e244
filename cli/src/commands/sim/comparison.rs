//! The same tests, run in other ways: whose verdicts or ends are others.

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

use super::determinism::RunDifferences;
use crate::{commands::campaign::progress_bar, fault::CommandFault};

/// Findings that are listed, at most.
const LISTED: usize = 20;

/// How a way differs from the usual one, in words.
pub struct OtherWay<'p> {
    /// The option that runs one test in it.
    pub option: String,
    pub campaign: CampaignSetup<'p>,
}

/// What is said of ways of one kind.
pub struct WayWords {
    /// What begins the line, `schedules`.
    pub topic: &'static str,
    /// Of several, `other orders of their threads`, and of one, `in another order of their threads`.
    pub several: &'static str,
    pub one: &'static str,
    /// `in the usual order`.
    pub usual: String,
    /// Beside the progress bar.
    pub progress: &'static str,
}

/// What a test came to, as far as another way may change it.
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
    fn difference(&self, other: &Self, usual: &str) -> Option<String> {
        let pairs = self.verdicts.iter().zip(&other.verdicts);
        let mut changed = pairs.filter(|(a, b)| a != b);
        if let Some(((name, before), (_, now))) = changed.next() {
            return Some(format!("{name} is {}, and {} {usual}", word(*now), word(*before)));
        }
        let first = |text: &str| text.lines().next().unwrap_or_default().to_owned();
        (self.ended != other.ended)
            .then(|| format!("{}; {usual}: {}", first(&other.ended), first(&self.ended)))
    }
}

/// Of a test that differs: the first way in which it does, and how.
type DifferentTests = BTreeMap<String, (String, String)>;

/// Runs the tests in the other ways, one after the other, and compares what they come to with the first outcome.
pub fn compare<'p>(
    (tests, first): (&[Test], &CampaignOutcome),
    ways: Vec<OtherWay<'p>>,
    words: &WayWords,
) -> Result<RunDifferences, CommandFault> {
    let known: BTreeMap<String, TestVerdicts> =
        first.tests.iter().map(|t| (t.result.name.to_string(), TestVerdicts::of(&t.result))).collect();
    let bar = progress_bar(tests.len() * ways.len(), "tests");
    bar.set_message(words.progress);
    let found: Mutex<DifferentTests> = Mutex::default();
    // By way, how many tests differ in it.
    let mut counts: Vec<(String, usize)> = Vec::new();
    for way in ways {
        let differ = Mutex::new(0);
        // The files of the first run are the results.
        let campaign = CampaignSetup { keep: None, clocks: None, replays: false, ..way.campaign };
        let CampaignRun { outcome, .. } = campaign.run(tests, |done| {
            let name = done.result.name.to_string();
            let now = TestVerdicts::of(done.result);
            let difference = known.get(&name).and_then(|k| k.difference(&now, &words.usual));
            if let Some(difference) = difference {
                *differ.lock().unwrap_or_else(PoisonError::into_inner) += 1;
                let mut found = found.lock().unwrap_or_else(PoisonError::into_inner);
                found.entry(name).or_insert((way.option.clone(), difference));
            }
            bar.inc(1);
            Ok(())
        })?;
        counts.push((way.option, differ.into_inner().unwrap_or_else(PoisonError::into_inner)));
        if outcome.interrupted {
            break;
        }
    }
    bar.finish_and_clear();
    let found = found.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(RunDifferences { tests: found.len(), text: words.text(&found, tests.len(), &counts) })
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

impl WayWords {
    fn text(&self, found: &DifferentTests, tests: usize, counts: &[(String, usize)]) -> String {
        let Self { topic, several, one, .. } = self;
        if found.is_empty() {
            let tests = if tests == 1 { "1 test comes".to_owned() } else { format!("{tests} tests come") };
            return format!("{topic}: {tests} to the same in {} {several}\n", counts.len());
        }
        let count = found.len();
        let come = if count == 1 { "comes" } else { "come" };
        let mut text = format!("{topic}: {count} of {tests} tests {come} to something else {one}\n");
        for (name, (option, difference)) in found.iter().take(LISTED) {
            let _ = writeln!(text, "  {name}: with {option}, {difference}");
        }
        if count > LISTED {
            let _ = writeln!(text, "  and {} more", count - LISTED);
        }
        let counts: Vec<String> = counts.iter().map(|(option, n)| format!("{n} with {option}")).collect();
        let _ = writeln!(text, "  as many differ: {}", counts.join(", "));
        text
    }
}
