//! One-way counters: variables that everything looks at in one direction, so that of two values the better can do all that the
//! other can.
//!
//! A variable `n` is one where the *lesser* value is better if each read of it is a comparison that a lesser value satisfies, too
//! (`n < 7` in a guard, in an invariant, in a goal, never under an odd number of `not`), and each assignment to it keeps the order
//! of two values: `n += k` and `n -= k` with a constant, or a value that does not depend on such a counter. So a state that differs
//! from another only in that its counters are better simulates it: what is enabled there is enabled here, leads to the same
//! locations, variables and clocks, and again to counters that are no worse. Where the *greater* is better, all is the other way round.
//!
//! Of a counter whose overflow is [sought](OverflowTreatment::Sought) or [avoided](OverflowTreatment::Avoided) the additions, too, look one
//! way: towards the overflow, or away from it.
//!
//! What would see the difference the other way disqualifies a variable: a fault (an assignment must be known to stay in its range, by
//! the edge's own guard or by how far the counter can come at all; an expression that may have no value reads nothing one way), the guard of a receiver that may
//! stay away (there its negation counts, too), a guard over an urgent channel (where it holds, time must not pass), bounds of clocks,
//! arguments, indices and functions. The same is said, for people, in `spec/search.md`.

use crate::{
    network::{
        code::{CompiledExpr, CompiledLvalue, SyncMedium},
        model::{CompiledNetwork, OverflowTreatment},
        number::NumberComparison,
        parts::{ClockConstraints, CompiledEdge, EdgeSync, EdgeUpdate},
    },
    search::{
        counter_steps::{narrow, single, step, sum},
        goals::{CompiledGoals, SymbolicFormula},
        options::SearchOrder,
        reach_of_counter,
    },
};

/// Below this many values a variable costs less as a part of the discrete state.
const WORTH_IT: i64 = 16;

/// A number of the state of which one value is better than another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct OneWayCounter {
    pub place: usize,
    best: i64,
    lesser: bool,
}

impl OneWayCounter {
    /// How far a value is from the best: the less, the better.
    pub(crate) fn rank(&self, value: i64) -> u32 {
        // INVARIANT: `counters` takes no range that is too wide.
        value.abs_diff(self.best) as u32
    }

    pub(crate) fn value(&self, rank: u32) -> i64 {
        if self.lesser { self.best + i64::from(rank) } else { self.best - i64::from(rank) }
    }
}

/// Whether all of these are as good as those, or better.
pub(crate) fn no_worse(these: &[u32], those: &[u32]) -> bool {
    these.iter().zip(those).all(|(a, b)| a <= b)
}

/// Whether a new state with these drives out one that was stored before, with those. Breadth first only what is stored later may
/// be left out, not what waits: a run through the better counters may be the longer one.
pub(crate) fn may_drive_out(order: SearchOrder, these: &[u32], those: &[u32]) -> bool {
    match order {
        SearchOrder::Breadth | SearchOrder::RandomBreadth => these == those,
        SearchOrder::Depth | SearchOrder::RandomDepth | SearchOrder::Topological => no_worse(these, those),
    }
}

/// The network's counters, among the numbers of the state that matter.
pub(crate) fn counters(
    model: &CompiledNetwork,
    goals: &CompiledGoals,
    matters: &[bool],
) -> Vec<OneWayCounter> {
    let mut reads =
        OneWayReads { model, lesser: vec![true; model.size()], greater: vec![true; model.size()] };
    reads.network();
    reads.goals(goals);
    (0..model.slots.len())
        .filter(|&slot| !model.slots[slot].is_bool && model.slots[slot].enumeration.is_none())
        .map(|slot| model.slot_at(slot))
        .filter(|&place| matters[place])
        .filter_map(|place| {
            let (lo, hi) = model.ranges()[place];
            let width = hi.checked_sub(lo).filter(|w| *w >= WORTH_IT - 1 && *w < 1 << 30);
            width?;
            let lesser = reads.lesser[place];
            (lesser || reads.greater[place]).then_some(OneWayCounter {
                place,
                best: if lesser { lo } else { hi },
                lesser,
            })
        })
        .collect()
}

/// By place of the state: whether all that looks at it is content with a lesser value, or with a greater.
struct OneWayReads<'m, 'p> {
    model: &'m CompiledNetwork<'p>,
    lesser: Vec<bool>,
    greater: Vec<bool>,
}

impl OneWayReads<'_, '_> {
    fn both_ways(&mut self, place: u32) {
        self.lesser[place as usize] = false;
        self.greater[place as usize] = false;
    }

