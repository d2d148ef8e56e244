//! Networks with hand-shakes and joint channels.

use hrdsl_ir::{
    ArgPattern, EventId, Expr, Program, Span, Value,
    expr::{BinaryOp, Index, Place},
    ta::{
        Automaton, AutomatonId, Channel, ChannelId, ChannelKind,
        ClockOp::{self, Ge, Gt, Le, Lt},
        Edge,
        LocationKind::{Committed, Normal},
        Party, ReceiveArg, Sync, Update,
    },
};

use super::common::{E, add, automaton, bin, clock, edge, eq, event, location, n, normal, program, v, var};

pub fn channel(p: &mut Program, name: &str, kind: ChannelKind, params: &[(i64, i64)]) -> ChannelId {
    let params = params.iter().map(|&(lo, hi)| var("n", lo, hi, lo)).collect();
    p.channels.push(Channel { name: name.into(), kind, urgent: false, params, origin: Span::default() });
    ChannelId(p.channels.len() as u16 - 1)
}

pub fn hand_shake(p: &mut Program, name: &str, most: i64) -> ChannelId {
    channel(p, name, ChannelKind::HandShake, &[(0, most)])
}

/// The edge offers `channel(args)`.
pub fn offer(mut e: E, channel: ChannelId, args: &[Expr]) -> E {
    e.0.sync = Sync::Offer { channel, args: args.to_vec() };
    e
}

/// The edge accepts `channel(arg)`.
pub fn accept(mut e: E, channel: ChannelId, arg: i64) -> E {
    let args = vec![ReceiveArg::Match(ArgPattern::Is(Value::Int(arg)))];
    e.0.sync = Sync::Accept { channel, args };
    e
}

/// The edge accepts `channel`, whatever its argument is: it binds it.
pub fn accept_any(mut e: E, channel: ChannelId) -> E {
    e.0.sync = Sync::Accept { channel, args: vec![ReceiveArg::Bind] };
    e
}

pub fn join(mut e: E, channel: ChannelId) -> E {
    e.0.sync = Sync::Join { channel };
    e
}

/// Dining philosophers: time-out 3, eat 10, slow 0.
pub fn philosophers(count: i64) -> Program {
    let mut p = program();
    let take = hand_shake(&mut p, "take", count - 1);
    let release = hand_shake(&mut p, "release", count - 1);
    for k in 0..count {
        let mut f = automaton(&format!("Fork{k}"), &[]);
        let (free, taken) = (normal(&mut f, "free"), normal(&mut f, "taken"));
        accept(edge(free, taken), take, k).to(&mut f);
        accept(edge(taken, free), release, k).to(&mut f);
        add(&mut p, f);
    }
    for i in 0..count {
        let (left, right) = ([n((i + count - 1) % count)], [n(i)]);
        let mut a = automaton(&format!("Phil{i}"), &["x"]);
        let idle = normal(&mut a, "idle");
        let acq = location(&mut a, "acq", Normal, &[clock(0, Le, 3)]);
        let eat = location(&mut a, "eat", Normal, &[clock(0, Le, 10)]);
        let rel = location(&mut a, "rel", Normal, &[clock(0, Le, 0)]);
        offer(edge(idle, acq), take, &left).reset(0).to(&mut a);
        offer(edge(acq, idle), release, &left).clock(0, Ge, 3).to(&mut a);
        offer(edge(acq, eat), take, &right).clock(0, Le, 3).reset(0).to(&mut a);
        offer(edge(eat, rel), release, &right).clock(0, Ge, 10).reset(0).to(&mut a);
        offer(edge(rel, idle), release, &left).to(&mut a);
        add(&mut p, a);
    }
    p
}

/// All go on at once, within a second of the last.
pub fn parallel(count: u16) -> Program {
    let mut p = program();
    let parties = (0..count).map(|i| Party { automaton: AutomatonId(i), optional: false }).collect();
    let go = channel(&mut p, "go", ChannelKind::Joint(parties), &[]);
    for i in 0..count {
        let mut a = automaton(&format!("P{i}"), &["x"]);
        let (start, wait, done) = (normal(&mut a, "A"), normal(&mut a, "B"), normal(&mut a, "C"));
        edge(start, wait).reset(0).to(&mut a);
        join(edge(wait, done), go).clock(0, Le, 1).to(&mut a);
        add(&mut p, a);
    }
    p
}

