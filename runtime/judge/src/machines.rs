//! State machines over all tests: what they consist of, and how many tests reached what of it.

use std::collections::BTreeMap;

use hrdsl_results::{MachineResult, MachineStateResult, MachineTransitionResult, TestName};

use crate::tally::{FinishedTest, count_one};

/// The machines that the tests declared, in the order in which they did. `suite` says where a test's suite stands, of so many.
pub(crate) fn machines(
    tests: &[FinishedTest],
    suites: usize,
    suite: impl Fn(&FinishedTest) -> usize,
) -> Vec<MachineResult> {
    let mut campaign = CampaignMachines { suites, ..CampaignMachines::default() };
    for test in tests {
        campaign.declare(test);
    }
    for test in tests {
        campaign.count(test, suite(test));
    }
    campaign.machines
}

#[derive(Default)]
struct CampaignMachines {
    suites: usize,
    machines: Vec<MachineResult>,
    /// Where each machine stands, and in it each state and transition, by names.
    places: BTreeMap<String, ItemPlaces>,
}

#[derive(Default)]
struct ItemPlaces {
    machine: usize,
    states: BTreeMap<String, usize>,
    transitions: BTreeMap<String, usize>,
}

impl CampaignMachines {
    fn declare(&mut self, test: &FinishedTest) {
        for declared in &test.machines {
            let next = self.machines.len();
            let places = self.places.entry(declared.machine.clone()).or_insert_with(|| {
                self.machines
                    .push(MachineResult { machine: declared.machine.clone(), ..MachineResult::default() });
                ItemPlaces { machine: next, ..ItemPlaces::default() }
            });
            let Some(machine) = self.machines.get_mut(places.machine) else { continue };
            let hits = || vec![0; self.suites];
            for state in &declared.states {
                places.states.entry(state.clone()).or_insert_with(|| {
                    machine.states.push(MachineStateResult {
                        state: state.clone(),
                        hits: hits(),
                        first: None,
                    });
                    machine.states.len() - 1
                });
            }
            for edge in &declared.transitions {
                places.transitions.entry(edge.to_string()).or_insert_with(|| {
                    machine.transitions.push(MachineTransitionResult {
                        from: edge.from.clone(),
                        outcome: edge.outcome.clone(),
                        to: edge.to.clone(),
                        hits: hits(),
                        first: None,
                    });
                    machine.transitions.len() - 1
                });
            }
            for outcome in &declared.outcomes {
                if !machine.outcomes.contains(outcome) {
                    machine.outcomes.push(outcome.clone());
                }
            }
        }
    }

    fn count(&mut self, test: &FinishedTest, suite: usize) {
        for reached in &test.result.judgement.machines {
            let Some(places) = self.places.get(&reached.machine) else { continue };
            let Some(machine) = self.machines.get_mut(places.machine) else { continue };
            for state in reached.states.iter().filter_map(|s| places.states.get(s)) {
                if let Some(MachineStateResult { hits, first, .. }) = machine.states.get_mut(*state) {
                    hit(hits, first, suite, &test.result.name);
                }
            }
            for transition in reached.transitions.iter().filter_map(|t| places.transitions.get(t)) {
                let found = machine.transitions.get_mut(*transition);
                if let Some(MachineTransitionResult { hits, first, .. }) = found {
                    hit(hits, first, suite, &test.result.name);
                }
            }
        }
    }
}

/// One more test. The first is so by the alphabet: the same whatever the order of the tests.
fn hit(hits: &mut [u32], first: &mut Option<TestName>, suite: usize, test: &TestName) {
    count_one(hits, suite);
    if first.as_ref().is_none_or(|first| test < first) {
        *first = Some(test.clone());
    }
}

#[cfg(test)]
mod tests {

    use hrdsl_results::{MachineCoverage, TestResult, TraceJudgement};
    use hrdsl_trace::{MachineDeclaration, MachineEdge};

    use super::*;

    fn test(name: &str, entered: &[&str], taken: &[&str]) -> FinishedTest {
        let edge = |[from, outcome, to]: [&str; 3]| MachineEdge {
            from: from.into(),
            outcome: outcome.into(),
            to: to.into(),
        };
        let declared = MachineDeclaration {
            machine: "M".into(),
            states: vec!["A".into(), "B".into()],
            transitions: vec![edge(["A", "go", "B"]), edge(["B", "back", "A"])],
            outcomes: Vec::new(),
        };
        let texts = |all: &[&str]| all.iter().map(|s| (*s).to_owned()).collect();
        let reached =
            MachineCoverage { machine: "M".into(), states: texts(entered), transitions: texts(taken) };
        let judgement = TraceJudgement { machines: vec![reached], ..TraceJudgement::default() };
        let result = TestResult { name: name.into(), judgement, ..TestResult::default() };
        FinishedTest { result, machines: vec![declared], ..FinishedTest::default() }
    }

    #[test]
    fn tests_are_counted_for_each_suite() {
        let tests = [test("b", &["A", "B"], &["A -go-> B"]), test("a", &["A"], &[]), test("c", &["A"], &[])];
        let all = machines(&tests, 2, |t| usize::from(t.result.name == "c"));
        assert_eq!(all.len(), 1);
        assert_eq!((all[0].states_reached(), all[0].transitions_reached()), ((2, 2), (1, 2)));
        let states: Vec<_> =
            all[0].states.iter().map(|s| (s.state.as_str(), s.hits.clone(), s.first.as_deref())).collect();
        assert_eq!(states, [("A", vec![2, 1], Some("a")), ("B", vec![1, 0], Some("b"))]);
        let transitions: Vec<_> =
            all[0].transitions.iter().map(|t| (t.name(), t.hits.clone(), t.first.as_deref())).collect();
        let go = ("A -go-> B".to_owned(), vec![1, 0], Some("b"));
        assert_eq!(transitions, [go, ("B -back-> A".to_owned(), vec![0, 0], None)]);
    }
}
