//! Just after a bound that an automaton cannot outstay: so long after it left.
//!
//! Two clocks are added: one that the edges which leave at the bound set to zero, and one that nothing sets. Where the first is a
//! step and the second is more, the edge was taken that long ago: without it, both are the time since the start.

use hrdsl_ir::{
    Nanos,
    ta::{ClockConstraint, ClockId, ClockOp, EdgeAssignment, QueryFormula, TimeSum},
};
use hrdsl_prove::ObservedNetwork;

use super::{possible, sites::BoundSite};
use crate::slots::NetworkNumbers;

/// A network with the two clocks, and what is asked of it.
pub struct JustAfter {
    pub observed: ObservedNetwork,
    pub question: QueryFormula,
}

/// `None`: the location is not left at the bound for certain.
pub fn just_after(observed: &ObservedNetwork, site: &BoundSite, step: Nanos) -> Option<JustAfter> {
    if site.leaving.is_empty() {
        return None;
    }
    let mut observed = observed.clone();
    let shared = observed.program.clocks.len();
    let id = observed.network.automata.get(usize::from(site.member))?;
    let automaton = observed.program.automata.get_mut(usize::from(id.0))?;
    let first = shared + automaton.clocks.len();
    let [left, start] = [first, first + 1].map(|clock| u16::try_from(clock).ok().map(ClockId));
    automaton.clocks.extend(["~left".to_owned(), "~start".to_owned()]);
    for edge in &site.leaving {
        automaton.edges.get_mut(*edge)?.updates.push(EdgeAssignment::zero(left?));
    }
    let numbers = NetworkNumbers::of(&observed.program, &observed.network);
    let is = |clock: Option<ClockId>, op| {
        let clock = numbers.clock(usize::from(site.member), clock?)?;
        let bound = TimeSum::constant(step);
        Some(QueryFormula::Clock(ClockConstraint { clock, minus: None, op, bound }))
    };
    let stimuli = super::sites::stimuli(&observed.program, &observed.network);
    let same = |s: &&super::StimulusEdge| {
        site.stimuli.iter().any(|known| (known.member, known.edge) == (s.member, s.edge))
    };
    let stimuli: Vec<_> = stimuli.iter().filter(same).cloned().collect();
    let question =
        QueryFormula::And(vec![is(left, ClockOp::Eq)?, is(start, ClockOp::Gt)?, possible(&stimuli)]);
    Some(JustAfter { observed, question })
}
