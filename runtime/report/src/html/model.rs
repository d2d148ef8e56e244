//! The section about what of the models of suites by agents was reached.

use hrdsl_results::{AgentCoverage, Results, SuiteInfo};
use serde::Serialize;

use super::super::model::{kinds, of, ratio};

/// A suite by agents.
#[derive(Serialize)]
pub struct Model {
    suite: String,
    runs: usize,
    goals_reached: usize,
    goals: usize,
    columns: Vec<&'static str>,
    agents: Vec<Agent>,
    uncovered: Vec<Reason>,
}

#[derive(Serialize)]
struct Agent {
    name: String,
    cells: Vec<Cell>,
    unreached: Vec<Reason>,
}

#[derive(Serialize)]
struct Cell {
    text: String,
    /// Whether something was not reached.
    is_gap: bool,
}

#[derive(Serialize)]
struct Reason {
    name: String,
    reason: String,
}

/// All suites of which model coverage is known.
pub fn all(results: &Results) -> Vec<Model> {
    results.suites.iter().filter_map(model).collect()
}

fn model(suite: &SuiteInfo) -> Option<Model> {
    let coverage = suite.model.as_ref()?;
    let kinds = kinds(coverage);
    let agent = |agent: &AgentCoverage| {
        let cell = |kind| {
            let tally = of(agent, kind);
            Cell { text: ratio(tally), is_gap: tally.reached < tally.all }
        };
        let unreached = agent.unreached.iter();
        Agent {
            name: agent.agent.clone(),
            cells: kinds.iter().copied().map(cell).collect(),
            unreached: unreached
                .map(|u| Reason { name: u.item.to_string(), reason: u.reason.clone() })
                .collect(),
        }
    };
    let uncovered = suite.explanation.iter().flat_map(|e| &e.uncovered);
    Some(Model {
        suite: suite.name.to_string(),
        runs: coverage.runs,
        goals_reached: coverage.goals_reached,
        goals: coverage.goals,
        columns: kinds.iter().map(|k| k.title()).collect(),
        agents: coverage.agents.iter().map(agent).collect(),
        uncovered: uncovered.map(|u| Reason { name: u.goal.to_string(), reason: u.reason.clone() }).collect(),
    })
}
