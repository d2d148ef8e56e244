//! Exhaustive exploration of the standard families, next to the figures of TChecker (covreach, one core).
//!
//! `cargo bench -p hrdsl-ta --bench families -- [NAME] [--threads N] [--reference] [--order breadth|depth|topological]
//! [--skip-committed] [--size N]`

#[path = "../tests/common/mod.rs"]
mod common;

use common::{families, processor::seconds};
use hrdsl_ir::{Program, ta::LocationId};
use hrdsl_ta::{
    CompiledNetwork, GoalKind, ObservationOptions, ReachabilityGoal, SearchOptions, SearchOrder,
    StateFormula, explore,
};

/// Name, size, model; TChecker's states stored, seconds, megabytes (0: not known).
type Row = (&'static str, i64, fn(i64) -> Program, usize, f64, f64);

const ROWS: [Row; 17] = [
    ("fischer", 8, families::fischer, 25_080, 1.2, 0.0),
    ("fischer", 9, families::fischer, 81_035, 6.1, 0.0),
    ("fischer", 10, families::fischer, 260_998, 34.0, 144.0),
    ("csma_cd", 9, families::csma_cd, 55_554, 2.2, 0.0),
    ("csma_cd", 10, families::csma_cd, 144_898, 7.7, 0.0),
    ("csma_cd", 11, families::csma_cd, 369_666, 0.0, 0.0),
    ("critical_region", 3, families::critical_region, 3_015, 0.0, 0.0),
    ("critical_region", 4, families::critical_region, 53_697, 2.3, 0.0),
    ("train_gate", 4, families::train_gate, 12_000, 0.0, 0.0),
    ("train_gate", 5, families::train_gate, 215_375, 2.7, 72.0),
    ("fddi", 8, families::fddi, 341, 0.0, 0.0),
    ("fddi", 10, families::fddi, 525, 1.4, 0.0),
    ("fddi", 12, families::fddi, 749, 10.0, 0.0),
    ("philosophers", 6, families::philosophers, 5_480, 0.0, 0.0),
    ("philosophers", 7, families::philosophers, 38_179, 6.9, 0.0),
    ("parallel", 13, families::parallel, 8_193, 0.0, 0.0),
    ("manufacture", 1000, families::manufacture, 0, 0.0, 0.0),
];

/// Edges, locations, and conditions on variables of the line of work.
fn line_goals(p: &Program) -> Vec<ReachabilityGoal> {
    let goal = |what| ReachabilityGoal { what, settled: false };
    let mut goals = Vec::new();
    for (automaton, a) in p.automata.iter().enumerate() {
        let places = (0..a.locations.len() as u16).map(LocationId);
        goals.extend(places.map(|location| goal(GoalKind::Location { automaton, location })));
    }
    let data = |e| goal(GoalKind::Condition(StateFormula::Data(e)));
    let is = |slot, k| common::eq(common::v(slot), common::n(k));
    goals.extend((0..8).map(|k| data(is(1, k))));
    goals.extend((0..29).map(|k| data(common::and(is(1, k % 8), is(0, 33 * k)))));
    // No run ends with more parts than there is room for: these are proofs.
    goals.extend((0..4).map(|k| data(common::and(is(1, 8), is(0, k)))));
    goals
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let has = |flag: &str| args.iter().any(|a| a == flag);
    let after = |flag: &str| args.iter().position(|a| a == flag).and_then(|i| args.get(i + 1));
    let mut options = if has("--reference") { SearchOptions::reference() } else { SearchOptions::default() };
    options.budget = hrdsl_ta::SearchBudget { states: 200_000_000, bytes: 4 << 30 };
    options.threads = after("--threads").and_then(|n| n.parse().ok()).unwrap_or(1);
    options.keep_committed &= !has("--skip-committed");
    match after("--order").map(String::as_str) {
        Some("breadth") => options.order = SearchOrder::Breadth,
        Some("depth") => options.order = SearchOrder::Depth,
        Some("topological") => options.order = SearchOrder::Topological,
        Some(_) | None => {}
    }
    let wanted = after("--size").and_then(|n| n.parse::<i64>().ok());
    let only = args.first().filter(|a| !a.starts_with("--"));
    println!(
        "{:<16} {:>4} {:>9} {:>9} {:>9} {:>9} {:>7} {:>8}   TChecker: stored, s, MB",
        "family", "size", "stored", "visited", "discrete", "steps", "CPU s", "MB"
    );
    for (name, size, make, stored, time, memory) in ROWS {
        if only.is_some_and(|o| !name.starts_with(o.as_str())) || wanted.is_some_and(|w| w != size) {
            continue;
        }
        let p = make(size);
        let goals = if name == "manufacture" { line_goals(&p) } else { Vec::new() };
        let start = seconds();
        let result = CompiledNetwork::new(&p, &p.networks[0], &ObservationOptions::default())
            .map_err(hrdsl_ta::SearchError::from)
            .and_then(|model| explore(&model, &goals, &options, &|_| true));
        let used = seconds() - start;
        match result {
            Ok(r) => println!(
                "{name:<16} {size:>4} {:>9} {:>9} {:>9} {:>9} {used:>7.2} {:>8.1}   {stored} {time} {memory}{}",
                r.states_stored,
                r.states_visited,
                r.discrete_states,
                r.transitions,
                r.peak_bytes as f64 / 1e6,
                if r.complete { "" } else { "  (not complete)" },
            ),
            Err(e) => println!("{name:<16} {size:>4} {e}"),
        }
    }
}
