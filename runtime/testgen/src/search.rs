//! Tests by search: one exploration of the network decides every goal; what its witnesses show needs no test of its own.
//!
//! The coverpoints are counted by the search itself, so that a bin of a cross product is a condition on states, and
//! no property is written by hand. The goals of a requirement are decided on the network with the requirement's observer.

use std::fmt::Display;

use hrdsl_ir::{
    Nanos, Program,
    abstract_test::AbstractTest,
    suite::{PlayerRef, SearchGoal, Suite},
    ta::{Network, NetworkId},
};
use hrdsl_results::{AbstractTests, GoalReport, GoalStatus};
use hrdsl_ta::{GoalKind, ReachabilityGoal, SearchError, WitnessRun};
use hrdsl_trace::decimal;

use crate::{
    bounds,
    covers::{ReachedItems, WitnessedGoal},
    diverse::{self, WitnessPool},
    expand::{counters, goals},
    extract,
    named::NamedGoal,
    ways::{self, EventWays},
};
use hrdsl_prove::{
    GoalDecision, GoalFate, ObservedNetwork, ProofOptions, SearchOrder, SearchWatch, decide,
    held::TimedHolds, of_formula,
};

/// Decides all goals and takes the environment's part of each witness. Where up to `diverse` witnesses of each are asked for,
/// gives further ones, too.
///
/// # Errors
/// A network that does not exist or cannot be run.
pub fn harvest(
    program: &Program,
    suite: &Suite,
    (network, asked): (NetworkId, &[SearchGoal]),
    settings: &ProofOptions,
    diverse: u32,
) -> Result<(AbstractTests, WitnessPool), String> {
    let network = program
        .networks
        .get(usize::from(network.0))
        .ok_or_else(|| format!("suite `{}` names no network", suite.name))?;
    let named = goals(program, network, asked);
    let mut harvest = AbstractTests::default();
    let all: Vec<&NamedGoal> = named.iter().collect();
    let (fates, states) =
        fates(program, network, &all, settings, &mut harvest.notes).map_err(|e| of_network(network, &e))?;
    let held_back = held_back(program, network, &named, &fates, settings, states);
    let maker = WitnessTests::new(program, suite, network, &named);
    let mut pool = WitnessPool::default();
    let mut at_start = InitialGoals::default();
    for ((goal, fate), held_back) in fates.iter().enumerate().zip(held_back) {
        let (status, mut reason) = said(fate, states);
        if let Some(why) = held_back {
            reason = format!("{reason}; {why}");
        }
        if let GoalFate::Reached(run) = fate {
            let test = maker.test(Some(goal), &named[goal].id, &run.witness, &mut pool);
            if run.witness.steps.is_empty() && named[goal].is_of_states() {
                reason = "from the start, so in every test".to_owned();
                at_start.add(goal, test);
            } else {
                harvest.tests.push(test);
            }
        }
        harvest.goals.push(GoalReport { goal: named[goal].id.clone(), status, reason, test: None });
    }
    for goal in asked {
        let SearchGoal::Bounds(step) = goal else { continue };
        let step = bounds::boundary_step(program, *step);
        maker.bounds(&mut harvest, &mut pool, (step, settings)).map_err(|e| of_network(network, &e))?;
    }
    at_start.put_into(&mut harvest);
    if diverse > 1 {
        // Those that are not needed may be wanted as second ones.
        pool.spares.clone_from(&harvest.tests);
        let finder = WayFinder { maker: &maker, first: &fates, states, settings };
        finder.spares(&mut pool, diverse).map_err(|e| of_network(network, &e))?;
    }
    Ok((harvest, pool))
}

/// Goals that the first state meets, each with a test in which nobody does anything.
#[derive(Default)]
struct InitialGoals {
    goals: Vec<usize>,
    tests: Vec<AbstractTest>,
}

impl InitialGoals {
    fn add(&mut self, goal: usize, test: AbstractTest) {
        self.goals.push(goal);
        self.tests.push(test);
    }

