//! Which numbers of a state matter: those that guards, invariants, what is sent, goals and histories read, and those from
//! which these are computed.
//!
//! A variable that nothing reads stays if an assignment to it may be a fault: a fault is an answer, too.

use crate::{
    network::{
        code::{CodeLibrary, CompiledLvalue, VariablePlace},
        model::CompiledNetwork,
        parts::{ClockConstraints, CompiledEdge, EdgeSync, EdgeUpdate, TimeExpr},
    },
    search::{goals::CompiledGoals, probe::StateProbe},
};

/// By place of the state whether it matters.
pub(crate) fn relevant(
    model: &CompiledNetwork,
    goals: &CompiledGoals,
    probe: Option<&dyn StateProbe>,
) -> Vec<bool> {
    let mut others = Vec::new();
    if let Some(probe) = probe {
        probe.each_place(model, &mut |i| others.push(i));
    }
    mattering(model, goals, &others, AssignmentFaults::All)
}

/// By place of the state whether it matters to what can happen, to the goals and to whoever asks for these places, and not only because
/// it may leave its range.
pub(crate) fn read(model: &CompiledNetwork, goals: &CompiledGoals, asked: &[u32]) -> Vec<bool> {
    mattering(model, goals, asked, AssignmentFaults::AllButRanges)
}

/// Which faults of an assignment make what it sets matter.
#[derive(Clone, Copy, PartialEq, Eq)]
enum AssignmentFaults {
    All,
    /// Not that the value is outside the range.
    AllButRanges,
}

fn mattering(
    model: &CompiledNetwork,
    goals: &CompiledGoals,
    others: &[u32],
    faults: AssignmentFaults,
) -> Vec<bool> {
    let mut matters = vec![true; model.size()];
    let first = model.slot_at(0);
    matters[first..first + model.slots.len()].fill(false);
    let lib = &model.library;
    let mut note = |i: u32| matters[i as usize] = true;
    goals.each_place(model, &mut note);
    others.iter().for_each(|i| note(*i));
    for member in &model.members {
        for spot in &member.locations {
            clocks(lib, &spot.invariant, &mut note);
            spot.holds.iter().for_each(|c| c.each_var(lib, &mut note));
        }
        for arrow in &member.edges {
            clocks(lib, &arrow.guard, &mut note);
            arrow.data.iter().for_each(|c| c.each_var(lib, &mut note));
            if let EdgeSync::Out(signal) = &arrow.sync {
                signal.args.iter().for_each(|a| a.code.each_var(lib, &mut note));
            }
        }
    }
    loop {
        let mut more = Vec::new();
        for arrow in model.members.iter().flat_map(|m| &m.edges) {
            updates(lib, arrow, &matters, faults, &mut |i| more.push(i));
        }
        let before = more.iter().filter(|i| !matters[**i as usize]).count();
        more.iter().for_each(|i| matters[*i as usize] = true);
        if before == 0 {
            return matters;
        }
    }
}

fn times(lib: &CodeLibrary, t: &TimeExpr, note: &mut dyn FnMut(u32)) {
    t.terms.iter().for_each(|t| t.1.each_var(lib, note));
}

fn clocks(lib: &CodeLibrary, clocks: &ClockConstraints, note: &mut dyn FnMut(u32)) {
    clocks.moving.iter().for_each(|m| times(lib, &m.time, note));
}

/// What the updates need that matter.
fn updates(
    lib: &CodeLibrary,
    arrow: &CompiledEdge,
    matters: &[bool],
    faults: AssignmentFaults,
    note: &mut dyn FnMut(u32),
) {
    let locals = arrow.locals(lib);
    for u in &arrow.updates {
        match u {
            // Setting a clock may make it negative.
            EdgeUpdate::Reset { to, .. } => times(lib, to, note),
            EdgeUpdate::Call(routine, args) => {
                // What a function does is not looked at closely: its faults matter.
                args.iter().for_each(|a| a.each_var(lib, note));
                lib.each_read(*routine, note);
                lib.each_written(*routine, note);
            }
            EdgeUpdate::Assign(place, value) => {
                let mut calls = false;
                value.each_call(&mut |_| calls = true);
                let span = value.span(lib, &locals);
                let may_fail = match faults {
                    AssignmentFaults::All => !safe(lib, place, span, &locals),
                    AssignmentFaults::AllButRanges => !has_value(lib, place, span.2, &locals),
                };
                let mut wanted = calls || may_fail;
                if calls {
                    value.each_call(&mut |r| lib.each_written(r, note));
                }
                place.targets(&mut |i| wanted |= matters[i as usize]);
                if wanted {
                    value.each_var(lib, note);
                    place.indices.iter().for_each(|i| i.0.each_var(lib, note));
                    place.targets(note);
                }
            }
        }
    }
}

/// Whether the assignment is never a fault.
fn safe(lib: &CodeLibrary, place: &CompiledLvalue, span: (i64, i64, bool), locals: &[(i64, i64)]) -> bool {
    has_value(lib, place, span.2, locals) && fits(lib, place, span)
}

/// Whether there always is a value, and something that takes it.
fn has_value(lib: &CodeLibrary, place: &CompiledLvalue, sure: bool, locals: &[(i64, i64)]) -> bool {
    sure && place.always_there(lib, locals) && matches!(place.base, VariablePlace::State(_))
}

/// Whether a value between these is in the range of whatever it may be assigned to.
pub(crate) fn fits(lib: &CodeLibrary, place: &CompiledLvalue, (lo, hi, _): (i64, i64, bool)) -> bool {
    let mut fits = true;
    place.targets(&mut |i| {
        let (least, most) = lib.ranges[i as usize];
        fits &= lo >= least && hi <= most;
    });
    fits
}
