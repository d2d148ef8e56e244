//! Tests: networks with all kinds of synchronisation, explored by the search and by the concrete interpreter.
//!
//! With closed bounds, whole times are enough to reach what can be reached (Henzinger, Manna, Pnueli, "What Good Are Digital
//! Clocks?", ICALP 1992), so the interpreter can explore by itself. Receivers of broadcasts have no clock guards, since that
//! one stays away would be an open bound.

use std::{collections::BTreeSet, ops::ControlFlow};

use hrdsl_ir::{
    Expr, Program, Span,
    expr::{ArrayIndex, BinaryOp, Lvalue},
    suite::{DelayChoice, WitnessKind},
    ta::NetworkId,
    ta::{
        Automaton, AutomatonFunction, AutomatonId, AutomatonVar, Channel, ChannelId, ChannelKind,
        ChannelParticipant, ClockConstraint, ClockId, ClockOp, Edge, EdgeAssignment, FunctionId,
        FunctionStatement, Location, LocationId, LocationKind, Network, Query, QueryFormula, QueryKind,
        ReceiveArg, SyncLabel, TimeSum, TimeTerm,
    },
    value::SECOND,
};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::{
    decide::answer::{QueryOptions, QueryVerdict, answers},
    witness::{concrete::ConcreteInterpreter, error::SearchError, run::WitnessRun},
};

/// Greater than all constants and what clocks are set to.
const CAP: i64 = 6;

fn var(name: &str, lo: i64, hi: i64) -> AutomatonVar {
    AutomatonVar { name: name.into(), lo, hi, init: lo, is_bool: false, enumeration: None }
}

fn q(at: Expr) -> Expr {
    Expr::Element(Box::new(place(at)))
}

fn place(at: Expr) -> Lvalue {
    Lvalue { slot: 0, indices: vec![ArrayIndex { at, count: 2, stride: 1 }] }
}

/// q: (0..2)[2]; front() is q[0]; push(e) moves q[0] to q[1] and sets q[0].
fn base() -> Program {
    let channel = |name: &str, kind, urgent, params: Vec<AutomatonVar>| Channel {
        name: name.into(),
        kind,
        urgent,
        params,
        origin: Span::default(),
    };
    let participant = |n, optional| ChannelParticipant { automaton: AutomatonId(n), optional };
    let all = ChannelKind::MultiWay(vec![participant(1, false), participant(0, false), participant(2, true)]);
    let any = ChannelKind::MultiWay(vec![participant(0, true), participant(2, true)]);
    let function = |name: &str, params: Vec<AutomatonVar>, result, pure, body| AutomatonFunction {
        name: name.into(),
        owner: None,
        params,
        locals: Vec::new(),
        result,
        pure,
        body,
        origin: Span::default(),
    };
    let assign = |at, value| FunctionStatement::Assign { place: place(Expr::int(at)), value };
    Program {
        shared: vec![var("q[0]", 0, 2), var("q[1]", 0, 2)],
        clocks: vec!["g".into()],
        channels: vec![
            channel("shake", ChannelKind::Binary, false, vec![var("k", 0, 1)]),
            channel("hurry", ChannelKind::Binary, true, Vec::new()),
            channel("tell", ChannelKind::Broadcast, false, vec![var("k", 0, 2)]),
            channel("alarm", ChannelKind::Broadcast, true, Vec::new()),
            channel("all", all, false, Vec::new()),
            channel("any", any, true, Vec::new()),
        ],
        functions: vec![
            function(
                "front",
                Vec::new(),
                Some(var("", 0, 2)),
                true,
                vec![FunctionStatement::Return(Some(q(Expr::int(0))))],
            ),
            function(
                "push",
                vec![var("e", 0, 2)],
                None,
                false,
                vec![assign(1, q(Expr::int(0))), assign(0, Expr::Var(2))],
            ),
        ],
        networks: vec![Network {
            name: "net".into(),
            automata: (0..3).map(AutomatonId).collect(),
            origin: Span::default(),
        }],
        ..Program::default()
    }
}

fn time(rng: &mut ChaCha8Rng) -> TimeSum {
    let terms = if rng.random_bool(0.3) {
        let front =
            if rng.random_bool(0.5) { Expr::Apply(FunctionId(0), Vec::new()) } else { q(Expr::int(1)) };
        vec![TimeTerm { factor: SECOND, value: front }]
    } else {
        Vec::new()
    };
    TimeSum { nanos: rng.random_range(0..3) * SECOND, terms }
}

fn constraint(rng: &mut ChaCha8Rng, ops: &[ClockOp]) -> ClockConstraint {
    let op = ops[rng.random_range(0..ops.len())];
    ClockConstraint { clock: ClockId(rng.random_range(0..2)), minus: None, op, bound: time(rng) }
}

