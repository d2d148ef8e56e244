//! One-way counters: random networks with counters that are read one way, and some that are not, against explicit exploration of
//! clock regions, with subsumption on counters and without.
//!
//! `HRDSL_CASES` sets the number of networks, `HRDSL_SEED` the first seed.

mod common;
#[path = "common/oracle/mod.rs"]
mod oracle;

use common::{
    add, and, asked::asked, automaton, bin, channel, clock, deadlines, edge, eq, location, n, program,
    shared, v,
};
use hrdsl_ir::{
    Expr, Program,
    expr::{BinaryOp, UnaryOp},
    ta::{ChannelKind, ClockConstraint, ClockId, ClockOp, LocationId, LocationKind, QueryFormula, TimeSum},
    value::SECOND,
};
use hrdsl_ta::{
    GoalKind, GoalOutcome, ReachabilityGoal, SearchError, SearchOptions, SearchOrder, SubsumptionRelation,
};
use oracle::{Graph, Limits, explore};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const LIMITS: Limits = Limits { states: 20_000, bound: 4, differences: false };
/// The greatest value of a counter.
const MOST: i64 = 17;
/// Slots: a variable that is read in every way, a counter whose lesser value is better, and one whose greater is.
const PLAIN: u16 = 0;
const LESSER: u16 = 1;
const GREATER: u16 = 2;

struct Dice(ChaCha8Rng);

impl Dice {
    fn below(&mut self, n: i64) -> i64 {
        self.0.random_range(0..n)
    }

    fn one_in(&mut self, n: i64) -> bool {
        self.below(n) == 0
    }

    /// A comparison with a counter; rarely one that looks the other way.
    fn counted(&mut self, two: bool) -> Expr {
        let k = self.below(MOST + 1);
        let not = |e| Expr::Unary(UnaryOp::Not, Box::new(e));
        match self.below(if two { 8 } else { 4 }) {
            0 if self.one_in(20) => eq(v(LESSER), n(k)),
            1 if self.one_in(20) => bin(BinaryOp::Gt, v(LESSER), n(k)),
            0 | 1 => bin(BinaryOp::Lt, v(LESSER), n(k)),
            2 => bin(BinaryOp::Le, bin(BinaryOp::Add, v(LESSER), n(2)), n(k)),
            3 => not(bin(BinaryOp::Ge, v(LESSER), n(k))),
            4 => bin(BinaryOp::Lt, v(LESSER), v(GREATER)),
            5 => not(bin(BinaryOp::Le, v(GREATER), n(k))),
            6 => bin(BinaryOp::Or, bin(BinaryOp::Gt, v(GREATER), n(k)), bin(BinaryOp::Lt, v(LESSER), n(k))),
            _ => bin(BinaryOp::Ge, v(GREATER), n(k)),
        }
    }
}

fn network(seed: u64) -> Program {
    let mut d = Dice(ChaCha8Rng::seed_from_u64(seed));
    let mut p = program();
    shared(&mut p, "s", 0, 2, 0);
    shared(&mut p, "c", 0, MOST, 0);
    let two = d.one_in(3);
    if two {
        shared(&mut p, "d", 0, MOST, MOST);
    }
    let kind = if d.one_in(2) { ChannelKind::Binary } else { ChannelKind::Broadcast };
    let over = channel(&mut p, "over", kind, &[]);
    p.channels[0].urgent = d.one_in(4);
    for m in 0..2 {
        let mut a = automaton(["A", "B"][m], &["x"]);
        let places: Vec<LocationId> = (0..3)
            .map(|l| {
                let invariant =
                    if d.one_in(4) { vec![clock(0, ClockOp::Le, 1 + d.below(2))] } else { Vec::new() };
                let kind = match d.below(12) {
                    0 if l > 0 => LocationKind::Committed,
                    1 if l > 0 => LocationKind::Urgent,
                    _ => LocationKind::Normal,
                };
                location(&mut a, ["l", "m", "k"][l], kind, &invariant)
            })
            .collect();
        if d.one_in(5) {
            a.locations[2].holds = Some(d.counted(two));
        }
        for _ in 0..4 + d.below(3) {
            random_edge(&mut d, &places, over, m, two).to(&mut a);
        }
        add(&mut p, a);
    }
    p
}

