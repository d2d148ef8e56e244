//! Local time: the same verdicts as the standard search, with fewer states.

mod common;
mod local_nets;

use common::{add, automaton, channel, edge, eq, families, n, normal, program, shared, v};
use hrdsl_ir::{
    Program,
    ta::{AutomatonId, ChannelKind, ChannelParticipant, ClockOp, LocationId, QueryFormula},
};
use hrdsl_ta::{
    CompiledNetwork, GoalKind, GoalOutcome, ModelError, ObservationOptions, ReachabilityGoal, SearchBudget,
    SearchCutoff, SearchError, SearchOrder, SearchReport, StateFormula, TimeFrame, explore,
    local::{self, LocalSearchError, LocalSearchOptions, NotApplicableError},
};
use local_nets::{Draft, Member};
use proptest::prelude::*;

fn model(p: &Program) -> CompiledNetwork<'_> {
    CompiledNetwork::new(p, &p.networks[0], &ObservationOptions::default()).unwrap()
}

fn run(p: &Program) -> SearchReport {
    let report = local::explore(&model(p), &[], &LocalSearchOptions::default(), &|_| true).unwrap();
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
    let options = LocalSearchOptions { media: false, ..LocalSearchOptions::default() };
    let p = families::fischer(3);
    let refused = local::explore(&model(&p), &[], &options, &|_| true);
    assert_eq!(refused, Err(LocalSearchError::NotApplicable(NotApplicableError::Shared("id".into()))));
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
fn goals(p: &Program) -> Vec<ReachabilityGoal> {
    let mut goals = Vec::new();
    let mut goal = |what| goals.push(ReachabilityGoal { what, settled: false });
    let locations = |a: usize| (0..p.automata[a].locations.len() as u16).map(LocationId);
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
    }
    goals
}

/// What a report says of the search itself.
fn figures(r: &SearchReport) -> [usize; 6] {
    let complete = usize::from(r.complete);
    [r.states_stored, r.states_visited, r.discrete_states, r.transitions, r.peak_bytes, complete]
}

