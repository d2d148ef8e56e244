//! `diverse N`: further witnesses of each goal, chosen greedily by what they add.
//!
//! A witness **shows** edges that automata take, pairs of edges that an automaton takes one after the other, and events with their
//! arguments: outcomes. The next test is, of those that reach the goal, the one that shows most of what no test before it does;
//! of several, the one whose script is the farthest from all that reach the goal already, in steps to be changed, left out or
//! put in (Levenshtein 1966); of several, the first.

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

    /// Adds spares until each goal that the kept tests reach is reached by so many, as far as there are different ones. A round
    /// gives every goal one more, so that what is cut off by a number of tests is the last round's.
    fn add_to(&self, kept: &mut Vec<AbstractTest>, goals: usize, each: u32) -> usize {
        let before = kept.len();
        let mut known: BTreeSet<TestIdentity> = kept.iter().map(|t| identity(&t.scripts)).collect();
        let mut shown: BTreeSet<&RunFeature> =
            known.iter().filter_map(|t| self.shows.get(t)).flatten().collect();
        for round in 2..=each {
            for goal in 0..goals {
                let have: Vec<&AbstractTest> = kept.iter().filter(|t| t.reaches.contains(&goal)).collect();
                if have.is_empty() || have.len() >= round as usize {
                    continue;
                }
                let Some(next) = self.next(goal, &have, &known, &shown) else { continue };
                let id = identity(&next.scripts);
                shown.extend(self.shows.get(&id).into_iter().flatten());
                known.insert(id);
                kept.push(next.clone());
            }
        }
        kept.len() - before
    }

    fn next(
        &self,
        goal: usize,
        have: &[&AbstractTest],
        known: &BTreeSet<TestIdentity>,
        shown: &BTreeSet<&RunFeature>,
    ) -> Option<&AbstractTest> {
        let mut best: Option<((usize, usize), &AbstractTest)> = None;
        for spare in self.spares.iter().filter(|t| t.reaches.contains(&goal)) {
            let id = identity(&spare.scripts);
            if known.contains(&id) {
                continue;
            }
            let adds = self.shows.get(&id).map_or(0, |f| f.iter().filter(|f| !shown.contains(f)).count());
            let far = have.iter().map(|t| distance(&t.scripts, &spare.scripts)).min().unwrap_or(0);
            if best.is_none_or(|(most, _)| (adds, far) > most) {
                best = Some(((adds, far), spare));
            }
        }
        best.map(|(_, spare)| spare)
    }
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
}
