//! The standard families of timed automata.
//!
//! Their hand-shakes of two are said with a broadcast: a shared variable mirrors the location of the partner (so it adds
//! no state), and the partner with a clock guard sends, guarded by the mirror, so that the other always takes part.

use hrdsl_ir::{
    EventId, Expr, Program,
    expr::BinaryOp::{Add, Ge, Gt, Lt, Rem, Sub},
    ta::{
        Automaton,
        ClockOp::{self, Le},
        LocationKind::{Committed, Normal},
    },
};

use super::{add, and, automaton, bin, clock, edge, eq, event, location, n, normal, or, program, shared, v};

/// Fischer's mutual exclusion, K = 10.
pub fn fischer(count: i64) -> Program {
    let mut p = program();
    let id = shared(&mut p, "id", 0, count, 0);
    for i in 1..=count {
        let mut a = automaton(&format!("P{i}"), &["x"]);
        let start = normal(&mut a, "A");
        let req = location(&mut a, "req", Normal, &[clock(0, Le, 10)]);
        let wait = normal(&mut a, "wait");
        let cs = normal(&mut a, "cs");
        edge(start, req).when(eq(v(id), n(0))).reset(0).to(&mut a);
        edge(req, wait).clock(0, Le, 10).reset(0).set(id, n(i)).to(&mut a);
        edge(wait, req).when(eq(v(id), n(0))).reset(0).to(&mut a);
        edge(wait, cs).clock(0, ClockOp::Gt, 10).when(eq(v(id), n(i))).to(&mut a);
        edge(cs, start).set(id, n(0)).to(&mut a);
        add(&mut p, a);
    }
    p
}

fn events(p: &mut Program, name: &str, count: i64) -> Vec<EventId> {
    (0..count).map(|i| event(p, &format!("{name}_{i}"), &[])).collect()
}

/// CSMA/CD, λ = 808, σ = 26.
pub fn csma_cd(count: i64) -> Program {
    const LAMBDA: i64 = 808;
    const SIGMA: i64 = 26;
    let mut p = program();
    let j = shared(&mut p, "j", 1, count + 1, 1);
    // 0 Idle, 1 Active, 2 Collision, 3 Loop; 0 Wait, 1 Start, 2 Retry
    let bus_at = shared(&mut p, "bus", 0, 3, 0);
    let at: Vec<u16> = (0..count).map(|i| shared(&mut p, &format!("station_{i}"), 0, 2, 0)).collect();
    let (begin, busy) = (events(&mut p, "begin", count), events(&mut p, "busy", count));
    let (end, cd) = (events(&mut p, "end", count), events(&mut p, "cd", count));
    let mut bus = automaton("Bus", &["y"]);
    let idle = normal(&mut bus, "Idle");
    let active = normal(&mut bus, "Active");
    let collision = location(&mut bus, "Collision", Normal, &[clock(0, ClockOp::Lt, SIGMA)]);
    let cycle = location(&mut bus, "Loop", Committed, &[]);
    for i in 0..count as usize {
        let ready = || bin(hrdsl_ir::expr::BinaryOp::Ne, v(at[i]), n(1));
        edge(idle, active).when(ready()).send(begin[i]).reset(0).set(bus_at, n(1)).to(&mut bus);
        let hit = edge(active, collision).when(ready()).send(begin[i]);
        hit.clock(0, ClockOp::Lt, SIGMA).reset(0).set(bus_at, n(2)).to(&mut bus);
        edge(active, active).when(ready()).send(busy[i]).clock(0, ClockOp::Ge, SIGMA).to(&mut bus);
        edge(active, idle).on(end[i]).reset(0).set(bus_at, n(0)).to(&mut bus);
        edge(cycle, cycle).on(cd[i]).set(j, bin(Add, v(j), n(1))).to(&mut bus);
    }
    edge(collision, cycle).clock(0, ClockOp::Lt, SIGMA).set(j, n(1)).set(bus_at, n(3)).to(&mut bus);
    let done = edge(cycle, idle).when(eq(v(j), n(count + 1))).clock(0, ClockOp::Lt, SIGMA).reset(0);
    done.set(j, n(1)).set(bus_at, n(0)).to(&mut bus);
    add(&mut p, bus);
    for i in 0..count as usize {
        let mut s = automaton(&format!("S{i}"), &["x"]);
        let wait = normal(&mut s, "Wait");
        let start = location(&mut s, "Start", Normal, &[clock(0, Le, LAMBDA)]);
        let retry = location(&mut s, "Retry", Normal, &[clock(0, ClockOp::Lt, 2 * SIGMA)]);
        let told = || and(eq(v(bus_at), n(3)), eq(v(j), n(i as i64 + 1)));
        edge(wait, start).on(begin[i]).reset(0).set(at[i], n(1)).to(&mut s);
        edge(wait, retry).on(busy[i]).reset(0).set(at[i], n(2)).to(&mut s);
        edge(wait, wait).when(told()).send(cd[i]).reset(0).to(&mut s);
        edge(wait, retry).when(told()).send(cd[i]).reset(0).set(at[i], n(2)).to(&mut s);
        let over = edge(start, wait).when(eq(v(bus_at), n(1))).send(end[i]);
        over.clock(0, ClockOp::Eq, LAMBDA).reset(0).set(at[i], n(0)).to(&mut s);
        let stop = edge(start, retry).when(told()).send(cd[i]).clock(0, ClockOp::Lt, SIGMA);
        stop.reset(0).set(at[i], n(2)).to(&mut s);
        edge(retry, start).on(begin[i]).reset(0).set(at[i], n(1)).to(&mut s);
        edge(retry, retry).on(busy[i]).reset(0).to(&mut s);
        edge(retry, retry).when(told()).send(cd[i]).clock(0, ClockOp::Lt, 2 * SIGMA).reset(0).to(&mut s);
        add(&mut p, s);
    }
    p
}

