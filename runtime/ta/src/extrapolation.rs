//! Extrapolation: makes the number of zones finite without changing which locations can be reached.
//!
//! Without diagonal constraints: ExtraLU+ of Behrmann, Bouyer, Larsen and Pelánek, "Lower and Upper Bounds in Zone-Based
//! Abstractions of Timed Automata" (2004/2006), with the bounds of each location from a static analysis of guards
//! (Behrmann, Bouyer, Fleury, Larsen, TACAS 2003). With diagonal constraints every such abstraction is unsound (Bouyer
//! 2004); then zones are split along them and extrapolated by greatest constants, as Bengtsson and Yi do.

use hrdsl_ir::ta::{Edge, Sync, Update};

use crate::{
    dbm::{Bound, Dbm},
    network::{Constraint, Member},
};

/// No bound: the clock is never compared that way before it is reset.
const NONE: i64 = i64::MIN;

/// The greatest constants that a clock is compared with, from below and from above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Lu {
    lower: i64,
    upper: i64,
}

const NEVER: Lu = Lu { lower: NONE, upper: NONE };

/// What the static analysis found.
pub(crate) struct Extrapolation {
    /// Each automaton's clocks (the first, and how many), and the bounds by location, then by own clock.
    members: Vec<(usize, Vec<Vec<Lu>>)>,
    diagonals: Option<Diagonals>,
}

struct Diagonals {
    constraints: Vec<Constraint>,
    /// The greatest constant of each clock.
    greatest: Vec<i64>,
}

impl Extrapolation {
    pub(crate) fn new(members: &[Member], dim: usize) -> Self {
        let mut first = 1;
        let mut bounds = Vec::new();
        for m in members {
            bounds.push((first, analyse(m, first)));
            first += m.automaton.clocks.len();
        }
        Self { members: bounds, diagonals: Diagonals::of(members, dim) }
    }

    /// Extrapolates a zone of the discrete state whose locations are `locations`; gives it to `out` in one or, with
    /// diagonal constraints, several pieces.
    pub(crate) fn apply(&self, locations: &[i64], zone: &mut Dbm, out: &mut dyn FnMut(&Dbm)) {
        match &self.diagonals {
            None => {
                self.extra_lu(locations, zone);
                out(zone);
            }
            Some(d) => d.apply(zone.clone(), 0, out),
        }
    }

    pub(crate) fn bounds(&self, locations: &[i64], out: &mut crate::abstraction::Bounds) {
        let mut lu = Vec::new();
        self.lu(locations, &mut lu);
        for (i, b) in lu.iter().enumerate() {
            (out.lower[i], out.upper[i]) = (out.lower[i].max(b.lower), out.upper[i].max(b.upper));
        }
    }

    pub(crate) fn diagonals(&self) -> Vec<Constraint> {
        self.diagonals.as_ref().map_or(Vec::new(), |d| d.constraints.clone())
    }

    pub(crate) fn greatest(&self, dim: usize) -> Vec<i64> {
        match &self.diagonals {
            Some(d) => d.greatest.clone(),
            None => {
                let mut all = vec![0; dim];
                for (first, places) in &self.members {
                    for row in places {
                        for (k, b) in row.iter().enumerate() {
                            all[first + k] = all[first + k].max(b.lower).max(b.upper);
                        }
                    }
                }
                all
            }
        }
    }

    fn lu(&self, locations: &[i64], lu: &mut Vec<Lu>) {
        lu.clear();
        lu.push(Lu { lower: 0, upper: 0 });
        for ((_, by_location), &at) in self.members.iter().zip(locations) {
            lu.extend_from_slice(&by_location[at as usize]);
        }
    }

    fn extra_lu(&self, locations: &[i64], zone: &mut Dbm) {
        let mut lu = Vec::with_capacity(zone.dim());
        self.lu(locations, &mut lu);
        let dim = zone.dim();
        // The least value of each clock, before anything changes.
        let least: Vec<i64> = (0..dim).map(|i| -zone.at(0, i).value()).collect();
        let mut changed = false;
        for i in 0..dim {
            for j in 0..dim {
                if i == j {
                    continue;
                }
                let b = zone.at(i, j);
                let new = if b.is_infinite() || (i > 0 && (b.value() > lu[i].lower || least[i] > lu[i].lower))
                {
                    Bound::INFINITY
                } else if least[j] <= lu[j].upper {
                    b
                } else if i > 0 {
                    Bound::INFINITY
                } else if lu[j].upper == NONE {
                    Bound::LE_ZERO
                } else {
                    Bound::lt(-lu[j].upper)
                };
                if new != b {
                    zone.put(i, j, new);
                    changed = true;
                }
            }
        }
        if changed {
            zone.close();
        }
    }
}

