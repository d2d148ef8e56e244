//! Observers against what they stand for: random monitors against the monitor itself, and windows of assumptions against
//! the check of assumptions, on models that can do one thing only.

use hrdsl_coverage::assume::AssumptionChecker;
use hrdsl_ir::{
    Actor, ActorId, ArgPattern, Event, EventId, EventPattern, Expr, Nanos, Parameter, Program, Role, Span,
    Type, Value,
    monitor::{
        Assumption, Monitor, MonitorClockGuard, MonitorEdge as Rule, MonitorEffect, MonitorState,
        MonitorTrigger, RequirementKind, StateId,
    },
    ta::{
        Automaton, AutomatonId, ClockConstraint, ClockId, ClockOp, Edge, EdgeAssignment, Location,
        LocationId, LocationKind, Network, QueryFormula, SyncLabel, TimeSum,
    },
    value::SECOND,
};
use hrdsl_monitor::{MonitorOutcome, MonitorRunner};
use hrdsl_prove::{GoalFate, ObservedNetwork, ProofOptions, SearchWatch, decide, of_formula};
use hrdsl_trace::{TraceObserver as _, TraceStep, TraceStepKind};

/// A small generator, so that each case is the same everywhere.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }

    fn one_in(&mut self, n: u64) -> bool {
        self.roll(n) == 0
    }
}

const EVENTS: [&str; 3] = ["a", "b", "c"];

/// `a` has a number of 0..2, `b` a bool, `c` nothing.
fn program() -> Program {
    let params = [vec![Type::Int { lo: 0, hi: 2 }], vec![Type::Bool], vec![]];
    let event = |(name, params): (&&str, &Vec<Type>)| Event {
        name: (*name).into(),
        params: params.iter().map(|ty| Parameter { name: "p".into(), ty: *ty }).collect(),
        from: ActorId(0),
        to: Vec::new(),
        stimulus: None,
        origin: Span::default(),
    };
    Program {
        actors: vec![Actor { name: "env".into(), role: Role::Environment, origin: Span::default() }],
        events: EVENTS.iter().zip(&params).map(event).collect(),
        ..Program::default()
    }
}

fn value(dice: &mut Dice, event: usize) -> Vec<Value> {
    match event {
        0 => vec![Value::Int(dice.roll(3) as i64)],
        1 => vec![Value::Bool(dice.one_in(2))],
        _ => vec![],
    }
}

/// Events with their times, in order; several may share an instant.
type Script = Vec<(Nanos, EventId, Vec<Value>)>;

fn script(dice: &mut Dice) -> Script {
    let mut now = 0;
    (0..dice.roll(8))
        .map(|_| {
            now += dice.roll(4) as i64 * SECOND;
            let event = dice.roll(3) as usize;
            (now, EventId(event as u16), value(dice, event))
        })
        .collect()
}

/// An automaton that does this and nothing else, and then stays until the end.
fn actor_of(script: &Script, end: Nanos) -> Automaton {
    let clock =
        |op, time| ClockConstraint { clock: ClockId(0), minus: None, op, bound: TimeSum::constant(time) };
    let times = script.iter().map(|s| s.0).chain([end]);
    let location = |(n, time): (usize, Nanos)| Location {
        name: format!("l{n}"),
        kind: LocationKind::Normal,
        invariant: vec![clock(ClockOp::Le, time)],
        holds: None,
        stopped: Vec::new(),
        origin: Span::default(),
    };
    let edge = |(n, (time, event, args)): (usize, &(Nanos, EventId, Vec<Value>))| Edge {
        from: LocationId(n as u16),
        to: LocationId(n as u16 + 1),
        selects: vec![],
        clock_guard: vec![clock(ClockOp::Ge, *time)],
        guard: None,
        sync: SyncLabel::Send { event: *event, args: args.iter().map(|v| Expr::Const(*v)).collect() },
        updates: Vec::<EdgeAssignment>::new(),
        origin: Span::default(),
    };
    Automaton {
        name: "Script".into(),
        actor: Some(ActorId(0)),
        clocks: vec!["x".into()],
        vars: vec![],
        locations: times.enumerate().map(location).collect(),
        initial: LocationId(0),
        edges: script.iter().enumerate().map(edge).collect(),
        origin: Span::default(),
    }
}

