//! What the rules on plans look up in an agent, found in one pass: asking does not go through all plans again.

use std::{
    cell::{Cell, OnceCell},
    collections::{BTreeMap, BTreeSet},
};

use super::agent_facts::{BeliefChange, HeldBeliefs, all_steps, change};
use crate::{
    AgentId, BeliefId, ChoiceKind, GoalId, MessageSubject, Performative, PlayerRef, Scenario, TriggerOn,
    TypedAgent, TypedChoiceCondition, TypedLiteral, TypedMethod, TypedStepKind,
};

/// Steps of looking that the rules on plans have for all agents of a scenario. What comes after that is not looked for: to
/// compare each plan with each other one would take without end.
const WORK: u64 = 4_000_000;

/// What is left of [`WORK`].
pub(crate) struct AgentWork(Cell<u64>);

impl Default for AgentWork {
    fn default() -> Self {
        Self(Cell::new(WORK))
    }
}

impl AgentWork {
    /// Takes some of it; `false` if there is not that much left.
    pub fn take(&self, steps: usize) -> bool {
        let left = self.0.get().checked_sub(steps as u64);
        self.0.set(left.unwrap_or(0));
        left.is_some()
    }
}

/// How a message is about something, and who sends it.
pub(crate) type SentMessage = (Option<Performative>, AgentId);

/// One agent's plans, steps, messages and choices by what they are about. Plans and steps are numbers, those of steps in
/// the plan's body; of a step within a block that of the block.
#[derive(Default)]
pub(crate) struct AgentIndex<'a> {
    plans: BTreeMap<TriggerOn, Vec<usize>>,
    /// By belief.
    pub changes: Vec<Vec<BeliefChange<'a>>>,
    pub queries: Vec<Vec<(usize, usize, &'a TypedLiteral)>>,
    pub initial: Vec<Vec<usize>>,
    pub derived: Vec<bool>,
    pub about_belief: Vec<Vec<SentMessage>>,
    /// By belief: how suites choose it, with the number of the suite among those that the agent plays in.
    pub chosen: Vec<Vec<(usize, ChoiceKind)>>,
    /// In how many suites the agent plays.
    pub suites: usize,
    pub conditions: Vec<&'a TypedChoiceCondition>,
    /// By goal.
    pub adopted: Vec<Vec<(usize, usize)>>,
    pub spawned: Vec<Vec<usize>>,
    /// How often it is a goal from the start.
    pub initial_goals: Vec<usize>,
    pub about_goal: Vec<Vec<SentMessage>>,
    /// How many plans and steps there are.
    pub size: usize,
    /// By belief: what is certain of it, once it has been asked.
    pub held: Vec<OnceCell<HeldBeliefs>>,
}

/// The indices of all agents.
pub(crate) fn indices(scenario: &Scenario) -> Vec<AgentIndex<'_>> {
    let mut all: Vec<AgentIndex<'_>> = scenario.agents.iter().map(AgentIndex::of).collect();
    for (content, speech) in scenario.contents.iter().zip(&scenario.speech) {
        for (index, of) in all.iter_mut().zip(&content.of) {
            let about = match of {
                Some(MessageSubject::Belief(b)) => index.about_belief.get_mut(usize::from(b.0)),
                Some(MessageSubject::Goal(g)) => index.about_goal.get_mut(usize::from(g.0)),
                None => None,
            };
            about.into_iter().for_each(|about| about.extend(speech.uses.iter().copied()));
        }
    }
    for suite in &scenario.suites {
        let TypedMethod::Agents { players, choose, .. } = &suite.method else { continue };
        let playing: BTreeSet<u16> = players
            .iter()
            .filter_map(|p| match p {
                PlayerRef::Agent(agent) => Some(agent.0),
                PlayerRef::Automaton(_) => None,
            })
            .collect();
        for choice in choose {
            let Some(index) = all.get_mut(usize::from(choice.agent.0)) else { continue };
            index.conditions.extend(&choice.condition);
            let Some(chosen) = index.chosen.get_mut(usize::from(choice.belief.0)) else { continue };
            // The first choice in a suite stands, and only where the agent plays.
            let number = index.suites;
            if playing.contains(&choice.agent.0) && chosen.last().is_none_or(|(n, _)| *n != number) {
                chosen.push((number, choice.how));
            }
        }
        for agent in playing {
            all.get_mut(usize::from(agent)).into_iter().for_each(|index| index.suites += 1);
        }
    }
    all
}

impl<'a> AgentIndex<'a> {
    fn of(agent: &'a TypedAgent) -> Self {
        let (beliefs, goals) = (agent.beliefs.len(), agent.goals.len());
        let mut index = Self {
            changes: (0..beliefs).map(|_| Vec::new()).collect(),
            queries: vec![Vec::new(); beliefs],
            initial: vec![Vec::new(); beliefs],
            derived: vec![false; beliefs],
            about_belief: vec![Vec::new(); beliefs],
            chosen: vec![Vec::new(); beliefs],
            adopted: vec![Vec::new(); goals],
            spawned: vec![Vec::new(); goals],
            initial_goals: vec![0; goals],
            about_goal: vec![Vec::new(); goals],
            held: vec![OnceCell::new(); beliefs],
            ..Self::default()
        };
        for (number, plan) in agent.plans.iter().enumerate() {
            index.size += 1;
            index.plans.entry(plan.trigger.on).or_default().push(number);
            for (at, block) in plan.body.iter().enumerate() {
                for step in all_steps(std::slice::from_ref(block)) {
                    index.size += 1;
                    index.step(number, at, &step.kind);
                    if let Some(change) = change(step) {
                        index.changes[usize::from(change.belief().0)].push(change);
                    }
                }
            }
        }
        for (i, fact) in agent.initial_beliefs.iter().enumerate() {
            index.initial[usize::from(fact.belief.0)].push(i);
        }
        agent.rules.iter().for_each(|r| index.derived[usize::from(r.belief.0)] = true);
        agent.initial_goals.iter().for_each(|(g, _)| index.initial_goals[usize::from(g.0)] += 1);
        index
    }

    fn step(&mut self, plan: usize, at: usize, kind: &'a TypedStepKind) {
        if let Some(l) = kind.as_query() {
            self.queries[usize::from(l.belief.0)].push((plan, at, l));
        } else if let Some((goal, _)) = kind.as_achieve() {
            self.adopted[usize::from(goal.0)].push((plan, at));
        } else if let TypedStepKind::Spawn { goal, .. } = kind {
            self.spawned[usize::from(goal.0)].push(plan);
        }
    }

    /// The plans with this trigger, in the order of the text.
    pub fn plans(&self, on: TriggerOn) -> &[usize] {
        self.plans.get(&on).map_or(&[], Vec::as_slice)
    }

    pub fn changes_of(&self, belief: BeliefId) -> &[BeliefChange<'a>] {
        &self.changes[usize::from(belief.0)]
    }

    pub fn adopters(&self, goal: GoalId) -> &[(usize, usize)] {
        &self.adopted[usize::from(goal.0)]
    }
}
