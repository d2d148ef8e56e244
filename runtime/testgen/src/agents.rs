//! Tests by agents: the multi-agent system is run once for each chosen set of beliefs, in virtual time.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_bdi::{
    choose::{BeliefExplorer, SetTuples, factors},
    coverage::AgentTeam,
    measure::AgentCounts,
};
use hrdsl_harness::RunTermination;
use hrdsl_ir::{
    Program,
    abstract_test::{AbstractTest, BeliefSet, ReachedGoals, TestOrigin},
    bdi::AgentId,
    suite::{ExploreMode, PlayerRef, Suite, SuiteMethod},
};
use hrdsl_results::{AbstractTests, AgentFindings, ModelCoverage};
use rayon::prelude::*;

use crate::{
    concrete, extract,
    goals::{AgentGoals, agents},
    model,
    model_run::{LogDetail, ModelRun, ModelRunOptions, model_run},
};

/// Different warnings of runs that are told, at most.
const WARNINGS: usize = 20;

/// Runs the agents for each set of beliefs and takes the environment's part of each run; also gives the tuples of the sets.
///
/// # Errors
/// A choice that has no alternatives, or a model that cannot be run.
pub fn harvest(
    program: &Program,
    suite: &Suite,
    count: u32,
    seed: u64,
) -> Result<(AbstractTests, Option<SetTuples>), String> {
    let SuiteMethod::Agents { players, stop_after, goals, .. } = &suite.method else {
        return Err(not_by_agents(suite));
    };
    let mut explorer = explorer(program, suite, count, seed)?;
    let awaits = extract::AwaitGroups::of(program, players);
    let goals = AgentGoals::of(program, players, goals);
    let model = AgentRunInput { program, suite, players, awaits, goals: &goals, seed };
    let mut sum = AgentRunTally::new(program, players, *stop_after);
    while !sum.is_over() {
        let batch = explorer.next_batch();
        if batch.is_empty() {
            break;
        }
        let rewards = run_batch(&model, &mut sum, batch)?;
        explorer.learn(&rewards);
    }
    Ok((sum.harvest(&model, &explorer), explorer.tuples))
}

fn not_by_agents(suite: &Suite) -> String {
    format!("suite `{}` is not by agents", suite.name)
}

/// What a suite by agents tries, within the conditions of its choices: whoever speaks of a set by its number means these.
fn explorer<'p>(
    program: &'p Program,
    suite: &'p Suite,
    count: u32,
    seed: u64,
) -> Result<BeliefExplorer<'p>, String> {
    let SuiteMethod::Agents { players, choose, explore, .. } = &suite.method else {
        return Err(not_by_agents(suite));
    };
    let fault = |e| format!("suite `{}`: {e}", suite.name);
    let factors = factors(program, choose).map_err(fault)?;
    let ids: Vec<AgentId> = agents(program, players).into_iter().map(|(id, _)| id).collect();
    BeliefExplorer::of(program, &ids, choose, &factors, (*explore, count, seed)).map_err(fault)
}

/// Runs the agents with each set, all at once, and adds up what that brought, in the order of the sets.
fn run_batch(
    model: &AgentRunInput<'_>,
    sum: &mut AgentRunTally,
    batch: Vec<BeliefSet>,
) -> Result<Vec<u32>, String> {
    // Sets are numbered from 1.
    let numbered: Vec<(u64, BeliefSet)> = (sum.sets + 1..).zip(batch).collect();
    let runs: Vec<Result<AgentRunOutcome, String>> =
        numbered.par_iter().map(|(number, set)| model.run(*number, set)).collect();
    let mut rewards = Vec::new();
    for run in runs {
        if sum.is_over() {
            break;
        }
        rewards.push(sum.add(run?));
    }
    Ok(rewards)
}

/// The belief set of this number, from 1, of a suite by agents; `count` and `seed` are those of its generation. Only a
/// suite that learns has to be run for it.
///
/// # Errors
/// A suite of another method, a choice without alternatives, a number that is too high, or a model that cannot be run.
pub fn belief_set(
    program: &Program,
    suite: &Suite,
    count: Option<u32>,
    seed: u64,
    number: u64,
) -> Result<BeliefSet, String> {
    let SuiteMethod::Agents { players, explore, stop_after, goals, .. } = &suite.method else {
        return Err(not_by_agents(suite));
    };
    let mut explorer = explorer(program, suite, count.unwrap_or(suite.settings.tests), seed)?;
    let awaits = extract::AwaitGroups::of(program, players);
    let goals = AgentGoals::of(program, players, goals);
    let model = AgentRunInput { program, suite, players, awaits, goals: &goals, seed };
    let mut sum = AgentRunTally::new(program, players, *stop_after);
    let mut made = 0;
    loop {
        let mut batch = explorer.next_batch();
        if batch.is_empty() || sum.is_over() || number == 0 {
            let end = format!("suite `{}` has no belief set {number}", suite.name);
            return Err(if number == 0 { end } else { format!("{end}: it has {made}") });
        }
        let here = usize::try_from(number - made - 1).unwrap_or(usize::MAX);
        if here < batch.len() {
            return Ok(batch.swap_remove(here));
        }
        made += batch.len() as u64;
        if *explore == ExploreMode::Learn {
            let rewards = run_batch(&model, &mut sum, batch)?;
            explorer.learn(&rewards);
        }
    }
}

