//! Local time: the same verdicts as the standard search, with fewer states.

mod common;
mod local_nets;

use common::families;
use hrdsl_ir::{Program, ta::LocationId};
use hrdsl_ta::{
    Goal, GoalKind, Model, Observe, Outcome, Report, StateFormula, explore,
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

/// Every location, every edge, every pair of locations of two automata.
fn goals(p: &Program) -> Vec<Goal> {
    let mut goals = Vec::new();
    let mut goal = |what| goals.push(Goal { what, settled: false });
    let locations = |a: usize| (0..p.automata[a].locations.len() as u16).map(LocationId);
    for automaton in 0..p.automata.len() {
        (0..p.automata[automaton].edges.len()).for_each(|edge| goal(GoalKind::Edge { automaton, edge }));
        locations(automaton).for_each(|location| goal(GoalKind::Location { automaton, location }));
        for (other, l) in (0..automaton).flat_map(|o| locations(o).map(move |l| (o, l))) {
            for location in locations(automaton) {
                let here = StateFormula::At { automaton, location };
                let there = StateFormula::At { automaton: other, location: l };
                goal(GoalKind::Condition(StateFormula::And(vec![here, there])));
            }
        }
    }
    goals
}

/// Both searches answer all goals alike. Witnesses were replayed before they are here.
fn agree(p: &Program) {
    let (model, goals) = (model(p), goals(p));
    let local = local::explore(&model, &goals, &Options::default(), &|_| true).unwrap();
    let plain = hrdsl_ta::Options { reduce: true, ..hrdsl_ta::Options::reference() };
    let global = explore(&model, &goals, &plain, &|_| true).unwrap();
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
    let guard = proptest::option::of((0..2u16, 0..5u8, 0..4i64));
    let shared = prop_oneof![
        4 => Just((None, None)),
        1 => (proptest::option::of(0..3i64), proptest::option::of(0..3i64)),
    ];
    let ends = (0..3u16, 0..3u16);
    (ends, 0..13u8, guard, proptest::option::of(0..2u16), shared)
        .prop_map(|((from, to), sync, guard, reset, shared)| Draft { from, to, sync, guard, reset, shared })
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
