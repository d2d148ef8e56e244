//! Extrapolation: makes the number of zones finite without changing which locations can be reached.
//!
//! Without diagonal constraints: ExtraLU+ of Behrmann, Bouyer, Larsen and Pelánek, "Lower and Upper Bounds in Zone-Based
//! Abstractions of Timed Automata" (2004/2006), with the bounds of each location from a static analysis of guards
//! (Behrmann, Bouyer, Fleury, Larsen, TACAS 2003), or ExtraM+ where a bisimulation is needed. With diagonal constraints
//! every such abstraction is unsound (Bouyer 2004); then zones are split along them and extrapolated by greatest constants,
//! as Bengtsson and Yi do.
//!
//! A clock without any bound in a location does not matter there: zones leave it out (Daws and Yovine 1996).

use crate::{
    ModelError,
    code::Library,
    dbm::{Bound, Dbm, Number},
    network::{Arrow, Clocks, Constraint, Member, Op, Part, constraints},
};

/// No bound: the clock is never compared that way before it is reset.
pub(crate) const NONE: i64 = i64::MIN;

/// Constants beyond this are too far apart for the analysis.
const FAR: i64 = 1 << 50;

/// The greatest constants that a clock is compared with, from below and from above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Lu {
    pub lower: i64,
    pub upper: i64,
}

const NEVER: Lu = Lu { lower: NONE, upper: NONE };

impl Lu {
    fn join(self, other: Lu) -> Lu {
        Lu { lower: self.lower.max(other.lower), upper: self.upper.max(other.upper) }
    }

    /// Of a clock that becomes the one with these bounds when `by` is added.
    fn before(self, by: i64) -> Lu {
        let one = |n: i64| if n == NONE { NONE } else { n.saturating_sub(by).max(0) };
        Lu { lower: one(self.lower), upper: one(self.upper) }
    }
}

/// Which bounds an extrapolation uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Abstraction {
    /// Lower and upper bounds apart: keeps what can be reached.
    #[default]
    LowerUpper,
    /// The greater of the two for both: keeps what can be reached from where (a bisimulation).
    Greatest,
}

/// The clocks that matter in a discrete state, and their bounds. The first is the reference clock.
#[derive(Clone, Debug, Default)]
pub(crate) struct Frame {
    /// Numbers of the network's clocks, ascending.
    pub clocks: Vec<u16>,
    pub bounds: Vec<Lu>,
}

impl Frame {
    /// The zone's index of a clock of the network.
    #[inline]
    pub(crate) fn index(&self, clock: u16) -> Option<usize> {
        if clock == 0 {
            return Some(0);
        }
        self.clocks.iter().position(|c| *c == clock)
    }

    pub(crate) fn dim(&self) -> usize {
        self.clocks.len()
    }
}

/// What the static analysis found.
pub(crate) struct Extrapolation {
    /// By member and location: own clocks that matter there.
    own: Vec<Vec<Vec<(u16, Lu)>>>,
    /// By member and location: the bounds of the shared clocks.
    shared: Vec<Vec<Vec<Lu>>>,
    shared_clocks: usize,
    all_clocks: bool,
    pub(crate) diagonals: Option<Diagonals>,
}

pub(crate) struct Diagonals {
    constraints: Vec<Constraint>,
    /// The greatest constant of each clock.
    greatest: Vec<i64>,
}

impl Extrapolation {
    pub(crate) fn new(
        members: &[Member],
        shared_clocks: usize,
        dim: usize,
        formulas: &Clocks,
        all_clocks: bool,
        library: &Library,
    ) -> Result<Self, ModelError> {
        let analysis = Analysis::run(members, shared_clocks, dim, formulas, library)?;
        let mut diagonals = Diagonals::of(members, dim, formulas)?;
        if let Some(d) = &mut diagonals {
            analysis.widen(d, members);
        }
        let all_clocks = all_clocks || diagonals.is_some();
        let keep = |lu: &Lu| all_clocks || *lu != NEVER;
        let own = |(m, rows): (&Member, &Vec<Vec<Lu>>)| {
            let first = m.first_clock as u16;
            let row = |row: &Vec<Lu>| {
                let own = (first..).zip(row[shared_clocks..].iter().copied());
                own.filter(|(_, lu)| keep(lu)).collect::<Vec<_>>()
            };
            rows.iter().map(row).collect::<Vec<_>>()
        };
        let shared = |rows: &Vec<Vec<Lu>>| rows.iter().map(|r| r[..shared_clocks].to_vec()).collect();
        Ok(Self {
            own: members.iter().zip(&analysis.bounds).map(own).collect(),
            shared: analysis.bounds.iter().map(shared).collect(),
            shared_clocks,
            all_clocks,
            diagonals,
        })
    }

