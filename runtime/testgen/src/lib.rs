//! Tests from a scenario: abstract ones by agents, by search or at random; then made concrete from a seed.
//!
//! # Steps
//!
//! 1. [`agents`], [`search`] and [`random`] make abstract tests: each the stimuli of the environment's actors, and the
//!    awaits and waits between them, with where it came from and the bins that the model predicts;
//! 2. [equal](distinct) abstract tests become one, and [`mod@minimise`] keeps those that are needed for the suite's [`goals`];
//! 3. [`concrete`] draws the second tier's values: test number n of a suite has the seed s · 10⁶ + n, where s is that of the generation;
//! 4. [`model`] says what of the agents' programs was reached, what each test is for, and why goals stayed uncovered;
//! 5. [`write()`] prints tests in the language.
#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod agents;
mod bins;
mod bounds;
mod combinations;
mod concrete;
mod covers;
mod cut;
mod distinct;
mod diverse;
mod expand;
mod extract;
mod flow;
mod goals;
mod minimise;
mod model;
pub mod model_run;
mod named;
mod pauses;
mod random;
mod search;
mod slots;
mod times;
mod ways;
mod write;

use hrdsl_ir::{
    Nanos, Program,
    abstract_test::AbstractTest,
    suite::{DelayChoice, Suite, SuiteMethod, WitnessKind},
    test::{Test, TestMethod, TestProvenance, TestScript, TestStep},
};
use hrdsl_prove::ProofOptions;
use hrdsl_results::{
    AbstractTests, AgentFindings, GeneratedSuite, GoalReport, GoalStatus, SuiteExplanation, TestName,
    UncoveredGoal,
};

use diverse::WitnessPool;

pub use bounds::{BoundFinding, BoundFindings, BoundSide, boundary_step, decided as bound_findings};

pub use agents::{belief_set, how_many_sets};
pub use concrete::seed_of;
pub use write::{step_lines, write};

/// How tests are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GenerateOptions {
    /// How many concrete tests, instead of what the suite says.
    pub count: Option<u32>,
    /// Everything random comes from it.
    pub seed: u64,
    /// Whether to keep only the tests that are needed, instead of what the suite says.
    pub minimise: Option<bool>,
    /// Of a suite by search: which witnesses are taken, instead of what the suite says.
    pub witness: Option<WitnessKind>,
    pub delays: Option<DelayChoice>,
    /// Of a suite by search: how it searches; its witnesses and seed do not count.
    pub search: ProofOptions,
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
) -> Result<GeneratedSuite, String> {
    generate_with(program, suite, GenerateOptions { count, seed, ..GenerateOptions::default() })
}

/// The most tests of one suite: all of them are held in memory, and written to one file.
pub const MAX_TESTS: u32 = 20_000;

/// The abstract tests of a suite, before any of them goes.
struct SuiteHarvest {
    method: TestMethod,
    abstract_tests: AbstractTests,
    /// Whether only those are kept that are needed.
    minimise: bool,
    /// The tuples that the sets of agents are to have, and the sets that lead to each of the different tests.
    tuples: Option<(hrdsl_bdi::choose::SetTuples, Vec<Vec<u64>>)>,
    /// Of a search: further witnesses, and how many of each goal are kept.
    spares: Option<(WitnessPool, u32)>,
    /// Of agents: how much shorter and longer pauses are made, too.
    pauses: Option<Nanos>,
}