    /// Every test reaches them, so they have none of their own, unless there is no other.
    fn put_into(self, harvest: &mut AbstractTests) {
        /// So many are told by name.
        const TOLD: usize = 3;
        if self.goals.is_empty() {
            return;
        }
        if harvest.tests.is_empty() {
            harvest.tests = self.tests;
        }
        harvest.tests.iter_mut().for_each(|test| test.reaches.extend(&self.goals));
        let named = self.goals.iter().filter_map(|goal| harvest.goals.get(*goal));
        let mut told: Vec<String> = named.map(|report| report.goal.to_string()).collect();
        let more = told.len().saturating_sub(TOLD);
        if more > 0 {
            told.truncate(TOLD);
            told.push(format!("and {more} more"));
        }
        harvest.notes.push(format!("from the start, so in every test: {}", told.join(", ")));
    }
}

fn of_network(network: &Network, error: &SearchError) -> String {
    format!("network `{}`: {error}", network.name)
}

/// Makes tests of witnesses.
struct WitnessTests<'a> {
    program: &'a Program,
    suite: &'a Suite,
    network: &'a Network,
    named: &'a [NamedGoal],
    awaits: extract::AwaitGroups,
}

impl<'a> WitnessTests<'a> {
    fn new(program: &'a Program, suite: &'a Suite, network: &'a Network, named: &'a [NamedGoal]) -> Self {
        let players: Vec<PlayerRef> = network.automata.iter().map(|a| PlayerRef::Automaton(*a)).collect();
        let awaits = extract::AwaitGroups::of(program, &players);
        Self { program, suite, network, named, awaits }
    }

    /// The test of a witness, with the goals that the run reaches: `own`, if it is one of the suite, and others that it shows.
    fn test(
        &self,
        own: Option<usize>,
        name: &dyn Display,
        run: &WitnessRun,
        pool: &mut WitnessPool,
    ) -> AbstractTest {
        let program = self.program;
        let trace = run.trace();
        let mut test = AbstractTest {
            scripts: extract::scripts(program, &self.awaits, &trace, self.suite.settings.patience),
            because: vec![format!("witness of {name}")],
            predicts: extract::covered(program, &trace).cross_names(&program.coverage),
            ..AbstractTest::default()
        };
        let seen = ReachedItems::of(program, self.network, run, test.predicts.clone());
        let shows = |goal: usize| self.named[goal].shown.iter().any(|s| seen.has(s));
        test.reaches = (0..self.named.len()).filter(|goal| shows(*goal)).chain(own).collect();
        pool.note(&test, diverse::features(&seen, run));
        test
    }

    /// Adds the bounds of the network, and a test for each of their sides that is reached.
    fn bounds(
        &self,
        harvest: &mut AbstractTests,
        pool: &mut WitnessPool,
        (step, settings): (Nanos, &ProofOptions),
    ) -> Result<(), SearchError> {
        let found = bounds::decided(self.program, self.network, step, settings)?;
        harvest.notes.push(format!(
            "network `{}`: {} symbolic states stored for {} times beside bounds, {} s beside each, in {} explorations",
            self.network.name,
            found.states,
            found.findings.len(),
            decimal::seconds(step),
            found.searches,
        ));
        for bound in found.findings {
            if harvest.goals.iter().any(|known| known.goal == bound.id) {
                continue;
            }
            let (mut status, mut reason) = (bound.status, bound.reason);
            let refused = bound.run.as_ref().and_then(|run| bounds::refused(self.program, run));
            match (bound.run, refused) {
                (Some(_), Some(why)) => (status, reason) = (GoalStatus::Inconclusive, why),
                (Some(run), None) => {
                    let test = self.test(Some(harvest.goals.len()), &bound.id, &run, pool);
                    harvest.tests.push(test);
                }
                (None, _) => {}
            }
            harvest.goals.push(GoalReport { goal: bound.id, status, reason, test: None });
        }
        Ok(())
    }
}

/// Looks for further witnesses.
struct WayFinder<'a> {
    maker: &'a WitnessTests<'a>,
    /// What became of the suite's goals.
    first: &'a [GoalFate],
    /// How many states that took.
    states: usize,
    settings: &'a ProofOptions,
}

