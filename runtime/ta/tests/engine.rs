//! Counters, limits, settled goals, faults, budgets and witnesses of the search.

mod common;

use common::{add, automaton, bin, clock, edge, event, location, n, normal, program, shared, v, var};
use hrdsl_ir::{
    ArgPattern, Enumeration, EventId, EventPattern, Expr, Program, Symbol, Type, Value,
    expr::BinaryOp,
    ta::{
        AutomatonId, ClockConstraint, ClockId, ClockOp, EdgeAssignment, LocationId, LocationKind, ReceiveArg,
    },
    value::SECOND,
};
use hrdsl_ta::{
    CompiledNetwork, EventCounter, EventLimit, GoalKind, GoalOutcome, ModelError, ObservationOptions,
    ReachabilityGoal, SearchBudget, SearchCutoff, SearchError, SearchOptions, SearchReport, StateFormula,
    WitnessRun, check, explore, slot_names,
};

fn condition(f: StateFormula) -> ReachabilityGoal {
    ReachabilityGoal { what: GoalKind::Condition(f), settled: false }
}

fn at(automaton: usize, location: u16) -> ReachabilityGoal {
    ReachabilityGoal {
        what: GoalKind::Location { automaton, location: LocationId(location) },
        settled: false,
    }
}

fn pattern(event: EventId, arg: Option<bool>) -> EventPattern {
    let args = vec![arg.map_or(ArgPattern::Any, |b| ArgPattern::Is(Value::Bool(b)))];
    EventPattern { event, args }
}

fn search(
    p: &Program,
    goals: &[ReachabilityGoal],
    counters: &[EventCounter],
    limits: &[EventLimit],
) -> Result<SearchReport, SearchError> {
    check(p, &p.networks[0], goals, counters, limits, SearchBudget::default())
}

fn reached(outcome: &GoalOutcome) -> &WitnessRun {
    match outcome {
        GoalOutcome::Reached(w) => w,
        GoalOutcome::Unreachable | GoalOutcome::Inconclusive(_) => panic!("{outcome:?}"),
    }
}

/// One automaton that decides yes or no every two seconds; another counts the yes in a variable of its own.
fn decider() -> (Program, EventId) {
    let mut p = program();
    let e = event(&mut p, "decided", &[Type::Bool]);
    let mut a = automaton("Decider", &["x"]);
    let l = location(&mut a, "think", LocationKind::Normal, &[clock(0, ClockOp::Le, 2)]);
    let mut choice = var("ready", 0, 1, 0);
    choice.is_bool = true;
    edge(l, l).clock(0, ClockOp::Ge, 2).select(choice).send_args(e, &[v(0)]).reset(0).to(&mut a);
    add(&mut p, a);
    let mut b = automaton("Tally", &[]);
    b.vars.push(var("yes", 0, 3, 0));
    let (l, brief) = (normal(&mut b, "listen"), location(&mut b, "brief", LocationKind::Committed, &[]));
    let yes = ReceiveArg::Match(ArgPattern::Is(Value::Bool(true)));
    let room = || bin(BinaryOp::Lt, v(0), n(3));
    edge(l, brief).on_args(e, &[yes]).when(room()).set(0, bin(BinaryOp::Add, v(0), n(1))).to(&mut b);
    edge(brief, l).to(&mut b);
    add(&mut p, b);
    (p, e)
}

#[test]
fn counters_saturate_and_make_conditions() {
    let (p, e) = decider();
    let counters = [
        EventCounter { patterns: vec![pattern(e, Some(true))], cap: 3 },
        EventCounter { patterns: vec![pattern(e, Some(false))], cap: 2 },
    ];
    let counted = |counter, lo, hi| StateFormula::CounterIn { counter, lo, hi };
    let goals = [
        condition(StateFormula::And(vec![counted(0, 3, None), counted(1, 1, Some(1))])),
        condition(StateFormula::And(vec![
            counted(0, 2, Some(2)),
            StateFormula::Not(Box::new(StateFormula::Data(bin(BinaryOp::Eq, v(0), n(2))))),
        ])),
    ];
    let report = search(&p, &goals, &counters, &[]).unwrap();
    assert_eq!(slot_names(&p, &p.networks[0]), ["Tally.yes"]);
    let w = reached(&report.goals[0]);
    // Four decisions, two seconds each; the last leaves the tally in its committed location.
    let times: Vec<i64> = w.trace().steps.iter().map(|s| s.time / SECOND).collect();
    assert_eq!(times, [2, 4, 6, 8]);
    assert_eq!(report.goals[1], GoalOutcome::Unreachable);
    assert!(report.complete);
}

