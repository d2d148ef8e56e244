//! Queries of all kinds about networks with variables that nothing reads, against explicit exploration of clock regions.
//!
//! `HRDSL_CASES` sets the number of networks, `HRDSL_SEED` the first seed.

mod common;
#[path = "common/oracle/mod.rs"]
mod oracle;

use common::asked::{at, query};
use common::counted::{ARRAY, FIRST, READ, SECOND_COUNTER, network, never_set};
use common::{add, automaton, bin, edge, eq, location, n, program, shared, v};
use hrdsl_ir::{
    Expr, Program,
    expr::BinaryOp,
    ta::{ClockId, LocationId, LocationKind, QueryFormula, QueryKind, QueryMeasure},
    value::SECOND,
};
use hrdsl_ta::{
    ExtremumLimit, ExtremumValue, GoalKind, GoalOutcome, ObservationOptions, QueryAnswer, QueryOptions,
    QueryVerdict, RangeFinding, ReachabilityGoal, RunEnding, ScheduleOptions, SearchBudget, SearchError,
    SearchOptions, UnreadCounters, fastest,
};
use oracle::{Graph, Limits, explore};

const LIMITS: Limits = Limits { states: 20_000, bound: 4, differences: false };

/// `None`: there is nothing that nobody reads.
fn apart(p: &Program, ask: &QueryKind) -> Option<Result<(QueryAnswer, bool), SearchError>> {
    let unread = UnreadCounters::find_for_query(p, &p.networks[0], ask).unwrap()?;
    let budget = SearchBudget { states: 3_000, ..SearchBudget::default() };
    let options = QueryOptions { budget, ..QueryOptions::default() };
    Some(unread.answer(&query(ask.clone()), &options, &|_| true))
}

/// What the regions say of a network, and of the one in which the variables are never set.
struct Judge<'a, 'p> {
    within: &'a Graph<'p>,
    beyond: &'a Graph<'p>,
    /// Nothing leaves its range.
    is_sound: bool,
}

impl Judge<'_, '_> {
    fn compare(&self, what: &str, ask: &QueryKind, answer: &QueryAnswer) -> Result<(), String> {
        let holds = answer.verdict == QueryVerdict::Holds;
        let eventually = |graph: &Graph<'_>| match ask {
            QueryKind::Eventually(f) => graph.eventually(f),
            QueryKind::PotentiallyAlways(f) => graph.always(f).map(|holds| !holds),
            QueryKind::LeadsTo(f, g) => graph.leads_to(f, g),
            _ => Err("not about whole runs".to_owned()),
        };
        match ask {
            QueryKind::Possibly(f) => {
                // The regions call it a deadlock, too, where a fault is all that may come.
                let within = self.within.possibly(f)?;
                assert!(within || !holds, "{what}");
                assert!(!self.is_sound || holds == within, "{what}");
            }
            QueryKind::Eventually(_) | QueryKind::PotentiallyAlways(_) | QueryKind::LeadsTo(..) => {
                let is_shown = holds == matches!(ask, QueryKind::PotentiallyAlways(_));
                let (within, beyond) = (eventually(self.within)?, eventually(self.beyond)?);
                // The regions have a run end where a fault is all that may come.
                assert!(!self.is_sound || is_shown != within, "{what}");
                assert!(!(is_shown && within) && (is_shown || beyond), "{what}");
            }
            QueryKind::Sup { of, when } | QueryKind::Inf { of, when } => {
                let greatest = matches!(ask, QueryKind::Sup { .. });
                let limit = answer.extrema[0].limit;
                if matches!(of[0], QueryMeasure::Data(_)) {
                    let values = self.within.values(usize::from(READ), when)?;
                    let value = if greatest { values.last() } else { values.first() };
                    let want = value.map_or(ExtremumLimit::Nowhere, |n| ExtremumLimit::At {
                        value: ExtremumValue::Number(*n),
                        attained: true,
                    });
                    assert_eq!(limit, want, "{what}");
                    return Ok(());
                }
                match (self.within.extremes(0, when)?.map(|both| both[usize::from(greatest)]), limit) {
                    (None, limit) => assert_eq!(limit, ExtremumLimit::Nowhere, "{what}"),
                    (Some(Some((units, attained))), limit) => {
                        let value = ExtremumValue::Nanos(units * SECOND);
                        assert_eq!(limit, ExtremumLimit::At { value, attained }, "{what}");
                    }
                    (Some(None), limit) => assert_ne!(limit, ExtremumLimit::Nowhere, "{what}"),
                }
            }
            QueryKind::Invariantly(_) => {}
        }
        Ok(())
    }
}

