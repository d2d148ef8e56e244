//! Counters that nobody reads: random networks with variables that are written and hardly ever read, and that may leave their
//! ranges, against explicit exploration of clock regions.
//!
//! `HRDSL_CASES` sets the number of networks, `HRDSL_SEED` the first seed; with `HRDSL_SOAK=1` it is 10,000.

mod common;
#[path = "common/oracle/mod.rs"]
mod oracle;

use common::counted::{ARRAY, Dice, FIRST, READ, SECOND_COUNTER, network, never_set};
use common::{add, and, automaton, bin, edge, eq, location, n, program, shared, v};
use hrdsl_ir::{
    Expr, Program,
    expr::BinaryOp,
    ta::{ClockConstraint, ClockId, ClockOp, LocationId, LocationKind, QueryFormula, TimeSum},
    value::SECOND,
};
use hrdsl_ta::{
    GoalKind, GoalOutcome, ObservationOptions, RangeAnswer, RangeFinding, ReachabilityGoal, SearchBudget,
    SearchCutoff, SearchError, SearchOptions, SearchReport, UnreadCounters,
};
use oracle::{Fault, Graph, Limits, explore};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

const LIMITS: Limits = Limits { states: 20_000, bound: 4, differences: false };

fn goals(seed: u64) -> Vec<ReachabilityGoal> {
    let mut d = Dice(ChaCha8Rng::seed_from_u64(!seed));
    let at =
        |d: &mut Dice, automaton| QueryFormula::At { automaton, location: LocationId(d.below(3) as u16) };
    let mut parts = vec![at(&mut d, 0), at(&mut d, 1)];
    if d.one_in(2) {
        parts.push(QueryFormula::Data(eq(v(READ), n(d.below(3)))));
    }
    if d.one_in(3) {
        let bound = TimeSum::constant(d.below(3) * SECOND);
        let op = [ClockOp::Le, ClockOp::Eq, ClockOp::Ge][d.below(3) as usize];
        let clock = ClockId(d.below(2) as u16);
        parts.push(QueryFormula::Clock(ClockConstraint { clock, minus: None, op, bound }));
    }
    if d.one_in(8) {
        parts.push(QueryFormula::Data(and(eq(v(FIRST), n(2)), eq(v(READ), n(0)))));
    }
    vec![ReachabilityGoal { what: GoalKind::Formula(QueryFormula::And(parts)), settled: false }]
}

/// Slots that a goal reads, or a guard.
fn looked_at(p: &Program, goals: &[ReachabilityGoal]) -> bool {
    let reads = |e: &Expr| {
        let mut found = false;
        e.each_var(&mut |i| found |= i == FIRST);
        found
    };
    let formula = |f: &QueryFormula| match f {
        QueryFormula::And(fs) => fs.iter().any(|f| matches!(f, QueryFormula::Data(e) if reads(e))),
        _ => false,
    };
    let mut edges = p.automata.iter().flat_map(|a| &a.edges);
    edges.any(|e| e.guard.as_ref().is_some_and(reads))
        || goals.iter().any(|g| matches!(&g.what, GoalKind::Formula(f) if formula(f)))
}

type Found = (SearchReport, Vec<RangeAnswer>);

/// `None`: there is nothing that nobody reads.
fn apart(
    p: &Program,
    goals: &[ReachabilityGoal],
    options: &SearchOptions,
) -> Option<Result<Found, SearchError>> {
    let formulas = goals.iter().filter_map(|g| match &g.what {
        GoalKind::Formula(f) => Some(f.clone()),
        _ => None,
    });
    let observe = ObservationOptions { formulas: formulas.collect(), ..ObservationOptions::default() };
    let unread = UnreadCounters::find(p, &p.networks[0], &observe, goals).unwrap()?;
    Some(unread.explore(goals, options, &|_| true))
}

fn reached(o: &GoalOutcome) -> bool {
    match o {
        GoalOutcome::Reached(_) => true,
        GoalOutcome::Unreachable => false,
        GoalOutcome::Inconclusive(why) => panic!("{why:?}"),
    }
}