fn harvested(
    program: &Program,
    suite: &Suite,
    options: GenerateOptions,
    most: u32,
) -> Result<SuiteHarvest, String> {
    let GenerateOptions { seed, minimise, .. } = options;
    let (mut tuples, mut spares, mut pauses) = (None, None, None);
    let (method, abstract_tests, minimise) = match &suite.method {
        SuiteMethod::Agents { minimise: said, bounds, .. } => {
            pauses = bounds.map(|step| bounds::boundary_step(program, step));
            let (harvest, of) = agents::harvest(program, suite, most, seed)?;
            let minimise = minimise.unwrap_or(*said);
            // Who asks for the tests that the goals need does not ask for all tuples.
            tuples = of.filter(|_| !minimise).map(|of| (of, distinct::sets(&harvest.tests)));
            (TestMethod::Agents, harvest, minimise)
        }
        SuiteMethod::Search { network, goals, witness, delays, diverse } => {
            let settings = ProofOptions {
                witness: options.witness.unwrap_or(*witness),
                delays: options.delays.unwrap_or(*delays),
                seed,
                keep_first: true,
                ..options.search
            };
            let each = diverse.unwrap_or(1);
            let (harvest, pool) = search::harvest(program, suite, (*network, goals), &settings, each)?;
            spares = Some((pool, each)).filter(|_| each > 1);
            (TestMethod::Search, harvest, true)
        }
        SuiteMethod::Random { .. } => {
            (TestMethod::Random, random::harvest(program, suite, most, seed)?, false)
        }
    };
    Ok(SuiteHarvest { method, abstract_tests, minimise, tuples, spares, pauses })
}

/// Makes the tests of a suite.
///
/// # Errors
/// A model that cannot be run, with the place.
pub fn generate_with(
    program: &Program,
    suite: &Suite,
    options: GenerateOptions,
) -> Result<GeneratedSuite, String> {
    let GenerateOptions { count, seed, .. } = options;
    let most = count.unwrap_or(suite.settings.tests);
    if most > MAX_TESTS {
        return Err(format!("{most} tests are more than are generated for one suite: at most {MAX_TESTS}"));
    }
    let SuiteHarvest { method, abstract_tests, minimise, tuples, spares, pauses } =
        harvested(program, suite, options, most)?;
    let AbstractTests { tests, mut goals, mut notes, found } = abstract_tests;
    let mut different = distinct::distinct(tests);
    let mut number = most;
    if minimise {
        let keep = minimise::minimised(&different);
        notes.push(format!("{} of {} abstract tests are needed", keep.len(), different.len()));
        different = keep.into_iter().map(|i| different[i].clone()).collect();
        // One of each will do, unless a number was asked for. Those of a search are made concrete again, with other seeds.
        if method != TestMethod::Search {
            number = count.unwrap_or(most.min(u32::try_from(different.len()).unwrap_or(u32::MAX)));
        }
    }
    notes.extend(spares.map(|(pool, each)| pool.added_to(&mut different, goals.len(), each)));
    let usual = different.len();
    if let Some(step) = pauses {
        notes.push(pauses::added_to(program, &mut different, step));
        // They come besides what the suite asks for.
        let more = u32::try_from(different.len() - usual).unwrap_or(u32::MAX);
        number = count.unwrap_or(number.saturating_add(more).min(MAX_TESTS));
    }
    let tests = make_concrete(program, suite, method, &different, number, seed)?;
    let made = &different[..different.len().min(number as usize)];
    let origins = different.iter().cycle().take(tests.len()).filter_map(|t| t.origin.clone()).collect();
    name_tests(suite, made, &mut goals);
    let with_sets = made.len().min(usual);
    let lost_tuples = tuples.and_then(|(of, sets)| cut::lost(&of, &sets, with_sets));
    notes.extend(lost_tuples.map(|lost| cut::warning(lost, with_sets)));
    let explanation = found.as_ref().map(|found| explain(found, made, suite));
    Ok(GeneratedSuite {
        suite: suite.name.clone(),
        method,
        abstract_tests: different.len(),
        tests,
        origins,
        goals,
        coverage: found.map(|found| found.coverage),
        explanation,
        lost_tuples,
        notes,
    })
}

