//! Each kind of query on small hand-made networks.

mod common;

use common::asked::{ask, at, x};
use common::{E, add, automaton, bin, clock, edge, eq, event, location, n, normal, program, shared, v};
use hrdsl_ir::{
    Program, Span,
    expr::BinaryOp,
    ta::{
        ClockConstraint, ClockId, ClockOp, LocationId, LocationKind, QueryFormula, QueryKind, QueryMeasure,
        TimeSum,
    },
    value::SECOND,
};
use hrdsl_ta::{ExtremumLimit, ExtremumValue, QueryAnswer, QueryVerdict, RunEnding};

fn not(f: QueryFormula) -> QueryFormula {
    QueryFormula::Not(Box::new(f))
}

fn ending(a: &QueryAnswer) -> Option<RunEnding> {
    a.run.as_ref().map(|r| r.ending)
}

/// a [x <= 5] -> b when x >= 2
struct Two {
    p: Program,
    a: LocationId,
    b: LocationId,
}

fn two(bounded: bool) -> Two {
    let mut p = program();
    let mut m = automaton("M", &["x"]);
    let inv = [clock(0, ClockOp::Le, 5)];
    let a = location(&mut m, "a", LocationKind::Normal, if bounded { &inv } else { &[] });
    let b = normal(&mut m, "b");
    edge(a, b).clock(0, ClockOp::Ge, 2).to(&mut m);
    add(&mut p, m);
    Two { p, a, b }
}

#[test]
fn possibly_and_invariantly() {
    let t = two(true);
    let yes = ask(&t.p, QueryKind::Possibly(at(0, t.b)));
    assert_eq!(yes.verdict, QueryVerdict::Holds);
    assert_eq!(yes.run.unwrap().end, 2 * SECOND);
    assert_eq!(yes.why, "a run reaches it after 1 transition and 2 s");
    let no = ask(&t.p, QueryKind::Invariantly(at(0, t.a)));
    assert_eq!((no.verdict, no.run.is_some()), (QueryVerdict::Fails, true));
    let never = QueryFormula::And(vec![at(0, t.a), at(0, t.b)]);
    assert_eq!(ask(&t.p, QueryKind::Possibly(never.clone())).verdict, QueryVerdict::Fails);
    assert_eq!(ask(&t.p, QueryKind::Invariantly(not(never))).verdict, QueryVerdict::Holds);
}

#[test]
fn clocks_in_reachability() {
    let t = two(true);
    let in_a = |f| QueryFormula::And(vec![at(0, t.a), f]);
    let late = ask(&t.p, QueryKind::Possibly(in_a(x(0, ClockOp::Ge, 5))));
    assert_eq!(late.verdict, QueryVerdict::Holds);
    let run = late.run.unwrap();
    assert_eq!((run.steps.len(), run.end), (0, 5 * SECOND));
    assert_eq!(ask(&t.p, QueryKind::Possibly(in_a(x(0, ClockOp::Gt, 5)))).verdict, QueryVerdict::Fails);
    assert_eq!(
        ask(&t.p, QueryKind::Invariantly(not(in_a(x(0, ClockOp::Gt, 5))))).verdict,
        QueryVerdict::Holds
    );
    // Greater than any constant of the model, and finer.
    assert_eq!(ask(&t.p, QueryKind::Possibly(x(0, ClockOp::Gt, 1000))).verdict, QueryVerdict::Holds);
    let half = ClockConstraint {
        clock: ClockId(0),
        minus: None,
        op: ClockOp::Eq,
        bound: TimeSum::constant(SECOND / 2),
    };
    let run = ask(&t.p, QueryKind::Possibly(QueryFormula::Clock(half))).run.unwrap();
    assert_eq!(run.end, SECOND / 2);
}

#[test]
fn eventually_needs_an_invariant() {
    let t = two(true);
    assert_eq!(ask(&t.p, QueryKind::Eventually(at(0, t.b))).verdict, QueryVerdict::Holds);
    let t = two(false);
    let no = ask(&t.p, QueryKind::Eventually(at(0, t.b)));
    assert_eq!((no.verdict, ending(&no)), (QueryVerdict::Fails, Some(RunEnding::Waits)));
    assert_eq!(no.why, "time can pass for ever in `M.a`, so no run has to go on from there");
}