fn possibly(graph: &Graph, goals: &[ReachabilityGoal]) -> Result<bool, String> {
    let GoalKind::Formula(f) = &goals[0].what else { return Err("no formula".to_owned()) };
    graph.possibly(f)
}

/// What was compared of a network.
#[derive(Default)]
struct Tally {
    compared: u64,
    beyond: u64,
    left: u64,
    kept: u64,
}

fn compare(seed: u64, tally: &mut Tally) -> Result<(), String> {
    let (p, goals) = (network(seed), goals(seed));
    let graph = explore(&p, &p.networks[0], LIMITS)?;
    if !graph.starts {
        return Ok(());
    }
    let cut: &[u16] = if looked_at(&p, &goals) {
        // What is assigned to an array may come from the read variable alone.
        &[SECOND_COUNTER, ARRAY]
    } else {
        &[FIRST, SECOND_COUNTER, ARRAY]
    };
    let of_cut = |slot: usize| cut.contains(&(slot as u16)) || slot == usize::from(ARRAY) + 1;
    let is_cut = |f: &Fault| matches!(f, Fault::Range { slot, .. } if of_cut(*slot));
    let others = !graph.faults.iter().all(|f| is_cut(&f.1));
    let wide = never_set(&p, cut);
    let beyond = explore(&wide, &wide.networks[0], LIMITS)?;
    // A fault of others that lies beyond an overflow leaves all to the search as it is without this, which meets some fault.
    let others = others || !(graph.faults.is_empty() || beyond.faults.is_empty());
    let (within, beyond) = (possibly(&graph, &goals)?, possibly(&beyond, &goals)?);
    for options in [
        SearchOptions::default(),
        SearchOptions::shortest(),
        SearchOptions { threads: 2, ..SearchOptions::reference() },
    ] {
        let shown = || format!("seed {seed}, {options:?}\n{}", oracle::text::program(&p));
        match apart(&p, &goals, &options) {
            None => return Ok(()),
            Some(Err(SearchError::Internal(what))) => panic!("{what}: {}", shown()),
            Some(Err(SearchError::Model { error, .. })) => {
                assert!(others || (!within && beyond), "{error}: {}", shown());
                tally.beyond += u64::from(!others);
            }
            Some(Ok((report, ranges))) => {
                assert_eq!(reached(&report.goals[0]), within, "{}", shown());
                assert!(others || within || !beyond, "a fault is not told: {}", shown());
                for range in ranges {
                    let slots: Vec<u16> = (0..p.shared.len() as u16)
                        .filter(|s| range.variables.contains(&p.shared[usize::from(*s)].name))
                        .collect();
                    let met = graph
                        .faults
                        .iter()
                        .any(|f| matches!(f.1, Fault::Range { slot, .. } if slots.contains(&(slot as u16))));
                    match range.finding {
                        RangeFinding::Kept => {
                            assert!(!met, "{:?} are said to stay: {}", range.variables, shown());
                            tally.kept += 1;
                        }
                        RangeFinding::Left { .. } => {
                            assert!(met, "{:?} are said to leave: {}", range.variables, shown());
                            tally.left += 1;
                        }
                        RangeFinding::Behind(_) => {}
                        RangeFinding::Inconclusive { cutoff, .. } => panic!("{cutoff:?}: {}", shown()),
                    }
                }
            }
        }
    }
    tally.compared += 1;
    Ok(())
}

fn number(name: &str, default: u64) -> u64 {
    #[allow(clippy::disallowed_methods, reason = "how long to look is asked from outside")]
    let given = std::env::var(name).ok();
    given.and_then(|n| n.parse().ok()).unwrap_or(default)
}

#[test]
fn counters_that_nobody_reads_agree_with_regions() {
    let usual = if number("HRDSL_SOAK", 0) == 1 { 10_000 } else { 800 };
    let (cases, first) = (number("HRDSL_CASES", usual), number("HRDSL_SEED", 0));
    let mut tally = Tally::default();
    for seed in first..first + cases {
        // What the regions are too many for is not compared.
        let _ = compare(seed, &mut tally);
    }
    let Tally { compared, beyond, left, kept } = tally;
    assert!(compared * 2 >= cases, "only {compared} of {cases} networks could be compared");
    assert!(beyond * 100 > cases && left * 10 > cases && kept * 20 > cases, "{beyond}, {left}, {kept}");
}