/// How many belief sets are tried for a suite by agents, at most, and how many there are.
///
/// # Errors
/// A suite of another method, or a choice without alternatives.
pub fn how_many_sets(
    program: &Program,
    suite: &Suite,
    count: Option<u32>,
    seed: u64,
) -> Result<(usize, u128), String> {
    let explorer = explorer(program, suite, count.unwrap_or(suite.settings.tests), seed)?;
    Ok((explorer.left(), explorer.space))
}

/// What is the same for all runs.
struct AgentRunInput<'a> {
    program: &'a Program,
    suite: &'a Suite,
    players: &'a [PlayerRef],
    awaits: extract::AwaitGroups,
    goals: &'a AgentGoals,
    seed: u64,
}

/// What a run brought.
struct AgentRunOutcome {
    test: AbstractTest,
    measured: Vec<(AgentId, AgentCounts)>,
    /// Of the coverpoints.
    numbers: Vec<i64>,
    warnings: Vec<String>,
    keeps_assumptions: bool,
}

impl AgentRunInput<'_> {
    /// Runs the agents with a set of beliefs; `number` is its place among all sets.
    fn run(&self, number: u64, set: &BeliefSet) -> Result<AgentRunOutcome, String> {
        let seed = concrete::seed_of(self.seed, number);
        let ModelRun { trace, ended, measured, warnings, .. } = model_run(
            self.program,
            self.players,
            &set.facts,
            &ModelRunOptions::new(seed, self.suite.settings.horizon, LogDetail::Failures),
        );
        if let RunTermination::Fault(fault) = ended {
            return Err(format!("suite `{}`, with {}: {fault}", self.suite.name, set.text.join(", ")));
        }
        let covered = extract::covered(self.program, &trace);
        let test = AbstractTest {
            scripts: extract::scripts(self.program, &self.awaits, &trace, self.suite.settings.patience),
            because: vec![set.text.join(", ")],
            predicts: covered.cross_names(&self.program.coverage),
            reaches: self.goals.reached(&measured, &covered),
            origin: Some(TestOrigin { number, beliefs: set.clone() }),
        };
        let keeps_assumptions = extract::keeps_assumptions(self.program, &trace);
        Ok(AgentRunOutcome { test, measured, numbers: covered.numbers, warnings, keeps_assumptions })
    }
}

/// What all runs brought, in the order of their sets.
struct AgentRunTally {
    stop_after: Option<u32>,
    /// Sets that count.
    sets: u64,
    /// How many of the last ones brought nothing new.
    idle: u32,
    tests: Vec<AbstractTest>,
    reached: ReachedGoals,
    /// What only runs reached that break an assumption.
    broken: ReachedGoals,
    left_out: usize,
    measured: Vec<(AgentId, AgentCounts)>,
    seen: BTreeSet<Vec<i64>>,
    /// With the number of runs that gave them.
    warnings: BTreeMap<String, u64>,
}

impl AgentRunTally {
    fn new(program: &Program, players: &[PlayerRef], stop_after: Option<u32>) -> Self {
        let measured = agents(program, players).into_iter().map(|(id, a)| (id, AgentCounts::new(a)));
        Self {
            stop_after,
            sets: 0,
            idle: 0,
            tests: Vec::new(),
            reached: ReachedGoals::new(),
            broken: ReachedGoals::new(),
            left_out: 0,
            measured: measured.collect(),
            seen: BTreeSet::new(),
            warnings: BTreeMap::new(),
        }
    }

    /// Whether so many sets in a row brought nothing new that exploration ends.
    fn is_over(&self) -> bool {
        self.stop_after.is_some_and(|most| self.idle >= most.max(1))
    }

    /// Adds a run; gives the number of goals that it was the first to reach.
    fn add(&mut self, run: AgentRunOutcome) -> u32 {
        self.sets += 1;
        self.idle += 1;
        for warning in run.warnings.into_iter().collect::<BTreeSet<_>>() {
            *self.warnings.entry(warning).or_default() += 1;
        }
        if !run.keeps_assumptions {
            self.left_out += 1;
            self.broken.extend(run.test.reaches);
            return 0;
        }
        let new = run.test.reaches.difference(&self.reached).count();
        if new > 0 {
            self.idle = 0;
        }
        self.reached.extend(&run.test.reaches);
        for (agent, counts) in &run.measured {
            if let Some((_, sum)) = self.measured.iter_mut().find(|(a, _)| a == agent) {
                sum.add(counts);
            }
        }
        self.seen.insert(run.numbers);
        self.tests.push(run.test);
        u32::try_from(new).unwrap_or(u32::MAX)
    }

