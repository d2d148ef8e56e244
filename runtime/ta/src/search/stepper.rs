//! The symbolic transition relation: zones before and after transitions, and the delays that follow.
//!
//! A zone has only the clocks that matter in its discrete state ([`ActiveClocks`]). A transition takes them over, sets those that it
//! resets, and forgets the rest, all in one step.

use std::ops::ControlFlow;

use crate::{
    network::{
        code::CodeEvalError,
        error::ModelError,
        model::{CompiledNetwork, OverflowTreatment},
        semantics::{
            ClockReset, ConstraintFilter, EnumerationScratch, FiringOrError, NegativityCheck,
            TransitionEffect, TransitionFiring,
        },
    },
    search::store::{PackedState, PassedList},
    zone::{
        constraint::DifferenceConstraint,
        dbm::{ClockUpperBounds, Dbm, DbmBound, DbmNumber},
        extrapolation::{ActiveClocks, ExtrapolationAbstraction, LuBounds, NONE},
    },
};

/// A symbolic state after a transition.
pub(crate) struct SymbolicSuccessor<'a, N> {
    /// Its number among those of the same symbolic state.
    pub number: u32,
    pub firing: &'a TransitionFiring<'a>,
    pub state: &'a mut Vec<i64>,
    pub frame: &'a ActiveClocks,
    /// Not extrapolated.
    pub zone: &'a mut Dbm<N>,
    pub resets: &'a [ClockReset],
    /// Its discrete state, looked up.
    pub packed: &'a mut PackedState,
}

/// Which clocks zones have, and what is told apart of them.
#[derive(Clone, Copy)]
pub(crate) struct ZoneClocks {
    pub abstraction: ExtrapolationAbstraction,
    /// The time since the start is a clock, too, behind those of the network, up to so many units. Only its least values matter: who
    /// comes later can do no more.
    pub time: Option<i64>,
}

impl ZoneClocks {
    fn frame(self, model: &CompiledNetwork, state: &[i64], out: &mut ActiveClocks) {
        model.extrapolation.frame(state, self.abstraction, out);
        if let Some(most) = self.time {
            out.clocks.push(model.dim as u16);
            out.bounds.push(LuBounds { lower: NONE, upper: most });
        }
    }
}

/// Computes symbolic successors, with memory that it uses again and again.
pub(crate) struct SymbolicStepper<'m, 'p, N> {
    pub model: &'m CompiledNetwork<'p>,
    clocks: ZoneClocks,
    scratch: EnumerationScratch,
    before: Vec<i64>,
    w: StepperWorkspace<N>,
}

struct StepperWorkspace<N> {
    effect: TransitionEffect,
    stack: Vec<i64>,
    scratch: EnumerationScratch,
    guarded: Dbm<N>,
    zone: Dbm<N>,
    frame: ActiveClocks,
    invariant: Vec<DifferenceConstraint>,
    above: ClockUpperBounds<N>,
    from: Vec<(u16, i64)>,
    /// The index in the zone before the transition, by clock of the network.
    index: Vec<u16>,
    packed: PackedState,
}

/// The clock is not in the zone.
const GONE: u16 = u16::MAX;

/// Whether single constraints meet a zone: quick, and wrong in one direction only.
struct ZoneConstraintFilter<'a, N> {
    zone: &'a Dbm<N>,
    index: &'a [u16],
}

impl<N: DbmNumber> ConstraintFilter for ZoneConstraintFilter<'_, N> {
    fn may(&self, c: DifferenceConstraint) -> bool {
        let (i, j) = (self.index[usize::from(c.i)], self.index[usize::from(c.j)]);
        i == GONE || j == GONE || self.zone.meets(usize::from(i), usize::from(j), c.bound)
    }
}

fn constrain<N: DbmNumber>(zone: &mut Dbm<N>, index: &[u16], c: DifferenceConstraint) -> bool {
    let (i, j) = (index[usize::from(c.i)], index[usize::from(c.j)]);
    // INVARIANT: constraints speak of clocks that matter where they are looked at.
    i == GONE || j == GONE || zone.constrain(usize::from(i), usize::from(j), c.bound)
}

/// `dim`: how many clocks there can be in zones, time included.
fn set_index(index: &mut Vec<u16>, frame: &ActiveClocks, dim: usize) {
    index.clear();
    index.resize(dim, GONE);
    for (i, &c) in frame.clocks.iter().enumerate() {
        index[usize::from(c)] = i as u16;
    }
}

