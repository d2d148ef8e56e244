//! The steps of a model between two observations and at one: all that it can do, with all times at which it can.

use std::{cell::RefCell, collections::BTreeSet, rc::Rc, sync::Arc};

use hrdsl_ir::{EventId, Program, Value, ta::AutomatonId};
use hrdsl_ta::{
    CompiledNetwork, ModelError, ObservationOptions, OpenNetwork, OpenTransition,
    dbm::{Dbm, DbmBound},
};
use rustc_hash::FxHashMap;

use crate::{
    ConformanceOptions,
    model::SystemModel,
    states::{ExtraClock, PossibleState, SentOutput, StateKey, range},
    trail::ModelPart,
};

/// More sets of states than this between two observations are not gone through.
const MOST_STATES: usize = 5_000;
/// More outputs, or edges that are looked at, than this between two observations are not gone through.
const MOST_EXTRAS: usize = 12;
/// More discrete states than this are not remembered with what may happen in them.
const MOST_REMEMBERED: usize = 4096;

/// Why a model cannot be followed any farther.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum WalkFault {
    Model(ModelError),
    /// Too many states.
    States,
    /// Too many events that are on their way at once.
    Outputs,
}

impl WalkFault {
    pub(crate) fn sentence(&self) -> String {
        match self {
            WalkFault::Model(error) => format!("the model is at fault: {error}"),
            WalkFault::States => {
                format!("the model can be in more than {MOST_STATES} sets of states between two observations")
            }
            WalkFault::Outputs => {
                format!("the model can make more than {MOST_EXTRAS} events within the latency")
            }
        }
    }
}

impl From<ModelError> for WalkFault {
    fn from(error: ModelError) -> Self {
        WalkFault::Model(error)
    }
}

/// What became of a model at an observation.
pub(crate) enum ObservationEffect {
    /// The states in which it can be now.
    Now(Vec<PossibleState>),
    /// It cannot let so much time pass.
    Late,
    /// It cannot make this event now; the states in which it could have been.
    Wrong(Vec<PossibleState>),
    /// It cannot take this event now, nor be without it.
    Refused,
}

/// An output that is seen, or can be: when, as the least and the greatest time since the last observation.
pub(crate) struct VisibleOutput<'a> {
    pub output: &'a SentOutput,
    pub from: i64,
    pub until: Option<i64>,
}

/// A bound whose clock is looked at whenever an edge is taken.
pub(crate) struct WatchedBound {
    /// Index in the network.
    pub automaton: usize,
    /// Edges of the automaton.
    pub edges: Vec<usize>,
    /// Number in the network.
    pub clock: usize,
}

/// A model that is followed.
pub(crate) struct ModelWalk<'p> {
    compiled: CompiledNetwork<'p>,
    latency: i64,
    hidden: Vec<EventId>,
    /// Not if clocks are looked at: then their values matter.
    simplifies: bool,
    watched: Vec<WatchedBound>,
    known: FxHashMap<Vec<i64>, Rc<Vec<OpenTransition>>>,
    members: Vec<AutomatonId>,
    /// The parts of the model in which it was or could be, if somebody asks for them.
    visited: Option<RefCell<BTreeSet<ModelPart>>>,
}

impl<'p> ModelWalk<'p> {
    pub(crate) fn new(
        program: &'p Program,
        model: &SystemModel,
        options: &ConformanceOptions,
        watched: Vec<WatchedBound>,
    ) -> Result<Self, WalkFault> {
        let observe =
            ObservationOptions { all_clocks: true, nanoseconds: true, ..ObservationOptions::default() };
        Ok(Self {
            compiled: CompiledNetwork::new(program, &model.network, &observe)?,
            latency: options.latency,
            hidden: options.unobserved.clone(),
            simplifies: watched.is_empty(),
            watched,
            known: FxHashMap::default(),
            members: model.network.automata.clone(),
            visited: None,
        })
    }

    /// Keeps from now on which parts of the model are visited.
    pub(crate) fn keep_visited(&mut self) {
        self.visited.get_or_insert_default();
    }

    pub(crate) fn visited(self) -> BTreeSet<ModelPart> {
        self.visited.map(RefCell::into_inner).unwrap_or_default()
    }

    fn visit(
        &self,
        part: impl Fn(AutomatonId, usize) -> ModelPart,
        places: impl Iterator<Item = (usize, usize)>,
    ) {
        let Some(visited) = &self.visited else { return };
        let parts = places.filter_map(|(member, at)| Some(part(*self.members.get(member)?, at)));
        visited.borrow_mut().extend(parts);
    }

