//! Networks in which engine and regions once differed.

use hrdsl_ir::{
    Expr, Program, Span,
    expr::{ArrayIndex, BinaryOp, Lvalue},
    ta::{
        AutomatonId, Channel, ChannelId, ChannelKind, ChannelParticipant, ClockConstraint, ClockId, ClockOp,
        LocationKind, ReceiveArg, SyncLabel, TimeSum, TimeTerm,
    },
    value::SECOND,
};

use crate::{
    common::{add, automaton, bin, clock, edge, eq, location, n, normal, program, shared, v, var},
    engine::{LIMITS, asks, disagreement},
    oracle::explore,
};

fn agrees(p: &Program) {
    assert_eq!(disagreement(p), Ok(None), "{}", crate::oracle::text::program(p));
}

/// `s` is 0, 1 or 2, `q` has two elements: `q[s]` is a fault, if `s` is 2.
fn array() -> (Program, TimeSum) {
    let mut p = program();
    shared(&mut p, "s", 0, 2, 0);
    shared(&mut p, "q0", 0, 1, 0);
    shared(&mut p, "q1", 0, 1, 1);
    let element = Lvalue { slot: 1, indices: vec![ArrayIndex { at: v(0), count: 2, stride: 1 }] };
    let value = Expr::Element(Box::new(element));
    (p, TimeSum { nanos: SECOND, terms: vec![TimeTerm { factor: SECOND, value }] })
}

fn at_least(bound: TimeSum) -> ClockConstraint {
    ClockConstraint { clock: ClockId(0), minus: None, op: ClockOp::Ge, bound }
}

#[test]
fn a_false_guard_protects_the_bounds() {
    let (mut p, bound) = array();
    let mut a = automaton("A", &["x"]);
    let (l, m) = (normal(&mut a, "l"), normal(&mut a, "m"));
    edge(l, l).select(var("k", 0, 2, 0)).set(0, v(3)).to(&mut a);
    let mut guarded = edge(l, m).when(bin(BinaryOp::Lt, v(0), n(2)));
    guarded.0.clock_guard.push(at_least(bound));
    guarded.to(&mut a);
    add(&mut p, a);
    agrees(&p);
}

#[test]
fn a_false_invariant_protects_its_bounds() {
    let (mut p, bound) = array();
    let mut a = automaton("A", &["x"]);
    let limit = ClockConstraint { op: ClockOp::Le, ..at_least(bound) };
    let l = location(&mut a, "l", LocationKind::Normal, &[limit]);
    a.locations[0].holds = Some(bin(BinaryOp::Lt, v(0), n(2)));
    edge(l, l).select(var("k", 0, 2, 0)).set(0, v(3)).to(&mut a);
    add(&mut p, a);
    agrees(&p);
}

/// `C` is committed and sets `s`, which the guard of `B` divides by.
fn divided(kind: ChannelKind) -> Program {
    let mut p = program();
    shared(&mut p, "s", 0, 2, 0);
    let multi_way = matches!(kind, ChannelKind::MultiWay(_));
    let origin = Span::default();
    p.channels.push(Channel { name: "c".into(), kind, urgent: false, params: Vec::new(), origin });
    let channel = ChannelId(0);
    let accept = || SyncLabel::Accept { channel, args: Vec::<ReceiveArg>::new() };
    let syncs = if multi_way {
        [SyncLabel::Join { channel }, SyncLabel::Join { channel }]
    } else {
        [SyncLabel::Offer { channel, args: Vec::new() }, accept()]
    };
    for (i, sync) in syncs.into_iter().enumerate() {
        let mut a = automaton(["A", "B"][i], &["x"]);
        let (l, m) = (normal(&mut a, "l"), normal(&mut a, "m"));
        let mut e = edge(l, m);
        if i == 1 {
            e = e.when(eq(bin(BinaryOp::Div, n(2), v(0)), n(1)));
        }
        e.0.sync = sync;
        e.to(&mut a);
        add(&mut p, a);
    }
    let mut c = automaton("C", &["x"]);
    let l = location(&mut c, "l", LocationKind::Committed, &[]);
    let m = normal(&mut c, "m");
    edge(l, m).set(0, n(2)).to(&mut c);
    if !multi_way {
        let mut hears = edge(l, m).when(eq(v(0), n(1)));
        hears.0.sync = accept();
        hears.to(&mut c);
    }
    add(&mut p, c);
    p
}

