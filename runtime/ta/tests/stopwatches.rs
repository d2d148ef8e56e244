//! Clocks that stand still: what is proved, what is found, and what is not asked, against a judge that tries all times of a grid.

mod common;

use common::asked::query;
use common::grid::{GRID, GridJudge, random};
use common::{add, and, automaton, channel, clock, edge, eq, location, n, normal, or, program, shared, v};
use hrdsl_ir::{
    Program,
    ta::{ChannelKind, ClockConstraint, ClockId, ClockOp, LocationId, LocationKind, QueryFormula, QueryKind},
    value::SECOND,
};
use hrdsl_ta::{
    CompiledNetwork, GoalKind, GoalOutcome, ObservationOptions, QueryOptions, QueryVerdict, ReachabilityGoal,
    SearchBudget, SearchCutoff, SearchOptions, SearchReport, answer, check, explore,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// The last location is left only at the end: goals are the locations of both automata.
fn goals(p: &Program) -> Vec<ReachabilityGoal> {
    let all = p.automata.iter().enumerate().flat_map(|(automaton, a)| {
        (0..a.locations.len()).map(move |l| GoalKind::Location { automaton, location: LocationId(l as u16) })
    });
    all.map(|what| ReachabilityGoal { what, settled: false }).collect()
}

fn searched(p: &Program) -> SearchReport {
    let budget = SearchBudget { states: 4_000, ..SearchBudget::default() };
    check(p, &p.networks[0], &goals(p), &[], &[], budget).unwrap()
}

// ── By hand ──

/// `run` while x and z run; `wait` while x stands. Then x and z are compared.
fn one(guard: &[ClockConstraint]) -> Program {
    let mut p = program();
    let mut a = automaton("P", &["x", "z"]);
    let run = location(&mut a, "run", LocationKind::Normal, &[clock(1, ClockOp::Le, 4)]);
    let wait = normal(&mut a, "wait");
    let again = normal(&mut a, "again");
    let end = normal(&mut a, "end");
    a.locations[usize::from(wait.0)].stopped = vec![ClockId(0)];
    edge(run, wait).clock(1, ClockOp::Ge, 4).to(&mut a);
    edge(wait, again).clock(1, ClockOp::Eq, 9).to(&mut a);
    let mut last = edge(again, end);
    last.0.clock_guard = guard.to_vec();
    last.to(&mut a);
    add(&mut p, a);
    p
}

#[test]
fn a_clock_that_stood_is_behind() {
    let reached = |guard: &[ClockConstraint]| searched(&one(guard)).goals.pop().unwrap();
    let GoalOutcome::Reached(run) = reached(&[clock(0, ClockOp::Ge, 7)]) else { panic!("4 + 3 s are 7") };
    assert_eq!((run.end, run.ticks), (12 * SECOND, 1), "9 s, and the 3 s that are left of 7");
    let late = reached(&[clock(0, ClockOp::Ge, 7), clock(1, ClockOp::Le, 11)]);
    assert_eq!(late, GoalOutcome::Unreachable, "11 s are 6 of x");
    assert!(matches!(
        reached(&[clock(0, ClockOp::Le, 4), clock(1, ClockOp::Ge, 9)]),
        GoalOutcome::Reached(_)
    ));
}

/// Two stopwatches and a clock: each pair of three delays adds up to 1 s, so each delay is half a second. No whole times do that.
fn halves(last: i64) -> Program {
    let mut p = program();
    let mut a = automaton("P", &["x", "y", "z"]);
    // x runs in the first and second, y in the second and third, z in the first and third.
    let places: Vec<LocationId> = ["first", "second", "third", "end"].map(|l| normal(&mut a, l)).to_vec();
    for (place, stands) in places.iter().zip([1u16, 2, 0]) {
        a.locations[usize::from(place.0)].stopped = vec![ClockId(stands)];
    }
    edge(places[0], places[1]).to(&mut a);
    edge(places[1], places[2]).to(&mut a);
    let end = edge(places[2], places[3]).clock(0, ClockOp::Eq, 1).clock(1, ClockOp::Eq, 1);
    end.clock(2, ClockOp::Eq, last).to(&mut a);
    add(&mut p, a);
    p
}

#[test]
fn times_may_be_fractions() {
    let GoalOutcome::Reached(run) = searched(&halves(1)).goals.pop().unwrap() else { panic!() };
    let times: Vec<i64> = run.steps.iter().map(|s| s.time * 2 / run.ticks).collect();
    assert_eq!(times, [SECOND, 2 * SECOND, 3 * SECOND]);
}

/// The zones know the differences of two clocks each, and not that all three add up to twice the time: y would have to stand for longer
/// than there is. What they reach no run reaches, and the second search says so.
#[test]
fn what_zones_alone_reach_is_not_reached() {
    assert_eq!(searched(&halves(3)).goals.pop().unwrap(), GoalOutcome::Unreachable);
    // The same in a place that can be come to again and again: there are more paths than can be tried.
    let mut p = halves(3);
    let a = &mut p.automata[0];
    edge(LocationId(1), LocationId(0)).to(a);
    edge(LocationId(0), LocationId(2)).to(a);
    let found = searched(&p).goals.pop().unwrap();
    assert!(
        matches!(found, GoalOutcome::Inconclusive(SearchCutoff::Zones) | GoalOutcome::Unreachable),
        "{found:?}"
    );
}

#[test]
fn differences_of_clocks_are_refused_by_name() {
    let p = one(&[]);
    let at = |location| QueryFormula::At { automaton: 0, location: LocationId(location) };
    let late =
        || QueryFormula::Clock(ClockConstraint { minus: Some(ClockId(1)), ..clock(0, ClockOp::Ge, 3) });
    let asked = [
        QueryKind::Eventually(late()),
        QueryKind::PotentiallyAlways(late()),
        QueryKind::LeadsTo(at(0), late()),
        QueryKind::Possibly(late()),
    ];
    for ask in asked {
        let query = query(ask);
        let error = answer(&p, &p.networks[0], &query, &QueryOptions::default()).unwrap_err().to_string();
        assert!(
            error.contains("cannot be asked where clocks stand still, as `P.x` does in `P.wait`"),
            "{error}"
        );
    }
    let reached = query(QueryKind::Possibly(at(3)));
    let answered = answer(&p, &p.networks[0], &reached, &QueryOptions::default()).unwrap();
    assert_eq!(answered.verdict, QueryVerdict::Holds);
}

// ── At random, against a grid ──

/// No wrong yes and no wrong no. Where a run's times are not on the judge's grid, the judge has one of the run's own.
#[test]
fn random_networks_agree_with_a_grid() {
    #[allow(clippy::disallowed_methods, reason = "how long to look is asked from outside")]
    let given = std::env::var("HRDSL_CASES").ok();
    let cases = given.and_then(|n| n.parse().ok()).unwrap_or(150);
    let (mut yes, mut no, mut open) = (0, 0, 0);
    for seed in 0..cases {
        let p = random(&mut ChaCha8Rng::seed_from_u64(seed));
        let model = CompiledNetwork::new(&p, &p.networks[0], &ObservationOptions::default()).unwrap();
        let judge = GridJudge { p: &p, grid: GRID };
        let reached = judge.reached();
        if reached.is_empty() {
            continue;
        }
        let goals = goals(&p);
        let options = SearchOptions {
            budget: SearchBudget { states: 3_000, ..SearchBudget::default() },
            ..SearchOptions::default()
        };
        let report = explore(&model, &goals, &options, &|_| true).unwrap();
        for (goal, outcome) in goals.iter().zip(&report.goals) {
            let GoalKind::Location { automaton, location } = goal.what else { continue };
            let place = (automaton, usize::from(location.0));
            match outcome {
                GoalOutcome::Reached(run) => {
                    yes += 1;
                    let whole = run.steps.iter().map(|s| s.time).chain([run.end]).all(|t| {
                        i128::from(t) * i128::from(GRID) % (i128::from(run.ticks) * i128::from(SECOND)) == 0
                    });
                    let on_grid = reached.contains(&place);
                    let finer =
                        || GridJudge { p: &p, grid: GRID * run.ticks.min(12) }.reached().contains(&place);
                    assert!(on_grid || (!whole && finer()), "{seed}: {place:?} is not reached: {run:?}");
                }
                GoalOutcome::Unreachable => {
                    no += 1;
                    assert!(!reached.contains(&place), "{seed}: {place:?} is reached");
                }
                GoalOutcome::Inconclusive(_) => open += 1,
            }
        }
    }
    assert!(yes > cases && no > cases / 4, "{yes} {no} {open}");
    assert!(open * 20 <= yes + no, "{yes} {no} {open}");
}

// ── Interruption ──

/// A task that comes each `period` and needs `work`; those before it in the list interrupt it.
#[derive(Clone, Copy)]
struct PeriodicTask {
    period: i64,
    work: i64,
}

/// The longest response of the last task, by the recurrence R = C + Σ ⌈R / Tⱼ⌉ Cⱼ (Joseph and Pandya 1986).
fn response(tasks: &[PeriodicTask]) -> i64 {
    let (last, others) = tasks.split_last().unwrap();
    let mut r = last.work;
    loop {
        let next = last.work + others.iter().map(|t| (r + t.period - 1) / t.period * t.work).sum::<i64>();
        if next == r {
            return r;
        }
        r = next;
    }
}

/// Tasks on one processor, the first the most urgent, all released at the start. Of each: `c`, what is done of its work, which stands
/// while another runs; `r`, the time since its release. Whoever may go on or has to give way does so at once.
fn interrupted(tasks: &[PeriodicTask]) -> Program {
    let mut p = program();
    let ready: Vec<u16> = (0..tasks.len()).map(|i| shared(&mut p, &format!("ready{i}"), 0, 1, 0)).collect();
    let now = channel(&mut p, "now", ChannelKind::Broadcast, &[]);
    p.channels[0].urgent = true;
    for (i, task) in tasks.iter().enumerate() {
        let mut a = automaton(&format!("T{i}"), &["c", "r"]);
        let (c, r) = (0, 1);
        let start = location(&mut a, "start", LocationKind::Committed, &[]);
        let idle = location(&mut a, "idle", LocationKind::Normal, &[clock(r, ClockOp::Le, task.period)]);
        let ends = [clock(c, ClockOp::Le, task.work), clock(r, ClockOp::Le, task.period)];
        let runs = location(&mut a, "runs", LocationKind::Normal, &ends);
        let held = location(&mut a, "held", LocationKind::Normal, &[clock(r, ClockOp::Le, task.period)]);
        a.locations[usize::from(held.0)].stopped = vec![ClockId(c)];
        edge(start, held).set(ready[i], n(1)).to(&mut a);
        edge(idle, held).clock(r, ClockOp::Eq, task.period).set(ready[i], n(1)).reset(c).reset(r).to(&mut a);
        let free = ready[..i].iter().map(|&slot| eq(v(slot), n(0))).reduce(and);
        let taken = ready[..i].iter().map(|&slot| eq(v(slot), n(1))).reduce(or);
        let mut go = edge(held, runs).offer(now, &[]);
        go.0.guard = free;
        go.to(&mut a);
        if let Some(taken) = taken {
            edge(runs, held).offer(now, &[]).when(taken).to(&mut a);
        }
        edge(runs, idle).clock(c, ClockOp::Eq, task.work).set(ready[i], n(0)).to(&mut a);
        add(&mut p, a);
    }
    p
}

/// Whether the last task can be at work, or wait for it, this long after its release.
fn last_responds(p: &Program, op: ClockOp, after: i64) -> QueryVerdict {
    let last = p.automata.len() - 1;
    let at = |l| QueryFormula::At { automaton: last as u16, location: LocationId(l) };
    // The network's clocks: none is shared, and each task has two.
    let response = clock(2 * last as u16 + 1, op, after);
    let asked = QueryFormula::And(vec![QueryFormula::Or(vec![at(2), at(3)]), QueryFormula::Clock(response)]);
    answer(p, &p.networks[0], &query(QueryKind::Possibly(asked)), &QueryOptions::default()).unwrap().verdict
}

#[test]
fn the_recurrence_is_that_of_the_literature() {
    let tasks = [(7, 3), (12, 3), (20, 5)].map(|(period, work)| PeriodicTask { period, work });
    // Burns and Wellings, "Real-Time Systems and Programming Languages", on response-time analysis: 3, 6 and 20.
    assert_eq!([1, 2, 3].map(|n| response(&tasks[..n])), [3, 6, 20]);
}

#[test]
fn responses_under_interruption_are_those_of_the_recurrence() {
    let sets: [&[(i64, i64)]; 4] = [
        &[(7, 3), (12, 3), (20, 5)],
        &[(5, 1), (9, 2), (14, 4)],
        &[(4, 1), (6, 2), (12, 3)],
        &[(3, 1), (8, 3)],
    ];
    for set in sets {
        let tasks: Vec<PeriodicTask> =
            set.iter().map(|&(period, work)| PeriodicTask { period, work }).collect();
        for count in 1..=tasks.len() {
            let longest = response(&tasks[..count]);
            let p = interrupted(&tasks[..count]);
            assert_eq!(
                last_responds(&p, ClockOp::Ge, longest),
                QueryVerdict::Holds,
                "{set:?} {count}: {longest}"
            );
            assert_eq!(
                last_responds(&p, ClockOp::Gt, longest),
                QueryVerdict::Fails,
                "{set:?} {count}: {longest}"
            );
        }
    }
}
