//! A network's transitions as local zones see them.

use std::sync::Arc;

use hrdsl_ir::ta::LocationKind;

use super::{
    access::NetworkProcesses,
    refusal::{LocalSearchError, NotApplicableError},
    zone::{
        self, BoundOverflowError, ClockAssignment, ClockBound, LocalLuBounds, LocalZone, LocalZoneBound,
        MeetingBounds,
    },
};
use crate::{
    network::{
        by_location::LocationTable,
        code::{CodeEvalContext, CodeEvalError},
        error::ModelError,
        model::CompiledNetwork,
        semantics::{ConstraintFilter, FiringOrError, TransitionEffect, TransitionFiring},
    },
    search::store::{PackedState, PassedList},
    witness::error::SearchError,
    zone::constraint::DifferenceConstraint,
};

/// A network made ready for local time.
pub(super) struct LocalStateSpace<'m, 'p> {
    pub model: &'m CompiledNetwork<'p>,
    pub processes: Arc<NetworkProcesses>,
    /// All of them.
    everybody: Vec<u16>,
    /// The own clocks that matter, counted from 0, and the bounds of all shared clocks.
    own: LocationTable<(u16, LocalLuBounds)>,
    shared: LocationTable<LocalLuBounds>,
}

/// The last transition that was looked at, and where it leads; used again and again.
#[derive(Default)]
pub(super) struct LocalWorkspace {
    pub effect: TransitionEffect,
    /// The processes that have one time in it, in order.
    pub who: Vec<u16>,
    /// Its guard, and the invariants that those who move enter, as bounds before it.
    pub bounds: Vec<ClockBound>,
    pub sets: Vec<ClockAssignment>,
    pub zone: LocalZone,
    /// The zone as far as all processes have one time, of the clocks that matter.
    pub together: Vec<LocalZoneBound>,
    /// The clocks that matter, counted from 0, and their bounds.
    pub clocks: Vec<u16>,
    pub lu: Vec<LocalLuBounds>,
    pub stack: Vec<i64>,
    /// Its discrete state, looked up.
    pub packed: PackedState,
    meeting: MeetingBounds,
    invariant: Vec<DifferenceConstraint>,
    passing: Vec<ClockBound>,
}

/// Whether single bounds on clocks meet a zone.
pub(super) struct LocalZoneFilter<'a> {
    pub zone: &'a LocalZone,
    pub processes: &'a NetworkProcesses,
}

impl ConstraintFilter for LocalZoneFilter<'_> {
    fn may(&self, c: DifferenceConstraint) -> bool {
        match (clock_bound(&c), self.processes.owner(c.i.max(c.j))) {
            (Ok(b), Some(owner)) if c.i == 0 || c.j == 0 => self.zone.meets(b, owner),
            _ => true,
        }
    }
}

impl<'m, 'p> LocalStateSpace<'m, 'p> {
    pub(super) fn new(model: &'m CompiledNetwork<'p>, media: bool) -> Result<Self, NotApplicableError> {
        let processes = Arc::new(NetworkProcesses::of(model, media)?);
        let everybody = (0..processes.count as u16).collect();
        let known = &model.extrapolation;
        let own = known.own.try_map(|&(clock, lu)| Some((clock - 1, LocalLuBounds::of(lu)?)));
        let shared = known.shared.try_map(|&lu| LocalLuBounds::of(lu));
        let (Some(own), Some(shared)) = (own, shared) else { return Err(NotApplicableError::Constants) };
        Ok(Self { model, processes, everybody, own, shared })
    }

    pub(super) fn clocks(&self) -> usize {
        self.model.clocks()
    }

    /// The most entries that a synchronised zone has.
    pub(super) fn room(&self) -> usize {
        self.model.dim * self.model.dim
    }

    /// The start, with the time that passes there.
    pub(super) fn start(&self, w: &mut LocalWorkspace) -> Result<(), LocalSearchError> {
        w.effect.target = self.model.initial();
        w.zone = LocalZone::start(self.processes.count, self.clocks());
        for m in 0..self.model.members.len() {
            let holds = self.invariant(m, &mut w.effect.target, &mut w.stack, &mut w.invariant);
            let holds = holds.map_err(|f| broken(self.fault(m, &w.effect.target, f)))?;
            let mut zero = holds;
            for c in &w.invariant {
                zero &= keeps(&clock_bound(c)?, 0);
            }
            if !zero {
                return Err(broken(ModelError::Initial));
            }
        }
        self.enter(w, &self.everybody)?;
        // INVARIANT: all processes start at one time.
        Ok(())
    }