impl WayFinder<'_> {
    /// Searches again: so many times in each of two random orders, for the goals and for every edge, and once for each event, for
    /// the goals with it and without it. Keeps what is not much longer than what was found first.
    fn spares(&self, pool: &mut WitnessPool, diverse: u32) -> Result<(), SearchError> {
        let WitnessTests { program, network, named, .. } = *self.maker;
        let edges = ways::edges(program, network);
        let all: Vec<&NamedGoal> = named.iter().chain(&edges).collect();
        let orders = [SearchOrder::RandomBreadth, SearchOrder::RandomDepth];
        for (round, order) in (1..=u64::from(diverse)).flat_map(|round| orders.map(|order| (round, order))) {
            let seed = self.settings.seed.wrapping_mul(1_000_003).wrapping_add(round);
            let settings = ProofOptions { order: Some(order), seed, ..*self.settings };
            let (fates, _) = fates(program, network, &all, &settings, &mut Vec::new())?;
            for (goal, (fate, asked)) in fates.iter().zip(&all).enumerate() {
                self.keep(pool, Some(goal).filter(|goal| *goal < named.len()), &asked.id, fate);
            }
        }
        let plain = ObservedNetwork::new(program, network);
        let settings = EventWays::settings(self.settings, self.states);
        for EventWays { counters, asked } in EventWays::of(program, network, named) {
            let questions: Vec<ReachabilityGoal> = asked.iter().map(|way| way.2.clone()).collect();
            let found = decide(program, &plain, &questions, &counters, &settings, &SearchWatch::default())?;
            for ((goal, name, _), fate) in asked.iter().zip(&found.fates) {
                self.keep(pool, Some(*goal), name, fate);
            }
        }
        Ok(())
    }

    /// Keeps a further witness, if it is not much longer than the first one of some goal that it reaches.
    fn keep(&self, pool: &mut WitnessPool, own: Option<usize>, name: &dyn Display, fate: &GoalFate) {
        let GoalFate::Reached(run) = fate else { return };
        let longest = |goal: usize| match &self.first[goal] {
            GoalFate::Reached(first) => diverse::longest(first.witness.steps.len()),
            GoalFate::Unreachable | GoalFate::Inconclusive(_) => 0,
        };
        let is_short = |goal: usize| run.witness.steps.len() <= longest(goal);
        if own.is_some_and(|goal| !is_short(goal)) {
            return;
        }
        let mut spare = self.maker.test(own, name, &run.witness, pool);
        // Goals without a first witness here are those of bounds, and none of them is asked again.
        spare.reaches.retain(|goal| is_short(*goal));
        if !spare.reaches.is_empty() {
            pool.spares.push(spare);
        }
    }
}

/// For each goal: why nothing reaches it, if it is that holds take no time.
fn held_back(
    program: &Program,
    network: &Network,
    named: &[NamedGoal],
    decided: &[GoalFate],
    settings: &ProofOptions,
    states: usize,
) -> Vec<Option<String>> {
    let mut reasons = vec![None; named.len()];
    let open: Vec<usize> =
        (0..named.len()).filter(|goal| matches!(decided[*goal], GoalFate::Unreachable)).collect();
    if open.is_empty() {
        return reasons;
    }
    let Some(held) = TimedHolds::of(program, network) else { return reasons };
    let questions: Vec<&NamedGoal> = open.iter().map(|goal| &named[*goal]).collect();
    let settings = TimedHolds::settings(settings, states);
    // A fault of this network is none of the model's.
    let Ok((fates, _)) = fates(&held.program, network, &questions, &settings, &mut Vec::new()) else {
        return reasons;
    };
    for (goal, fate) in open.into_iter().zip(fates) {
        if let GoalFate::Reached(run) = fate {
            reasons[goal] = held.because(&run.witness);
        }
    }
    reasons
}

fn said(fate: &GoalFate, states: usize) -> (GoalStatus, String) {
    match fate {
        GoalFate::Reached(run) => (GoalStatus::Reached, format!("in {} steps", run.witness.steps.len())),
        GoalFate::Unreachable => (
            GoalStatus::Unreachable,
            format!("proved: none of the {states} symbolic states that the model can reach meets it"),
        ),
        GoalFate::Inconclusive(why) => (GoalStatus::Inconclusive, why.clone()),
    }
}

/// What a search must keep besides the state, so that goals that need more do not burden the others.
#[derive(Clone, Copy, PartialEq, Eq)]
enum SearchHistory {
    Nothing,
    LastEdges,
    LastDefinitions,
}

