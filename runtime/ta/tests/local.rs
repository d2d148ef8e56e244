//! Local time: the same verdicts as the standard search, with fewer states.

mod common;
mod local_nets;

use common::families;
use hrdsl_ir::{
    Program,
    ta::{ClockOp, Formula, LocationId},
};
use hrdsl_ta::{
    Error, Goal, GoalKind, Model, Observe, Outcome, Report, StateFormula, explore,
    local::{self, Failure, NotApplicable, Options},
};
use local_nets::{Draft, Member};
use proptest::prelude::*;

fn model(p: &Program) -> Model<'_> {
    Model::new(p, &p.networks[0], &Observe::default()).unwrap()
}

fn run(p: &Program) -> Report {
    let report = local::explore(&model(p), &[], &Options::default(), &|_| true).unwrap();
    assert!(report.complete);
    report
}

#[test]
fn philosophers_need_one_zone_for_each_discrete_state() {
    for (n, stored) in [(5, 277), (6, 853), (7, 2_627), (8, 8_090)] {
        let report = run(&families::philosophers(n));
        assert_eq!((report.states_stored, report.discrete_states), (stored, stored));
    }
}

#[test]
fn media_stand_for_shared_variables() {
    // All of Fischer's transitions use the one variable: nothing commutes.
    assert_eq!(run(&families::fischer(6)).states_stored, 2_378);
    let options = Options { media: false, ..Options::default() };
    let p = families::fischer(3);
    let refused = local::explore(&model(&p), &[], &options, &|_| true);
    assert_eq!(refused, Err(Failure::NotApplicable(NotApplicable::Shared("id".into()))));
}

#[test]
fn families_have_no_more_states_than_with_global_time() {
    for (p, most) in [
        (families::fddi(8), 341),
        (families::parallel(8), 257),
        (families::train_gate(4), 12_000),
        (families::critical_region(3), 3_015),
    ] {
        assert!(run(&p).states_stored <= most);
    }
}

/// Every location, every edge, every pair of locations of two automata, and some values of clocks.
fn goals(p: &Program) -> Vec<Goal> {
    let mut goals = Vec::new();
    let mut goal = |what| goals.push(Goal { what, settled: false });
    let locations = |a: usize| (0..p.automata[a].locations.len() as u16).map(LocationId);
    let mut clocks = p.clocks.len() as u16;
    for (automaton, a) in p.automata.iter().enumerate() {
        (0..a.edges.len()).for_each(|edge| goal(GoalKind::Edge { automaton, edge }));
        locations(automaton).for_each(|location| goal(GoalKind::Location { automaton, location }));
        for (other, l) in (0..automaton).flat_map(|o| locations(o).map(move |l| (o, l))) {
            for location in locations(automaton) {
                let here = StateFormula::At { automaton, location };
                let there = StateFormula::At { automaton: other, location: l };
                goal(GoalKind::Condition(StateFormula::And(vec![here, there])));
            }
        }
        if !a.clocks.is_empty() {
            formulas(automaton as u16, clocks).into_iter().for_each(|f| goal(GoalKind::Formula(f)));
        }
        clocks += a.clocks.len() as u16;
    }
    goals
}

/// In a location, with a clock between bounds.
fn formulas(automaton: u16, x: u16) -> Vec<Formula> {
    let at = |l: u16| Formula::At { automaton, location: LocationId(l) };
    let clock = |op, n| Formula::Clock(common::clock(x, op, n));
    let between = |l, a, b| Formula::And(vec![at(l), clock(ClockOp::Ge, a), clock(ClockOp::Lt, b)]);
    vec![
        between(0, 2, 3),
        between(1, 0, 1),
        Formula::And(vec![at(1), Formula::Not(Box::new(clock(ClockOp::Le, 4)))]),
    ]
}

/// Both searches answer all goals alike. Witnesses were replayed before they are here.
fn agree(p: &Program) {
    let goals = goals(p);
    let formula = |g: &Goal| if let GoalKind::Formula(f) = &g.what { Some(f.clone()) } else { None };
    let formulas = goals.iter().filter_map(formula).collect();
    let observe = Observe { formulas, ..Observe::default() };
    let model = Model::new(p, &p.networks[0], &observe).unwrap();
    let plain = hrdsl_ta::Options { reduce: true, ..hrdsl_ta::Options::reference() };
    let global = explore(&model, &goals, &plain, &|_| true);
    let local = local::explore(&model, &goals, &Options::default(), &|_| true);
    let (local, global) = match (local, global) {
        (Ok(local), Ok(global)) => (local, global),
        (Err(Failure::Search(Error::Model { .. })), Err(Error::Model { .. })) => return,
        (local, global) => panic!("{local:?} with local time, {global:?} with global time"),
    };
    for ((goal, a), b) in goals.iter().zip(&local.goals).zip(&global.goals) {
        let same = matches!(
            (a, b),
            (Outcome::Reached(_), Outcome::Reached(_)) | (Outcome::Unreachable, Outcome::Unreachable)
        );
        assert!(same, "{goal:?}: {a:?} with local time, {b:?} with global time");
    }
    let all = |r: &Report| r.complete.then_some(r.discrete_states);
    if let (Some(a), Some(b)) = (all(&local), all(&global)) {
        assert_eq!(a, b);
    }
}

#[test]
fn families_have_the_same_answers() {
    agree(&families::philosophers(4));
    agree(&families::fddi(3));
    agree(&families::parallel(4));
    agree(&families::train_gate(3));
    agree(&families::fischer(4));
    agree(&families::csma_cd(3));
    agree(&families::critical_region(2));
}

fn draft() -> impl Strategy<Value = Draft> {
    let clock = || 0..12u16;
    let guard = proptest::option::of((clock(), 0..5u8, 0..4i64));
    let copied = prop_oneof![4 => Just(None), 1 => clock().prop_map(Some)];
    let reset = proptest::option::of((clock(), copied, prop_oneof![4 => Just(0), 1 => 0..3i64]));
    let shared = prop_oneof![
        4 => Just((None, None)),
        1 => (proptest::option::of(0..3i64), proptest::option::of(0..3i64)),
    ];
    let ends = (0..3u16, 0..3u16);
    (ends, 0..13u8, guard, reset, shared).prop_map(|((from, to), sync, guard, reset, shared)| Draft {
        from,
        to,
        sync,
        guard,
        reset,
        shared,
    })
}

fn member() -> impl Strategy<Value = Member> {
    let location = (0..12u8, proptest::option::of((0..2u16, 0..4i64)));
    let locations = proptest::collection::vec(location, 2..=3);
    (0..=2u16, locations, proptest::collection::vec(draft(), 2..=5))
        .prop_map(|(clocks, locations, edges)| Member { clocks, locations, edges })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_networks_have_the_same_answers(
        members in proptest::collection::vec(member(), 2..=4),
        optional in any::<[bool; 3]>(),
    ) {
        let p = local_nets::random(&members, optional);
        agree(&p);
    }
}
