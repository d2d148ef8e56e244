//! Tests of counting, sorting, naming and assuming.

use hrdsl_ir::{
    ActorId, ArgPattern, Event, EventId, EventPattern, Nanos, Program, Span, Symbol, Value,
    coverage::{self as ir, BinCondition, BinName, CoverBin, CoverCross, Coverpoint, CoverpointId, CrossBin},
    monitor::Assumption,
    world::SignalId,
};
use hrdsl_trace::{
    MachineDeclaration, MachineEdge, MachineStep, Trace, TraceObserver, TraceStep, TraceStepKind,
};
use proptest::prelude::*;

use crate::{CoverageCollector, MachineCollector, TestCoverage, assume::AssumptionChecker};

const ASK: u16 = 0;
const DECIDED: u16 = 1;

fn pattern(event: u16, args: &[ArgPattern]) -> EventPattern {
    EventPattern { event: EventId(event), args: args.to_vec() }
}

fn bin(name: &str, lo: i64, hi: Option<i64>) -> CoverBin {
    CoverBin { name: name.to_owned(), lo, hi }
}

fn point(name: &str, count: Vec<EventPattern>, bins: Vec<CoverBin>) -> Coverpoint {
    Coverpoint { name: name.to_owned(), count, bins, origin: Span::default() }
}

fn cross_bin(name: &str, when: BinCondition) -> CrossBin {
    CrossBin { name: name.to_owned(), when, origin: Span::default() }
}

fn is(point: u16, bin: u16) -> BinCondition {
    BinCondition::In { point: CoverpointId(point), bin }
}

/// Points `legs` and `ready`, and their cross.
fn declared() -> ir::Coverage {
    let legs = vec![bin("none", 0, Some(0)), bin("some", 1, None), bin("four", 4, None)];
    let ready = vec![bin("no", 0, Some(0)), bin("some", 1, None)];
    let yes = ArgPattern::Is(Value::Bool(true));
    ir::Coverage {
        points: vec![
            point("legs", vec![pattern(ASK, &[])], legs),
            point("ready", vec![pattern(DECIDED, &[yes]), pattern(DECIDED, &[ArgPattern::Any])], ready),
        ],
        crosses: vec![CoverCross {
            name: "human_robot".to_owned(),
            points: vec![CoverpointId(0), CoverpointId(1)],
            bins: vec![
                cross_bin("4 legs, ready at least once", BinCondition::And(vec![is(0, 2), is(1, 1)])),
                cross_bin("idle", BinCondition::Not(Box::new(BinCondition::Or(vec![is(0, 1), is(1, 1)])))),
                cross_bin("some", is(0, 1)),
            ],
            ignore: vec![BinCondition::And(vec![is(0, 0), is(1, 1)])],
            origin: Span::default(),
        }],
    }
}

fn program(coverage: ir::Coverage, assumptions: Vec<Assumption>) -> Program {
    let event = |name: &str| Event {
        name: name.to_owned(),
        params: Vec::new(),
        from: ActorId(0),
        to: Vec::new(),
        stimulus: None,
        origin: Span::default(),
    };
    Program { events: vec![event("ask"), event("decided")], coverage, assumptions, ..Program::default() }
}

fn ask(time: Nanos) -> TraceStep {
    TraceStep { time, what: TraceStepKind::Event { event: EventId(ASK), args: Vec::new() } }
}

fn decided(time: Nanos, yes: bool) -> TraceStep {
    TraceStep { time, what: TraceStepKind::Event { event: EventId(DECIDED), args: vec![Value::Bool(yes)] } }
}

fn collect(steps: Vec<TraceStep>) -> TestCoverage {
    let mut collector = CoverageCollector::new(&program(declared(), Vec::new()));
    Trace { steps, end: 100 }.replay(&mut collector);
    collector.finish()
}

