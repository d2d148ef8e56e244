//! `hrdsl judge`: verdicts, bins and conformance to models from recordings.

use std::{
    collections::BTreeMap,
    fs::File,
    io::{BufRead, BufReader, Cursor, Read},
    path::{Path, PathBuf},
    time::Duration,
};

use hrdsl_ir::{Nanos, Program};
use hrdsl_runtime::{
    conformance::ConformanceOptions,
    judge::{
        CampaignOutcome, FinishedTest, JudgedRecording, NamedFormula, UnseenSignal, judge_by_formulas, tally,
        tell_values_around,
    },
    recording, report,
    results::{
        BinName, BinResult, CampaignResults, ConformanceVerdict, MachineCoverage, MachineResult,
        RequirementResult, RunEnd, TestName, TestResult, VerdictResult,
    },
};
use serde::Serialize;

use super::report::WIDTH;
use crate::{
    color,
    exit::CommandExit,
    fault::CommandFault,
    files, input,
    observation::{ObservationArgs, locate},
    quantity, render, results_folder, terminal,
};

/// Judge recordings: verdicts, bins and conformance to the model as a campaign gives them, without running anything.
///
/// A recording is a file that `sim` wrote into traces/ or replays/, or that another program wrote in the same form (spec/traces.md).
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  hrdsl judge scenario.hri hrdsl-out/handover\n  hrdsl judge scenario.hri hrdsl-out/handover/traces/handover.bdi_tests.t017.jsonl\n  hrdsl judge scenario.hri log.jsonl --json\n  hrdsl judge scenario.hri robot.mcap --latency 50ms\n  hrdsl judge scenario.hri log.jsonl --around 2s\n  hrdsl judge scenario.hri log.jsonl --formula 'always (asked implies eventually[0 s, 10 s] released)'"
)]
pub struct JudgeArgs {
    /// The scenario.
    file: PathBuf,
    /// Recordings (`.jsonl`, `.mcap`), or folders with recordings in them; of the results of `sim`, those in traces/.
    #[arg(required = true)]
    recordings: Vec<PathBuf>,
    /// Print the verdicts, failures and bins as JSON.
    #[arg(long)]
    json: bool,
    /// Judge recordings of another scenario, or of other events and signals, too, as long as every name in them is known.
    #[arg(long)]
    changed: bool,
    /// Judge by a formula of metric temporal logic, too; may be given several times.
    ///
    /// It speaks of the signals and events of the recordings, with windows into the past and the future (spec/metric.md).
    #[arg(long, value_name = "FORMULA")]
    formula: Vec<String>,
    /// Tell the value of each part of a violated requirement (its events, signals and conditions), from so long before the first violation to so
    /// long after it, as `2s`.
    #[arg(long, value_name = "TIME", value_parser = quantity::time)]
    around: Option<Duration>,
    #[command(flatten)]
    observation: ObservationArgs,
    /// Exit with 0 even if requirements were violated or runs broke off.
    #[arg(long)]
    exit_zero: bool,
}

/// What `--json` prints. The parts of a test are those of `results.json`, byte for byte.
#[derive(Serialize)]
struct JudgementDocument<'a> {
    format: &'static str,
    version: u32,
    scenario: &'a str,
    requirements: &'a [RequirementResult],
    bins: &'a [BinResult],
    #[serde(skip_serializing_if = "<[MachineResult]>::is_empty")]
    machines: &'a [MachineResult],
    tests: Vec<JudgedTest<'a>>,
}

#[derive(Serialize)]
struct JudgedTest<'a> {
    name: &'a TestName,
    seed: u64,
    ended: RunEnd,
    error: Option<&'a str>,
    duration: f64,
    verdicts: &'a [VerdictResult],
    bins: &'a [BinName],
    #[serde(skip_serializing_if = "<[MachineCoverage]>::is_empty")]
    machines: &'a [MachineCoverage],
    #[serde(skip_serializing_if = "<[ConformanceVerdict]>::is_empty")]
    conformance: &'a [ConformanceVerdict],
}

/// # Errors
/// A file that cannot be read, or a scenario that has nothing to judge.
pub fn run(args: &JudgeArgs) -> Result<CommandExit, CommandFault> {
    let compilation = input::load(&args.file, &[])?;
    let Some(program) = input::report_errors(&args.file, &compilation) else {
        return Ok(CommandExit::Errors);
    };
    let options = args.observation.options(program)?;
    let around = args.around.map(|time| Nanos::try_from(time.as_nanos())).transpose();
    let around = around.map_err(|e| format!("--around: {e}"))?;
    let Some(formulas) = formulas(program, &args.formula) else { return Ok(CommandExit::Usage) };
    let mut unseen: BTreeMap<UnseenSignal, usize> = BTreeMap::new();
    let mut tests = Vec::new();
    let mut refused = 0_usize;
    for path in paths(&args.recordings)? {
        match judged((program, &formulas), &path, (args.changed, &options, around)) {
            Ok((test, signals)) => {
                tests.push(test);
                signals.into_iter().for_each(|signal| *unseen.entry(signal).or_default() += 1);
            }
            Err(why) => {
                terminal::say_line(format_args!("error: {}: {why}", terminal::shown(&path)));
                refused += 1;
            }
        }
    }
    let planned = tests.len() + refused;
    for (UnseenSignal { formula, signal }, count) in &unseen {
        terminal::say_line(format_args!(
            "warning: {formula}: `{signal}` has no sample in {count} of {} recordings, which say nothing about it",
            tests.len()
        ));
    }
    let outcome = CampaignOutcome { tests, planned, formulas, ..CampaignOutcome::default() };
    let mut results = tally(program, 0, &[], outcome, &BTreeMap::new(), String::new());
    locate(&mut results, &compilation);
    if args.json {
        terminal::print_data(&json(&results)?)?;
    } else if !results.tests.is_empty() {
        let summary = report::summary_of_recordings(&results, WIDTH, color::stdout_has());
        terminal::print(&(summary + &render::around(&results.tests)))?;
    }
    Ok(if refused > 0 {
        CommandExit::Usage
    } else if results.is_clean() || args.exit_zero {
        CommandExit::Ok
    } else {
        CommandExit::Findings
    })
}

