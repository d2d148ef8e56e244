//! What an agent reasons with: its program, beliefs and intentions, and who it is among the others.

use std::{
    collections::VecDeque,
    sync::{Arc, LazyLock},
};

use hrdsl_ir::{
    ActorId, List, Nanos, Program, Span, Symbol, Value,
    bdi::{Agent, AgentId, GoalId, TriggerOn},
    list::same,
};
use rustc_hash::FxHashMap;

use crate::{
    belief::BeliefBase,
    event::QueuedEvent,
    intention::{Intention, IntentionPool, PlanFrame},
    plan::PlanLibrary,
    unify::VariableSlot,
};

/// The agents of a run.
#[derive(Debug)]
pub(crate) struct PeerTable {
    pub agents: Vec<(Symbol, AgentId)>,
    /// All names, in the order of the society.
    pub list: List,
    /// Places by the names' numbers; of equal names the first.
    places: FxHashMap<u64, u16>,
}

impl PeerTable {
    pub fn new(program: &Program, agents: impl Iterator<Item = AgentId>) -> Self {
        let name = |id: AgentId| {
            // One that is not declared is shown by its number; its machine is malformed.
            let undeclared = || Symbol::intern(&format!("#{}", id.0));
            program.agents.get(usize::from(id.0)).map_or_else(undeclared, |a| Symbol::intern(&a.name))
        };
        let agents: Vec<(Symbol, AgentId)> = agents.map(|id| (name(id), id)).collect();
        let mut places = FxHashMap::default();
        for (place, (name, _)) in (0u16..).zip(&agents) {
            places.entry(name.number()).or_insert(place);
        }
        let names: Vec<Value> = agents.iter().map(|(name, _)| Value::Symbol(*name)).collect();
        Self { agents, list: List::of(&names), places }
    }

    /// The agent of this name.
    pub fn place(&self, name: Symbol) -> Option<u16> {
        self.places.get(&name.number()).copied().filter(|p| self.agents[usize::from(*p)].0 == name)
    }
}

/// What an agent reasons with whose program cannot be run: nothing.
static NO_PROGRAM: LazyLock<Agent> = LazyLock::new(|| Agent {
    name: String::new(),
    actor: ActorId(0),
    beliefs: Vec::new(),
    goals: Vec::new(),
    rules: Vec::new(),
    jason: false,
    initial_beliefs: Vec::new(),
    initial_goals: Vec::new(),
    plans: Vec::new(),
    origin: Span::default(),
});

/// Who an agent is among the others.
#[derive(Clone, Debug)]
pub(crate) struct AgentIdentity {
    pub name: Symbol,
    pub place: u16,
    pub id: AgentId,
    pub peers: Arc<PeerTable>,
}

/// How a goal is had.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum GoalAttitude {
    Intended,
    Desired,
    Suspended,
}

/// All that a query may look at.
#[derive(Debug)]
pub(crate) struct MentalState<'p> {
    pub program: &'p Program,
    pub agent: &'p Agent,
    pub library: PlanLibrary<'p>,
    pub beliefs: BeliefBase,
    pub pool: IntentionPool<'p>,
    pub events: VecDeque<QueuedEvent>,
    pub now: Nanos,
    pub me: AgentIdentity,
}

/// Whether the arguments are these, as far as these are known.
pub(crate) fn agree(args: &[VariableSlot], wanted: &[VariableSlot]) -> bool {
    let agrees = |(a, w): (&VariableSlot, &VariableSlot)| match (a, w) {
        (Some(a), Some(w)) => same(*a, *w),
        (_, None) => true,
        (None, Some(_)) => false,
    };
    args.len() == wanted.len() && args.iter().zip(wanted).all(agrees)
}

impl<'p> MentalState<'p> {
    /// At time 0, without beliefs; without an agent, one that does nothing.
    pub fn new(program: &'p Program, agent: Option<&'p Agent>, me: AgentIdentity) -> Self {
        let library = agent.map_or_else(PlanLibrary::default, |a| PlanLibrary::new(program, me.id, a));
        let beliefs = agent.map_or_else(BeliefBase::default, BeliefBase::new);
        Self {
            program,
            agent: agent.unwrap_or_else(|| &NO_PROGRAM),
            library,
            beliefs,
            pool: IntentionPool::default(),
            events: VecDeque::new(),
            now: 0,
            me,
        }
    }
}

impl MentalState<'_> {
    /// Whether the frame is of the goal: selected for it, or for its failure.
    fn is_of(&self, frame: &PlanFrame, goal: GoalId) -> bool {
        let on = self.library.plan(frame.plan).trigger.on;
        !frame.branch && (on == TriggerOn::GoalAdded(goal) || on == TriggerOn::GoalFailed(goal))
    }

    /// The lowest frame of the intention with such a goal.
    pub fn frame_of(&self, intention: &Intention, goal: GoalId, args: &[VariableSlot]) -> Option<usize> {
        let is_it = |f: &PlanFrame| self.is_of(f, goal) && agree(intention.args(*f), args);
        intention.frames.iter().position(is_it)
    }

    /// Calls `f` with the arguments of each such goal: by intention, in their order, from the lowest frame on; then, if it
    /// is desired, of those that wait for a plan.
    pub fn each_had(&self, attitude: GoalAttitude, goal: GoalId, f: &mut dyn FnMut(&[VariableSlot])) {
        for place in self.pool.in_order() {
            let intention = self.pool.see(place);
            if attitude == GoalAttitude::Suspended && !intention.suspended {
                continue;
            }
            intention.frames.iter().filter(|x| self.is_of(x, goal)).for_each(|x| f(intention.args(*x)));
        }
        if attitude == GoalAttitude::Desired {
            let posted = self.events.iter().filter(|e| e.on == TriggerOn::GoalAdded(goal));
            posted.for_each(|e| f(&e.args));
        }
    }

    pub fn has_any(&self, attitude: GoalAttitude, goal: GoalId) -> bool {
        let mut any = false;
        self.each_had(attitude, goal, &mut |_| any = true);
        any
    }
}
