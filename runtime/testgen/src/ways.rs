//! What else is asked of a network for `diverse N`: every edge, and every goal with and without each event on the way to it.
//!
//! A search notes a goal as soon as a successor meets it, and stores each state with the first path that leads there. So a way
//! of one step hides the way of two that leads to the same state, whatever the order is: it has to be asked for by name.

use std::collections::BTreeSet;

use hrdsl_ir::{
    ArgPattern, EventId, EventPattern, Program,
    suite::SearchGoal,
    ta::{Network, SyncLabel},
};
use hrdsl_prove::ProofOptions;
use hrdsl_ta::{EventCounter, GoalKind, ReachabilityGoal, StateFormula};

use crate::{
    expand::{counters, goals},
    named::NamedGoal,
};

/// The edges of the network, each a goal: the way into a location is one of them.
pub fn edges(program: &Program, network: &Network) -> Vec<NamedGoal> {
    goals(program, network, &[SearchGoal::Edges])
}

/// The goals of a suite that states meet, each twice: with an event before it, and without.
pub struct EventWays {
    /// The program's counters, and behind them one that tells whether the event has happened.
    pub counters: Vec<EventCounter>,
    /// The index of the suite's goal, what it is called with the event, and the question.
    pub asked: Vec<(usize, String, ReachabilityGoal)>,
}

impl EventWays {
    /// One for each event that an automaton of the network may send.
    pub fn of(program: &Program, network: &Network, named: &[NamedGoal]) -> Vec<Self> {
        sent(program, network).into_iter().map(|event| Self::with(program, event, named)).collect()
    }

    fn with(program: &Program, id: EventId, named: &[NamedGoal]) -> Self {
        let event = &program.events[usize::from(id.0)];
        let any = EventPattern { event: id, args: vec![ArgPattern::Any; event.params.len()] };
        let mut counters = counters(program);
        let counter = counters.len();
        counters.push(EventCounter { patterns: vec![any], cap: 1 });
        let happened = StateFormula::CounterIn { counter, lo: 1, hi: None };
        let not_yet = StateFormula::CounterIn { counter, lo: 0, hi: Some(0) };
        let mut asked = Vec::new();
        for (goal, named) in named.iter().enumerate() {
            for alternative in &named.alternatives {
                let Some(formula) = alternative.formula().filter(is_discrete) else { continue };
                for (how, condition) in [("with", &happened), ("without", &not_yet)] {
                    let what =
                        GoalKind::Condition(StateFormula::And(vec![formula.clone(), condition.clone()]));
                    let name = format!("{} {how} {}", named.id, event.name);
                    asked.push((goal, name, ReachabilityGoal { what, settled: alternative.settled }));
                }
            }
        }
        Self { counters, asked }
    }

    /// What each of these searches may store: the state is kept with and without the event, and what nothing can reach is not to
    /// cost a proof once more for each event.
    pub fn settings(settings: &ProofOptions, states: usize) -> ProofOptions {
        let mut settings = *settings;
        settings.budget.states = settings.budget.states.min(states.saturating_mul(4).saturating_add(1000));
        settings
    }
}

/// The events that automata of the network send, in the order of their declarations.
fn sent(program: &Program, network: &Network) -> BTreeSet<EventId> {
    let members = network.automata.iter().map(|id| program.automaton(*id));
    let edges = members.flat_map(|automaton| &automaton.edges);
    let event = |sync: &SyncLabel| if let SyncLabel::Send { event, .. } = sync { Some(*event) } else { None };
    edges.filter_map(|edge| event(&edge.sync)).collect()
}

/// Whether it speaks of no clock, so that a counter can be asked together with it.
fn is_discrete(formula: &StateFormula) -> bool {
    match formula {
        StateFormula::And(all) | StateFormula::Or(all) => all.iter().all(is_discrete),
        StateFormula::Not(a) => is_discrete(a),
        StateFormula::At { .. } | StateFormula::Data(_) | StateFormula::CounterIn { .. } => true,
        StateFormula::Clock(_) | StateFormula::Deadlock => false,
    }
}