    /// The comparisons of clocks that zones are split along.
    pub(crate) fn differences(&self) -> Vec<Constraint> {
        self.diagonals.as_ref().map_or(Vec::new(), |d| d.constraints.clone())
    }

    /// The greatest constant of each clock of the network, in any location.
    pub(crate) fn greatest(&self, dim: usize) -> Vec<i64> {
        if let Some(d) = &self.diagonals {
            return d.greatest.clone();
        }
        let mut all = vec![0; dim];
        for &(clock, lu) in self.own.iter().flatten().flatten() {
            let most = &mut all[usize::from(clock)];
            *most = lu.lower.max(lu.upper).max(*most);
        }
        for row in self.shared.iter().flatten() {
            for (most, lu) in all.iter_mut().skip(1).zip(row) {
                *most = lu.lower.max(lu.upper).max(*most);
            }
        }
        all
    }

    /// The clocks that matter in a state, with their bounds.
    pub(crate) fn frame(&self, state: &[i64], abstraction: Abstraction, out: &mut Frame) {
        out.clocks.clear();
        out.bounds.clear();
        out.clocks.push(0);
        out.bounds.push(Lu { lower: 0, upper: 0 });
        for x in 0..self.shared_clocks {
            let rows = self.shared.iter().zip(state);
            let lu = rows.map(|(by_location, &at)| by_location[at as usize][x]).fold(NEVER, Lu::join);
            if self.all_clocks || lu != NEVER {
                out.clocks.push(x as u16 + 1);
                out.bounds.push(lu);
            }
        }
        for (by_location, &at) in self.own.iter().zip(state) {
            for &(clock, lu) in &by_location[at as usize] {
                out.clocks.push(clock);
                out.bounds.push(lu);
            }
        }
        if abstraction == Abstraction::Greatest {
            for lu in &mut out.bounds {
                let most = lu.lower.max(lu.upper);
                *lu = Lu { lower: most, upper: most };
            }
        }
    }
}

/// Extrapolates by lower and upper bounds, and closes again if anything changed.
pub(crate) fn extra_lu<N: Number>(frame: &Frame, zone: &mut Dbm<N>, beyond: &mut Vec<bool>) {
    let dim = zone.dim();
    let least = |zone: &Dbm<N>, i: usize| -zone.at(0, i).value();
    // Clocks whose least value is above what they are compared with from above.
    beyond.clear();
    beyond.extend((0..dim).map(|j| least(zone, j) > frame.bounds[j].upper));
    let any = beyond.iter().any(|b| *b);
    let mut changed = false;
    for i in 1..dim {
        let lower = frame.bounds[i].lower;
        let all = lower == NONE || least(zone, i) > lower;
        let row = &mut zone.row_mut(i)[..dim];
        row[i] = N::INFINITY;
        if all {
            changed |= row.iter().any(|b| *b != N::INFINITY);
            row.fill(N::INFINITY);
        } else {
            let most = N::of(Bound::le(lower));
            let mut lost = false;
            for b in row.iter_mut() {
                let gone = *b > most && *b != N::INFINITY;
                lost |= gone;
                *b = if gone { N::INFINITY } else { *b };
            }
            if any {
                for (b, far) in row.iter_mut().zip(beyond.iter()) {
                    let gone = *far && *b != N::INFINITY;
                    lost |= gone;
                    *b = if gone { N::INFINITY } else { *b };
                }
            }
            changed |= lost;
        }
        row[i] = N::LE_ZERO;
    }
    if any {
        let row = zone.row_mut(0);
        for j in 1..dim {
            if beyond[j] {
                let upper = frame.bounds[j].upper;
                let new = if upper == NONE { N::LE_ZERO } else { N::of(Bound::lt(-upper)) };
                changed |= row[j] != new;
                row[j] = new;
            }
        }
    }
    if changed {
        zone.close();
    }
}

