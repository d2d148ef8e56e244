//! Where a walk is: a discrete state with all clocks that are possible there, and the transitions from it with the times at which they
//! can be taken.
//!
//! Zones have two clocks more than the network: the time since the start, which is never set, and that since the last transition.
//! Nothing is extrapolated, so that each bound shown is the exact one.

use std::fmt;

use hrdsl_ir::{
    Nanos, Program,
    ta::{LocationId, Network},
};

use crate::{
    network::{
        error::ModelError,
        model::{CompiledNetwork, ObservationOptions, slot_names},
        open::{OpenNetwork, OpenTransition},
    },
    witness::{build::told_step, trace::WitnessTransition, trace::seconds},
    zone::{
        constraint::keep,
        dbm::{Dbm, DbmBound},
    },
};

/// A network that is walked through.
pub struct NetworkWalk<'p> {
    pub(crate) program: &'p Program,
    pub(crate) network: &'p Network,
    pub(crate) model: CompiledNetwork<'p>,
}

/// Where a walk is.
#[derive(Clone, Debug, PartialEq)]
pub struct WalkState {
    pub(crate) discrete: Vec<i64>,
    /// All clocks, the time since the start and that since the last transition; after time has passed as far as it may.
    pub(crate) zone: Dbm,
    /// Time may pass for ever.
    pub for_ever: bool,
}

/// Something that can happen.
#[derive(Clone)]
pub struct WalkOption {
    /// Who does what; its time is the earliest.
    pub told: WitnessTransition,
    /// When, since the start.
    pub time: MomentRange,
    /// When, since the last transition.
    pub delay: MomentRange,
    /// It is a fault of the model: then it leads nowhere.
    pub fault: Option<ModelError>,
    pub(crate) transition: OpenTransition,
    pub(crate) next: Option<WalkState>,
}

/// Times from a first to a last one, in nanoseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MomentRange {
    pub from: Nanos,
    /// The first itself is not in it.
    pub after: bool,
    /// `None`: it has no end.
    pub until: Option<Nanos>,
    /// The last itself is not in it.
    pub before: bool,
}

/// What a clock, or the difference of two, can be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClockView {
    /// `Door.x`, `Door.x - Person.x`
    pub name: String,
    pub range: MomentRange,
}

impl fmt::Display for MomentRange {
    /// `2 s`, `2 s to 6 s`, `after 2 s, before 6 s`, `from 2 s on`
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let from = seconds(self.from, 1);
        match (self.until.map(|t| seconds(t, 1)), self.after, self.before) {
            (Some(until), false, false) if until == from => write!(f, "{from} s"),
            (Some(until), false, false) => write!(f, "{from} s to {until} s"),
            (Some(until), true, false) => write!(f, "after {from} s, up to {until} s"),
            (Some(until), false, true) => write!(f, "from {from} s, before {until} s"),
            (Some(until), true, true) => write!(f, "after {from} s, before {until} s"),
            (None, false, _) => write!(f, "from {from} s on"),
            (None, true, _) => write!(f, "after {from} s"),
        }
    }
}

impl MomentRange {
    /// Of a clock in a zone, or of the difference of two.
    fn of(zone: &Dbm, clock: usize, minus: usize) -> Self {
        let (most, least) = (zone.at(clock, minus), zone.at(minus, clock));
        Self {
            from: if least.is_infinite() { Nanos::MIN } else { -least.value() },
            after: least.is_strict(),
            until: (!most.is_infinite()).then(|| most.value()),
            before: !most.is_infinite() && most.is_strict(),
        }
    }

    /// As part of a sentence: `at 2 s`, `from 2 s to 6 s`, `after 2 s`.
    #[must_use]
    pub fn during(&self) -> String {
        match self.until {
            Some(until) if until == self.from => format!("at {self}"),
            Some(_) if !self.after && !self.before => format!("from {self}"),
            Some(_) | None => self.to_string(),
        }
    }
}

impl<'p> NetworkWalk<'p> {
    /// # Errors
    /// If the network cannot be walked through: it is malformed, or its constants are too large to be counted in nanoseconds.
    pub fn new(program: &'p Program, network: &'p Network) -> Result<Self, ModelError> {
        let observe =
            ObservationOptions { all_clocks: true, nanoseconds: true, ..ObservationOptions::default() };
        Ok(Self { program, network, model: CompiledNetwork::new(program, network, &observe)? })
    }

    /// The number of the clock that is the time since the start.
    pub(crate) fn now(&self) -> usize {
        self.model.dim
    }

    fn since(&self) -> usize {
        self.model.dim + 1
    }

    /// Where the network starts.
    ///
    /// # Errors
    /// If the invariants do not hold there, or have no value.
    pub fn start(&self) -> Result<WalkState, ModelError> {
        let (discrete, _) = OpenNetwork::new(&self.model).start()?;
        self.settled(discrete, Dbm::zero(self.model.dim + 2))?.ok_or(ModelError::Initial)
    }

