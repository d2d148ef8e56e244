//! Tests from a scenario: abstract ones by agents, by search or at random; then made concrete from a seed.
//!
//! # Steps
//!
//! 1. [`agents`], [`search`] and [`random`] make abstract tests: each the stimuli of the environment's actors, and the
//!    awaits and waits between them, with where it came from and the bins that the model predicts;
//! 2. equal abstract tests become one;
//! 3. [`concrete`] draws the second tier's values: test number n of a suite has seed n (Section "Experimental setup");
//! 4. [`write`] prints tests in the language.

mod agents;
mod concrete;
mod extract;
mod random;
mod search;
mod write;

use hrdsl_ir::{
    Program,
    suite::{Method, Suite},
    test::{Provenance, Test, TestStep},
};

pub use search::bin_goal;
pub use write::{step_text, write};

/// An abstract test: steps without samples.
#[derive(Clone, Debug, PartialEq)]
pub struct AbstractTest {
    pub steps: Vec<TestStep>,
    pub because: Vec<String>,
    pub predicts: Vec<String>,
}

/// What became of one goal of a suite by search.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct GoalReport {
    /// `bin human_robot.4 legs, bored`, `edge Robot: sense -> decide`
    pub goal: String,
    pub status: GoalStatus,
    /// For an unreachable goal, why; for an open one, which budget ran out.
    pub reason: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum GoalStatus {
    Reached,
    Unreachable,
    Open,
}

/// A generated suite.
#[derive(Clone, Debug)]
pub struct Generated {
    pub suite: String,
    pub method: &'static str,
    /// How many different abstract tests there are.
    pub abstract_tests: usize,
    pub tests: Vec<Test>,
    /// Of a suite by search: every goal's fate.
    pub goals: Vec<GoalReport>,
    /// What a user should know: runs left out, budgets that ran out.
    pub notes: Vec<String>,
}

/// Abstract tests with what there is to say about them.
#[derive(Default)]
pub struct Harvest {
    pub tests: Vec<AbstractTest>,
    pub goals: Vec<GoalReport>,
    pub notes: Vec<String>,
}

/// Makes the tests of a suite: `count` concrete tests, or as many as the suite says.
///
/// # Errors
/// A model that cannot be run, with the place.
pub fn generate(
    program: &Program,
    suite: &Suite,
    count: Option<u32>,
    seed: u64,
) -> Result<Generated, String> {
    let count = count.unwrap_or(suite.tests);
    let (method, mut harvest) = match &suite.method {
        Method::Agents { players, choose, explore } => {
            ("agents", agents::harvest(program, suite, players, choose, *explore, count, seed)?)
        }
        Method::Search { network, goals } => ("search", search::harvest(program, suite, *network, goals)?),
        Method::Random { .. } => ("random", random::harvest(program, suite, count, seed)?),
    };
    let different = distinct(std::mem::take(&mut harvest.tests));
    let tests = make_concrete(program, suite, method, &different, count, seed)?;
    Ok(Generated {
        suite: suite.name.clone(),
        method,
        abstract_tests: different.len(),
        tests,
        goals: harvest.goals,
        notes: harvest.notes,
    })
}

/// How many origins of one abstract test are written out.
const ORIGINS: usize = 3;

/// Equal abstract tests are one; the first keeps its place and takes over the others' reasons.
fn distinct(tests: Vec<AbstractTest>) -> Vec<AbstractTest> {
    let mut seen: indexmap::IndexMap<String, AbstractTest> = indexmap::IndexMap::new();
    for test in tests {
        let key = format!("{:?}", test.steps);
        match seen.entry(key) {
            indexmap::map::Entry::Vacant(slot) => {
                slot.insert(test);
            }
            indexmap::map::Entry::Occupied(mut slot) => {
                let known = slot.get_mut();
                for line in test.because {
                    if !known.because.contains(&line) {
                        known.because.push(line);
                    }
                }
            }
        }
    }
    let mut tests: Vec<AbstractTest> = seen.into_values().collect();
    for test in &mut tests {
        let more = test.because.len().saturating_sub(ORIGINS);
        if more > 0 {
            test.because.truncate(ORIGINS);
            test.because.push(format!("and {more} more that lead to the same test"));
        }
    }
    tests
}

/// Numbers and seeds the tests; abstract tests that are too few come again with other seeds.
fn make_concrete(
    program: &Program,
    suite: &Suite,
    method: &str,
    tests: &[AbstractTest],
    count: u32,
    seed: u64,
) -> Result<Vec<Test>, String> {
    let cycle = tests.iter().cycle().take(if tests.is_empty() { 0 } else { count as usize });
    cycle
        .zip(1u64..)
        .map(|(test, number)| {
            let seed = concrete::seed_of(seed, number);
            Ok(Test {
                name: format!("{}.{}.t{number:03}", program.name, suite.name),
                seed,
                provenance: Provenance {
                    suite: suite.name.clone(),
                    method: method.to_owned(),
                    because: test.because.clone(),
                    predicts: test.predicts.clone(),
                },
                steps: concrete::concretise(program, &test.steps, seed)?,
                origin: suite.origin,
            })
        })
        .collect()
}
