//! Random small networks against explicit exploration of clock regions.
//!
//! The oracle shares nothing with the engine but the program: it reads the edges itself, and its clocks are integers with an
//! order of their fractions (Alur and Dill's regions), which is exact, while a fixed grid of times would not be.

mod common;

use std::collections::{BTreeSet, VecDeque};

use common::{E, add, and, automaton, bin, clock, edge, eq, event, location, n, program, shared, v, var};
use hrdsl_ir::{
    ArgPattern, Expr, Program, Type, Value,
    expr::BinaryOp,
    ta::{
        Automaton, ClockConstraint, ClockId, ClockOp, EdgeAssignment, LocationId, LocationKind, ReceiveArg,
        SyncLabel,
    },
    value::SECOND,
};
use hrdsl_ta::{GoalKind, GoalOutcome, ModelError, ReachabilityGoal, SearchBudget, SearchError, check};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

// ── The oracle ──

/// The whole part and the rank of the fraction (0: none). Above the greatest constant: that plus one, and rank 0.
type Clock = (i64, u8);

#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
struct State {
    at: Vec<u16>,
    data: Vec<i64>,
    clocks: Vec<Clock>,
}

struct Oracle<'p> {
    p: &'p Program,
    /// The greatest constant.
    most: i64,
    first_clock: Vec<usize>,
    locations: BTreeSet<(usize, u16)>,
    edges: BTreeSet<(usize, usize)>,
}

type Way = (usize, usize, Vec<Value>);

impl<'p> Oracle<'p> {
    /// `None`: the invariants do not hold at the start.
    fn run(p: &'p Program, most: i64) -> Option<Self> {
        let mut clocks = 0;
        let mut first_clock = Vec::new();
        for a in &p.automata {
            first_clock.push(clocks);
            clocks += a.clocks.len();
        }
        let mut o = Oracle { p, most, first_clock, locations: BTreeSet::new(), edges: BTreeSet::new() };
        let start = State {
            at: p.automata.iter().map(|a| a.initial.0).collect(),
            data: p.shared.iter().map(|x| x.init).collect(),
            clocks: vec![(0, 0); clocks],
        };
        if !o.invariants(&start) {
            return None;
        }
        let mut seen = BTreeSet::from([start.clone()]);
        let mut waiting = VecDeque::from([start]);
        while let Some(s) = waiting.pop_front() {
            o.locations.extend(s.at.iter().copied().enumerate());
            for next in o.successors(&s) {
                if seen.insert(next.clone()) {
                    waiting.push_back(next);
                }
            }
        }
        Some(o)
    }

    fn kind(&self, s: &State, a: usize) -> LocationKind {
        self.p.automata[a].locations[s.at[a] as usize].kind
    }

    fn invariants(&self, s: &State) -> bool {
        (0..s.at.len()).all(|a| self.holds(s, a, &self.p.automata[a].locations[s.at[a] as usize].invariant))
    }

    fn holds(&self, s: &State, a: usize, cs: &[ClockConstraint]) -> bool {
        cs.iter().all(|c| {
            let of = |c: ClockId| s.clocks[self.first_clock[a] + c.0 as usize];
            let (x, y) = (of(c.clock), c.minus.map_or((0, 0), of));
            if c.minus.is_some() {
                assert!(x.0 <= self.most && y.0 <= self.most, "diagonals only while nothing is beyond");
            }
            // Twice the value: even for a whole number, odd for what lies between two.
            let between = i64::from(x.1 > y.1) - i64::from(x.1 < y.1);
            let beyond = x.0 > self.most;
            let value = 2 * (x.0 - y.0) + between + i64::from(beyond);
            let bound = 2 * (c.bound.nanos / SECOND);
            match c.op {
                ClockOp::Lt => value < bound,
                ClockOp::Le => value <= bound,
                ClockOp::Eq => value == bound,
                ClockOp::Ge => value >= bound,
                ClockOp::Gt => value > bound,
            }
        })
    }

