//! How fast agents reason: goals adopted, messages, many agents, deep recursion. `benches/agentspeak` has the same
//! programs for other interpreters.

use divan::Bencher;
use divan::counter::ItemsCount;
use hrdsl_bdi::{AgentSociety, RunStatus};
use hrdsl_ir::Program;

#[allow(dead_code, reason = "what tests alone use")]
#[path = "../tests/programs/mod.rs"]
mod programs;

fn main() {
    divan::main();
}

fn run(program: &Program) -> AgentSociety<'_> {
    let mut society = AgentSociety::new(program, &programs::all(program), 0);
    society.set_cycle_limit(u64::MAX);
    society.run(0, &mut Vec::new());
    assert_eq!(society.status(), RunStatus::Idle);
    society
}

/// One agent, a counter loop: goals a second.
#[divan::bench(sample_count = 10, sample_size = 1)]
fn goals(bencher: Bencher<'_, '_>) {
    const GOALS: i64 = 2_000_000;
    let program = programs::program(vec![programs::counter(GOALS)]);
    bencher.counter(ItemsCount::new(GOALS as usize)).bench(|| run(&program));
}

/// Two agents: messages a second.
#[divan::bench(sample_count = 10, sample_size = 1)]
fn messages(bencher: Bencher<'_, '_>) {
    const MESSAGES: i64 = 1_000_000;
    let program = programs::messages(MESSAGES);
    bencher.counter(ItemsCount::new(MESSAGES as usize)).bench(|| run(&program));
}

/// 1000 agents, 1000 goals each.
#[divan::bench(sample_count = 10, sample_size = 1)]
fn crowd(bencher: Bencher<'_, '_>) {
    let program = programs::crowd(1000, 1000);
    bencher.counter(ItemsCount::new(1_000_000_usize)).bench(|| run(&program));
}

/// Goals that wait for each other, so deep: linear if the rate stays.
#[divan::bench(args = [10_000, 100_000, 1_000_000], sample_count = 10, sample_size = 1)]
fn deep(bencher: Bencher<'_, '_>, depth: i64) {
    let program = programs::deep(depth);
    bencher.counter(ItemsCount::new(depth as usize)).bench(|| run(&program));
}
