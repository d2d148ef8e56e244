//! What a suite by agents is to reach, and what of it a model run reached.

use std::collections::BTreeSet;

use hrdsl_bdi::{
    coverage::{AgentTeam, items, place},
    measure::AgentCounts,
};
use hrdsl_coverage::TestCoverage;
use hrdsl_ir::{
    Program,
    abstract_test::ReachedGoals,
    bdi::{Agent, AgentId},
    cover_item::AgentGoal,
    coverage::{BinName, CrossId},
    suite::{ModelGoal, PlayerRef},
};
use hrdsl_results::SuiteGoalId;

use crate::bins;

/// The goals of a suite, each once, in the order in which the suite asks for them.
pub struct AgentGoals {
    pub all: Vec<AgentGoal>,
    pub ids: Vec<SuiteGoalId>,
}

/// The agents among the players.
pub fn agents<'p>(program: &'p Program, players: &[PlayerRef]) -> Vec<(AgentId, &'p Agent)> {
    let agent = |player: &PlayerRef| match player {
        PlayerRef::Agent(id) => Some((*id, program.agents.get(usize::from(id.0))?)),
        PlayerRef::Automaton(_) => None,
    };
    players.iter().filter_map(agent).collect()
}

impl AgentGoals {
    /// Without any: each plan, and each bin of each cross.
    #[must_use]
    pub fn of(program: &Program, players: &[PlayerRef], asked: &[ModelGoal]) -> Self {
        let crosses = (0u16..).zip(&program.coverage.crosses);
        let usual = std::iter::once(ModelGoal::Plans)
            .chain(crosses.map(|(cross, _)| ModelGoal::Bins(CrossId(cross))))
            .collect::<Vec<_>>();
        let asked = if asked.is_empty() { &usual } else { asked };
        let mut goals = Self { all: Vec::new(), ids: Vec::new() };
        let mut known = BTreeSet::new();
        for goal in asked {
            for (goal, id) in expand(program, players, *goal) {
                if known.insert(goal) {
                    goals.all.push(goal);
                    goals.ids.push(id);
                }
            }
        }
        goals
    }

    /// The goals that a run reached.
    #[must_use]
    pub fn reached(&self, measured: &[(AgentId, AgentCounts)], coverage: &TestCoverage) -> ReachedGoals {
        let is_reached = |goal: &AgentGoal| match goal {
            AgentGoal::Item(agent, item) => {
                measured.iter().any(|(a, counts)| a == agent && counts.reaches(*item))
            }
            AgentGoal::Bin(cross, bin) => {
                coverage.crosses.get(usize::from(*cross)).is_some_and(|bins| bins.contains(bin))
            }
        };
        self.all.iter().enumerate().filter(|(_, g)| is_reached(g)).map(|(i, _)| i).collect()
    }

    /// Why no run reached a goal. `seen` are the numbers that runs had for the coverpoints.
    #[must_use]
    pub fn why(&self, goal: usize, team: &AgentTeam<'_>, seen: &BTreeSet<Vec<i64>>) -> String {
        match self.all.get(goal) {
            Some(AgentGoal::Item(agent, item)) => team.why(*agent, *item),
            Some(AgentGoal::Bin(cross, bin)) => bins::why(&team.program.coverage, *cross, *bin, seen),
            None => "there is no such goal".to_owned(),
        }
    }
}

fn expand(program: &Program, players: &[PlayerRef], goal: ModelGoal) -> Vec<(AgentGoal, SuiteGoalId)> {
    match goal {
        ModelGoal::Bins(cross) => {
            let Some(declared) = program.coverage.crosses.get(usize::from(cross.0)) else {
                return Vec::new();
            };
            let bins = (0u16..).zip(&declared.bins);
            let named = bins.map(|(i, bin)| {
                (AgentGoal::Bin(cross.0, i), SuiteGoalId::Bin(BinName::new(&declared.name, &bin.name)))
            });
            named.collect()
        }
        ModelGoal::Plans
        | ModelGoal::Contexts
        | ModelGoal::Edges
        | ModelGoal::Messages
        | ModelGoal::Paths => {
            let of = |(id, agent): (AgentId, &Agent)| {
                let named = items(agent, goal)
                    .into_iter()
                    .map(|i| (AgentGoal::Item(id, i), SuiteGoalId::Item(i.kind(), place(program, agent, i))));
                named.collect::<Vec<_>>()
            };
            agents(program, players).into_iter().flat_map(of).collect()
        }
    }
}