    /// As [`Self::silently`], of what is only looked ahead to: no part of the model is visited.
    pub(crate) fn foreseen(
        &mut self,
        from: &[PossibleState],
        until: i64,
        seen: &mut dyn FnMut(VisibleOutput),
    ) -> Result<Vec<PossibleState>, WalkFault> {
        let visited = self.visited.take();
        let reached = self.silently(from, until, seen);
        self.visited = visited;
        reached
    }

    fn open(&self) -> OpenNetwork<'_, 'p> {
        OpenNetwork::new(&self.compiled)
    }

    /// The location of each automaton.
    pub(crate) fn locations(&self, state: &PossibleState) -> Vec<usize> {
        self.open().locations(&state.discrete).collect()
    }

    /// The states at the start, as if something had been observed then.
    pub(crate) fn start(&self) -> Result<Vec<PossibleState>, WalkFault> {
        let (discrete, zone) = self.open().start()?;
        let dim = zone.dim();
        let from: Vec<(u16, i64)> = (0..dim).chain([0]).map(|clock| (clock as u16, 0)).collect();
        let mut with_since = Dbm::zero(1);
        with_since.gather(&zone, &from);
        Ok(vec![PossibleState { discrete, zone: with_since, extras: Vec::new() }])
    }

    fn transitions(&mut self, discrete: &[i64]) -> Rc<Vec<OpenTransition>> {
        if let Some(known) = self.known.get(discrete) {
            return Rc::clone(known);
        }
        if self.known.len() >= MOST_REMEMBERED {
            self.known.clear();
        }
        let new = Rc::new(self.open().transitions(discrete));
        self.known.insert(discrete.to_vec(), Rc::clone(&new));
        new
    }

    /// All states in which the model can be up to some time after the last observation, if nothing is observed until then. `seen` is told what
    /// would be seen of it.
    pub(crate) fn silently(
        &mut self,
        from: &[PossibleState],
        until: i64,
        seen: &mut dyn FnMut(VisibleOutput),
    ) -> Result<Vec<PossibleState>, WalkFault> {
        let mut reached = ReachedStates::default();
        for state in from {
            self.enter(state.clone(), until, &mut reached)?;
        }
        let mut next = 0;
        while let Some(here) = reached.all.get(next).cloned() {
            next += 1;
            if let Some(output) = here.queued() {
                let (from, until) = range(&here.zone, here.since(), 0);
                seen(VisibleOutput { output, from, until });
            }
            for transition in self.transitions(&here.discrete).iter() {
                let Some(there) = self.taken(&here, transition)? else { continue };
                match self.output(transition) {
                    None => self.enter(there, until, &mut reached)?,
                    Some(output) if self.latency > 0 => {
                        let there = there.with(0, ExtraClock::Queued(Arc::new(output)));
                        self.enter(there, until, &mut reached)?;
                    }
                    Some(output) => {
                        let (from, until) = range(&there.zone, there.since(), 0);
                        seen(VisibleOutput { output: &output, from, until });
                    }
                }
            }
        }
        Ok(reached.all)
    }

    /// What can be seen of a transition.
    fn output(&self, transition: &OpenTransition) -> Option<SentOutput> {
        let (event, args) = transition.sent.as_ref().filter(|(event, _)| !self.hidden.contains(event))?;
        let sender = transition.parts.first()?;
        Some(SentOutput { event: *event, args: args.clone(), edge: (sender.automaton, sender.edge) })
    }

    /// The state after a transition, if it can be taken.
    fn taken(
        &self,
        from: &PossibleState,
        transition: &OpenTransition,
    ) -> Result<Option<PossibleState>, WalkFault> {
        let Some((discrete, zone)) = self.open().follow(transition, &from.zone)? else { return Ok(None) };
        self.visit(ModelPart::Edge, transition.parts.iter().map(|part| (part.automaton, part.edge)));
        let there = PossibleState { discrete, zone, extras: from.extras.clone() };
        Ok(Some(self.marked(from, there, transition)))
    }

