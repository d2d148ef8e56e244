//! `hrdsl prove`: whether the networks of a scenario keep its requirements, and what its queries answer.

mod asked;
mod clock;
mod follow;
mod job;
mod show;
mod table;

use std::{path::PathBuf, sync::Arc, time::Duration};

use hrdsl_runtime::prove::{ProofOptions, TimeFrame};
use hrdsl_source::printable;

use super::search_options::{DelayArg, SearchOrderArg, SearchThreadsArgs, WitnessArg};
use crate::{edge_sources::EdgeSources, exit::CommandExit, fault::CommandFault, files, input, terminal};
use asked::QueriedScenario;
use clock::ProofClock;
use table::{ProofRow, PropertyKind};

/// Search the networks of a scenario: can they violate a requirement, and what do the queries answer?
///
/// All requirements and queries, unless some are named. A violation is shown by a run. An interrupt (Ctrl-C) ends the search with what is
/// known; a second one ends at once.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  hrdsl prove scenario.hri
  hrdsl prove scenario.hri --requirement R2 --trace
  hrdsl prove scenario.hri --ask 'E<> Robot.grasped and t > 5 s' --witness fastest --trace
  hrdsl prove scenario.hri --ask 'A[] not deadlock' --threads 2 --timeout 60s
  hrdsl prove scenario.hri --query live --mermaid live.mmd
  hrdsl prove scenario.hri --stream | jq -r 'select(.verdict) | .name + \" \" + .verdict'
  hrdsl prove scenario.hri --json > found.json; hrdsl prove changed.hri --follow found.json")]
pub struct ProveArgs {
    /// The scenario.
    file: PathBuf,
    /// Only this network; may be given several times.
    #[arg(long, value_name = "NAME")]
    network: Vec<String>,
    /// Only this requirement; may be given several times.
    #[arg(long, value_name = "NAME")]
    requirement: Vec<String>,
    /// Only this query; may be given several times.
    #[arg(long, value_name = "NAME")]
    query: Vec<String>,
    /// A query that the scenario does not have, as it would be written there after the `=`; may be given several times.
    #[arg(long, value_name = "QUERY")]
    ask: Vec<String>,
    #[command(flatten)]
    options: ProveSearchArgs,
    /// Stop after this time, like `60s` or `500ms`: what is not decided then is inconclusive.
    #[arg(long, value_name = "T", value_parser = crate::quantity::time)]
    timeout: Option<Duration>,
    /// Search nothing: say whether the runs of this file (JSON of `prove` or `step`, or UPPAAL's .xtr) are runs of the network, and
    /// where they leave it.
    #[arg(long, value_name = "TRACE", conflicts_with_all = ["requirement", "query", "ask", "trace", "mermaid", "dot"])]
    follow: Option<PathBuf>,
    /// Print a line of JSON for each answer as soon as it is decided, and the document of --json as the last one.
    #[arg(long, conflicts_with = "follow")]
    stream: bool,
    /// In JSON, say how many seconds each search took: then it is not the same each time.
    #[arg(long)]
    timings: bool,
    /// Tell each run that shows something, step by step.
    #[arg(long)]
    trace: bool,
    /// Write the first of these runs as a Mermaid sequence diagram.
    #[arg(long, value_name = "FILE")]
    mermaid: Option<PathBuf>,
    /// Write it as a Graphviz graph.
    #[arg(long, value_name = "FILE")]
    dot: Option<PathBuf>,
    /// One document on stdout, instead of text.
    #[arg(long)]
    json: bool,
}

/// How networks are searched: for `prove`.
#[derive(clap::Args)]
pub struct ProveSearchArgs {
    /// Which run shows what is found [default: shortest; with --order, any].
    #[arg(long, value_enum)]
    witness: Option<WitnessArg>,
    /// When its transitions happen.
    #[arg(long, value_enum, default_value_t = DelayArg::Earliest)]
    delays: DelayArg,
    /// In which order states are looked at [default: what the witness needs].
    #[arg(long, value_enum)]
    order: Option<SearchOrderArg>,
    /// Give each automaton a time of its own, where that serves: often fewer states if automata share little [default: if
    /// the beginning of the search shows that it does].
    #[arg(long)]
    local_time: bool,
    /// Have one time for all automata throughout.
    #[arg(long, conflicts_with = "local_time")]
    common_time: bool,
    /// Say with the answers of queries how they were searched, and why so.
    #[arg(long)]
    explain: bool,
    /// Do not store states with a committed location: often less memory, and less time. Runs may not be the shortest.
    #[arg(long)]
    skip_committed: bool,
    /// Keep states apart that differ in one-way counters alone, or in those that nobody reads: the same answers from more states.
    #[arg(long)]
    exact_counters: bool,
    #[command(flatten)]
    threads: SearchThreadsArgs,
    /// Everything random comes from this.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// The most symbolic states that one search stores; otherwise memory alone decides.
    #[arg(long, value_name = "N")]
    budget_states: Option<usize>,
    /// The most memory for them, like `2GB` or `500MB`.
    #[arg(long, value_name = "SIZE", value_parser = crate::quantity::data)]
    budget_memory: Option<u64>,
}

