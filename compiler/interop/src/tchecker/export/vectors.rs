//! Synchronisation: binary synchronisations, broadcasts and multi-way channels as `sync` vectors.
//!
//! A broadcast's receivers are weak, so that it never waits for them. TChecker allows no guards on weak edges: a process
//! with guarded ones is strong, and gets a loop wherever it would not take part (`loops`).

use hrdsl_ir::ta::ChannelKind;

use super::{
    TcheckerWriter,
    edges::{EdgeInstance, EdgeSyncRole},
    loops::LoopedVector,
};

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
        // Who loops in a committed location has to know who sends: each sender has a vector with events of its own.
        let committed = |r: &usize| guarded(*r, instances, &hears) && self.commits(*r);
        let apart = senders.len() > 1 && receivers.iter().any(committed);
        for (n, s) in senders.iter().enumerate() {
            keep(*s, instances, &sends, &out, joined);
            let others: Vec<usize> = receivers.iter().copied().filter(|r| r != s).collect();
            let event = if apart && n > 0 { self.names.fresh(&format!("{name}_in")) } else { taken.clone() };
            let mut vector = format!("{}@{out}", self.names.processes[*s]);
            for r in &others {
                let weak = if guarded(*r, instances, &hears) { "" } else { "?" };
                vector += &format!(":{}@{event}{weak}", self.names.processes[*r]);
            }
            if !others.is_empty() {
                joined.syncs.push(vector);
            }
            for r in others {
                // Vectors with the same event have the same edges.
                if apart || n == 0 || (n == 1 && r == senders[0]) {
                    keep(r, instances, &hears, &event, joined);
                    if guarded(r, instances, &hears) {
                        let parts = receivers.iter().filter(|q| **q != r && *q != s).map(|q| (*q, &hears));
                        let parts = std::iter::once((*s, &sends)).chain(parts).collect();
                        let vector =
                            LoopedVector { event: &event, part: &hears, others: parts, alone: false };
                        self.loops(r, &vector, instances, joined);
                    }
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
        // Where nobody must take part, loops alone would be a transition of nobody.
        let nobody_must = taking.iter().all(|(_, optional)| *optional);
        for (p, optional) in &taking {
            keep(*p, instances, &part, &event, joined);
            let mut mark = "";
            if *optional && guarded(*p, instances, &part) {
                let others = taking.iter().filter(|(q, _)| q != p).map(|(q, _)| (*q, &part)).collect();
                let vector = LoopedVector { event: &event, part: &part, others, alone: nobody_must };
                self.loops(*p, &vector, instances, joined);
            } else if *optional {
                mark = "?";
            }
            vector.push(format!("{}@{event}{mark}", self.names.processes[*p]));
        }
        if vector.len() > 1 {
            joined.syncs.push(vector.join(":"));
        }
    }
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
