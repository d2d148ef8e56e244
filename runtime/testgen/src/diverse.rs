//! `diverse N`: further witnesses of each goal, chosen greedily by what they add.
//!
//! A witness **shows** edges that automata take, pairs of edges that an automaton takes one after the other, and events with their
//! arguments: outcomes. The next test is, of those that reach the goal and do something, the one that shows most edges that no
//! test shows that reaches the goal already; of several, most pairs; of several, most of what no test of the suite does; of several, the one whose
//! script is the farthest from all that reach the goal already, in steps to be changed, left out or put in (Levenshtein 1966); of
//! several, the first.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_ir::{
    abstract_test::AbstractTest,
    test::{TestScript, TestStep},
};
use hrdsl_ta::WitnessRun;

use crate::{
    covers::{ReachedItems, RunFlow},
    distinct::{TestIdentity, identity},
};

/// A further witness has at most so many transitions, if the first has so many: what wanders about would show most, and take
/// hours.
pub fn longest(first: usize) -> usize {
    2 * first + 8
}

/// Something that a run shows.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum RunFeature {
    /// Automaton and edge.
    Edge(usize, usize),
    /// Automaton and two edges, one after the other.
    Pair(usize, usize, usize),
    /// Event and arguments.
    Outcome(u16, Vec<(u8, u64)>),
}

impl RunFeature {
    fn is_edge(&self) -> bool {
        match self {
            Self::Edge(..) => true,
            Self::Pair(..) | Self::Outcome(..) => false,
        }
    }

    fn is_pair(&self) -> bool {
        match self {
            Self::Pair(..) => true,
            Self::Edge(..) | Self::Outcome(..) => false,
        }
    }
}

/// What a run shows.
pub fn features(seen: &ReachedItems, run: &WitnessRun) -> BTreeSet<RunFeature> {
    let RunFlow { edges, pairs } = seen.flow();
    let outcomes = run.steps.iter().filter_map(|step| step.event.as_ref());
    let outcomes = outcomes
        .map(|(event, args)| RunFeature::Outcome(event.0, args.iter().map(|arg| arg.key()).collect()));
    edges
        .iter()
        .map(|(automaton, edge)| RunFeature::Edge(*automaton, *edge))
        .chain(pairs.iter().map(|(automaton, first, second)| RunFeature::Pair(*automaton, *first, *second)))
        .chain(outcomes)
        .collect()
}

/// Witnesses besides those that the suite has anyway.
#[derive(Default)]
pub struct WitnessPool {
    /// Further tests, in the order in which they were found.
    pub spares: Vec<AbstractTest>,
    /// What the runs of the tests show, by the tests' scripts: of spares and of others.
    pub shows: BTreeMap<TestIdentity, BTreeSet<RunFeature>>,
}

impl WitnessPool {
    /// Notes what the run of a test shows.
    pub fn note(&mut self, test: &AbstractTest, features: BTreeSet<RunFeature>) {
        self.shows.entry(identity(&test.scripts)).or_default().extend(features);
    }

    /// As [`add_to`](Self::add_to), and says how many there were.
    pub fn added_to(&self, kept: &mut Vec<AbstractTest>, goals: usize, each: u32) -> String {
        let added = self.add_to(kept, goals, each);
        format!("{added} more of {} further witnesses, for up to {each} of each goal", self.spares.len())
    }

    /// Adds spares until each goal that the kept tests reach is reached by so many, and along so many different sets of edges, as far as
    /// there are different ones. A round gives every goal one more, so that what is cut off by a number of tests is the last
    /// round's.
    fn add_to(&self, kept: &mut Vec<AbstractTest>, goals: usize, each: u32) -> usize {
        let before = kept.len();
        let mut known: BTreeSet<TestIdentity> = kept.iter().map(|t| identity(&t.scripts)).collect();
        let mut shown: BTreeSet<&RunFeature> =
            known.iter().filter_map(|t| self.shows.get(t)).flatten().collect();
        for round in 2..=each {
            for goal in 0..goals {
                let have: Vec<&AbstractTest> = kept.iter().filter(|t| t.reaches.contains(&goal)).collect();
                let ways = self.ways(&have);
                if have.is_empty() || ways >= round as usize {
                    continue;
                }
                let Some((adds, next)) = self.next(goal, &have, &known, &shown) else { continue };
                if have.len() >= round as usize && adds.edges == 0 {
                    continue;
                }
                let id = identity(&next.scripts);
                shown.extend(self.features_of(&id));
                known.insert(id);
                kept.push(next.clone());
            }
        }
        kept.len() - before
    }

    /// What the run of a test shows.
    fn features_of<'a>(&'a self, id: &TestIdentity) -> impl Iterator<Item = &'a RunFeature> + use<'a> {
        self.shows.get(id).into_iter().flatten()
    }

    /// Along how many different sets of edges these tests go.
    fn ways(&self, tests: &[&AbstractTest]) -> usize {
        let edges = |test: &&AbstractTest| -> Vec<&RunFeature> {
            self.features_of(&identity(&test.scripts)).filter(|f| f.is_edge()).collect()
        };
        tests.iter().map(edges).collect::<BTreeSet<_>>().len()
    }

    fn next(
        &self,
        goal: usize,
        have: &[&AbstractTest],
        known: &BTreeSet<TestIdentity>,
        shown: &BTreeSet<&RunFeature>,
    ) -> Option<(AddedFeatures, &AbstractTest)> {
        let of_goal: BTreeSet<&RunFeature> =
            have.iter().flat_map(|t| self.features_of(&identity(&t.scripts))).collect();
        let mut best: Option<(AddedFeatures, &AbstractTest)> = None;
        for spare in self.spares.iter().filter(|t| t.reaches.contains(&goal) && does_something(t)) {
            let id = identity(&spare.scripts);
            if known.contains(&id) {
                continue;
            }
            let new = |of: fn(&RunFeature) -> bool| {
                self.features_of(&id).filter(|f| of(f) && !of_goal.contains(f)).count()
            };
            let adds = AddedFeatures {
                edges: new(RunFeature::is_edge),
                pairs: new(RunFeature::is_pair),
                of_suite: self.features_of(&id).filter(|f| !shown.contains(f)).count(),
                far: have.iter().map(|t| distance(&t.scripts, &spare.scripts)).min().unwrap_or(0),
            };
            if best.as_ref().is_none_or(|(most, _)| adds > *most) {
                best = Some((adds, spare));
            }
        }
        best
    }
}