#[test]
fn a_counter_that_stops_too_early_is_refused() {
    let (p, e) = decider();
    let counters = [EventCounter { patterns: vec![pattern(e, None)], cap: 2 }];
    for (lo, hi) in [(3, None), (0, Some(2))] {
        let goal = condition(StateFormula::CounterIn { counter: 0, lo, hi });
        let found = search(&p, &[goal], &counters, &[]);
        assert!(matches!(found, Err(SearchError::Model { error: ModelError::Question(_), .. })));
    }
}

#[test]
fn limits_restrict_what_happens() {
    let (p, e) = decider();
    let yes = || pattern(e, Some(true));
    let counters = [EventCounter { patterns: vec![yes()], cap: 3 }];
    let goal = |lo| condition(StateFormula::CounterIn { counter: 0, lo, hi: None });
    let limits = [EventLimit { patterns: vec![yes()], at_most: 2 }];
    let report = search(&p, &[goal(2), goal(3)], &counters, &limits).unwrap();
    reached(&report.goals[0]);
    assert_eq!(report.goals[1], GoalOutcome::Unreachable);
}

#[test]
fn settled_goals_wait_until_no_location_is_committed() {
    let (p, _) = decider();
    let one = StateFormula::Data(bin(BinaryOp::Eq, v(0), n(1)));
    let goals = [
        condition(one.clone()),
        ReachabilityGoal { what: GoalKind::Condition(one), settled: true },
        at(1, 1),
    ];
    let settled_brief = ReachabilityGoal { settled: true, ..at(1, 1) };
    let goals = [goals.as_slice(), &[settled_brief]].concat();
    let report = search(&p, &goals, &[], &[]).unwrap();
    assert_eq!(reached(&report.goals[0]).steps.len(), 1);
    assert_eq!(reached(&report.goals[1]).steps.len(), 2);
    assert_eq!(reached(&report.goals[2]).steps.len(), 1);
    assert_eq!(report.goals[3], GoalOutcome::Unreachable);
}

#[test]
fn a_witness_reads_well() {
    let (p, _) = decider();
    let goal = ReachabilityGoal { what: GoalKind::Edge { automaton: 1, edge: 1 }, settled: false };
    let report = search(&p, &[goal], &[], &[]).unwrap();
    assert_eq!(
        reached(&report.goals[0]).text(&p, &p.networks[0]),
        "2 s  Decider  decided(true)  stays in think, Tally: listen -> brief   [Tally.yes: 0 -> 1; Decider.x = 0]\n\
         \x20      Decider: think -> think with ready = true\n\
         2 s  Tally                   brief -> listen\n"
    );
}

#[test]
fn leaving_a_range_is_a_fault_with_the_way_to_it() {
    let mut p = program();
    let count = shared(&mut p, "count", 0, 2, 0);
    let mut a = automaton("A", &["x"]);
    let l = normal(&mut a, "l");
    let up = edge(l, l).clock(0, ClockOp::Eq, 3).reset(0);
    up.set(count, bin(BinaryOp::Add, v(count), n(1))).to(&mut a);
    add(&mut p, a);
    let Err(SearchError::Model { error, witness }) = search(&p, &[], &[], &[]) else { panic!("no fault") };
    assert_eq!(error.to_string(), "automaton `A`, edge l -> l: `count` becomes 3, outside 0..2");
    assert_eq!(witness.unwrap().steps.iter().map(|s| s.time).collect::<Vec<_>>(), [3 * SECOND, 6 * SECOND]);
}

