//! Exhaustive exploration of the standard families.

#[path = "../tests/common/mod.rs"]
mod common;

use common::families;
use hrdsl_ir::Program;
use hrdsl_ta::{Budget, check};

fn main() {
    divan::main();
}

fn explore(p: &Program) -> usize {
    let report = check(p, &p.networks[0], &[], &[], &[], Budget::default());
    report.map_or(0, |r| r.states_stored)
}

#[divan::bench(args = [6, 7, 8, 9], sample_count = 5)]
fn fischer(bencher: divan::Bencher, count: i64) {
    let p = families::fischer(count);
    bencher.bench(|| explore(&p));
}

#[divan::bench(args = [6, 7, 8], sample_count = 5)]
fn csma_cd(bencher: divan::Bencher, count: i64) {
    let p = families::csma_cd(count);
    bencher.bench(|| explore(&p));
}

#[divan::bench(args = [6, 8], sample_count = 5)]
fn fddi(bencher: divan::Bencher, count: i64) {
    let p = families::fddi(count);
    bencher.bench(|| explore(&p));
}

#[divan::bench(args = [3, 4], sample_count = 5)]
fn train_gate(bencher: divan::Bencher, count: i64) {
    let p = families::train_gate(count);
    bencher.bench(|| explore(&p));
}