fn needs(goal: &ReachabilityGoal) -> SearchHistory {
    match goal.what {
        GoalKind::Pair { .. } => SearchHistory::LastEdges,
        GoalKind::Use { .. } => SearchHistory::LastDefinitions,
        GoalKind::Edge { .. } | GoalKind::Location { .. } | GoalKind::Condition(_) | GoalKind::Formula(_) => {
            SearchHistory::Nothing
        }
    }
}

/// Decides all goals: those of the network alone in one exploration, pairs and uses in one each, and those of each
/// requirement in one of its own.
fn fates(
    program: &Program,
    network: &Network,
    named: &[&NamedGoal],
    settings: &ProofOptions,
    notes: &mut Vec<String>,
) -> Result<(Vec<GoalFate>, usize), SearchError> {
    let plain = ObservedNetwork::new(program, network);
    let questions: Vec<ReachabilityGoal> =
        named.iter().flat_map(|n| n.alternatives.iter().cloned()).collect();
    let mut decided = GoalDecision::default();
    let mut outcomes: Vec<GoalFate> = vec![GoalFate::Unreachable; questions.len()];
    for need in [SearchHistory::Nothing, SearchHistory::LastEdges, SearchHistory::LastDefinitions] {
        let of: Vec<usize> = (0..questions.len()).filter(|q| needs(&questions[*q]) == need).collect();
        if of.is_empty() {
            continue;
        }
        let some: Vec<ReachabilityGoal> = of.iter().map(|q| questions[*q].clone()).collect();
        let counters = if need == SearchHistory::Nothing { counters(program) } else { Vec::new() };
        let more = decide(program, &plain, &some, &counters, settings, &SearchWatch::default())?;
        decided.states += more.states;
        decided.visited += more.visited;
        decided.searches += more.searches;
        for (question, fate) in of.into_iter().zip(more.fates) {
            outcomes[question] = fate;
        }
    }
    let alone = named.iter().filter(|n| n.monitor.is_none()).count();
    // Who asks for bounds alone has no goals here.
    let told = (!named.is_empty()).then(|| {
        format!(
            "network `{}`: {} symbolic states stored, {} visited, for {alone} goals in {}",
            network.name,
            decided.states,
            decided.visited,
            match decided.searches {
                0 | 1 => "one exploration".to_owned(),
                n => format!("{n} explorations"),
            }
        )
    });
    notes.extend(told);
    let (states, mut outcomes) = (decided.states, outcomes.into_iter());
    let mut fates = Vec::new();
    for goal in named {
        fates.push(match goal.monitor {
            None => any(outcomes.by_ref().take(goal.alternatives.len())),
            Some(monitor) => of_requirement(program, network, monitor, &goal.shown, settings)?,
        });
    }
    Ok((fates, states))
}

/// The fate of a goal that has several alternatives.
fn any(outcomes: impl Iterator<Item = GoalFate>) -> GoalFate {
    let mut fate = GoalFate::Unreachable;
    for outcome in outcomes {
        fate = match (fate, outcome) {
            (GoalFate::Reached(run), _) | (_, GoalFate::Reached(run)) => GoalFate::Reached(run),
            (GoalFate::Inconclusive(why), _) | (_, GoalFate::Inconclusive(why)) => {
                GoalFate::Inconclusive(why)
            }
            (GoalFate::Unreachable, GoalFate::Unreachable) => GoalFate::Unreachable,
        };
    }
    fate
}

fn of_requirement(
    program: &Program,
    network: &Network,
    monitor: usize,
    shown: &[WitnessedGoal],
    settings: &ProofOptions,
) -> Result<GoalFate, SearchError> {
    let mut observed = ObservedNetwork::new(program, network);
    let verdicts = match observed.add(&program.monitors[monitor]) {
        Ok(verdicts) => verdicts,
        Err(why) => return Ok(GoalFate::Inconclusive(why)),
    };
    let formula = if shown.iter().any(|s| matches!(s, WitnessedGoal::Violation(_))) {
        verdicts.violated
    } else {
        Some(verdicts.triggered)
    };
    let Some(formula) = formula else { return Ok(GoalFate::Unreachable) };
    let GoalDecision { mut fates, .. } =
        decide(program, &observed, &[of_formula(&formula)], &[], settings, &SearchWatch::default())?;
    Ok(fates.pop().unwrap_or(GoalFate::Unreachable))
}
