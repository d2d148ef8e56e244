//! How far a counter can come, from the network's structure alone.
//!
//! Whoever raises it without a guard on it goes along a path of such edges, and each automaton can do that only so far: until a
//! cycle takes it past a guard. So it is at most what the last guarded (or setting) edge leaves, and what each automaton can add
//! after that.

use crate::{
    network::{
        code::CompiledExpr,
        model::CompiledNetwork,
        parts::{CompiledEdge, EdgeUpdate},
    },
    search::counter_steps::{narrow, single, step},
};

/// Whether all additions to a counter keep it in its range in all that can be reached.
pub(super) fn stays_in_range(model: &CompiledNetwork, counter: u32) -> bool {
    [1, -1].into_iter().all(|sign| CounterReach { model, counter, sign }.is_bounded())
}

/// One direction of a counter: `sign` times its value only matters where it grows.
struct CounterReach<'m, 'p> {
    model: &'m CompiledNetwork<'p>,
    counter: u32,
    sign: i64,
}

/// What an edge does to a counter, in the direction that is looked at.
#[derive(Clone, Copy)]
struct EdgeEffect {
    /// What the guard lets it be before, at most; `None`: anything.
    guard: Option<i64>,
    /// What it is set to, at most.
    set: Option<i64>,
    /// What is added, at least 0.
    adds: i64,
}

impl CounterReach<'_, '_> {
    fn is_bounded(&self) -> bool {
        let (lo, hi) = self.model.ranges()[self.counter as usize];
        let end = if self.sign > 0 { i128::from(hi) } else { -i128::from(lo) };
        let effects: Vec<Vec<EdgeEffect>> =
            self.model.members.iter().map(|m| m.edges.iter().map(|e| self.effect(e)).collect()).collect();
        if effects.iter().flatten().all(|e| e.adds == 0) {
            return true;
        }
        let start = i128::from(self.sign * self.model.initial()[self.counter as usize]);
        let together: i128 = effects.iter().map(|of| i128::from(self.at_once(of))).sum();
        let lasting = effects.iter().flatten().filter_map(|e| {
            let least = e.set.or(e.guard)?;
            // What others add in the same transition may come before it or after it.
            Some(i128::from(least) + together)
        });
        let base = lasting.fold(start, i128::max);
        let after: Option<i128> =
            effects.iter().enumerate().map(|(m, of)| self.unguarded(m, of).map(i128::from)).sum();
        after.is_some_and(|after| base + after <= end)
    }

    fn effect(&self, edge: &CompiledEdge) -> EdgeEffect {
        let (lo, hi) = self.model.ranges()[self.counter as usize];
        let (mut least, mut most) = (lo, hi);
        if let Some(guard) = &edge.data {
            narrow(guard, self.counter, &mut least, &mut most);
        }
        let bound = if self.sign > 0 { most } else { -least };
        let guard = (bound < if self.sign > 0 { hi } else { -lo }).then_some(bound);
        let mut effect = EdgeEffect { guard, set: None, adds: 0 };
        for update in &edge.updates {
            let EdgeUpdate::Assign(place, value) = update else { continue };
            if single(place) != Some(self.counter) {
                continue;
            }
            match step(self.counter, value) {
                Some(by) => effect.adds = effect.adds.saturating_add((self.sign * by).max(0)),
                None => effect.set = Some(self.most(edge, value, (lo, hi))),
            }
        }
        effect
    }

    /// The most that a value can be that is in the range.
    fn most(&self, edge: &CompiledEdge, value: &CompiledExpr, (lo, hi): (i64, i64)) -> i64 {
        let (least, most, _) = value.span(&self.model.library, &edge.locals(&self.model.library));
        if self.sign > 0 { most.min(hi) } else { -least.max(lo) }
    }

    /// What one of these edges adds at most.
    fn at_once(&self, effects: &[EdgeEffect]) -> i64 {
        effects.iter().map(|e| e.adds).max().unwrap_or(0)
    }

    /// What a path of edges that neither have a guard on it nor set it adds at most; `None`: without end.
    fn unguarded(&self, member: usize, effects: &[EdgeEffect]) -> Option<i64> {
        let member = &self.model.members[member];
        let free = || {
            let all = member.edges.iter().zip(effects);
            all.filter(|(_, e)| e.guard.is_none() && e.set.is_none())
        };
        let mut most = vec![0i64; member.locations.len()];
        for _ in 0..=member.locations.len() {
            let mut changed = false;
            for (edge, effect) in free() {
                let here = most[edge.from()].saturating_add(effect.adds);
                changed |= here > most[edge.to()];
                most[edge.to()] = most[edge.to()].max(here);
            }
            if !changed {
                return most.into_iter().max();
            }
        }
        None
    }
}
