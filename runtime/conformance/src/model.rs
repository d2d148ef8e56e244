//! Which automata model the system, and what of them a trace shows.

use std::collections::BTreeSet;

use hrdsl_ir::{
    ActorId, EventId, Nanos, Program, Role, Span,
    ta::{AutomatonId, Network},
};

use crate::sharing::SharedUse;

/// Automata that play the system's actor together: those of a network, or one that is in none.
#[derive(Clone, Debug, PartialEq)]
pub struct SystemModel {
    /// Their names, joined by ` | `.
    pub name: String,
    pub network: Network,
    /// The events that its edges send; what else the actor makes, the model does not speak of.
    pub outputs: BTreeSet<EventId>,
    /// The events that its edges take from others.
    pub inputs: BTreeSet<EventId>,
    /// Why no trace can show what it does.
    pub obstacle: Option<String>,
}

/// The models of the actors that systems play, or of all actors of the system if no system is declared.
#[must_use]
pub fn system_models(program: &Program) -> Vec<SystemModel> {
    let mut actors: Vec<ActorId> = program.systems.iter().map(|s| s.actor).collect();
    if actors.is_empty() {
        actors.extend(program.actors_of(Role::System));
    }
    actors.sort_unstable();
    actors.dedup();
    let mut models: Vec<SystemModel> = Vec::new();
    for actor in actors {
        let plays = |id: &AutomatonId| program.automaton(*id).actor == Some(actor);
        for network in &program.networks {
            let players: Vec<AutomatonId> = network.automata.iter().copied().filter(plays).collect();
            add(program, &players, &network.automata, &mut models);
        }
        let in_a_network = |id: &AutomatonId| program.networks.iter().any(|n| n.automata.contains(id));
        let count = u16::try_from(program.automata.len()).unwrap_or(u16::MAX);
        for id in (0..count).map(AutomatonId).filter(|id| plays(id) && !in_a_network(id)) {
            add(program, &[id], &[id], &mut models);
        }
    }
    models
}

/// When a system that plays a model's actor is stopped, at the earliest: until then, one at rest stays so.
#[must_use]
pub(crate) fn limit(program: &Program) -> Option<Nanos> {
    program.systems.iter().map(|s| s.limit).min()
}

fn add(program: &Program, players: &[AutomatonId], around: &[AutomatonId], models: &mut Vec<SystemModel>) {
    if players.is_empty() {
        return;
    }
    let automata = with_helpers(program, players, around);
    if models.iter().any(|m| m.network.automata == automata) {
        return;
    }
    let names: Vec<&str> = automata.iter().map(|id| program.automaton(*id).name.as_str()).collect();
    let name = names.join(" | ");
    let edges = || automata.iter().flat_map(|id| &program.automaton(*id).edges);
    let outputs: BTreeSet<EventId> = edges().filter_map(|e| e.sync.as_send()).map(|s| s.0).collect();
    let taken = edges().filter_map(|e| e.sync.as_receive()).map(|t| t.0);
    let inputs = taken.filter(|event| !outputs.contains(event)).collect();
    let obstacle = obstacle(program, &automata, around);
    let network = Network { name: name.clone(), automata, origin: Span::default() };
    models.push(SystemModel { name, network, outputs, inputs, obstacle });
}

/// The players, and the automata without an actor with which they share channels or variables, in the network's order.
fn with_helpers(program: &Program, players: &[AutomatonId], around: &[AutomatonId]) -> Vec<AutomatonId> {
    let mut all: BTreeSet<AutomatonId> = players.iter().copied().collect();
    loop {
        let used = SharedUse::of(program, all.iter().copied());
        let helps = |id: &&AutomatonId| {
            program.automaton(**id).actor.is_none()
                && !all.contains(id)
                && used.meets(&SharedUse::of(program, [**id])).is_some()
        };
        let Some(helper) = around.iter().find(helps) else { break };
        all.insert(*helper);
    }
    around.iter().copied().filter(|id| all.contains(id)).collect()
}

/// What the automata have in common with those of other actors: it is in no trace.
fn obstacle(program: &Program, automata: &[AutomatonId], around: &[AutomatonId]) -> Option<String> {
    let used = SharedUse::of(program, automata.iter().copied());
    around.iter().filter(|id| !automata.contains(id)).find_map(|other| {
        let what = used.depends_on(&SharedUse::of(program, [*other]))?.name(program);
        let other = &program.automaton(*other).name;
        Some(format!("it shares {what} with `{other}`, and no trace shows what that does to it"))
    })
}