/// For each entry of a zone Z the least number that the entry of a zone Z' must have so that Z ⊆ aLU(Z').
///
/// INVARIANT: Z ⊈ aLU(Z') exactly if there are x, y with Z₀ₓ ≥ (≤, -Uₓ), Z'ᵧₓ < Zᵧₓ and Z'ᵧₓ + (<, -Lᵧ) < Z₀ₓ (Herbreteau,
/// Srivathsan, Walukiewicz, "Better Abstractions for Timed Automata", LICS 2012, Theorem 32). With whole bounds the last is
/// Z'ᵧₓ < Z₀ₓ + 2 Lᵧ in packed numbers, rounded up to an even one.
pub(crate) fn thresholds<N: Number>(frame: &Frame, zone: &Dbm<N>, out: &mut Vec<N>) {
    out.clear();
    let dim = zone.dim();
    for y in 0..dim {
        let lower = frame.bounds[y].lower;
        if lower == NONE {
            out.resize(out.len() + dim, N::LEAST);
            continue;
        }
        for x in 0..dim {
            out.push(threshold(frame, zone, y, x, lower));
        }
    }
}

#[inline]
fn threshold<N: Number>(frame: &Frame, zone: &Dbm<N>, y: usize, x: usize, lower: i64) -> N {
    let (upper, least) = (frame.bounds[x].upper, zone.entry(0, x));
    if upper == NONE || least < N::of(Bound::le(-upper)) {
        return N::LEAST;
    }
    let packed: i64 = least.into();
    let strict = Bound::lt(lower + (packed + 1).div_euclid(2));
    zone.entry(y, x).min(N::of(strict))
}

/// What the analysis works on.
struct Analysis<'m, 'p> {
    members: &'m [Member<'p>],
    shared: usize,
    /// By member, location, and clock: the shared ones first.
    bounds: Vec<Vec<Vec<Lu>>>,
    library: &'m Library,
}

/// Where a clock's value comes from when an edge is taken: a clock and what is added, at least.
type Source = Option<(u16, i64)>;