#[test]
fn events_are_counted_once_per_point() {
    let unknown = TraceStep { time: 2, what: TraceStepKind::Event { event: EventId(9), args: Vec::new() } };
    let sample =
        TraceStep { time: 2, what: TraceStepKind::Sample { signal: SignalId(0), value: Value::Bool(true) } };
    let covered = collect(vec![ask(0), decided(1, true), decided(1, false), unknown, sample]);
    assert_eq!(covered.numbers, [1, 2]);
    assert_eq!(covered.points, [vec![1], vec![1]]);
    assert_eq!(covered.crosses, [vec![2]]);
}

#[test]
fn events_are_told_apart_by_symbols() {
    let symbol = |name: &str| Value::Symbol(Symbol::intern(name));
    let of = |name: &str| point(name, vec![pattern(DECIDED, &[ArgPattern::Is(symbol(name))])], Vec::new());
    let declared = ir::Coverage { points: vec![of("slow"), of("fast")], crosses: Vec::new() };
    let went = |time, name| {
        let args = vec![symbol(name)];
        TraceStep { time, what: TraceStepKind::Event { event: EventId(DECIDED), args } }
    };
    let mut collector = CoverageCollector::new(&program(declared, Vec::new()));
    let steps = vec![went(0, "fast"), went(1, "slow"), went(2, "fast"), went(3, "still")];
    Trace { steps, end: 9 }.replay(&mut collector);
    assert_eq!(collector.finish().numbers, [1, 2]);
}

#[test]
fn a_test_can_fall_into_several_bins() {
    let covered = collect(vec![ask(0), ask(1), ask(2), ask(3), decided(4, true)]);
    assert_eq!(covered.points, [vec![1, 2], vec![1]]);
    let names = covered.cross_names(&declared());
    assert_eq!(names, ["human_robot.4 legs, ready at least once", "human_robot.some"]);
}

#[test]
fn what_is_ignored_hits_no_cross_bin() {
    assert_eq!(collect(vec![decided(0, true)]).crosses, [Vec::<u16>::new()]);
    assert_eq!(collect(Vec::new()).cross_names(&declared()), ["human_robot.idle"]);
}

#[test]
fn names_of_bins_are_stable() {
    assert_eq!(BinName::new("legs", "four").as_str(), "legs.four");
    assert_eq!(BinName::new("legs", "4 legs, \"ready\"").as_str(), "legs.4 legs, \"ready\"");
    assert_eq!(BinName::new("c", "a\nb\tc").as_str(), "c.a b c");
    for bad in ["legs", "legs.", ".four", ""] {
        assert_eq!(BinName::parse(bad), None, "{bad}");
    }
}

fn at_most(n: u32, within: Option<Nanos>) -> Assumption {
    Assumption {
        text: String::new(),
        events: vec![pattern(ASK, &[])],
        at_most: n,
        within,
        origin: Span::default(),
    }
}

#[test]
fn a_window_includes_its_very_end() {
    let mut assumptions = AssumptionChecker::new(&program(declared(), vec![at_most(2, Some(10))]));
    assert_eq!(assumptions.admit(0, EventId(ASK), &[]), Ok(()));
    assert_eq!(assumptions.admit(4, EventId(ASK), &[]), Ok(()));
    assert_eq!(assumptions.admit(10, EventId(ASK), &[]), Err(0));
    assert_eq!(assumptions.would_violate(10, EventId(DECIDED), &[Value::Bool(true)]), None);
    assert_eq!(assumptions.admit(11, EventId(ASK), &[]), Ok(()));
    assert_eq!(assumptions.would_violate(14, EventId(ASK), &[]), Some(0));
    assert_eq!(assumptions.would_violate(15, EventId(ASK), &[]), None);
    // Asking is not doing.
    assert_eq!(assumptions.would_violate(15, EventId(ASK), &[]), None);
}