fn update(rng: &mut ChaCha8Rng) -> EdgeAssignment {
    match rng.random_range(0..6) {
        0 => EdgeAssignment::Assign {
            place: place(Expr::int(rng.random_range(0..2))),
            value: Expr::int(rng.random_range(0..3)),
        },
        1 => EdgeAssignment::Call { function: FunctionId(1), args: vec![Expr::int(rng.random_range(0..3))] },
        2 => EdgeAssignment::Reset { clock: ClockId(1), from: None, to: time(rng) },
        3 => {
            let by = TimeSum::constant(rng.random_range(0..2) * SECOND);
            EdgeAssignment::Reset { clock: ClockId(1), from: Some(ClockId(0)), to: by }
        }
        4 => EdgeAssignment::zero(ClockId(0)),
        _ => EdgeAssignment::zero(ClockId(1)),
    }
}

fn edge(rng: &mut ChaCha8Rng, me: u16, places: u16) -> Edge {
    let mut e = Edge {
        from: LocationId(rng.random_range(0..places)),
        to: LocationId(rng.random_range(0..places)),
        selects: Vec::new(),
        clock_guard: Vec::new(),
        guard: None,
        sync: SyncLabel::Internal,
        updates: Vec::new(),
        origin: Span::default(),
    };
    let channel = ChannelId(rng.random_range(0..9));
    let offers = rng.random_bool(0.5);
    let mut clocks = true;
    let bound = |offers: bool, args: Vec<Expr>, got: Option<ReceiveArg>| {
        if offers {
            SyncLabel::Offer { channel, args }
        } else {
            SyncLabel::Accept { channel, args: got.into_iter().collect() }
        }
    };
    match channel.0 {
        0 => {
            e.selects = if offers { vec![var("s", 0, 1)] } else { Vec::new() };
            e.sync = bound(offers, vec![Expr::Var(2)], Some(ReceiveArg::Bind));
        }
        2 => {
            e.sync = bound(offers, vec![q(Expr::int(0))], Some(ReceiveArg::Bind));
            clocks = offers;
        }
        1 | 3 => {
            e.sync = bound(offers, Vec::new(), None);
            clocks = false;
        }
        4 => {
            e.sync = SyncLabel::Join { channel };
            clocks = me != 2;
        }
        5 if me != 1 => {
            e.sync = SyncLabel::Join { channel };
            clocks = false;
        }
        _ => {}
    }
    let binds = matches!((channel.0, offers), (0, _) | (2, false));
    if clocks && rng.random_bool(0.6) {
        e.clock_guard.push(constraint(rng, &[ClockOp::Le, ClockOp::Ge, ClockOp::Eq]));
    }
    if rng.random_bool(0.3) {
        let left =
            if binds && rng.random_bool(0.6) { Expr::Var(2) } else { q(Expr::int(rng.random_range(0..2))) };
        let op = [BinaryOp::Eq, BinaryOp::Ne][rng.random_range(0..2)];
        e.guard = Some(Expr::binary(op, left, Expr::int(rng.random_range(0..2))));
    }
    (0..rng.random_range(0..3)).for_each(|_| e.updates.push(update(rng)));
    if binds && rng.random_bool(0.5) {
        e.updates.push(EdgeAssignment::Call { function: FunctionId(1), args: vec![Expr::Var(2)] });
    }
    e
}

fn network(rng: &mut ChaCha8Rng) -> Program {
    let mut p = base();
    for (me, name) in (0..).zip(["P", "Q", "R"]) {
        let places = rng.random_range(2..4u16);
        let locations = (0..places).map(|l| Location {
            name: format!("l{l}"),
            kind: match rng.random_range(0..12) {
                0 => LocationKind::Urgent,
                1 => LocationKind::Committed,
                _ => LocationKind::Normal,
            },
            invariant: if rng.random_bool(0.5) { vec![constraint(rng, &[ClockOp::Le])] } else { Vec::new() },
            holds: rng
                .random_bool(0.15)
                .then(|| Expr::binary(BinaryOp::Ne, q(Expr::int(1)), Expr::int(rng.random_range(1..3)))),
            stopped: Vec::new(),
            origin: Span::default(),
        });
        let locations = locations.collect();
        let edges = (0..rng.random_range(3..8)).map(|_| edge(rng, me, places)).collect();
        p.automata.push(Automaton {
            name: name.into(),
            actor: None,
            clocks: vec!["x".into()],
            vars: Vec::new(),
            locations,
            initial: LocationId(0),
            edges,
            origin: Span::default(),
        });
    }
    p
}

