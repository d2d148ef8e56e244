//! Asks the engine for goals and queries of the first network.

use super::clock;
use hrdsl_ir::{
    Program, Span,
    ta::{ClockOp, LocationId, NetworkId, Query, QueryFormula, QueryKind},
};
use hrdsl_ta::{
    CompiledNetwork, GoalKind, ObservationOptions, QueryAnswer, QueryOptions, ReachabilityGoal, SearchError,
    SearchOptions, SearchReport, answer, explore,
};

pub fn asked(
    p: &Program,
    goals: &[ReachabilityGoal],
    options: &SearchOptions,
) -> Result<SearchReport, SearchError> {
    let formulas = goals.iter().filter_map(|g| match &g.what {
        GoalKind::Formula(f) => Some(f.clone()),
        GoalKind::Location { .. }
        | GoalKind::Edge { .. }
        | GoalKind::Pair { .. }
        | GoalKind::Use { .. }
        | GoalKind::Condition(_) => None,
    });
    let observe = ObservationOptions { formulas: formulas.collect(), ..ObservationOptions::default() };
    let model = CompiledNetwork::new(p, &p.networks[0], &observe)?;
    explore(&model, goals, options, &|_| true)
}

pub fn query(ask: QueryKind) -> Query {
    Query {
        name: "q".into(),
        title: "q".into(),
        text: String::new(),
        network: NetworkId(0),
        ask,
        origin: Span::default(),
    }
}

pub fn ask_with(p: &Program, ask: QueryKind, options: &QueryOptions) -> QueryAnswer {
    answer(p, &p.networks[0], &query(ask), options).unwrap()
}

pub fn ask(p: &Program, ask: QueryKind) -> QueryAnswer {
    ask_with(p, ask, &QueryOptions::default())
}

pub fn at(automaton: u16, l: LocationId) -> QueryFormula {
    QueryFormula::At { automaton, location: l }
}

pub fn x(c: u16, op: ClockOp, s: i64) -> QueryFormula {
    QueryFormula::Clock(clock(c, op, s))
}

pub fn model(p: &Program) -> CompiledNetwork<'_> {
    CompiledNetwork::new(p, &p.networks[0], &ObservationOptions::default()).unwrap()
}
