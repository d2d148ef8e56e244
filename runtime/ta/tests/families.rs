//! The numbers of stored states of the standard families, as published or known from other model checkers, and that
//! nothing but the number of steps depends on how a search is done.

mod common;

use common::{asked::ask_with, families};
use hrdsl_ir::{
    Program,
    suite::WitnessKind,
    ta::{ClockId, LocationId, QueryFormula, QueryKind, QueryMeasure},
    value::SECOND,
};
use hrdsl_ta::{
    CompiledNetwork, ExtremumLimit, ExtremumValue, GoalKind, GoalOutcome, ObservationOptions, QueryAnswer,
    QueryOptions, QueryVerdict, ReachabilityGoal, SearchOptions, SearchOrder, SearchReport, StateFormula,
    SubsumptionRelation, explore,
};

fn search(p: &Program, goals: &[ReachabilityGoal], options: &SearchOptions) -> SearchReport {
    let model = CompiledNetwork::new(p, &p.networks[0], &ObservationOptions::default()).unwrap();
    explore(&model, goals, options, &|_| true).unwrap()
}

/// States stored by the plain zone graph.
fn stored(p: &Program) -> usize {
    let report = search(p, &[], &SearchOptions::reference());
    assert!(report.complete);
    report.states_stored
}

#[test]
fn fischer() {
    assert_eq!(stored(&families::fischer(6)), 2_378);
    assert_eq!(stored(&families::fischer(7)), 7_737);
    assert_eq!(stored(&families::fischer(8)), 25_080);
}

#[test]
fn fischer_without_inclusion() {
    let options = SearchOptions { subsumption: SubsumptionRelation::Equality, ..SearchOptions::reference() };
    assert_eq!(search(&families::fischer(8), &[], &options).states_visited, 122_184);
}

#[test]
fn csma_cd() {
    assert_eq!(stored(&families::csma_cd(8)), 20_738);
}

#[test]
fn fddi() {
    assert_eq!(stored(&families::fddi(8)), 341);
    assert_eq!(stored(&families::fddi(10)), 525);
    assert_eq!(search(&families::fddi(10), &[], &SearchOptions::reference()).states_visited, 10_219);
}

#[test]
fn critical_region() {
    assert_eq!(stored(&families::critical_region(3)), 3_015);
    // Simulation drives out as much as inclusion does; breadth first is the slower way there.
    let whole = search(&families::critical_region(4), &[], &SearchOptions::default());
    assert_eq!((whole.complete, whole.states_stored), (true, 53_697));
}

/// As TChecker's own generators make them.
#[test]
fn families_of_independent_automata() {
    assert_eq!(stored(&families::fire_alarm(8)), 279);
    assert_eq!(stored(&families::corsso(2)), 573);
    assert_eq!(stored(&families::fischer_async(6)), 2_378);
    assert_eq!(stored(&families::fischer_async(7)), 7_737);
}

#[test]
fn train_gate() {
    assert_eq!(stored(&families::train_gate(4)), 12_000);
}

#[test]
fn philosophers() {
    assert_eq!(stored(&families::philosophers(5)), 911);
    assert_eq!(stored(&families::philosophers(6)), 5_480);
}

#[test]
fn parallel() {
    assert_eq!(stored(&families::parallel(8)), 257);
    assert_eq!(stored(&families::parallel(10)), 1_025);
}

#[test]
fn fischer_excludes() {
    let p = families::fischer(4);
    let cs = |automaton| StateFormula::At { automaton, location: LocationId(3) };
    let goal = |f| ReachabilityGoal { what: GoalKind::Condition(f), settled: false };
    let goals = [goal(StateFormula::And(vec![cs(0), cs(1)])), goal(cs(2))];
    let report = search(&p, &goals, &SearchOptions::shortest());
    assert_eq!(report.goals[0], GoalOutcome::Unreachable);
    let GoalOutcome::Reached(witness) = &report.goals[1] else { panic!("not reached") };
    // K = 10 is a strict bound: one nanosecond more.
    assert_eq!(witness.nanos(witness.steps.last().unwrap()), 10_000_000_001);
}

fn asked(p: &Program, ask: QueryKind, witness: WitnessKind) -> QueryAnswer {
    ask_with(p, ask, &QueryOptions { witness, ..QueryOptions::default() })
}

/// As many states as reachability takes, or less: not those of a second, finer search.
#[test]
fn deadlocks_take_no_more_states_than_reachability() {
    let never = QueryKind::Possibly(QueryFormula::Deadlock);
    for p in [families::fischer(6), families::train_gate(4), families::critical_region(3)] {
        let options = SearchOptions { order: SearchOrder::Breadth, ..SearchOptions::default() };
        let reached = search(&p, &[], &options).states_stored;
        let found = asked(&p, never.clone(), WitnessKind::Any);
        let seen = format!("no run reaches it: all that can be reached was seen ({reached} symbolic states)");
        assert_eq!((found.verdict, found.why), (QueryVerdict::Fails, seen));
    }
    // A station that has begun cannot be told of a collision that is noticed late.
    let found = asked(&families::csma_cd(5), never, WitnessKind::Shortest);
    assert_eq!(found.run.unwrap().steps.len(), 3);
}

