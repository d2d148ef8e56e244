//! Exhaustive exploration of the standard families, next to TChecker's best algorithm on each.
//!
//! `cargo bench -p hrdsl-ta --bench families -- [NAME] [--size N] [--threads N] [--common-time] [--reference]
//! [--order breadth|depth|topological] [--skip-committed] [--tchecker PATH] [--examples FOLDER]`
//!
//! `cargo bench -p hrdsl-ta --bench families -- --speedup [--threads N]`: the wall clock with one thread and with two, or N; and of as many
//! processes with one thread at once, which is what the machine gives.
//!
//! Each row is a process of its own, so that its seconds (user and system, of all threads) and its memory (the most that was
//! resident) are those of the whole process, like TChecker's. TChecker's figures are read from `benches/tchecker.csv`, unless
//! `--tchecker` names a `tck-reach`, or one is on the PATH, and `--examples` TChecker's folder of that name: then its generators
//! make the models, and each of its algorithms that serves is measured, breadth first.

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "families/peer.rs"]
mod peer;
#[path = "families/speedup.rs"]
mod speedup;

use std::process::ExitCode;

use common::families;
use hrdsl_ir::{Program, ta::LocationId};
use hrdsl_ta::{
    CompiledNetwork, GoalKind, ObservationOptions, ReachabilityGoal, SearchBudget, SearchOptions,
    SearchOrder, SearchReport, StateFormula, explore,
};
use peer::{Peer, PeerFigures, children_seconds};

