//! The one place that knows the engine: asks it, and compares its answers with the regions.

use hrdsl_ir::{Program, ta::LocationId};
use hrdsl_ta::{Budget, Error, Goal, GoalKind, ModelError, Outcome, check};

use crate::oracle::{Graph, Limits, explore};

const LIMITS: Limits = Limits { states: 20_000, bound: 4, differences: false };

/// What the engine says otherwise than the regions. `Err`: the regions cannot say.
pub fn disagreement(p: &Program) -> Result<Option<String>, String> {
    let graph = explore(p, &p.networks[0], LIMITS)?;
    Ok(reachability(p, &graph).err())
}

fn goals(p: &Program) -> Vec<Goal> {
    let mut goals = Vec::new();
    for (automaton, id) in p.networks[0].automata.iter().enumerate() {
        let a = &p.automata[usize::from(id.0)];
        let locations =
            (0..a.locations.len()).map(|l| GoalKind::Location { automaton, location: LocationId(l as u16) });
        let edges = (0..a.edges.len()).map(|edge| GoalKind::Edge { automaton, edge });
        goals.extend(locations.chain(edges).map(|what| Goal { what, settled: false }));
    }
    goals
}

fn reachability(p: &Program, graph: &Graph) -> Result<(), String> {
    let goals = goals(p);
    let found = check(p, &p.networks[0], &goals, &[], &[], Budget::default());
    let report = match found {
        Err(Error::Model { error: ModelError::Initial, .. }) if !graph.starts => return Ok(()),
        Err(Error::Model { .. }) if !graph.faults.is_empty() => return Ok(()),
        Err(error) => return Err(format!("the engine alone: {error:?}")),
        Ok(_) if !graph.starts => return Err("the engine starts".to_owned()),
        Ok(report) => report,
    };
    let locations = graph.locations();
    for (goal, outcome) in goals.iter().zip(&report.goals) {
        let expected = match &goal.what {
            GoalKind::Location { automaton, location } => locations.contains(&(*automaton, location.0)),
            GoalKind::Edge { automaton, edge } => graph.edges.contains_key(&(*automaton, *edge)),
            GoalKind::Condition(_) => unreachable!(),
        };
        match outcome {
            Outcome::Reached(w) if !expected => {
                return Err(format!("{goal:?} is not reachable: {}", w.text(p, &p.networks[0])));
            }
            Outcome::Unreachable if expected => return Err(format!("{goal:?} is reachable")),
            Outcome::Unreachable if !graph.faults.is_empty() => {
                return Err(format!("a fault is not told: {:?}", graph.faults[0]));
            }
            Outcome::Reached(_) | Outcome::Unreachable => {}
            Outcome::Open(_) => return Err("the budget is used up".to_owned()),
        }
    }
    Ok(())
}