/// FDDI, TTRT = 50 N, SA = 20, TD = 0.
pub fn fddi(count: i64) -> Program {
    let mut p = program();
    // The ring's place: 2 i at q_i, 2 i + 1 at r_i.
    let ring_at = shared(&mut p, "ring", 0, 2 * count - 1, 0);
    let (tt, rt) = (events(&mut p, "TT", count), events(&mut p, "RT", count));
    let mut ring = automaton("Ring", &["r"]);
    let at: Vec<_> = (0..count)
        .map(|i| {
            let q = location(&mut ring, &format!("q{i}"), Normal, &[clock(0, Le, 0)]);
            (q, normal(&mut ring, &format!("r{i}")))
        })
        .collect();
    for i in 0..count as usize {
        let next = (i + 1) % count as usize;
        edge(at[i].0, at[i].1)
            .on(tt[i])
            .clock(0, ClockOp::Eq, 0)
            .set(ring_at, n(2 * i as i64 + 1))
            .to(&mut ring);
        edge(at[i].1, at[next].0).on(rt[i]).reset(0).set(ring_at, n(2 * next as i64)).to(&mut ring);
    }
    add(&mut p, ring);
    for i in 0..count {
        station(&mut p, i, count, ring_at, tt[i as usize], rt[i as usize]);
    }
    p
}

fn station(p: &mut Program, i: i64, count: i64, ring_at: u16, tt: EventId, rt: EventId) {
    const SA: i64 = 20;
    let ttrt = 50 * count;
    let (t, a, b) = (0, 1, 2);
    let mut s = automaton(&format!("S{i}"), &["t", "a", "b"]);
    let short = [clock(t, Le, SA)];
    let q0 = normal(&mut s, "q0");
    let q1 = location(&mut s, "q1", Normal, &short);
    let q2 = location(&mut s, "q2", Normal, &short);
    let q3 = location(&mut s, "q3", Normal, &[clock(a, Le, ttrt + SA)]);
    let q4 = normal(&mut s, "q4");
    let q5 = location(&mut s, "q5", Normal, &short);
    let q6 = location(&mut s, "q6", Normal, &short);
    let q7 = location(&mut s, "q7", Normal, &[clock(b, Le, ttrt + SA)]);
    for (from, late, early, after, to, own) in [(q0, q1, q2, q3, q4, b), (q4, q5, q6, q7, q0, a)] {
        let here = || eq(v(ring_at), n(2 * i));
        let held = || eq(v(ring_at), n(2 * i + 1));
        edge(from, late).when(here()).send(tt).clock(t, ClockOp::Ge, ttrt).reset(t).reset(own).to(&mut s);
        edge(from, early).when(here()).send(tt).clock(t, ClockOp::Lt, ttrt).reset(t).reset(own).to(&mut s);
        edge(late, to).when(held()).send(rt).clock(t, ClockOp::Eq, SA).to(&mut s);
        edge(early, after).clock(t, ClockOp::Eq, SA).to(&mut s);
        edge(after, to).when(held()).send(rt).to(&mut s);
    }
    add(p, s);
}

