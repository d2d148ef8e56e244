//! The one place that knows the engine: asks it in all its modes, and compares its answers with the regions.

use hrdsl_ir::{
    Program,
    suite::WitnessKind,
    ta::{
        AutomatonId, ClockConstraint, ClockId, ClockOp, LocationId, QueryFormula, QueryKind, QueryMeasure,
        TimeSum, location_variable,
    },
    value::SECOND,
};
use hrdsl_ta::{
    ExtrapolationAbstraction, ExtremumLimit, ExtremumValue, GoalKind, GoalOutcome, ModelError, QueryAnswer,
    QueryOptions, QueryVerdict, ReachabilityGoal, SearchBudget, SearchError, SearchOptions, SearchOrder,
    SubsumptionRelation, answer,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::{
    common::{
        asked::{asked, query},
        automaton, eq, n, normal, v,
    },
    oracle::{Graph, Limits, explore},
};

pub const LIMITS: Limits = Limits { states: 20_000, bound: 4, differences: false };

/// What the engine says otherwise than the regions. `Err`: the regions cannot say.
pub fn disagreement(p: &Program) -> Result<Option<String>, String> {
    let graph = explore(p, &p.networks[0], LIMITS)?;
    let goals = goals(p);
    let expected: Vec<bool> = goals.iter().map(|g| reached(&graph, &g.what)).collect::<Result<_, _>>()?;
    for (name, options) in modes() {
        if let Err(what) = compared(p, &graph, &goals, &expected, &options) {
            return Ok(Some(format!("{name}: {what}")));
        }
    }
    if !graph.starts || !graph.faults.is_empty() {
        return Ok(None);
    }
    for asked in [asks, lengths, bounds, times] {
        let differs = asked(p, &graph)?;
        if differs.is_some() {
            return Ok(differs);
        }
    }
    Ok(None)
}

/// Deadlocks and runs without end: every kind of query about the first formulas.
pub fn asks(p: &Program, graph: &Graph) -> Result<Option<String>, String> {
    let formulas = formulas(p);
    let [f, g, h, ..] = formulas.as_slice() else { return Ok(None) };
    let at = |automaton, l| QueryFormula::At { automaton, location: LocationId(l) };
    let left = QueryFormula::Not(Box::new(at(0, 0)));
    let dead = || QueryFormula::Deadlock;
    let dead_and = QueryFormula::And(vec![f.clone(), dead()]);
    let dead_or = QueryFormula::Or(vec![dead(), h.clone()]);
    let alive = QueryFormula::And(vec![QueryFormula::Not(Box::new(dead())), g.clone()]);
    let asked = [
        (QueryKind::Possibly(dead()), graph.possibly(&dead())?),
        (QueryKind::Possibly(dead_and.clone()), graph.possibly(&dead_and)?),
        (QueryKind::Possibly(dead_or.clone()), graph.possibly(&dead_or)?),
        (QueryKind::Possibly(alive.clone()), graph.possibly(&alive)?),
        (QueryKind::PotentiallyAlways(at(0, 0)), graph.always(&at(0, 0))?),
        (QueryKind::PotentiallyAlways(f.clone()), graph.always(f)?),
        (QueryKind::Eventually(left.clone()), graph.eventually(&left)?),
        (QueryKind::Eventually(g.clone()), graph.eventually(g)?),
        (QueryKind::LeadsTo(at(0, 1), at(0, 0)), graph.leads_to(&at(0, 1), &at(0, 0))?),
        (QueryKind::LeadsTo(g.clone(), h.clone()), graph.leads_to(g, h)?),
    ];
    for (ask, expected) in asked {
        match said(p, ask.clone(), WitnessKind::Any) {
            Ok(a) if a.verdict == if expected { QueryVerdict::Holds } else { QueryVerdict::Fails } => {}
            other => return Ok(Some(format!("{ask:?} should be {expected}: {other:?}"))),
        }
    }
    Ok(None)
}

fn said(p: &Program, ask: QueryKind, witness: WitnessKind) -> Result<QueryAnswer, SearchError> {
    // A clock may grow without end in a loop in which time is bounded.
    let states = match ask {
        QueryKind::Sup { .. } | QueryKind::Inf { .. } => 5_000,
        QueryKind::Possibly(_)
        | QueryKind::Invariantly(_)
        | QueryKind::PotentiallyAlways(_)
        | QueryKind::Eventually(_)
        | QueryKind::LeadsTo(..) => usize::MAX,
    };
    let query = query(ask);
    let budget = SearchBudget { states, ..SearchBudget::default() };
    answer(p, &p.networks[0], &query, &QueryOptions { witness, budget, ..QueryOptions::default() })
}

/// Shortest runs have as few transitions as any.
fn lengths(p: &Program, graph: &Graph) -> Result<Option<String>, String> {
    let least = graph.lengths();
    let dead = QueryFormula::Deadlock;
    for f in formulas(p).into_iter().chain([dead]) {
        let mut expected = None;
        for (at, &length) in least.iter().enumerate() {
            if graph.holds(at, &f).map_err(|e| format!("{e:?}"))? {
                expected = Some(expected.map_or(length, |old: usize| old.min(length)));
            }
        }
        let found = said(p, QueryKind::Possibly(f.clone()), WitnessKind::Shortest);
        let length = found.as_ref().map(|a| a.run.as_ref().map(|run| run.steps.len()));
        if length != Ok(expected) {
            return Ok(Some(format!("a shortest run to {f:?} has {expected:?} transitions: {found:?}")));
        }
    }
    Ok(None)
}

/// `sup` and `inf` of clocks and variables.
fn bounds(p: &Program, graph: &Graph) -> Result<Option<String>, String> {
    let formulas = formulas(p);
    let clocks = graph.states[0].clocks.len();
    for (i, f) in formulas.iter().take(3).enumerate() {
        let clock = i % clocks;
        let of = vec![QueryMeasure::Clock(ClockId(clock as u16)), QueryMeasure::Data(v(0))];
        let clock = graph.extremes(clock, f)?;
        let numbers = graph.values(0, f)?;
        for side in [0, 1] {
            let ask = if side == 0 {
                QueryKind::Inf { of: of.clone(), when: f.clone() }
            } else {
                QueryKind::Sup { of: of.clone(), when: f.clone() }
            };
            let found = said(p, ask.clone(), WitnessKind::Any);
            let number = if side == 0 { numbers.first() } else { numbers.last() };
            let number = number.map_or(ExtremumLimit::Nowhere, |&n| ExtremumLimit::At {
                value: ExtremumValue::Number(n),
                attained: true,
            });
            let agrees = found.as_ref().is_ok_and(|a| {
                a.extrema.len() == 2
                    && (a.extrema[1].limit == number || inconclusive(&a.extrema[1].limit))
                    && is_limit(&a.extrema[0].limit, clock.map(|c| c[side]), graph)
            });
            if !agrees {
                return Ok(Some(format!("{ask:?} is {clock:?} and {number:?}: {found:?}")));
            }
        }
    }
    Ok(None)
}

fn inconclusive(limit: &ExtremumLimit) -> bool {
    matches!(limit, ExtremumLimit::Inconclusive { .. })
}

/// Whether the engine's limit is this one. `Some(None)`: beyond what the regions tell apart.
fn is_limit(limit: &ExtremumLimit, expected: Option<Option<(i64, bool)>>, graph: &Graph) -> bool {
    let unit = graph.net.unit;
    match (limit, expected) {
        (ExtremumLimit::Nowhere, expected) => expected.is_none(),
        (ExtremumLimit::At { value: ExtremumValue::Nanos(n), attained }, Some(Some((units, exact)))) => {
            (*n, *attained) == (units * unit, exact)
        }
        (ExtremumLimit::At { value: ExtremumValue::Nanos(n), .. }, Some(None)) => {
            *n >= graph.net.grain.most * unit
        }
        (ExtremumLimit::Unbounded | ExtremumLimit::Inconclusive { .. }, expected) => expected == Some(None),
        (ExtremumLimit::At { .. }, _) => false,
    }
}

/// Fastest runs end as early as any: an automaton more has a clock that tells the time.
fn times(p: &Program, _: &Graph) -> Result<Option<String>, String> {
    let mut timed = p.clone();
    let mut watch = automaton("Watch", &["t"]);
    normal(&mut watch, "on");
    timed.automata.push(watch);
    let id = AutomatonId(timed.automata.len() as u16 - 1);
    timed.networks[0].automata.push(id);
    // One clock more makes many regions more.
    let Ok(graph) = explore(&timed, &timed.networks[0], Limits { states: 3_000, ..LIMITS }) else {
        return Ok(None);
    };
    let clock = graph.states[0].clocks.len() - 1;
    for f in formulas(p).into_iter().take(4).chain([QueryFormula::Deadlock]) {
        let expected = graph.extremes(clock, &f)?.map(|[least, _]| least);
        let found = said(p, QueryKind::Possibly(f.clone()), WitnessKind::Fastest);
        let end = found.as_ref().map(|a| a.run.as_ref().map(|run| (run.end, run.ticks)));
        let agrees = match (end, expected) {
            (Ok(None), None) => true,
            (Ok(Some((end, ticks))), Some(Some((units, attained)))) => {
                let least = units * graph.net.unit * ticks;
                // A strict bound is met a tick later, or some.
                if attained { end == least } else { end > least && end < least + graph.net.unit * ticks }
            }
            (Ok(Some((end, ticks))), Some(None)) => end >= graph.net.grain.most * graph.net.unit * ticks,
            (Ok(None), Some(_)) | (Ok(Some(_)), None) | (Err(_), _) => false,
        };
        if !agrees {
            return Ok(Some(format!("the earliest {f:?} is at {expected:?}: {found:?}")));
        }
    }
    Ok(None)
}

/// All orders, one thread and two, with and without what makes it fast.
fn modes() -> Vec<(&'static str, SearchOptions)> {
    let with = |order, threads| SearchOptions { order, threads, ..SearchOptions::default() };
    vec![
        ("reference", SearchOptions::reference()),
        (
            "equality",
            SearchOptions { subsumption: SubsumptionRelation::Equality, ..SearchOptions::reference() },
        ),
        (
            "greatest constants",
            SearchOptions { abstraction: ExtrapolationAbstraction::Greatest, ..SearchOptions::reference() },
        ),
        ("shortest", SearchOptions::shortest()),
        ("breadth", with(SearchOrder::Breadth, 1)),
        ("topological", with(SearchOrder::Topological, 1)),
        ("depth", with(SearchOrder::Depth, 1)),
        ("random depth", SearchOptions { seed: 7, ..with(SearchOrder::RandomDepth, 1) }),
        ("two threads", with(SearchOrder::Topological, 2)),
        ("two threads, depth", with(SearchOrder::Depth, 2)),
        ("everything kept", SearchOptions { reduce: false, ..with(SearchOrder::Depth, 1) }),
        ("committed states passed", SearchOptions { keep_committed: false, ..with(SearchOrder::Depth, 1) }),
    ]
}

fn goals(p: &Program) -> Vec<ReachabilityGoal> {
    let mut goals = Vec::new();
    for (automaton, id) in p.networks[0].automata.iter().enumerate() {
        let a = &p.automata[usize::from(id.0)];
        let locations =
            (0..a.locations.len()).map(|l| GoalKind::Location { automaton, location: LocationId(l as u16) });
        let edges = (0..a.edges.len()).map(|edge| GoalKind::Edge { automaton, edge });
        goals.extend(locations.chain(edges).map(|what| ReachabilityGoal { what, settled: false }));
    }
    let formulas = formulas(p).into_iter().map(GoalKind::Formula);
    goals.extend(formulas.map(|what| ReachabilityGoal { what, settled: false }));
    goals
}

/// A few formulas over locations, variables and clocks.
pub fn formulas(p: &Program) -> Vec<QueryFormula> {
    let network = &p.networks[0].automata;
    let clocks =
        p.clocks.len() + network.iter().map(|a| p.automata[usize::from(a.0)].clocks.len()).sum::<usize>();
    let mut rng = ChaCha8Rng::seed_from_u64(clocks as u64 + 10 * network.len() as u64);
    let mut below = |n: usize| rng.random_range(0..n);
    let mut all = Vec::new();
    for i in 0..10 {
        let mut parts = Vec::new();
        for (m, a) in network.iter().enumerate() {
            let at = LocationId(below(p.automata[usize::from(a.0)].locations.len()) as u16);
            if below(3) > 0 {
                parts.push(match below(3) {
                    0 => QueryFormula::Data(eq(v(location_variable(m as u16)), n(i64::from(at.0)))),
                    _ => QueryFormula::At { automaton: m as u16, location: at },
                });
            }
        }
        if below(2) == 0 {
            parts.push(QueryFormula::Data(eq(v(0), n(below(3) as i64))));
        }
        if below(2) == 0 {
            let op = [ClockOp::Lt, ClockOp::Le, ClockOp::Eq, ClockOp::Ge, ClockOp::Gt][below(5)];
            let bound = TimeSum::constant(below(4) as i64 * SECOND);
            let c = ClockConstraint { clock: ClockId(below(clocks) as u16), minus: None, op, bound };
            parts.push(QueryFormula::Clock(c));
        }
        let all_of = QueryFormula::And(parts);
        all.push(if i % 5 == 4 { QueryFormula::Not(Box::new(all_of)) } else { all_of });
    }
    all
}

fn reached(graph: &Graph, goal: &GoalKind) -> Result<bool, String> {
    match goal {
        GoalKind::Location { automaton, location } => {
            Ok(graph.locations().contains(&(*automaton, location.0)))
        }
        GoalKind::Edge { automaton, edge } => Ok(graph.edges.contains_key(&(*automaton, *edge))),
        GoalKind::Formula(f) => graph.possibly(f),
        GoalKind::Pair { .. } | GoalKind::Use { .. } | GoalKind::Condition(_) => {
            Err("no such goal".to_owned())
        }
    }
}

/// How the regions come to a goal.
fn way(graph: &Graph, goal: &GoalKind) -> String {
    let first = match goal {
        GoalKind::Location { automaton, location } => {
            graph.states.iter().position(|s| s.at[*automaton] == location.0)
        }
        GoalKind::Edge { automaton, edge } => graph.edges.get(&(*automaton, *edge)).copied(),
        GoalKind::Formula(f) => (0..graph.states.len()).find(|&s| graph.holds(s, f) == Ok(true)),
        GoalKind::Pair { .. } | GoalKind::Use { .. } | GoalKind::Condition(_) => None,
    };
    first.map_or(String::new(), |s| graph.path(s))
}

fn compared(
    p: &Program,
    graph: &Graph,
    goals: &[ReachabilityGoal],
    expected: &[bool],
    options: &SearchOptions,
) -> Result<(), String> {
    let report = match asked(p, goals, options) {
        Err(SearchError::Model { error: ModelError::Initial, .. }) if !graph.starts => return Ok(()),
        Err(SearchError::Model { .. }) if !graph.faults.is_empty() => return Ok(()),
        Err(error) => return Err(format!("the engine alone: {error:?}")),
        Ok(_) if !graph.starts => return Err("the engine starts".to_owned()),
        Ok(report) => report,
    };
    let fault = graph.faults.first();
    for ((goal, outcome), &expected) in goals.iter().zip(&report.goals).zip(expected) {
        match outcome {
            GoalOutcome::Reached(w) if !expected => {
                return Err(format!("{goal:?} is not reachable: {}", w.text(p, &p.networks[0])));
            }
            GoalOutcome::Unreachable if expected => {
                return Err(format!("{goal:?} is reachable:\n{}", way(graph, &goal.what)));
            }
            GoalOutcome::Unreachable if fault.is_some() => {
                return Err(format!("a fault is not told: {fault:?}\n{}", graph.path(graph.faults[0].0)));
            }
            GoalOutcome::Reached(_) | GoalOutcome::Unreachable => {}
            GoalOutcome::Inconclusive(_) => return Err("the budget is used up".to_owned()),
        }
    }
    if options.threads > 1 {
        let alone = asked(p, goals, &SearchOptions { threads: 1, ..*options });
        if alone.as_ref() != Ok(&report) {
            return Err("one thread gives another report".to_owned());
        }
    }
    Ok(())
}