#[test]
fn a_missed_guard_is_a_time_lock() {
    // a [x <= 5] -> b when x <= 2: who waits longer is stuck.
    let mut p = program();
    let mut m = automaton("M", &["x"]);
    let a = location(&mut m, "a", LocationKind::Normal, &[clock(0, ClockOp::Le, 5)]);
    let b = normal(&mut m, "b");
    edge(a, b).clock(0, ClockOp::Le, 2).to(&mut m);
    edge(b, b).clock(0, ClockOp::Ge, 0).to(&mut m);
    add(&mut p, m);
    let no = ask(&p, QueryKind::Eventually(at(0, b)));
    assert_eq!((no.verdict, ending(&no)), (QueryVerdict::Fails, Some(RunEnding::Stuck)));
    assert!(no.run.unwrap().end > 2 * SECOND);
    let yes = ask(&p, QueryKind::Possibly(QueryFormula::Deadlock));
    let run = yes.run.unwrap();
    assert_eq!((run.steps.len(), run.end), (0, 2 * SECOND + 1));
    let free = QueryFormula::Or(vec![
        not(QueryFormula::Deadlock),
        QueryFormula::And(vec![at(0, a), x(0, ClockOp::Gt, 2)]),
    ]);
    assert_eq!(ask(&p, QueryKind::Invariantly(free)).verdict, QueryVerdict::Holds);
    assert_eq!(ask(&p, QueryKind::Invariantly(not(QueryFormula::Deadlock))).verdict, QueryVerdict::Fails);
}

#[test]
fn a_deadlock_may_come_from_the_target_s_invariant() {
    // a -> b [y <= 1] with x reset only: after a second nothing is possible.
    let mut p = program();
    let mut m = automaton("M", &["x", "y"]);
    let a = normal(&mut m, "a");
    let b = location(&mut m, "b", LocationKind::Normal, &[clock(1, ClockOp::Le, 1)]);
    edge(a, b).reset(0).to(&mut m);
    edge(b, b).reset(1).to(&mut m);
    add(&mut p, m);
    let run =
        ask(&p, QueryKind::Possibly(QueryFormula::And(vec![QueryFormula::Deadlock, at(0, a)]))).run.unwrap();
    assert_eq!(run.end, SECOND + 1);
    assert_eq!(
        ask(&p, QueryKind::Possibly(QueryFormula::And(vec![QueryFormula::Deadlock, x(1, ClockOp::Le, 1)])))
            .verdict,
        QueryVerdict::Fails
    );
}

#[test]
fn a_loop_is_a_counterexample_and_a_zeno_one_says_so() {
    let mut p = program();
    let mut m = automaton("M", &["x"]);
    let a = location(&mut m, "a", LocationKind::Normal, &[clock(0, ClockOp::Le, 3)]);
    let b = normal(&mut m, "b");
    edge(a, a).clock(0, ClockOp::Ge, 3).reset(0).to(&mut m);
    edge(a, b).clock(0, ClockOp::Ge, 3).to(&mut m);
    add(&mut p, m);
    let no = ask(&p, QueryKind::Eventually(at(0, b)));
    assert_eq!((no.verdict, ending(&no)), (QueryVerdict::Fails, Some(RunEnding::Again(0))));
    assert_eq!(no.why, "a run goes round for ever through `M.a`, by 1 transition");
    let yes = ask(&p, QueryKind::PotentiallyAlways(at(0, a)));
    assert_eq!((yes.verdict, ending(&yes)), (QueryVerdict::Holds, Some(RunEnding::Again(0))));
    // The same in no time.
    p.automata[0].locations[0].kind = LocationKind::Committed;
    p.automata[0].edges[0].clock_guard.clear();
    let zeno = ask(&p, QueryKind::PotentiallyAlways(at(0, a)));
    assert_eq!(
        zeno.why,
        "a run stays in it: a run goes round for ever through `M.a`, by 1 transition, in which no time passes (a Zeno run)"
    );
    // Time passes in it, but no more than the invariant lets, however often it goes round.
    p.automata[0].locations[0].kind = LocationKind::Normal;
    p.automata[0].edges[0].updates.clear();
    let zeno = ask(&p, QueryKind::Eventually(at(0, b)));
    assert_eq!(
        zeno.why,
        "a run goes round for ever through `M.a`, by 1 transition, in which time does not pass beyond a bound, since `M.x` is bounded and never set (a Zeno run)"
    );
}