type Row = (&'static str, i64, fn(i64) -> Program);

/// Those that are compared; what else there is takes part where its name is given.
const ROWS: [Row; 15] = [
    ("fischer", 10, families::fischer),
    ("csma_cd", 11, families::csma_cd),
    ("critical_region", 4, families::critical_region),
    ("train_gate", 5, families::train_gate),
    ("fire_alarm", 14, families::fire_alarm),
    ("fischer_async", 7, families::fischer_async),
    ("corsso", 5, families::corsso),
    ("philosophers", 8, families::philosophers),
    ("fischer", 8, families::fischer),
    ("csma_cd", 9, families::csma_cd),
    ("critical_region", 3, families::critical_region),
    ("train_gate", 4, families::train_gate),
    ("fddi", 10, families::fddi),
    ("parallel", 13, families::parallel),
    ("manufacture", 1000, families::manufacture),
];
const COMPARED: usize = 8;

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

/// That the first automaton is in two locations at once: no state meets it, so that all are seen.
fn never() -> Vec<ReachabilityGoal> {
    let at = |l| StateFormula::At { automaton: 0, location: LocationId(l) };
    vec![ReachabilityGoal {
        what: GoalKind::Condition(StateFormula::And(vec![at(0), at(1)])),
        settled: false,
    }]
}

/// What was given on the command line.
struct BenchArgs(Vec<String>);

impl BenchArgs {
    fn has(&self, flag: &str) -> bool {
        self.0.iter().any(|a| a == flag)
    }

    fn after(&self, flag: &str) -> Option<&str> {
        self.0.iter().position(|a| a == flag).and_then(|i| self.0.get(i + 1)).map(String::as_str)
    }

    fn options(&self) -> SearchOptions {
        let mut options =
            if self.has("--reference") { SearchOptions::reference() } else { SearchOptions::default() };
        options.budget = SearchBudget { states: 200_000_000, bytes: 4 << 30 };
        options.threads = self.after("--threads").and_then(|n| n.parse().ok()).unwrap_or(1);
        options.keep_committed &= !self.has("--skip-committed");
        match self.after("--order") {
            Some("breadth") => options.order = SearchOrder::Breadth,
            Some("depth") => options.order = SearchOrder::Depth,
            Some("topological") => options.order = SearchOrder::Topological,
            Some(_) | None => {}
        }
        options
    }

    /// The rows that were asked for.
    fn rows(&self) -> Vec<Row> {
        let name = self.0.first().filter(|a| !a.starts_with("--"));
        let size = self.after("--size").and_then(|n| n.parse::<i64>().ok());
        let mut rows: Vec<Row> = match name {
            Some(name) => ROWS.into_iter().filter(|row| row.0.starts_with(name.as_str())).collect(),
            None => ROWS[..COMPARED].to_vec(),
        };
        if let Some(size) = size {
            rows.dedup_by_key(|row| row.0);
            rows.iter_mut().for_each(|row| row.1 = size);
        }
        rows
    }
}

/// The search of one row, in a process of its own.
fn one(args: &BenchArgs, (name, size, make): Row) -> Result<SearchReport, String> {
    let p = make(size);
    let goals = if name == "manufacture" { line_goals(&p) } else { never() };
    CompiledNetwork::new(&p, &p.networks[0], &ObservationOptions::default())
        .map_err(hrdsl_ta::SearchError::from)
        .and_then(|model| explore(&model, &goals, &args.options(), &|_| true))
        .map_err(|e| e.to_string())
}

/// The most memory that this process had resident, in megabytes.
fn most_resident() -> f64 {
    #[allow(clippy::disallowed_methods, reason = "a bench looks at its own process")]
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap_or_default();
    line.split_whitespace().next().and_then(|n| n.parse::<f64>().ok()).unwrap_or(0.0) * 1.024e-3
}

/// What the process of a row prints: the counts, then the memory.
fn print_one(report: &SearchReport) {
    let SearchReport { states_stored, states_visited, discrete_states, transitions, .. } = report;
    let left = if report.complete { "" } else { "left" };
    let local = report.chosen.as_deref().is_some_and(|why| why.starts_with("local"));
    let time = if local { "local" } else { "one" };
    println!(
        "{states_stored} {states_visited} {discrete_states} {transitions} {:.1} {time} {left}",
        most_resident()
    );
}

/// What the process of a row printed and took.
struct RowFigures {
    /// Stored, visited, discrete, steps, megabytes.
    numbers: Vec<f64>,
    /// Whose time the zones told.
    time: &'static str,
    left: bool,
    seconds: f64,
}

/// Runs the row in a process of its own.
fn measured(args: &BenchArgs, row: Row) -> Result<RowFigures, String> {
    let me = std::env::current_exe().map_err(|e| e.to_string())?;
    let mut command = peer::command(&me);
    command.args(["--one", row.0, "--of", &row.1.to_string()]).args(&args.0);
    let before = children_seconds();
    let out = command.output().map_err(|e| e.to_string())?;
    let seconds = children_seconds() - before;
    if !out.status.success() {
        return Err(String::from_utf8_lossy(&out.stderr).trim().to_owned());
    }
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    let numbers = text.split_whitespace().filter_map(|w| w.parse().ok()).collect();
    let time = if text.contains("local") { "local" } else { "one" };
    Ok(RowFigures { numbers, time, left: text.contains("left"), seconds })
}

fn line(row: Row, ours: &RowFigures, peer: Option<&PeerFigures>) -> String {
    let RowFigures { numbers, time, left, seconds } = ours;
    let at = |i: usize| numbers.get(i).copied().unwrap_or(0.0);
    let head = format!("{:<16}{:>5}", row.0, row.1);
    let ours =
        format!("{:>9}{:>9}{:>9}{:>9}{time:>7}{seconds:>8.3}{:>7.1}", at(0), at(1), at(2), at(3), at(4));
    let theirs = peer.map_or(String::new(), |p| {
        format!(
            "  | {:<13}{:>9}{:>8.2}{:>8.1}  |{:>6.1} ×{:>6.1} ×",
            p.algorithm,
            p.stored,
            p.seconds,
            p.megabytes,
            p.seconds / seconds,
            p.megabytes / at(4)
        )
    });
    format!("{head}{ours}{theirs}{}", if *left { "  (not complete)" } else { "" })
}

fn main() -> ExitCode {
    let args = BenchArgs(std::env::args().skip(1).filter(|a| a != "--bench").collect());
    if let (Some(name), Some(size)) = (args.after("--one"), args.after("--of")) {
        let row = ROWS.into_iter().find(|row| row.0 == name);
        let (Some(row), Ok(size)) = (row, size.parse()) else { return ExitCode::FAILURE };
        return match one(&args, (row.0, size, row.2)) {
            Ok(report) => {
                print_one(&report);
                ExitCode::SUCCESS
            }
            Err(why) => {
                eprintln!("{why}");
                ExitCode::FAILURE
            }
        };
    }
    if args.has("--speedup") {
        let me = std::env::current_exe().map_err(|e| e.to_string());
        let threads = args.options().threads.max(2);
        return match me.and_then(|me| speedup::print(&me, threads)) {
            Ok(()) => ExitCode::SUCCESS,
            Err(why) => {
                eprintln!("{why}");
                ExitCode::FAILURE
            }
        };
    }
    let peer = match Peer::of(args.after("--tchecker"), args.after("--examples")) {
        Ok(peer) => peer,
        Err(why) => {
            eprintln!("{why}");
            return ExitCode::FAILURE;
        }
    };
    println!("TChecker: {}", peer.origin());
    println!(
        "{:<16}{:>5}{:>9}{:>9}{:>9}{:>9}{:>7}{:>8}{:>7}  | {:<13}{:>9}{:>8}{:>8}  |  CPU s     MB",
        "family",
        "size",
        "stored",
        "visited",
        "discrete",
        "steps",
        "time",
        "CPU s",
        "MB",
        "TChecker",
        "stored",
        "CPU s",
        "MB"
    );
    for row in args.rows() {
        match measured(&args, row) {
            Ok(ours) => println!("{}", line(row, &ours, peer.best(row.0, row.1).as_ref())),
            Err(why) => println!("{:<16}{:>5} {why}", row.0, row.1),
        }
    }
    ExitCode::SUCCESS
}
