//! What all reports say about a campaign in the same way: verdicts, standings, gaps.

use std::collections::BTreeMap;

use hrdsl_results::{
    BinResult, CampaignResults, ConformanceOutcome, CounterexampleStep, CoverageRatios, FirstFailure,
    GoalStatus, InterfaceWarning, MachineResult, RequirementKind, RequirementResult, TestName, TestResult,
    UnservedWait, VerdictOutcome as Outcome, VerdictResult, VerdictTally,
};

use crate::text;

/// How a verdict is shown.
pub trait ShownOutcome {
    fn symbol(self) -> &'static str;
    fn short(self) -> &'static str;
    fn letter(self) -> char;
    fn word(self) -> &'static str;
    /// What the legend adds to the word; empty if the word says it.
    fn meaning(self) -> &'static str;
}

impl ShownOutcome for Outcome {
    /// A mark that needs no colour.
    fn symbol(self) -> &'static str {
        match self {
            Outcome::Pass => "✓",
            Outcome::Fail => "✗",
            Outcome::Vacuous => "○",
            Outcome::Inconclusive => "…",
            Outcome::Error => "!",
        }
    }

    /// The heading of its column.
    fn short(self) -> &'static str {
        match self {
            Outcome::Pass => "P",
            Outcome::Fail => "F",
            Outcome::Vacuous => "V",
            Outcome::Inconclusive => "I",
            Outcome::Error => "E",
        }
    }

    /// One letter, for style classes and filters.
    fn letter(self) -> char {
        match self {
            Outcome::Pass => 'p',
            Outcome::Fail => 'f',
            Outcome::Vacuous => 'n',
            Outcome::Inconclusive => 'o',
            Outcome::Error => 'e',
        }
    }

    /// As a word.
    fn word(self) -> &'static str {
        match self {
            Outcome::Pass => "passed",
            Outcome::Fail => "failed",
            Outcome::Vacuous => "vacuous",
            Outcome::Inconclusive => "inconclusive",
            Outcome::Error => "error",
        }
    }

    fn meaning(self) -> &'static str {
        match self {
            Outcome::Pass | Outcome::Fail | Outcome::Inconclusive | Outcome::Error => "",
            Outcome::Vacuous => "never triggered",
        }
    }
}

/// The kind of a requirement, as a word.
pub fn kind(requirement: &RequirementResult) -> &'static str {
    match requirement.kind {
        RequirementKind::Safety => "safety",
        RequirementKind::Functional => "functional",
    }
}

/// All suites together.
pub fn total(requirement: &RequirementResult) -> VerdictTally {
    requirement.tally.iter().fold(VerdictTally::default(), |sum, t| VerdictTally {
        pass: sum.pass + t.pass,
        fail: sum.fail + t.fail,
        vacuous: sum.vacuous + t.vacuous,
        inconclusive: sum.inconclusive + t.inconclusive,
        error: sum.error + t.error,
    })
}

/// Where a requirement stands after all tests: the worst thing that is known about it.
pub fn standing(requirement: &RequirementResult) -> Outcome {
    let tally = total(requirement);
    if tally.fail > 0 {
        Outcome::Fail
    } else if tally.pass > 0 {
        Outcome::Pass
    } else if tally.inconclusive > 0 {
        Outcome::Inconclusive
    } else if tally.error > 0 {
        Outcome::Error
    } else {
        Outcome::Vacuous
    }
}

/// What is known about a bin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinStatus {
    Hit,
    /// No test hit it, and nothing says that none could.
    Missed,
    /// The model cannot reach it, and no test did.
    Unreachable,
    /// The model cannot reach it, yet a test did: the model is wrong.
    Refuted,
}

impl BinStatus {
    pub fn of(bin: &BinResult) -> Self {
        let is_hit = bin.hits.iter().any(|n| *n > 0);
        match (is_hit, bin.unreachable.is_some()) {
            (true, false) => BinStatus::Hit,
            (false, false) => BinStatus::Missed,
            (false, true) => BinStatus::Unreachable,
            (true, true) => BinStatus::Refuted,
        }
    }

