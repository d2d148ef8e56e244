//! The bounds on clocks that a model has: each with its place, and the model without some of them or with others.

use hrdsl_ir::{
    Nanos, Program, Span,
    ta::{AutomatonId, ClockConstraint, ClockId, ClockOp, EdgeAssignment, TimeSum},
};

use crate::{model::SystemModel, walk::WatchedBound};

/// What a bound is a part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BoundPlace {
    /// The guard of this edge.
    Guard(usize),
    /// The invariant of this location.
    Invariant(usize),
}

/// A bound of a model: a comparison of one clock with a time.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelBound {
    /// Index in the model's network.
    member: usize,
    automaton: AutomatonId,
    place: BoundPlace,
    /// Which of the constraints there.
    number: usize,
    pub(crate) clock: ClockId,
    pub(crate) op: ClockOp,
    pub(crate) time: Nanos,
}

/// All bounds of a model that compare one clock with a time without variables.
pub(crate) fn bounds(program: &Program, model: &SystemModel) -> Vec<ModelBound> {
    let mut all = Vec::new();
    for (member, id) in model.network.automata.iter().enumerate() {
        let automaton = program.automaton(*id);
        let invariants = automaton.locations.iter().map(|l| &l.invariant).enumerate();
        let invariants = invariants.map(|(at, constraints)| (BoundPlace::Invariant(at), constraints));
        let guards = automaton.edges.iter().map(|e| &e.clock_guard).enumerate();
        let guards = guards.map(|(at, constraints)| (BoundPlace::Guard(at), constraints));
        for (place, constraints) in invariants.chain(guards) {
            for (number, constraint) in constraints.iter().enumerate() {
                let Some(time) = constraint.bound.fixed().filter(|_| constraint.minus.is_none()) else {
                    continue;
                };
                let (clock, op) = (constraint.clock, constraint.op);
                all.push(ModelBound { member, automaton: *id, place, number, clock, op, time });
            }
        }
    }
    all
}

impl ModelBound {
    /// `Robot: move -> send`, `Robot.move`, and where that is written.
    pub(crate) fn site(&self, program: &Program) -> (String, Span) {
        let automaton = program.automaton(self.automaton);
        let name = &automaton.name;
        match self.place {
            BoundPlace::Guard(at) => match automaton.edges.get(at) {
                Some(edge) => {
                    let (from, to) = (&automaton.location(edge.from).name, &automaton.location(edge.to).name);
                    (format!("{name}: {from} -> {to}"), edge.origin)
                }
                None => (name.clone(), automaton.origin),
            },
            BoundPlace::Invariant(at) => match automaton.locations.get(at) {
                Some(location) => (format!("{name}.{}", location.name), location.origin),
                None => (name.clone(), automaton.origin),
            },
        }
    }

    /// The name of its clock.
    pub(crate) fn clock_name(&self, program: &Program) -> String {
        let own = &program.automaton(self.automaton).clocks;
        let mut all = program.clocks.iter().chain(own);
        all.nth(usize::from(self.clock.0)).cloned().unwrap_or_default()
    }

    /// Its clock, and the edges at which its clock is looked at: that of the guard, or those that leave the location or set the clock.
    pub(crate) fn watched(&self, program: &Program, model: &SystemModel) -> WatchedBound {
        let automaton = program.automaton(self.automaton);
        let sets = |edge: &hrdsl_ir::ta::Edge| {
            edge.updates.iter().any(|update| match update {
                EdgeAssignment::Reset { clock, .. } => *clock == self.clock,
                EdgeAssignment::Assign { .. } | EdgeAssignment::Call { .. } => false,
            })
        };
        let edges = match self.place {
            BoundPlace::Guard(at) => vec![at],
            BoundPlace::Invariant(at) => {
                let leaves = |edge: &hrdsl_ir::ta::Edge| {
                    usize::from(edge.from.0) == at && (usize::from(edge.to.0) != at || sets(edge))
                };
                let edges = automaton.edges.iter().enumerate();
                edges.filter(|(_, edge)| leaves(edge)).map(|(number, _)| number).collect()
            }
        };
        let shared = program.clocks.len();
        let before = model.network.automata.iter().take(self.member);
        let before: usize = before.map(|id| program.automaton(*id).clocks.len()).sum();
        let number = usize::from(self.clock.0);
        let clock = 1 + number + if number < shared { 0 } else { before };
        WatchedBound { automaton: self.member, edges, clock }
    }

    fn constraints<'p>(&self, program: &'p mut Program) -> Option<&'p mut Vec<ClockConstraint>> {
        let automaton = program.automata.get_mut(usize::from(self.automaton.0))?;
        match self.place {
            BoundPlace::Guard(at) => automaton.edges.get_mut(at).map(|edge| &mut edge.clock_guard),
            BoundPlace::Invariant(at) => automaton.locations.get_mut(at).map(|l| &mut l.invariant),
        }
    }
}

/// The bounds with what stands in the place of each: nothing, or comparisons with other times.
pub(crate) fn replaced(program: &Program, bounds: &[(ModelBound, Vec<(ClockOp, Nanos)>)]) -> Program {
    let mut changed = program.clone();
    let mut order: Vec<&(ModelBound, Vec<(ClockOp, Nanos)>)> = bounds.iter().collect();
    // From the last one on, so that the numbers of the others stay true.
    order.sort_by_key(|(bound, _)| std::cmp::Reverse(bound.number));
    for (bound, instead) in order {
        let Some(constraints) = bound.constraints(&mut changed) else { continue };
        if bound.number < constraints.len() {
            constraints.remove(bound.number);
        }
        constraints.extend(instead.iter().map(|(op, time)| ClockConstraint {
            clock: bound.clock,
            minus: None,
            op: *op,
            bound: TimeSum::constant(*time),
        }));
    }
    changed
}