#[test]
fn a_committed_location_forbids_the_fault_of_a_participant() {
    let participant = |i| ChannelParticipant { automaton: AutomatonId(i), optional: false };
    agrees(&divided(ChannelKind::MultiWay(vec![participant(0), participant(1)])));
}

#[test]
fn a_committed_location_forbids_the_fault_of_a_receiver() {
    agrees(&divided(ChannelKind::Broadcast));
    agrees(&divided(ChannelKind::Binary));
}

/// A receiver that binds an argument and asks about it, in a network in which nobody sends.
#[test]
fn a_bound_argument_is_not_asked_for_without_a_sender() {
    let mut p = program();
    shared(&mut p, "s", 0, 2, 0);
    let e = crate::common::event(&mut p, "e", &[hrdsl_ir::Type::Int { lo: 0, hi: 2 }]);
    for name in ["A", "B"] {
        let mut a = automaton(name, &["x"]);
        let (l, m) = (normal(&mut a, "l"), normal(&mut a, "m"));
        if name == "B" {
            edge(l, m).on_args(e, &[ReceiveArg::Bind]).when(bin(BinaryOp::Lt, v(1), n(2))).to(&mut a);
        }
        add(&mut p, a);
    }
    let graph = explore(&p, &p.networks[0], LIMITS).unwrap();
    assert_eq!(asks(&p, &graph), Ok(None));
}

/// A receiver with `x == 0 s` stays away from a broadcast after a difference was compared.
#[test]
fn a_receiver_that_stays_away_has_time_to() {
    let p = crate::dice::network(569, crate::dice::Flavour::Differences);
    agrees(&p);
}

/// The way out of `l` is closed by the time that `l` allows, and would lead to where a bound has no value.
#[test]
fn an_edge_that_cannot_be_taken_is_no_fault_of_a_deadlock() {
    for closed in [clock(0, ClockOp::Gt, 3), clock(0, ClockOp::Ge, 2)] {
        let (mut p, bound) = array();
        let mut a = automaton("A", &["x"]);
        let l = location(&mut a, "l", LocationKind::Normal, &[clock(0, ClockOp::Lt, 2)]);
        let m = location(
            &mut a,
            "m",
            LocationKind::Normal,
            &[ClockConstraint { op: ClockOp::Le, ..at_least(bound) }],
        );
        let mut never = edge(l, m).set(0, n(2));
        never.0.clock_guard.push(closed);
        never.to(&mut a);
        add(&mut p, a);
        agrees(&p);
    }
}

/// The network in which a deadlock's search once told the fault of an edge that is never taken.
#[test]
fn the_invariant_of_a_target_is_looked_at_after_the_guard() {
    agrees(&crate::dice::network(100_819, crate::dice::Flavour::Whole));
}

/// An edge joins what another participant never does: what its guard divides by is asked by nobody.
#[test]
fn a_join_that_cannot_be_is_no_fault() {
    agrees(&crate::dice::network(2_006_480, crate::dice::Flavour::Whole));
    // A committed location that has no part in it forbids it.
    agrees(&crate::dice::network(2_014_692, crate::dice::Flavour::Whole));
}

/// Something can happen within less than a nanosecond after a witness's strict bound, and only then.
#[test]
fn a_state_may_be_alive_for_less_than_a_nanosecond() {
    agrees(&crate::dice::network(1_005_204, crate::dice::Flavour::Channels));
}