#[test]
fn bounds_and_fastest_runs_of_families() {
    let at = |automaton, l| QueryFormula::At { automaton, location: LocationId(l) };
    let of = |clock| vec![QueryMeasure::Clock(ClockId(clock))];
    let seconds = |n, attained| ExtremumLimit::At { value: ExtremumValue::Nanos(n * SECOND), attained };
    let limit = |p: &Program, ask| asked(p, ask, WitnessKind::Any).extrema[0].limit;
    let trains = families::train_gate(3);
    assert_eq!(limit(&trains, QueryKind::Sup { of: of(0), when: at(1, 4) }), seconds(5, true));
    let csma = families::csma_cd(4);
    assert_eq!(limit(&csma, QueryKind::Sup { of: of(4), when: at(4, 2) }), seconds(52, false));
    let fischer = families::fischer(4);
    assert_eq!(limit(&fischer, QueryKind::Inf { of: of(3), when: at(3, 3) }), seconds(10, false));
    assert_eq!(limit(&fischer, QueryKind::Sup { of: of(3), when: at(3, 3) }), ExtremumLimit::Unbounded);
    let fast = asked(&families::critical_region(2), QueryKind::Possibly(at(4, 5)), WitnessKind::Fastest);
    assert_eq!(fast.run.unwrap().end, 10 * SECOND);
}

#[test]
fn liveness_of_families() {
    let at = |automaton, l| QueryFormula::At { automaton, location: LocationId(l) };
    let leaves = |p: &Program, automaton, l| {
        let left = QueryFormula::Not(Box::new(at(automaton, l)));
        asked(p, QueryKind::LeadsTo(at(automaton, l), left), WitnessKind::Any).verdict
    };
    // Who has asked goes on within K; who is in the critical section may stay for ever.
    assert_eq!(leaves(&families::fischer(5), 4, 1), QueryVerdict::Holds);
    assert_eq!(leaves(&families::fischer(5), 4, 3), QueryVerdict::Fails);
    assert_eq!(leaves(&families::train_gate(3), 3, 1), QueryVerdict::Holds);
}

/// All locations, and whether two automata can be in their last ones at once.
fn questions(p: &Program) -> Vec<ReachabilityGoal> {
    let mut goals = Vec::new();
    let mut last = Vec::new();
    for (automaton, a) in p.automata.iter().enumerate() {
        for l in 0..a.locations.len() as u16 {
            let what = GoalKind::Location { automaton, location: LocationId(l) };
            goals.push(ReachabilityGoal { what, settled: false });
        }
        last.push(StateFormula::At { automaton, location: LocationId(a.locations.len() as u16 - 1) });
    }
    for pair in last.windows(2) {
        goals.push(ReachabilityGoal {
            what: GoalKind::Condition(StateFormula::And(pair.to_vec())),
            settled: true,
        });
    }
    goals
}

fn reached(r: &SearchReport) -> Vec<bool> {
    r.goals.iter().map(|g| matches!(g, GoalOutcome::Reached(_))).collect()
}

/// Whatever the order, what is stored and the threads.
fn options() -> Vec<SearchOptions> {
    let mut all = Vec::new();
    for order in
        [SearchOrder::Breadth, SearchOrder::Depth, SearchOrder::RandomDepth, SearchOrder::Topological]
    {
        for keep_committed in [false, true] {
            for subsumption in [
                SubsumptionRelation::Simulation,
                SubsumptionRelation::Inclusion,
                SubsumptionRelation::Equality,
            ] {
                all.push(SearchOptions {
                    order,
                    keep_committed,
                    subsumption,
                    seed: 7,
                    ..SearchOptions::default()
                });
            }
        }
    }
    all
}

#[test]
fn verdicts_depend_on_nothing() {
    for p in [families::fischer(4), families::manufacture(30)] {
        let goals = questions(&p);
        let reference = search(&p, &goals, &SearchOptions::reference());
        for options in options() {
            let one = search(&p, &goals, &options);
            assert_eq!(reached(&one), reached(&reference), "{options:?}");
            let two = search(&p, &goals, &SearchOptions { threads: 2, ..options });
            assert_eq!(one, two, "{options:?}");
        }
    }
}

#[test]
fn threads_change_nothing() {
    let models = [
        families::csma_cd(5),
        families::fddi(4),
        families::critical_region(2),
        families::train_gate(4),
        families::philosophers(4),
        families::parallel(6),
    ];
    for p in models {
        for options in options() {
            let one = search(&p, &[], &options);
            assert!(one.complete);
            assert_eq!(one, search(&p, &[], &SearchOptions { threads: 2, ..options }), "{options:?}");
            assert_eq!(one, search(&p, &[], &SearchOptions { threads: 3, ..options }), "{options:?}");
        }
    }
}

#[test]
fn simulation_stores_no_more_than_inclusion() {
    for p in [families::fischer(5), families::csma_cd(5), families::fddi(4), families::critical_region(2)] {
        let options =
            SearchOptions { subsumption: SubsumptionRelation::Simulation, ..SearchOptions::reference() };
        assert!(search(&p, &[], &options).states_stored <= stored(&p));
    }
}