/// The bounds of each location: of its invariant and its edges, and of where an edge leads unless it resets the clock.
fn analyse(member: &Member, first: usize) -> Vec<Vec<Lu>> {
    let clocks = member.automaton.clocks.len();
    let mut bounds = vec![vec![NEVER; clocks]; member.locations.len()];
    for (place, row) in member.locations.iter().zip(&mut bounds) {
        place.invariant.iter().for_each(|c| note(c, first, row));
    }
    for arrow in &member.edges {
        let row = &mut bounds[usize::from(arrow.edge.from.0)];
        for c in &arrow.guard {
            note(c, first, row);
            // That a receiver does not take part is a guard, too: the negation of its own.
            if matches!(arrow.edge.sync, Sync::Receive { .. }) {
                note(&c.negated(), first, row);
            }
        }
    }
    loop {
        let mut changed = false;
        for arrow in &member.edges {
            let (from, to) = (usize::from(arrow.edge.from.0), usize::from(arrow.edge.to.0));
            for x in (0..clocks).filter(|&x| !resets(arrow.edge, x)) {
                let (old, there) = (bounds[from][x], bounds[to][x]);
                let new = Lu { lower: old.lower.max(there.lower), upper: old.upper.max(there.upper) };
                changed |= new != old;
                bounds[from][x] = new;
            }
        }
        if !changed {
            return bounds;
        }
    }
}

fn resets(edge: &Edge, clock: usize) -> bool {
    edge.updates.iter().any(|u| match u {
        Update::Assign { .. } | Update::Call { .. } => false,
        Update::Reset { clock: c, .. } => usize::from(c.0) == clock,
    })
}

fn note(c: &Constraint, first: usize, row: &mut [Lu]) {
    let (i, j) = (usize::from(c.i), usize::from(c.j));
    // Constants below zero compare with nothing that a clock can be: zero stands for them.
    if j == 0 && i > 0 {
        let own = &mut row[i - first];
        own.upper = own.upper.max(c.bound.value().max(0));
    } else if i == 0 && j > 0 {
        let own = &mut row[j - first];
        own.lower = own.lower.max((-c.bound.value()).max(0));
    }
}

impl Diagonals {
    fn of(members: &[Member], dim: usize) -> Option<Self> {
        let mut constraints: Vec<Constraint> = Vec::new();
        let mut greatest = vec![0; dim];
        let invariants = members.iter().flat_map(|m| m.locations.iter().flat_map(|l| &l.invariant));
        let guards = members.iter().flat_map(|m| m.edges.iter().flat_map(|a| &a.guard));
        for c in invariants.chain(guards) {
            for x in [c.i, c.j] {
                let most = &mut greatest[usize::from(x)];
                *most = (*most).max(c.bound.value().abs());
            }
            if c.i != 0 && c.j != 0 && !constraints.contains(c) && !constraints.contains(&c.negated()) {
                constraints.push(*c);
            }
        }
        greatest[0] = 0;
        (!constraints.is_empty()).then_some(Self { constraints, greatest })
    }

    /// Splits along the constraints from the `next` on, then extrapolates each piece.
    fn apply(&self, zone: Dbm, next: usize, out: &mut dyn FnMut(&Dbm)) {
        let Some(&c) = self.constraints.get(next) else {
            let piece = self.normalise(&zone);
            return out(&piece);
        };
        for side in [c, c.negated()] {
            let mut part = zone.clone();
            if part.constrain(usize::from(side.i), usize::from(side.j), side.bound) {
                self.apply(part, next + 1, out);
            }
        }
    }

    /// The piece by greatest constants, kept on its side of every diagonal constraint.
    fn normalise(&self, piece: &Dbm) -> Dbm {
        let mut wide = piece.clone();
        let dim = wide.dim();
        for i in 0..dim {
            for j in (0..dim).filter(|&j| j != i) {
                let b = piece.at(i, j);
                if b.is_infinite() {
                    continue;
                }
                if i > 0 && b.value() > self.greatest[i] {
                    wide.put(i, j, Bound::INFINITY);
                } else if -b.value() > self.greatest[j] {
                    wide.put(i, j, Bound::lt(-self.greatest[j]));
                }
            }
        }
        wide.close();
        for c in &self.constraints {
            for side in [*c, c.negated()] {
                let other = side.negated();
                if !piece.meets(usize::from(other.i), usize::from(other.j), other.bound) {
                    wide.constrain(usize::from(side.i), usize::from(side.j), side.bound);
                }
            }
        }
        wide
    }
}