    fn harvest(self, model: &AgentRunInput<'_>, explorer: &BeliefExplorer<'_>) -> AbstractTests {
        let notes = self.notes(explorer);
        let team = AgentTeam { program: model.program, measured: &self.measured };
        let goals = &model.goals.ids;
        let why = |goal: usize| match (self.reached.contains(&goal), self.broken.contains(&goal)) {
            (true, _) => String::new(),
            (false, true) => "only runs that break an assumption reach it".to_owned(),
            (false, false) => model.goals.why(goal, &team, &self.seen),
        };
        let found = AgentFindings {
            reasons: (0..goals.len()).map(why).collect(),
            goals: goals.clone(),
            coverage: ModelCoverage {
                runs: self.tests.len(),
                goals_reached: self.reached.len(),
                goals: goals.len(),
                agents: model::coverage(model.program, model.players, &team),
            },
        };
        AbstractTests { tests: self.tests, notes, found: Some(found), ..AbstractTests::default() }
    }

    fn notes(&self, explorer: &BeliefExplorer<'_>) -> Vec<String> {
        let mut notes = Vec::new();
        if self.left_out > 0 {
            notes.push(format!(
                "{} belief sets led to a run that breaks an assumption and were left out",
                self.left_out
            ));
        }
        notes.extend(explorer.notes.iter().cloned());
        notes.push(format!("{} of {} belief sets were run", self.sets, explorer.space));
        if let Some(most) = self.stop_after.filter(|_| self.is_over()) {
            notes.push(format!("exploration ended since {most} belief sets in a row brought nothing new"));
        }
        if explorer.cut {
            notes.push("a limit cut the exploration short".to_owned());
        }
        let in_runs = |n: u64| if n == 1 { "in 1 run".to_owned() } else { format!("in {n} runs") };
        let warnings = self.warnings.iter().take(WARNINGS);
        notes.extend(warnings.map(|(warning, n)| format!("{warning} ({})", in_runs(*n))));
        if self.warnings.len() > WARNINGS {
            notes.push(format!("and {} other warnings", self.warnings.len() - WARNINGS));
        }
        notes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(goals: &[usize], keeps_assumptions: bool) -> AgentRunOutcome {
        let test = AbstractTest { reaches: goals.iter().copied().collect(), ..AbstractTest::default() };
        let warnings = vec!["odd".to_owned(), "odd".to_owned()];
        AgentRunOutcome {
            test,
            measured: Vec::new(),
            numbers: vec![goals.len() as i64],
            warnings,
            keeps_assumptions,
        }
    }

    fn sum(stop_after: Option<u32>) -> AgentRunTally {
        AgentRunTally::new(&Program::default(), &[], stop_after)
    }

    #[test]
    fn what_a_run_is_the_first_to_reach_is_its_reward() {
        let mut sum = sum(None);
        let rewards: Vec<u32> =
            [&[0, 1][..], &[1], &[1, 2, 3], &[]].map(|g| sum.add(outcome(g, true))).to_vec();
        assert_eq!(rewards, [2, 0, 2, 0]);
        assert!(!sum.is_over());
        assert_eq!((sum.tests.len(), sum.reached.len(), sum.seen.len()), (4, 4, 4));
        assert_eq!(sum.warnings["odd"], 4);
    }

    #[test]
    fn exploration_ends_when_so_many_in_a_row_brought_nothing_new() {
        let mut sum = sum(Some(2));
        for (goals, is_over) in
            [(&[0][..], false), (&[0], false), (&[0, 1], false), (&[1], false), (&[], true)]
        {
            sum.add(outcome(goals, true));
            assert_eq!(sum.is_over(), is_over, "{goals:?}");
        }
    }

    #[test]
    fn a_run_that_breaks_an_assumption_reaches_nothing() {
        let mut sum = sum(Some(2));
        assert_eq!(sum.add(outcome(&[0, 1], false)), 0);
        assert_eq!(sum.add(outcome(&[1], true)), 1);
        assert_eq!((sum.tests.len(), sum.left_out, sum.seen.len()), (1, 1, 1));
        assert_eq!(sum.broken.difference(&sum.reached).collect::<Vec<_>>(), [&0]);
        sum.add(outcome(&[0], false));
        sum.add(outcome(&[0], false));
        assert!(sum.is_over());
    }
}