#[test]
fn the_run_to_a_fault_ends_when_it_happens() {
    let mut p = program();
    let mut a = automaton("A", &["x", "y"]);
    let (l, m) = (normal(&mut a, "l"), normal(&mut a, "m"));
    edge(l, m).clock(0, ClockOp::Ge, 1).reset(1).to(&mut a);
    // Two seconds later at the earliest, and `y` is not yet 4 s then.
    let mut back = edge(m, m).clock(0, ClockOp::Ge, 3);
    let to = hrdsl_ir::ta::TimeSum::constant(-4 * SECOND);
    back.0.updates.push(EdgeAssignment::Reset { clock: ClockId(0), from: Some(ClockId(1)), to });
    back.to(&mut a);
    add(&mut p, a);
    let Err(SearchError::Model { error, witness }) = search(&p, &[], &[], &[]) else { panic!("no fault") };
    assert_eq!(error.to_string(), "automaton `A`, edge m -> m: the clock `A.x` becomes less than zero");
    let witness = witness.unwrap();
    assert_eq!((witness.steps.len(), witness.end / witness.ticks), (1, 3 * SECOND));
}

/// `x` is set to `y - 1`; nothing but that asks for `y`. After `y >= 2` it never makes `x` negative.
fn set_back(first: i64) -> Program {
    let mut p = program();
    let mut a = automaton("A", &["x", "y"]);
    let [l, m, k] = ["l", "m", "k"].map(|name| normal(&mut a, name));
    edge(l, m).clock(1, ClockOp::Ge, first).to(&mut a);
    edge(m, m).clock(0, ClockOp::Ge, 1).reset(0).to(&mut a);
    let mut back = edge(m, k);
    let to = hrdsl_ir::ta::TimeSum::constant(-SECOND);
    back.0.updates.push(EdgeAssignment::Reset { clock: ClockId(0), from: Some(ClockId(1)), to });
    back.to(&mut a);
    edge(k, k).clock(0, ClockOp::Ge, 1).to(&mut a);
    add(&mut p, a);
    p
}

#[test]
fn a_clock_that_is_set_back_is_known_well_enough() {
    let network = |p: &Program, options: &SearchOptions| {
        let model = CompiledNetwork::new(p, &p.networks[0], &ObservationOptions::default()).unwrap();
        explore(&model, &[], options, &|_| true)
    };
    let all = [SearchOptions::default(), SearchOptions::reference(), SearchOptions::shortest()];
    for options in all {
        assert!(network(&set_back(2), &options).unwrap().complete);
        // One second after the start `y` is 1 s, and before that less.
        let Err(SearchError::Model { error, witness }) = network(&set_back(0), &options) else {
            panic!("no fault")
        };
        assert_eq!(error.to_string(), "automaton `A`, edge m -> k: the clock `A.x` becomes less than zero");
        assert_eq!(witness.unwrap().end, 0);
    }
}

#[test]
fn a_fault_that_no_time_allows_is_none() {
    let mut p = program();
    let count = shared(&mut p, "count", 0, 2, 0);
    let mut a = automaton("A", &["x"]);
    let l = location(&mut a, "l", LocationKind::Normal, &[clock(0, ClockOp::Le, 2)]);
    edge(l, l).clock(0, ClockOp::Gt, 2).set(count, n(9)).to(&mut a);
    add(&mut p, a);
    assert!(search(&p, &[], &[], &[]).unwrap().complete);
}

#[test]
fn what_the_budget_leaves_is_open() {
    let (p, _) = decider();
    let yes = |k| condition(StateFormula::Data(bin(BinaryOp::Ge, v(0), n(k))));
    let goals = [yes(1), yes(3)];
    for (budget, why) in [
        (SearchBudget { states: 3, ..SearchBudget::default() }, SearchCutoff::States),
        (SearchBudget { bytes: 150, ..SearchBudget::default() }, SearchCutoff::Memory),
    ] {
        let report = check(&p, &p.networks[0], &goals, &[], &[], budget).unwrap();
        assert_eq!(report.goals[1], GoalOutcome::Inconclusive(why));
        assert_eq!(report.widest, None);
        assert!(!report.complete);
    }
}

