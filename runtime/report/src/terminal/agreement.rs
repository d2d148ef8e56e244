//! Where model and code differ: predictions that were not kept, and runs that do not conform.

use hrdsl_results::{CampaignResults, ConformanceOutcome, PredictionOutcome, TestResult};

use super::page::{StyledSpan, TerminalPage, TerminalStyle};
use crate::{facts, text};

/// Tests that departed from their model that are listed, at most.
const DEPARTURES: usize = 3;

/// The tests that went another way than the model of their suite said.
pub fn predictions(page: &mut TerminalPage, results: &CampaignResults) {
    let verdicts = || results.tests.iter().filter_map(|t| t.prediction.as_ref().map(|p| (t, p)));
    let number = |outcome| verdicts().filter(|(_, p)| p.outcome == outcome).count();
    let (kept, left) = (number(PredictionOutcome::Kept), number(PredictionOutcome::Left));
    if kept + left == 0 {
        return;
    }
    let said = format!("kept by {kept} of {}", text::count(kept + left, "test"));
    heading(page, "Predictions", said, left > 0);
    let departures = verdicts().filter_map(|(test, p)| p.departure(&test.steps).map(|how| (test, how)));
    list(page, results, departures);
}

/// The tests in which the code did what its model cannot do.
pub fn conformance(page: &mut TerminalPage, results: &CampaignResults) {
    let has = |test: &TestResult, outcome| test.judgement.conformance.iter().any(|c| c.outcome == outcome);
    let held: Vec<&TestResult> =
        results.tests.iter().filter(|t| !t.judgement.conformance.is_empty()).collect();
    if held.is_empty() {
        return;
    }
    let departs = held.iter().filter(|t| has(t, ConformanceOutcome::Departs)).count();
    let unknown = held
        .iter()
        .filter(|t| !has(t, ConformanceOutcome::Departs) && has(t, ConformanceOutcome::Inconclusive));
    let unknown = unknown.count();
    let conform = held.len() - departs - unknown;
    let open = if unknown > 0 { format!(", {unknown} inconclusive") } else { String::new() };
    let said = format!("to the model in {conform} of {}{open}", text::count(held.len(), "test"));
    heading(page, "Conformance", said, departs > 0);
    let first = |test: &&TestResult, outcome| {
        let of = |c: &&hrdsl_results::ConformanceVerdict| c.outcome == outcome;
        test.judgement.conformance.iter().find(of).and_then(hrdsl_results::ConformanceVerdict::sentence)
    };
    // Why nothing can be said is told where there is nothing else.
    let told = if departs > 0 { ConformanceOutcome::Departs } else { ConformanceOutcome::Inconclusive };
    list(page, results, held.iter().filter_map(|test| first(test, told).map(|how| (*test, how))));
}

fn heading(page: &mut TerminalPage, what: &str, said: String, differs: bool) {
    let style = if differs { TerminalStyle::Warn } else { TerminalStyle::Dim };
    page.out.push('\n');
    page.line(&[StyledSpan(what.into(), TerminalStyle::Bold), StyledSpan(format!("  {said}"), style)]);
}

fn list<'r>(
    page: &mut TerminalPage,
    results: &CampaignResults,
    departures: impl Iterator<Item = (&'r TestResult, String)>,
) {
    let mut more = 0;
    for (number, (test, how)) in departures.enumerate() {
        if number >= DEPARTURES {
            more += 1;
            continue;
        }
        let name = text::line(facts::short(results, &test.name));
        page.line(&[
            StyledSpan("○ ".into(), TerminalStyle::Warn),
            StyledSpan(format!("{}  ", text::cut(&name, page.width / 3)), TerminalStyle::Plain),
            StyledSpan(text::line(&how), TerminalStyle::Plain),
        ]);
    }
    if more > 0 {
        page.line(&[StyledSpan(format!("  and {more} more"), TerminalStyle::Dim)]);
    }
}
