//! The standard families of timed automata, with the constants for which numbers of states are known.

use hrdsl_ir::{
    Program,
    expr::BinaryOp::{Add, Gt, Le as AtMost, Lt, Rem, Sub},
    ta::{
        AutomatonId,
        ChannelKind::{Binary, MultiWay},
        ChannelParticipant,
        ClockOp::{Eq, Ge, Gt as After, Le, Lt as Before},
        LocationKind::{Committed, Normal},
    },
};

use super::{
    E, add, automaton, bin, channel, clock, edge, element, eq, event, location, n, normal, place, program,
    shared, v,
};

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
        edge(wait, cs).clock(0, After, 10).when(eq(v(id), n(i))).to(&mut a);
        edge(cs, start).set(id, n(0)).to(&mut a);
        add(&mut p, a);
    }
    p
}

/// CSMA/CD, λ = 808, σ = 26.
pub fn csma_cd(count: i64) -> Program {
    const LAMBDA: i64 = 808;
    const SIGMA: i64 = 26;
    let mut p = program();
    let j = shared(&mut p, "j", 1, count + 1, 1);
    let [begin, busy, end] = ["begin", "busy", "end"].map(|name| channel(&mut p, name, Binary, &[]));
    let cd = channel(&mut p, "cd", Binary, &[(1, count)]);
    let mut bus = automaton("Bus", &["y"]);
    let idle = normal(&mut bus, "Idle");
    let active = normal(&mut bus, "Active");
    let collision = location(&mut bus, "Collision", Normal, &[clock(0, Before, SIGMA)]);
    let cycle = location(&mut bus, "Loop", Committed, &[]);
    edge(idle, active).accept(begin, &[]).reset(0).to(&mut bus);
    edge(active, collision).accept(begin, &[]).clock(0, Before, SIGMA).reset(0).to(&mut bus);
    edge(active, active).accept(busy, &[]).clock(0, Ge, SIGMA).to(&mut bus);
    edge(active, idle).accept(end, &[]).reset(0).to(&mut bus);
    edge(collision, cycle).clock(0, Before, SIGMA).set(j, n(1)).to(&mut bus);
    let told = edge(cycle, cycle).when(bin(AtMost, v(j), n(count))).offer(cd, &[v(j)]);
    told.set(j, bin(Add, v(j), n(1))).to(&mut bus);
    let done = edge(cycle, idle).when(eq(v(j), n(count + 1))).clock(0, Before, SIGMA);
    done.reset(0).set(j, n(1)).to(&mut bus);
    add(&mut p, bus);
    for i in 1..=count {
        let mut s = automaton(&format!("S{i}"), &["x"]);
        let wait = normal(&mut s, "Wait");
        let start = location(&mut s, "Start", Normal, &[clock(0, Le, LAMBDA)]);
        let retry = location(&mut s, "Retry", Normal, &[clock(0, Before, 2 * SIGMA)]);
        edge(wait, start).offer(begin, &[]).reset(0).to(&mut s);
        edge(wait, retry).offer(busy, &[]).reset(0).to(&mut s);
        edge(wait, wait).accept(cd, &[i]).reset(0).to(&mut s);
        edge(wait, retry).accept(cd, &[i]).reset(0).to(&mut s);
        edge(start, wait).offer(end, &[]).clock(0, Eq, LAMBDA).reset(0).to(&mut s);
        edge(start, retry).accept(cd, &[i]).clock(0, Before, SIGMA).reset(0).to(&mut s);
        edge(retry, start).offer(begin, &[]).clock(0, Before, 2 * SIGMA).reset(0).to(&mut s);
        edge(retry, retry).offer(busy, &[]).clock(0, Before, 2 * SIGMA).reset(0).to(&mut s);
        edge(retry, retry).accept(cd, &[i]).clock(0, Before, 2 * SIGMA).reset(0).to(&mut s);
        add(&mut p, s);
    }
    p
}

