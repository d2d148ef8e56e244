//! Binary, multi-way and urgent channels, functions, arrays and clocks set to times, by what can be reached.

mod common;

use common::{
    add, automaton, bin, channel, clock, edge, element, location, n, normal, place, program, shared, v, var,
};
use hrdsl_ir::{
    Expr, Program, Span,
    expr::{BinaryOp, Lvalue},
    ta::{
        AutomatonFunction, AutomatonId, ChannelKind, ChannelParticipant, ClockConstraint, ClockId, ClockOp,
        EdgeAssignment, FunctionId, FunctionStatement, LocationKind, TimeSum, TimeTerm,
    },
    value::SECOND,
};
use hrdsl_ta::{CompiledNetwork, ObservationOptions, SearchError, SearchOptions, SearchReport, explore};

fn search(p: &Program, options: &SearchOptions) -> Result<SearchReport, SearchError> {
    let model = CompiledNetwork::new(p, &p.networks[0], &ObservationOptions::default())?;
    explore(&model, &[], options, &|_| true)
}

/// How many discrete states can be reached, by all ways of searching.
fn discrete(p: &Program) -> usize {
    let reference = search(p, &SearchOptions::reference()).unwrap();
    let kept = search(p, &SearchOptions { reduce: false, ..SearchOptions::default() }).unwrap();
    assert_eq!(reference.discrete_states, kept.discrete_states);
    reference.discrete_states
}

