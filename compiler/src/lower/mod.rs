//! [`Scenario`] → [`Program`]: one file for each concern. Nothing here can fail: the checker has seen to it.

pub mod bdi;
pub mod coverage;
pub mod expr;
pub mod function;
pub mod monitor;
pub mod query;
pub mod suite;
pub mod ta;
pub mod test;
pub mod vocabulary;
pub mod world;

use hrdsl_ir::Program;
use hrdsl_model::Scenario;
use hrdsl_source::Files;

/// Lowers a scenario without errors. `files` gives the text of requirements.
#[must_use]
pub fn lower(scenario: &Scenario, files: &Files) -> Program {
    let mut signals = world::Signals::declared(scenario);
    let world = scenario.world.as_ref().map(|w| world::world(w, &mut signals));
    let monitors = scenario.requirements.iter().map(|r| monitor::monitor(r, files, &mut signals)).collect();
    let automata: Vec<_> = scenario.automata.iter().map(|a| ta::automaton(a, scenario)).collect();
    Program {
        name: scenario.name.clone(),
        actors: vocabulary::actors(scenario),
        events: vocabulary::events(scenario),
        agents: scenario.agents.iter().map(bdi::agent).collect(),
        contents: scenario.contents.iter().map(bdi::content).collect(),
        shared: scenario.shared.iter().map(ta::var).collect(),
        clocks: scenario.clocks.iter().map(|c| c.name.clone()).collect(),
        channels: scenario.channels.iter().map(ta::channel).collect(),
        queries: scenario.queries.iter().map(|q| query::query(q, scenario, &automata, files)).collect(),
        functions: scenario.functions.iter().map(|f| function::function(f, scenario, &automata)).collect(),
        automata,
        networks: scenario.networks.iter().map(ta::network).collect(),
        signals: signals.into_list(),
        monitors,
        assumptions: scenario.assumptions.iter().map(|a| monitor::assumption(a, files)).collect(),
        coverage: coverage::coverage(scenario),
        suites: scenario.suites.iter().map(suite::suite).collect(),
        tests: scenario.tests.iter().map(|t| test::test(t, &scenario.name)).collect(),
        world,
        system: scenario.system.as_ref().map(vocabulary::system),
    }
}
