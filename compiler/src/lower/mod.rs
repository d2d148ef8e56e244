//! [`Scenario`] → [`Program`]: what the two have in common goes over as it is, with slots for names; one file for each thing
//! that has a form of its own. Nothing here can fail: the checker has seen to it.

pub mod expr;
pub mod monitor;
pub mod query;
pub mod system;
pub mod ta;
pub mod world;

use hrdsl_ir::{Program, coverage::Coverage};
use hrdsl_model::Scenario;
use hrdsl_source::SourceFiles;

use expr::local;

/// Lowers a scenario without errors. `files` gives the text of requirements.
#[must_use]
pub fn lower(scenario: &Scenario, files: &SourceFiles) -> Program {
    let mut signals = world::SignalTable::declared(scenario);
    let world = scenario.world.as_ref().map(|w| world::world(w, &scenario.device_kinds, &mut signals));
    let monitors = scenario.requirements.iter().map(|r| monitor::monitor(r, files, &mut signals)).collect();
    let systems = scenario.systems.iter().map(|s| system::system(s, &mut signals)).collect();
    let automata: Vec<_> = scenario.automata.iter().map(|a| ta::automaton(a, scenario)).collect();
    Program {
        name: scenario.name.clone(),
        actors: scenario.actors.clone(),
        events: scenario.events.iter().map(|e| e.lower(&local)).collect(),
        provenance: scenario.provenance.clone(),
        agents: scenario.agents.iter().map(|a| a.lower(&local)).collect(),
        contents: scenario.contents.clone(),
        shared: scenario.shared.clone(),
        clocks: scenario.clocks.clone(),
        channels: scenario.channels.clone(),
        queries: scenario.queries.iter().map(|q| query::query(q, scenario, &automata, files)).collect(),
        functions: scenario.functions.iter().map(|f| ta::function(f, scenario, &automata)).collect(),
        suites: scenario.suites.iter().map(|s| query::suite(s, scenario, &automata, files)).collect(),
        automata,
        networks: scenario.networks.clone(),
        signals: signals.into_list(),
        monitors,
        assumptions: scenario.assumptions.iter().map(|a| monitor::assumption(a, files)).collect(),
        coverage: Coverage { points: scenario.points.clone(), crosses: scenario.crosses.clone() },
        tests: scenario.tests.clone(),
        world,
        systems,
    }
}