#[test]
fn a_budget_that_ends_names_the_int_that_has_the_most_values() {
    let mut p = program();
    let few = shared(&mut p, "few", 0, 3, 0);
    let mut a = automaton("A", &["x"]);
    a.vars.push(var("many", -5, 1000, -5));
    let (many, l) = (few + 1, normal(&mut a, "l"));
    let up = |slot, most| {
        let below = bin(BinaryOp::Lt, v(slot), n(most));
        edge(l, l).clock(0, ClockOp::Ge, 1).when(below).set(slot, bin(BinaryOp::Add, v(slot), n(1))).reset(0)
    };
    up(few, 3).to(&mut a);
    up(many, 1000).to(&mut a);
    add(&mut p, a);
    // With an equality it is a part of the discrete state, without one it is a counter.
    for test in [BinaryOp::Eq, BinaryOp::Lt] {
        let goals = [condition(StateFormula::And(vec![
            StateFormula::Data(bin(test, v(many), n(-1))),
            StateFormula::Data(bin(BinaryOp::Gt, v(few), n(3))),
        ]))];
        let budget = SearchBudget { states: 20, ..SearchBudget::default() };
        let options = SearchOptions { budget, ..SearchOptions::shortest() };
        let model = CompiledNetwork::new(&p, &p.networks[0], &ObservationOptions::default()).unwrap();
        let report = explore(&model, &goals, &options, &|_| true).unwrap();
        if report.complete {
            // Of each value of `few` one state, with the least of `many`.
            assert_eq!((test, report.states_stored), (BinaryOp::Lt, 4));
            continue;
        }
        let widest = report.widest.unwrap().to_string();
        assert!(widest.starts_with("`A.many` has the most values so far, from -5 to "), "{widest}");
    }
}

#[test]
fn strict_bounds_in_a_tiny_unit_need_finer_ticks() {
    // Two strict bounds within one nanosecond: 0 < t1 < t2 < 1 ns.
    let mut p = program();
    let mut a = automaton("A", &["x", "y"]);
    let nano = |clock, op, bound| ClockConstraint {
        clock: ClockId(clock),
        minus: None,
        op,
        bound: hrdsl_ir::ta::TimeSum::constant(bound),
    };
    let l = [normal(&mut a, "a"), normal(&mut a, "b"), normal(&mut a, "c")];
    let mut first = edge(l[0], l[1]).reset(0);
    first.0.clock_guard.push(nano(0, ClockOp::Gt, 0));
    first.to(&mut a);
    let mut second = edge(l[1], l[2]);
    second.0.clock_guard.extend([nano(0, ClockOp::Gt, 0), nano(1, ClockOp::Lt, 1)]);
    second.to(&mut a);
    add(&mut p, a);
    let report = search(&p, &[at(0, 2)], &[], &[]).unwrap();
    let w = reached(&report.goals[0]);
    assert_eq!((w.ticks, w.steps[0].time, w.steps[1].time), (3, 1, 2));
}

#[test]
fn malformed_programs_are_errors() {
    let (mut p, _) = decider();
    p.automata[0].edges[0].to = LocationId(7);
    assert!(matches!(
        search(&p, &[], &[], &[]),
        Err(SearchError::Model { error: ModelError::Malformed { .. }, .. })
    ));
    let (p, _) = decider();
    assert!(matches!(search(&p, &[at(5, 0)], &[], &[]), Err(SearchError::Model { .. })));
}