#[test]
fn the_first_assumption_violated_is_named() {
    let all = [at_most(3, None), at_most(1, Some(5)), at_most(0, Some(0))];
    let mut assumptions = AssumptionChecker::new(&program(declared(), all[..2].to_vec()));
    for time in [0, 6, 12] {
        assert_eq!(assumptions.admit(time, EventId(ASK), &[]), Ok(()));
    }
    assert_eq!(assumptions.admit(13, EventId(ASK), &[]), Err(0));
    let mut never = AssumptionChecker::new(&program(declared(), all[2..].to_vec()));
    assert_eq!(never.admit(0, EventId(ASK), &[]), Err(0));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_bins_name_can_be_read_back(owner in "[a-z_][a-z_0-9]{0,8}", bin in "[ -~äλ]{1,12}") {
        let name = BinName::new(&owner, &bin);
        prop_assert!(!name.as_str().contains('\n'));
        prop_assert_eq!((name.owner(), name.bin()), (owner.as_str(), bin.as_str()));
        prop_assert_eq!(BinName::parse(name.as_str()), Some(name));
    }

    /// Against all windows of the whole list.
    #[test]
    fn assumptions_hold_in_every_window(
        gaps in prop::collection::vec(0i64..6, 0..20),
        n in 0u32..4,
        within in prop::option::of(0i64..15),
    ) {
        let mut time = 0;
        let times: Vec<Nanos> = gaps.iter().map(|gap| { time += gap; time }).collect();
        let inside = |start: Nanos| {
            times.iter().filter(|t| **t >= start && within.is_none_or(|d| **t - start <= d)).count()
        };
        let kept = times.iter().all(|t| inside(*t) <= n as usize);
        let events: Vec<_> = times.iter().map(|t| (*t, EventId(ASK), Vec::new())).collect();
        prop_assert_eq!(AssumptionChecker::allows(&program(declared(), vec![at_most(n, within)]), &events), kept);
        let mut collector = CoverageCollector::new(&program(declared(), Vec::new()));
        events.iter().enumerate().for_each(|(i, e)| collector.step(i, &ask(e.0)));
        prop_assert_eq!(collector.finish().numbers[0] as usize, times.len());
    }
}

// ── state machines ──

fn edge([from, outcome, to]: [&str; 3]) -> MachineEdge {
    MachineEdge { from: from.into(), outcome: outcome.into(), to: to.into() }
}

fn moved(what: [&str; 3]) -> MachineStep {
    MachineStep::Moved { machine: "M".into(), edge: edge(what) }
}

#[test]
fn states_are_entered_and_transitions_taken() {
    let declared = MachineDeclaration {
        machine: "M".into(),
        states: ["A", "B", "C"].map(String::from).into(),
        transitions: [["A", "go", "B"], ["B", "back", "A"], ["B", "stop", "end"]].map(edge).into(),
        outcomes: vec!["end".into()],
    };
    let mut collector = MachineCollector::default();
    let begun = MachineStep::Begun { machine: "M".into(), state: "A".into() };
    for step in [MachineStep::Declared(declared.clone()), begun, moved(["A", "go", "B"])] {
        collector.step(&step);
    }
    let hits = collector.clone().finish();
    assert_eq!(hits.len(), 1);
    assert_eq!(hits[0].declared, declared);
    assert_eq!(hits[0].entered.iter().collect::<Vec<_>>(), ["A", "B"]);
    assert_eq!(hits[0].taken.iter().collect::<Vec<_>>(), [&edge(["A", "go", "B"])]);
    // An outcome is no state, and a declaration that comes again adds what is new.
    collector.step(&moved(["B", "stop", "end"]));
    collector.step(&MachineStep::Declared(MachineDeclaration { states: vec!["D".into()], ..declared }));
    let hits = collector.finish();
    assert_eq!(hits[0].declared.states, ["A", "B", "C", "D"]);
    assert_eq!(hits[0].entered.len(), 2);
    assert_eq!(hits[0].taken.len(), 2);
}

#[test]
fn what_was_not_declared_is_from_then_on() {
    let mut collector = MachineCollector::default();
    collector.step(&moved(["X", "slip", "Y"]));
    let hits = collector.finish();
    assert_eq!((hits[0].declared.states.clone(), hits[0].entered.len()), (vec!["X".into(), "Y".into()], 2));
    assert_eq!(hits[0].declared.transitions, [edge(["X", "slip", "Y"])]);
}