    /// Looks at a transition; whether it is one of the zone: then its effect is in `w`, looked up in the store, if there is one.
    pub(super) fn found(
        &self,
        w: &mut LocalWorkspace,
        state: &[i64],
        zone: &LocalZone,
        found: &FiringOrError,
        store: Option<&PassedList<LocalZoneBound>>,
    ) -> Result<bool, LocalSearchError> {
        let (FiringOrError::Firing(TransitionFiring { guard, .. }) | FiringOrError::Fault { guard, .. }) =
            found;
        w.bounds.clear();
        for c in *guard {
            w.bounds.push(clock_bound(c)?);
        }
        let firing = match found {
            FiringOrError::Firing(firing) => firing,
            FiringOrError::Fault { member, edge, fault, .. } => {
                let error = self.model.fault(usize::from(*member), usize::from(*edge), *fault);
                return self.unless_met(w, zone, error);
            }
        };
        self.processes.involved(firing.parts, &mut w.who);
        if !w.meeting.of(zone, &w.who, &w.bounds).map_err(NotApplicableError::from)? {
            return Ok(false);
        }
        match self.model.effect(state, firing, &mut w.stack, &mut w.effect) {
            Ok(true) => {}
            Ok(false) => return Ok(false),
            Err((m, e, fault)) => {
                let error = self.model.fault(usize::from(m), usize::from(e), fault);
                return self.unless_met(w, zone, error);
            }
        }
        if let Some(store) = store {
            store.anticipate(&w.effect.target, &mut w.packed);
        }
        self.negative(w, zone)?;
        if !self.enters(w, zone, firing)? {
            return Ok(false);
        }
        w.zone.restrict(zone, &w.meeting);
        // INVARIANT: somebody moves.
        w.zone.assign(&w.sets, usize::from(w.who[0]));
        if let Some(store) = store {
            store.look_up(&mut w.packed);
        }
        let who = std::mem::take(&mut w.who);
        let met = self.enter(w, &who);
        w.who = who;
        met
    }

    /// The fault, if all processes can have one time at which the bounds hold: then the network can be there.
    fn unless_met(
        &self,
        w: &mut LocalWorkspace,
        zone: &LocalZone,
        error: ModelError,
    ) -> Result<bool, LocalSearchError> {
        let met = w.meeting.of(zone, &self.everybody, &w.bounds).map_err(NotApplicableError::from)?;
        if met { Err(broken(error)) } else { Ok(false) }
    }

    /// Whether an update may make a clock negative.
    fn negative(&self, w: &mut LocalWorkspace, zone: &LocalZone) -> Result<(), LocalSearchError> {
        for i in 0..w.effect.below.len() {
            let below = w.effect.below[i];
            let bound =
                zone::lt(-below.reset.by).ok_or(BoundOverflowError).map_err(NotApplicableError::from)?;
            w.bounds.push(ClockBound { clock: below.reset.from - 1, upper: true, bound });
            let fault = CodeEvalError::Negative { clock: below.reset.clock };
            let error = self.model.fault(usize::from(below.member), usize::from(below.edge), fault);
            self.unless_met(w, zone, error)?;
            w.bounds.pop();
        }
        Ok(())
    }

    /// What the transition sets, and its meeting with the invariants that it enters; `false`: they forbid it.
    fn enters(
        &self,
        w: &mut LocalWorkspace,
        zone: &LocalZone,
        firing: &TransitionFiring,
    ) -> Result<bool, LocalSearchError> {
        w.sets.clear();
        for r in &w.effect.resets {
            let by = zone::le(r.by).ok_or(BoundOverflowError).map_err(NotApplicableError::from)?;
            w.sets.push(ClockAssignment { clock: r.clock - 1, from: r.from.checked_sub(1), by });
        }
        let guards = w.bounds.len();
        for part in firing.parts {
            let m = usize::from(part.member);
            match self.invariant(m, &mut w.effect.target, &mut w.stack, &mut w.invariant) {
                Ok(true) => {}
                Ok(false) => return Ok(false),
                Err(fault) => {
                    let error = self.fault(m, &w.effect.target, fault);
                    return self.unless_met(w, zone, error);
                }
            }
            for c in &w.invariant {
                let b = clock_bound(c)?;
                // A bound on what a clock becomes is one on what it comes from.
                match w.effect.resets.iter().find(|r| r.clock == b.clock + 1) {
                    None => w.bounds.push(b),
                    Some(r) if r.from == 0 => {
                        if !keeps(&b, r.by) {
                            return Ok(false);
                        }
                    }
                    Some(r) => {
                        let shift = zone::le(if b.upper { -r.by } else { r.by }).ok_or(BoundOverflowError);
                        let bound = zone::plus(b.bound, shift.map_err(NotApplicableError::from)?);
                        w.bounds.push(ClockBound { clock: r.from - 1, upper: b.upper, bound });
                    }
                }
            }
        }
        if w.bounds.len() > guards || !w.effect.below.is_empty() {
            return Ok(w.meeting.of(zone, &w.who, &w.bounds).map_err(NotApplicableError::from)?);
        }
        Ok(true)
    }

