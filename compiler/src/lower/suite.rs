//! Suites.

use hrdsl_ir::{
    EventId,
    bdi::{AgentId, BeliefId},
    suite::{
        Choice, ChoiceKind, Condition, Delays, Explore, Method, ModelGoal, PlayerRef, SearchGoal, Suite,
        WitnessKind,
    },
    ta::AutomatonId,
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
            players: players.iter().map(|p| player(*p)).collect(),
            choose: choose.iter().map(choice).collect(),
            explore: match explore {
                model::Explore::Exhaustive => Explore::Exhaustive,
                model::Explore::Wise(t) => Explore::Wise(*t),
                model::Explore::Random => Explore::Random,
                model::Explore::Learn => Explore::Learn,
            },
            stop_after: *stop_after,
            goals: goals.iter().map(|g| model_goal(*g)).collect(),
            minimise: *minimise,
        },
        model::Method::Search { network, goals, witness, delays } => Method::Search {
            network: network.0,
            goals: goals.iter().map(|g| goal(*g)).collect(),
            witness: match witness {
                model::WitnessKind::Any => WitnessKind::Any,
                model::WitnessKind::Shortest => WitnessKind::Shortest,
                model::WitnessKind::Fastest => WitnessKind::Fastest,
            },
            delays: match delays {
                model::Delays::Earliest => Delays::Earliest,
                model::Delays::Latest => Delays::Latest,
                model::Delays::Sampled => Delays::Sampled,
            },
        },
        model::Method::Random { stimuli, awaits, length, pause } => Method::Random {
            stimuli: stimuli.iter().map(|e| EventId(e.0)).collect(),
            awaits: patterns(awaits),
            length_lo: length.0,
            length_hi: length.1,
            pause_lo: nanos(pause.0),
            pause_hi: nanos(pause.1),
        },
    }
}

fn player(p: model::Player) -> PlayerRef {
    match p {
        model::Player::Agent(a) => PlayerRef::Agent(AgentId(a.0)),
        model::Player::Automaton(a) => PlayerRef::Automaton(AutomatonId(a.0)),
    }
}

fn choice(c: &model::Choice) -> Choice {
    let how = match c.how {
        model::ChoiceKind::One => ChoiceKind::One,
        model::ChoiceKind::OnePer(param) => ChoiceKind::OnePer(param),
        model::ChoiceKind::Any => ChoiceKind::Any,
    };
    let condition = c.condition.as_ref().map(|c| Condition {
        context: context(&c.context),
        vars: c.vars.clone(),
        origin: c.span,
    });
    Choice { agent: AgentId(c.agent.0), belief: BeliefId(c.belief.0), how, condition }
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