#[test]
fn receivers_update_after_the_sender_in_order() {
    let mut p = program();
    let s = shared(&mut p, "s", 0, 100, 1);
    let e = event(&mut p, "e", &[]);
    let mut sender = automaton("S", &[]);
    let (a, b) = (normal(&mut sender, "a"), normal(&mut sender, "b"));
    edge(a, b).send(e).set(s, n(5)).to(&mut sender);
    // Its own reception is not for it.
    edge(a, a).on(e).set(s, n(99)).to(&mut sender);
    for (name, op, k) in [("R1", BinaryOp::Mul, 3), ("R2", BinaryOp::Add, 4)] {
        let mut r = automaton(name, &[]);
        let l = normal(&mut r, "l");
        // The guard sees the value before the sender's update.
        edge(l, l).on(e).when(common::eq(v(s), n(1))).set(s, bin(op, v(s), n(k))).to(&mut r);
        add(&mut p, r);
    }
    add(&mut p, sender);
    let is = |k| condition(StateFormula::Data(common::eq(v(s), n(k))));
    let report = search(&p, &[is(19), is(99)], &[], &[]).unwrap();
    reached(&report.goals[0]);
    assert_eq!(report.goals[1], GoalOutcome::Unreachable);
}

fn pace() -> Enumeration {
    Enumeration::intern("Pace", &["slow", "normal", "fast"])
}

fn symbol(name: &str) -> Value {
    Value::Symbol(Symbol::intern(name))
}

fn is(name: &str) -> Expr {
    Expr::Const(symbol(name))
}

fn over(name: &str, e: Enumeration, init: &str) -> hrdsl_ir::ta::AutomatonVar {
    let init = e.index_of(Symbol::intern(init)).unwrap() as i64;
    hrdsl_ir::ta::AutomatonVar { enumeration: Some(e), ..var(name, 0, e.values().len() as i64 - 1, init) }
}

/// A person asks for any pace but its last, once a second; a robot takes the pace asked for, but is never `fast` at once.
/// The shared variable is what was asked for last.
fn walkers() -> (Program, EventId, EventId) {
    let mut p = program();
    let ask = event(&mut p, "ask", &[Type::Enum(pace())]);
    let halt = event(&mut p, "halt", &[Type::Enum(pace())]);
    p.shared.push(over("last", pace(), "slow"));
    let mut person = automaton("Person", &["x"]);
    let l = location(&mut person, "asks", LocationKind::Normal, &[clock(0, ClockOp::Le, 1)]);
    edge(l, l)
        .clock(0, ClockOp::Ge, 1)
        .select(over("want", pace(), "slow"))
        .when(bin(BinaryOp::Ne, v(1), v(0)))
        .send_args(ask, &[v(1)])
        .set(0, v(1))
        .reset(0)
        .to(&mut person);
    add(&mut p, person);
    let mut robot = automaton("Robot", &[]);
    robot.vars.push(over("feed", pace(), "slow"));
    let l = normal(&mut robot, "walks");
    let to = |name| ReceiveArg::Match(ArgPattern::Is(symbol(name)));
    let step =
        Expr::If(Box::new(bin(BinaryOp::Eq, v(1), is("slow"))), Box::new(is("normal")), Box::new(is("fast")));
    edge(l, l).on_args(ask, &[to("fast")]).set(1, step).to(&mut robot);
    let bound = bin(BinaryOp::Ne, v(2), is("fast"));
    edge(l, l).on_args(ask, &[ReceiveArg::Bind]).when(bound).set(1, v(2)).to(&mut robot);
    let still = location(&mut robot, "still", LocationKind::Normal, &[]);
    edge(l, still).when(bin(BinaryOp::Eq, v(1), is("fast"))).send_args(halt, &[v(1)]).to(&mut robot);
    add(&mut p, robot);
    (p, ask, halt)
}