    /// A state after a transition, with the clocks of the bounds that are watched as they were before it.
    fn marked(
        &self,
        before: &PossibleState,
        after: PossibleState,
        transition: &OpenTransition,
    ) -> PossibleState {
        let takes = |bound: &WatchedBound| {
            let parts = &transition.parts;
            parts.iter().any(|p| p.automaton == bound.automaton && bound.edges.contains(&p.edge))
        };
        let taken: Vec<usize> =
            (0..).zip(&self.watched).filter(|(_, bound)| takes(bound)).map(|(number, _)| number).collect();
        if taken.is_empty() {
            return after;
        }
        // Copied before the transition, which may set the clock, and followed with it.
        let mut copied = before.clone();
        for number in taken {
            let clock = self.watched.get(number).map_or(0, |bound| bound.clock);
            copied = copied.with(clock, ExtraClock::Copied(number)).with(0, ExtraClock::Since(number));
        }
        match self.open().follow(transition, &copied.zone) {
            Ok(Some((discrete, zone))) => PossibleState { discrete, zone, extras: copied.extras },
            Ok(None) | Err(_) => after,
        }
    }

    fn enter(
        &self,
        mut state: PossibleState,
        until: i64,
        reached: &mut ReachedStates,
    ) -> Result<(), WalkFault> {
        if state.extras.len() > MOST_EXTRAS {
            return Err(WalkFault::Outputs);
        }
        if self.visited.is_some() {
            self.visit(ModelPart::Location, self.locations(&state).into_iter().enumerate());
        }
        let Some(stay) = self.open().stay(&state.discrete)? else { return Ok(()) };
        if stay.wait(&mut state.zone) {
            let since = state.since();
            state.zone.constrain(since, 0, DbmBound::le(until));
            let ages: Vec<usize> = state.ages().collect();
            for age in ages {
                state.zone.constrain(age, 0, DbmBound::le(self.latency));
            }
        }
        reached.add(state);
        if reached.all.len() > MOST_STATES { Err(WalkFault::States) } else { Ok(()) }
    }

    /// The states in which the model is when so much time has passed, and nothing was observed. None: it cannot be silent for so long.
    pub(crate) fn after(
        &mut self,
        from: &[PossibleState],
        time: i64,
    ) -> Result<Vec<PossibleState>, WalkFault> {
        let all = self.silently(from, time, &mut |_| {})?;
        Ok(all.iter().filter_map(|state| state.at(time)).collect())
    }

    /// What becomes of states when, so much time later, an event is observed that comes from outside.
    pub(crate) fn input(
        &mut self,
        from: &[PossibleState],
        time: i64,
        (event, args): (EventId, &[Value]),
    ) -> Result<ObservationEffect, WalkFault> {
        let arrived = self.after(from, time)?;
        if arrived.is_empty() {
            return Ok(ObservationEffect::Late);
        }
        let mut next = Vec::new();
        for state in &arrived {
            for reception in self.open().receptions(&state.discrete, event, args) {
                next.extend(self.taken(state, &reception)?);
            }
        }
        Ok(if next.is_empty() { ObservationEffect::Refused } else { ObservationEffect::Now(next) })
    }

    /// What becomes of states when, so much time later, an event of the model's is observed.
    pub(crate) fn output_seen(
        &mut self,
        from: &[PossibleState],
        time: i64,
        (event, args): (EventId, &[Value]),
    ) -> Result<ObservationEffect, WalkFault> {
        let arrived = self.after(from, time)?;
        if arrived.is_empty() {
            return Ok(ObservationEffect::Late);
        }
        let mut next = Vec::new();
        for state in &arrived {
            if state.queued().is_some_and(|output| output.is(event, args)) {
                next.push(state.clone().popped());
            }
            if self.latency > 0 {
                continue;
            }
            for transition in self.transitions(&state.discrete).iter() {
                if !self.output(transition).is_some_and(|output| output.is(event, args)) {
                    continue;
                }
                next.extend(self.taken(state, transition)?);
            }
        }
        Ok(if next.is_empty() { ObservationEffect::Wrong(arrived) } else { ObservationEffect::Now(next) })
    }

    /// The states as they are kept until the next observation.
    pub(crate) fn kept(&self, states: Vec<PossibleState>) -> Vec<PossibleState> {
        let mut reached = ReachedStates::default();
        for state in states {
            let mut state = state.observed();
            if self.simplifies {
                self.open().simplify(&state.discrete, &mut state.zone);
            }
            reached.add(state);
        }
        reached.all
    }
}

/// States, none of which is a part of another.
#[derive(Default)]
struct ReachedStates {
    all: Vec<PossibleState>,
    places: FxHashMap<StateKey, Vec<usize>>,
}

impl ReachedStates {
    fn add(&mut self, state: PossibleState) {
        if state.zone.is_empty() {
            return;
        }
        let places = self.places.entry(state.key()).or_default();
        let includes = |place: &usize| self.all.get(*place).is_some_and(|old| old.zone.includes(&state.zone));
        if places.iter().any(includes) {
            return;
        }
        places.push(self.all.len());
        self.all.push(state);
    }
}