#[test]
fn clocks_in_liveness() {
    let t = two(true);
    // Time passes through each cell, up to the invariant.
    assert_eq!(ask(&t.p, QueryKind::Eventually(x(0, ClockOp::Eq, 2))).verdict, QueryVerdict::Holds);
    assert_eq!(ask(&t.p, QueryKind::Eventually(x(0, ClockOp::Gt, 2))).verdict, QueryVerdict::Holds);
    // Which it need not do in a: it may leave at 2.
    let three_in_a = QueryFormula::And(vec![at(0, t.a), x(0, ClockOp::Ge, 3)]);
    assert_eq!(ask(&t.p, QueryKind::Eventually(three_in_a.clone())).verdict, QueryVerdict::Fails);
    let or_b = QueryFormula::Or(vec![three_in_a, at(0, t.b)]);
    assert_eq!(ask(&t.p, QueryKind::Eventually(or_b)).verdict, QueryVerdict::Holds);
    // No run stays before 2, but one stays before 6 if it ends at 5.
    assert_eq!(ask(&t.p, QueryKind::PotentiallyAlways(x(0, ClockOp::Lt, 2))).verdict, QueryVerdict::Fails);
    let mut stops = two(true);
    stops.p.automata[0].edges.clear();
    let stays = ask(&stops.p, QueryKind::PotentiallyAlways(x(0, ClockOp::Lt, 6)));
    assert_eq!((stays.verdict, ending(&stays)), (QueryVerdict::Holds, Some(RunEnding::Stuck)));
    assert_eq!(
        ask(&stops.p, QueryKind::PotentiallyAlways(x(0, ClockOp::Lt, 5))).verdict,
        QueryVerdict::Fails
    );
    stops.p.automata[0].locations[0].invariant = vec![clock(0, ClockOp::Lt, 5)];
    assert_eq!(
        ask(&stops.p, QueryKind::PotentiallyAlways(x(0, ClockOp::Lt, 5))).verdict,
        QueryVerdict::Holds
    );
    assert_eq!(ask(&stops.p, QueryKind::Eventually(x(0, ClockOp::Ge, 5))).verdict, QueryVerdict::Fails);
}

#[test]
fn leads_to() {
    // idle -> busy [x <= 3] -> idle; and a trap behind busy at 3.
    let mut p = program();
    let mut m = automaton("M", &["x"]);
    let idle = normal(&mut m, "idle");
    let busy = location(&mut m, "busy", LocationKind::Normal, &[clock(0, ClockOp::Le, 3)]);
    let hole = normal(&mut m, "hole");
    edge(idle, busy).reset(0).to(&mut m);
    edge(busy, idle).clock(0, ClockOp::Ge, 1).to(&mut m);
    add(&mut p, m);
    let ask_it = |p: &Program| ask(p, QueryKind::LeadsTo(at(0, busy), at(0, idle)));
    assert_eq!(ask_it(&p).verdict, QueryVerdict::Holds);
    assert_eq!(ask(&p, QueryKind::Eventually(at(0, busy))).verdict, QueryVerdict::Fails);
    let mut worse = p.clone();
    edge(busy, hole).clock(0, ClockOp::Ge, 3).to(&mut worse.automata[0]);
    let no = ask_it(&worse);
    assert_eq!((no.verdict, ending(&no)), (QueryVerdict::Fails, Some(RunEnding::Waits)));
    assert_eq!(no.run.unwrap().end, 3 * SECOND);
    // Only from where the first holds with its clocks.
    let late = QueryFormula::And(vec![at(0, busy), x(0, ClockOp::Gt, 3)]);
    assert_eq!(ask(&worse, QueryKind::LeadsTo(late, at(0, idle))).verdict, QueryVerdict::Holds);
}