    pub fn symbol(self) -> &'static str {
        match self {
            BinStatus::Hit => "✓",
            BinStatus::Missed => "○",
            BinStatus::Unreachable => "⊘",
            BinStatus::Refuted => "!",
        }
    }
}

/// Whether the model of a suite predicted anything: without that, a prediction of 0 means nothing.
pub fn predicts(results: &CampaignResults, suite: usize) -> bool {
    results.bins.iter().any(|b| b.predicted.get(suite).is_some_and(|n| *n > 0))
}

/// How many of the bins each suite hit.
pub fn bins_hit(results: &CampaignResults, suite: usize) -> usize {
    results.bins.iter().filter(|b| b.hits.get(suite).is_some_and(|n| *n > 0)).count()
}

/// Lines and branches of all files.
pub fn code(results: &CampaignResults) -> CoverageRatios {
    results.code.iter().fold(CoverageRatios::default(), |sum, f| CoverageRatios {
        lines: sum.lines + f.ratios.lines,
        lines_total: sum.lines_total + f.ratios.lines_total,
        branches: sum.branches + f.ratios.branches,
        branches_total: sum.branches_total + f.ratios.branches_total,
    })
}

/// Whether a test violates a requirement.
pub fn violates(test: &TestResult, requirement: &str) -> bool {
    failed(test, requirement).is_some()
}

/// The failure of a requirement in a test.
pub fn failure<'a>(test: &'a TestResult, requirement: &str) -> Option<(&'a VerdictResult, &'a FirstFailure)> {
    let verdict = failed(test, requirement)?;
    verdict.failure.as_ref().map(|failure| (verdict, failure))
}

fn failed<'a>(test: &'a TestResult, requirement: &str) -> Option<&'a VerdictResult> {
    test.judgement.verdicts.iter().find(|v| v.requirement == *requirement && v.outcome == Outcome::Fail)
}

/// The tests that violate a requirement, in order, each with its place in [`CampaignResults::tests`].
pub fn failing<'a>(
    results: &'a CampaignResults,
    requirement: &RequirementResult,
) -> Vec<(usize, &'a TestResult)> {
    results.tests.iter().enumerate().filter(|(_, t)| violates(t, &requirement.name)).collect()
}

/// Which obligation a violation is of, in a sentence; nothing if it needs none.
pub fn how(failure: &FirstFailure) -> String {
    let since = text::moment(failure.triggered_at);
    let passed = text::moment(failure.time - failure.triggered_at);
    match (failure.deadline, failure.triggered_at < failure.time) {
        (true, _) => format!("What was due since {since} was not done within {passed}."),
        (false, true) => format!("Breaks what held since {since}."),
        (false, false) => String::new(),
    }
}

/// A violation in a few words: the step that violates, with the margin if it has one, or what was not done.
pub fn in_short(verdict: &VerdictResult, failure: &FirstFailure) -> String {
    let steps = failure.counterexample.as_slice();
    let step = steps.last().map(|s| text::line(&s.text)).unwrap_or_default();
    let passed = text::moment(failure.time - failure.triggered_at);
    if failure.deadline {
        return if steps.is_empty() {
            format!("nothing within {passed}")
        } else {
            format!("nothing within {passed} of {step}")
        };
    }
    let step =
        if steps.last().is_some_and(|last| sample(last).is_some()) { latest_samples(steps) } else { step };
    match steps {
        // What has to hold from the start on is not triggered by the first sample, though a monitor begins with that.
        [first, .., _] if failure.triggered_at < failure.time && sample(first).is_some() => step,
        [first, .., _] if failure.triggered_at < failure.time => {
            format!("{step}, {passed} after {}", text::line(&first.text))
        }
        _ => match &verdict.worst_margin {
            Some((value, unit)) => format!("{step}, margin {}", text::margin(*value, unit)),
            None => step,
        },
    }
}