fn explain(found: &AgentFindings, made: &[AbstractTest], suite: &Suite) -> SuiteExplanation {
    let name = |index: usize| test_name(suite, index as u64 + 1);
    let is_reached = |goal: usize| made.iter().any(|t| t.reaches.contains(&goal));
    let open = (0..found.goals.len()).filter(|goal| !is_reached(*goal));
    let uncovered = open.map(|goal| UncoveredGoal {
        goal: found.goals[goal].clone(),
        reason: match found.reasons[goal].as_str() {
            "" => format!("only tests beyond the first {} reach it", made.len()),
            reason => reason.to_owned(),
        },
    });
    SuiteExplanation { tests: model::explained(made, &found.goals, name), uncovered: uncovered.collect() }
}

/// Says of each goal of a search which test is the first to reach it.
fn name_tests(suite: &Suite, made: &[AbstractTest], goals: &mut [GoalReport]) {
    for (at, goal) in goals.iter_mut().enumerate().filter(|(_, g)| g.status == GoalStatus::Reached) {
        let first = made.iter().position(|t| t.reaches.contains(&at));
        goal.test = first.map(|index| test_name(suite, index as u64 + 1));
    }
}

/// `SUITE.t001`
fn test_name(suite: &Suite, number: u64) -> TestName {
    format!("{}.t{number:03}", suite.name).into()
}

/// Numbers and seeds the tests; abstract tests that are too few come again with other seeds.
fn make_concrete(
    program: &Program,
    suite: &Suite,
    method: TestMethod,
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
                name: format!("{}.{}", program.name, test_name(suite, number)),
                seed,
                provenance: TestProvenance {
                    suite: suite.name.clone(),
                    method,
                    because: test.because.clone(),
                    predicts: test.predicts.clone(),
                },
                scripts: warmed_up(suite, concrete::concretise(program, &test.scripts, seed)?),
                origin: suite.origin,
            })
        })
        .collect()
}

fn warmed_up(suite: &Suite, mut scripts: Vec<TestScript>) -> Vec<TestScript> {
    let time = suite.settings.warmup;
    if time > 0 {
        scripts.iter_mut().for_each(|script| script.steps.insert(0, TestStep::Wait { time }));
    }
    scripts
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{Span, ta::NetworkId};
    use hrdsl_results::{ModelCoverage, SuiteGoalId};

    use super::*;

    pub fn test(wait: i64, because: &str, reaches: &[usize]) -> AbstractTest {
        AbstractTest {
            scripts: TestScript::of_all(vec![TestStep::Wait { time: wait }]),
            because: vec![because.into()],
            reaches: reaches.iter().copied().collect(),
            ..AbstractTest::default()
        }
    }

    #[test]
    fn goals_that_only_tests_left_out_reach_are_uncovered() {
        let suite = Suite {
            name: "s".into(),
            method: SuiteMethod::Search {
                network: NetworkId(0),
                goals: vec![],
                witness: hrdsl_ir::suite::WitnessKind::default(),
                delays: hrdsl_ir::suite::DelayChoice::default(),
                diverse: None,
            },
            settings: hrdsl_ir::suite::SuiteSettings {
                tests: 1,
                ..hrdsl_ir::suite::SuiteSettings::default()
            },
            origin: Span::default(),
        };
        let goal = |name: &str| SuiteGoalId::Query(name.into());
        let found = AgentFindings {
            goals: ["g0", "g1", "g2"].map(goal).to_vec(),
            reasons: ["", "", "it cannot be"].map(String::from).to_vec(),
            coverage: ModelCoverage::default(),
        };
        let said = explain(&found, &[test(1, "a", &[0])], &suite);
        assert_eq!(said.tests[0].test, "s.t001");
        assert_eq!((&said.tests[0].first, &said.tests[0].only), (&vec![goal("g0")], &vec![goal("g0")]));
        let uncovered = |name: &str, reason: &str| UncoveredGoal { goal: goal(name), reason: reason.into() };
        assert_eq!(
            said.uncovered,
            [uncovered("g1", "only tests beyond the first 1 reach it"), uncovered("g2", "it cannot be")]
        );
    }
}