fn asked(seed: u64) -> Vec<QueryKind> {
    let l = |shift: u64| LocationId(((seed >> shift) % 3) as u16);
    let (here, there) = (at(0, l(0)), at(1, l(2)));
    let reads = QueryFormula::Data(eq(v(READ), n((seed % 3) as i64)));
    let stuck = QueryFormula::And(vec![here.clone(), QueryFormula::Deadlock]);
    let of = |measure: &QueryMeasure| vec![measure.clone()];
    let (int, clock) = (QueryMeasure::Data(v(READ)), QueryMeasure::Clock(ClockId(0)));
    vec![
        QueryKind::Possibly(stuck),
        QueryKind::Possibly(QueryFormula::Deadlock),
        QueryKind::Eventually(there.clone()),
        QueryKind::Eventually(reads.clone()),
        QueryKind::PotentiallyAlways(QueryFormula::Not(Box::new(there.clone()))),
        QueryKind::LeadsTo(reads, there),
        QueryKind::Sup { of: of(&int), when: here.clone() },
        QueryKind::Inf { of: of(&int), when: here.clone() },
        QueryKind::Sup { of: of(&clock), when: here.clone() },
        QueryKind::Inf { of: of(&clock), when: here },
    ]
}

fn reads(e: &Expr) -> bool {
    let mut found = false;
    e.each_var(&mut |i| found |= i == FIRST);
    found
}

#[derive(Debug, Default)]
struct Tally {
    compared: u64,
    /// Answers that the network without the variables gave.
    apart: u64,
    faults: u64,
    open: u64,
}

