//! A single automaton in virtual time.

mod common;

use common::{add, automaton, bin, clock, edge, event, location, n, normal, program, v, var};
use hrdsl_ir::{
    EventId, Nanos, Program, Type, Value,
    expr::BinaryOp,
    ta::{AutomatonId, ClockOp, LocationId, LocationKind, ReceiveArg},
    value::SECOND,
};
use hrdsl_ta::{ModelError, VirtualTimePlayer};

struct Robot {
    p: Program,
    request: EventId,
    offer: EventId,
    timeout: EventId,
}

/// Waits for a request, offers after 2 s (strictly), times out after 10 s.
fn robot() -> Robot {
    let mut p = program();
    let request = event(&mut p, "request", &[Type::Int { lo: 0, hi: 9 }]);
    let offer = event(&mut p, "offer", &[Type::Int { lo: 0, hi: 9 }]);
    let timeout = event(&mut p, "timeout", &[]);
    let mut a = automaton("Robot", &["x"]);
    a.vars.push(var("legs", 0, 3, 0));
    let idle = normal(&mut a, "idle");
    let busy = location(&mut a, "busy", LocationKind::Normal, &[clock(0, ClockOp::Le, 5)]);
    let wait = location(&mut a, "wait", LocationKind::Normal, &[clock(0, ClockOp::Le, 10)]);
    let more = bin(BinaryOp::Add, v(0), v(1));
    edge(idle, busy).on_args(request, &[ReceiveArg::Bind]).reset(0).set(0, more).to(&mut a);
    edge(busy, wait).clock(0, ClockOp::Gt, 2).send_args(offer, &[v(0)]).reset(0).to(&mut a);
    edge(wait, idle).clock(0, ClockOp::Ge, 10).send(timeout).to(&mut a);
    add(&mut p, a);
    Robot { p, request, offer, timeout }
}

/// Runs the player as a harness would: whenever it wants to wake, up to a time.
fn play(player: &mut VirtualTimePlayer, until: Nanos) -> Vec<(Nanos, EventId, Vec<Value>)> {
    let mut log = Vec::new();
    while let Some(t) = player.next_wake().filter(|&t| t <= until) {
        let mut out = Vec::new();
        player.run(t, &mut out).unwrap();
        log.extend(out.into_iter().map(|(e, args)| (t, e, args)));
    }
    log
}

#[test]
fn plays_as_early_as_the_model_lets_it() {
    let r = robot();
    let mut player = VirtualTimePlayer::new(&r.p, AutomatonId(0));
    assert_eq!(player.next_wake(), None);
    player.receive(r.request, &[Value::Int(2)], 3 * SECOND).unwrap();
    assert_eq!((player.location(), player.variable(0)), (Some(LocationId(1)), Some(Value::Int(2))));
    let offered = 5 * SECOND + 1;
    assert_eq!(player.next_wake(), Some(offered));
    assert_eq!(
        play(&mut player, 100 * SECOND),
        [(offered, r.offer, vec![Value::Int(2)]), (offered + 10 * SECOND, r.timeout, vec![])]
    );
    // An event that no edge is for is not seen.
    player.receive(r.offer, &[Value::Int(2)], 101 * SECOND).unwrap();
    assert_eq!(player.location(), Some(LocationId(0)));
}

#[test]
fn a_missed_deadline_is_a_timelock() {
    let r = robot();
    let mut player = VirtualTimePlayer::new(&r.p, AutomatonId(0));
    player.receive(r.request, &[Value::Int(1)], 0).unwrap();
    let late = player.run(6 * SECOND, &mut Vec::new());
    assert_eq!(late, Err(ModelError::Timelock { automaton: "Robot".into(), location: "busy".into() }));
}

#[test]
fn a_range_is_kept() {
    let r = robot();
    let mut player = VirtualTimePlayer::new(&r.p, AutomatonId(0));
    let over = player.receive(r.request, &[Value::Int(4)], 0);
    assert!(matches!(over, Err(ModelError::Range { value: 4, .. })));
}