    /// The next region in time.
    fn later(&self, s: &State) -> State {
        let mut next = s.clone();
        let most = self.most;
        let beyond = |c: &Clock| c.0 > most;
        if s.clocks.iter().any(|c| !beyond(c) && c.1 == 0) {
            for c in next.clocks.iter_mut().filter(|c| !beyond(c)) {
                *c = if c.1 == 0 && c.0 == most { (most + 1, 0) } else { (c.0, c.1 + 1) };
            }
        } else if let Some(last) = s.clocks.iter().filter(|c| !beyond(c)).map(|c| c.1).max() {
            for c in next.clocks.iter_mut().filter(|c| !beyond(c) && c.1 == last) {
                *c = (c.0 + 1, 0);
            }
        }
        self.tidy(&mut next);
        next
    }

    /// Numbers the ranks without gaps.
    fn tidy(&self, s: &mut State) {
        let ranks: BTreeSet<u8> = s.clocks.iter().map(|c| c.1).filter(|&r| r > 0).collect();
        for c in &mut s.clocks {
            c.1 = ranks.iter().position(|&r| r == c.1).map_or(0, |i| i as u8 + 1);
        }
    }

    fn eval(&self, s: &State, e: &Expr, binders: &[Value]) -> Value {
        e.eval(&|i| {
            let i = i as usize;
            if i < s.data.len() {
                Some(Value::Int(s.data[i]))
            } else {
                binders.get(i - s.data.len()).copied()
            }
        })
        .unwrap()
    }

    /// The enabled ways along one edge, for what it received.
    fn ways(&self, s: &State, a: usize, e: usize, received: Option<&[Value]>) -> Vec<Way> {
        let edge = &self.p.automata[a].edges[e];
        if edge.from.0 != s.at[a] || !self.holds(s, a, &edge.clock_guard) {
            return Vec::new();
        }
        let mut bound = Vec::new();
        if let (SyncLabel::Receive { args, .. }, Some(values)) = (&edge.sync, received) {
            for (p, v) in args.iter().zip(values) {
                match p {
                    ReceiveArg::Bind => bound.push(*v),
                    ReceiveArg::Match(ArgPattern::Is(w)) if w != v => return Vec::new(),
                    ReceiveArg::Match(_) => {}
                }
            }
        }
        let mut selected: Vec<Vec<Value>> = vec![Vec::new()];
        for x in &edge.selects {
            selected = selected
                .iter()
                .flat_map(|old| (x.lo..=x.hi).map(|k| [old.as_slice(), &[Value::Int(k)]].concat()))
                .collect();
        }
        let all = selected.into_iter().map(|sel| [sel, bound.clone()].concat());
        all.filter(|b| edge.guard.as_ref().is_none_or(|g| self.eval(s, g, b) == Value::Bool(true)))
            .map(|b| (a, e, b))
            .collect()
    }

    fn successors(&mut self, s: &State) -> Vec<State> {
        let mut out = Vec::new();
        let all = 0..s.at.len();
        if all.clone().all(|a| self.kind(s, a) == LocationKind::Normal) {
            let next = self.later(s);
            if self.invariants(&next) {
                out.push(next);
            }
        }
        for a in all.clone() {
            for e in 0..self.p.automata[a].edges.len() {
                let sync = self.p.automata[a].edges[e].sync.clone();
                if matches!(sync, SyncLabel::Receive { .. }) {
                    continue;
                }
                for way in self.ways(s, a, e, None) {
                    let mut groups = vec![vec![way.clone()]];
                    if let SyncLabel::Send { args, .. } = &sync {
                        let values: Vec<Value> = args.iter().map(|x| self.eval(s, x, &way.2)).collect();
                        for r in all.clone().filter(|&r| r != a) {
                            groups = self.join(s, r, &values, groups);
                        }
                    }
                    out.extend(groups.into_iter().filter_map(|g| self.take(s, &g)));
                }
            }
        }
        out
    }

    fn join(&self, s: &State, r: usize, values: &[Value], groups: Vec<Vec<Way>>) -> Vec<Vec<Way>> {
        let edges = self.p.automata[r].edges.iter().enumerate();
        let ways: Vec<Way> = edges
            .filter(|(_, e)| matches!(e.sync, SyncLabel::Receive { .. }))
            .flat_map(|(e, _)| self.ways(s, r, e, Some(values)))
            .collect();
        if ways.is_empty() {
            return groups;
        }
        groups
            .iter()
            .flat_map(|g| ways.iter().map(|w| [g.as_slice(), std::slice::from_ref(w)].concat()))
            .collect()
    }

