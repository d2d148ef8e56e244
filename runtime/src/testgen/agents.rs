//! Tests by agents: the multi-agent system is run once for each chosen set of beliefs, in virtual time.

use hrdsl_bdi::choose::{explore, factors};
use hrdsl_ir::{
    Program,
    suite::{Choice, Explore, PlayerRef, Suite},
};
use rayon::prelude::*;

use super::{AbstractTest, Harvest, extract};
use crate::harness::{AgentPlayer, AutomatonPlayer, Ended, Harness, Player};

/// Runs the agents for each set of beliefs and takes the environment's part of each run.
///
/// # Errors
/// A choice that has no alternatives, or a model that cannot be run.
pub fn harvest(
    program: &Program,
    suite: &Suite,
    players: &[PlayerRef],
    choose: &[Choice],
    how: Explore,
    count: u32,
    seed: u64,
) -> Result<Harvest, String> {
    let factors = factors(program, choose).map_err(|e| format!("suite `{}`: {e}", suite.name))?;
    let explored = explore(&factors, how, count, seed);
    let awaits = extract::Awaits::of(program, players);
    let runs: Vec<Result<Option<AbstractTest>, String>> = explored
        .sets
        .par_iter()
        .map(|set| {
            let harness = Harness::new(program, cast(program, players, &set.facts), None, suite.horizon);
            let run = harness.run();
            if let Ended::Fault(fault) = run.ended {
                return Err(format!("suite `{}`, with {}: {fault}", suite.name, set.text.join(", ")));
            }
            if !extract::keeps_assumptions(program, &run.trace) {
                return Ok(None);
            }
            Ok(Some(AbstractTest {
                steps: extract::steps(program, &awaits, &run.trace, suite.patience),
                because: vec![set.text.join(", ")],
                predicts: extract::predicted(program, &run.trace),
            }))
        })
        .collect();
    let mut harvest = Harvest::default();
    let mut left_out = 0;
    for run in runs {
        match run? {
            Some(test) => harvest.tests.push(test),
            None => left_out += 1,
        }
    }
    if left_out > 0 {
        harvest
            .notes
            .push(format!("{left_out} belief sets led to a run that breaks an assumption and were left out"));
    }
    harvest.notes.push(format!("{} of {} belief sets were run", explored.sets.len(), explored.space));
    if explored.cut {
        harvest.notes.push("a limit cut the exploration short".to_owned());
    }
    Ok(harvest)
}

fn cast<'p>(
    program: &'p Program,
    players: &[PlayerRef],
    facts: &[(hrdsl_ir::bdi::AgentId, hrdsl_ir::bdi::Fact)],
) -> Vec<Box<dyn Player + 'p>> {
    let play = |player: &PlayerRef| -> Box<dyn Player + 'p> {
        match player {
            PlayerRef::Agent(agent) => {
                let own = facts.iter().filter(|(a, _)| a == agent).map(|(_, f)| f.clone());
                Box::new(AgentPlayer::new(program, *agent, &own.collect::<Vec<_>>(), 0))
            }
            PlayerRef::Automaton(automaton) => Box::new(AutomatonPlayer::new(program, *automaton)),
        }
    };
    players.iter().map(play).collect()
}