/// A loop that counts up to `most`, beside a place that is reached after so many rounds of another one.
fn laps(most: i64, rounds: i64) -> Program {
    let mut p = program();
    let s = shared(&mut p, "s", 0, 9, 0);
    let c = shared(&mut p, "c", 0, most, 0);
    let mut a = automaton("A", &["x"]);
    let [l, end] = ["l", "end"].map(|name| location(&mut a, name, LocationKind::Normal, &[]));
    let count = |slot| bin(BinaryOp::Add, v(slot), n(1));
    edge(l, l).when(bin(BinaryOp::Lt, v(s), n(9))).set(s, count(s)).set(c, count(c)).to(&mut a);
    edge(l, l).when(eq(v(s), n(9))).set(s, n(0)).set(c, count(c)).to(&mut a);
    edge(l, end).when(eq(v(s), n(rounds))).to(&mut a);
    add(&mut p, a);
    p
}

fn end_of(p: &Program, budget: usize) -> Result<Found, SearchError> {
    let at = QueryFormula::At { automaton: 0, location: LocationId(1) };
    let goal = ReachabilityGoal { what: GoalKind::Formula(at), settled: false };
    let budget = SearchBudget { states: budget, ..SearchBudget::default() };
    apart(p, &[goal], &SearchOptions { budget, ..SearchOptions::shortest() }).unwrap()
}

#[test]
fn a_goal_before_the_overflow_is_reached_and_one_beyond_it_is_the_fault() {
    let (report, ranges) = end_of(&laps(7, 7), usize::MAX).unwrap();
    assert!(reached(&report.goals[0]));
    assert_eq!(report.states_stored, 10, "the counter makes no states");
    let RangeFinding::Left { error, run } = &ranges[0].finding else { panic!("{ranges:?}") };
    assert_eq!(
        (error.to_string().as_str(), run.steps.len()),
        ("automaton `A`, edge l -> l: `c` becomes 8, outside 0..7", 7)
    );
    let Err(SearchError::Model { error, witness: Some(run) }) = end_of(&laps(6, 7), usize::MAX) else {
        panic!("a fault is not told")
    };
    assert_eq!(
        (error.to_string().as_str(), run.steps.len()),
        ("automaton `A`, edge l -> l: `c` becomes 7, outside 0..6", 6)
    );
}

#[test]
fn a_range_that_the_budget_leaves_open_is_said_to_be_so() {
    let (report, ranges) = end_of(&laps(100_000, 7), 500).unwrap();
    assert!(reached(&report.goals[0]));
    let RangeFinding::Inconclusive { cutoff: SearchCutoff::States, widest: Some(widest) } =
        &ranges[0].finding
    else {
        panic!("{ranges:?}")
    };
    assert_eq!(widest.name, "c");
}

/// Two that leave their ranges in one transition: the second has no fault of its own, since the first comes before it.
#[test]
fn what_leaves_its_range_with_another_that_does_so_before_it_stays_open() {
    let mut p = program();
    let (first, second) = (shared(&mut p, "first", 0, 2, 0), shared(&mut p, "second", 0, 2, 0));
    let mut a = automaton("A", &["x"]);
    let [l, _] = ["l", "end"].map(|name| location(&mut a, name, LocationKind::Normal, &[]));
    let count = |slot| bin(BinaryOp::Add, v(slot), n(1));
    edge(l, l).set(first, count(first)).set(second, count(second)).to(&mut a);
    add(&mut p, a);
    let (report, ranges) = end_of(&p, usize::MAX).unwrap();
    assert!(!reached(&report.goals[0]));
    let [one, other] = ranges.as_slice() else { panic!("{ranges:?}") };
    assert!(matches!(&one.finding, RangeFinding::Left { .. }), "{one:?}");
    let RangeFinding::Behind(error) = &other.finding else { panic!("{other:?}") };
    assert!(error.to_string().contains("`first` becomes 3"), "{error}");
}
