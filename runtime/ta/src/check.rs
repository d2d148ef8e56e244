//! Checks that an automaton is well formed, so that engines can index without looking.

use hrdsl_ir::{
    Program,
    ta::{Automaton, AutomatonId, ChannelId, ChannelKind, ClockConstraint, ClockId, Sync, Update, Var},
};

use crate::ModelError;

/// The automaton of this id, if all its indices are within bounds.
///
/// # Errors
/// `Malformed` says what is not.
pub(crate) fn automaton(program: &Program, id: AutomatonId) -> Result<&Automaton, ModelError> {
    let Some(automaton) = program.automata.get(usize::from(id.0)) else {
        return Err(ModelError::Malformed { automaton: format!("#{}", id.0), what: "does not exist".into() });
    };
    match fault(program, id, automaton) {
        None => Ok(automaton),
        Some(what) => Err(ModelError::Malformed { automaton: automaton.name.clone(), what }),
    }
}

fn fault(program: &Program, id: AutomatonId, a: &Automaton) -> Option<String> {
    let locations = a.locations.len();
    let known = |l: hrdsl_ir::ta::LocationId| usize::from(l.0) < locations;
    if !known(a.initial) {
        return Some("no initial location".into());
    }
    if let Some(v) = program.shared.iter().chain(&a.vars).find(|v| !range_is_sound(v)) {
        return Some(format!("the range of `{}` does not hold its initial value", v.name));
    }
    let selects = a.edges.iter().flat_map(|e| &e.selects);
    if let Some(v) = program.shared.iter().chain(&a.vars).chain(selects).find(|v| !range_has_values(v)) {
        return Some(format!("the range of `{}` is not that of its enumeration", v.name));
    }
    if a.locations.iter().any(|l| l.invariant.iter().any(|c| !clocks_exist(program, a, c))) {
        return Some("an invariant has an unknown clock".into());
    }
    for (i, e) in a.edges.iter().enumerate() {
        if !known(e.from) || !known(e.to) {
            return Some(format!("edge {i} has an unknown location"));
        }
        if e.clock_guard.iter().any(|c| !clocks_exist(program, a, c)) {
            return Some(format!("edge {i} has an unknown clock"));
        }
        if !updates_exist(program, a, &e.updates) {
            return Some(format!("edge {i} updates an unknown variable or clock"));
        }
        if !sync_exists(program, id, &e.sync) {
            return Some(format!("edge {i} has an unknown event or channel, or a wrong number of arguments"));
        }
    }
    None
}

fn range_is_sound(v: &Var) -> bool {
    v.lo <= v.init && v.init <= v.hi
}

/// Whether the range is that of the enumeration's indices, if there is one: then no symbol can leave it.
fn range_has_values(v: &Var) -> bool {
    v.enumeration.is_none_or(|e| v.lo == 0 && i64::try_from(e.values().len()) == Ok(v.hi.saturating_add(1)))
}

fn clock_exists(program: &Program, a: &Automaton, clock: ClockId) -> bool {
    usize::from(clock.0) < program.clocks.len() + a.clocks.len()
}

fn clocks_exist(program: &Program, a: &Automaton, c: &ClockConstraint) -> bool {
    clock_exists(program, a, c.clock) && c.minus.is_none_or(|m| clock_exists(program, a, m))
}

fn updates_exist(program: &Program, a: &Automaton, updates: &[Update]) -> bool {
    updates.iter().all(|u| match u {
        Update::Assign { place, .. } => usize::from(place.slot) < program.shared.len() + a.vars.len(),
        Update::Reset { clock, from, .. } => {
            clock_exists(program, a, *clock) && from.is_none_or(|y| clock_exists(program, a, y))
        }
        Update::Call { function, args } => {
            let known = program.functions.get(usize::from(function.0));
            known.is_some_and(|f| f.params.len() == args.len())
        }
    })
}

fn sync_exists(program: &Program, id: AutomatonId, sync: &Sync) -> bool {
    let arity = |event: &hrdsl_ir::EventId| program.events.get(usize::from(event.0)).map(|e| e.params.len());
    let channel = |c: &ChannelId| program.channels.get(usize::from(c.0));
    let carries = |c: &ChannelId, args: usize| {
        let alone = |c: &hrdsl_ir::ta::Channel| match c.kind {
            ChannelKind::HandShake | ChannelKind::Broadcast => c.params.len() == args,
            ChannelKind::Joint(_) => false,
        };
        channel(c).is_some_and(alone)
    };
    match sync {
        Sync::Internal => true,
        Sync::Send { event, args } => arity(event) == Some(args.len()),
        Sync::Receive { event, args } => arity(event) == Some(args.len()),
        Sync::Offer { channel, args } => carries(channel, args.len()),
        Sync::Accept { channel, args } => carries(channel, args.len()),
        Sync::Join { channel: c } => channel(c).is_some_and(|c| match &c.kind {
            ChannelKind::Joint(parties) => parties.iter().any(|p| p.automaton == id),
            ChannelKind::HandShake | ChannelKind::Broadcast => false,
        }),
    }
}
