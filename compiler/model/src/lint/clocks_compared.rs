//! HR0508: edges and invariants that compare two clocks, in a network in which some location stops a clock: nothing can be asked of it.

use hrdsl_source::{Diagnostic, DiagnosticCode, Span};

use super::facts::ScenarioFacts;
use crate::{Scenario, TypedAutomaton, TypedClockConstraint};

pub(crate) fn check<'a>(scenario: &'a Scenario, _: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    for network in &scenario.networks {
        let Some(stops) = scenario.stopping_location(network) else { continue };
        for span in scenario.members(network).flat_map(comparing) {
            let message = format!(
                "two clocks are compared in the network `{}`, in which `{stops}` stops one",
                network.name
            );
            issues.push(
                Diagnostic::warning(DiagnosticCode::CLOCKS_COMPARED, span, message)
                    .here("what zones say of a difference relies on clocks that all run")
                    .help("compare each of them with a time, or do without `stopped`: nothing can be asked of such a network"),
            );
        }
    }
}

/// The edges and locations that compare two clocks.
fn comparing(automaton: &TypedAutomaton) -> impl Iterator<Item = Span> {
    let two = |all: &[TypedClockConstraint]| all.iter().any(|c| c.minus.is_some());
    let locations = automaton.locations.iter().filter(move |l| two(&l.invariant)).map(|l| l.origin);
    let edges = automaton.edges.iter().filter(move |e| two(&e.clock_guard)).map(|e| e.origin);
    locations.chain(edges)
}