impl<'m, 'p, N: DbmNumber> SymbolicStepper<'m, 'p, N> {
    pub(crate) fn new(model: &'m CompiledNetwork<'p>, clocks: ZoneClocks) -> Self {
        let w = StepperWorkspace {
            effect: TransitionEffect::default(),
            stack: Vec::new(),
            scratch: EnumerationScratch::default(),
            guarded: Dbm::zero(1),
            zone: Dbm::zero(1),
            frame: ActiveClocks::default(),
            invariant: Vec::new(),
            above: ClockUpperBounds::new(),
            from: Vec::new(),
            index: Vec::new(),
            packed: PackedState::default(),
        };
        Self { model, clocks, scratch: EnumerationScratch::default(), before: Vec::new(), w }
    }

    /// The symbolic state at the start, not extrapolated.
    ///
    /// # Errors
    /// `Initial` if the invariants do not hold.
    pub(crate) fn initial(&mut self) -> Result<(Vec<i64>, ActiveClocks, Dbm<N>), ModelError> {
        let mut state = self.model.initial();
        let mut frame = ActiveClocks::default();
        self.frame(&state, &mut frame);
        self.w.effect.target.clone_from(&state);
        self.w.zone = Dbm::zero(frame.dim());
        set_index(&mut self.w.index, &frame, self.model.dim + 1);
        self.w.frame.clocks.clone_from(&frame.clocks);
        self.w.frame.bounds.clone_from(&frame.bounds);
        // Clocks that do not matter are zero, too.
        let zero = |c: &DifferenceConstraint| c.bound >= DbmBound::LE_ZERO;
        if !self.model.invariant(&mut state, &mut self.w.stack, &mut self.w.invariant)?
            || !self.w.invariant.iter().all(zero)
            || !self.w.enter(self.model)?
        {
            return Err(ModelError::Initial);
        }
        Ok((state, frame, self.w.zone.clone()))
    }

    /// The clocks that matter in a state, with their bounds.
    pub(crate) fn frame(&self, state: &[i64], out: &mut ActiveClocks) {
        self.clocks.frame(self.model, state, out);
    }

    /// Calls `f` with each symbolic successor, in order, until it breaks off. They are looked up in the store.
    ///
    /// # Errors
    /// A fault of the model that the zone meets.
    pub(crate) fn each<F>(
        &mut self,
        state: &mut [i64],
        frame: &ActiveClocks,
        zone: &Dbm<N>,
        store: &PassedList<N>,
        mut f: F,
    ) -> Result<(), ModelError>
    where
        F: FnMut(SymbolicSuccessor<N>) -> ControlFlow<()>,
    {
        let (model, clocks) = (self.model, self.clocks);
        let mut index = std::mem::take(&mut self.w.index);
        set_index(&mut index, frame, model.dim + 1);
        // The enumeration holds the state itself.
        let mut before = std::mem::take(&mut self.before);
        before.clear();
        before.extend_from_slice(state);
        let (w, scratch) = (&mut self.w, &mut self.scratch);
        let mut number = 0;
        let mut fault = None;
        let mut found = |found: FiringOrError| -> ControlFlow<()> {
            match w.found(model, clocks, &before, (zone, store), &index, &found) {
                Ok(false) => ControlFlow::Continue(()),
                Err(error) => {
                    fault = Some(error);
                    ControlFlow::Break(())
                }
                Ok(true) => {
                    let FiringOrError::Firing(firing) = &found else { return ControlFlow::Continue(()) };
                    number += 1;
                    f(SymbolicSuccessor {
                        number: number - 1,
                        firing,
                        state: &mut w.effect.target,
                        frame: &w.frame,
                        zone: &mut w.zone,
                        resets: &w.effect.resets,
                        packed: &mut w.packed,
                    })
                }
            }
        };
        let _ = model.enumerate(state, &ZoneConstraintFilter { zone, index: &index }, scratch, &mut found);
        self.w.index = index;
        self.before = before;
        fault.map_or(Ok(()), Err)
    }
}