/// FDDI, TTRT = 50 N, SA = 20, TD = 0.
pub fn fddi(count: i64) -> Program {
    let mut p = program();
    let [tt, rt] = ["TT", "RT"].map(|name| channel(&mut p, name, Binary, &[(0, count - 1)]));
    let mut ring = automaton("Ring", &["r"]);
    let at: Vec<_> = (0..count)
        .map(|i| {
            let q = location(&mut ring, &format!("q{i}"), Normal, &[clock(0, Le, 0)]);
            (q, normal(&mut ring, &format!("r{i}")))
        })
        .collect();
    for i in 0..count {
        let (here, next) = (at[i as usize], at[((i + 1) % count) as usize]);
        edge(here.0, here.1).offer(tt, &[n(i)]).clock(0, Eq, 0).to(&mut ring);
        edge(here.1, next.0).accept(rt, &[i]).reset(0).to(&mut ring);
    }
    add(&mut p, ring);
    let (ttrt, sa) = (50 * count, 20);
    for i in 0..count {
        let mut s = automaton(&format!("S{i}"), &["t", "a", "b"]);
        let (t, a, b) = (0, 1, 2);
        let bound = |x, k| clock(x, Le, k);
        let q: Vec<_> = [None, Some((t, sa)), Some((t, sa)), Some((a, ttrt + sa)), None]
            .into_iter()
            .chain([Some((t, sa)), Some((t, sa)), Some((b, ttrt + sa))])
            .zip(0..)
            .map(|(inv, k)| {
                let inv: Vec<_> = inv.map(|(x, c)| bound(x, c)).into_iter().collect();
                location(&mut s, &format!("q{k}"), Normal, &inv)
            })
            .collect();
        for (from, late, early, other, clear) in [(0, 1, 2, 4, b), (4, 5, 6, 0, a)] {
            let (tight, waits) = (q[early], q[early + 1]);
            edge(q[from], q[late]).accept(tt, &[i]).clock(t, Ge, ttrt).reset(t).reset(clear).to(&mut s);
            edge(q[from], tight).accept(tt, &[i]).clock(t, Before, ttrt).reset(t).reset(clear).to(&mut s);
            edge(q[late], q[other]).offer(rt, &[n(i)]).clock(t, Eq, sa).to(&mut s);
            edge(tight, waits).clock(t, Eq, sa).to(&mut s);
            edge(waits, q[other]).offer(rt, &[n(i)]).to(&mut s);
        }
        add(&mut p, s);
    }
    p
}

/// Critical region, T = 10.
pub fn critical_region(count: i64) -> Program {
    const T: i64 = 10;
    let mut p = program();
    let id = shared(&mut p, "id", 0, count, 0);
    let [enter, exit] = ["enter", "exit"].map(|name| channel(&mut p, name, Binary, &[(1, count)]));
    let mut counter = automaton("Counter", &[]);
    let (i, c) = (normal(&mut counter, "I"), normal(&mut counter, "C"));
    edge(i, c).when(eq(v(id), n(0))).set(id, n(1)).to(&mut counter);
    edge(c, c).when(bin(Lt, v(id), n(count))).set(id, bin(Add, v(id), n(1))).to(&mut counter);
    edge(c, c).when(eq(v(id), n(count))).set(id, n(1)).to(&mut counter);
    add(&mut p, counter);
    for i in 1..=count {
        let mut a = automaton(&format!("Arbiter{i}"), &[]);
        let (req, ack) = (normal(&mut a, "req"), normal(&mut a, "ack"));
        edge(req, ack).accept(enter, &[i]).when(eq(v(id), n(i))).set(id, n(0)).to(&mut a);
        edge(ack, req).accept(exit, &[i]).set(id, n(i)).to(&mut a);
        add(&mut p, a);
    }
    for i in 1..=count {
        let mut c = automaton(&format!("Cell{i}"), &["x"]);
        let not_ready = normal(&mut c, "not_ready");
        let testing = location(&mut c, "testing", Normal, &[clock(0, Le, T)]);
        let requesting = normal(&mut c, "requesting");
        let critical = location(&mut c, "critical", Normal, &[clock(0, Le, 2 * T)]);
        let testing2 = location(&mut c, "testing2", Normal, &[clock(0, Le, T)]);
        let (error, safe) = (normal(&mut c, "error"), normal(&mut c, "safe"));
        edge(not_ready, testing).clock(0, Le, 2 * T).reset(0).to(&mut c);
        edge(testing, not_ready).clock(0, Ge, T).reset(0).to(&mut c);
        edge(testing, requesting).clock(0, Le, T - 1).to(&mut c);
        edge(requesting, critical).offer(enter, &[n(i)]).reset(0).to(&mut c);
        edge(critical, error).clock(0, Ge, 2 * T).to(&mut c);
        edge(critical, testing2).offer(exit, &[n(i)]).clock(0, Le, T - 1).reset(0).to(&mut c);
        edge(testing2, error).clock(0, Ge, T).to(&mut c);
        edge(testing2, safe).clock(0, Le, T - 1).to(&mut c);
        add(&mut p, c);
    }
    p
}