#[test]
fn committed_loops_stay() {
    let mut p = program();
    let q = shared(&mut p, "q", 0, 1, 0);
    let mut m = automaton("M", &[]);
    let a = location(&mut m, "a", LocationKind::Committed, &[]);
    let b = location(&mut m, "b", LocationKind::Committed, &[]);
    edge(a, b).set(q, n(1)).to(&mut m);
    edge(b, a).set(q, n(0)).to(&mut m);
    add(&mut p, m);
    let mut other = automaton("N", &[]);
    let c = normal(&mut other, "c");
    let d = normal(&mut other, "d");
    edge(c, d).to(&mut other);
    add(&mut p, other);
    let yes = ask(&p, QueryKind::PotentiallyAlways(at(1, c)));
    assert_eq!((yes.verdict, ending(&yes)), (QueryVerdict::Holds, Some(RunEnding::Again(0))));
    assert_eq!(
        ask(&p, QueryKind::PotentiallyAlways(QueryFormula::Data(eq(v(q), n(0))))).verdict,
        QueryVerdict::Fails
    );
    // The other never gets a turn.
    assert_eq!(ask(&p, QueryKind::Possibly(at(1, d))).verdict, QueryVerdict::Fails);
}

fn limits(a: &QueryAnswer) -> Vec<ExtremumLimit> {
    a.extrema.iter().map(|e| e.limit).collect()
}

fn secs(s: i64, attained: bool) -> ExtremumLimit {
    ExtremumLimit::At { value: ExtremumValue::Nanos(s * SECOND), attained }
}

#[test]
fn least_and_greatest() {
    let t = two(true);
    let clocks = |when: QueryFormula| QueryKind::Sup { of: vec![QueryMeasure::Clock(ClockId(0))], when };
    let low = |when: QueryFormula| QueryKind::Inf { of: vec![QueryMeasure::Clock(ClockId(0))], when };
    assert_eq!(limits(&ask(&t.p, clocks(at(0, t.a)))), [secs(5, true)]);
    assert_eq!(limits(&ask(&t.p, clocks(at(0, t.b)))), [ExtremumLimit::Unbounded]);
    assert_eq!(limits(&ask(&t.p, low(at(0, t.b)))), [secs(2, true)]);
    assert_eq!(limits(&ask(&t.p, low(at(0, t.a)))), [secs(0, true)]);
    let beyond = QueryFormula::And(vec![at(0, t.b), x(0, ClockOp::Gt, 700)]);
    assert_eq!(limits(&ask(&t.p, low(beyond))), [secs(700, false)]);
    let between = QueryFormula::And(vec![at(0, t.b), x(0, ClockOp::Lt, 900)]);
    let sup = ask(&t.p, clocks(between));
    assert_eq!(limits(&sup), [secs(900, false)]);
    assert_eq!(sup.why, "< 900 s");
    assert!(sup.extrema[0].run.as_ref().unwrap().end > 899 * SECOND);
    let nowhere = QueryFormula::And(vec![at(0, t.a), at(0, t.b)]);
    assert_eq!(limits(&ask(&t.p, clocks(nowhere))), [ExtremumLimit::Nowhere]);
}

#[test]
fn a_clock_beyond_its_constants_is_followed() {
    // Four rounds of 3 s each; total is never reset and never tested.
    let mut p = program();
    let k = shared(&mut p, "k", 0, 4, 0);
    let mut m = automaton("M", &["x", "total"]);
    let a = location(&mut m, "a", LocationKind::Normal, &[clock(0, ClockOp::Le, 3)]);
    let more = bin(BinaryOp::Add, v(k), n(1));
    let again = edge(a, a).clock(0, ClockOp::Gt, 2).when(bin(BinaryOp::Lt, v(k), n(4)));
    again.reset(0).set(k, more).to(&mut m);
    add(&mut p, m);
    let of = || vec![QueryMeasure::Clock(ClockId(1)), QueryMeasure::Data(v(k))];
    let done = || QueryFormula::Data(eq(v(k), n(4)));
    let sup = ask(&p, QueryKind::Sup { of: of(), when: done() });
    let four = ExtremumLimit::At { value: ExtremumValue::Number(4), attained: true };
    assert_eq!(limits(&sup), [secs(15, true), four]);
    let inf = ask(&p, QueryKind::Inf { of: of(), when: done() });
    assert_eq!(limits(&inf), [secs(8, false), four]);
    for e in sup.extrema.iter().chain(&inf.extrema) {
        assert!(e.run.is_some());
    }
}