    /// Whatever it reads is read both ways.
    fn taint(&mut self, code: &CompiledExpr) {
        let mut all = Vec::new();
        code.each_var(&self.model.library, &mut |i| all.push(i));
        all.into_iter().for_each(|i| self.both_ways(i));
    }

    fn wants(&mut self, place: u32, lesser: bool) {
        let other = if lesser { &mut self.greater } else { &mut self.lesser };
        other[place as usize] = false;
    }

    /// A condition that should hold (or not hold) as often as possible.
    fn condition(&mut self, code: &CompiledExpr, locals: &[(i64, i64)], holds: bool) {
        // What may have no value is a fault, which is seen both ways.
        if !code.span(&self.model.library, locals).2 {
            return self.taint(code);
        }
        self.sure_condition(code, holds);
    }

    fn sure_condition(&mut self, code: &CompiledExpr, holds: bool) {
        match code {
            CompiledExpr::VarConst(op, i, _) => self.compares(*op, holds, &[*i], &[]),
            CompiledExpr::VarVar(op, i, j) => self.compares(*op, holds, &[*i], &[*j]),
            CompiledExpr::And(ab) | CompiledExpr::Or(ab) => {
                self.sure_condition(&ab.0, holds);
                self.sure_condition(&ab.1, holds);
            }
            CompiledExpr::Not(a) => self.sure_condition(a, !holds),
            CompiledExpr::Compare(op, ab) => match (sum(&ab.0), sum(&ab.1)) {
                (Some(a), Some(b)) => {
                    let left: Vec<u32> = a.plus.iter().chain(&b.minus).copied().collect();
                    let right: Vec<u32> = a.minus.iter().chain(&b.plus).copied().collect();
                    self.compares(*op, holds, &left, &right);
                }
                _ => self.taint(code),
            },
            CompiledExpr::Const(_)
            | CompiledExpr::Var(_)
            | CompiledExpr::Local(_)
            | CompiledExpr::Arith(..)
            | CompiledExpr::Neg(_)
            | CompiledExpr::Abs(_)
            | CompiledExpr::If(_)
            | CompiledExpr::Element(_)
            | CompiledExpr::Apply(..)
            | CompiledExpr::Convert(..)
            | CompiledExpr::Generic(_) => self.taint(code),
        }
    }

    fn compares(&mut self, op: NumberComparison, holds: bool, left: &[u32], right: &[u32]) {
        let lesser = match op {
            NumberComparison::Lt | NumberComparison::Le => holds,
            NumberComparison::Gt | NumberComparison::Ge => !holds,
            NumberComparison::Eq | NumberComparison::Ne => {
                return left.iter().chain(right).for_each(|i| self.both_ways(*i));
            }
        };
        left.iter().for_each(|i| self.wants(*i, lesser));
        right.iter().for_each(|i| self.wants(*i, !lesser));
    }

    fn clocks(&mut self, clocks: &ClockConstraints) {
        clocks.moving.iter().flat_map(|m| &m.time.terms).for_each(|t| self.taint(&t.1));
    }

    fn network(&mut self) {
        let model = self.model;
        for (m, member) in model.members.iter().enumerate() {
            for spot in &member.locations {
                self.clocks(&spot.invariant);
                spot.holds.iter().for_each(|h| self.condition(h, &[], true));
            }
            for edge in &member.edges {
                self.edge(m, edge);
            }
        }
    }

    fn edge(&mut self, member: usize, edge: &CompiledEdge) {
        let locals = edge.locals(&self.model.library);
        self.clocks(&edge.guard);
        if let Some(guard) = &edge.data {
            if self.is_negated(edge) { self.taint(guard) } else { self.condition(guard, &locals, true) }
        }
        if let EdgeSync::Out(signal) = &edge.sync {
            signal.args.iter().for_each(|a| self.taint(&a.code));
        }
        for update in &edge.updates {
            match update {
                EdgeUpdate::Reset { to, .. } => to.terms.iter().for_each(|t| self.taint(&t.1)),
                EdgeUpdate::Call(routine, args) => {
                    args.iter().for_each(|a| self.taint(a));
                    let mut all = Vec::new();
                    self.model.library.each_read(*routine, &mut |i| all.push(i));
                    self.model.library.each_written(*routine, &mut |i| all.push(i));
                    all.into_iter().for_each(|i| self.both_ways(i));
                }
                EdgeUpdate::Assign(place, value) => self.assignment(member, edge, place, value),
            }
        }
    }