fn random_edge(
    d: &mut Dice,
    places: &[LocationId],
    over: hrdsl_ir::ta::ChannelId,
    member: usize,
    two: bool,
) -> common::E {
    let any = |d: &mut Dice| places[d.below(3) as usize];
    let (from, to) = (any(d), any(d));
    let mut e = edge(from, to);
    let synchronised = d.one_in(4);
    if synchronised {
        e = if member == 0 { e.offer(over, &[]) } else { e.accept(over, &[]) };
    } else if d.one_in(2) {
        e = e.clock(0, [ClockOp::Lt, ClockOp::Le, ClockOp::Eq, ClockOp::Ge][d.below(4) as usize], d.below(3));
    }
    if d.one_in(3) {
        e = e.when(d.counted(two));
    }
    if d.one_in(4) {
        e = e.when(eq(v(PLAIN), n(d.below(3))));
    }
    if d.one_in(2) {
        let k = 1 + d.below(3);
        // Rarely without the guard that keeps it in its range, less rarely where a cycle has others.
        if !d.one_in(if from < to { 4 } else { 40 }) {
            e = e.when(bin(BinaryOp::Lt, v(LESSER), n(MOST + 1 - 2 * k - 3 * i64::from(synchronised))));
        }
        e = e.set(LESSER, bin(BinaryOp::Add, v(LESSER), n(k)));
    } else if d.one_in(12) {
        e = e.set(LESSER, n(d.below(3)));
    }
    if two && d.one_in(3) {
        e = e.when(bin(BinaryOp::Ge, v(GREATER), n(2 + 2 * i64::from(synchronised))));
        e = e.set(GREATER, bin(BinaryOp::Sub, v(GREATER), n(1 + d.below(2))));
    }
    if d.one_in(4) {
        e = e.set(PLAIN, n(d.below(3)));
    }
    if d.one_in(2) { e.reset(0) } else { e }
}

fn goals(p: &Program, seed: u64) -> Vec<ReachabilityGoal> {
    let mut d = Dice(ChaCha8Rng::seed_from_u64(!seed));
    let two = p.shared.len() > 2;
    let mut goals = Vec::new();
    for (automaton, a) in p.automata.iter().enumerate() {
        goals.extend((0..a.edges.len()).map(|edge| GoalKind::Edge { automaton, edge }));
        goals.extend((0..3).map(|l| GoalKind::Location { automaton, location: LocationId(l) }));
    }
    for _ in 0..8 {
        let mut parts = Vec::new();
        for automaton in 0..2 {
            let at = QueryFormula::At { automaton, location: LocationId(d.below(3) as u16) };
            match d.below(3) {
                0 => parts.push(at),
                1 => parts.push(QueryFormula::Not(Box::new(at))),
                _ => {}
            }
        }
        parts.push(QueryFormula::Data(and(d.counted(two), eq(v(PLAIN), n(d.below(3))))));
        if d.one_in(3) {
            let bound = TimeSum::constant(d.below(3) * SECOND);
            let op = [ClockOp::Le, ClockOp::Eq, ClockOp::Ge][d.below(3) as usize];
            let clock = ClockId(d.below(2) as u16);
            parts.push(QueryFormula::Clock(ClockConstraint { clock, minus: None, op, bound }));
        }
        goals.push(GoalKind::Formula(QueryFormula::And(parts)));
    }
    goals.into_iter().map(|what| ReachabilityGoal { what, settled: false }).collect()
}

fn expected(graph: &Graph, goal: &GoalKind) -> Result<bool, String> {
    match goal {
        GoalKind::Location { automaton, location } => {
            Ok(graph.locations().contains(&(*automaton, location.0)))
        }
        GoalKind::Edge { automaton, edge } => Ok(graph.edges.contains_key(&(*automaton, *edge))),
        GoalKind::Formula(f) => graph.possibly(f),
        GoalKind::Pair { .. } | GoalKind::Use { .. } | GoalKind::Condition(_) => Err("no such goal".into()),
    }
}

/// What a search says: of each goal, or that there is a fault.
fn said(p: &Program, goals: &[ReachabilityGoal], options: &SearchOptions) -> (Option<Vec<bool>>, usize) {
    match asked(p, goals, options) {
        Ok(report) => {
            let reached = |o: &GoalOutcome| match o {
                GoalOutcome::Reached(_) => true,
                GoalOutcome::Unreachable => false,
                GoalOutcome::Inconclusive(why) => panic!("{why:?}"),
            };
            (Some(report.goals.iter().map(reached).collect()), report.states_stored)
        }
        Err(SearchError::Model { .. }) => (None, 0),
        Err(SearchError::Internal(what)) => panic!("{what}\n{}", oracle::text::program(p)),
    }
}

/// How many transitions the shortest run to each goal has.
fn lengths(p: &Program, goals: &[ReachabilityGoal], counters: bool) -> Vec<Option<usize>> {
    let report = asked(p, goals, &SearchOptions { counters, ..SearchOptions::shortest() }).unwrap();
    let length = |o: &GoalOutcome| match o {
        GoalOutcome::Reached(run) => Some(run.steps.len()),
        GoalOutcome::Unreachable | GoalOutcome::Inconclusive(_) => None,
    };
    report.goals.iter().map(length).collect()
}