impl ProveSearchArgs {
    fn settings(&self) -> ProofOptions {
        let usual = if self.order.is_some() { WitnessArg::Any } else { WitnessArg::Shortest };
        let mut settings = ProofOptions {
            witness: self.witness.unwrap_or(usual).into(),
            delays: self.delays.into(),
            order: self.order.map(Into::into),
            time: match (self.local_time, self.common_time) {
                (true, _) => TimeFrame::Local,
                (false, true) => TimeFrame::Common,
                (false, false) => TimeFrame::Chosen,
            },
            explain: self.explain,
            skip_committed: self.skip_committed,
            exact_counters: self.exact_counters,
            threads: self.threads.count(),
            seed: self.seed,
            ..ProofOptions::default()
        };
        if let Some(states) = self.budget_states {
            settings.budget.states = states;
        }
        if let Some(bytes) = self.budget_memory {
            settings.budget.bytes = usize::try_from(bytes).unwrap_or(usize::MAX);
        }
        settings
    }
}

/// # Errors
/// A file, a name that does not exist, or an engine that contradicts itself.
pub fn run(args: &ProveArgs) -> Result<CommandExit, CommandFault> {
    let asked = QueriedScenario::load(args)?;
    let Some(program) = input::report_errors(&args.file, &asked.compilation) else {
        return Ok(CommandExit::Errors);
    };
    let sources = EdgeSources::of(&asked.compilation);
    if let Some(trace) = &args.follow {
        return follow::run(args, trace, program, &sources);
    }
    let jobs = asked.jobs(args, program)?;
    if jobs.is_empty() {
        return Err(
            "there is nothing to prove: the scenario has neither requirements nor queries of a network"
                .to_owned(),
        );
    }
    let settings = args.options.settings();
    let clock = ProofClock::start(args.timeout, args.stream)?;
    let shared = Arc::new(program.clone());
    let mut rows = Vec::new();
    for job in &jobs {
        let more = job.rows(&shared, &settings, &clock, &rows)?;
        rows.extend(more);
    }
    clock.finish();
    rows.sort_by_key(|row| row.place);
    // Several searches may have left out the same variables.
    rows.dedup_by(|later, row| row.kind == PropertyKind::Range && later.place == row.place);
    rows.iter_mut().for_each(|row| row.locate(&sources));
    write_run(args, &rows)?;
    if args.stream {
        terminal::print_data(&show::line(program, &rows, args.timings)?)?;
    } else if args.json {
        terminal::print_data(&show::json(program, &rows, args.timings)?)?;
    } else {
        terminal::print(&printable(&show::human(&rows, args.trace)))?;
    }
    Ok(if clock.is_interrupted() { CommandExit::Interrupted } else { verdict(&rows) })
}

/// The first run that shows something, as a diagram.
fn write_run(args: &ProveArgs, rows: &[ProofRow]) -> Result<(), CommandFault> {
    let trace = rows.iter().find_map(|r| r.trace.as_ref());
    for (path, text) in [
        (&args.mermaid, trace.map(hrdsl_runtime::prove::WitnessTrace::mermaid)),
        (&args.dot, trace.map(hrdsl_runtime::prove::WitnessTrace::dot)),
    ] {
        match (path, text) {
            (Some(path), Some(text)) => files::write(path, &text)?,
            (Some(path), None) => {
                terminal::say_line(format_args!(
                    "note: {} is not written: there is no run to show",
                    terminal::shown(path)
                ));
            }
            (None, _) => {}
        }
    }
    Ok(())
}

/// The worst of all.
fn verdict(rows: &[ProofRow]) -> CommandExit {
    let worst = |exit: CommandExit| rows.iter().any(|r| r.exit() == exit).then_some(exit);
    worst(CommandExit::Errors)
        .or(worst(CommandExit::Findings))
        .or(worst(CommandExit::Inconclusive))
        .unwrap_or(CommandExit::Ok)
}
