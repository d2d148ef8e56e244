//! Suites.

use hrdsl_ir::{
    suite::{Choice, Condition, Method, ModelGoal, SearchGoal, Suite},
    value::nanos,
};
use hrdsl_model as model;

use super::{bdi::context, vocabulary::patterns};

pub(crate) fn suite(s: &model::Suite) -> Suite {
    Suite {
        name: s.name.clone(),
        method: method(&s.method),
        tests: s.tests,
        horizon: nanos(s.horizon),
        patience: nanos(s.patience),
        origin: s.span,
    }
}

fn method(m: &model::Method) -> Method {
    match m {
        model::Method::Agents { players, choose, explore, stop_after, goals, minimise } => Method::Agents {
            players: players.clone(),
            choose: choose.iter().map(choice).collect(),
            explore: *explore,
            stop_after: *stop_after,
            goals: goals.iter().map(|g| model_goal(*g)).collect(),
            minimise: *minimise,
        },
        model::Method::Search { network, goals, witness, delays } => Method::Search {
            network: network.0,
            goals: goals.iter().map(|g| goal(*g)).collect(),
            witness: *witness,
            delays: *delays,
        },
        model::Method::Random { stimuli, awaits, length, pause } => Method::Random {
            stimuli: stimuli.clone(),
            awaits: patterns(awaits),
            length_lo: length.0,
            length_hi: length.1,
            pause_lo: nanos(pause.0),
            pause_hi: nanos(pause.1),
        },
    }
}

fn choice(c: &model::Choice) -> Choice {
    let condition = c.condition.as_ref().map(|c| Condition {
        context: context(&c.context),
        vars: c.vars.clone(),
        origin: c.span,
    });
    Choice { agent: c.agent, belief: c.belief, how: c.how, condition }
}

fn model_goal(g: model::ModelGoal) -> ModelGoal {
    match g {
        model::ModelGoal::Bins(cross) => ModelGoal::Bins { cross: cross.0 },
        model::ModelGoal::Plans => ModelGoal::Plans,
        model::ModelGoal::Contexts => ModelGoal::Contexts,
        model::ModelGoal::Edges => ModelGoal::Edges,
        model::ModelGoal::Messages => ModelGoal::Messages,
        model::ModelGoal::Paths => ModelGoal::Paths,
    }
}

fn goal(g: model::SearchGoal) -> SearchGoal {
    match g {
        model::SearchGoal::Bins(cross) => SearchGoal::Bins { cross: cross.0 },
        model::SearchGoal::Locations => SearchGoal::Locations,
        model::SearchGoal::Edges => SearchGoal::Edges,
        model::SearchGoal::Pairs => SearchGoal::Pairs,
        model::SearchGoal::Uses => SearchGoal::Uses,
        model::SearchGoal::Violation(requirement) => SearchGoal::Violation { monitor: requirement.0 },
        model::SearchGoal::Trigger(requirement) => SearchGoal::Trigger { monitor: requirement.0 },
        model::SearchGoal::Query(query) => SearchGoal::Query { query: query.0 },
    }
}
