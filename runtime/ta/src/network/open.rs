//! A network as a part of something larger: what it can do by itself, and what it does about an event from outside.
//!
//! Whoever walks it brings zones: the clocks of the network come first, each by its number there, then as many of their own as they like,
//! which only run.

use hrdsl_ir::{EventId, Type, Value};

use crate::{
    network::{
        actions::{DelayCondition, EnabledTransition},
        code::SyncMedium,
        error::ModelError,
        graph::set,
        model::{CompiledNetwork, values},
        number::NumberType,
        semantics::AutomatonMove,
    },
    zone::{
        constraint::keep,
        dbm::Dbm,
        extrapolation::{ActiveClocks, ExtrapolationAbstraction, KEEP, MaximalConstants, extra},
    },
};

/// A number that no constant, variable or pattern has.
const FOREIGN: i64 = i64::MIN + 1;

/// A compiled network that others speak with. It must have been compiled with all clocks.
#[derive(Clone, Copy)]
pub struct OpenNetwork<'m, 'p> {
    model: &'m CompiledNetwork<'p>,
}

/// Something that may happen in a discrete state.
#[derive(Clone)]
pub struct OpenTransition {
    /// The event of its automata, with its arguments; none: what happens is not to be seen from outside, or was received.
    pub sent: Option<(EventId, Vec<Value>)>,
    /// Who takes part, in the order of the updates; nobody, if an event from outside is ignored, or the transition is a fault.
    pub parts: Vec<AutomatonMove>,
    pub(crate) action: EnabledTransition,
}

/// What staying in a discrete state means for clocks.
#[derive(Clone, Debug)]
pub struct StateStay(DelayCondition);

impl StateStay {
    /// Lets time pass, as far as it may. Returns whether any may.
    pub fn wait(&self, zone: &mut Dbm) -> bool {
        if self.0.waits {
            zone.up_but(&self.0.stopped);
            // Not empty: it has what was there before.
            self.0.invariant.iter().for_each(|c| {
                keep(zone, *c);
            });
        }
        self.0.waits
    }
}

impl<'m, 'p> OpenNetwork<'m, 'p> {
    #[must_use]
    pub fn new(model: &'m CompiledNetwork<'p>) -> Self {
        Self { model }
    }

    /// The state at the start, and its clocks before time passes.
    ///
    /// # Errors
    /// If the invariants do not hold at the start.
    pub fn start(&self) -> Result<(Vec<i64>, Dbm), ModelError> {
        self.model.refuse_stopped("what a network can do step by step")?;
        let state = self.model.initial();
        let stay = self.model.stay(&state)?.ok_or(ModelError::Initial)?;
        let mut zone = Dbm::zero(self.model.dim);
        if !stay.invariant.iter().all(|c| keep(&mut zone, *c)) {
            return Err(ModelError::Initial);
        }
        Ok((state, zone))
    }

