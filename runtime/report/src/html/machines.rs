//! The section about the system's state machines.

use hrdsl_results::{CampaignResults, MachineResult, TestName};
use serde::Serialize;

use super::{
    drawing::{MachineDrawing, drawing},
    pieces::TestLink,
};
use crate::facts;

#[derive(Serialize)]
pub struct MachineSection {
    name: String,
    in_short: String,
    is_whole: bool,
    outcomes: Vec<String>,
    drawing: Option<MachineDrawing>,
    states: Vec<MachineRow>,
    transitions: Vec<MachineRow>,
}

/// A state, or a transition.
#[derive(Serialize)]
struct MachineRow {
    /// Of a state, its label; of a transition, the state that it leaves.
    from: String,
    outcome: String,
    to: String,
    /// For each suite.
    hits: Vec<u32>,
    total: u32,
    first: Option<TestLink>,
}

/// All machines, in order.
pub fn all(results: &CampaignResults, link: &dyn Fn(&TestName) -> TestLink) -> Vec<MachineSection> {
    let row = |[from, outcome, to]: [&str; 3], hits: &[u32], first: &Option<TestName>| MachineRow {
        from: from.to_owned(),
        outcome: outcome.to_owned(),
        to: to.to_owned(),
        hits: hits.to_vec(),
        total: hits.iter().sum(),
        first: first.as_ref().map(link),
    };
    let section = |machine: &MachineResult| MachineSection {
        name: machine.machine.clone(),
        in_short: facts::machine_in_short(machine),
        is_whole: facts::is_whole(machine),
        outcomes: machine.outcomes.clone(),
        drawing: drawing(machine),
        states: machine.states.iter().map(|s| row([&s.state, "", ""], &s.hits, &s.first)).collect(),
        transitions: machine
            .transitions
            .iter()
            .map(|t| row([&t.from, &t.outcome, &t.to], &t.hits, &t.first))
            .collect(),
    };
    results.machines.iter().map(section).collect()
}