fn fault(p: &Program) -> String {
    match search(p, &SearchOptions::default()) {
        Err(SearchError::Model { error, .. }) => error.to_string(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_binary_synchronisation_needs_two_and_the_same_arguments() {
    let mut p = program();
    let c = channel(&mut p, "c", ChannelKind::Binary, &[(0, 3)]);
    let mut a = automaton("A", &[]);
    let l = [normal(&mut a, "a"), normal(&mut a, "b"), normal(&mut a, "c")];
    edge(l[0], l[1]).offer(c, &[n(1)]).to(&mut a);
    edge(l[0], l[2]).offer(c, &[n(2)]).to(&mut a);
    // Nobody shakes hands with itself.
    edge(l[0], l[2]).accept(c, &[1]).to(&mut a);
    add(&mut p, a);
    let mut b = automaton("B", &[]);
    b.vars.push(var("got", 0, 3, 0));
    let l = [normal(&mut b, "a"), normal(&mut b, "b")];
    // The binder follows the own variable.
    edge(l[0], l[1]).bind(c).when(bin(BinaryOp::Lt, v(1), n(2))).set(0, v(1)).to(&mut b);
    add(&mut p, b);
    assert_eq!(discrete(&p), 2);
}

#[test]
fn an_argument_outside_its_range_is_a_fault() {
    let mut p = program();
    let c = channel(&mut p, "c", ChannelKind::Binary, &[(0, 3)]);
    let mut a = automaton("A", &[]);
    let l = normal(&mut a, "a");
    edge(l, l).offer(c, &[n(4)]).to(&mut a);
    add(&mut p, a);
    assert_eq!(fault(&p), "automaton `A`, edge a -> a: argument `p` of `c` is 4");
}

/// B must join, C may; A's edge waits for a variable.
fn multi_way(optional: bool, clock_of_c: i64) -> Program {
    let mut p = program();
    let participant =
        |automaton, optional| ChannelParticipant { automaton: AutomatonId(automaton), optional };
    let participants = vec![participant(0, false), participant(1, optional)];
    let go = channel(&mut p, "go", ChannelKind::MultiWay(participants), &[]);
    let mut a = automaton("A", &["x"]);
    let l = [location(&mut a, "a", LocationKind::Normal, &[clock(0, ClockOp::Le, 3)]), normal(&mut a, "b")];
    edge(l[0], l[1]).join(go).to(&mut a);
    add(&mut p, a);
    let mut b = automaton("B", &["y"]);
    let l = [normal(&mut b, "a"), normal(&mut b, "b")];
    edge(l[0], l[1]).join(go).clock(0, ClockOp::Ge, clock_of_c).to(&mut b);
    add(&mut p, b);
    p
}

#[test]
fn a_multi_way_channel_waits_for_who_must_take_part() {
    // Start and both gone on.
    assert_eq!(discrete(&multi_way(false, 2)), 2);
    // B comes too late.
    assert_eq!(discrete(&multi_way(false, 4)), 1);
    // With or without B.
    assert_eq!(discrete(&multi_way(true, 2)), 3);
    assert_eq!(discrete(&multi_way(true, 4)), 2);
    // B could always take part: it must.
    assert_eq!(discrete(&multi_way(true, 0)), 2);
}

#[test]
fn an_urgent_channel_stops_time_when_it_is_possible() {
    for (urgent, states) in [(true, 2), (false, 3)] {
        let mut p = program();
        let c = channel(&mut p, "c", ChannelKind::Binary, &[]);
        p.channels[0].urgent = urgent;
        let mut a = automaton("A", &["x"]);
        let l = [normal(&mut a, "a"), normal(&mut a, "b"), normal(&mut a, "late")];
        edge(l[0], l[1]).offer(c, &[]).to(&mut a);
        edge(l[0], l[2]).clock(0, ClockOp::Ge, 1).to(&mut a);
        add(&mut p, a);
        let mut b = automaton("B", &[]);
        let l = normal(&mut b, "a");
        edge(l, l).accept(c, &[]).to(&mut b);
        add(&mut p, b);
        assert_eq!(discrete(&p), states);
    }
}

#[test]
fn clocks_are_set_to_times_and_compared_with_variables() {
    let mut p = program();
    let k = shared(&mut p, "k", 0, 3, 2);
    p.clocks.push("total".into());
    let mut a = automaton("A", &["x"]);
    let (total, x) = (ClockId(0), ClockId(1));
    let l = [normal(&mut a, "a"), normal(&mut a, "b"), normal(&mut a, "c"), normal(&mut a, "d")];
    let scaled = |factor: i64, nanos: i64| TimeSum {
        nanos: nanos * SECOND,
        terms: vec![TimeTerm { factor: factor * SECOND, value: v(k) }],
    };
    // x = 2 k + 1 = 5 while total is at most 1.
    let mut set = edge(l[0], l[1]).clock(0, ClockOp::Le, 1);
    set.0.updates.push(EdgeAssignment::Reset { clock: x, from: None, to: scaled(2, 1) });
    set.to(&mut a);
    // x - total is 5 - total's value then, so at most 5 and at least 4: x >= 3 k + 1 = 7 needs total >= 2.
    let at = |clock, op, bound| ClockConstraint { clock, minus: None, op, bound };
    let mut on = edge(l[1], l[2]);
    on.0.clock_guard.push(at(x, ClockOp::Ge, scaled(3, 1)));
    on.0.clock_guard.push(at(total, ClockOp::Lt, TimeSum::constant(2 * SECOND)));
    on.to(&mut a);
    let mut copied = edge(l[1], l[3]);
    copied.0.clock_guard.push(at(x, ClockOp::Ge, scaled(3, 1)));
    copied.0.clock_guard.push(at(total, ClockOp::Le, TimeSum::constant(2 * SECOND)));
    copied.0.updates.push(EdgeAssignment::Reset {
        clock: total,
        from: Some(x),
        to: TimeSum::constant(-7 * SECOND),
    });
    copied.to(&mut a);
    add(&mut p, a);
    assert_eq!(discrete(&p), 3);
}

#[test]
fn a_negative_clock_is_a_fault_where_it_can_be_one() {
    let model = |least: i64| {
        let mut p = program();
        let mut a = automaton("A", &["x", "y"]);
        let l = normal(&mut a, "a");
        let mut e = edge(l, l).clock(0, ClockOp::Ge, least).clock(0, ClockOp::Le, 5);
        let to = TimeSum::constant(-2 * SECOND);
        e.0.updates.push(EdgeAssignment::Reset { clock: ClockId(1), from: Some(ClockId(0)), to });
        e.to(&mut a);
        add(&mut p, a);
        p
    };
    assert_eq!(fault(&model(1)), "automaton `A`, edge a -> a: the clock `A.y` becomes less than zero");
    assert_eq!(discrete(&model(2)), 1);
}

/// `fn sum() -> 0..limit { s = 0; for i in 0..2 { s += q[i] } return s }`
fn sum(limit: i64) -> AutomatonFunction {
    let add = bin(BinaryOp::Add, v(4), element(0, v(5), 3));
    AutomatonFunction {
        name: "sum".into(),
        owner: None,
        params: Vec::new(),
        locals: vec![var("s", 0, 9, 0), var("i", 0, 2, 0)],
        result: Some(var("", 0, limit, 0)),
        pure: true,
        body: vec![
            FunctionStatement::For {
                slot: 5,
                lo: n(0),
                hi: n(2),
                body: vec![FunctionStatement::Assign { place: Lvalue::slot(4), value: add }],
            },
            FunctionStatement::Return(Some(v(4))),
        ],
        origin: Span::default(),
    }
}

#[test]
fn functions_and_arrays_have_values_or_faults() {
    let mut p = program();
    for i in 0..3 {
        shared(&mut p, &format!("q{i}"), 0, 3, 0);
    }
    let at = shared(&mut p, "at", 0, 3, 0);
    p.functions.push(sum(9));
    let mut a = automaton("A", &[]);
    let l = normal(&mut a, "a");
    let total = || Expr::Apply(FunctionId(0), Vec::new());
    let more = edge(l, l).when(bin(BinaryOp::Lt, total(), n(3)));
    more.put(place(0, v(at), 3), bin(BinaryOp::Add, element(0, v(at), 3), n(1))).to(&mut a);
    edge(l, l).when(bin(BinaryOp::Lt, v(at), n(2))).set(at, bin(BinaryOp::Add, v(at), n(1))).to(&mut a);
    add(&mut p, a);
    // All ways to put at most three things into three places, up to the place where `at` is.
    let ways = (0..3).map(|at| (0..=3_usize).map(|k| ways(k, at)).sum::<usize>()).sum::<usize>();
    assert_eq!(discrete(&p), ways);
    p.automata[0].edges[1].guard = None;
    assert_eq!(fault(&p), "automaton `A`, edge a -> a: index 3 is none of 0..2");
    p.functions[0].body.insert(0, FunctionStatement::While { condition: Expr::bool(true), body: Vec::new() });
    assert_eq!(fault(&p), "automaton `A`, edge a -> a: a function does not end");
}

/// To put `k` things into the places `0..=last`.
fn ways(k: usize, last: usize) -> usize {
    if last == 0 { 1 } else { (0..=k).map(|here| ways(k - here, last - 1)).sum() }
}

#[test]
fn what_nothing_reads_is_left_out() {
    let mut p = program();
    let seen = shared(&mut p, "seen", 0, 7, 0);
    let mut a = automaton("A", &[]);
    let l = normal(&mut a, "a");
    edge(l, l).select(var("k", 0, 7, 0)).set(seen, v(1)).to(&mut a);
    add(&mut p, a);
    assert_eq!(discrete(&p), 8);
    assert_eq!(search(&p, &SearchOptions::default()).unwrap().discrete_states, 1);
    // But not what may leave its range: that is an answer.
    p.shared[0].hi = 6;
    let found = fault(&p);
    assert_eq!(found, "automaton `A`, edge a -> a: `seen` becomes 7, outside 0..6");
}
