//! 91 goals at once, in a network with an int that counts time up to 1,000.
//!
//! `cargo bench -p hrdsl-ta --bench goals -- [--without-counters] [--breadth] [--goals N] [--end N]`

#[path = "../tests/common/mod.rs"]
mod common;

use common::deadlines;

use hrdsl_ta::{
    CompiledNetwork, GoalKind, GoalOutcome, ObservationOptions, ReachabilityGoal, SearchOptions, explore,
};

/// The most memory that this process has had, in megabytes.
fn most_megabytes() -> f64 {
    #[allow(clippy::disallowed_methods, reason = "a bench reads what its process takes")]
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    line.and_then(|l| l.split_whitespace().next()?.parse::<f64>().ok()).unwrap_or(0.0) / 1000.0
}

/// User seconds of this process.
fn seconds() -> f64 {
    #[allow(clippy::disallowed_methods, reason = "a bench reads the clock of its process")]
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after = stat.rsplit(')').next().unwrap_or("");
    after.split_whitespace().nth(11).and_then(|s| s.parse::<f64>().ok()).unwrap_or(0.0) / 100.0
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let has = |flag: &str| args.iter().any(|a| a == flag);
    let after = |flag: &str| args.iter().position(|a| a == flag).and_then(|i| args.get(i + 1)?.parse().ok());
    let end = after("--end").unwrap_or(1000);
    let mut options = SearchOptions { counters: !has("--without-counters"), ..SearchOptions::default() };
    if has("--breadth") {
        options.order = hrdsl_ta::SearchOrder::Breadth;
    }
    let p = deadlines::shift(end);
    let mut goals = deadlines::goals(end);
    goals.truncate(usize::try_from(after("--goals").unwrap_or(91)).unwrap_or(91));
    let observe = ObservationOptions { formulas: goals.clone(), ..ObservationOptions::default() };
    let goal = |f| ReachabilityGoal { what: GoalKind::Formula(f), settled: false };
    let goals: Vec<ReachabilityGoal> = goals.into_iter().map(goal).collect();
    let start = seconds();
    let model = CompiledNetwork::new(&p, &p.networks[0], &observe).expect("the model is sound");
    let report = explore(&model, &goals, &options, &|_| true).expect("the model has no fault");
    let count = |f: fn(&GoalOutcome) -> bool| report.goals.iter().filter(|o| f(o)).count();
    println!(
        "reached {}, unreachable {}, open {}; {} states stored, {} visited; {:.2} CPU s, {:.1} MB of states, {:.1} MB in all",
        count(|o| matches!(o, GoalOutcome::Reached(_))),
        count(|o| matches!(o, GoalOutcome::Unreachable)),
        count(|o| matches!(o, GoalOutcome::Inconclusive(_))),
        report.states_stored,
        report.states_visited,
        seconds() - start,
        report.peak_bytes as f64 / 1e6,
        most_megabytes(),
    );
}
