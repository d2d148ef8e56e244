//! `hrdsl prove`: whether the networks of a scenario keep its requirements, and what its queries answer.

mod asked;
mod follow;
mod show;
mod table;

use std::{
    path::PathBuf,
    sync::{
        Arc,
        atomic::Ordering,
        mpsc::{self, RecvTimeoutError},
    },
    thread,
    time::{Duration, Instant},
};

use hrdsl_ir::Program;
use hrdsl_runtime::prove::{
    self, ProofOptions, ProofStatus, QueryFinding, QueryResult, RequirementProof, SearchWatch,
};
use hrdsl_source::{printable, printable_line};
use indicatif::{ProgressBar, ProgressStyle};

use super::search_options::{DelayArg, SearchOrderArg, WitnessArg};
use crate::{edge_sources::EdgeSources, exit::CommandExit, fault::CommandFault, files, input, terminal};
use asked::QueriedScenario;
use table::ProofRow;

/// Search the networks of a scenario: can they violate a requirement, and what do the queries answer?
///
/// All requirements and queries, unless some are named. A violation is shown by a run.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  hrdsl prove scenario.hri
  hrdsl prove scenario.hri --requirement R2 --trace
  hrdsl prove scenario.hri --ask 'E<> Robot.grasped and t > 5 s' --witness fastest --trace
  hrdsl prove scenario.hri --ask 'A[] not deadlock' --threads 2 --timeout 60s
  hrdsl prove scenario.hri --query live --mermaid live.mmd
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
    /// Give each automaton a time of its own, where that serves: often fewer states if automata share little.
    #[arg(long)]
    local_time: bool,
    /// Do not store states with a committed location: often less memory, and less time. Runs may not be the shortest.
    #[arg(long)]
    skip_committed: bool,
    /// Keep states apart that differ in one-way counters alone: the same answers from more states.
    #[arg(long)]
    exact_counters: bool,
    /// Threads that search at once.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=256))]
    threads: u16,
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
            local_time: self.local_time,
            skip_committed: self.skip_committed,
            exact_counters: self.exact_counters,
            threads: usize::from(self.threads),
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
    let clock = ProofClock::start(args.timeout);
    let shared = Arc::new(program.clone());
    let mut rows = Vec::new();
    for job in &jobs {
        rows.extend(job.rows(&shared, &settings, &clock)?);
    }
    clock.finish();
    rows.iter_mut().for_each(|row| row.locate(&sources));
    write_run(args, &rows)?;
    if args.json {
        terminal::print_data(&show::json(program, &rows)?)?;
    } else {
        terminal::print(&printable(&show::human(&rows, args.trace)))?;
    }
    Ok(verdict(&rows))
}

/// Something to decide.
pub struct ProofJob {
    /// Index into the program's networks.
    pub network: usize,
    pub what: ProofTarget,
}

/// By their places in the program.
pub enum ProofTarget {
    Requirement(usize),
    /// All of one network: what one exploration can decide is decided by one.
    Queries(Vec<usize>),
}

impl ProofJob {
    fn rows(
        &self,
        program: &Arc<Program>,
        settings: &ProofOptions,
        clock: &ProofClock,
    ) -> Result<Vec<ProofRow>, CommandFault> {
        let started = now();
        let (of, settings, network) = (Arc::clone(program), *settings, self.network);
        let mut rows = match &self.what {
            ProofTarget::Requirement(monitor) => {
                let monitor = *monitor;
                let work = move |watch: &SearchWatch| {
                    prove::prove(&of, &of.networks[network], monitor, &settings, watch)
                };
                let late = || RequirementProof {
                    monitor,
                    status: ProofStatus::Inconclusive(LATE.to_owned()),
                    states: 0,
                    note: None,
                };
                let proof = clock.watched(&program.monitors[monitor].name, work)?;
                vec![ProofRow::of_proof(program, &proof.unwrap_or_else(late))]
            }
            ProofTarget::Queries(queries) => {
                let asked = queries.clone();
                let work = move |watch: &SearchWatch| prove::answers(&of, &asked, &settings, watch);
                let late = |query: &usize| QueryResult {
                    query: *query,
                    found: QueryFinding::Inconclusive(LATE.to_owned()),
                    run: None,
                    notes: Vec::new(),
                    states: None,
                };
                let label = match queries.as_slice() {
                    [query] => program.queries[*query].name.clone(),
                    several => format!("{} queries", several.len()),
                };
                let answers = clock.watched(&label, work)?;
                let answers = answers.unwrap_or_else(|| queries.iter().map(late).collect());
                answers.iter().map(|a| ProofRow::of_answer(program, a)).collect()
            }
        };
        for row in &mut rows {
            row.network.clone_from(&program.networks[network].name);
            row.time = started.elapsed();
        }
        Ok(rows)
    }
}

const LATE: &str = "the time was over";

#[allow(clippy::disallowed_methods, reason = "how long it took is shown, and decides nothing but a time-out")]
fn now() -> Instant {
    Instant::now()
}

/// Time, and a line on the terminal for long work.
struct ProofClock {
    until: Option<Instant>,
    bar: ProgressBar,
}

/// How long a search is waited for that was told to stop. Not all of them listen.
const GRACE: Duration = Duration::from_millis(500);

impl ProofClock {
    fn start(timeout: Option<Duration>) -> Self {
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg}  {elapsed}") {
            bar.set_style(style);
        }
        Self { until: timeout.and_then(|t| now().checked_add(t)), bar }
    }

    /// Runs something while its progress is shown, and tells it when its time is over. `None`: it did not end in time, and is
    /// left behind, until the process ends.
    fn watched<T: Send + 'static>(
        &self,
        name: &str,
        work: impl FnOnce(&SearchWatch) -> Result<T, CommandFault> + Send + 'static,
    ) -> Result<Option<T>, CommandFault> {
        if self.until.is_some_and(|until| now() >= until) {
            return Ok(None);
        }
        let watch = Arc::new(SearchWatch::default());
        let (done, result) = mpsc::channel();
        let watching = Arc::clone(&watch);
        // Searches recurse little, but expressions are as deep as they are written.
        let search = thread::Builder::new().stack_size(STACK);
        let search = search.spawn(move || {
            // Nobody may wait any more.
            let _ = done.send(work(&watching));
        });
        search.map_err(|e| format!("cannot start a thread: {e}"))?;
        let mut waited = Duration::from_millis(1);
        loop {
            match result.recv_timeout(waited) {
                Ok(found) => return found.map(Some),
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(format!("internal error: the search for `{name}` broke off"));
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
            // Short work ends soon; long work is looked at now and then.
            waited = (waited * 2).min(Duration::from_millis(50));
            if let Some(until) = self.until.filter(|until| now() >= *until) {
                watch.stop.store(true, Ordering::Relaxed);
                if now() >= until + GRACE {
                    return Ok(None);
                }
            }
            self.bar.set_message(format!(
                "{}: {} states",
                printable_line(name),
                watch.stored.load(Ordering::Relaxed)
            ));
            self.bar.tick();
        }
    }

    fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

const STACK: usize = 64 << 20;

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
