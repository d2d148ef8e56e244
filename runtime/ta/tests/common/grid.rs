//! Random networks in which clocks stand still, and a judge that tries all times of a grid.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_ir::{
    Program,
    ta::{ClockConstraint, ClockId, ClockOp, EdgeAssignment, LocationId, LocationKind},
    value::SECOND,
};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::{E, add, automaton, clock, edge, eq, location, n, program, shared, v};

pub const MOST: i64 = 4;
/// Parts of a second in the judge's grid.
pub const GRID: i64 = 6;

fn bound(rng: &mut ChaCha8Rng, ops: &[ClockOp], clocks: u16) -> ClockConstraint {
    clock(rng.random_range(0..clocks), ops[rng.random_range(0..ops.len())], rng.random_range(0..=MOST))
}

/// A shared clock, two automata with a clock each, and an int; closed bounds of whole seconds.
pub fn random(rng: &mut ChaCha8Rng) -> Program {
    let mut p = program();
    p.clocks.push("s".into());
    shared(&mut p, "k", 0, 2, 0);
    for name in ["P", "Q"] {
        let mut a = automaton(name, &["x"]);
        for l in 0..3 {
            let ends = rng.random_bool(0.4).then(|| bound(rng, &[ClockOp::Le], 2));
            let at = location(&mut a, &format!("l{l}"), LocationKind::Normal, ends.as_slice());
            for c in 0..2 {
                if rng.random_bool(0.35) {
                    a.locations[usize::from(at.0)].stopped.push(ClockId(c));
                }
            }
        }
        for _ in 0..rng.random_range(3..6) {
            random_edge(rng).to(&mut a);
        }
        add(&mut p, a);
    }
    p
}

fn random_edge(rng: &mut ChaCha8Rng) -> E {
    let mut place = || LocationId(rng.random_range(0..3));
    let mut e = edge(place(), place());
    for _ in 0..rng.random_range(0..3) {
        e.0.clock_guard.push(bound(rng, &[ClockOp::Le, ClockOp::Ge, ClockOp::Eq], 2));
    }
    if rng.random_bool(0.3) {
        e = e.when(eq(v(0), n(rng.random_range(0..3))));
    }
    if rng.random_bool(0.4) {
        e = e.set(0, n(rng.random_range(0..3)));
    }
    if rng.random_bool(0.4) {
        e = e.reset(rng.random_range(0..2));
    }
    e
}

/// A state of the judge: locations, the int, the clocks in parts of a second (the shared one, then each automaton's).
pub type GridState = ([usize; 2], i64, [i64; 3]);

/// All locations that are reached at times of a grid, by trying everything: a reading of the language's page of its own.
pub struct GridJudge<'p> {
    pub p: &'p Program,
    pub grid: i64,
}