    /// Whether somebody acts where the edge's guard does not hold: others go without it, or time passes.
    fn is_negated(&self, edge: &CompiledEdge) -> bool {
        let urgent = |medium: SyncMedium| match medium {
            SyncMedium::Channel(c) => self.model.program.channels[usize::from(c.0)].urgent,
            SyncMedium::Event(_) => false,
        };
        match &edge.sync {
            EdgeSync::Internal => false,
            EdgeSync::Out(signal) => urgent(signal.medium),
            EdgeSync::In(pattern) => pattern.broadcast || urgent(pattern.medium),
            EdgeSync::Join { channel, optional } => *optional || urgent(SyncMedium::Channel(*channel)),
        }
    }

    fn assignment(
        &mut self,
        member: usize,
        edge: &CompiledEdge,
        place: &CompiledLvalue,
        value: &CompiledExpr,
    ) {
        let Some(counter) = single(place) else {
            let mut all = Vec::new();
            place.targets(&mut |i| all.push(i));
            place.indices.iter().for_each(|i| i.0.each_var(&self.model.library, &mut |i| all.push(i)));
            all.into_iter().for_each(|i| self.both_ways(i));
            return self.taint(value);
        };
        match (step(counter, value), self.model.overflow_at(counter)) {
            // Upwards the greater value comes to its overflow with the lesser one, and perhaps before it; downwards the lesser.
            (Some(by), Some(treatment)) if by != 0 => {
                self.wants(counter, (by > 0) == (treatment == OverflowTreatment::Avoided));
            }
            (Some(_), Some(_)) => {}
            (Some(_), None) if self.stays_in_range(member, edge, counter) => {}
            (Some(_), None) if reach_of_counter::stays_in_range(self.model, counter) => {}
            (Some(_), None) => self.both_ways(counter),
            (None, _) => self.taint(value),
        }
    }

    /// Whether no update of the edge takes the counter out of its range, whatever the others in the same transition have added.
    fn stays_in_range(&self, member: usize, edge: &CompiledEdge, counter: u32) -> bool {
        let (least, most) = self.model.ranges()[counter as usize];
        let (mut lo, mut hi) = (least, most);
        if let Some(guard) = &edge.data {
            narrow(guard, counter, &mut lo, &mut hi);
        }
        if !matches!(edge.sync, EdgeSync::Internal) {
            let Some((down, up)) = self.of_others(member, counter) else { return false };
            (lo, hi) = (lo.saturating_add(down).max(least), hi.saturating_add(up).min(most));
        }
        for update in &edge.updates {
            let EdgeUpdate::Assign(place, value) = update else { continue };
            if single(place) != Some(counter) {
                continue;
            }
            match step(counter, value) {
                Some(by) => (lo, hi) = (lo.saturating_add(by), hi.saturating_add(by)),
                // Its value, and whether it is a fault, is the same whatever the counter is.
                None => (lo, hi) = (least, most),
            }
            if lo < least || hi > most {
                return false;
            }
        }
        true
    }

    /// What the other automata may add to a counter in the same transition, at least and at most; `None`: they set it.
    fn of_others(&self, member: usize, counter: u32) -> Option<(i64, i64)> {
        let (mut down, mut up) = (0i64, 0i64);
        for (_, other) in self.model.members.iter().enumerate().filter(|(m, _)| *m != member) {
            let (mut least, mut most) = (0i64, 0i64);
            for edge in other.edges.iter().filter(|e| !matches!(e.sync, EdgeSync::Internal)) {
                let (mut low, mut high) = (0i64, 0i64);
                for update in &edge.updates {
                    let EdgeUpdate::Assign(place, value) = update else { continue };
                    if single(place) == Some(counter) {
                        let by = step(counter, value)?;
                        (low, high) = (low.saturating_add(by.min(0)), high.saturating_add(by.max(0)));
                    }
                }
                (least, most) = (least.min(low), most.max(high));
            }
            (down, up) = (down.saturating_add(least), up.saturating_add(most));
        }
        Some((down, up))
    }

    fn goals(&mut self, goals: &CompiledGoals) {
        goals.tests.iter().for_each(|t| self.condition(&t.code, &[], true));
        goals.symbolic.iter().for_each(|s| self.formula(&s.2, true));
    }

    fn formula(&mut self, formula: &SymbolicFormula, holds: bool) {
        match formula {
            SymbolicFormula::Data(code) => self.condition(code, &[], holds),
            SymbolicFormula::Clock(c) => c.time.terms.iter().for_each(|t| self.taint(&t.1)),
            SymbolicFormula::Not(a) => self.formula(a, !holds),
            SymbolicFormula::And(all) | SymbolicFormula::Or(all) => {
                all.iter().for_each(|a| self.formula(a, holds));
            }
        }
    }
}