#[test]
fn symbols_are_chosen_sent_received_and_reached() {
    let (p, ask, halt) = walkers();
    let fast = StateFormula::Data(bin(BinaryOp::Eq, v(1), is("fast")));
    let both = bin(BinaryOp::And, bin(BinaryOp::Eq, v(0), is("fast")), bin(BinaryOp::Eq, v(1), is("slow")));
    let goals = [condition(fast), condition(StateFormula::Data(both)), at(1, 1)];
    let report = search(&p, &goals, &[], &[]).unwrap();
    assert_eq!(slot_names(&p, &p.networks[0]), ["last", "Robot.feed"]);
    // A witness is given only if the interpreter has replayed it.
    let w = reached(&report.goals[0]);
    let sent: Vec<_> = w.steps.iter().filter_map(|s| s.event.clone()).collect();
    assert_eq!(sent, [(ask, vec![symbol("normal")]), (ask, vec![symbol("fast")])]);
    let (normal, fast) = (symbol("normal"), symbol("fast"));
    assert_eq!(w.steps[1].variables, [(0, normal, fast), (1, normal, fast)]);
    let text = w.text(&p, &p.networks[0]);
    assert!(text.contains("Robot.feed: normal -> fast"), "{text}");
    assert_eq!(report.goals[1], GoalOutcome::Unreachable);
    let last = reached(&report.goals[2]).steps.last().cloned().unwrap();
    assert_eq!(last.event, Some((halt, vec![symbol("fast")])));
    assert!(report.complete);
}

#[test]
fn faults_with_symbols_are_said() {
    let hand = || Enumeration::intern("Hand", &["left", "right", "both"]);
    let fault = |change: &dyn Fn(&mut Program)| {
        let (mut p, ..) = walkers();
        change(&mut p);
        match search(&p, &[at(1, 1)], &[], &[]) {
            Err(SearchError::Model { error, .. }) => error.to_string(),
            other => panic!("{other:?}"),
        }
    };
    let sent = fault(&|p| p.events[1].params[0].ty = Type::Enum(hand()));
    assert_eq!(sent, "automaton `Robot`, edge walks -> still: argument `p` of `halt` is fast");
    let other = fault(&|p| p.automata[1].edges[1].updates = edge_update(1, is("left")));
    assert_eq!(other, "automaton `Robot`, edge walks -> walks: operand of the wrong type");
    let range = "the range of `feed` is not that of its enumeration";
    for (lo, hi) in [(0, 3), (0, 1), (-1, 2)] {
        let found = fault(&|p| {
            let feed = &mut p.automata[1].vars[0];
            (feed.lo, feed.hi) = (lo, hi);
        });
        assert_eq!(found, format!("malformed automaton `Robot`: {range}"));
    }
}

fn edge_update(slot: u16, value: Expr) -> Vec<hrdsl_ir::ta::EdgeAssignment> {
    vec![hrdsl_ir::ta::EdgeAssignment::Assign { place: hrdsl_ir::expr::Lvalue::slot(slot), value }]
}

#[test]
fn a_player_hears_and_says_symbols() {
    let (p, ask, halt) = walkers();
    let mut player = hrdsl_ta::VirtualTimePlayer::new(&p, AutomatonId(1));
    let mut out = Vec::new();
    for (second, pace, feed) in [(1, "slow", "slow"), (2, "fast", "normal"), (3, "normal", "normal")] {
        player.receive(ask, &[symbol(pace)], second * SECOND).unwrap();
        player.run(second * SECOND, &mut out).unwrap();
        assert_eq!((player.variable(1), out.len()), (Some(symbol(feed)), 0));
    }
    player.receive(ask, &[symbol("fast")], 4 * SECOND).unwrap();
    player.run(4 * SECOND, &mut out).unwrap();
    assert_eq!(out, [(halt, vec![symbol("fast")])]);
    // What others do to shared variables, a player does not see.
    assert_eq!((player.variable(0), player.variable(2)), (Some(symbol("slow")), None));
    // The person asks by itself; the first select that the guard allows is not the pace of the start.
    let mut person = hrdsl_ta::VirtualTimePlayer::new(&p, AutomatonId(0));
    let mut asked = Vec::new();
    person.run(0, &mut asked).unwrap();
    person.run(SECOND, &mut asked).unwrap();
    assert_eq!(asked, [(ask, vec![symbol("normal")])]);
}
