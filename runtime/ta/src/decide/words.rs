//! The words of answers: bounds, budgets, lengths.

use crate::{
    decide::extremum::{ExtremumLimit, ExtremumSide, ExtremumValue, MeasureExtremum},
    search::report::SearchCutoff,
    witness::{run::WitnessRun, trace::seconds},
};

pub(super) fn limit_text(e: &MeasureExtremum, side: ExtremumSide) -> String {
    let text = |q: &ExtremumValue| match q {
        ExtremumValue::Nanos(n) => format!("{} s", seconds(*n, 1)),
        ExtremumValue::Number(n) => n.to_string(),
    };
    let (closed, open) = if side == ExtremumSide::Sup { ("<=", "<") } else { (">=", ">") };
    match &e.limit {
        ExtremumLimit::At { value, attained } => {
            format!("{} {}", if *attained { closed } else { open }, text(value))
        }
        ExtremumLimit::Unbounded => "unbounded".to_owned(),
        ExtremumLimit::Nowhere => "the formula holds nowhere".to_owned(),
        ExtremumLimit::Inconclusive { seen: Some(q) } => format!("inconclusive; {} was seen", text(q)),
        ExtremumLimit::Inconclusive { seen: None } => "inconclusive".to_owned(),
    }
}

pub(super) fn used_up(what: SearchCutoff) -> String {
    let what = match what {
        SearchCutoff::States => "states",
        SearchCutoff::Memory => "memory",
        SearchCutoff::Stopped => return "the search was stopped".to_owned(),
        SearchCutoff::Zones => {
            return "undecided: the zones cannot tell, since clocks stand still, and no run was found"
                .to_owned();
        }
    };
    format!("the budget of {what} was used up")
}

pub(super) fn length(run: &WitnessRun) -> String {
    if run.steps.is_empty() && run.end == 0 {
        return "at the start".to_owned();
    }
    format!("after {} and {} s", count(run.steps.len(), "transition"), seconds(run.end, run.ticks))
}

pub(super) fn count(n: usize, of: &str) -> String {
    if n == 1 { format!("1 {of}") } else { format!("{n} {of}s") }
}
