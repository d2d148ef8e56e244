//! How often each requirement was triggered, and how near it was to being violated.

use hrdsl_results::{CampaignResults, RequirementResult, VerdictResult};

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
    let verdicts = results.tests.iter().flat_map(|test| &test.judgement.verdicts);
    let own: Vec<&VerdictResult> = verdicts.filter(|v| v.requirement == requirement.name).collect();
    let total: u64 = own.iter().map(|v| u64::from(v.triggered)).sum();
    let tests = own.iter().filter(|v| v.triggered > 0).count();
    let standing = facts::standing(requirement);
    let name = format!("{} {:<names$}", standing.symbol(), text::line(&requirement.name));
    let times = if total == 1 { "once".to_owned() } else { format!("{total} times") };
    let of = format!("  in {tests} of {}", text::count(own.len(), "test"));
    let margin = requirement.worst_margin.as_ref().map_or_else(String::new, |least| {
        let test = text::line(facts::short(results, &least.test));
        format!("  least margin {} in {test}", text::margin(least.value, &least.unit))
    });
    let style = if total == 0 { TerminalStyle::Warn } else { TerminalStyle::Plain };
    page.line(&[
        StyledSpan(name, TerminalStyle::of(standing)),
        right(&times, 16, style),
        left(&of, 22, TerminalStyle::Plain),
        StyledSpan(margin, TerminalStyle::Plain),
    ]);
}