/// The train-gate with a circular queue.
pub fn train_gate(count: i64) -> Program {
    let mut p = program();
    let queue = shared(&mut p, "q0", 0, count - 1, 0);
    for i in 1..count {
        shared(&mut p, &format!("q{i}"), 0, count - 1, 0);
    }
    let head = shared(&mut p, "head", 0, count - 1, 0);
    let length = shared(&mut p, "length", 0, count, 0);
    let [go, appr, leave, stop] =
        ["go", "appr", "leave", "stop"].map(|name| channel(&mut p, name, Binary, &[(0, count - 1)]));
    let at = |of| bin(Rem, bin(Add, v(head), of), n(count));
    let front = || element(queue, v(head), count);
    let back = || element(queue, at(bin(Sub, v(length), n(1))), count);
    let mut gate = automaton("Gate", &[]);
    let (free, occ) = (normal(&mut gate, "Free"), normal(&mut gate, "Occ"));
    let transient = location(&mut gate, "Transient", Committed, &[]);
    // The binder of the edges that accept follows the shared variables.
    let train = length + 1;
    let push = |e: E| {
        let pushed = e.put(place(queue, at(v(length)), count), v(train));
        pushed.set(length, bin(Add, v(length), n(1)))
    };
    edge(free, occ).when(bin(Gt, v(length), n(0))).offer(go, &[front()]).to(&mut gate);
    push(edge(free, occ).bind(appr).when(eq(v(length), n(0)))).to(&mut gate);
    push(edge(occ, transient).bind(appr)).to(&mut gate);
    let pop = edge(occ, free).bind(leave).when(eq(front(), v(train))).set(head, at(n(1)));
    pop.set(length, bin(Sub, v(length), n(1))).to(&mut gate);
    edge(transient, occ).offer(stop, &[back()]).to(&mut gate);
    add(&mut p, gate);
    for me in 0..count {
        let mut t = automaton(&format!("Train{me}"), &["x"]);
        let safe = normal(&mut t, "Safe");
        let coming = location(&mut t, "Appr", Normal, &[clock(0, Le, 20)]);
        let halted = normal(&mut t, "Stop");
        let start = location(&mut t, "Start", Normal, &[clock(0, Le, 15)]);
        let cross = location(&mut t, "Cross", Normal, &[clock(0, Le, 5)]);
        edge(safe, coming).offer(appr, &[n(me)]).reset(0).to(&mut t);
        edge(coming, cross).clock(0, Ge, 10).reset(0).to(&mut t);
        edge(coming, halted).accept(stop, &[me]).clock(0, Le, 10).to(&mut t);
        edge(halted, start).accept(go, &[me]).reset(0).to(&mut t);
        edge(start, cross).clock(0, Ge, 7).reset(0).to(&mut t);
        edge(cross, safe).offer(leave, &[n(me)]).clock(0, Ge, 3).to(&mut t);
        add(&mut p, t);
    }
    p
}

/// Dining philosophers: time-out 3, eat 10, slow 0.
pub fn philosophers(count: i64) -> Program {
    let mut p = program();
    let [take, release] = ["take", "release"].map(|name| channel(&mut p, name, Binary, &[(0, count - 1)]));
    for k in 0..count {
        let mut f = automaton(&format!("Fork{k}"), &[]);
        let (free, taken) = (normal(&mut f, "free"), normal(&mut f, "taken"));
        edge(free, taken).accept(take, &[k]).to(&mut f);
        edge(taken, free).accept(release, &[k]).to(&mut f);
        add(&mut p, f);
    }
    for i in 0..count {
        let (left, right) = (n((i + count - 1) % count), n(i));
        let mut a = automaton(&format!("Phil{i}"), &["x"]);
        let idle = normal(&mut a, "idle");
        let acq = location(&mut a, "acq", Normal, &[clock(0, Le, 3)]);
        let eat = location(&mut a, "eat", Normal, &[clock(0, Le, 10)]);
        let rel = location(&mut a, "rel", Normal, &[clock(0, Le, 0)]);
        edge(idle, acq).offer(take, std::slice::from_ref(&left)).reset(0).to(&mut a);
        edge(acq, idle).offer(release, std::slice::from_ref(&left)).clock(0, Ge, 3).to(&mut a);
        edge(acq, eat).offer(take, std::slice::from_ref(&right)).clock(0, Le, 3).reset(0).to(&mut a);
        edge(eat, rel).offer(release, &[right]).clock(0, Ge, 10).reset(0).to(&mut a);
        edge(rel, idle).offer(release, &[left]).to(&mut a);
        add(&mut p, a);
    }
    p
}