impl<N: DbmNumber> StepperWorkspace<N> {
    /// Whether there is a successor, which is then in `effect`, `frame` and `zone`.
    fn found(
        &mut self,
        model: &CompiledNetwork,
        clocks: ZoneClocks,
        state: &[i64],
        (zone, store): (&Dbm<N>, &PassedList<N>),
        index: &[u16],
        found: &FiringOrError,
    ) -> Result<bool, ModelError> {
        let (FiringOrError::Firing(TransitionFiring { guard, .. }) | FiringOrError::Fault { guard, .. }) =
            found;
        // Without a guard the zone is as it was: no copy is needed.
        let guarded = !guard.is_empty();
        if guarded {
            self.guarded.copy_from(zone);
            if !guard.iter().all(|&c| constrain(&mut self.guarded, index, c)) {
                return Ok(false);
            }
        }
        let firing = match found {
            FiringOrError::Firing(firing) => firing,
            FiringOrError::Fault { member, edge, fault, .. } => {
                return Err(model.fault(usize::from(*member), usize::from(*edge), *fault));
            }
        };
        let effect = model.effect(state, firing, &mut self.stack, &mut self.effect);
        if let Err((_, _, CodeEvalError::Range { at, .. })) = effect
            && model.overflow_at(at) == Some(OverflowTreatment::Avoided)
        {
            return Ok(false);
        }
        let named = |(m, e, f): (u16, u16, _)| model.fault(usize::from(m), usize::from(e), f);
        if !effect.map_err(named)? {
            return Ok(false);
        }
        store.anticipate(&self.effect.target, &mut self.packed);
        let source = if guarded { &self.guarded } else { zone };
        for NegativityCheck { reset, member, edge } in &self.effect.below {
            let x = index[usize::from(reset.from)];
            if x == GONE || source.meets(usize::from(x), 0, DbmBound::lt(-reset.by)) {
                let fault = CodeEvalError::Negative { clock: reset.clock };
                return Err(named((*member, *edge, fault)));
            }
        }
        clocks.frame(model, &self.effect.target, &mut self.frame);
        self.transfer(index, if guarded { None } else { Some(zone) });
        store.look_up(&mut self.packed);
        if !model.invariant(&mut self.effect.target, &mut self.stack, &mut self.invariant)? {
            return Ok(false);
        }
        self.enter(model)
    }

    /// The zone of the clocks that matter after the transition.
    fn transfer(&mut self, index: &[u16], unguarded: Option<&Dbm<N>>) {
        self.from.clear();
        let mut lost = false;
        for &clock in &self.frame.clocks {
            let reset = self.effect.resets.iter().find(|r| r.clock == clock);
            let (x, by) = reset.map_or((clock, 0), |r| (r.from, r.by));
            lost |= index[usize::from(x)] == GONE;
            self.from.push((index[usize::from(x)], by));
        }
        if lost {
            return self.transfer_some(unguarded);
        }
        self.zone.gather(unguarded.unwrap_or(&self.guarded), &self.from);
    }

    /// As [`transfer`](Self::transfer), where nothing is known of some of the clocks.
    fn transfer_some(&mut self, unguarded: Option<&Dbm<N>>) {
        let unknown: Vec<usize> = (0..self.from.len()).filter(|&i| self.from[i].0 == GONE).collect();
        for &i in &unknown {
            self.from[i] = (0, 0);
        }
        self.zone.gather(unguarded.unwrap_or(&self.guarded), &self.from);
        for &x in &unknown {
            for k in 0..self.zone.dim() {
                let above = self.zone.entry(k, 0);
                self.zone.set(x, k, N::INFINITY);
                self.zone.set(k, x, above);
            }
            self.zone.set(x, x, N::LE_ZERO);
        }
    }

    /// Enters the target and delays there; `false`: its invariants forbid it.
    fn enter(&mut self, model: &CompiledNetwork) -> Result<bool, ModelError> {
        let (frame, mut others) = (&self.frame, false);
        // Clocks are in order in both, mostly: the next is looked for behind the last.
        let mut behind = 0;
        let above = self.invariant.iter().filter_map(|c| {
            let x = if c.j == 0 { frame.index_from(behind, c.i) } else { None };
            behind = x.unwrap_or(behind);
            others |= x.is_none();
            Some((x?, N::of(c.bound)))
        });
        self.above.set(frame.dim(), above);
        if !self.zone.constrain_above(&self.above) {
            return Ok(false);
        }
        if others && !self.rest() {
            return Ok(false);
        }
        if model.may_delay(&mut self.effect.target, &mut self.scratch) {
            // Not empty: it has what was there before the delay.
            self.zone.up_within(&self.above);
            if others {
                self.rest();
            }
        }
        Ok(true)
    }

    /// The invariants that are not upper bounds of single clocks.
    fn rest(&mut self) -> bool {
        let (frame, zone) = (&self.frame, &mut self.zone);
        self.invariant.iter().all(|c| {
            let (Some(i), Some(j)) = (frame.index(c.i), frame.index(c.j)) else { return true };
            c.j == 0 || zone.constrain(i, j, c.bound)
        })
    }
}
