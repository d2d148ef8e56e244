//! Each kind of query on the standard families, next to plain searches of the same networks.
//!
//! `cargo bench -p hrdsl-ta --bench queries -- [NAME] [--kind KIND]`

#[path = "../tests/common/mod.rs"]
mod common;

use common::{asked, families, processor::seconds};
use hrdsl_ir::{
    Program,
    suite::WitnessKind,
    ta::{ClockId, LocationId, QueryFormula, QueryKind, QueryMeasure},
};
use hrdsl_ta::{
    CompiledNetwork, ObservationOptions, QueryOptions, SearchOptions, SearchOrder, SubsumptionRelation,
    answer, explore,
};

/// What a query is compared with.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Measured {
    /// All that can be reached, by default options.
    Reachability,
    /// As that, by equality alone.
    WithoutInclusion,
    Query,
}

/// A name, what is done, the query, and its witness.
type Job = (&'static str, Measured, Option<QueryKind>, WitnessKind);

/// Name, size, model, a location of an automaton to come to, one of its clocks, and a location of it that it always leaves.
type Family = (&'static str, i64, fn(i64) -> Program, (u16, u16), u16, (u16, u16));

/// Of Fischer: a process in its critical section, and one that has asked; of CSMA/CD: a station that retries, and one that sends; of the
/// trains: the last one crosses, and it comes; of the critical region: a cell is in error, and it is being tested.
const FAMILIES: [Family; 4] = [
    ("fischer", 7, families::fischer, (6, 3), 6, (6, 1)),
    ("csma_cd", 9, families::csma_cd, (9, 2), 9, (9, 1)),
    ("train_gate", 4, families::train_gate, (4, 4), 3, (4, 1)),
    ("critical_region", 3, families::critical_region, (6, 5), 2, (6, 1)),
];

fn jobs(there: (u16, u16), clock: u16, left: (u16, u16)) -> Vec<Job> {
    let at = |(automaton, l): (u16, u16)| QueryFormula::At { automaton, location: LocationId(l) };
    let there = || at(there);
    // The one there, and another where it always leaves, in its own time.
    let other = (left.0 - 1, left.1);
    let later = || QueryFormula::And(vec![there(), at(other)]);
    let never = || QueryFormula::And(vec![there(), QueryFormula::Not(Box::new(there()))]);
    let not = |f| QueryFormula::Not(Box::new(f));
    let of = || vec![QueryMeasure::Clock(ClockId(clock))];
    let any = WitnessKind::Any;
    let query = |name, ask| (name, Measured::Query, Some(ask), any);
    vec![
        ("reachability", Measured::Reachability, None, any),
        ("without inclusion", Measured::WithoutInclusion, None, any),
        query("E<> false", QueryKind::Possibly(never())),
        query("A[] not deadlock", QueryKind::Invariantly(not(QueryFormula::Deadlock))),
        query("sup", QueryKind::Sup { of: of(), when: there() }),
        query("inf", QueryKind::Inf { of: of(), when: there() }),
        query("A<>", QueryKind::Eventually(there())),
        query("-->", QueryKind::LeadsTo(at(left), not(at(left)))),
        ("shortest", Measured::Query, Some(QueryKind::Possibly(there())), WitnessKind::Shortest),
        ("fastest", Measured::Query, Some(QueryKind::Possibly(there())), WitnessKind::Fastest),
        ("shortest, later", Measured::Query, Some(QueryKind::Possibly(later())), WitnessKind::Shortest),
        ("fastest, later", Measured::Query, Some(QueryKind::Possibly(later())), WitnessKind::Fastest),
    ]
}

fn run(p: &Program, (_, measured, ask, witness): &Job) -> String {
    let explored = |options: &SearchOptions| {
        let model = CompiledNetwork::new(p, &p.networks[0], &ObservationOptions::default());
        let report =
            model.map_err(hrdsl_ta::SearchError::from).and_then(|m| explore(&m, &[], options, &|_| true));
        report.map_or_else(|e| e.to_string(), |r| format!("{} states", r.states_stored))
    };
    match (measured, ask) {
        (Measured::WithoutInclusion, _) => explored(&SearchOptions {
            subsumption: SubsumptionRelation::Equality,
            order: SearchOrder::Breadth,
            ..SearchOptions::default()
        }),
        (Measured::Query, Some(ask)) => {
            let query = asked::query(ask.clone());
            let options = QueryOptions { witness: *witness, ..QueryOptions::default() };
            let answer = answer(p, &p.networks[0], &query, &options);
            answer.map_or_else(|e| e.to_string(), |a| format!("{:?}: {}", a.verdict, a.why))
        }
        (Measured::Reachability | Measured::Query, _) => explored(&SearchOptions::default()),
    }
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let after = |flag: &str| args.iter().position(|a| a == flag).and_then(|i| args.get(i + 1));
    let only = args.first().filter(|a| !a.starts_with("--"));
    println!("{:<16} {:>4} {:<18} {:>8}", "family", "size", "question", "CPU s");
    for (name, size, make, place, clock, left) in FAMILIES {
        if only.is_some_and(|o| !name.starts_with(o.as_str())) {
            continue;
        }
        let p = make(size);
        for job in jobs(place, clock, left) {
            if after("--kind").is_some_and(|k| job.0 != k.as_str()) {
                continue;
            }
            let start = seconds();
            let said = run(&p, &job);
            println!("{name:<16} {size:>4} {:<18} {:>8.2}   {said}", job.0, seconds() - start);
        }
    }
}
