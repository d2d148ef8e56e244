//! All that may happen in a discrete state, one transition after the other.

use std::{ops::ControlFlow, rc::Rc};

use hrdsl_ir::EventId;

use crate::{
    network::{
        code::{CodeEvalError, SyncMedium},
        error::ModelError,
        model::CompiledNetwork,
        semantics::{
            ClockReset, CompiledMove, EnumerationScratch, FiringOrError, NoConstraintFilter,
            TransitionEffect, TransitionFiring,
        },
    },
    zone::{constraint::DifferenceConstraint, dbm::DbmBound},
};

/// A transition of a path.
#[derive(Clone, Debug)]
pub(crate) struct PathTransition {
    /// In the order of their updates.
    pub parts: Vec<CompiledMove>,
    pub medium: Option<SyncMedium>,
    pub args: Vec<i64>,
    pub guard: Vec<DifferenceConstraint>,
    pub resets: Vec<ClockReset>,
}

/// Something that may happen in a discrete state.
#[derive(Clone)]
pub(crate) struct EnabledTransition {
    pub taken: Rc<PathTransition>,
    /// Where the transition would make a clock negative, and the fault that this is.
    pub below: Vec<(DifferenceConstraint, ModelError)>,
    /// The discrete state after it; it may be one that the invariants over variables forbid.
    pub target: Result<Vec<i64>, Box<ModelError>>,
}

/// What staying in a discrete state means.
#[derive(Clone, Debug)]
pub(crate) struct DelayCondition {
    pub invariant: Vec<DifferenceConstraint>,
    /// Time may pass.
    pub waits: bool,
    /// The clocks that stand still meanwhile, ascending.
    pub stopped: Vec<u16>,
}

impl DelayCondition {
    /// Time may pass for ever.
    pub(crate) fn for_ever(&self) -> bool {
        let ends = |c: &DifferenceConstraint| {
            c.i != 0 && c.j == 0 && !c.bound.is_infinite() && !self.stopped.contains(&c.i)
        };
        self.waits && !self.invariant.iter().any(ends)
    }
}

/// What an enumeration tells what it has found.
type FoundFiring<'f> = dyn FnMut(FiringOrError) -> ControlFlow<()> + 'f;

impl CompiledNetwork<'_> {
    /// All that may happen in a discrete state, in the network's order.
    pub(crate) fn actions(&self, state: &[i64]) -> Vec<EnabledTransition> {
        let mut out = Vec::new();
        self.each_action(state, &mut |action| {
            out.push(action);
            ControlFlow::Continue(())
        });
        out
    }

    /// Calls `f` with all that may happen in a discrete state, in the network's order, until it breaks off.
    pub(crate) fn each_action(&self, state: &[i64], f: &mut dyn FnMut(EnabledTransition) -> ControlFlow<()>) {
        let mut own = state.to_vec();
        let mut enumerate = |scratch: &mut EnumerationScratch, found: &mut FoundFiring| {
            let _ = self.enumerate(&mut own, &NoConstraintFilter, scratch, found);
        };
        self.collected(state, &mut enumerate, f);
    }

    /// All that the network may do about an event from outside.
    pub(crate) fn receptions(&self, state: &[i64], event: EventId, args: &[i64]) -> Vec<EnabledTransition> {
        let (mut own, mut out) = (state.to_vec(), Vec::new());
        let mut enumerate = |scratch: &mut EnumerationScratch, found: &mut FoundFiring| {
            let _ = self.received(&mut own, (event, args), scratch, found);
        };
        self.collected(state, &mut enumerate, &mut |action| {
            out.push(action);
            ControlFlow::Continue(())
        });
        out
    }

    fn collected(
        &self,
        state: &[i64],
        enumerate: &mut dyn FnMut(&mut EnumerationScratch, &mut FoundFiring),
        f: &mut dyn FnMut(EnabledTransition) -> ControlFlow<()>,
    ) {
        let (mut scratch, mut stack, mut effect) =
            (EnumerationScratch::default(), Vec::new(), TransitionEffect::default());
        let mut found = |found: FiringOrError| -> ControlFlow<()> {
            let action = match found {
                FiringOrError::Firing(firing) => self.action(state, &firing, &mut stack, &mut effect),
                FiringOrError::Fault { member, edge, fault, guard } => {
                    let error = self.fault(usize::from(member), usize::from(edge), fault);
                    let (parts, args, resets) = (Vec::new(), Vec::new(), Vec::new());
                    let taken = PathTransition { parts, medium: None, args, guard: guard.to_vec(), resets };
                    Some(EnabledTransition {
                        taken: Rc::new(taken),
                        below: Vec::new(),
                        target: Err(Box::new(error)),
                    })
                }
            };
            action.map_or(ControlFlow::Continue(()), &mut *f)
        };
        enumerate(&mut scratch, &mut found);
    }

    /// `None`: a limit forbids it.
    fn action(
        &self,
        state: &[i64],
        firing: &TransitionFiring,
        stack: &mut Vec<i64>,
        effect: &mut TransitionEffect,
    ) -> Option<EnabledTransition> {
        let named = |(m, e, f): (u16, u16, CodeEvalError)| self.fault(usize::from(m), usize::from(e), f);
        let target = match self.effect(state, firing, stack, effect) {
            Ok(false) => return None,
            Ok(true) => Ok(effect.target.clone()),
            Err(fault) => Err(Box::new(named(fault))),
        };
        let below = effect.below.iter().map(|b| {
            let bound = DbmBound::lt(-b.reset.by);
            let fault = CodeEvalError::Negative { clock: b.reset.clock };
            (DifferenceConstraint { i: b.reset.from, j: 0, bound }, named((b.member, b.edge, fault)))
        });
        let below = below.collect();
        let taken = PathTransition {
            parts: firing.parts.to_vec(),
            medium: firing.medium,
            args: firing.args.to_vec(),
            guard: firing.guard.to_vec(),
            resets: if target.is_ok() { effect.resets.clone() } else { Vec::new() },
        };
        Some(EnabledTransition { taken: Rc::new(taken), below, target })
    }

    pub(crate) fn target(&self, state: &[i64], taken: &PathTransition) -> Result<Vec<i64>, ModelError> {
        let mut effect = TransitionEffect::default();
        let PathTransition { parts, medium, args, guard, .. } = taken;
        let firing = TransitionFiring { parts, medium: *medium, args, guard };
        match self.effect(state, &firing, &mut Vec::new(), &mut effect) {
            Ok(_) => Ok(effect.target),
            Err((m, e, f)) => Err(self.fault(usize::from(m), usize::from(e), f)),
        }
    }

    pub(crate) fn stay(&self, state: &[i64]) -> Result<Option<DelayCondition>, ModelError> {
        let (mut own, mut stack, mut invariant) = (state.to_vec(), Vec::new(), Vec::new());
        if !self.invariant(&mut own, &mut stack, &mut invariant)? {
            return Ok(None);
        }
        let waits = self.may_delay(&mut own, &mut EnumerationScratch::default());
        Ok(Some(DelayCondition { invariant, waits, stopped: self.stopped(state) }))
    }
}