/// FDDI, TTRT = 50 N, SA = 20, TD = 0.
pub fn fddi(count: i64) -> Program {
    let mut p = program();
    let tt = hand_shake(&mut p, "TT", count - 1);
    let rt = hand_shake(&mut p, "RT", count - 1);
    let mut ring = automaton("Ring", &["r"]);
    let here: Vec<_> = (0..count)
        .map(|i| {
            let q = location(&mut ring, &format!("q{i}"), Normal, &[clock(0, Le, 0)]);
            (q, normal(&mut ring, &format!("r{i}")))
        })
        .collect();
    for i in 0..count as usize {
        let next = here[(i + 1) % here.len()].0;
        let give = offer(edge(here[i].0, here[i].1), tt, &[n(i as i64)]);
        give.clock(0, ClockOp::Eq, 0).to(&mut ring);
        accept(edge(here[i].1, next), rt, i as i64).reset(0).to(&mut ring);
    }
    add(&mut p, ring);
    let ttrt = 50 * count;
    for i in 0..count {
        let mut s = automaton(&format!("S{i}"), &["t", "a", "b"]);
        let (t, a, b) = (0, 1, 2);
        let short = [clock(t, Le, 20)];
        let q0 = normal(&mut s, "q0");
        let q1 = location(&mut s, "q1", Normal, &short);
        let q2 = location(&mut s, "q2", Normal, &short);
        let q3 = location(&mut s, "q3", Normal, &[clock(a, Le, ttrt + 20)]);
        let q4 = normal(&mut s, "q4");
        let q5 = location(&mut s, "q5", Normal, &short);
        let q6 = location(&mut s, "q6", Normal, &short);
        let q7 = location(&mut s, "q7", Normal, &[clock(b, Le, ttrt + 20)]);
        for (from, late, early, after, to, own) in [(q0, q1, q2, q3, q4, b), (q4, q5, q6, q7, q0, a)] {
            accept(edge(from, late), tt, i).clock(t, Ge, ttrt).reset(t).reset(own).to(&mut s);
            accept(edge(from, early), tt, i).clock(t, Lt, ttrt).reset(t).reset(own).to(&mut s);
            offer(edge(late, to), rt, &[n(i)]).clock(t, ClockOp::Eq, 20).to(&mut s);
            edge(early, after).clock(t, ClockOp::Eq, 20).to(&mut s);
            offer(edge(after, to), rt, &[n(i)]).to(&mut s);
        }
        add(&mut p, s);
    }
    p
}

/// The train-gate; the queue is the gate's own.
pub fn train_gate(count: i64) -> Program {
    let mut p = program();
    let shake = |p: &mut Program, name: &str| hand_shake(p, name, count - 1);
    let (appr, go) = (shake(&mut p, "appr"), shake(&mut p, "go"));
    let (leave, stop) = (shake(&mut p, "leave"), shake(&mut p, "stop"));
    let mut gate = automaton("Gate", &[]);
    gate.vars.extend((0..count).map(|i| var(&format!("q{i}"), 0, count - 1, 0)));
    gate.vars.extend([var("head", 0, count - 1, 0), var("length", 0, count, 0)]);
    let (head, length, bound) = (count as u16, count as u16 + 1, count as u16 + 2);
    let at = |k: Expr| bin(BinaryOp::Rem, bin(BinaryOp::Add, v(head), k), n(count));
    let slot =
        |k: Expr| Place { slot: 0, indices: vec![Index { at: at(k), count: count as u16, stride: 1 }] };
    let element = |k: Expr| Expr::Element(Box::new(slot(k)));
    let less = || bin(BinaryOp::Sub, v(length), n(1));
    let (free, occ) = (normal(&mut gate, "Free"), normal(&mut gate, "Occ"));
    let transient = location(&mut gate, "Transient", Committed, &[]);
    let push = |mut e: E| {
        e.0.updates.push(Update::Assign { place: slot(v(length)), value: v(bound) });
        e.set(length, bin(BinaryOp::Add, v(length), n(1)))
    };
    let some = bin(BinaryOp::Gt, v(length), n(0));
    offer(edge(free, occ).when(some), go, &[element(n(0))]).to(&mut gate);
    push(accept_any(edge(free, occ).when(eq(v(length), n(0))), appr)).to(&mut gate);
    push(accept_any(edge(occ, transient).when(bin(BinaryOp::Lt, v(length), n(count))), appr)).to(&mut gate);
    let pop = accept_any(edge(occ, free).when(eq(element(n(0)), v(bound))), leave);
    pop.set(head, at(n(1))).set(length, less()).to(&mut gate);
    offer(edge(transient, occ), stop, &[element(less())]).to(&mut gate);
    add(&mut p, gate);
    for i in 0..count {
        let mut t = automaton(&format!("Train{i}"), &["x"]);
        let safe = normal(&mut t, "Safe");
        let near = location(&mut t, "Appr", Normal, &[clock(0, Le, 20)]);
        let halted = normal(&mut t, "Stop");
        let start = location(&mut t, "Start", Normal, &[clock(0, Le, 15)]);
        let cross = location(&mut t, "Cross", Normal, &[clock(0, Le, 5)]);
        offer(edge(safe, near), appr, &[n(i)]).reset(0).to(&mut t);
        edge(near, cross).clock(0, Ge, 10).reset(0).to(&mut t);
        accept(edge(near, halted), stop, i).clock(0, Le, 10).to(&mut t);
        accept(edge(halted, start), go, i).reset(0).to(&mut t);
        edge(start, cross).clock(0, Ge, 7).reset(0).to(&mut t);
        offer(edge(cross, safe), leave, &[n(i)]).clock(0, Ge, 3).to(&mut t);
        add(&mut p, t);
    }
    p
}