    /// The state after time has passed as far as it may.
    fn settled(&self, discrete: Vec<i64>, mut zone: Dbm) -> Result<Option<WalkState>, ModelError> {
        let Some(stay) = self.model.stay(&discrete)? else { return Ok(None) };
        zone.reset(self.since());
        if stay.waits {
            zone.up();
        }
        if !stay.invariant.iter().all(|c| keep(&mut zone, *c)) {
            return Ok(None);
        }
        Ok(Some(WalkState { discrete, zone, for_ever: stay.for_ever() }))
    }

    /// All that can happen in a state, now or later, in the network's order.
    #[must_use]
    pub fn options(&self, state: &WalkState) -> Vec<WalkOption> {
        let all = OpenNetwork::new(&self.model).transitions(&state.discrete);
        all.into_iter().filter_map(|transition| self.option(state, transition)).collect()
    }

    /// `None`: no clocks of the state allow it.
    fn option(&self, state: &WalkState, transition: OpenTransition) -> Option<WalkOption> {
        let reached = self.reached(state, &transition);
        let (zone, next, fault) = match reached {
            Ok((entered, next)) => (entered, Some(next), None),
            Err(None) => return None,
            Err(Some(fault)) => {
                let mut zone = state.zone.clone();
                if !transition.action.taken.guard.iter().all(|c| keep(&mut zone, *c)) {
                    return None;
                }
                (zone, None, Some(fault))
            }
        };
        let taken = &transition.action.taken;
        let after = next.as_ref().map_or(&state.discrete, |n| &n.discrete);
        let mut step = told_step(&self.model, &state.discrete, after, taken);
        let time = MomentRange::of(&zone, self.now(), 0);
        step.time = time.from;
        let told = WitnessTransition::from_step(self.program, self.network, &step);
        let delay = MomentRange::of(&zone, self.since(), 0);
        Some(WalkOption { told, time, delay, fault, transition, next })
    }

    /// The clocks right after a transition, and the state after it; `None`: it is not possible.
    fn reached(
        &self,
        state: &WalkState,
        transition: &OpenTransition,
    ) -> Result<(Dbm, WalkState), Option<ModelError>> {
        let (discrete, zone) =
            OpenNetwork::new(&self.model).follow(transition, &state.zone).map_err(Some)?.ok_or(None)?;
        let next = self.settled(discrete, zone.clone()).map_err(Some)?.ok_or(None)?;
        Ok((zone, next))
    }

    /// The state at one moment since the start; `None`: it cannot be there then.
    pub(crate) fn at(&self, state: &WalkState, time: &MomentRange) -> Option<WalkState> {
        let mut there = state.clone();
        let least = if time.after { DbmBound::lt(-time.from) } else { DbmBound::le(-time.from) };
        let mut fits = there.zone.constrain(0, self.now(), least);
        if let Some(until) = time.until {
            let most = if time.before { DbmBound::lt(until) } else { DbmBound::le(until) };
            fits &= there.zone.constrain(self.now(), 0, most);
        }
        (fits && !there.zone.is_empty()).then_some(there)
    }

    /// The names of the automata.
    #[must_use]
    pub fn automata(&self) -> Vec<&'p str> {
        self.network.automata.iter().map(|id| self.program.automaton(*id).name.as_str()).collect()
    }

    /// The name of the location of each automaton.
    #[must_use]
    pub fn locations(&self, state: &WalkState) -> Vec<&'p str> {
        let named = |(id, n): (&hrdsl_ir::ta::AutomatonId, &i64)| {
            let location = LocationId(u16::try_from(*n).unwrap_or(u16::MAX));
            self.program.automaton(*id).location(location).name.as_str()
        };
        self.network.automata.iter().zip(&state.discrete).map(named).collect()
    }

    /// The variables with their values.
    #[must_use]
    pub fn variables(&self, state: &WalkState) -> Vec<(String, String)> {
        let names = slot_names(self.program, self.network).into_iter().enumerate();
        let value = |slot| self.model.slot_value(&state.discrete, slot);
        names.filter_map(|(slot, name)| Some((name, value(slot)?.to_string()))).collect()
    }

    /// The times since the start at which the walk can be in the state.
    #[must_use]
    pub fn time(&self, state: &WalkState) -> MomentRange {
        MomentRange::of(&state.zone, self.now(), 0)
    }

    /// What each clock can be, then the differences of two that this does not say.
    #[must_use]
    pub fn clocks(&self, state: &WalkState) -> Vec<ClockView> {
        let zone = &state.zone;
        let mut all: Vec<ClockView> = (1..self.model.dim)
            .map(|c| ClockView { name: self.model.clock_name(c), range: MomentRange::of(zone, c, 0) })
            .collect();
        for i in 1..self.model.dim {
            for j in i + 1..self.model.dim {
                // What the two intervals alone would allow.
                let (least, most) = (zone.at(j, 0).plus(zone.at(0, i)), zone.at(i, 0).plus(zone.at(0, j)));
                if zone.at(i, j) < most || zone.at(j, i) < least {
                    let name = format!("{} - {}", self.model.clock_name(i), self.model.clock_name(j));
                    all.push(ClockView { name, range: MomentRange::of(zone, i, j) });
                }
            }
        }
        all
    }
}
