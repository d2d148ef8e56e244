//! Loops for a process that is strong in a vector and would not take part: TChecker allows no guards on weak edges.
//!
//! A loop changes nothing but in one respect: who takes part from a committed location makes the transition one of those that
//! may happen while a location is committed. So a loop from there asks that another part of the vector is at an edge
//! from a committed location, too. TChecker's guards see variables only: a variable `P_at` says where that process is.

use std::collections::BTreeSet;

use hrdsl_ir::ta::LocationKind;

use super::{
    TcheckerWriter,
    edges::{EdgeInstance, EdgeSyncRole},
    value::GuardPart,
    vectors::SynchronizedEdges,
};
use crate::exchange::obstacle::ExportObstacle;

/// The most loops that stand in for one location's edges that are closed.
const MAX_LOOPS: usize = 256;

/// A vector, as one of its parts sees it that must be in it.
pub struct LoopedVector<'a> {
    /// The part's own event, and its edges.
    pub event: &'a str,
    pub part: &'a EdgeSyncRole,
    /// The other processes in it, with their edges.
    pub others: Vec<(usize, &'a EdgeSyncRole)>,
    /// No part must be there: somebody else has to take part.
    pub alone: bool,
}

impl TcheckerWriter<'_> {
    /// The process has committed locations.
    pub(super) fn commits(&self, p: usize) -> bool {
        self.automata[p].locations.iter().any(|l| l.kind == LocationKind::Committed)
    }

    /// Loops for a process that must be in a vector, where its own edges are closed.
    pub(super) fn loops(
        &mut self,
        p: usize,
        vector: &LoopedVector,
        instances: &[Vec<EdgeInstance>],
        joined: &mut SynchronizedEdges,
    ) {
        let automaton = self.automata[p];
        for (l, location) in automaton.locations.iter().enumerate() {
            let mine = instances[p].iter().filter(|i| i.part == *vector.part && i.from == l);
            let mut ways: Vec<Vec<GuardPart>> = vec![Vec::new()];
            for edge in mine {
                ways = ways.iter().flat_map(|way| closed(way, &edge.guard)).take(MAX_LOOPS + 1).collect();
            }
            let committed = location.kind == LocationKind::Committed;
            if committed || vector.alone {
                let reasons = self.reasons(vector, instances, committed);
                let joint = |way: &Vec<GuardPart>| {
                    let way = way.clone();
                    reasons.iter().map(move |reason| [way.as_slice(), reason.as_slice()].concat())
                };
                ways = ways.iter().flat_map(joint).take(MAX_LOOPS + 1).collect();
            }
            if ways.len() > MAX_LOOPS {
                let message = format!(
                    "`{}` may stay out of `{}` in `{}` for more than {MAX_LOOPS} reasons: ask less in its guards there",
                    automaton.name, vector.event, location.name
                );
                self.obstacles.push(ExportObstacle { message, origin: location.origin });
                return;
            }
            let loops = ways.into_iter().map(|guard| EdgeInstance {
                from: l,
                to: l,
                event: vector.event.to_owned(),
                guard,
                body: Vec::new(),
                part: vector.part.clone(),
            });
            joined.edges[p].extend(loops);
        }
    }

    /// The ways in which another part of a vector takes part, as guards; `committed`: from a committed location.
    fn reasons(
        &mut self,
        vector: &LoopedVector,
        instances: &[Vec<EdgeInstance>],
        committed: bool,
    ) -> BTreeSet<Vec<GuardPart>> {
        let mut reasons = BTreeSet::new();
        for (q, role) in &vector.others {
            for edge in instances[*q].iter().filter(|i| i.part == **role) {
                if committed && self.automata[*q].locations[edge.from].kind != LocationKind::Committed {
                    continue;
                }
                let mut reason = vec![GuardPart::of_integers(format!("{}=={}", self.tracked(*q), edge.from))];
                // Who sends is in the vector only with its guard.
                if !matches!(role, EdgeSyncRole::Announces(_)) {
                    reason.extend(edge.guard.iter().cloned());
                }
                reasons.insert(reason);
            }
        }
        reasons
    }

    /// The variable that says where a process is.
    fn tracked(&mut self, p: usize) -> String {
        if let Some(name) = self.tracked.get(&p) {
            return name.clone();
        }
        let name = self.names.fresh(&format!("{}_at", self.names.processes[p]));
        self.tracked.insert(p, name.clone());
        name
    }

    /// Keeps the variables that say where processes are.
    pub(super) fn track(&self, joined: &mut SynchronizedEdges) {
        for (p, name) in &self.tracked {
            for edge in joined.edges[*p].iter_mut().filter(|e| e.from != e.to) {
                edge.body.push(format!("{name}={}", edge.to));
            }
        }
    }
}

/// The ways in which a guard is false: the first part that is, all before it true. No guard is never false.
fn closed(way: &[GuardPart], guard: &[GuardPart]) -> Vec<Vec<GuardPart>> {
    let mut all = Vec::new();
    for (i, part) in guard.iter().enumerate() {
        for text in &part.closed {
            let last = GuardPart { text: text.clone(), closed: Vec::new() };
            all.push([way, &guard[..i], &[last]].concat());
        }
    }
    all
}