fn with_script(mut program: Program, script: &Script, end: Nanos) -> (Program, Network) {
    program.automata.push(actor_of(script, end));
    let network = Network { name: "all".into(), automata: vec![AutomatonId(0)], origin: Span::default() };
    program.networks.push(network.clone());
    (program, network)
}

fn pattern(dice: &mut Dice) -> EventPattern {
    let event = dice.roll(3) as usize;
    let arg = |v: Value, any: bool| if any { ArgPattern::Any } else { ArgPattern::Is(v) };
    let args = value(dice, event);
    let args = args.into_iter().map(|v| arg(v, dice.one_in(2))).collect();
    EventPattern { event: EventId(event as u16), args }
}

fn patterns(dice: &mut Dice) -> Vec<EventPattern> {
    (0..=dice.roll(2)).map(|_| pattern(dice)).collect()
}

fn clock_guard(dice: &mut Dice) -> MonitorClockGuard {
    let bound = (1 + dice.roll(6) as i64) * SECOND / 2;
    if dice.one_in(2) { MonitorClockGuard::Before(bound) } else { MonitorClockGuard::After(bound) }
}

/// What happens at most of the deadlines.
fn deadline_edges(dice: &mut Dice, states: &[MonitorState]) -> Vec<Rule> {
    let count = states.len();
    let mut edges = Vec::new();
    for (n, state) in states.iter().enumerate() {
        if state.deadline.is_some() && !dice.one_in(4) {
            let to = StateId(dice.roll(count as u64) as u16);
            let from = StateId(n as u16);
            edges.push(Rule {
                from,
                to,
                on: MonitorTrigger::Deadline,
                guard: None,
                clock: None,
                effects: vec![if dice.one_in(3) { MonitorEffect::Suspect } else { MonitorEffect::Fail }],
            });
        }
    }
    edges
}

fn monitor(dice: &mut Dice) -> Monitor {
    let count = 1 + dice.roll(4) as usize;
    let deadline = |dice: &mut Dice| (dice.one_in(2)).then(|| (1 + dice.roll(4) as i64) * SECOND);
    let states: Vec<MonitorState> = (0..count)
        .map(|n| MonitorState { name: format!("s{n}"), pending: dice.one_in(2), deadline: deadline(dice) })
        .collect();
    let clocks: Vec<MonitorClockGuard> = (0..count).map(|_| clock_guard(dice)).collect();
    let mut edges = Vec::new();
    for _ in 0..dice.roll(10) {
        let (from, to) = (dice.roll(count as u64) as usize, dice.roll(count as u64) as usize);
        let mut effects = Vec::new();
        let timed = states[to].deadline.is_some() && from != to;
        if timed || dice.one_in(3) {
            effects.push(MonitorEffect::ResetClock);
        }
        if dice.one_in(3) {
            effects.push(MonitorEffect::Trigger);
        }
        if dice.one_in(4) {
            effects.push(MonitorEffect::Discharge);
        }
        if dice.one_in(5) {
            effects.push(MonitorEffect::Fail);
        }
        let on = MonitorTrigger::Event(patterns(dice));
        edges.push(Rule {
            from: StateId(from as u16),
            to: StateId(to as u16),
            on,
            guard: None,
            clock: dice.one_in(4).then(|| clocks[from]),
            effects,
        });
    }
    edges.extend(deadline_edges(dice, &states));
    Monitor {
        name: "R".into(),
        kind: RequirementKind::Functional,
        title: String::new(),
        doc: String::new(),
        text: String::new(),
        signals: vec![],
        states,
        initial: StateId(0),
        at_start: if dice.one_in(8) { vec![MonitorEffect::Trigger] } else { Vec::new() },
        conditions: Vec::new(),
        edges,
        margin: None,
        formula: None,
        origin: Span::default(),
    }
}