    fn take(&mut self, s: &State, ways: &[Way]) -> Option<State> {
        let committed = |a: usize| self.kind(s, a) == LocationKind::Committed;
        if (0..s.at.len()).any(committed) && !ways.iter().any(|w| committed(w.0)) {
            return None;
        }
        let mut next = s.clone();
        for (a, e, binders) in ways {
            let edge = &self.p.automata[*a].edges[*e];
            next.at[*a] = edge.to.0;
            for u in &edge.updates {
                match u {
                    EdgeAssignment::Reset { clock, .. } => {
                        next.clocks[self.first_clock[*a] + clock.0 as usize] = (0, 0);
                    }
                    EdgeAssignment::Assign { place, value } => {
                        next.data[place.slot as usize] = self.eval(&next, value, binders).as_int().unwrap();
                    }
                    EdgeAssignment::Call { .. } => unreachable!("the networks have no functions"),
                }
            }
        }
        self.tidy(&mut next);
        if !self.invariants(&next) {
            return None;
        }
        self.edges.extend(ways.iter().map(|w| (w.0, w.1)));
        Some(next)
    }
}

// ── Random networks ──

struct Dice(ChaCha8Rng);

impl Dice {
    fn below(&mut self, n: u32) -> u32 {
        self.0.random_range(0..n)
    }
    fn one_in(&mut self, n: u32) -> bool {
        self.below(n) == 0
    }
    fn op(&mut self) -> ClockOp {
        [ClockOp::Lt, ClockOp::Le, ClockOp::Eq, ClockOp::Ge, ClockOp::Gt][self.below(5) as usize]
    }
    fn data(&mut self) -> Expr {
        match self.below(3) {
            0 => n(i64::from(self.below(3))),
            1 => v(0),
            _ => bin(BinaryOp::Rem, bin(BinaryOp::Add, v(0), n(1)), n(3)),
        }
    }
}

/// The most seconds of a network with diagonal constraints.
const END: i64 = 5;

/// A network of two or three automata; with `diagonal`, constraints on differences, in a bounded time.
fn network(seed: u64, diagonal: bool) -> Program {
    let mut d = Dice(ChaCha8Rng::seed_from_u64(seed));
    let mut p = program();
    shared(&mut p, "s", 0, 2, 0);
    let e = event(&mut p, "e", &[Type::Int { lo: 0, hi: 2 }]);
    let count = if diagonal || d.one_in(2) { 2 } else { 3 };
    for i in 0..count {
        let two = if diagonal { i == 0 } else { count == 2 && d.one_in(2) };
        let own = if two { 2 } else { 1 };
        let names = ["x", "y", "end"];
        let bounded = diagonal && i == 0;
        let mut a = automaton(&format!("A{i}"), &names[..own + usize::from(bounded)]);
        for l in 0..2 + d.below(3) {
            let kind = match d.below(8) {
                0 => LocationKind::Committed,
                1 => LocationKind::Urgent,
                _ => LocationKind::Normal,
            };
            let mut invariant = Vec::new();
            if d.one_in(3) {
                let op = if d.one_in(2) { ClockOp::Lt } else { ClockOp::Le };
                invariant.push(clock(d.below(own as u32) as u16, op, i64::from(1 + d.below(3))));
            }
            if bounded {
                a.clocks[own] = "end".into();
                invariant.push(clock(own as u16, ClockOp::Le, END));
            }
            location(&mut a, &format!("l{l}"), kind, &invariant);
        }
        for _ in 0..3 + d.below(5) {
            random_edge(&mut d, &mut a, e, own as u16, diagonal && two);
        }
        add(&mut p, a);
    }
    p
}