impl<'m, 'p> Analysis<'m, 'p> {
    fn run(
        members: &'m [Member<'p>],
        shared: usize,
        dim: usize,
        formulas: &Clocks,
        library: &'m Library,
    ) -> Result<Self, ModelError> {
        let rows = |m: &Member| vec![vec![NEVER; shared + m.automaton.clocks.len()]; m.locations.len()];
        let mut a = Self { members, shared, bounds: members.iter().map(rows).collect(), library };
        for m in 0..members.len() {
            a.own(m);
        }
        a.everywhere(formulas, dim);
        let steps: Vec<Vec<Vec<Source>>> = members
            .iter()
            .enumerate()
            .map(|(m, member)| member.edges.iter().map(|e| a.sources(m, e)).collect())
            .collect();
        while a.propagate(&steps) {
            let all = a.bounds.iter().flatten().flatten();
            if all.into_iter().any(|lu| lu.lower > FAR || lu.upper > FAR) {
                let name = members.first().map_or(String::new(), |m| m.automaton.name.clone());
                return Err(ModelError::Constants { automaton: name });
            }
        }
        Ok(a)
    }

    /// The column of a clock of the network in the member's rows.
    fn column(&self, member: usize, clock: u16) -> Option<usize> {
        let clock = usize::from(clock);
        if clock <= self.shared {
            return clock.checked_sub(1);
        }
        let own = clock.checked_sub(self.members[member].first_clock)?;
        (own < self.members[member].automaton.clocks.len()).then_some(self.shared + own)
    }

    /// The bounds that a member's own guards and invariants make.
    fn own(&mut self, m: usize) {
        let members = self.members;
        let member = &members[m];
        for (l, spot) in member.locations.iter().enumerate() {
            self.note(m, l, &spot.invariant, false);
        }
        for arrow in &member.edges {
            // That a receiver does not take part is a guard, too: the negation of its own.
            let negated = match &arrow.sync {
                Part::In(pattern) => pattern.broadcast,
                Part::Join { optional, .. } => *optional,
                Part::Internal | Part::Out(_) => false,
            };
            self.note(m, arrow.from(), &arrow.guard, negated);
        }
    }

    fn note(&mut self, m: usize, location: usize, clocks: &Clocks, negated: bool) {
        for c in &clocks.fixed {
            self.compare(m, location, *c);
            if negated {
                self.compare(m, location, c.negated());
            }
        }
        for c in &clocks.moving {
            for n in [c.span.0, c.span.1] {
                constraints(c.i, c.j, c.op, n, &mut |c| {
                    self.compare(m, location, c);
                    if negated {
                        self.compare(m, location, c.negated());
                    }
                });
            }
        }
    }

    fn compare(&mut self, m: usize, location: usize, c: Constraint) {
        // Constants below zero compare with nothing that a clock can be: zero stands for them.
        let at = |a: &Self, clock| a.column(m, clock);
        if c.j == 0
            && let Some(x) = at(self, c.i)
        {
            let own = &mut self.bounds[m][location][x];
            own.upper = own.upper.max(c.bound.value().max(0));
        } else if c.i == 0
            && let Some(x) = at(self, c.j)
        {
            let own = &mut self.bounds[m][location][x];
            own.lower = own.lower.max((-c.bound.value()).max(0));
        }
    }

    /// Formulas look at clocks in each state, from both sides.
    fn everywhere(&mut self, formulas: &Clocks, dim: usize) {
        let mut most = vec![NONE; dim];
        let mut look = |c: &Constraint| {
            for x in [c.i, c.j] {
                let old = &mut most[usize::from(x)];
                *old = (*old).max(c.bound.value().abs());
            }
        };
        formulas.fixed.iter().for_each(&mut look);
        for m in &formulas.moving {
            for n in [m.span.0, m.span.1] {
                constraints(m.i, m.j, m.op, n, &mut |c| look(&c));
            }
        }
        for m in 0..self.members.len() {
            for (clock, &n) in most.iter().enumerate().skip(1) {
                if n == NONE || (clock <= self.shared && m > 0) {
                    continue;
                }
                let Some(x) = self.column(m, clock as u16) else { continue };
                for row in &mut self.bounds[m] {
                    row[x] = row[x].join(Lu { lower: n, upper: n });
                }
            }
        }
    }

    /// For each column where its value comes from; `None`: it is set to a time.
    fn sources(&self, m: usize, arrow: &Arrow) -> Vec<Source> {
        let member = &self.members[m];
        let locals = arrow.locals(self.library);
        let own = member.first_clock as u16..;
        let mut all: Vec<(u16, Source)> = (1..=self.shared as u16)
            .chain(own.take(member.automaton.clocks.len()))
            .map(|c| (c, Some((c, 0))))
            .collect();
        for u in &arrow.updates {
            let Op::Reset { clock, from, to } = u else { continue };
            let known = |c: u16| all.iter().find(|a| a.0 == c).and_then(|a| a.1);
            let source = from.and_then(known).map(|(y, by)| (y, by + to.span(self.library, &locals).0));
            if let Some(place) = all.iter_mut().find(|a| a.0 == *clock) {
                place.1 = source;
            }
        }
        all.into_iter().map(|a| a.1).collect()
    }

    /// The greatest constants must tell what clocks will be compared with after updates, too.
    fn widen(&self, diagonals: &mut Diagonals, members: &[Member]) {
        let mut set = 0;
        for arrow in members.iter().flat_map(|m| &m.edges) {
            for u in &arrow.updates {
                let Op::Reset { to, .. } = u else { continue };
                let (lo, hi) = to.span(self.library, &arrow.locals(self.library));
                set = set.max(lo.abs()).max(hi.abs());
            }
        }
        for (clock, most) in diagonals.greatest.iter_mut().enumerate().skip(1) {
            for m in 0..members.len() {
                let Some(x) = self.column(m, clock as u16) else { continue };
                let all = self.bounds[m].iter().map(|row| row[x].lower.max(row[x].upper));
                *most = all.fold(*most, i64::max);
            }
            *most += set;
        }
    }

    /// One round of the bounds from the targets of edges to where they start. Returns whether anything changed.
    fn propagate(&mut self, steps: &[Vec<Vec<Source>>]) -> bool {
        let mut changed = false;
        let members = self.members;
        // What anybody wants of a shared clock: an edge that sets it from another clock must know that.
        let mut wanted = vec![NEVER; self.shared];
        for row in self.bounds.iter().flatten() {
            for (w, lu) in wanted.iter_mut().zip(row) {
                *w = w.join(*lu);
            }
        }
        for (m, member) in members.iter().enumerate() {
            for (arrow, sources) in member.edges.iter().zip(&steps[m]) {
                for (x, source) in sources.iter().enumerate() {
                    let &Some((y, by)) = source else { continue };
                    let Some(column) = self.column(m, y) else { continue };
                    let mut there = self.bounds[m][arrow.to()][x];
                    if x < self.shared && (column != x || by != 0) {
                        there = there.join(wanted[x]);
                    }
                    let place = &mut self.bounds[m][arrow.from()][column];
                    let new = place.join(there.before(by));
                    changed |= new != *place;
                    *place = new;
                }
            }
        }
        changed
    }
}