/// The signal of which a step shows a sample, and what it shows, as `speed = 1 m/s`.
fn sample(step: &CounterexampleStep) -> Option<(&str, &str)> {
    let shown = step.text.strip_prefix("signal ")?;
    shown.split_once(" = ").map(|(signal, _)| (signal, shown))
}

/// The last sample of each signal: which of them violates a requirement that compares several, its steps do not say.
fn latest_samples(steps: &[CounterexampleStep]) -> String {
    let mut latest: Vec<(&str, &str)> = Vec::new();
    for (signal, shown) in steps.iter().rev().filter_map(sample) {
        if latest.iter().all(|(known, _)| *known != signal) {
            latest.push((signal, shown));
        }
    }
    let shown: Vec<_> = latest.iter().rev().map(|(_, shown)| text::line(shown)).collect();
    format!("signal {}", shown.join(", "))
}

/// A test's name within its scenario.
pub fn short<'a>(results: &CampaignResults, name: &'a TestName) -> &'a str {
    name.within(&results.scenario)
}

/// The names of the middleware at which somebody was alone, without mere notes.
pub fn warnings(results: &CampaignResults) -> Vec<&InterfaceWarning> {
    results.warnings.iter().filter(|w| !w.is_note()).collect()
}

/// What must be known about a run: its marks, where it left its prediction and the model, and what its programs waited for in vain.
pub fn notes(test: &TestResult) -> Vec<String> {
    let marks = test.marks.iter().map(|mark| mark.sentence().to_owned());
    let departure = test.prediction.as_ref().and_then(|p| p.departure(&test.steps));
    let left = departure.map(|how| format!("not as predicted: {how}"));
    let models = test.judgement.conformance.iter().filter_map(|verdict| {
        let sentence = verdict.sentence()?;
        Some(match verdict.outcome {
            ConformanceOutcome::Departs => format!("not as the model: {sentence}"),
            ConformanceOutcome::Conforms | ConformanceOutcome::Inconclusive => {
                format!("conformance inconclusive: {sentence}")
            }
        })
    });
    marks.chain(left).chain(models).chain(test.waits.iter().map(UnservedWait::sentence)).collect()
}

/// Whether everything of a state machine was reached.
pub fn is_whole(machine: &MachineResult) -> bool {
    unreached(machine).is_empty()
}

/// The state machines as far as the tests of one suite reached them.
pub fn machines_of(results: &CampaignResults, suite: &str) -> Vec<MachineResult> {
    let Some(at) = results.suites.iter().position(|s| s.name == *suite) else { return Vec::new() };
    let own = |hits: &[u32]| hits.get(at).copied().into_iter().collect();
    let mut machines = results.machines.clone();
    for machine in &mut machines {
        machine.states.iter_mut().for_each(|s| s.hits = own(&s.hits));
        machine.transitions.iter_mut().for_each(|t| t.hits = own(&t.hits));
    }
    machines
}

/// `7 of 8 states, 11 of 15 transitions`; without transitions, the states alone.
pub fn machine_in_short(machine: &MachineResult) -> String {
    let ((states, all_states), (taken, all)) = (machine.states_reached(), machine.transitions_reached());
    let states = format!("{states} of {}", text::count(all_states, "state"));
    if all == 0 { states } else { format!("{states}, {taken} of {}", text::count(all, "transition")) }
}

/// What of a state machine no test reached: states, then transitions, each with the word for it.
pub fn unreached(machine: &MachineResult) -> Vec<(&'static str, String)> {
    let is_missed = |hits: &[u32]| hits.iter().all(|n| *n == 0);
    let states = machine.states.iter().filter(|s| is_missed(&s.hits));
    let transitions = machine.transitions.iter().filter(|t| is_missed(&t.hits));
    let states = states.map(|s| ("never entered", s.state.clone()));
    states.chain(transitions.map(|t| ("never taken", t.name()))).collect()
}

/// The first place of each test's name.
pub fn places(results: &CampaignResults) -> BTreeMap<&TestName, usize> {
    results.tests.iter().enumerate().rev().map(|(i, t)| (&t.name, i)).collect()
}