fn random_edge(d: &mut Dice, a: &mut Automaton, e: hrdsl_ir::EventId, clocks: u16, diagonal: bool) {
    let locations = a.locations.len() as u32;
    let mut it: E = edge(LocationId(d.below(locations) as u16), LocationId(d.below(locations) as u16));
    while d.one_in(2) {
        it = it.clock(d.below(u32::from(clocks)) as u16, d.op(), i64::from(d.below(4)));
    }
    if diagonal && d.one_in(2) {
        let bound = (i64::from(d.below(6)) - 2) * SECOND;
        it.0.clock_guard.push(ClockConstraint {
            clock: ClockId(0),
            minus: Some(ClockId(1)),
            op: d.op(),
            bound: hrdsl_ir::ta::TimeSum::constant(bound),
        });
    }
    if d.one_in(3) {
        it = it.when(eq(v(0), n(i64::from(d.below(3)))));
    }
    let selected = d.one_in(4);
    if selected {
        it = it.select(var("k", 0, 2, 0));
    }
    let binder = v(1);
    it = match d.below(3) {
        0 => it,
        1 => {
            let arg = if selected { binder.clone() } else { d.data() };
            it.send_args(e, &[arg])
        }
        _ => match d.below(3) {
            0 => it.on_args(e, &[ReceiveArg::Match(ArgPattern::Any)]),
            1 => it.on_args(e, &[ReceiveArg::Match(ArgPattern::Is(Value::Int(i64::from(d.below(3)))))]),
            _ => {
                let bound = v(1 + u16::from(selected));
                let guarded = it.on_args(e, &[ReceiveArg::Bind]);
                let low = bin(BinaryOp::Lt, bound.clone(), n(2));
                let guarded = if d.one_in(2) { guarded.when(and(low, n_is_true())) } else { guarded };
                guarded.set(0, bound)
            }
        },
    };
    if selected && d.one_in(2) {
        it = it.set(0, binder);
    }
    if d.one_in(3) {
        it = it.set(0, d.data());
    }
    for x in 0..clocks {
        if d.one_in(3) {
            it = it.reset(x);
        }
    }
    it.to(a);
}

fn n_is_true() -> Expr {
    Expr::bool(true)
}

/// Compares reachability of each location and edge.
fn compare(p: &Program, most: i64) -> Result<(), TestCaseError> {
    let mut goals = Vec::new();
    for (automaton, a) in p.automata.iter().enumerate() {
        let locations =
            (0..a.locations.len()).map(|l| GoalKind::Location { automaton, location: LocationId(l as u16) });
        let edges = (0..a.edges.len()).map(|edge| GoalKind::Edge { automaton, edge });
        goals.extend(locations.chain(edges).map(|what| ReachabilityGoal { what, settled: false }));
    }
    let found = check(p, &p.networks[0], &goals, &[], &[], SearchBudget::default());
    let Some(oracle) = Oracle::run(p, most) else {
        let initial = Err(SearchError::Model { error: ModelError::Initial, witness: None });
        prop_assert_eq!(found, initial);
        return Ok(());
    };
    let report = found.map_err(|e| TestCaseError::fail(e.to_string()))?;
    for (goal, outcome) in goals.iter().zip(&report.goals) {
        let expected = match &goal.what {
            GoalKind::Location { automaton, location } => {
                oracle.locations.contains(&(*automaton, location.0))
            }
            GoalKind::Edge { automaton, edge } => oracle.edges.contains(&(*automaton, *edge)),
            GoalKind::Pair { .. } | GoalKind::Use { .. } | GoalKind::Formula(_) | GoalKind::Condition(_) => {
                unreachable!()
            }
        };
        match outcome {
            GoalOutcome::Reached(w) => {
                prop_assert!(expected, "{:?} is not reachable: {}", goal, w.text(p, &p.networks[0]));
            }
            GoalOutcome::Unreachable => prop_assert!(!expected, "{:?} is reachable", goal),
            GoalOutcome::Inconclusive(_) => prop_assert!(false, "the budget is used up"),
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn networks_agree_with_regions(seed in any::<u64>()) {
        compare(&network(seed, false), 3)?;
    }

    #[test]
    fn diagonal_constraints_agree_with_regions(seed in any::<u64>()) {
        compare(&network(seed, true), END + 1)?;
    }
}
