//! Synchronisation: binary synchronisations, broadcasts and multi-way channels as `sync` vectors.
//!
//! A broadcast's receivers are weak, so that it never waits for them. TChecker allows no guards on weak edges: a process
//! with guarded ones is strong, and gets a loop wherever it would not take part. The loop changes nothing, unless the
//! process is in a committed location, which is refused.

use hrdsl_ir::ta::{ChannelKind, LocationKind};

use super::{
    TcheckerWriter,
    edges::{EdgeInstance, EdgeSyncRole},
};
use crate::exchange::obstacle::ExportObstacle;

/// The most loops that stand in for one location's edges that are closed.
const MAX_LOOPS: usize = 256;

/// What is to be written.
pub struct SynchronizedEdges {
    /// By process, with their events.
    pub edges: Vec<Vec<EdgeInstance>>,
    /// `P@a:Q@b?`
    pub syncs: Vec<String>,
}

impl TcheckerWriter<'_> {
    pub(super) fn vectors(&mut self, instances: &[Vec<EdgeInstance>]) -> SynchronizedEdges {
        let mut joined = SynchronizedEdges { edges: vec![Vec::new(); instances.len()], syncs: Vec::new() };
        let mut parts: Vec<&EdgeSyncRole> = instances.iter().flatten().map(|i| &i.part).collect();
        parts.sort();
        parts.dedup();
        for part in parts {
            match part {
                EdgeSyncRole::Alone => self.alone(instances, &mut joined),
                EdgeSyncRole::Offers(name) => self.binary(name, instances, &mut joined),
                EdgeSyncRole::Announces(name) => self.broadcast(name, instances, &mut joined),
                EdgeSyncRole::Joins(channel) => self.multi_way(*channel, instances, &mut joined),
                // With what they take.
                EdgeSyncRole::Accepts(_) | EdgeSyncRole::Hears(_) => {}
            }
        }
        joined
    }

    fn alone(&mut self, instances: &[Vec<EdgeInstance>], joined: &mut SynchronizedEdges) {
        let event = self.names.fresh("tau");
        for p in 0..instances.len() {
            keep(p, instances, &EdgeSyncRole::Alone, &event, joined);
        }
    }

    fn binary(&mut self, name: &str, instances: &[Vec<EdgeInstance>], joined: &mut SynchronizedEdges) {
        let (offers, accepts) =
            (EdgeSyncRole::Offers(name.to_owned()), EdgeSyncRole::Accepts(name.to_owned()));
        let (senders, receivers) = (with(instances, &offers), with(instances, &accepts));
        let (out, taken) = (self.names.fresh(name), self.names.fresh(&format!("{name}_in")));
        let pairs: Vec<(usize, usize)> =
            senders.iter().flat_map(|s| receivers.iter().map(|r| (*s, *r))).filter(|(s, r)| s != r).collect();
        // An edge without a partner would be a step of its own.
        for p in 0..instances.len() {
            if pairs.iter().any(|(s, _)| *s == p) {
                keep(p, instances, &offers, &out, joined);
            }
            if pairs.iter().any(|(_, r)| *r == p) {
                keep(p, instances, &accepts, &taken, joined);
            }
        }
        for (s, r) in pairs {
            joined
                .syncs
                .push(format!("{}@{out}:{}@{taken}", self.names.processes[s], self.names.processes[r]));
        }
    }

    fn broadcast(&mut self, name: &str, instances: &[Vec<EdgeInstance>], joined: &mut SynchronizedEdges) {
        let (sends, hears) = (EdgeSyncRole::Announces(name.to_owned()), EdgeSyncRole::Hears(name.to_owned()));
        let (senders, receivers) = (with(instances, &sends), with(instances, &hears));
        let (out, taken) = (self.names.fresh(name), self.names.fresh(&format!("{name}_in")));
        for s in &senders {
            keep(*s, instances, &sends, &out, joined);
            let others: Vec<usize> = receivers.iter().copied().filter(|r| r != s).collect();
            let mut vector = format!("{}@{out}", self.names.processes[*s]);
            for r in &others {
                let weak = if guarded(*r, instances, &hears) { "" } else { "?" };
                vector += &format!(":{}@{taken}{weak}", self.names.processes[*r]);
            }
            if !others.is_empty() {
                joined.syncs.push(vector);
            }
        }
        for r in receivers {
            if senders.iter().any(|s| *s != r) {
                keep(r, instances, &hears, &taken, joined);
                if guarded(r, instances, &hears) {
                    self.loops(r, instances, &hears, &taken, joined);
                }
            }
        }
    }

    fn multi_way(&mut self, channel: usize, instances: &[Vec<EdgeInstance>], joined: &mut SynchronizedEdges) {
        let channel_name = self.program.channels[channel].name.clone();
        let ChannelKind::MultiWay(participants) = &self.program.channels[channel].kind else { return };
        let part = EdgeSyncRole::Joins(channel);
        let at = |participant: &hrdsl_ir::ta::ChannelParticipant| {
            self.network.automata.iter().position(|a| *a == participant.automaton)
        };
        let present: Vec<(usize, bool)> = participants
            .iter()
            .filter_map(|participant| Some((at(participant)?, participant.optional)))
            .collect();
        let has = |p: usize| instances[p].iter().any(|i| i.part == part);
        if present.iter().any(|(p, optional)| !optional && !has(*p)) {
            return;
        }
        let taking: Vec<(usize, bool)> = present.into_iter().filter(|(p, _)| has(*p)).collect();
        let event = self.names.fresh(&channel_name);
        let mut vector = Vec::new();
        for (p, optional) in &taking {
            keep(*p, instances, &part, &event, joined);
            let mut mark = "";
            if *optional && guarded(*p, instances, &part) {
                if taking.iter().all(|(_, optional)| *optional) {
                    let message = format!("all parts of `{channel_name}` are optional, and some have guards");
                    let origin = self.program.channels[channel].origin;
                    self.obstacles.push(ExportObstacle { message, origin });
                }
                self.loops(*p, instances, &part, &event, joined);
            } else if *optional {
                mark = "?";
            }
            vector.push(format!("{}@{event}{mark}", self.names.processes[*p]));
        }
        if vector.len() > 1 {
            joined.syncs.push(vector.join(":"));
        }
    }

    /// Loops for a process that must take part, where its own edges are closed.
    fn loops(
        &mut self,
        p: usize,
        instances: &[Vec<EdgeInstance>],
        part: &EdgeSyncRole,
        event: &str,
        joined: &mut SynchronizedEdges,
    ) {
        let automaton = self.automata[p];
        for (l, location) in automaton.locations.iter().enumerate() {
            if location.kind == LocationKind::Committed {
                let message = format!(
                    "`{}` hears `{event}` under a guard, and its location `{}` is committed: TChecker's weak edges have no guards",
                    automaton.name, location.name
                );
                self.obstacles.push(ExportObstacle { message, origin: location.origin });
                return;
            }
            let mine = instances[p].iter().filter(|i| i.part == *part && i.from == l);
            let mut ways: Vec<Vec<String>> = vec![Vec::new()];
            for edge in mine {
                ways = ways.iter().flat_map(|way| closed(way, &edge.guard)).take(MAX_LOOPS + 1).collect();
            }
            if ways.len() > MAX_LOOPS {
                let message = format!("`{event}` has too many guards in `{}`", location.name);
                self.obstacles.push(ExportObstacle { message, origin: location.origin });
                return;
            }
            let loops = ways.into_iter().map(|guard| EdgeInstance {
                from: l,
                to: l,
                event: event.to_owned(),
                guard,
                body: Vec::new(),
                part: part.clone(),
            });
            joined.edges[p].extend(loops);
        }
    }
}

/// The ways in which a guard is false: the first part that is, all before it true. No guard is never false.
fn closed(way: &[String], guard: &[String]) -> Vec<Vec<String>> {
    let one = |i: usize| {
        let mut all = way.to_vec();
        all.extend_from_slice(&guard[..i]);
        all.push(format!("!({})", guard[i]));
        all
    };
    (0..guard.len()).map(one).collect()
}

fn with(instances: &[Vec<EdgeInstance>], part: &EdgeSyncRole) -> Vec<usize> {
    (0..instances.len()).filter(|p| instances[*p].iter().any(|i| i.part == *part)).collect()
}

fn guarded(p: usize, instances: &[Vec<EdgeInstance>], part: &EdgeSyncRole) -> bool {
    instances[p].iter().any(|i| i.part == *part && !i.guard.is_empty())
}

fn keep(
    p: usize,
    instances: &[Vec<EdgeInstance>],
    part: &EdgeSyncRole,
    event: &str,
    joined: &mut SynchronizedEdges,
) {
    let mine = instances[p].iter().filter(|i| i.part == *part);
    joined.edges[p].extend(mine.map(|i| EdgeInstance { event: event.to_owned(), ..i.clone() }));
}