#[test]
fn edges_without_end_are_noticed() {
    let mut p = program();
    let mut a = automaton("A", &[]);
    let l = normal(&mut a, "l");
    edge(l, l).to(&mut a);
    add(&mut p, a);
    let mut player = VirtualTimePlayer::new(&p, AutomatonId(0));
    assert_eq!(player.next_wake(), Some(0));
    assert!(matches!(player.run(0, &mut Vec::new()), Err(ModelError::Zeno { .. })));
}

#[test]
fn an_upper_bound_alone_fires_at_once_and_the_first_edge_wins() {
    let mut p = program();
    let mut a = automaton("A", &["x"]);
    let l: Vec<LocationId> = ["a", "b", "c", "d"].map(|name| normal(&mut a, name)).into();
    edge(l[0], l[1]).clock(0, ClockOp::Ge, 4).to(&mut a);
    edge(l[0], l[2]).clock(0, ClockOp::Lt, 3).to(&mut a);
    edge(l[2], l[3]).clock(0, ClockOp::Ge, 5).to(&mut a);
    edge(l[2], l[1]).clock(0, ClockOp::Ge, 5).to(&mut a);
    add(&mut p, a);
    let mut player = VirtualTimePlayer::new(&p, AutomatonId(0));
    assert_eq!(player.next_wake(), Some(0));
    player.run(0, &mut Vec::new()).unwrap();
    assert_eq!((player.location(), player.next_wake()), (Some(l[2]), Some(5 * SECOND)));
    player.run(5 * SECOND, &mut Vec::new()).unwrap();
    assert_eq!(player.location(), Some(l[3]));
}

#[test]
fn an_invariant_or_urgency_hides_later_edges() {
    let mut p = program();
    let mut a = automaton("A", &["x"]);
    let b = location(&mut a, "b", LocationKind::Normal, &[clock(0, ClockOp::Lt, 3)]);
    let c = location(&mut a, "c", LocationKind::Urgent, &[]);
    edge(b, c).clock(0, ClockOp::Ge, 3).to(&mut a);
    edge(c, b).clock(0, ClockOp::Ge, 9).to(&mut a);
    add(&mut p, a);
    assert_eq!(VirtualTimePlayer::new(&p, AutomatonId(0)).next_wake(), None);
    p.automata[0].initial = c;
    assert_eq!(VirtualTimePlayer::new(&p, AutomatonId(0)).next_wake(), None);
}

#[test]
fn the_target_s_invariant_is_waited_for() {
    // b asks for y <= 1 and the edge resets x only: too late after a second.
    let mut p = program();
    let mut a = automaton("A", &["x", "y"]);
    let start = normal(&mut a, "a");
    let b = location(&mut a, "b", LocationKind::Normal, &[clock(1, ClockOp::Le, 1)]);
    edge(start, b).clock(0, ClockOp::Ge, 2).reset(0).to(&mut a);
    add(&mut p, a);
    let mut player = VirtualTimePlayer::new(&p, AutomatonId(0));
    assert_eq!(player.next_wake(), None);
    player.run(2 * SECOND, &mut Vec::new()).unwrap();
    assert_eq!(player.location(), Some(start));
}

#[test]
fn selects_take_the_first_that_the_guard_allows_or_are_drawn() {
    let mut p = program();
    let pick = event(&mut p, "pick", &[Type::Int { lo: 0, hi: 9 }]);
    let mut a = automaton("A", &[]);
    let (l, m) = (normal(&mut a, "l"), normal(&mut a, "m"));
    let high = bin(BinaryOp::Ge, v(0), n(3));
    edge(l, m).select(var("k", 0, 9, 0)).when(high).send_args(pick, &[v(0)]).to(&mut a);
    add(&mut p, a);
    let picked = |mut player: VirtualTimePlayer| {
        let mut out = Vec::new();
        player.run(0, &mut out).unwrap();
        out[0].1[0].as_int().unwrap()
    };
    assert_eq!(picked(VirtualTimePlayer::new(&p, AutomatonId(0))), 3);
    let drawn: Vec<i64> =
        (0..40).map(|seed| picked(VirtualTimePlayer::seeded(&p, AutomatonId(0), seed))).collect();
    assert_eq!(drawn[7], picked(VirtualTimePlayer::seeded(&p, AutomatonId(0), 7)));
    assert!(drawn.iter().all(|k| (3..=9).contains(k)));
    assert!(drawn.iter().collect::<std::collections::BTreeSet<_>>().len() > 3);
}

