//! The one place that knows the engine: asks it in all its modes, and compares its answers with the regions.

use hrdsl_ir::{
    Program, Span,
    ta::NetworkId,
    ta::{
        ClockConstraint, ClockId, ClockOp, LocationId, Query, QueryFormula, QueryKind, TimeSum,
        location_variable,
    },
    value::SECOND,
};
use hrdsl_ta::{
    ExtrapolationAbstraction, GoalKind, GoalOutcome, ModelError, QueryOptions, QueryVerdict,
    ReachabilityGoal, SearchError, SearchOptions, SearchOrder, SubsumptionRelation, answer,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::{
    common::{asked::asked, eq, n, v},
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
    if graph.starts && graph.faults.is_empty() { asks(p, &graph) } else { Ok(None) }
}

/// Deadlocks and runs without end: every kind of query about the first formulas.
pub fn asks(p: &Program, graph: &Graph) -> Result<Option<String>, String> {
    let formulas = formulas(p);
    let [f, g, h, ..] = formulas.as_slice() else { return Ok(None) };
    let at = |automaton, l| QueryFormula::At { automaton, location: LocationId(l) };
    let left = QueryFormula::Not(Box::new(at(0, 0)));
    let asked = [
        (QueryKind::Possibly(QueryFormula::Deadlock), graph.possibly(&QueryFormula::Deadlock)?),
        (QueryKind::PotentiallyAlways(at(0, 0)), graph.always(&at(0, 0))?),
        (QueryKind::PotentiallyAlways(f.clone()), graph.always(f)?),
        (QueryKind::Eventually(left.clone()), graph.eventually(&left)?),
        (QueryKind::Eventually(g.clone()), graph.eventually(g)?),
        (QueryKind::LeadsTo(at(0, 1), at(0, 0)), graph.leads_to(&at(0, 1), &at(0, 0))?),
        (QueryKind::LeadsTo(g.clone(), h.clone()), graph.leads_to(g, h)?),
    ];
    for (ask, expected) in asked {
        let query = Query {
            name: "q".into(),
            title: String::new(),
            text: String::new(),
            network: NetworkId(0),
            ask,
            origin: Span::default(),
        };
        match answer(p, &p.networks[0], &query, &QueryOptions::default()) {
            Ok(a) if a.verdict == if expected { QueryVerdict::Holds } else { QueryVerdict::Fails } => {}
            other => return Ok(Some(format!("{:?} should be {expected}: {other:?}", query.ask))),
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