/// The locations that the interpreter reaches in whole times; `None`: the model is at fault, or the start is forbidden.
fn reached(p: &Program) -> Option<BTreeSet<(u16, u16)>> {
    let members: Vec<&Automaton> = p.automata.iter().collect();
    let start = ConcreteInterpreter::new(p, &members, 1);
    if start.broken_invariant().ok()?.is_some() {
        return None;
    }
    let key = |m: &ConcreteInterpreter| {
        let clocks: Vec<i128> = m.clocks();
        (m.location.clone(), m.numbers().iter().map(|n| n.1).collect::<Vec<i64>>(), clocks)
    };
    let (mut seen, mut out) = (BTreeSet::from([key(&start)]), BTreeSet::new());
    let mut waiting = vec![start];
    while let Some(m) = waiting.pop() {
        out.extend((0..).zip(m.location.iter().map(|l| l.0)));
        let mut next = Vec::new();
        let _ = m
            .each_next(&mut |n| {
                next.push(n);
                ControlFlow::Continue(())
            })
            .ok()?;
        if m.may_wait() {
            let mut later = m.clone();
            later.now += i128::from(SECOND);
            if later.broken_invariant().ok()?.is_none() {
                next.push(later);
            }
        }
        for mut n in next {
            n.cap(i128::from(CAP * SECOND));
            if seen.insert(key(&n)) {
                waiting.push(n);
            }
        }
    }
    Some(out)
}

fn queries(p: &Program) -> Vec<((u16, u16), Query)> {
    let places = (0..).zip(&p.automata).flat_map(|(a, m)| (0..m.locations.len() as u16).map(move |l| (a, l)));
    places
        .map(|(automaton, l)| {
            let at = QueryFormula::At { automaton, location: LocationId(l) };
            let query = Query {
                name: String::new(),
                title: String::new(),
                text: String::new(),
                network: NetworkId(0),
                ask: QueryKind::Possibly(at),
                origin: Span::default(),
            };
            ((automaton, l), query)
        })
        .collect()
}

/// All answers; `None`: the model is at fault.
fn runs(p: &Program, options: QueryOptions) -> Option<Vec<(bool, Option<Box<WitnessRun>>)>> {
    let all = queries(p);
    let asked: Vec<&Query> = all.iter().map(|q| &q.1).collect();
    match answers(p, &p.networks[0], &asked, &options) {
        Ok(answers) => Some(answers.into_iter().map(|a| (a.verdict == QueryVerdict::Holds, a.run)).collect()),
        Err(SearchError::Model { .. }) => None,
        Err(SearchError::Internal(e)) => panic!("{e}"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]
    #[test]
    fn the_search_reaches_what_the_interpreter_reaches(seed in any::<u64>()) {
        let p = network(&mut ChaCha8Rng::seed_from_u64(seed));
        let Some(want) = reached(&p) else { return Ok(()) };
        let got = runs(&p, QueryOptions::default());
        prop_assert!(got.is_some(), "seed {}: only the search finds a fault", seed);
        for ((place, _), (reached, run)) in queries(&p).iter().zip(got.unwrap_or_default()) {
            prop_assert_eq!(reached, want.contains(place), "seed {}: {:?}", seed, place);
            prop_assert_eq!(reached, run.is_some());
        }
    }

    /// Each run that is given was replayed.
    #[test]
    fn runs_with_all_options_replay(seed in any::<u64>()) {
        let p = network(&mut ChaCha8Rng::seed_from_u64(seed));
        let go = |witness, delays| runs(&p, QueryOptions { witness, delays, seed, ..QueryOptions::default() });
        let Some(short) = go(WitnessKind::Shortest, DelayChoice::Earliest) else { return Ok(()) };
        let (Some(any), Some(fast)) =
            (go(WitnessKind::Any, DelayChoice::Sampled), go(WitnessKind::Fastest, DelayChoice::Latest)) else { return Ok(()) };
        for ((s, a), f) in short.iter().zip(&any).zip(&fast) {
            prop_assert_eq!(s.0, a.0);
            prop_assert_eq!(s.0, f.0);
            let (Some(s), Some(a), Some(f)) = (&s.1, &a.1, &f.1) else { continue };
            prop_assert!(s.steps.len() <= a.steps.len().min(f.steps.len()), "seed {}", seed);
            prop_assert!(f.end <= s.end.min(a.end), "seed {}: {} {}", seed, f.end, s.end);
        }
    }
}

#[test]
fn most_networks_are_sound_and_some_locations_cannot_be_reached() {
    let (mut sound, mut yes, mut no) = (0, 0, 0);
    for seed in 0..200 {
        let p = network(&mut ChaCha8Rng::seed_from_u64(seed));
        if let Some(all) = runs(&p, QueryOptions::default()) {
            sound += 1;
            yes += all.iter().filter(|r| r.0).count();
            no += all.iter().filter(|r| !r.0).count();
        }
    }
    assert!(sound > 100 && yes > 400 && no > 60, "{sound} {yes} {no}");
}
