//! What is told of the system besides its code: its state machines, and its names on the middleware.

use hrdsl_results::{CampaignResults, MachineResult};

use super::page::{StyledSpan, TerminalPage, TerminalStyle};
use crate::{facts, text};

/// States and transitions that are listed for a machine, at most.
const UNREACHED: usize = 8;
/// Names of the middleware that are listed, at most.
const WARNINGS: usize = 12;

/// A line for each state machine, then what of it was not reached.
pub fn machines(page: &mut TerminalPage, results: &CampaignResults) {
    if !results.machines.is_empty() {
        page.out.push('\n');
    }
    for machine in &results.machines {
        let style = if facts::is_whole(machine) { TerminalStyle::Good } else { TerminalStyle::Warn };
        page.line(&[
            StyledSpan(format!("State machine {}", text::line(&machine.machine)), TerminalStyle::Bold),
            StyledSpan(format!("  {}", facts::machine_in_short(machine)), style),
        ]);
        unreached(page, machine);
    }
}

fn unreached(page: &mut TerminalPage, machine: &MachineResult) {
    let missed = facts::unreached(machine);
    for (what, name) in missed.iter().take(UNREACHED) {
        page.line(&[
            StyledSpan("○ ".into(), TerminalStyle::Warn),
            StyledSpan(format!("{what}  "), TerminalStyle::Dim),
            StyledSpan(text::line(name), TerminalStyle::Plain),
        ]);
    }
    if missed.len() > UNREACHED {
        page.line(&[StyledSpan(format!("  and {} more", missed.len() - UNREACHED), TerminalStyle::Dim)]);
    }
}

/// Names of the middleware at which somebody was alone in every test, with what to add to the binding.
pub fn interfaces(page: &mut TerminalPage, results: &CampaignResults) {
    let warnings = facts::warnings(results);
    if warnings.is_empty() {
        return;
    }
    page.out.push('\n');
    page.line(&[
        StyledSpan("Interfaces".into(), TerminalStyle::Bold),
        StyledSpan("  where nobody met in any test".into(), TerminalStyle::Dim),
    ]);
    for warning in warnings.iter().take(WARNINGS) {
        let tests = format!("  {}", text::count(warning.tests as usize, "test"));
        let room = page.width.saturating_sub(2 + tests.chars().count());
        page.line(&[
            StyledSpan("! ".into(), TerminalStyle::Warn),
            StyledSpan(text::cut(&text::line(&warning.sentence()), room), TerminalStyle::Plain),
            StyledSpan(tests, TerminalStyle::Dim),
        ]);
        if let Some(advice) = warning.advice() {
            page.whole(&format!("  {}", text::line(&advice)));
        }
    }
    if warnings.len() > WARNINGS {
        page.line(&[StyledSpan(format!("  and {} more", warnings.len() - WARNINGS), TerminalStyle::Dim)]);
    }
}