/// What a further test of a goal adds; what is declared first counts first.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct AddedFeatures {
    /// Edges that no test of the goal takes.
    edges: usize,
    /// Pairs of edges that none of them takes one after the other.
    pairs: usize,
    /// Whatever no test of the suite shows.
    of_suite: usize,
    /// Steps to the nearest test of the goal.
    far: usize,
}

/// Whether anybody does anything in it: an empty test shows what the system does when it is left alone, and drives nothing.
fn does_something(test: &AbstractTest) -> bool {
    test.scripts.iter().any(|script| !script.steps.is_empty())
}

/// How many steps have to be changed, left out or put in.
fn distance(a: &[TestScript], b: &[TestScript]) -> usize {
    strsim::generic_levenshtein(&steps(a), &steps(b))
}

/// Each step by itself, with whose it is.
fn steps(scripts: &[TestScript]) -> Vec<TestIdentity> {
    let alone = |actor, step: &TestStep| identity(&[TestScript { actor, steps: vec![step.clone()] }]);
    scripts.iter().flat_map(|script| script.steps.iter().map(|step| alone(script.actor, step))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::test;

    /// Tests that wait so long, with the goals that they reach and the edges that they show.
    fn pool(all: &[(i64, &[usize], &[usize])]) -> (WitnessPool, Vec<AbstractTest>) {
        let mut pool = WitnessPool::default();
        let mut tests = Vec::new();
        for (wait, goals, edges) in all {
            let test = test(*wait, "w", goals);
            pool.note(&test, edges.iter().map(|e| RunFeature::Edge(0, *e)).collect());
            tests.push(test);
        }
        (pool, tests)
    }

    fn waits(tests: &[AbstractTest]) -> Vec<&TestStep> {
        tests.iter().map(|t| &t.scripts[0].steps[0]).collect()
    }

    #[test]
    fn what_adds_most_comes_next_and_nothing_comes_twice() {
        let (mut pool, mut tests) = pool(&[
            (1, &[0, 1], &[1]),
            (2, &[0], &[1, 2]),
            (3, &[0], &[2, 3, 4]),
            (4, &[1], &[1]),
            (5, &[2], &[9]),
        ]);
        pool.spares = tests.split_off(1);
        assert_eq!(pool.add_to(&mut tests.clone(), 3, 1), 0, "one of each is what there is");
        let mut two = tests.clone();
        assert_eq!(pool.add_to(&mut two, 3, 2), 2);
        let wait = |time| TestStep::Wait { time };
        assert_eq!(waits(&two), [&wait(1), &wait(3), &wait(4)]);
        let mut many = tests.clone();
        // Nobody has reached goal 2 of those that are kept, and there are no more different ones.
        assert_eq!(pool.add_to(&mut many, 3, 9), 3);
        assert_eq!(waits(&many), [&wait(1), &wait(3), &wait(4), &wait(2)]);
    }

    #[test]
    fn of_those_that_add_as_much_the_farther_one_comes_next() {
        let (mut pool, mut tests) = pool(&[(1, &[0], &[]), (2, &[0], &[])]);
        let mut far = test(1, "w", &[0]);
        far.scripts[0].steps.extend([TestStep::Wait { time: 7 }, TestStep::Wait { time: 8 }]);
        pool.spares = vec![tests.remove(1), far.clone()];
        assert_eq!(pool.add_to(&mut tests, 1, 2), 1);
        assert_eq!(tests[1], far);
    }

    #[test]
    fn other_edges_come_before_whatever_else_is_new_and_empty_tests_never() {
        let (mut pool, mut tests) = pool(&[(1, &[0], &[1]), (2, &[0], &[1]), (3, &[0], &[2])]);
        let outcomes = (0..9).map(|n| RunFeature::Outcome(n, Vec::new()));
        pool.note(&tests[1], outcomes.collect());
        let mut empty = test(1, "w", &[0]);
        empty.scripts.iter_mut().for_each(|script| script.steps.clear());
        pool.note(&empty, [RunFeature::Edge(0, 3)].into());
        pool.spares = [vec![empty], tests.split_off(1)].concat();
        assert_eq!(pool.add_to(&mut tests, 1, 9), 2);
        let wait = |time| TestStep::Wait { time };
        assert_eq!(waits(&tests), [&wait(1), &wait(3), &wait(2)]);
    }

    #[test]
    fn a_goal_of_many_tests_on_one_way_gets_another_way_and_no_other_values() {
        let (mut pool, mut tests) =
            pool(&[(1, &[0], &[1]), (2, &[0], &[1]), (3, &[0], &[1]), (4, &[0], &[2])]);
        pool.spares = tests.split_off(2);
        assert_eq!(pool.add_to(&mut tests, 1, 2), 1);
        assert_eq!(waits(&tests)[2], &TestStep::Wait { time: 4 });
    }
}
