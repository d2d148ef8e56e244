//! Exhaustive exploration with local time, next to the figures of TChecker (local-time zones with sync subsumption, one
//! core) and to the search with global time.
//!
//! `cargo bench -p hrdsl-ta --bench local -- [NAME]`

#[path = "../tests/common/mod.rs"]
mod common;

use common::{families, processor::seconds};
use hrdsl_ir::Program;
use hrdsl_ta::{CompiledNetwork, ObservationOptions, SearchOptions, SearchReport, explore, local};

/// Name, size, model; TChecker's states stored and seconds (0: not known); whether global time is tried, too.
type Row = (&'static str, i64, fn(i64) -> Program, usize, f64, bool);

const ROWS: [Row; 12] = [
    ("philosophers", 6, families::philosophers, 853, 0.0, true),
    ("philosophers", 7, families::philosophers, 2_627, 0.0, true),
    ("philosophers", 8, families::philosophers, 8_090, 0.0, false),
    ("philosophers", 9, families::philosophers, 24_914, 9.8, false),
    ("philosophers", 10, families::philosophers, 0, 0.0, false),
    ("fddi", 10, families::fddi, 0, 0.0, true),
    ("fddi", 12, families::fddi, 0, 0.0, true),
    ("parallel", 13, families::parallel, 0, 0.0, true),
    ("train_gate", 5, families::train_gate, 0, 0.0, true),
    ("csma_cd", 9, families::csma_cd, 0, 0.0, true),
    ("critical_region", 4, families::critical_region, 0, 0.0, true),
    ("fischer", 8, families::fischer, 0, 0.0, true),
];

fn timed<E: std::fmt::Display>(run: impl FnOnce() -> Result<SearchReport, E>) -> String {
    let start = seconds();
    match run() {
        Ok(r) => format!(
            "{:>8} stored {:>8} visited {:>6.2} s {:>7.1} MB",
            r.states_stored,
            r.states_visited,
            seconds() - start,
            r.peak_bytes as f64 / 1e6
        ),
        Err(e) => e.to_string(),
    }
}

fn main() {
    let only = std::env::args().skip(1).find(|a| !a.starts_with('-'));
    for (name, size, build, stored, time, global) in ROWS {
        if only.as_ref().is_some_and(|o| o != name) {
            continue;
        }
        let p = build(size);
        let model = match CompiledNetwork::new(&p, &p.networks[0], &ObservationOptions::default()) {
            Ok(model) => model,
            Err(e) => {
                println!("{name} {size}: {e}");
                continue;
            }
        };
        let local = timed(|| local::explore(&model, &[], &local::LocalSearchOptions::default(), &|_| true));
        println!("{name:>16} {size:>3} local  {local} (TChecker: {stored} in {time} s)");
        if global {
            let global = timed(|| explore(&model, &[], &SearchOptions::default(), &|_| true));
            println!("{name:>16} {size:>3} global {global}");
        }
    }
}
