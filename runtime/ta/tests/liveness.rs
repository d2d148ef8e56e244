//! Liveness, deadlocks and bounds of random small networks against explicit exploration of clock regions.
//!
//! The oracle reads the program itself; its clocks are integers with an order of their fractions (Alur and Dill's regions). A
//! maximal run is an infinite path of the region graph (beyond all constants time leads from a region to itself), or one that
//! ends where neither time nor a transition leads on.

mod common;

use std::collections::{BTreeMap, BTreeSet};

use common::{add, automaton, clock, edge, eq, event, location, n, program, shared, v};
use hrdsl_ir::{
    Program, Span,
    ta::NetworkId,
    ta::{
        ClockConstraint, ClockOp, Edge, EdgeAssignment, LocationId, LocationKind, Query, QueryFormula,
        QueryKind, SyncLabel,
    },
    value::SECOND,
};
use hrdsl_ta::{QueryOptions, QueryVerdict, answer};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Greater than all constants.
const MOST: i64 = 3;

#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
struct State {
    at: Vec<u16>,
    data: i64,
    /// The whole part and the rank of the fraction (0: none). Beyond the constants: `(MOST + 1, 0)`.
    clocks: Vec<(i64, u8)>,
}

struct Oracle<'p> {
    p: &'p Program,
    /// Successors of each state.
    next: BTreeMap<State, Vec<State>>,
    /// States in which a transition is possible.
    moves: BTreeSet<State>,
    /// The next region in time, where time may pass.
    later: BTreeMap<State, State>,
    start: Option<State>,
}

fn compare(clock: (i64, u8), op: ClockOp, bound: i64) -> bool {
    // Twice the value: odd for what lies between two whole numbers.
    let value = 2 * clock.0 + i64::from(clock.1 > 0) + i64::from(clock.0 > MOST);
    match op {
        ClockOp::Lt => value < 2 * bound,
        ClockOp::Le => value <= 2 * bound,
        ClockOp::Eq => value == 2 * bound,
        ClockOp::Ge => value >= 2 * bound,
        ClockOp::Gt => value > 2 * bound,
    }
}

impl<'p> Oracle<'p> {
    fn new(p: &'p Program) -> Self {
        let start = State {
            at: p.automata.iter().map(|a| a.initial.0).collect(),
            data: 0,
            clocks: vec![(0, 0); p.automata.len()],
        };
        let mut o =
            Oracle { p, next: BTreeMap::new(), moves: BTreeSet::new(), later: BTreeMap::new(), start: None };
        if !o.allowed(&start) {
            return o;
        }
        let mut waiting = vec![start.clone()];
        o.start = Some(start);
        while let Some(s) = waiting.pop() {
            if o.next.contains_key(&s) {
                continue;
            }
            let mut all = o.transitions(&s);
            if !all.is_empty() {
                o.moves.insert(s.clone());
            }
            if let Some(later) = o.wait(&s) {
                o.later.insert(s.clone(), later.clone());
                all.push(later);
            }
            waiting.extend(all.iter().cloned());
            o.next.insert(s, all);
        }
        o
    }

    fn kind(&self, s: &State, a: usize) -> LocationKind {
        self.p.automata[a].locations[s.at[a] as usize].kind
    }

    fn holds(&self, s: &State, a: usize, cs: &[ClockConstraint]) -> bool {
        cs.iter().all(|c| compare(s.clocks[a], c.op, c.bound.nanos / SECOND))
    }

    fn allowed(&self, s: &State) -> bool {
        (0..s.at.len()).all(|a| self.holds(s, a, &self.p.automata[a].locations[s.at[a] as usize].invariant))
    }

    fn wait(&self, s: &State) -> Option<State> {
        if (0..s.at.len()).any(|a| self.kind(s, a) != LocationKind::Normal) {
            return None;
        }
        let mut next = s.clone();
        let beyond = |c: &(i64, u8)| c.0 > MOST;
        if s.clocks.iter().any(|c| !beyond(c) && c.1 == 0) {
            for c in next.clocks.iter_mut().filter(|c| !beyond(c)) {
                *c = if c.1 == 0 && c.0 == MOST { (MOST + 1, 0) } else { (c.0, c.1 + 1) };
            }
        } else if let Some(last) = s.clocks.iter().filter(|c| !beyond(c)).map(|c| c.1).max() {
            for c in next.clocks.iter_mut().filter(|c| !beyond(c) && c.1 == last) {
                *c = (c.0 + 1, 0);
            }
        }
        tidy(&mut next);
        self.allowed(&next).then_some(next)
    }

    fn open(&self, s: &State, a: usize, e: &Edge) -> bool {
        let data = e.guard.as_ref().is_none_or(|g| {
            g.eval(&|_| Some(hrdsl_ir::Value::Int(s.data))) == Ok(hrdsl_ir::Value::Bool(true))
        });
        e.from.0 == s.at[a] && self.holds(s, a, &e.clock_guard) && data
    }