    /// The location of each automaton.
    pub fn locations<'s>(&self, state: &'s [i64]) -> impl Iterator<Item = usize> + use<'s> {
        state.iter().take(self.model.members.len()).map(|&n| usize::try_from(n).unwrap_or(usize::MAX))
    }

    /// `None`: invariants over variables forbid the state.
    ///
    /// # Errors
    /// If an invariant has no value.
    pub fn stay(&self, state: &[i64]) -> Result<Option<StateStay>, ModelError> {
        Ok(self.model.stay(state)?.map(StateStay))
    }

    /// All that may happen in a discrete state by itself, in the network's order.
    #[must_use]
    pub fn transitions(&self, state: &[i64]) -> Vec<OpenTransition> {
        self.model.actions(state).into_iter().map(|action| self.open(action)).collect()
    }

    /// All that may come of an event from outside, which no committed location holds back. Where nobody takes it, it is ignored.
    #[must_use]
    pub fn receptions(&self, state: &[i64], event: EventId, args: &[Value]) -> Vec<OpenTransition> {
        let numbers = self.numbers(event, args);
        let all = self.model.receptions(state, event, &numbers).into_iter();
        all.map(|action| OpenTransition { sent: None, ..self.open(action) }).collect()
    }

    fn open(&self, action: EnabledTransition) -> OpenTransition {
        let taken = &action.taken;
        let sent = match taken.medium {
            Some(medium @ SyncMedium::Event(event)) => Some((event, values(self.model, medium, &taken.args))),
            Some(SyncMedium::Channel(_)) | None => None,
        };
        let parts = taken.parts.iter().map(|part| self.model.moved(part)).collect();
        OpenTransition { sent, parts, action }
    }

    /// The arguments as the network counts them.
    fn numbers(&self, event: EventId, args: &[Value]) -> Vec<i64> {
        let constant = |value: Value| {
            let at = self.model.library.constants.iter().position(|c| c.key() == value.key())?;
            i64::try_from(at).ok()
        };
        let number = |(ty, value): (Type, Value)| match ty {
            Type::Bool => NumberType::Bool.number(value),
            Type::Int { .. } => NumberType::Int.number(value),
            Type::Enum(e) => NumberType::Enum(e).number(value),
            Type::Float(_) | Type::Text | Type::List(_) => constant(value),
        };
        let types = self.model.program.event(event).params.iter().map(|p| p.ty);
        types.zip(args.iter().copied()).map(|pair| number(pair).unwrap_or(FOREIGN)).collect()
    }

    /// Where a transition leads to from some clocks: the state, and the clocks right after it. `None`: it is not possible.
    ///
    /// # Errors
    /// The fault of the model that the transition is.
    pub fn follow(
        &self,
        transition: &OpenTransition,
        zone: &Dbm,
    ) -> Result<Option<(Vec<i64>, Dbm)>, ModelError> {
        let EnabledTransition { taken, below, target } = &transition.action;
        let mut zone = zone.clone();
        if !taken.guard.iter().all(|c| keep(&mut zone, *c)) {
            return Ok(None);
        }
        let target = target.as_ref().map_err(|e| (**e).clone())?;
        let meets = |zone: &Dbm, i: u16, j: u16, bound| zone.meets(usize::from(i), usize::from(j), bound);
        if let Some((_, fault)) = below.iter().find(|(c, _)| meets(&zone, c.i, c.j, c.bound)) {
            return Err(fault.clone());
        }
        let Some(stay) = self.model.stay(target)? else { return Ok(None) };
        if !taken.resets.is_empty() {
            let mut sources: Vec<(usize, i64)> = (0..zone.dim()).map(|x| (x, 0)).collect();
            for reset in &taken.resets {
                sources[usize::from(reset.clock)] = (usize::from(reset.from), reset.by);
            }
            zone = set(&zone, &sources);
        }
        Ok(stay.invariant.iter().all(|c| keep(&mut zone, *c)).then(|| (target.clone(), zone)))
    }

    /// Takes from a zone what cannot matter to anything that happens later, so that zones stay few. The clocks after those of the network
    /// lose nothing.
    pub fn simplify(&self, state: &[i64], zone: &mut Dbm) {
        if self.model.extrapolation.diagonals.is_some() {
            return;
        }
        let mut bounds = MaximalConstants::none(zone.dim());
        let mut active = ActiveClocks::default();
        self.model.extrapolation.frame(state, ExtrapolationAbstraction::LowerUpper, &mut active);
        for (&clock, lu) in active.clocks.iter().zip(&active.bounds) {
            (bounds.lower[usize::from(clock)], bounds.upper[usize::from(clock)]) = (lu.lower, lu.upper);
        }
        for clock in self.model.dim..zone.dim() {
            (bounds.lower[clock], bounds.upper[clock]) = (KEEP, KEEP);
        }
        extra(zone, &bounds);
    }
}