/// A deadlock that simulation cannot rule out: the search by greatest constants decides.
#[test]
fn a_deadlock_that_only_what_is_simulated_could_have() {
    let mut p = program();
    let mut m = automaton("M", &["x", "y"]);
    let a = location(&mut m, "a", LocationKind::Normal, &[clock(0, ClockOp::Le, 1)]);
    // Entered with y = 0 and left while it is small; nothing later asks whether y is great.
    let b = location(&mut m, "b", LocationKind::Urgent, &[]);
    edge(a, b).reset(1).to(&mut m);
    edge(b, a).clock(1, ClockOp::Lt, 3).reset(0).to(&mut m);
    add(&mut p, m);
    let deadlock = || QueryKind::Possibly(QueryFormula::Deadlock);
    assert_eq!(ask(&p, deadlock()).verdict, QueryVerdict::Fails);
    assert_eq!(ask(&p, QueryKind::Eventually(at(0, b))).verdict, QueryVerdict::Holds);
    // With the invariant alone it is one.
    p.automata[0].edges[0].clock_guard.push(clock(0, ClockOp::Gt, 1));
    assert_eq!(ask(&p, deadlock()).verdict, QueryVerdict::Holds);
}

/// Alive for less than a nanosecond: the witness meets a strict bound by one, and what is left before another is no whole number of them.
#[test]
fn a_state_may_be_alive_for_less_than_a_tick() {
    let mut p = program();
    let mut m = automaton("M", &["x"]);
    let (wait, gone) = (normal(&mut m, "wait"), normal(&mut m, "gone"));
    edge(wait, gone).clock(0, ClockOp::Gt, 3).to(&mut m);
    add(&mut p, m);
    let mut o = automaton("O", &["x"]);
    let first = normal(&mut o, "first");
    let short = location(&mut o, "short", LocationKind::Normal, &[clock(0, ClockOp::Lt, 2)]);
    edge(first, short).reset(0).to(&mut o);
    add(&mut p, o);
    let alive = QueryFormula::And(vec![not(QueryFormula::Deadlock), at(1, short)]);
    let yes = ask(&p, QueryKind::Possibly(alive));
    assert_eq!((yes.verdict, yes.run.unwrap().end), (QueryVerdict::Holds, SECOND + 1));
}

#[test]
fn a_run_is_told_and_drawn() {
    let mut p = program();
    let go = event(&mut p, "go", &[]);
    let q = shared(&mut p, "q", 0, 3, 0);
    let mut m = automaton("Sender", &["x"]);
    let (a, b) = (normal(&mut m, "a"), normal(&mut m, "b"));
    edge(a, b).clock(0, ClockOp::Ge, 2).send(go).reset(0).to(&mut m);
    add(&mut p, m);
    let mut m = automaton("R", &[]);
    let (c, d) = (normal(&mut m, "c"), normal(&mut m, "d"));
    edge(c, d).on(go).set(q, n(2)).to(&mut m);
    let back: E = edge(d, c);
    back.to(&mut m);
    add(&mut p, m);
    let f = QueryFormula::And(vec![at(0, b), at(1, c)]);
    let run = ask(&p, QueryKind::Possibly(f)).run.unwrap();
    let trace = hrdsl_ta::WitnessTrace::from_run(&p, &p.networks[0], &run);
    let told = "\
2 s  Sender  go  a -> b, R: c -> d   [q: 0 -> 2; Sender.x = 0]
2 s  R           d -> c
";
    assert_eq!(trace.text(), told);
    let mermaid = "\
sequenceDiagram
  participant a0 as Sender
  participant a1 as R
  Note over a0,a1: 2 s
  a0-)a1: go
  Note over a0: a → b, q: 0 → 2
  Note over a1: c → d
  Note over a1: d → c