/// What the campaign leaves unsaid, in sentences: requirements that are never decided, missed bins, inconclusive goals, missed code, errors.
pub fn gaps(results: &CampaignResults) -> Vec<String> {
    let mut gaps = Vec::new();
    errors(results, &mut gaps);
    never_decided(results, &mut gaps);
    unvalued(results, &mut gaps);
    missed_bins(results, &mut gaps);
    unreached_goals(results, &mut gaps);
    for machine in results.machines.iter().filter(|m| !is_whole(m)) {
        let ((states, all_states), (taken, all)) = (machine.states_reached(), machine.transitions_reached());
        gaps.push(format!(
            "{} of {all_states} states and {} of {all} transitions of the state machine {} were reached by no test.",
            all_states - states,
            all - taken,
            machine.machine
        ));
    }
    if let Some(first) = results.unreplayed.first() {
        gaps.push(format!(
            "{} cannot be replayed: {}.",
            text::count(results.unreplayed.len(), "test"),
            text::line(&first.why)
        ));
    }
    let alone = warnings(results).len();
    if alone > 0 {
        let verb = if alone == 1 { "was" } else { "were" };
        gaps.push(format!(
            "{} of the middleware {verb} used by one side only: whatever depends on them did not happen.",
            text::count(alone, "name")
        ));
    }
    let code = code(results);
    if code.lines < code.lines_total {
        gaps.push(format!(
            "{} of {} lines and {} of {} branches of the code were executed by no test.",
            code.lines_total - code.lines,
            code.lines_total,
            code.branches_total - code.branches,
            code.branches_total
        ));
    }
    gaps
}

fn unreached_goals(results: &CampaignResults, gaps: &mut Vec<String>) {
    for suite in &results.suites {
        let inconclusive = suite.goals.iter().filter(|g| g.status == GoalStatus::Inconclusive).count();
        if inconclusive > 0 {
            gaps.push(format!(
                "{} of {} stayed inconclusive: the search ended before it had an answer.",
                text::count(inconclusive, "goal"),
                suite.name
            ));
        }
    }
    for suite in &results.suites {
        let missed = suite.explanation.as_ref().map_or(0, |e| e.uncovered.len());
        if missed > 0 {
            let goals = suite.model.as_ref().map_or(missed, |m| m.goals);
            gaps.push(format!(
                "{missed} of {} of {} are reached by none of its tests in the model.",
                text::count(goals, "goal"),
                suite.name
            ));
        }
    }
}

fn errors(results: &CampaignResults, gaps: &mut Vec<String>) {
    let broken = results.tests.iter().filter(|t| t.error.is_some()).count();
    if broken > 0 {
        gaps.push(format!(
            "{} broke off in error: what they would have shown is not known.",
            text::count(broken, "test")
        ));
    }
}

/// Verdicts that are open since a number that they compare was none, with the first place of each requirement.
fn unvalued(results: &CampaignResults, gaps: &mut Vec<String>) {
    for (i, requirement) in results.requirements.iter().enumerate() {
        let open = results.tests.iter().filter_map(|t| {
            let verdict = t.judgement.verdicts.get(i).filter(|v| v.outcome == Outcome::Inconclusive)?;
            Some((t, verdict.unvalued?))
        });
        let open: Vec<(&TestResult, f64)> = open.collect();
        if let Some((test, at)) = open.first() {
            gaps.push(format!(
                "{} stayed inconclusive in {}, since it compares a number that is none (NaN, or a division by zero): \
                 first in {} at {}.",
                requirement.name,
                text::count(open.len(), "test"),
                test.name,
                text::moment(*at)
            ));
        }
    }
}

