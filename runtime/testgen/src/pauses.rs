//! `reach each bound` of suites by agents: each pause of a test a little shorter, and a little longer.
//!
//! How long an agent waits is written in its plans, and is the only time that it chooses. Pauses are the same if they are as
//! long, come after the same await, and before the same stimulus: the first test with one stands for all.

use std::collections::BTreeSet;

use hrdsl_ir::{
    Nanos, Program,
    abstract_test::AbstractTest,
    test::{TestScript, TestStep},
};

use crate::{
    bounds::BoundSide,
    distinct::{TestIdentity, identity},
    write,
};

/// Adds the tests beside the pauses of these, and says how many they are.
pub fn added_to(program: &Program, tests: &mut Vec<AbstractTest>, step: Nanos) -> String {
    let beside = beside(program, tests, step);
    let said = format!("{} tests with a pause {} shorter or longer", beside.len(), write::time_text(step));
    tests.extend(beside);
    said
}

/// The tests beside the pauses of these, two of each pause that is longer than the step.
fn beside(program: &Program, tests: &[AbstractTest], step: Nanos) -> Vec<AbstractTest> {
    let mut known: BTreeSet<TestIdentity> = tests.iter().map(|t| identity(&t.scripts)).collect();
    let mut pauses: BTreeSet<TestIdentity> = BTreeSet::new();
    let mut made = Vec::new();
    for test in tests {
        for (at, script) in test.scripts.iter().enumerate() {
            for (place, pair) in script.steps.windows(2).enumerate() {
                let [TestStep::Wait { time }, next @ TestStep::Do { .. }] = pair else { continue };
                if *time <= step || !pauses.insert(pause(script, place)) {
                    continue;
                }
                for side in [BoundSide::Before, BoundSide::After] {
                    let beside = moved(program, test, (at, place), (*time, next), (side, step));
                    if known.insert(identity(&beside.scripts)) {
                        made.push(beside);
                    }
                }
            }
        }
    }
    made
}

/// What makes a pause what it is: the last await before it, itself, and what follows.
fn pause(script: &TestScript, place: usize) -> TestIdentity {
    let awaited = script.steps[..place].iter().rev().find(|step| matches!(step, TestStep::Await { .. }));
    let steps = awaited.into_iter().chain(&script.steps[place..place + 2]).cloned().collect();
    identity(&[TestScript { actor: script.actor, steps }])
}

/// The same test with that pause shorter, or longer. What its run would be is not known.
fn moved(
    program: &Program,
    test: &AbstractTest,
    (at, place): (usize, usize),
    (time, next): (Nanos, &TestStep),
    (side, step): (BoundSide, Nanos),
) -> AbstractTest {
    let mut scripts = test.scripts.clone();
    let to = if side == BoundSide::Before { time - step } else { time + step };
    scripts[at].steps[place] = TestStep::Wait { time: to };
    let pause = format!("{} before {}", write::time_text(time), write::step_text(program, next));
    let because =
        test.because.iter().take(1).cloned().chain([format!("{} the pause of {pause}", side.words())]);
    AbstractTest {
        scripts,
        because: because.collect(),
        origin: test.origin.clone(),
        ..AbstractTest::default()
    }
}
