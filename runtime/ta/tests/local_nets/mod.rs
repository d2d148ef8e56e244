//! Random networks with every kind of synchronisation.

use hrdsl_ir::{
    EventId, Program,
    ta::{
        Automaton, AutomatonId, ChannelId, ChannelKind, ChannelParticipant, ClockId,
        ClockOp::{self, Ge, Gt, Le, Lt},
        Edge, EdgeAssignment, LocationId,
        LocationKind::{Committed, Normal, Urgent},
        TimeSum,
    },
    value::SECOND,
};

use super::common::{add, automaton, channel, clock, edge, eq, event, location, n, program, shared, v};

/// What a random edge is like.
#[derive(Clone, Debug)]
pub struct Draft {
    pub from: u16,
    pub to: u16,
    pub sync: u8,
    /// Clock, comparison, constant. Clock 0 is the shared one, seldom.
    pub guard: Option<(u16, u8, i64)>,
    /// Clock, the clock that it becomes, what is added.
    pub reset: Option<(u16, Option<u16>, i64)>,
    /// Asks the shared variable, then sets it.
    pub shared: (Option<i64>, Option<i64>),
}

/// What a random automaton is like: its clocks, its locations with kind and bound, its edges.
#[derive(Clone, Debug)]
pub struct Member {
    pub clocks: u16,
    pub locations: Vec<(u8, Option<(u16, i64)>)>,
    pub edges: Vec<Draft>,
}

/// A network of random automata: binary synchronisations 0 and 1, a broadcast channel, an event, a multi-way channel of the first three.
pub fn random(members: &[Member], optional: [bool; 3]) -> Program {
    let mut p = program();
    let shake = channel(&mut p, "shake", ChannelKind::Binary, &[(0, 1)]);
    let cast = channel(&mut p, "cast", ChannelKind::Broadcast, &[]);
    let here = members.len().min(3);
    let participants =
        (0..here).map(|i| ChannelParticipant { automaton: AutomatonId(i as u16), optional: optional[i] });
    let all = channel(&mut p, "all", ChannelKind::MultiWay(participants.collect()), &[]);
    let tell = event(&mut p, "tell", &[]);
    shared(&mut p, "s", 0, 2, 0);
    p.clocks.push("g".into());
    for (i, m) in members.iter().enumerate() {
        let names: Vec<String> = (0..m.clocks).map(|c| format!("x{c}")).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let mut a: Automaton = automaton(&format!("A{i}"), &names);
        for (l, (kind, bound)) in m.locations.iter().enumerate() {
            let kind = match kind {
                0 => Committed,
                1 => Urgent,
                2.. => Normal,
            };
            let bound = bound.filter(|_| m.clocks > 0).map(|(c, k)| clock(1 + c % m.clocks, Le, k));
            location(&mut a, &format!("l{l}"), kind, bound.as_slice());
        }
        for draft in &m.edges {
            a.edges.push(random_edge(draft, m, (tell, [shake, cast, all]), i < here));
        }
        add(&mut p, a);
    }
    p
}

fn random_edge(
    draft: &Draft,
    m: &Member,
    (tell, [shake, cast, all]): (EventId, [ChannelId; 3]),
    joins: bool,
) -> Edge {
    let at = |l: u16| LocationId(l % m.locations.len() as u16);
    let mut e = edge(at(draft.from), at(draft.to));
    e = match draft.sync {
        0 | 1 => e.offer(shake, &[n(i64::from(draft.sync))]),
        2 | 3 => e.accept(shake, &[i64::from(draft.sync) - 2]),
        4 if joins => e.join(all),
        5 => e.offer(cast, &[]),
        6 => e.accept(cast, &[]),
        7 => e.send(tell),
        8 => e.on(tell),
        4 | 9.. => e,
    };
    // The shared clock is 0; own ones follow.
    let named = |c: u16| if c == 0 || m.clocks == 0 { 0 } else { 1 + c % m.clocks };
    if let Some((c, op, k)) = draft.guard.filter(|g| g.0 == 0 || m.clocks > 0) {
        let op = [Lt, Le, ClockOp::Eq, Ge, Gt][usize::from(op) % 5];
        e = e.clock(named(c), op, k);
    }
    if let Some((c, from, by)) = draft.reset.filter(|r| r.0 == 0 || m.clocks > 0) {
        let (clock, from) = (ClockId(named(c)), from.map(|y| ClockId(named(y))));
        e.0.updates.push(EdgeAssignment::Reset { clock, from, to: TimeSum::constant(by * SECOND) });
    }
    if let Some(k) = draft.shared.0 {
        e = e.when(eq(v(0), n(k)));
    }
    if let Some(k) = draft.shared.1 {
        e = e.set(0, n(k));
    }
    e.0
}
