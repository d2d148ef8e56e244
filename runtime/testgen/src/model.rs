//! What a suite by agents reached of its model, and why not the rest.

use hrdsl_bdi::coverage::{AgentTeam, place, universe};
use hrdsl_ir::{
    Program,
    abstract_test::{AbstractTest, ReachedGoals},
    bdi::AgentId,
    suite::{CoverItemKind, PlayerRef},
};
use hrdsl_results::{AgentCoverage, KindCoverage, SuiteGoalId, TestExplanation, TestName, UnreachedItem};

use crate::goals::agents;

/// What the agents' counts say, summed over all runs that count.
pub fn coverage(program: &Program, players: &[PlayerRef], team: &AgentTeam<'_>) -> Vec<AgentCoverage> {
    agents(program, players).into_iter().map(|(id, _)| of_agent(program, id, team)).collect()
}

fn of_agent(program: &Program, id: AgentId, team: &AgentTeam<'_>) -> AgentCoverage {
    let agent = &program.agents[usize::from(id.0)];
    let measured = team.measured.iter().find(|(a, _)| *a == id).map(|(_, m)| m);
    let items: Vec<_> =
        universe(agent).into_iter().map(|item| (item, measured.is_some_and(|m| m.reaches(item)))).collect();
    let kind = |kind: CoverItemKind| {
        let of_kind = || items.iter().filter(|(item, _)| item.kind() == kind);
        KindCoverage {
            kind,
            reached: of_kind().filter(|(_, reached)| *reached).count(),
            all: of_kind().count(),
        }
    };
    let unreached = items.iter().filter(|(_, reached)| !reached).map(|(item, _)| UnreachedItem {
        kind: item.kind(),
        item: SuiteGoalId::Item(item.kind(), place(program, agent, *item)),
        reason: team.why(id, *item),
    });
    AgentCoverage {
        agent: agent.name.clone(),
        kinds: CoverItemKind::ALL.into_iter().map(kind).collect(),
        unreached: unreached.collect(),
    }
}

/// What each test is for: `name` says what the first concrete test of an abstract one is called.
pub fn explained(
    tests: &[AbstractTest],
    goals: &[SuiteGoalId],
    name: impl Fn(usize) -> TestName,
) -> Vec<TestExplanation> {
    let mut how_many = vec![0usize; goals.len()];
    for goal in tests.iter().flat_map(|t| &t.reaches) {
        how_many[*goal] += 1;
    }
    let mut seen = ReachedGoals::new();
    let mut explained = Vec::new();
    for (index, test) in tests.iter().enumerate() {
        let named = |which: &dyn Fn(usize) -> bool| -> Vec<SuiteGoalId> {
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
        let goals: Vec<SuiteGoalId> = ["a", "b", "c", "d"].map(|q| SuiteGoalId::Query(q.into())).to_vec();
        let found =
            explained(&[test(&[0, 1]), test(&[1, 2]), test(&[2])], &goals, |i| format!("t{i}").into());
        let first: Vec<&[SuiteGoalId]> = found.iter().map(|t| t.first.as_slice()).collect();
        assert_eq!(first, [&goals[..2], &goals[2..3], &[]]);
        let only: Vec<&[SuiteGoalId]> = found.iter().map(|t| t.only.as_slice()).collect();
        assert_eq!(only, [&goals[..1], &[], &[]]);
        assert_eq!((found[1].test.as_str(), found[1].reaches), ("t1", 2));
    }
}