/// The critical region, T = 10.
pub fn critical_region(count: i64) -> Program {
    const T: i64 = 10;
    let mut p = program();
    let id = shared(&mut p, "id", 0, count, 0);
    // 0 req, 1 ack
    let arbiter: Vec<u16> = (0..count).map(|i| shared(&mut p, &format!("arbiter_{i}"), 0, 1, 0)).collect();
    let (enter, exit) = (events(&mut p, "enter", count), events(&mut p, "exit", count));
    let mut counter = automaton("Counter", &[]);
    let (first, count_on) = (normal(&mut counter, "I"), normal(&mut counter, "C"));
    edge(first, count_on).when(eq(v(id), n(0))).set(id, n(1)).to(&mut counter);
    edge(count_on, count_on).when(bin(Lt, v(id), n(count))).set(id, bin(Add, v(id), n(1))).to(&mut counter);
    edge(count_on, count_on).when(eq(v(id), n(count))).set(id, n(1)).to(&mut counter);
    add(&mut p, counter);
    for i in 0..count as usize {
        let me = i as i64 + 1;
        let mut a = automaton(&format!("Arbiter{me}"), &[]);
        let (req, ack) = (normal(&mut a, "req"), normal(&mut a, "ack"));
        edge(req, ack).on(enter[i]).set(id, n(0)).set(arbiter[i], n(1)).to(&mut a);
        edge(ack, req).on(exit[i]).set(id, n(me)).set(arbiter[i], n(0)).to(&mut a);
        add(&mut p, a);
        let mut c = automaton(&format!("Cell{me}"), &["x"]);
        let not_ready = normal(&mut c, "not_ready");
        let testing = location(&mut c, "testing", Normal, &[clock(0, Le, T)]);
        let requesting = normal(&mut c, "requesting");
        let critical = location(&mut c, "critical", Normal, &[clock(0, Le, 2 * T)]);
        let testing2 = location(&mut c, "testing2", Normal, &[clock(0, Le, T)]);
        let (error, safe) = (normal(&mut c, "error"), normal(&mut c, "safe"));
        edge(not_ready, testing).clock(0, Le, 2 * T).reset(0).to(&mut c);
        edge(testing, not_ready).clock(0, ClockOp::Ge, T).to(&mut c);
        edge(testing, requesting).clock(0, Le, T - 1).to(&mut c);
        let may = and(eq(v(arbiter[i]), n(0)), eq(v(id), n(me)));
        edge(requesting, critical).when(may).send(enter[i]).reset(0).to(&mut c);
        edge(critical, error).clock(0, ClockOp::Ge, 2 * T).to(&mut c);
        let leave = edge(critical, testing2).when(eq(v(arbiter[i]), n(1))).send(exit[i]);
        leave.clock(0, Le, T - 1).reset(0).to(&mut c);
        edge(testing2, error).clock(0, ClockOp::Ge, T).to(&mut c);
        edge(testing2, safe).clock(0, Le, T - 1).to(&mut c);
        add(&mut p, c);
    }
    p
}

/// The train-gate with a circular queue.
pub fn train_gate(count: i64) -> Program {
    let mut p = program();
    let queue: Vec<u16> = (0..count).map(|i| shared(&mut p, &format!("q{i}"), 0, count - 1, 0)).collect();
    let head = shared(&mut p, "head", 0, count - 1, 0);
    let length = shared(&mut p, "length", 0, count, 0);
    // 0 Free, 1 Occ, 2 Transient; a train: 1 stopped
    let gate_at = shared(&mut p, "gate", 0, 2, 0);
    let stopped: Vec<u16> = (0..count).map(|i| shared(&mut p, &format!("stopped_{i}"), 0, 1, 0)).collect();
    let (go, appr) = (events(&mut p, "go", count), events(&mut p, "appr", count));
    let (leave, stop) = (events(&mut p, "leave", count), events(&mut p, "stop", count));
    let place = |of: Expr| bin(Rem, bin(Add, v(head), of), n(count));
    let read = |at: &dyn Fn() -> Expr| {
        queue
            .iter()
            .zip(0..)
            .fold(n(0), |rest, (&q, k)| Expr::If(Box::new(eq(at(), n(k))), Box::new(v(q)), Box::new(rest)))
    };
    let front = || read(&|| v(head));
    let back = || read(&|| place(bin(Sub, v(length), n(1))));
    let mut gate = automaton("Gate", &[]);
    let (free, occ) = (normal(&mut gate, "Free"), normal(&mut gate, "Occ"));
    let transient = location(&mut gate, "Transient", Committed, &[]);
    for i in 0..count as usize {
        let me = i as i64;
        let push = |mut e: super::E| {
            for (&q, k) in queue.iter().zip(0..) {
                let here = eq(place(v(length)), n(k));
                e = e.set(q, Expr::If(Box::new(here), Box::new(n(me)), Box::new(v(q))));
            }
            e.set(length, bin(Add, v(length), n(1)))
        };
        let due = and(bin(Gt, v(length), n(0)), and(eq(front(), n(me)), eq(v(stopped[i]), n(1))));
        edge(free, occ).when(due).send(go[i]).set(gate_at, n(1)).to(&mut gate);
        push(edge(free, occ).on(appr[i])).set(gate_at, n(1)).to(&mut gate);
        push(edge(occ, transient).on(appr[i])).set(gate_at, n(2)).to(&mut gate);
        let pop = edge(occ, free).on(leave[i]).set(head, place(n(1)));
        pop.set(length, bin(Sub, v(length), n(1))).set(gate_at, n(0)).to(&mut gate);
        edge(transient, occ).on(stop[i]).set(gate_at, n(1)).to(&mut gate);
    }
    add(&mut p, gate);
    for i in 0..count as usize {
        let me = i as i64;
        let mut t = automaton(&format!("Train{i}"), &["x"]);
        let safe = normal(&mut t, "Safe");
        let coming = location(&mut t, "Appr", Normal, &[clock(0, Le, 20)]);
        let halted = normal(&mut t, "Stop");
        let start = location(&mut t, "Start", Normal, &[clock(0, Le, 15)]);
        let cross = location(&mut t, "Cross", Normal, &[clock(0, Le, 5)]);
        let open = or(and(eq(v(gate_at), n(0)), eq(v(length), n(0))), eq(v(gate_at), n(1)));
        edge(safe, coming).when(open).send(appr[i]).reset(0).to(&mut t);
        edge(coming, cross).clock(0, ClockOp::Ge, 10).reset(0).to(&mut t);
        let halt = edge(coming, halted).when(and(eq(v(gate_at), n(2)), eq(back(), n(me)))).send(stop[i]);
        halt.clock(0, Le, 10).set(stopped[i], n(1)).to(&mut t);
        edge(halted, start).on(go[i]).reset(0).set(stopped[i], n(0)).to(&mut t);
        edge(start, cross).clock(0, ClockOp::Ge, 7).reset(0).to(&mut t);
        let gone = edge(cross, safe).when(and(eq(v(gate_at), n(1)), eq(front(), n(me)))).send(leave[i]);
        gone.clock(0, ClockOp::Ge, 3).to(&mut t);
        add(&mut p, t);
    }
    p
}