/// What a random edge is like.
#[derive(Clone, Debug)]
pub struct Draft {
    pub from: u16,
    pub to: u16,
    pub sync: u8,
    pub guard: Option<(u16, u8, i64)>,
    pub reset: Option<u16>,
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

/// A network of random automata: hand-shakes 0 and 1, a broadcast channel, an event, a joint channel of the first three.
pub fn random(members: &[Member], optional: [bool; 3]) -> Program {
    let mut p = program();
    let shake = hand_shake(&mut p, "shake", 1);
    let cast = channel(&mut p, "cast", ChannelKind::Broadcast, &[]);
    let here = members.len().min(3);
    let parties = (0..here).map(|i| Party { automaton: AutomatonId(i as u16), optional: optional[i] });
    let all = channel(&mut p, "all", ChannelKind::Joint(parties.collect()), &[]);
    let tell = event(&mut p, "tell", &[]);
    p.shared.push(var("s", 0, 2, 0));
    for (i, m) in members.iter().enumerate() {
        let names: Vec<String> = (0..m.clocks).map(|c| format!("x{c}")).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let mut a: Automaton = automaton(&format!("A{i}"), &names);
        for (l, (kind, bound)) in m.locations.iter().enumerate() {
            let kind = match kind {
                0 => Committed,
                1 => hrdsl_ir::ta::LocationKind::Urgent,
                2.. => Normal,
            };
            let bound = bound.filter(|_| m.clocks > 0).map(|(c, k)| clock(c % m.clocks, Le, k));
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
    let at = |l: u16| hrdsl_ir::ta::LocationId(l % m.locations.len() as u16);
    let mut e = edge(at(draft.from), at(draft.to));
    e = match draft.sync {
        0 | 1 => offer(e, shake, &[n(i64::from(draft.sync))]),
        2 | 3 => accept(e, shake, i64::from(draft.sync) - 2),
        4 if joins => join(e, all),
        5 => offer(e, cast, &[]),
        6 => {
            e.0.sync = Sync::Accept { channel: cast, args: Vec::new() };
            e
        }
        7 => e.send(tell),
        8 => e.on(tell),
        4 | 9.. => e,
    };
    if let Some((c, op, k)) = draft.guard.filter(|_| m.clocks > 0) {
        let op = [Lt, Le, ClockOp::Eq, Ge, Gt][usize::from(op) % 5];
        e = e.clock(c % m.clocks, op, k);
    }
    if let Some(c) = draft.reset.filter(|_| m.clocks > 0) {
        e = e.reset(c % m.clocks);
    }
    if let Some(k) = draft.shared.0 {
        e = e.when(eq(v(0), n(k)));
    }
    if let Some(k) = draft.shared.1 {
        e = e.set(0, n(k));
    }
    e.0
}
