//! Random networks with variables that are written and hardly ever read, and that may leave their ranges.

use hrdsl_ir::{
    Program,
    expr::BinaryOp,
    ta::{ChannelKind, ClockOp, EdgeAssignment, LocationId, LocationKind},
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{
    E, add, automaton, bin, channel, clock, edge, element, eq, location, n, place, program, shared, v,
};

/// Slots: one that is read, two counters, an array of two.
pub const READ: u16 = 0;
pub const FIRST: u16 = 1;
pub const SECOND_COUNTER: u16 = 2;
pub const ARRAY: u16 = 3;
/// Which element of it is counted.
pub const WHICH: u16 = 5;

pub struct Dice(pub ChaCha8Rng);

impl Dice {
    pub fn below(&mut self, n: i64) -> i64 {
        self.0.random_range(0..n)
    }

    pub fn one_in(&mut self, n: i64) -> bool {
        self.below(n) == 0
    }
}

pub fn network(seed: u64) -> Program {
    let mut d = Dice(ChaCha8Rng::seed_from_u64(seed));
    let mut p = program();
    shared(&mut p, "s", 0, 2, 0);
    let most = [3, 5, 17][d.below(3) as usize];
    // Near its end, much of the network lies beyond the overflow.
    shared(&mut p, "n", 0, most, if d.one_in(2) { most - d.below(2) } else { 0 });
    shared(&mut p, "m", -2, most, 1);
    shared(&mut p, "a[0]", 0, 3, 0);
    shared(&mut p, "a[1]", 0, 3, 0);
    shared(&mut p, "t", 0, 1, 0);
    let kind = if d.one_in(2) { ChannelKind::Binary } else { ChannelKind::Broadcast };
    let over = channel(&mut p, "over", kind, &[]);
    p.channels[0].urgent = d.one_in(4);
    for m in 0..2 {
        let mut a = automaton(["A", "B"][m], &["x"]);
        let places: Vec<LocationId> = (0..3)
            .map(|l| {
                let invariant =
                    if d.one_in(4) { vec![clock(0, ClockOp::Le, 1 + d.below(2))] } else { Vec::new() };
                let kind = if l > 0 && d.one_in(8) { LocationKind::Committed } else { LocationKind::Normal };
                location(&mut a, ["l", "m", "k"][l], kind, &invariant)
            })
            .collect();
        for _ in 0..4 + d.below(2) {
            random_edge(&mut d, &places, over, m).to(&mut a);
        }
        add(&mut p, a);
    }
    p
}

fn random_edge(d: &mut Dice, places: &[LocationId], over: hrdsl_ir::ta::ChannelId, member: usize) -> E {
    let mut e = edge(places[d.below(3) as usize], places[d.below(3) as usize]);
    if d.one_in(4) {
        e = if member == 0 { e.offer(over, &[]) } else { e.accept(over, &[]) };
    } else if d.one_in(2) {
        e = e.clock(0, [ClockOp::Lt, ClockOp::Le, ClockOp::Eq, ClockOp::Ge][d.below(4) as usize], d.below(3));
    }
    if d.one_in(3) {
        e = e.when(eq(v(READ), n(d.below(3))));
    }
    // Rarely somebody does look at a counter.
    if d.one_in(24) {
        e = e.when(bin(BinaryOp::Lt, v(FIRST), n(d.below(4))));
    }
    if d.one_in(2) {
        e = counts(d, e);
    }
    if d.one_in(3) {
        e = e.set(READ, n(d.below(3)));
    }
    if d.one_in(2) { e.reset(0) } else { e }
}

fn counts(d: &mut Dice, e: E) -> E {
    let plus = |slot, k| bin(BinaryOp::Add, v(slot), n(k));
    match d.below(12) {
        0..=4 => e.set(FIRST, plus(FIRST, 1 + d.below(3))),
        5 => e.set(FIRST, n(d.below(2))),
        6 => e.set(SECOND_COUNTER, bin(BinaryOp::Sub, v(SECOND_COUNTER), n(1))),
        7 => e.set(SECOND_COUNTER, plus(SECOND_COUNTER, 1)),
        8 => e.set(SECOND_COUNTER, plus(FIRST, 1)),
        // Whether it is a fault hangs on what is read elsewhere.
        9 => e.set(FIRST, bin(BinaryOp::Add, v(FIRST), v(READ))),
        10 => e.set(READ, plus(READ, 1)),
        _ => e
            .put(place(ARRAY, v(WHICH), 2), bin(BinaryOp::Add, element(ARRAY, n(1), 2), n(1)))
            .set(WHICH, bin(BinaryOp::Sub, n(1), v(WHICH))),
    }
}

/// The network in which these variables are never set.
pub fn never_set(p: &Program, slots: &[u16]) -> Program {
    let mut p = p.clone();
    let keeps = |u: &EdgeAssignment| !matches!(u, EdgeAssignment::Assign { place, .. } if slots.contains(&place.slot));
    for e in p.automata.iter_mut().flat_map(|a| &mut a.edges) {
        e.updates.retain(keeps);
    }
    p
}
