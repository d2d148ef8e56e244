//! How often each requirement was triggered, and how near it was to being violated.

use hrdsl_results::{CampaignResults, RequirementResult, TestResult, TriggerTotal};

use super::page::{StyledSpan, TerminalPage, TerminalStyle, left, right};
use crate::{
    facts::{self, ShownOutcome},
    text,
};

/// For each requirement the triggers in all tests, in how many tests there was one, and the least margin with its test: on at most `width` columns,
/// with ANSI colours if `color`.
#[must_use]
pub fn trigger_totals(results: &CampaignResults, width: usize, color: bool) -> String {
    let mut page = TerminalPage::new(width, color);
    if results.requirements.is_empty() {
        return page.out;
    }
    page.out.push('\n');
    page.line(&[
        StyledSpan("Triggers".into(), TerminalStyle::Bold),
        StyledSpan("  of each requirement, in all tests".into(), TerminalStyle::Dim),
    ]);
    let names = results.requirements.iter().map(|r| text::line(&r.name).chars().count()).max().unwrap_or(0);
    for requirement in &results.requirements {
        line(&mut page, results, requirement, names);
    }
    page.out
}

fn line(page: &mut TerminalPage, results: &CampaignResults, requirement: &RequirementResult, names: usize) {
    // Results of earlier versions do not have the total.
    let total = TriggerTotal::of(&requirement.name, &results.tests);
    let judged = |test: &&TestResult| {
        test.judgement.verdicts.iter().any(|verdict| verdict.requirement == requirement.name)
    };
    let all = results.tests.iter().filter(judged).count();
    let standing = facts::standing(requirement);
    let name = format!("{} {:<names$}", standing.symbol(), text::line(&requirement.name));
    let times = if total.times == 1 { "once".to_owned() } else { format!("{} times", total.times) };
    let of = format!("  in {} of {}", total.tests, text::count(all, "test"));
    let margin = requirement.worst_margin.as_ref().map_or_else(String::new, |least| {
        let test = text::line(facts::short(results, &least.test));
        format!("  least margin {} in {test}", text::margin(least.value, &least.unit))
    });
    let style = if total.times == 0 { TerminalStyle::Warn } else { TerminalStyle::Plain };
    page.line(&[
        StyledSpan(name, TerminalStyle::of(standing)),
        right(&times, 16, style),
        left(&of, 22, TerminalStyle::Plain),
        StyledSpan(margin, TerminalStyle::Plain),
    ]);
}