fn modes() -> Vec<SearchOptions> {
    let with = |order| SearchOptions { order, ..SearchOptions::default() };
    vec![
        SearchOptions { counters: true, ..SearchOptions::reference() },
        SearchOptions::default(),
        with(SearchOrder::Breadth),
        SearchOptions { keep_committed: false, ..with(SearchOrder::Depth) },
        SearchOptions { threads: 2, ..with(SearchOrder::RandomDepth) },
        SearchOptions { subsumption: SubsumptionRelation::Equality, ..SearchOptions::default() },
    ]
}

#[test]
fn counters_agree_with_regions() {
    let (cases, first) = (common_number("HRDSL_CASES", 600), common_number("HRDSL_SEED", 0));
    let (mut compared, mut with, mut without) = (0, 0, 0);
    for seed in first..first + cases {
        let p = network(seed);
        let goals = goals(&p, seed);
        let Ok(graph) = explore(&p, &p.networks[0], LIMITS) else { continue };
        if !graph.starts {
            continue;
        }
        let regions: Result<Vec<bool>, String> = goals.iter().map(|g| expected(&graph, &g.what)).collect();
        let Ok(regions) = regions else { continue };
        compared += 1;
        for options in modes() {
            let (on, stored) = said(&p, &goals, &options);
            let (off, all) = said(&p, &goals, &SearchOptions { counters: false, ..options });
            with += stored;
            without += all;
            let shown = || format!("seed {seed}, {options:?}\n{}", oracle::text::program(&p));
            // A search that has met its goals need not meet the fault.
            if on.is_some() || graph.faults.is_empty() {
                assert_eq!(on.as_ref(), Some(&regions), "{}", shown());
            }
            if options.order == SearchOrder::Breadth && graph.faults.is_empty() {
                assert_eq!(lengths(&p, &goals, true), lengths(&p, &goals, false), "{}", shown());
            }
            if graph.faults.is_empty() {
                assert_eq!(on, off, "{}", shown());
            } else if on.as_ref().is_some_and(|on| on.contains(&false)) {
                panic!("a fault is not told: {}", shown());
            }
        }
    }
    assert!(compared * 2 >= cases, "only {compared} of {cases} networks could be compared");
    assert!(with * 5 < without * 4, "{with} states with counters, {without} without");
}

fn common_number(name: &str, default: u64) -> u64 {
    #[allow(clippy::disallowed_methods, reason = "how long to look is asked from outside")]
    let given = std::env::var(name).ok();
    given.and_then(|n| n.parse().ok()).unwrap_or(default)
}

#[test]
fn many_goals_are_decided_in_few_states() {
    const END: i64 = 90;
    let p = deadlines::shift(END);
    let goal = |f| ReachabilityGoal { what: GoalKind::Formula(f), settled: false };
    let goals: Vec<ReachabilityGoal> = deadlines::goals(END).into_iter().map(goal).collect();
    let (on, stored) = said(&p, &goals, &SearchOptions::default());
    let (off, all) = said(&p, &goals, &SearchOptions { counters: false, ..SearchOptions::default() });
    assert_eq!(on, off);
    let reached = on.unwrap().iter().filter(|r| **r).count();
    assert!(reached > 20 && reached < 91, "{reached}");
    assert!(stored * 10 < all, "{stored} of {all}");
}

/// Two steps without a guard on the counter, and one with: how far it can come is known from that.
#[test]
fn a_counter_without_a_guard_of_its_own_is_one_if_it_stays_in_its_range() {
    let laps = |most: i64| {
        let mut p = program();
        let c = shared(&mut p, "c", 0, most, 0);
        let mut a = automaton("A", &["x"]);
        let places = ["l", "m", "k"].map(|name| location(&mut a, name, LocationKind::Normal, &[]));
        let adds =
            |from: usize, k: i64| edge(places[from], places[from + 1]).set(c, bin(BinaryOp::Add, v(c), n(k)));
        adds(0, 3).to(&mut a);
        adds(1, 2).to(&mut a);
        edge(places[2], places[0]).when(bin(BinaryOp::Lt, v(c), n(100))).to(&mut a);
        add(&mut p, a);
        let at = QueryFormula::At { automaton: 0, location: LocationId(2) };
        let never = QueryFormula::And(vec![at, QueryFormula::Data(bin(BinaryOp::Lt, v(c), n(5)))]);
        let goal = ReachabilityGoal { what: GoalKind::Formula(never), settled: false };
        said(&p, &[goal], &SearchOptions::default())
    };
    // 99 before the last guard, 3 and 2 after it, and 3 more of whoever might have added with it.
    assert_eq!(laps(107), (Some(vec![false]), 3));
    // Not known from the structure, and so it is seen value by value: 100 is as far as it comes.
    assert_eq!(laps(106), (Some(vec![false]), 60));
    assert_eq!(laps(100), (Some(vec![false]), 60));
    assert_eq!(laps(99), (None, 0));
}
