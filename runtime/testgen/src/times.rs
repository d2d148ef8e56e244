//! The times that a scenario speaks of: what its requirements and automata compare clocks with.

use std::collections::BTreeSet;

use hrdsl_ir::{Nanos, Program, monitor::MonitorClockGuard};

use crate::named::is_generated;

/// All of them that no variable has a part in, without zero.
pub fn of(program: &Program) -> BTreeSet<Nanos> {
    let guards = |edge: &hrdsl_ir::ta::Edge| edge.clock_guard.clone();
    let mut times: BTreeSet<Nanos> = BTreeSet::new();
    for automaton in &program.automata {
        let written = automaton.locations.iter().filter(|l| !is_generated(&l.name));
        let invariants = written.flat_map(|l| l.invariant.clone());
        let all = invariants.chain(automaton.edges.iter().flat_map(guards));
        times.extend(all.filter(|c| c.minus.is_none()).filter_map(|c| c.bound.fixed()));
    }
    for monitor in &program.monitors {
        times.extend(monitor.states.iter().filter_map(|state| state.deadline));
        times.extend(monitor.edges.iter().filter_map(|edge| edge.clock).map(|guard| match guard {
            MonitorClockGuard::Before(time) | MonitorClockGuard::After(time) => time,
        }));
    }
    times.remove(&0);
    times
}
