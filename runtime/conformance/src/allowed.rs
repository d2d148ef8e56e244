//! What a model allows after an observation: its events with their windows, and silence.

use std::collections::BTreeMap;

use hrdsl_ir::{Nanos, Program, value::seconds};
use hrdsl_results::{AllowedEvent, ModelPlace};
use hrdsl_trace::print;

use crate::{
    model::SystemModel,
    states::{PossibleState, range},
    walk::{ModelWalk, WalkFault},
};

/// What a model allows after an observation.
#[derive(Clone, Debug, Default)]
pub(crate) struct AllowedContinuations {
    /// By when they begin.
    pub events: Vec<AllowedEvent>,
    /// The last moment until which it can be silent; none: for longer than was asked.
    pub silent_until: Option<Nanos>,
    /// The states in which it is at that moment.
    pub last: Vec<PossibleState>,
}

/// A window of an event, in time since the observation, with the edges that send it.
struct EventWindow {
    from: i64,
    until: Option<i64>,
    edges: Vec<(usize, usize)>,
}

/// What a model in these states, in which it is from `since` on, allows for some time.
pub(crate) fn allowed(
    program: &Program,
    model: &SystemModel,
    walk: &mut ModelWalk,
    states: &[PossibleState],
    (since, time): (Nanos, i64),
) -> Result<AllowedContinuations, WalkFault> {
    let mut windows: BTreeMap<String, EventWindow> = BTreeMap::new();
    let reached = walk.silently(states, time, &mut |seen| {
        let text = print::event_text(program, seen.output.event, &seen.output.args);
        let until = seen.until.filter(|until| *until < time);
        let window = windows.entry(text).or_insert(EventWindow { from: seen.from, until, edges: Vec::new() });
        window.from = window.from.min(seen.from);
        window.until = window.until.zip(until).map(|(a, b)| a.max(b));
        if !window.edges.contains(&seen.output.edge) {
            window.edges.push(seen.output.edge);
        }
    })?;
    let ends = |state: &PossibleState| range(&state.zone, state.since(), 0).1.unwrap_or(time);
    let last = reached.iter().map(ends).max().unwrap_or(0);
    let event = |(event, window): (String, EventWindow)| AllowedEvent {
        event,
        from: seconds(since + window.from),
        until: window.until.map(|until| seconds(since + until)),
        edges: window.edges.iter().filter_map(|edge| edge_place(program, model, *edge)).collect(),
    };
    let mut events: Vec<AllowedEvent> = windows.into_iter().map(event).collect();
    events.sort_by(|a, b| a.from.total_cmp(&b.from));
    let at_last = reached.iter().filter(|state| ends(state) == last);
    Ok(AllowedContinuations {
        events,
        silent_until: (last < time).then_some(since + last),
        last: at_last.cloned().collect(),
    })
}

fn edge_place(program: &Program, model: &SystemModel, (member, edge): (usize, usize)) -> Option<ModelPlace> {
    let automaton = program.automaton(*model.network.automata.get(member)?);
    let edge = automaton.edges.get(edge)?;
    let (from, to) = (&automaton.location(edge.from).name, &automaton.location(edge.to).name);
    Some(ModelPlace::new(format!("{}: {from} -> {to}", automaton.name), edge.origin))
}

/// The locations of some states, each once.
pub(crate) fn locations(
    program: &Program,
    model: &SystemModel,
    walk: &ModelWalk,
    states: &[PossibleState],
) -> Vec<ModelPlace> {
    let mut all: Vec<ModelPlace> = Vec::new();
    for state in states {
        for (id, location) in model.network.automata.iter().zip(walk.locations(state)) {
            let automaton = program.automaton(*id);
            let Some(location) = automaton.locations.get(location) else { continue };
            let place = ModelPlace::new(format!("{}.{}", automaton.name, location.name), location.origin);
            if !all.contains(&place) {
                all.push(place);
            }
        }
    }
    all
}

/// The greatest time that the model speaks of: so far ahead it is asked what it allows.
pub(crate) fn farthest(program: &Program, model: &SystemModel) -> i64 {
    let automata = || model.network.automata.iter().map(|id| program.automaton(*id));
    let invariants = automata().flat_map(|a| &a.locations).flat_map(|l| &l.invariant);
    let guards = automata().flat_map(|a| &a.edges).flat_map(|e| &e.clock_guard);
    let bounds = invariants.chain(guards).map(|c| c.bound.nanos.abs());
    // Bounds with variables have parts that are not known here.
    bounds.max().unwrap_or(0).max(hrdsl_ir::value::SECOND).saturating_mul(2)
}
