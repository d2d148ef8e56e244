//! What an agent reasons with: its program, beliefs and intentions, and who it is among the others.

use std::{collections::VecDeque, sync::Arc};

use hrdsl_ir::{
    List, Nanos, Program, Symbol, Value,
    bdi::{Agent, AgentId, GoalId, TriggerOn},
    list::same,
};
use rustc_hash::FxHashMap;

use crate::{
    belief::BeliefBase,
    event::Event,
    intention::{Intention, Pool},
    plan::Library,
    unify::Slot,
};

/// The agents of a run.
#[derive(Debug)]
pub(crate) struct Peers {
    pub agents: Vec<(Symbol, AgentId)>,
    /// All names, in the order of the society.
    pub list: List,
    /// Places by the names' numbers; of equal names the first.
    places: FxHashMap<u64, u16>,
}

impl Peers {
    pub fn new(program: &Program, agents: impl Iterator<Item = AgentId>) -> Self {
        let name = |id: AgentId| {
            let agent = program.agents.get(usize::from(id.0));
            Symbol::intern(agent.map_or("?", |a| &a.name))
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

/// Who an agent is among the others.
#[derive(Clone, Debug)]
pub(crate) struct Me {
    pub name: Symbol,
    pub place: u16,
    pub id: AgentId,
    pub peers: Arc<Peers>,
}

/// How a goal is had.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Held {
    Intended,
    Desired,
    Suspended,
}

/// All that a query may look at.
#[derive(Debug)]
pub(crate) struct Mind<'p> {
    pub program: &'p Program,
    pub agent: Option<&'p Agent>,
    pub library: Library<'p>,
    pub beliefs: BeliefBase,
    pub pool: Pool<'p>,
    pub events: VecDeque<Event>,
    pub now: Nanos,
    pub me: Me,
}

/// Whether the arguments are these, as far as these are known.
pub(crate) fn agree(args: &[Slot], wanted: &[Slot]) -> bool {
    let agrees = |(a, w): (&Slot, &Slot)| match (a, w) {
        (Some(a), Some(w)) => same(*a, *w),
        (_, None) => true,
        (None, Some(_)) => false,
    };
    args.len() == wanted.len() && args.iter().zip(wanted).all(agrees)
}

impl Mind<'_> {
    /// The lowest frame of the intention with such a goal.
    pub fn frame_of(&self, intention: &Intention, goal: GoalId, args: &[Slot]) -> Option<usize> {
        intention.frames.iter().position(|frame| {
            let on = self.library.plan(frame.plan).trigger.on;
            let has = on == TriggerOn::GoalAdded(goal) || on == TriggerOn::GoalFailed(goal);
            has && !frame.branch && agree(intention.args(*frame), args)
        })
    }

    /// Whether such a goal was posted, and waits for its plan.
    pub fn is_posted(&self, event: &Event, goal: GoalId, args: &[Slot]) -> bool {
        event.on == TriggerOn::GoalAdded(goal) && agree(&event.args, args)
    }

    pub fn holds_goal(&self, how: Held, goal: GoalId, args: &[Slot]) -> bool {
        let mut events = self.events.iter().filter(|e| self.is_posted(e, goal, args));
        let posted = match how {
            Held::Desired => events.next().is_some(),
            Held::Intended => events.any(|e| e.of.is_some()),
            Held::Suspended => {
                events.any(|e| e.of.is_some_and(|p| self.pool.get(p).is_some_and(|i| i.suspended)))
            }
        };
        let of_interest = |i: &Intention| how != Held::Suspended || i.suspended;
        posted
            || self.pool.iter().any(|(_, i)| of_interest(i) && self.frame_of(i, goal, args).is_some())
    }
}