fn never_decided(results: &CampaignResults, gaps: &mut Vec<String>) {
    let checked = |t: &VerdictTally| t.pass + t.fail > 0;
    let never: Vec<String> = results
        .requirements
        .iter()
        .filter(|r| !r.tally.iter().any(checked))
        .map(|r| r.name.to_string())
        .collect();
    if !never.is_empty() {
        gaps.push(format!("{} neither passed nor failed in any test.", text::enumeration(&never)));
    }
    for (i, suite) in results.suites.iter().enumerate() {
        let here = |r: &&RequirementResult| {
            !r.tally.get(i).is_some_and(checked) && !never.contains(&r.name.to_string())
        };
        let names: Vec<String> =
            results.requirements.iter().filter(here).map(|r| r.name.to_string()).collect();
        if !names.is_empty() {
            gaps.push(format!("{} neither passed nor failed in {}.", text::enumeration(&names), suite.name));
        }
    }
}

fn missed_bins(results: &CampaignResults, gaps: &mut Vec<String>) {
    let named = |state: BinStatus| -> Vec<String> {
        results.bins.iter().filter(|b| BinStatus::of(b) == state).map(|b| format!("“{}”", b.bin)).collect()
    };
    let missed = named(BinStatus::Missed);
    if !missed.is_empty() {
        gaps.push(format!(
            "{} of {} bins were hit by no test: {}.",
            missed.len(),
            results.bins.len(),
            text::enumeration(&missed)
        ));
    }
    let refuted = named(BinStatus::Refuted);
    if !refuted.is_empty() {
        gaps.push(format!(
            "The model cannot reach {}, yet tests did: the model does not match what was tested.",
            text::enumeration(&refuted)
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said of a violation whose counterexample has these steps, in short.
    fn short_of(steps: &[(f64, &str)]) -> String {
        let step = |(at, (time, text)): (usize, &(f64, &str))| CounterexampleStep {
            step: at,
            time: *time,
            text: (*text).to_owned(),
        };
        let counterexample: Vec<CounterexampleStep> = steps.iter().enumerate().map(step).collect();
        let times: Vec<f64> = steps.iter().map(|(time, _)| *time).collect();
        let failure = FirstFailure {
            time: *times.last().unwrap(),
            triggered_at: times[0],
            deadline: false,
            counterexample,
            around: Vec::new(),
        };
        let verdict = VerdictResult {
            requirement: "R".into(),
            outcome: Outcome::Fail,
            triggered: 1,
            failures: 1,
            failure: None,
            worst_margin: Some((-0.5, "m".to_owned())),
            unvalued: None,
        };
        in_short(&verdict, &failure)
    }

    #[test]
    fn a_violated_comparison_of_several_signals_tells_the_last_sample_of_each() {
        let steps = [(0.0, "signal y = 0 m"), (3.0, "signal x = -1 m"), (3.0, "signal y = 2 m")];
        assert_eq!(short_of(&steps), "signal x = -1 m, y = 2 m");
        assert_eq!(short_of(&[(0.0, "signal y = 0 m"), (3.0, "signal y = 2 m")]), "signal y = 2 m");
    }

    #[test]
    fn what_compares_a_number_that_is_none_is_said_to() {
        let mut results = crate::fixture::campaign(4);
        let said = |results: &CampaignResults| gaps(results).into_iter().find(|g| g.contains("NaN"));
        assert_eq!(said(&results), None);
        for test in &mut results.tests[2..4] {
            let verdict = &mut test.judgement.verdicts[0];
            (verdict.outcome, verdict.unvalued) = (Outcome::Inconclusive, Some(1.5));
        }
        let (name, test) = (&results.requirements[0].name, &results.tests[2].name);
        let expected = format!(
            "{name} stayed inconclusive in 2 tests, since it compares a number that is none (NaN, or a division by zero): \
             first in {test} at 1.50 s."
        );
        assert_eq!(said(&results), Some(expected));
    }

    #[test]
    fn what_was_triggered_by_an_event_tells_it() {
        let steps = [(1.0, "robot offered"), (3.0, "signal y = 2 m")];
        assert_eq!(short_of(&steps), "signal y = 2 m, 2.00 s after robot offered");
        assert_eq!(short_of(&[(1.0, "robot closing")]), "robot closing, margin −0.500 m");
    }
}
