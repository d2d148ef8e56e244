//! The static analysis for extrapolation: what clocks are compared with, location by location.

use crate::{
    network::{
        by_location::LocationTable,
        code::CodeLibrary,
        error::ModelError,
        parts::{ClockConstraints, CompiledAutomaton, CompiledEdge, EdgeSync, EdgeUpdate},
    },
    zone::{
        constraint::{DifferenceConstraint, constraints},
        extrapolation::{ActiveClocks, ExtrapolationAbstraction, LuBounds, NEVER, NONE},
    },
};

/// Constants beyond this are too far apart for the analysis.
const FAR: i64 = 1 << 50;

/// What the static analysis found.
pub(crate) struct ExtrapolationBounds {
    /// Own clocks that matter.
    pub(crate) own: LocationTable<(u16, LuBounds)>,
    /// How many own clocks matter at most in a state.
    most_own: usize,
    /// The bounds of all shared clocks.
    pub(crate) shared: LocationTable<LuBounds>,
    pub(crate) shared_clocks: usize,
    /// Clocks are kept even where they do not matter.
    pub(crate) all_clocks: bool,
    pub(crate) diagonals: Option<DiagonalConstraints>,
}

pub(crate) struct DiagonalConstraints {
    pub constraints: Vec<DifferenceConstraint>,
    /// The greatest constant of each clock.
    pub greatest: Vec<i64>,
}

impl ExtrapolationBounds {
    pub(crate) fn new(
        members: &[CompiledAutomaton],
        shared_clocks: usize,
        dim: usize,
        formulas: &ClockConstraints,
        all_clocks: bool,
        library: &CodeLibrary,
    ) -> Result<Self, ModelError> {
        let analysis = BoundsAnalysis::run(members, shared_clocks, dim, formulas, library)?;
        let mut diagonals = DiagonalConstraints::of(members, dim, formulas)?;
        if let Some(d) = &mut diagonals {
            analysis.widen(d, members);
        }
        let all_clocks = all_clocks || diagonals.is_some();
        let keep = |lu: &LuBounds| all_clocks || *lu != NEVER;
        let own = LocationTable::new(members.iter().zip(&analysis.bounds).map(|(m, rows)| {
            let first = m.first_clock as u16;
            let clocks = move |row: &'_ Vec<LuBounds>| (first..).zip(row[shared_clocks..].to_vec());
            rows.iter().map(move |row| clocks(row).filter(move |(_, lu)| keep(lu)))
        }));
        let shared = |rows: &'_ Vec<Vec<LuBounds>>| {
            rows.iter().map(|r| r[..shared_clocks].to_vec()).collect::<Vec<_>>()
        };
        Ok(Self {
            most_own: own.most(),
            own,
            shared: LocationTable::new(analysis.bounds.iter().map(shared)),
            shared_clocks,
            all_clocks,
            diagonals,
        })
    }

    /// The comparisons of clocks that zones are split along.
    pub(crate) fn differences(&self) -> Vec<DifferenceConstraint> {
        self.diagonals.as_ref().map_or(Vec::new(), |d| d.constraints.clone())
    }

    /// The greatest constant of each clock of the network, in any location.
    pub(crate) fn greatest(&self, dim: usize) -> Vec<i64> {
        if let Some(d) = &self.diagonals {
            return d.greatest.clone();
        }
        let mut all = vec![0; dim];
        for &(clock, lu) in self.own.items() {
            let most = &mut all[usize::from(clock)];
            *most = lu.lower.max(lu.upper).max(*most);
        }
        for row in self.shared.items().chunks_exact(self.shared_clocks.max(1)) {
            for (most, lu) in all.iter_mut().skip(1).zip(row) {
                *most = lu.lower.max(lu.upper).max(*most);
            }
        }
        all
    }

    /// The clocks that matter in a state, with their bounds.
    pub(crate) fn frame(&self, state: &[i64], abstraction: ExtrapolationAbstraction, out: &mut ActiveClocks) {
        // Written by index: to push asks for room each time.
        let most = 1 + self.shared_clocks + self.most_own;
        out.clocks.resize(most, 0);
        out.bounds.resize(most, NEVER);
        (out.clocks[0], out.bounds[0]) = (0, LuBounds { lower: 0, upper: 0 });
        let mut count = 1;
        for x in 0..self.shared_clocks {
            let lu = self.shared.rows(state).map(|row| row[x]).fold(NEVER, LuBounds::join);
            if self.all_clocks || lu != NEVER {
                (out.clocks[count], out.bounds[count]) = (x as u16 + 1, lu);
                count += 1;
            }
        }
        for &own in self.own.rows(state).flatten() {
            (out.clocks[count], out.bounds[count]) = own;
            count += 1;
        }
        out.clocks.truncate(count);
        out.bounds.truncate(count);
        if abstraction == ExtrapolationAbstraction::Greatest {
            for lu in &mut out.bounds {
                let most = lu.lower.max(lu.upper);
                *lu = LuBounds { lower: most, upper: most };
            }
        }
    }
}