#[test]
fn an_automaton_that_is_not_there_is_an_error() {
    let p = program();
    let mut player = VirtualTimePlayer::new(&p, AutomatonId(3));
    assert_eq!(player.next_wake(), None);
    assert!(matches!(player.run(0, &mut Vec::new()), Err(ModelError::Malformed { .. })));
}

#[test]
fn alone_it_takes_no_binary_synchronisation_and_a_broadcast_offer_as_internal() {
    use hrdsl_ir::{
        Expr, Span,
        ta::{
            Channel, ChannelId, ChannelKind, ChannelParticipant, ClockId, EdgeAssignment, SyncLabel, TimeSum,
            TimeTerm,
        },
    };
    let mut p = program();
    p.clocks.push("g".into());
    let kinds = [
        ChannelKind::Binary,
        ChannelKind::MultiWay(vec![ChannelParticipant { automaton: AutomatonId(0), optional: true }]),
        ChannelKind::Broadcast,
    ];
    p.channels = kinds
        .map(|kind| Channel {
            name: "c".into(),
            kind,
            urgent: false,
            params: Vec::new(),
            origin: Span::default(),
        })
        .into();
    let done = event(&mut p, "done", &[]);
    // Clock 0 is the shared one.
    let mut a = automaton("A", &["x"]);
    a.vars.push(var("n", 0, 5, 2));
    let l: Vec<LocationId> = ["a", "b", "c", "d"].map(|name| normal(&mut a, name)).into();
    let channel = |c: u16, e: common::E, offer: bool| {
        let mut e = e;
        let channel = ChannelId(c);
        e.0.sync =
            if offer { SyncLabel::Offer { channel, args: Vec::new() } } else { SyncLabel::Join { channel } };
        e
    };
    channel(0, edge(l[0], l[3]), true).to(&mut a);
    channel(1, edge(l[0], l[3]), false).to(&mut a);
    let mut offer = channel(2, edge(l[0], l[1]), true).clock(0, ClockOp::Ge, 0);
    // g >= n * 1 s; then x = g + 1 s.
    offer.0.clock_guard[0].bound =
        TimeSum { nanos: 0, terms: vec![TimeTerm { factor: SECOND, value: Expr::Var(0) }] };
    offer.0.updates.push(EdgeAssignment::Reset {
        clock: ClockId(1),
        from: Some(ClockId(0)),
        to: TimeSum::constant(SECOND),
    });
    offer.to(&mut a);
    edge(l[1], l[2]).clock(1, ClockOp::Ge, 7).send(done).to(&mut a);
    add(&mut p, a);
    let mut player = VirtualTimePlayer::new(&p, AutomatonId(0));
    assert_eq!(player.next_wake(), Some(2 * SECOND));
    // x is 3 s at 2 s, so it is 7 s at 6 s.
    assert_eq!(play(&mut player, 100 * SECOND), [(6 * SECOND, done, vec![])]);
}

#[test]
fn an_invariant_over_variables_forbids_an_edge() {
    let mut p = program();
    let mut a = automaton("A", &[]);
    a.vars.push(var("n", 0, 3, 0));
    let (start, end) = (normal(&mut a, "a"), normal(&mut a, "b"));
    a.locations[1].holds = Some(bin(BinaryOp::Gt, v(0), n(1)));
    edge(start, end).set(0, n(1)).to(&mut a);
    edge(start, end).set(0, n(2)).to(&mut a);
    add(&mut p, a);
    let mut player = VirtualTimePlayer::new(&p, AutomatonId(0));
    player.run(0, &mut Vec::new()).unwrap();
    assert_eq!((player.location(), player.variable(0)), (Some(end), Some(Value::Int(2))));
}