/// All processes wait, then go on at once, within a second of the last.
pub fn parallel(count: i64) -> Program {
    let mut p = program();
    let participant = |i| ChannelParticipant { automaton: AutomatonId(i), optional: false };
    let go = channel(&mut p, "go", MultiWay((0..count as u16).map(participant).collect()), &[]);
    for i in 0..count {
        let mut a = automaton(&format!("P{i}"), &["x"]);
        let (start, wait, done) = (normal(&mut a, "A"), normal(&mut a, "B"), normal(&mut a, "C"));
        edge(start, wait).reset(0).to(&mut a);
        edge(wait, done).join(go).clock(0, Le, 1).to(&mut a);
        add(&mut p, a);
    }
    p
}

/// Sensors that tell a central each in a window of its own, and wait for its answer: windows of 10, cycles of 50 N (Muñiz,
/// Westphal and Podelski, "Timed Automata with Disjoint Activity", FORMATS 2012).
pub fn fire_alarm(count: i64) -> Program {
    const WINDOW: i64 = 10;
    let mut p = program();
    let [alive, ack] = ["alive", "ack"].map(|name| channel(&mut p, name, Binary, &[]));
    for i in 1..=count {
        let (begin, end) = (2 * i * WINDOW - WINDOW, 2 * i * WINDOW);
        let mut s = automaton(&format!("Sensor{i}"), &["x"]);
        let until = [("ini", begin), ("wait", begin + 5), ("sent", end), ("fin", 50 * count)];
        let [ini, wait, sent, fin] =
            until.map(|(name, k)| location(&mut s, name, Normal, &[clock(0, Le, k)]));
        edge(ini, wait).clock(0, Ge, begin).to(&mut s);
        edge(wait, sent).offer(alive, &[]).to(&mut s);
        edge(sent, fin).offer(ack, &[]).to(&mut s);
        edge(sent, fin).clock(0, Ge, end).to(&mut s);
        edge(fin, ini).clock(0, Ge, 50 * count).reset(0).to(&mut s);
        add(&mut p, s);
    }
    let mut c = automaton("C", &[]);
    let hears = normal(&mut c, "I");
    edge(hears, hears).accept(ack, &[]).to(&mut c);
    edge(hears, hears).accept(alive, &[]).to(&mut c);
    add(&mut p, c);
    p
}

/// Fischer's mutual exclusion, K = 10, with the variable in an automaton of its own.
pub fn fischer_async(count: i64) -> Program {
    const K: i64 = 10;
    let mut p = program();
    let [is, becomes] = ["is", "becomes"].map(|name| channel(&mut p, name, Binary, &[(0, count)]));
    for i in 1..=count {
        let mut a = automaton(&format!("P{i}"), &["x"]);
        let start = normal(&mut a, "A");
        let req = location(&mut a, "req", Normal, &[clock(0, Le, K)]);
        let wait = normal(&mut a, "wait");
        let cs = normal(&mut a, "cs");
        edge(start, req).offer(is, &[n(0)]).reset(0).to(&mut a);
        edge(req, wait).offer(becomes, &[n(i)]).clock(0, Le, K).reset(0).to(&mut a);
        edge(wait, req).offer(is, &[n(0)]).reset(0).to(&mut a);
        edge(wait, cs).offer(is, &[n(i)]).clock(0, After, K).to(&mut a);
        edge(cs, start).offer(becomes, &[n(0)]).to(&mut a);
        add(&mut p, a);
    }
    let mut holder = automaton("ID", &[]);
    holder.vars.push(super::var("id", 0, count, 0));
    let here = normal(&mut holder, "l");
    for i in 0..=count {
        edge(here, here).accept(is, &[i]).when(eq(v(0), n(i))).to(&mut holder);
        edge(here, here).accept(becomes, &[i]).set(0, n(i)).to(&mut holder);
    }
    add(&mut p, holder);
    p
}