    fn transitions(&self, s: &State) -> Vec<State> {
        let mut out = Vec::new();
        let all = 0..s.at.len();
        let committed = all.clone().any(|a| self.kind(s, a) == LocationKind::Committed);
        for a in all.clone() {
            for e in &self.p.automata[a].edges {
                if matches!(e.sync, SyncLabel::Receive { .. }) || !self.open(s, a, e) {
                    continue;
                }
                let mut groups: Vec<Vec<(usize, &Edge)>> = vec![vec![(a, e)]];
                if let SyncLabel::Send { event, .. } = e.sync {
                    for r in all.clone().filter(|&r| r != a) {
                        let ways: Vec<&Edge> = self.p.automata[r]
                            .edges
                            .iter()
                            .filter(|w| matches!(w.sync, SyncLabel::Receive { event: f, .. } if f == event))
                            .filter(|w| self.open(s, r, w))
                            .collect();
                        if !ways.is_empty() {
                            groups = groups
                                .iter()
                                .flat_map(|g| ways.iter().map(|w| [g.as_slice(), &[(r, *w)]].concat()))
                                .collect();
                        }
                    }
                }
                for g in groups {
                    if committed && !g.iter().any(|(a, _)| self.kind(s, *a) == LocationKind::Committed) {
                        continue;
                    }
                    let mut next = s.clone();
                    for (a, e) in g {
                        take(&mut next, a, e);
                    }
                    tidy(&mut next);
                    if self.allowed(&next) {
                        out.push(next);
                    }
                }
            }
        }
        out
    }

    /// No transition is possible, now or after any delay.
    fn deadlocked(&self, s: &State) -> bool {
        let mut at = s;
        loop {
            if self.moves.contains(at) {
                return false;
            }
            match self.later.get(at) {
                Some(later) if later != at => at = later,
                Some(_) | None => return true,
            }
        }
    }

    fn is(&self, f: &QueryFormula, s: &State) -> bool {
        match f {
            QueryFormula::At { automaton, location } => s.at[usize::from(*automaton)] == location.0,
            QueryFormula::Data(e) => {
                e.eval(&|_| Some(hrdsl_ir::Value::Int(s.data))) == Ok(hrdsl_ir::Value::Bool(true))
            }
            QueryFormula::Clock(c) => compare(s.clocks[usize::from(c.clock.0)], c.op, c.bound.nanos / SECOND),
            QueryFormula::Deadlock => self.deadlocked(s),
            QueryFormula::Not(f) => !self.is(f, s),
            QueryFormula::And(fs) => fs.iter().all(|f| self.is(f, s)),
            QueryFormula::Or(fs) => fs.iter().any(|f| self.is(f, s)),
        }
    }

    /// The states from which a maximal run never meets the formula: what is left when all without a way on are taken away.
    fn avoiding(&self, f: &QueryFormula) -> BTreeSet<State> {
        let ends: BTreeSet<&State> =
            self.next.iter().filter(|(_, next)| next.is_empty()).map(|x| x.0).collect();
        let mut left: BTreeSet<State> = self.next.keys().filter(|s| !self.is(f, s)).cloned().collect();
        loop {
            let gone: Vec<State> = left
                .iter()
                .filter(|s| !ends.contains(s) && !self.next[*s].iter().any(|t| left.contains(t)))
                .cloned()
                .collect();
            if gone.is_empty() {
                return left;
            }
            gone.iter().for_each(|s| {
                left.remove(s);
            });
        }
    }

    fn verdict(&self, ask: &QueryKind) -> bool {
        let start = self.start.as_ref().unwrap();
        match ask {
            QueryKind::Possibly(f) => self.next.keys().any(|s| self.is(f, s)),
            QueryKind::Invariantly(f) => self.next.keys().all(|s| self.is(f, s)),
            QueryKind::PotentiallyAlways(f) => {
                self.avoiding(&QueryFormula::Not(Box::new(f.clone()))).contains(start)
            }
            QueryKind::Eventually(f) => !self.avoiding(f).contains(start),
            QueryKind::LeadsTo(f, g) => {
                let bad = self.avoiding(g);
                !self.next.keys().any(|s| self.is(f, s) && bad.contains(s))
            }
            QueryKind::Sup { .. } | QueryKind::Inf { .. } => unreachable!("not asked here"),
        }
    }
}

fn take(s: &mut State, a: usize, e: &Edge) {
    s.at[a] = e.to.0;
    for u in &e.updates {
        match u {
            EdgeAssignment::Reset { .. } => s.clocks[a] = (0, 0),
            EdgeAssignment::Assign { value, .. } => {
                let got = value.eval(&|_| Some(hrdsl_ir::Value::Int(s.data))).unwrap();
                s.data = got.as_int().unwrap();
            }
            EdgeAssignment::Call { .. } => unreachable!("not made here"),
        }
    }
}

/// Numbers the ranks without gaps.
fn tidy(s: &mut State) {
    let ranks: BTreeSet<u8> = s.clocks.iter().map(|c| c.1).filter(|&r| r > 0).collect();
    for c in &mut s.clocks {
        c.1 = ranks.iter().position(|&r| r == c.1).map_or(0, |i| i as u8 + 1);
    }
}