/// Both searches answer all goals alike. Witnesses were replayed before they are here.
fn agree(p: &Program) {
    let goals = goals(p);
    let model = model(p);
    let plain = hrdsl_ta::SearchOptions { reduce: true, ..hrdsl_ta::SearchOptions::reference() };
    let global = explore(&model, &goals, &plain, &|_| true);
    let local = local::explore(&model, &goals, &LocalSearchOptions::default(), &|_| true);
    let (local, global) = match (local, global) {
        (Ok(local), Ok(global)) => (local, global),
        (Err(LocalSearchError::Search(SearchError::Model { .. })), Err(SearchError::Model { .. })) => return,
        (local, global) => panic!("{local:?} with local time, {global:?} with global time"),
    };
    let breadth = |threads| {
        let options =
            LocalSearchOptions { threads, order: SearchOrder::Breadth, ..LocalSearchOptions::default() };
        local::explore(&model, &goals, &options, &|_| true).ok()
    };
    let (one, three) = (breadth(1), breadth(3));
    assert_eq!(one.as_ref().map(figures), three.as_ref().map(figures));
    assert!(one == three, "runs differ");
    for ((goal, a), b) in goals.iter().zip(&local.goals).zip(&global.goals) {
        let same = matches!(
            (a, b),
            (GoalOutcome::Reached(_), GoalOutcome::Reached(_))
                | (GoalOutcome::Unreachable, GoalOutcome::Unreachable)
        );
        assert!(same, "{goal:?}: {a:?} with local time, {b:?} with global time");
    }
    let all = |r: &SearchReport| r.complete.then_some(r.discrete_states);
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

/// All that is reported, work and memory included, however many threads compute successors: of whole searches, of those that end
/// with their last goal, and of those that the budget ends.
#[test]
fn threads_change_nothing() {
    let models = [families::corsso(3), families::philosophers(5), families::fddi(4), families::csma_cd(5)];
    for p in models {
        let model = model(&p);
        for goals in [Vec::new(), goals(&p), goals(&p)[..4].to_vec()] {
            for states in [usize::MAX, 700] {
                let budget = SearchBudget { states, ..SearchBudget::default() };
                let one = LocalSearchOptions {
                    budget,
                    order: SearchOrder::Breadth,
                    ..LocalSearchOptions::default()
                };
                let report = |options| local::explore(&model, &goals, &options, &|_| true).unwrap();
                let expected = report(one);
                for threads in [2, 3, 4] {
                    let report = report(LocalSearchOptions { threads, ..one });
                    assert_eq!(figures(&report), figures(&expected), "{threads} threads");
                    assert!(report == expected, "other runs with {threads} threads");
                }
            }
        }
    }
}

/// That an automaton is in the first two of its locations at once, which no state meets, and, if wanted, each location of the
/// last one.
fn never_and(p: &Program, more: bool) -> Vec<ReachabilityGoal> {
    let at = |automaton, l| StateFormula::At { automaton, location: LocationId(l) };
    let goal = |f| ReachabilityGoal { what: GoalKind::Condition(f), settled: false };
    let last = p.automata.len() - 1;
    let never = goal(StateFormula::And(vec![at(last, 0), at(last, 1)]));
    let places = (0..p.automata[last].locations.len() as u16).filter(|_| more);
    std::iter::once(never).chain(places.map(|l| goal(at(last, l)))).collect()
}

/// Where local time takes fewer zones it is chosen; verdicts and runs are those of common time.
#[test]
fn time_is_chosen_and_nothing_else_changes() {
    for (p, local) in [
        (families::philosophers(6), true),
        (families::corsso(3), true),
        (families::fischer(7), false),
        (families::csma_cd(8), false),
    ] {
        let model = model(&p);
        for (more, shortest) in [(false, false), (true, true)] {
            let goals = never_and(&p, more);
            let usual = if shortest {
                hrdsl_ta::SearchOptions::shortest()
            } else {
                hrdsl_ta::SearchOptions::default()
            };
            let search = |time| {
                let options = hrdsl_ta::SearchOptions { time, ..usual };
                explore(&model, &goals, &options, &|_| true).unwrap()
            };
            let (chosen, common) = (search(TimeFrame::Chosen), search(TimeFrame::Common));
            assert_eq!(chosen.goals, common.goals);
            let why = chosen.chosen.unwrap();
            assert_eq!(why.starts_with("local time: "), local, "{why}");
            assert_eq!(common.chosen, None);
            if local && !more {
                assert!(chosen.states_stored < common.states_stored);
            }
        }
    }
}

/// A budget that ends common time does not end what local time has decided.
#[test]
fn what_local_time_decides_is_decided() {
    let p = families::philosophers(7);
    let (model, goals) = (model(&p), never_and(&p, false));
    let budget = SearchBudget { states: 20_000, ..SearchBudget::default() };
    let search = |time| {
        let options = hrdsl_ta::SearchOptions { time, budget, ..hrdsl_ta::SearchOptions::default() };
        explore(&model, &goals, &options, &|_| true).unwrap().goals
    };
    assert_eq!(search(TimeFrame::Common), [GoalOutcome::Inconclusive(SearchCutoff::States)]);
    assert_eq!(search(TimeFrame::Chosen), [GoalOutcome::Unreachable]);
}

/// A goal that only a run whose time goes back would meet.
fn is_out_of_order(p: &Program, a: (usize, u16), b: (usize, u16)) {
    let at = |(automaton, l): (usize, u16)| StateFormula::At { automaton, location: LocationId(l) };
    let goal = |what| ReachabilityGoal { what: GoalKind::Condition(what), settled: false };
    let goals = [goal(StateFormula::And(vec![at(a), at(b)])), goal(at(a))];
    let report = local::explore(&model(p), &goals, &LocalSearchOptions::default(), &|_| true).unwrap();
    assert_eq!(report.goals[0], GoalOutcome::Unreachable);
    agree(p);
}

#[test]
fn a_shared_variable_is_written_before_it_is_read() {
    let mut p = program();
    let s = shared(&mut p, "s", 0, 1, 0);
    let mut late = automaton("Late", &["x"]);
    let (a, b) = (normal(&mut late, "a"), normal(&mut late, "b"));
    edge(a, b).clock(0, ClockOp::Ge, 3).set(s, n(1)).to(&mut late);
    add(&mut p, late);
    let mut early = automaton("Early", &["y"]);
    let (a, b) = (normal(&mut early, "a"), normal(&mut early, "b"));
    edge(a, b).clock(0, ClockOp::Le, 2).when(eq(v(s), n(1))).to(&mut early);
    add(&mut p, early);
    is_out_of_order(&p, (0, 1), (1, 1));
}

#[test]
fn a_shared_clock_is_read_when_it_is_set() {
    let mut p = program();
    p.clocks.push("g".into());
    let mut late = automaton("Late", &["x"]);
    let (a, b) = (normal(&mut late, "a"), normal(&mut late, "b"));
    edge(a, b).clock(1, ClockOp::Ge, 3).reset(0).to(&mut late);
    add(&mut p, late);
    let mut early = automaton("Early", &["y"]);
    let (a, b) = (normal(&mut early, "a"), normal(&mut early, "b"));
    edge(a, b).clock(1, ClockOp::Eq, 2).clock(0, ClockOp::Lt, 1).to(&mut early);
    add(&mut p, early);
    is_out_of_order(&p, (0, 1), (1, 1));
}

/// The one leaves before three, or goes off from three on; the other tells it, until two.
fn leaving(stay_away: impl Fn(&mut Program) -> [hrdsl_ir::ta::ChannelId; 2], multi_way: bool) -> Program {
    let mut p = program();
    let [told, tell] = stay_away(&mut p);
    let mut one = automaton("One", &["x"]);
    let (here, off, left) = (normal(&mut one, "here"), normal(&mut one, "off"), normal(&mut one, "left"));
    edge(here, off).clock(0, ClockOp::Ge, 3).to(&mut one);
    let hears = edge(here, left);
    if multi_way { hears.join(told) } else { hears.accept(told, &[]) }.to(&mut one);
    add(&mut p, one);
    let mut other = automaton("Other", &["y"]);
    let (a, b) = (normal(&mut other, "a"), normal(&mut other, "b"));
    let tells = edge(a, b).clock(0, ClockOp::Le, 2);
    if multi_way { tells.join(tell) } else { tells.offer(tell, &[]) }.to(&mut other);
    add(&mut p, other);
    p
}

#[test]
fn who_stays_away_from_a_broadcast_does_so_at_its_time() {
    let cast = |p: &mut Program| [channel(p, "cast", ChannelKind::Broadcast, &[]); 2];
    is_out_of_order(&leaving(cast, false), (0, 1), (1, 1));
}

#[test]
fn who_stays_away_from_a_multi_way_channel_does_so_at_its_time() {
    let participant = |i, optional| ChannelParticipant { automaton: AutomatonId(i), optional };
    let kind = ChannelKind::MultiWay(vec![participant(0, true), participant(1, false)]);
    let multi_way = |p: &mut Program| [channel(p, "all", kind.clone(), &[]); 2];
    is_out_of_order(&leaving(multi_way, true), (0, 1), (1, 1));
}

/// One automaton writes what another's invariant says, another has an urgent channel, a third a difference of clocks.
#[test]
fn what_local_time_does_not_serve_is_refused() {
    let refusal =
        |p: &Program| match local::explore(&model(p), &[], &LocalSearchOptions::default(), &|_| true) {
            Err(LocalSearchError::NotApplicable(why)) => why.to_string(),
            other => panic!("{other:?}"),
        };
    let mut p = program();
    let s = shared(&mut p, "s", 0, 1, 0);
    let mut one = automaton("One", &["x"]);
    let a = normal(&mut one, "a");
    one.locations[0].holds = Some(eq(v(s), n(0)));
    edge(a, a).to(&mut one);
    add(&mut p, one);
    let mut other = automaton("Other", &["y", "z"]);
    let b = normal(&mut other, "b");
    edge(b, b).set(s, n(1)).to(&mut other);
    add(&mut p, other);
    let why = refusal(&p);
    assert_eq!(why, "the invariant of `a` of `One` depends on `s`, which other automata change or share");
    p.automata[0].locations[0].holds = None;
    let hurry = channel(&mut p, "hurry", ChannelKind::Binary, &[]);
    p.channels[0].urgent = true;
    p.automata[0].edges[0] = edge(a, a).offer(hurry, &[]).0;
    assert_eq!(refusal(&p), "channel `hurry` is urgent");
    p.channels[0].urgent = false;
    let high = ReachabilityGoal {
        what: GoalKind::Formula(QueryFormula::Clock(common::clock(0, ClockOp::Ge, 1))),
        settled: false,
    };
    let refused = local::explore(&model(&p), &[high], &LocalSearchOptions::default(), &|_| true);
    assert_eq!(refused, Err(LocalSearchError::NotApplicable(NotApplicableError::ClockGoal)));
    let mut apart = common::clock(0, ClockOp::Le, 3);
    apart.minus = Some(hrdsl_ir::ta::ClockId(1));
    p.automata[1].edges[0].clock_guard.push(apart);
    assert_eq!(refusal(&p), "`Other` has a bound on a difference of clocks");
}

/// A variable leaves its range after two steps of one automaton; the other can no longer wait then, or it can.
#[test]
fn faults_are_met_where_all_can_be() {
    for (patience, faulty) in [(1, false), (4, true)] {
        let mut p = program();
        let mut one = automaton("One", &["x"]);
        one.vars.push(common::var("k", 0, 1, 0));
        let (a, b) = (normal(&mut one, "a"), normal(&mut one, "b"));
        edge(a, b).clock(0, ClockOp::Ge, 1).reset(0).to(&mut one);
        edge(b, b).clock(0, ClockOp::Ge, 2).set(0, n(2)).to(&mut one);
        add(&mut p, one);
        let mut other = automaton("Other", &["y"]);
        common::location(
            &mut other,
            "c",
            hrdsl_ir::ta::LocationKind::Normal,
            &[common::clock(0, ClockOp::Le, patience)],
        );
        add(&mut p, other);
        match local::explore(&model(&p), &[], &LocalSearchOptions::default(), &|_| true) {
            Ok(report) => assert!(report.complete && !faulty),
            Err(LocalSearchError::Search(SearchError::Model {
                error: ModelError::Range { value: 2, .. },
                witness,
            })) => {
                assert!(faulty);
                assert_eq!(witness.unwrap().steps.len(), 1);
            }
            Err(other) => panic!("{other}"),
        }
    }
}

/// Edges of few kinds, so that they meet.
fn draft(kinds: [u8; 3]) -> impl Strategy<Value = Draft> {
    // Clocks are seldom the shared one.
    let clock = || 0..8u16;
    let guard = proptest::option::weighted(0.7, (clock(), 0..5u8, 0..4i64));
    let copied = prop_oneof![4 => Just(None), 1 => clock().prop_map(Some)];
    let reset = proptest::option::weighted(0.3, (clock(), copied, prop_oneof![4 => Just(0), 1 => 0..3i64]));
    let shared = prop_oneof![
        2 => Just((None, None)),
        1 => (proptest::option::of(0..2i64), proptest::option::of(0..2i64)),
    ];
    let sync = prop_oneof![1 => Just(9), 2 => (0..3usize).prop_map(move |i| kinds[i])];
    let ends = (0..3u16, 0..3u16);
    (ends, sync, guard, reset, shared).prop_map(|((from, to), sync, guard, reset, shared)| Draft {
        from,
        to,
        sync,
        guard,
        reset,
        shared,
    })
}

fn member(kinds: [u8; 3]) -> impl Strategy<Value = Member> {
    let location = (0..16u8, proptest::option::weighted(0.25, (0..2u16, 0..4i64)));
    let locations = proptest::collection::vec(location, 2..=3);
    (0..=2u16, locations, proptest::collection::vec(draft(kinds), 2..=5))
        .prop_map(|(clocks, locations, edges)| Member { clocks, locations, edges })
}

fn members() -> impl Strategy<Value = Vec<Member>> {
    // Offers and accepts of a binary synchronisation, a broadcast, an event; a multi-way channel.
    let pairs = [[0, 2, 0], [1, 3, 2], [5, 6, 4], [7, 8, 5], [4, 4, 7], [9, 9, 9]];
    let kinds = prop_oneof![
        3 => (0..pairs.len()).prop_map(move |i| pairs[i]),
        1 => [0..13u8, 0..13u8, 0..13u8],
    ];
    kinds.prop_flat_map(|kinds| proptest::collection::vec(member(kinds), 2..=4))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_networks_have_the_same_answers(
        members in members(),
        optional in any::<[bool; 3]>(),
    ) {
        let p = local_nets::random(&members, optional);
        agree(&p);
    }
}