/// Single sign-on: processes that need a certificate or two, each at least 2 after the last and all within 10 (Yu and Wang,
/// "SAT-based model-checking for region automata", 2006).
pub fn corsso(count: i64) -> Program {
    const BETWEEN: i64 = 2;
    const WITHIN: i64 = 10;
    const MOST: i64 = 2;
    let mut p = program();
    for i in 1..=count {
        let mut a = automaton(&format!("P{i}"), &["x", "y"]);
        let (x, y) = (0, 1);
        // Certificates, and the policy that was chosen: it needs as many as its number.
        a.vars.push(super::var("got", 0, MOST + 1, 0));
        a.vars.push(super::var("policy", 0, MOST + 1, 0));
        let (got, policy) = (0, 1);
        let (auth, access) = (normal(&mut a, "auth"), normal(&mut a, "access"));
        let more = edge(auth, auth).clock(x, After, BETWEEN).when(bin(Gt, v(policy), n(0)));
        more.when(bin(Lt, v(got), n(MOST))).set(got, bin(Add, v(got), n(1))).reset(x).to(&mut a);
        for k in 1..=MOST {
            let chosen = edge(auth, auth).when(eq(v(policy), n(0))).set(policy, n(k)).set(got, n(0));
            chosen.reset(x).reset(y).to(&mut a);
            let enough = edge(auth, access).clock(y, Before, WITHIN).when(eq(v(policy), n(k)));
            enough.when(bin(AtMost, n(k), v(got))).to(&mut a);
        }
        edge(access, auth).set(policy, n(0)).to(&mut a);
        add(&mut p, a);
    }
    p
}

/// A line of work in the manner of models that count time in an integer: a ticking clock, a robot, a person, a belt, a
/// sensor and a supervisor, of 50 locations together. Time is a variable of `0..=horizon`, so that there are very many
/// discrete states.
pub fn manufacture(horizon: i64) -> Program {
    let mut p = program();
    let time = shared(&mut p, "time", 0, horizon, 0);
    let parts = shared(&mut p, "parts", 0, 7, 0);
    let ready = shared(&mut p, "ready", 0, 1, 0);
    let [give, look, stop] = ["give", "look", "stop"].map(|name| event(&mut p, name, &[]));
    let mut tick = automaton("Tick", &["x"]);
    let run = location(&mut tick, "run", Normal, &[clock(0, Le, 1)]);
    let over = normal(&mut tick, "over");
    let beat = edge(run, run).clock(0, Ge, 1).when(bin(Lt, v(time), n(horizon))).reset(0);
    beat.set(time, bin(Add, v(time), n(1))).to(&mut tick);
    edge(run, over).clock(0, Ge, 1).when(eq(v(time), n(horizon))).to(&mut tick);
    add(&mut p, tick);
    let every = |k: i64, m: i64| eq(bin(Rem, v(time), n(m)), n(k % m));
    for (name, places, change, calls) in
        [("Robot", 12, Add, [(1, give), (3, look)].as_slice()), ("Person", 10, Sub, &[(1, stop)])]
    {
        let mut a = automaton(name, &[]);
        let at: Vec<_> = (0..places).map(|k| normal(&mut a, &format!("l{k}"))).collect();
        for k in 0..places {
            let e = edge(at[k as usize], at[((k + 1) % places) as usize]);
            let e = match (calls.iter().find(|c| c.0 == k), k) {
                (Some((_, event)), _) => e.send(*event),
                (None, 5) => e.when(every(k, 2)).set(ready, bin(Sub, n(1), v(ready))),
                (None, 6) => {
                    let room = if change == Add { bin(Lt, v(parts), n(7)) } else { bin(Gt, v(parts), n(0)) };
                    e.when(room).set(parts, bin(change, v(parts), n(1)))
                }
                (None, _) => e.when(every(k, 3)),
            };
            e.to(&mut a);
        }
        add(&mut p, a);
    }
    for (name, places, open) in [("Belt", 9, give), ("Sensor", 8, look), ("Supervisor", 9, stop)] {
        let mut a = automaton(name, &[]);
        let first = normal(&mut a, "l0");
        let rest: Vec<_> = (1..places).map(|k| location(&mut a, &format!("l{k}"), Committed, &[])).collect();
        edge(first, rest[0]).on(open).to(&mut a);
        for pair in rest.windows(2) {
            edge(pair[0], pair[1]).to(&mut a);
        }
        edge(rest[rest.len() - 1], first).to(&mut a);
        add(&mut p, a);
    }
    p
}
