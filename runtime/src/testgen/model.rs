//! What a suite by agents reached of its model, and why not the rest.

use hrdsl_bdi::coverage::{Kind, Team, name, universe};
use hrdsl_ir::{Program, bdi::AgentId, suite::PlayerRef};
use serde::Serialize;

use super::{
    AbstractTest,
    goals::{Reached, agents},
};

/// What the runs of a suite's agents reached of their programs.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ModelCoverage {
    /// Runs that count.
    pub runs: usize,
    /// The suite's goals: how many were reached, and how many there are.
    pub goals_reached: usize,
    pub goals: usize,
    pub agents: Vec<AgentCoverage>,
}

/// What was reached of an agent.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AgentCoverage {
    pub agent: String,
    /// One for each [`Kind`], in order.
    pub kinds: Vec<KindCoverage>,
    pub unreached: Vec<Unreached>,
}

/// Items of a kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct KindCoverage {
    pub kind: Kind,
    pub reached: usize,
    pub all: usize,
}

/// An item that no run reached.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Unreached {
    pub kind: Kind,
    /// `plan Human.leg#2 failed`
    pub item: String,
    pub reason: String,
}

/// What each test of a suite is for, and why goals stayed uncovered.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Explanation {
    /// One for each abstract test that was made concrete, in order.
    pub tests: Vec<TestExplanation>,
    /// The goals that no test reaches.
    pub uncovered: Vec<Uncovered>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TestExplanation {
    /// The first concrete test made of it.
    pub test: String,
    /// The belief sets that it came from.
    pub because: Vec<String>,
    /// How many goals it reaches.
    pub reaches: usize,
    /// The goals that no test before it reaches.
    pub first: Vec<String>,
    /// Those that no other test reaches.
    pub only: Vec<String>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Uncovered {
    pub goal: String,
    pub reason: String,
}

/// What the agents' counts say, summed over all runs that count.
pub fn coverage(program: &Program, players: &[PlayerRef], team: &Team<'_>) -> Vec<AgentCoverage> {
    agents(program, players).into_iter().map(|(id, _)| of_agent(program, id, team)).collect()
}

fn of_agent(program: &Program, id: AgentId, team: &Team<'_>) -> AgentCoverage {
    let agent = &program.agents[usize::from(id.0)];
    let measured = team.measured.iter().find(|(a, _)| *a == id).map(|(_, m)| m);
    let items: Vec<_> = universe(agent)
        .into_iter()
        .map(|item| (item, measured.is_some_and(|m| item.is_reached(m))))
        .collect();
    let kind = |kind: Kind| {
        let of_kind = || items.iter().filter(|(item, _)| item.kind() == kind);
        KindCoverage {
            kind,
            reached: of_kind().filter(|(_, reached)| *reached).count(),
            all: of_kind().count(),
        }
    };
    let unreached = items.iter().filter(|(_, reached)| !reached).map(|(item, _)| Unreached {
        kind: item.kind(),
        item: name(program, agent, *item),
        reason: team.why(id, *item),
    });
    AgentCoverage {
        agent: agent.name.clone(),
        kinds: Kind::ALL.into_iter().map(kind).collect(),
        unreached: unreached.collect(),
    }
}

/// What each test is for: `name` says what the first concrete test of an abstract one is called.
pub fn explained(
    tests: &[AbstractTest],
    goals: &[String],
    name: impl Fn(usize) -> String,
) -> Vec<TestExplanation> {
    let mut how_many = vec![0usize; goals.len()];
    for goal in tests.iter().flat_map(|t| &t.reaches) {
        how_many[*goal] += 1;
    }
    let mut seen = Reached::new();
    let mut explained = Vec::new();
    for (index, test) in tests.iter().enumerate() {
        let named = |which: &dyn Fn(usize) -> bool| -> Vec<String> {
            test.reaches.iter().filter(|g| which(**g)).map(|g| goals[*g].clone()).collect()
        };
        explained.push(TestExplanation {
            test: name(index),
            because: test.because.clone(),
            reaches: test.reaches.len(),
            first: named(&|g| !seen.contains(&g)),
            only: named(&|g| how_many[g] == 1),
        });
        seen.extend(&test.reaches);
    }
    explained
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_and_only_are_told_apart() {
        let test = |goals: &[usize]| AbstractTest {
            reaches: goals.iter().copied().collect(),
            ..AbstractTest::default()
        };
        let goals: Vec<String> = ["a", "b", "c", "d"].map(String::from).to_vec();
        let found = explained(&[test(&[0, 1]), test(&[1, 2]), test(&[2])], &goals, |i| format!("t{i}"));
        let first: Vec<&[String]> = found.iter().map(|t| t.first.as_slice()).collect();
        assert_eq!(first, [&goals[..2], &goals[2..3], &[]]);
        let only: Vec<&[String]> = found.iter().map(|t| t.only.as_slice()).collect();
        assert_eq!(only, [&goals[..1], &[], &[]]);
        assert_eq!((found[1].test.as_str(), found[1].reaches), ("t1", 2));
    }
}