/// The recordings: files as they are given, of a folder those in and below it, in order. Of a campaign's folder it is those in
/// `traces`: what else ends in `.jsonl` there, the code under test wrote.
pub(super) fn paths(given: &[PathBuf]) -> Result<Vec<PathBuf>, CommandFault> {
    let mut all = Vec::new();
    for path in given {
        if path.is_dir() {
            let traces = path.join(results_folder::TRACES);
            let path = if traces.is_dir() { &traces } else { path };
            let files = results_folder::files_below(path)?;
            // Links are not followed: they may lead in circles.
            let is_recording =
                |p: &PathBuf| p.extension().is_some_and(|e| e == "jsonl" || e == "mcap") && !p.is_symlink();
            let before = all.len();
            all.extend(files.iter().map(|file| path.join(file)).filter(is_recording));
            if all.len() == before {
                return Err(format!(
                    "there is no recording (`.jsonl`, `.mcap`) in {}",
                    terminal::shown(path)
                ));
            }
        } else {
            all.push(path.clone());
        }
    }
    Ok(all)
}

/// The lines of a recording, in whichever form it is.
pub(super) fn opened(path: &Path) -> Result<Box<dyn BufRead>, CommandFault> {
    let mut file = BufReader::new(File::open(path).map_err(|e| e.to_string())?);
    if !recording::is_mcap(file.fill_buf().map_err(|e| e.to_string())?) {
        return Ok(Box::new(file));
    }
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes).map_err(|e| e.to_string())?;
    let found = recording::read(&bytes).map_err(|e| e.to_string())?;
    match found.faults.first() {
        Some(fault) => Err(fault.clone()),
        None => Ok(Box::new(Cursor::new(found.text))),
    }
}

/// The formulas of the command line. What is wrong with them is said; then there are none.
fn formulas(program: &Program, texts: &[String]) -> Option<Vec<NamedFormula>> {
    let mut formulas = Vec::new();
    for (number, text) in texts.iter().enumerate() {
        let name = format!("formula {}", number + 1);
        match NamedFormula::read(program, name.clone(), text) {
            Ok(formula) => formulas.push(formula),
            Err(error) => terminal::say(render::formula(&name, text, &error)),
        }
    }
    (formulas.len() == texts.len()).then_some(formulas)
}

/// What a recording shows, as the result of its test; and which signals of formulas it does not have.
fn judged(
    (program, formulas): (&Program, &[NamedFormula]),
    path: &Path,
    (changed, options, around): (bool, &ConformanceOptions, Option<Nanos>),
) -> Result<(FinishedTest, Vec<UnseenSignal>), CommandFault> {
    let (judged, unseen) =
        judge_by_formulas((program, formulas), opened(path)?, changed, options).map_err(|e| e.to_string())?;
    let duration = judged.duration();
    let JudgedRecording { recorded, mut judgement, machines } = judged;
    if let Some(around) = around {
        tell_values_around((program, formulas), opened(path)?, changed, &mut judgement, around)
            .map_err(|e| e.to_string())?;
    }
    // What is no test is called as its file is.
    let stem = || path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let name = TestName::from(recorded.header.test.unwrap_or_else(stem));
    let suite = name.within(&program.name).rsplit_once('.').map_or("recordings", |(suite, _)| suite).into();
    let result = TestResult {
        name,
        suite,
        seed: recorded.header.seed.unwrap_or(0),
        ended: recorded.ending.kind,
        // Other programs need not say why; that it broke off counts all the same.
        error: match recorded.ending.kind {
            RunEnd::Error => {
                Some(recorded.ending.error.unwrap_or_else(|| "no reason is recorded".to_owned()))
            }
            RunEnd::Quiescent | RunEnd::Limit => None,
        },
        duration,
        judgement,
        ..TestResult::default()
    };
    Ok((FinishedTest { result, machines, ..FinishedTest::default() }, unseen))
}

fn json(results: &CampaignResults) -> Result<String, CommandFault> {
    fn test(t: &TestResult) -> JudgedTest<'_> {
        let TestResult { name, seed, ended, error, duration, judgement, .. } = t;
        JudgedTest {
            name,
            seed: *seed,
            ended: *ended,
            error: error.as_deref(),
            duration: *duration,
            verdicts: &judgement.verdicts,
            bins: &judgement.bins,
            machines: &judgement.machines,
            conformance: &judgement.conformance,
        }
    }
    let document = JudgementDocument {
        format: "hrdsl-judgement",
        version: 2,
        scenario: &results.scenario,
        requirements: &results.requirements,
        bins: &results.bins,
        machines: &results.machines,
        tests: results.tests.iter().map(test).collect(),
    };
    files::json(&document)
}