impl GridJudge<'_> {
    fn clock_of(automaton: usize, c: ClockId) -> usize {
        if c.0 == 0 { 0 } else { 1 + automaton }
    }

    fn holds(&self, automaton: usize, c: &ClockConstraint, clocks: &[i64; 3]) -> bool {
        let bound = c.bound.nanos / SECOND * self.grid;
        let value = clocks[Self::clock_of(automaton, c.clock)];
        match c.op {
            ClockOp::Le => value <= bound,
            ClockOp::Ge => value >= bound,
            ClockOp::Eq => value == bound,
            ClockOp::Lt | ClockOp::Gt => unreachable!("bounds are closed"),
        }
    }

    fn allowed(&self, (at, _, clocks): &GridState) -> bool {
        (0..2).all(|a| self.p.automata[a].locations[at[a]].invariant.iter().all(|c| self.holds(a, c, clocks)))
    }

    /// What the edges lead to.
    fn taken(&self, state: &GridState) -> Vec<GridState> {
        let (at, k, clocks) = state;
        let mut all = Vec::new();
        for a in 0..2 {
            for e in self.p.automata[a].edges.iter().filter(|e| usize::from(e.from.0) == at[a]) {
                let data = e.guard.as_ref().is_none_or(|g| {
                    let value = g.eval(&|_| Some(hrdsl_ir::Value::Int(*k))).unwrap();
                    value.as_bool().unwrap()
                });
                if !data || !e.clock_guard.iter().all(|c| self.holds(a, c, clocks)) {
                    continue;
                }
                let mut then = (*at, *k, *clocks);
                then.0[a] = usize::from(e.to.0);
                for u in &e.updates {
                    match u {
                        EdgeAssignment::Assign { value, .. } => {
                            then.1 = value.eval(&|_| None).unwrap().as_int().unwrap();
                        }
                        EdgeAssignment::Reset { clock, .. } => then.2[Self::clock_of(a, *clock)] = 0,
                        EdgeAssignment::Call { .. } => unreachable!("there are no functions"),
                    }
                }
                all.push(then);
            }
        }
        all.retain(|s| self.allowed(s));
        all
    }

    /// A part of a second later.
    fn later(&self, state: &GridState) -> Option<GridState> {
        let (at, _, clocks) = state;
        let mut later = *state;
        for (x, clock) in clocks.iter().enumerate() {
            let stands = (0..2).any(|a| {
                let stopped = &self.p.automata[a].locations[at[a]].stopped;
                stopped.iter().any(|c| Self::clock_of(a, *c) == x)
            });
            // Beyond all constants, values are alike.
            later.2[x] = (clock + i64::from(!stands)).min((MOST + 1) * self.grid);
        }
        Some(later).filter(|s| self.allowed(s))
    }

    fn next(&self, state: &GridState) -> Vec<GridState> {
        self.taken(state).into_iter().chain(self.later(state)).collect()
    }

    /// Nothing is possible in it, now or later.
    pub fn is_deadlock(&self, state: &GridState) -> bool {
        let mut now = *state;
        loop {
            if !self.taken(&now).is_empty() {
                return false;
            }
            match self.later(&now) {
                Some(later) if later != now => now = later,
                Some(_) | None => return true,
            }
        }
    }

    /// All states, with the parts of a second after which each is reached first.
    pub fn states(&self) -> BTreeMap<GridState, i64> {
        let start = ([0, 0], 0, [0; 3]);
        let (mut seen, mut now, mut time) = (BTreeMap::new(), BTreeSet::from([start]), 0);
        now.retain(|s| self.allowed(s));
        while !now.is_empty() {
            let mut waiting: Vec<GridState> = now.iter().copied().filter(|s| !seen.contains_key(s)).collect();
            let mut then = BTreeSet::new();
            while let Some(state) = waiting.pop() {
                if seen.contains_key(&state) {
                    continue;
                }
                seen.insert(state, time);
                waiting.extend(self.taken(&state));
                then.extend(self.later(&state));
            }
            time += 1;
            now = then;
            now.retain(|s| !seen.contains_key(s));
        }
        seen
    }

    /// Whether some maximal run from one of these states keeps among states of that kind.
    pub fn stays(&self, from: &[GridState], keeps: &dyn Fn(&GridState) -> bool) -> bool {
        let mut left: BTreeSet<GridState> = BTreeSet::new();
        let mut waiting: Vec<GridState> = from.iter().copied().filter(|s| keeps(s)).collect();
        let mut next: BTreeMap<GridState, Vec<GridState>> = BTreeMap::new();
        while let Some(state) = waiting.pop() {
            if left.insert(state) {
                let all = self.next(&state);
                waiting.extend(all.iter().copied().filter(|s| keeps(s)));
                next.insert(state, all);
            }
        }
        if next.values().any(Vec::is_empty) {
            return true;
        }
        // What leads to nothing that is left has no run; what is left in the end has one without end.
        loop {
            let count = left.len();
            let still = |s: &GridState| next[s].iter().any(|then| left.contains(then));
            left = left.iter().copied().filter(still).collect();
            if left.len() == count {
                return !left.is_empty();
            }
        }
    }

    pub fn reached(&self) -> BTreeSet<(usize, usize)> {
        let start = ([0, 0], 0, [0; 3]);
        let (mut seen, mut out) = (BTreeSet::new(), BTreeSet::new());
        if self.allowed(&start) {
            seen.insert(start);
        }
        let mut waiting: Vec<GridState> = seen.iter().copied().collect();
        while let Some(state) = waiting.pop() {
            out.extend([(0, state.0[0]), (1, state.0[1])]);
            waiting.extend(self.next(&state).into_iter().filter(|s| seen.insert(*s)));
        }
        out
    }
}