// ── Networks ──

fn op(rng: &mut ChaCha8Rng) -> ClockOp {
    [ClockOp::Lt, ClockOp::Le, ClockOp::Eq, ClockOp::Ge, ClockOp::Gt][rng.random_range(0..5)]
}

fn network(rng: &mut ChaCha8Rng) -> Program {
    let mut p = program();
    let q = shared(&mut p, "q", 0, 1, 0);
    let go = event(&mut p, "go", &[]);
    for name in ["A", "B"] {
        let mut a = automaton(name, &["x"]);
        let count = rng.random_range(2..4u16);
        for l in 0..count {
            let kind = match rng.random_range(0..10) {
                0 => LocationKind::Urgent,
                1 => LocationKind::Committed,
                _ => LocationKind::Normal,
            };
            let bounded = rng.random_bool(0.7);
            let bound = [ClockOp::Le, ClockOp::Lt][rng.random_range(0..2)];
            let inv = [clock(0, bound, rng.random_range(1..=MOST))];
            location(&mut a, &format!("l{l}"), kind, if bounded { &inv } else { &[] });
        }
        for _ in 0..rng.random_range(2..6) {
            let (from, to) = (rng.random_range(0..count), rng.random_range(0..count));
            let mut e = edge(LocationId(from), LocationId(to));
            if rng.random_bool(0.6) {
                e = e.clock(0, op(rng), rng.random_range(0..=MOST));
            }
            if rng.random_bool(0.25) {
                e = e.when(eq(v(q), n(rng.random_range(0..2))));
            }
            if rng.random_bool(0.3) {
                e = e.set(q, n(rng.random_range(0..2)));
            }
            if rng.random_bool(0.6) {
                e = e.reset(0);
            }
            e = match rng.random_range(0..4) {
                0 => e.send(go),
                1 => e.on(go),
                _ => e,
            };
            e.to(&mut a);
        }
        add(&mut p, a);
    }
    p
}

fn atom(rng: &mut ChaCha8Rng, p: &Program, clocks: bool) -> QueryFormula {
    let automaton = rng.random_range(0..2u16);
    match rng.random_range(0..if clocks { 5 } else { 3 }) {
        0 | 1 => {
            let count = p.automata[usize::from(automaton)].locations.len() as u16;
            QueryFormula::At { automaton, location: LocationId(rng.random_range(0..count)) }
        }
        2 => QueryFormula::Data(eq(v(0), n(rng.random_range(0..2)))),
        _ => QueryFormula::Clock(clock(automaton, op(rng), rng.random_range(0..=MOST))),
    }
}

fn formula(rng: &mut ChaCha8Rng, p: &Program, clocks: bool) -> QueryFormula {
    match rng.random_range(0..5) {
        0 => QueryFormula::Not(Box::new(atom(rng, p, clocks))),
        1 => QueryFormula::And(vec![atom(rng, p, clocks), QueryFormula::Not(Box::new(atom(rng, p, clocks)))]),
        2 => QueryFormula::Or(vec![atom(rng, p, clocks), atom(rng, p, clocks)]),
        _ => atom(rng, p, clocks),
    }
}

fn check(p: &Program, ask: QueryKind, seed: u64) {
    let o = Oracle::new(p);
    if o.start.is_none() {
        return;
    }
    let query = Query {
        name: "q".into(),
        title: "q".into(),
        text: String::new(),
        network: NetworkId(0),
        ask: ask.clone(),
        origin: Span::default(),
    };
    let got = answer(p, &p.networks[0], &query, &QueryOptions::default())
        .unwrap_or_else(|e| panic!("seed {seed}: {e}"));
    let want = if o.verdict(&ask) { QueryVerdict::Holds } else { QueryVerdict::Fails };
    assert_eq!(got.verdict, want, "seed {seed}: {ask:?}: {}", got.why);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]
    #[test]
    fn liveness_is_that_of_regions(seed in any::<u64>()) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let p = network(&mut rng);
        for clocks in [false, true] {
            check(&p, QueryKind::Eventually(formula(&mut rng, &p, clocks)), seed);
            check(&p, QueryKind::PotentiallyAlways(formula(&mut rng, &p, clocks)), seed);
            let (f, g) = (formula(&mut rng, &p, clocks), formula(&mut rng, &p, clocks));
            check(&p, QueryKind::LeadsTo(f, g), seed);
        }
    }

    #[test]
    fn reachability_with_clocks_and_deadlocks_is_that_of_regions(seed in any::<u64>()) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let p = network(&mut rng);
        check(&p, QueryKind::Possibly(formula(&mut rng, &p, true)), seed);
        check(&p, QueryKind::Invariantly(formula(&mut rng, &p, true)), seed);
        check(&p, QueryKind::Possibly(QueryFormula::Deadlock), seed);
        let f = formula(&mut rng, &p, true);
        check(&p, QueryKind::Possibly(QueryFormula::And(vec![QueryFormula::Deadlock, f])), seed);
    }
}