    /// Lets time pass for those who were part of a transition to the target, with only the clocks that matter there.
    /// Whether all processes can have one time then.
    fn enter(&self, w: &mut LocalWorkspace, who: &[u16]) -> Result<bool, LocalSearchError> {
        self.active(w);
        w.zone.forget(&w.clocks);
        for &p in who {
            let m = usize::from(p);
            w.passing.clear();
            if m < self.model.members.len() {
                if self.is_still(&w.effect.target, m) {
                    continue;
                }
                // What it says of variables did not change, or was looked at.
                let known = self.invariant(m, &mut w.effect.target, &mut w.stack, &mut w.invariant);
                known.map_err(|f| broken(self.fault(m, &w.effect.target, f)))?;
                for c in &w.invariant {
                    w.passing.push(clock_bound(c)?);
                }
            }
            w.zone.elapse(m, &w.passing);
        }
        let met = w.zone.synchronised(&w.clocks, &mut w.meeting, &mut w.together);
        Ok(met.map_err(NotApplicableError::from)?)
    }

    /// The clocks that matter in the target.
    fn active(&self, w: &mut LocalWorkspace) {
        let known = &self.model.extrapolation;
        w.clocks.clear();
        w.lu.clear();
        for x in 0..known.shared_clocks {
            let bounds = self.shared.rows(&w.effect.target).map(|row| row[x]);
            let lu = bounds.fold(LocalLuBounds::NEVER, LocalLuBounds::join);
            if known.all_clocks || lu != LocalLuBounds::NEVER {
                w.clocks.push(x as u16);
                w.lu.push(lu);
            }
        }
        for &(clock, lu) in self.own.rows(&w.effect.target).flatten() {
            w.clocks.push(clock);
            w.lu.push(lu);
        }
    }

    fn fault(&self, member: usize, state: &[i64], fault: CodeEvalError) -> ModelError {
        self.model.invariant_fault(member, state[member] as usize, fault)
    }

    /// Whether no time passes for an automaton where it is.
    pub(super) fn is_still(&self, state: &[i64], member: usize) -> bool {
        self.model.place(state, member).kind != LocationKind::Normal
    }

    /// The bounds of an automaton's location; `Ok(false)`: its part over variables does not hold.
    pub(super) fn invariant(
        &self,
        member: usize,
        state: &mut [i64],
        stack: &mut Vec<i64>,
        out: &mut Vec<DifferenceConstraint>,
    ) -> Result<bool, CodeEvalError> {
        out.clear();
        let spot = self.model.place(state, member);
        if spot.holds.is_none() && spot.invariant.moving.is_empty() {
            out.extend_from_slice(&spot.invariant.fixed);
            return Ok(true);
        }
        let mut env = CodeEvalContext::new(&self.model.library, state, stack);
        if let Some(holds) = &spot.holds
            && holds.eval(&mut env)? == 0
        {
            return Ok(false);
        }
        spot.invariant.eval(&mut env, out)?;
        Ok(true)
    }
}

fn broken(error: ModelError) -> LocalSearchError {
    LocalSearchError::Search(SearchError::from(error))
}

/// A constraint as a bound on one clock.
pub(super) fn clock_bound(c: &DifferenceConstraint) -> Result<ClockBound, NotApplicableError> {
    let n = if c.bound.is_strict() { zone::lt } else { zone::le };
    let bound = n(c.bound.value()).ok_or(BoundOverflowError)?;
    // INVARIANT: networks with bounds on differences were refused.
    Ok(ClockBound { clock: c.i.max(c.j) - 1, upper: c.i > 0, bound })
}

/// Whether a clock of this value keeps the bound.
fn keeps(b: &ClockBound, value: i64) -> bool {
    value.unsigned_abs() < 1 << 26 && 2 * (if b.upper { value } else { -value }) < i64::from(b.bound)
}