fn is_reached(program: &Program, observed: &ObservedNetwork, formula: &QueryFormula) -> bool {
    let goals = [of_formula(formula)];
    let decided =
        decide(program, observed, &goals, &[], &ProofOptions::default(), &SearchWatch::default()).unwrap();
    match &decided.fates[0] {
        GoalFate::Reached(_) => true,
        GoalFate::Unreachable => false,
        GoalFate::Inconclusive(why) => panic!("inconclusive: {why}"),
    }
}

#[test]
fn an_observer_sees_what_its_monitor_does() {
    let (mut failed, mut kept, mut triggered) = (0, 0, 0);
    for seed in 0..1500 {
        let dice = &mut Dice(seed * 7919 + 1);
        let (script, monitor) = (script(dice), monitor(dice));
        // Never at a deadline: there the end of a trace is judged more strictly than the model.
        let end = script.last().map_or(0, |s| s.0) + dice.roll(6) as i64 * SECOND + SECOND / 2;
        let (mut program, network) = with_script(program(), &script, end);
        program.monitors.push(monitor.clone());
        let mut checker = MonitorRunner::new(&program);
        for (index, (time, event, args)) in script.iter().enumerate() {
            let what = TraceStepKind::Event { event: *event, args: args.clone() };
            checker.step(index, &TraceStep { time: *time, what });
        }
        checker.end(end);
        let verdict = checker.verdicts().remove(0);
        let fails = verdict.outcome == MonitorOutcome::Fail;
        let mut observed = ObservedNetwork::new(&program, &network);
        // One after the other at one clock that is not reset: its deadline is not counted from there.
        let Ok(verdicts) = observed.add(&monitor) else { continue };
        let seen = verdicts.violated.as_ref().is_some_and(|f| is_reached(&program, &observed, f));
        assert_eq!(seen, fails, "seed {seed}: {monitor:#?}\n{script:?} until {end}\n{verdict:?}");
        if !fails {
            let seen = is_reached(&program, &observed, &verdicts.triggered);
            assert_eq!(seen, verdict.triggered > 0, "trigger, seed {seed}: {monitor:#?}\n{script:?}");
            triggered += u32::from(seen);
        }
        (failed, kept) = (failed + u32::from(fails), kept + u32::from(!fails));
    }
    assert!(failed > 300 && kept > 300 && triggered > 100, "{failed} failed, {kept} kept, {triggered}");
}

#[test]
fn a_window_lets_happen_what_the_assumption_allows() {
    let (mut allowed, mut forbidden) = (0, 0);
    for seed in 0..600 {
        let dice = &mut Dice(seed * 104_729 + 3);
        let script = script(dice);
        let end = script.last().map_or(0, |s| s.0) + SECOND;
        let (mut program, network) = with_script(program(), &script, end);
        program.assumptions.push(Assumption {
            text: "assume".into(),
            events: patterns(dice),
            at_most: dice.roll(4) as u32,
            within: Some((1 + dice.roll(6) as i64) * SECOND),
            origin: Span::default(),
        });
        let last = QueryFormula::At { automaton: 0, location: LocationId(script.len() as u16) };
        let allows = AssumptionChecker::allows(&program, &script);
        let observed = ObservedNetwork::new(&program, &network);
        assert_eq!(is_reached(&program, &observed, &last), allows, "seed {seed}: {script:?} {program:#?}");
        (allowed, forbidden) = (allowed + u32::from(allows), forbidden + u32::from(!allows));
    }
    assert!(allowed > 100 && forbidden > 100, "{allowed} allowed, {forbidden} forbidden");
}