/// Dining philosophers: time-out 3, eat 10, slow 0.
pub fn philosophers(count: i64) -> Program {
    let mut p = program();
    let size = count as usize;
    let fork: Vec<u16> = (0..size).map(|i| shared(&mut p, &format!("fork_{i}"), 0, 1, 0)).collect();
    let (take, release) = (events(&mut p, "take", count), events(&mut p, "release", count));
    for k in 0..size {
        let mut f = automaton(&format!("Fork{k}"), &[]);
        let (free, taken) = (normal(&mut f, "free"), normal(&mut f, "taken"));
        edge(free, taken).on(take[k]).set(fork[k], n(1)).to(&mut f);
        edge(taken, free).on(release[k]).set(fork[k], n(0)).to(&mut f);
        add(&mut p, f);
    }
    for i in 0..size {
        let (left, right) = ((i + size - 1) % size, i);
        let mut a = automaton(&format!("Phil{i}"), &["x"]);
        let idle = normal(&mut a, "idle");
        let acq = location(&mut a, "acq", Normal, &[clock(0, Le, 3)]);
        let eat = location(&mut a, "eat", Normal, &[clock(0, Le, 10)]);
        let rel = location(&mut a, "rel", Normal, &[clock(0, Le, 0)]);
        let is = |f: usize, k: i64| eq(v(fork[f]), n(k));
        edge(idle, acq).when(is(left, 0)).send(take[left]).reset(0).to(&mut a);
        edge(acq, idle).when(is(left, 1)).send(release[left]).clock(0, ClockOp::Ge, 3).to(&mut a);
        edge(acq, eat).when(is(right, 0)).send(take[right]).clock(0, Le, 3).reset(0).to(&mut a);
        let sated = edge(eat, rel).when(is(right, 1)).send(release[right]);
        sated.clock(0, ClockOp::Ge, 10).reset(0).to(&mut a);
        edge(rel, idle).when(is(left, 1)).send(release[left]).to(&mut a);
        add(&mut p, a);
    }
    p
}

/// All processes wait, then go on at once, within a second of the last: the first tells the others.
///
/// The others' `x <= 1` is the invariant of where they go: it forbids the whole transition, as the hand-shake of all would.
pub fn parallel(count: i64) -> Program {
    let mut p = program();
    let ready = shared(&mut p, "ready", 0, count, 0);
    let go = event(&mut p, "go", &[]);
    for i in 0..count {
        let mut a: Automaton = automaton(&format!("P{i}"), &["x"]);
        let (start, wait) = (normal(&mut a, "A"), normal(&mut a, "B"));
        let done = location(&mut a, "C", Normal, &[clock(0, Le, 1)]);
        edge(start, wait).reset(0).set(ready, bin(Add, v(ready), n(1))).to(&mut a);
        if i == 0 {
            edge(wait, done).when(bin(Ge, v(ready), n(count))).send(go).to(&mut a);
        } else {
            edge(wait, done).on(go).to(&mut a);
        }
        add(&mut p, a);
    }
    p
}
