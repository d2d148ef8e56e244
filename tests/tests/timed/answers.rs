//! The answers to a query: by clock regions, and by the search.

use hrdsl_ir::{
    Program,
    ta::{Query, QueryFormula, QueryKind},
    value::SECOND,
};

use hrdsl_ta::{QueryOptions, QueryVerdict, SearchError, answer};

use crate::oracle::{Limits, explore};

/// `holds`, `fails`, `fault`, or why there is no answer.
pub fn by_regions(p: &Program, query: &Query) -> String {
    let mut limits = Limits { states: 100_000, bound: 10, differences: false };
    each_clock(&query.ask, &mut |c| {
        limits.bound = limits.bound.max(c.bound.nanos.abs() / SECOND);
        limits.differences |= c.minus.is_some();
    });
    let graph = match explore(p, &p.networks[usize::from(query.network.0)], limits) {
        Ok(graph) => graph,
        Err(why) => return why,
    };
    if !graph.starts || !graph.faults.is_empty() {
        return "fault".to_owned();
    }
    let answer = match &query.ask {
        QueryKind::Possibly(f) => graph.possibly(f),
        QueryKind::Invariantly(f) => graph.possibly(&QueryFormula::Not(Box::new(f.clone()))).map(|b| !b),
        QueryKind::PotentiallyAlways(f) => graph.always(f),
        QueryKind::Eventually(f) => graph.eventually(f),
        QueryKind::LeadsTo(f, g) => graph.leads_to(f, g),
        QueryKind::Sup { .. } | QueryKind::Inf { .. } => Err("no answer to this here".to_owned()),
    };
    match answer {
        Ok(true) => "holds".to_owned(),
        Ok(false) => "fails".to_owned(),
        Err(why) => why,
    }
}

/// The same, by the search.
pub fn by_search(p: &Program, query: &Query) -> String {
    match answer(p, &p.networks[usize::from(query.network.0)], query, &QueryOptions::default()) {
        Ok(found) => match found.verdict {
            QueryVerdict::Holds => "holds".to_owned(),
            QueryVerdict::Fails => "fails".to_owned(),
            QueryVerdict::Inconclusive => "inconclusive".to_owned(),
        },
        Err(SearchError::Model { .. }) => "fault".to_owned(),
        Err(SearchError::Internal(why)) => why,
    }
}

fn each_clock(ask: &QueryKind, f: &mut dyn FnMut(&hrdsl_ir::ta::ClockConstraint)) {
    match ask {
        QueryKind::Possibly(a)
        | QueryKind::Invariantly(a)
        | QueryKind::PotentiallyAlways(a)
        | QueryKind::Eventually(a) => clocks(a, f),
        QueryKind::LeadsTo(a, b) => {
            clocks(a, f);
            clocks(b, f);
        }
        QueryKind::Sup { when, .. } | QueryKind::Inf { when, .. } => clocks(when, f),
    }
}

fn clocks(formula: &QueryFormula, f: &mut dyn FnMut(&hrdsl_ir::ta::ClockConstraint)) {
    match formula {
        QueryFormula::Clock(c) => f(c),
        QueryFormula::Not(a) => clocks(a, f),
        QueryFormula::And(all) | QueryFormula::Or(all) => all.iter().for_each(|a| clocks(a, f)),
        QueryFormula::At { .. } | QueryFormula::Data(_) | QueryFormula::Deadlock => {}
    }
}