fn compare(seed: u64, tally: &mut Tally) -> Result<(), String> {
    let p = network(seed);
    let graph = explore(&p, &p.networks[0], LIMITS)?;
    if !graph.starts {
        return Ok(());
    }
    let mut edges = p.automata.iter().flat_map(|a| &a.edges);
    let cut: &[u16] = if edges.any(|e| e.guard.as_ref().is_some_and(reads)) {
        &[SECOND_COUNTER, ARRAY]
    } else {
        &[FIRST, SECOND_COUNTER, ARRAY]
    };
    let wide = never_set(&p, cut);
    let beyond = explore(&wide, &wide.networks[0], LIMITS)?;
    let judge = Judge { within: &graph, beyond: &beyond, is_sound: graph.faults.is_empty() };
    for ask in asked(seed) {
        let what = || format!("seed {seed}, {ask:?}\n{}", oracle::text::program(&p));
        match apart(&p, &ask) {
            None => {}
            Some(Err(SearchError::Internal(error))) => panic!("{error}: {}", what()),
            Some(Err(SearchError::Model { error, .. })) => {
                tally.faults += 1;
                assert!(!graph.faults.is_empty(), "{error}: {}", what());
            }
            Some(Ok((answer, _))) if answer.verdict == QueryVerdict::Inconclusive => tally.open += 1,
            Some(Ok((answer, apart))) => {
                tally.apart += u64::from(apart);
                judge.compare(&what(), &ask, &answer)?;
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
fn queries_without_what_nothing_reads_agree_with_regions() {
    let (cases, first) = (number("HRDSL_CASES", 400), number("HRDSL_SEED", 0));
    let mut tally = Tally::default();
    for seed in first..first + cases {
        // What the regions are too many for is not compared.
        let _ = compare(seed, &mut tally);
    }
    let Tally { compared, apart, faults, open } = tally;
    assert!(compared * 2 >= cases && apart > compared * 5, "{tally:?}");
    assert!(faults * 2 > compared && open < compared, "{tally:?}");
}

// ── By hand ──

/// Three places in a circle, gone round for ever; each round is counted up to `most`, unless the count begins again with each round.
fn circle(most: i64, begins_again: bool) -> Program {
    let mut p = program();
    let laps = shared(&mut p, "laps", 0, most, 1);
    let mut a = automaton("A", &["x"]);
    let [one, two, three] = ["one", "two", "three"].map(|l| {
        location(&mut a, l, LocationKind::Normal, &[common::clock(0, hrdsl_ir::ta::ClockOp::Le, 2)])
    });
    edge(one, two).reset(0).to(&mut a);
    edge(two, three).reset(0).to(&mut a);
    let last = edge(three, one).reset(0);
    let count = bin(BinaryOp::Add, v(laps), n(1));
    if begins_again { last.set(laps, n(0)) } else { last.set(laps, count) }.to(&mut a);
    add(&mut p, a);
    p
}

fn not(f: QueryFormula) -> QueryFormula {
    QueryFormula::Not(Box::new(f))
}

#[test]
fn no_query_counts_what_nothing_reads() {
    let p = circle(1_000_000, false);
    let x = || vec![QueryMeasure::Clock(ClockId(0))];
    let third = || at(0, LocationId(2));
    for ask in [
        QueryKind::Possibly(QueryFormula::Deadlock),
        QueryKind::Eventually(third()),
        QueryKind::LeadsTo(at(0, LocationId(0)), third()),
        QueryKind::PotentiallyAlways(not(third())),
        QueryKind::Sup { of: x(), when: third() },
        QueryKind::Inf { of: x(), when: third() },
    ] {
        let (answer, apart) = apart(&p, &ask).unwrap().unwrap();
        assert!(apart && answer.statistics.unwrap().stored < 10, "{ask:?}: {answer:?}");
    }
}

#[test]
fn a_loop_that_counts_leads_to_the_fault_and_one_that_begins_again_does_not() {
    let never = QueryKind::Eventually(QueryFormula::Or(Vec::new()));
    let (answer, apart_from) = apart(&circle(9, true), &never).unwrap().unwrap();
    let run = answer.run.unwrap();
    // The count is 1 in the first round, and 0 in all others.
    assert!(apart_from && matches!(run.ending, RunEnding::Again(3)) && run.steps.len() == 6, "{run:?}");
    let Err(SearchError::Model { error, witness: Some(run) }) = apart(&circle(9, false), &never).unwrap()
    else {
        panic!("a fault is not told")
    };
    assert!(error.to_string().contains("`laps` becomes 10"), "{error}");
    assert_eq!(run.steps.len(), 26);
}

#[test]
fn a_budget_that_ends_names_the_variable_that_grows() {
    let p = circle(1_000_000, false);
    let budget = SearchBudget { states: 300, ..SearchBudget::default() };
    let options = QueryOptions { budget, ..QueryOptions::default() };
    let laps = || QueryFormula::Data(bin(BinaryOp::Lt, v(0), n(900_000)));
    for ask in [
        QueryKind::Possibly(QueryFormula::And(vec![not(laps()), QueryFormula::Deadlock])),
        QueryKind::Eventually(not(laps())),
        QueryKind::LeadsTo(at(0, LocationId(0)), not(laps())),
        QueryKind::Sup { of: vec![QueryMeasure::Data(v(0))], when: at(0, LocationId(0)) },
    ] {
        let answer = hrdsl_ta::answer(&p, &p.networks[0], &query(ask.clone()), &options).unwrap();
        assert_eq!(answer.verdict, QueryVerdict::Inconclusive, "{ask:?}");
        assert!(answer.why.contains("; `laps` has the most values so far, from 1 to "), "{}", answer.why);
    }
}

#[test]
fn the_fastest_run_is_one_before_the_overflow() {
    // At once by counting twice, which overflows; or after 3 s.
    let mut p = program();
    let laps = shared(&mut p, "laps", 0, 1, 0);
    let mut a = automaton("A", &["x"]);
    let [one, two, end] = ["one", "two", "end"].map(|l| location(&mut a, l, LocationKind::Normal, &[]));
    let count = || bin(BinaryOp::Add, v(laps), n(1));
    edge(one, two).set(laps, count()).to(&mut a);
    edge(two, end).set(laps, count()).to(&mut a);
    edge(one, end).clock(0, hrdsl_ir::ta::ClockOp::Ge, 3).to(&mut a);
    add(&mut p, a);
    let goal = ReachabilityGoal { what: GoalKind::Formula(at(0, end)), settled: false };
    let observe = ObservationOptions { formulas: vec![at(0, end)], ..ObservationOptions::default() };
    let goals = [goal];
    let unread = UnreadCounters::find(&p, &p.networks[0], &observe, &goals).unwrap().unwrap();
    let (report, ranges) = unread.explore(&goals, &SearchOptions::shortest(), &|_| true).unwrap();
    let GoalOutcome::Reached(found) = &report.goals[0] else { panic!("{report:?}") };
    let budget = SearchBudget::default();
    let run = unread.fastest(&goals[0], found, budget, ScheduleOptions::default()).unwrap().unwrap();
    assert_eq!((run.end, run.steps.len()), (3 * SECOND * run.ticks, 1));
    assert!(matches!(&ranges[0].finding, RangeFinding::Left { .. }));
    // With all variables the fault comes first.
    assert!(fastest(unread.model(), &goals[0], found, budget, ScheduleOptions::default()).is_err());
}