/// So many pieces at most a bound with variables may stand for.
const PIECES: i64 = 64;

impl Diagonals {
    fn of(members: &[Member], dim: usize, formulas: &Clocks) -> Result<Option<Self>, ModelError> {
        let mut all: Vec<Constraint> = Vec::new();
        let mut note = |clocks: &Clocks| {
            all.extend_from_slice(&clocks.fixed);
            for m in &clocks.moving {
                let (lo, hi) = m.span;
                if m.j != 0 && hi - lo >= PIECES {
                    let what = "a difference of clocks is compared with a time of too many values";
                    return Err(ModelError::Question(what.into()));
                }
                let values = if m.j == 0 { vec![lo, hi] } else { (lo..=hi).collect() };
                for n in values {
                    constraints(m.i, m.j, m.op, n, &mut |c| all.push(c));
                }
            }
            Ok(())
        };
        note(formulas)?;
        for m in members {
            m.locations.iter().try_for_each(|l| note(&l.invariant))?;
            m.edges.iter().try_for_each(|e| note(&e.guard))?;
        }
        let mut greatest = vec![0; dim];
        let mut constraints: Vec<Constraint> = Vec::new();
        for c in &all {
            for x in [c.i, c.j] {
                let most = &mut greatest[usize::from(x)];
                *most = (*most).max(c.bound.value().abs());
            }
            if c.i != 0 && c.j != 0 && !constraints.contains(c) && !constraints.contains(&c.negated()) {
                constraints.push(*c);
            }
        }
        greatest[0] = 0;
        Ok((!constraints.is_empty()).then_some(Self { constraints, greatest }))
    }

    /// Splits a zone of all clocks along the constraints, then extrapolates each piece.
    pub(crate) fn apply<N: Number>(&self, zone: &Dbm<N>, out: &mut dyn FnMut(&Dbm<N>)) {
        self.split(zone.clone(), 0, out);
    }

    fn split<N: Number>(&self, zone: Dbm<N>, next: usize, out: &mut dyn FnMut(&Dbm<N>)) {
        let Some(&c) = self.constraints.get(next) else {
            let piece = self.normalise(&zone);
            return out(&piece);
        };
        for side in [c, c.negated()] {
            let mut part = zone.clone();
            if part.constrain(usize::from(side.i), usize::from(side.j), side.bound) {
                self.split(part, next + 1, out);
            }
        }
    }

    /// The piece by greatest constants, kept on its side of every diagonal constraint.
    fn normalise<N: Number>(&self, piece: &Dbm<N>) -> Dbm<N> {
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