";
    assert_eq!(trace.mermaid(), mermaid);
    let dot = trace.dot();
    assert!(
        dot.starts_with("digraph sequence {")
            && dot.contains("s0_0 -> s0_1 [label = \"go\", style = dashed];")
    );
    let json = serde_json::to_value(&trace).unwrap();
    assert_eq!(json["steps"][0]["parts"][1]["to"], "d");
    assert_eq!(json["ending"], "reached");
}

/// Two shake hands over `go(1)` in an urgent way; a third joins both over `all`.
fn channels() -> (Program, [LocationId; 2]) {
    use hrdsl_ir::ta::{
        AutomatonId, Channel, ChannelId, ChannelKind, ChannelParticipant, ReceiveArg, SyncLabel,
    };
    let mut p = program();
    let participant = |n| ChannelParticipant { automaton: AutomatonId(n), optional: false };
    let kinds = [ChannelKind::Binary, ChannelKind::MultiWay(vec![participant(0), participant(1)])];
    for (name, kind) in ["go", "all"].into_iter().zip(kinds) {
        let params = if name == "go" { vec![common::var("k", 0, 3, 0)] } else { Vec::new() };
        let urgent = name == "go";
        p.channels.push(Channel { name: name.into(), kind, urgent, params, origin: Span::default() });
    }
    let mut ids = [LocationId(0); 2];
    for (i, name) in ["A", "B"].into_iter().enumerate() {
        let mut m = automaton(name, &["x"]);
        let (a, b) = (normal(&mut m, "a"), normal(&mut m, "b"));
        ids = [a, b];
        let mut shake = edge(a, b).reset(0);
        let channel = ChannelId(0);
        shake.0.sync = if i == 0 {
            SyncLabel::Offer { channel, args: vec![n(1)] }
        } else {
            SyncLabel::Accept { channel, args: vec![ReceiveArg::Bind] }
        };
        shake.to(&mut m);
        let mut join = edge(b, a).clock(0, ClockOp::Gt, 2);
        join.0.sync = SyncLabel::Join { channel: ChannelId(1) };
        join.to(&mut m);
        add(&mut p, m);
    }
    (p, ids)
}

#[test]
fn channels_urge_and_are_told() {
    let (p, [a, b]) = channels();
    // Time never passes in a: the binary synchronisation is possible.
    let in_a = QueryFormula::And(vec![at(0, a), x(0, ClockOp::Gt, 3)]);
    let fresh = QueryFormula::And(vec![at(0, b), x(0, ClockOp::Gt, 2)]);
    assert_eq!(
        ask(&p, QueryKind::Possibly(QueryFormula::And(vec![at(0, a), not(at(1, a))]))).verdict,
        QueryVerdict::Fails
    );
    assert_eq!(ask(&p, QueryKind::Eventually(at(0, b))).verdict, QueryVerdict::Holds);
    assert_eq!(ask(&p, QueryKind::LeadsTo(at(0, a), at(1, b))).verdict, QueryVerdict::Holds);
    // The clock keeps what it had when it came back, but no time is added.
    assert_eq!(ask(&p, QueryKind::Possibly(in_a)).verdict, QueryVerdict::Holds);
    let run = ask(&p, QueryKind::Possibly(fresh)).run.unwrap();
    assert_eq!((run.steps.len(), run.end), (1, 2 * SECOND + 1));
    let again = QueryFormula::And(vec![at(0, a), x(0, ClockOp::Gt, 2)]);
    let run = ask(&p, QueryKind::Possibly(again)).run.unwrap();
    let trace = hrdsl_ta::WitnessTrace::from_run(&p, &p.networks[0], &run);
    let told = "          0 s  A  go(1)  a -> b, B: a -> b   [A.x = 0; B.x = 0]
2.000000001 s  A  all    b -> a, B: b -> a
";
    assert_eq!(trace.text(), told);
    assert!(trace.mermaid().contains("  a0->>a1: go(1)\n"));
    // Waiting in b for ever is possible: nothing forces the multi-way channel.
    let no = ask(&p, QueryKind::LeadsTo(at(0, b), at(0, a)));
    assert_eq!((no.verdict, ending(&no)), (QueryVerdict::Fails, Some(RunEnding::Waits)));
    assert!(no.why.starts_with("after the first, time can pass for ever in `A.b` and `B.b`"), "{}", no.why);
}