/// What the analysis works on.
struct BoundsAnalysis<'m, 'p> {
    members: &'m [CompiledAutomaton<'p>],
    shared: usize,
    /// By member, location, and clock: the shared ones first.
    bounds: Vec<Vec<Vec<LuBounds>>>,
    library: &'m CodeLibrary,
}

/// Where a clock's value comes from when an edge is taken: a clock and what is added, at least.
type ClockValueSource = Option<(u16, i64)>;

impl<'m, 'p> BoundsAnalysis<'m, 'p> {
    fn run(
        members: &'m [CompiledAutomaton<'p>],
        shared: usize,
        dim: usize,
        formulas: &ClockConstraints,
        library: &'m CodeLibrary,
    ) -> Result<Self, ModelError> {
        let rows =
            |m: &CompiledAutomaton| vec![vec![NEVER; shared + m.automaton.clocks.len()]; m.locations.len()];
        let mut a = Self { members, shared, bounds: members.iter().map(rows).collect(), library };
        for m in 0..members.len() {
            a.own(m);
        }
        a.everywhere(formulas, dim);
        let steps: Vec<Vec<Vec<ClockValueSource>>> = members
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
                EdgeSync::In(pattern) => pattern.broadcast,
                EdgeSync::Join { optional, .. } => *optional,
                EdgeSync::Internal | EdgeSync::Out(_) => false,
            };
            self.note(m, arrow.from(), &arrow.guard, negated);
            self.note_negative(m, arrow);
        }
    }

    /// Setting a clock to `y - k` asks whether `y < k`, which is a fault: as a guard would.
    fn note_negative(&mut self, m: usize, arrow: &CompiledEdge) {
        let locals = arrow.locals(self.library);
        // What the edge itself has set so far: a clock before it and what was added, at least.
        let mut known: Vec<(u16, Option<(u16, i64)>)> = Vec::new();
        for u in &arrow.updates {
            let EdgeUpdate::Reset { clock, from, to } = u else { continue };
            let least = to.span(self.library, &locals).0;
            let source = from.and_then(|y| known.iter().rfind(|k| k.0 == y).map_or(Some((y, 0)), |k| k.1));
            let source = source.map(|(y, by)| (y, by.saturating_add(least)));
            if let Some((y, by)) = source
                && by < 0
                && let Some(x) = self.column(m, y)
            {
                let own = &mut self.bounds[m][arrow.from()][x];
                own.upper = own.upper.max(by.saturating_neg());
            }
            known.push((*clock, source));
        }
    }

    fn note(&mut self, m: usize, location: usize, clocks: &ClockConstraints, negated: bool) {
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

    fn compare(&mut self, m: usize, location: usize, c: DifferenceConstraint) {
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
    fn everywhere(&mut self, formulas: &ClockConstraints, dim: usize) {
        let mut most = vec![NONE; dim];
        let mut look = |c: &DifferenceConstraint| {
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
                    row[x] = row[x].join(LuBounds { lower: n, upper: n });
                }
            }
        }
    }

    /// For each column where its value comes from; `None`: it is set to a time.
    fn sources(&self, m: usize, arrow: &CompiledEdge) -> Vec<ClockValueSource> {
        let member = &self.members[m];
        let locals = arrow.locals(self.library);
        let own = member.first_clock as u16..;
        let mut all: Vec<(u16, ClockValueSource)> = (1..=self.shared as u16)
            .chain(own.take(member.automaton.clocks.len()))
            .map(|c| (c, Some((c, 0))))
            .collect();
        for u in &arrow.updates {
            let EdgeUpdate::Reset { clock, from, to } = u else { continue };
            let known = |c: u16| all.iter().find(|a| a.0 == c).and_then(|a| a.1);
            let source = from.and_then(known).map(|(y, by)| (y, by + to.span(self.library, &locals).0));
            if let Some(place) = all.iter_mut().find(|a| a.0 == *clock) {
                place.1 = source;
            }
        }
        all.into_iter().map(|a| a.1).collect()
    }

    /// The greatest constants must tell what clocks will be compared with after updates, too.
    fn widen(&self, diagonals: &mut DiagonalConstraints, members: &[CompiledAutomaton]) {
        let mut set = 0;
        for arrow in members.iter().flat_map(|m| &m.edges) {
            for u in &arrow.updates {
                let EdgeUpdate::Reset { to, .. } = u else { continue };
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
    fn propagate(&mut self, steps: &[Vec<Vec<ClockValueSource>>]) -> bool {
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

impl DiagonalConstraints {
    fn of(
        members: &[CompiledAutomaton],
        dim: usize,
        formulas: &ClockConstraints,
    ) -> Result<Option<Self>, ModelError> {
        let mut all: Vec<DifferenceConstraint> = Vec::new();
        let mut note = |clocks: &ClockConstraints| {
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
        let mut constraints: Vec<DifferenceConstraint> = Vec::new();
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
}
