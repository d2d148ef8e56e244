//! The section about what of the models of suites by agents was reached.

use hrdsl_results::{AgentCoverage, CampaignResults, SuiteInfo};
use serde::Serialize;

use super::super::model::{kinds, of, ratio};

/// A suite by agents.
#[derive(Serialize)]
pub struct AgentSuiteSection {
    suite: String,
    runs: usize,
    goals_reached: usize,
    goals: usize,
    columns: Vec<&'static str>,
    agents: Vec<AgentRow>,
    uncovered: Vec<UncoveredReason>,
}

#[derive(Serialize)]
struct AgentRow {
    name: String,
    cells: Vec<CoverageCell>,
    unreached: Vec<UncoveredReason>,
}

#[derive(Serialize)]
struct CoverageCell {
    text: String,
    /// Whether something was not reached.
    is_gap: bool,
}

#[derive(Serialize)]
struct UncoveredReason {
    name: String,
    reason: String,
}

/// All suites of which model coverage is known.
pub fn all(results: &CampaignResults) -> Vec<AgentSuiteSection> {
    results.suites.iter().filter_map(model).collect()
}

fn model(suite: &SuiteInfo) -> Option<AgentSuiteSection> {
    let coverage = suite.model.as_ref()?;
    let kinds = kinds(coverage);
    let agent = |agent: &AgentCoverage| {
        let cell = |kind| {
            let tally = of(agent, kind);
            CoverageCell { text: ratio(tally), is_gap: tally.reached < tally.all }
        };
        let unreached = agent.unreached.iter();
        AgentRow {
            name: agent.agent.clone(),
            cells: kinds.iter().copied().map(cell).collect(),
            unreached: unreached
                .map(|u| UncoveredReason { name: u.item.to_string(), reason: u.reason.clone() })
                .collect(),
        }
    };
    let uncovered = suite.explanation.iter().flat_map(|e| &e.uncovered);
    Some(AgentSuiteSection {
        suite: suite.name.to_string(),
        runs: coverage.runs,
        goals_reached: coverage.goals_reached,
        goals: coverage.goals,
        columns: kinds.iter().map(|k| k.title()).collect(),
        agents: coverage.agents.iter().map(agent).collect(),
        uncovered: uncovered
            .map(|u| UncoveredReason { name: u.goal.to_string(), reason: u.reason.clone() })
            .collect(),
    })
}
