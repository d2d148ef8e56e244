//! `hrdsl gen`: tests from a scenario's suites, written as `.hri`.

use std::{
    collections::{BTreeMap, btree_map::Entry},
    path::{Path, PathBuf},
};

use hrdsl_compiler::CompilationResult;
use hrdsl_ir::{Program, Span, suite::Suite};
use hrdsl_runtime::{
    prove::ProofOptions,
    report::explain_text,
    results::{GeneratedSuite, GoalReport, GoalStatus, LostTuples, ModelCoverage, SuiteExplanation},
    testgen::{
        GenerateOptions, generate_with,
        model_run::{LogDetail, ModelInspection},
        write,
    },
};
use hrdsl_source::printable;
use serde::Serialize;

use super::inspect::{
    InspectedRun, json_lines,
    reasoning::{ModelRunEnd, ReasoningFilter, ending, reasoning},
};
use super::search_options::{DelayArg, SearchOrderArg, SearchThreadsArgs, WitnessArg};
use crate::{exit::CommandExit, fault::CommandFault, files, input, results_folder::ResultsFolder, terminal};

/// Generate tests from a scenario's suites and write them as readable `.hri`.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  hrdsl gen scenario.hri\n  hrdsl gen scenario.hri --suite bdi_tests -n 20 --seed 7 -o tests\n  hrdsl gen scenario.hri --suite bdi_tests --minimise --explain\n  hrdsl gen scenario.hri --suite bdi_tests --trace\n  hrdsl gen scenario.hri --suite ta_tests --witness fastest --delays latest"
)]
pub struct GenerateArgs {
    /// The scenario.
    file: PathBuf,
    /// Only this suite; may be given several times.
    #[arg(long, value_name = "NAME")]
    suite: Vec<String>,
    /// How many concrete tests of each suite, instead of what the suite says.
    #[arg(short = 'n', long, value_name = "N")]
    count: Option<u32>,
    /// Everything random comes from this.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// The folder to write to, one file for each suite.
    #[arg(short, long, value_name = "DIR", default_value = "hrdsl-tests")]
    out: PathBuf,
    /// Of suites by agents, keep only the tests that are needed for what all of them reach.
    #[arg(long)]
    minimise: bool,
    /// Of suites by agents, say what each test is for, what was not reached, and why.
    #[arg(long)]
    explain: bool,
    /// Of suites by agents, write beside the tests how the agents reasoned: `SUITE.traces/tNNN.log`, with --json `.jsonl`.
    #[arg(long)]
    trace: bool,
    /// Of suites by search, which run shows that a goal is reached, instead of what the suite says.
    #[arg(long, value_enum)]
    witness: Option<WitnessArg>,
    /// Of suites by search, when the transitions of these runs happen, instead of what the suite says.
    #[arg(long, value_enum)]
    delays: Option<DelayArg>,
    /// Of suites by search, in which order states are looked at [default: what the witness needs].
    #[arg(long, value_enum)]
    order: Option<SearchOrderArg>,
    #[command(flatten)]
    threads: SearchThreadsArgs,
    /// Print what was generated as one JSON document.
    #[arg(long)]
    json: bool,
}

/// # Errors
/// A file, a suite that does not exist, or a model that cannot be run.
pub fn run(args: &GenerateArgs) -> Result<CommandExit, CommandFault> {
    let compilation = input::load(&args.file, &[])?;
    let Some(program) = input::report_errors(&args.file, &compilation) else {
        return Ok(CommandExit::Errors);
    };
    let minimise = args.minimise.then_some(true);
    let chosen = chosen(program, &args.suite)?;
    let mut folder = ResultsFolder::beside(&args.out)?;
    let mut suites = Vec::new();
    for suite in chosen {
        let options = GenerateOptions {
            count: args.count,
            seed: args.seed,
            minimise,
            witness: args.witness.map(Into::into),
            delays: args.delays.map(Into::into),
            search: ProofOptions {
                order: args.order.map(Into::into),
                threads: args.threads.count(),
                ..ProofOptions::default()
            },
        };
        let generated = generate_with(program, suite, options)?;
        let path = folder.write(&file_of(&generated), &write(program, &generated.tests))?;
        let traces = if args.trace {
            trace(args, &compilation, program, suite, &generated, &mut folder)?
        } else {
            vec![]
        };
        if args.json {
            suites.push(MadeSuite::of(&generated, &path, &traces));
            continue;
        }
        let mut text = format!("{}  written to {}\n", describe(&generated), terminal::shown(&path));
        if !traces.is_empty() {
            text += &format!("  traces in {}\n", terminal::shown(&args.out.join(traces_of(&suite.name))));
        }
        if let Some(explanation) = generated.explanation.as_ref().filter(|_| args.explain) {
            text += &format!("\n{}\n", explain_text(&suite.name, explanation, generated.coverage.as_ref()));
        }
        terminal::print(&printable(&text))?;
    }
    if args.json {
        let document = GenerateDocument { format: "hrdsl-gen", version: 2, suites };
        terminal::print_data(&files::json(&document)?)?;
    }
    Ok(CommandExit::Ok)
}

/// What `--json` prints.
#[derive(Serialize)]
struct GenerateDocument {
    format: &'static str,
    version: u32,
    suites: Vec<MadeSuite>,
}

#[derive(Serialize)]
struct MadeSuite {
    suite: String,
    method: &'static str,
    file: String,
    abstract_tests: usize,
    tests: Vec<MadeTest>,
    notes: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    lost_tuples: Option<LostTuples>,
    goals: Vec<GoalReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    coverage: Option<ModelCoverage>,
    #[serde(skip_serializing_if = "Option::is_none")]
    explanation: Option<SuiteExplanation>,
}

#[derive(Serialize)]
struct MadeTest {
    name: String,
    seed: u64,
    /// The belief set that it came from.
    #[serde(skip_serializing_if = "Option::is_none")]
    set: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    trace: Option<String>,
}

impl MadeSuite {
    fn of(generated: &GeneratedSuite, path: &Path, traces: &[PathBuf]) -> Self {
        let test = |(at, test): (usize, &hrdsl_ir::test::Test)| MadeTest {
            name: test.name.clone(),
            seed: test.seed,
            set: generated.origins.get(at).map(|o| o.number),
            trace: traces.get(at).map(|p| p.display().to_string()),
        };
        Self {
            suite: generated.suite.clone(),
            method: generated.method.word(),
            file: path.display().to_string(),
            abstract_tests: generated.abstract_tests,
            tests: generated.tests.iter().enumerate().map(test).collect(),
            notes: generated.notes.clone(),
            lost_tuples: generated.lost_tuples,
            goals: generated.goals.clone(),
            coverage: generated.coverage.clone(),
            explanation: generated.explanation.clone(),
        }
    }
}

fn traces_of(suite: &str) -> PathBuf {
    PathBuf::from(format!("{suite}.traces"))
}

/// Writes how the agents reasoned in the run that each test came from; gives the files, one for each test of a suite by
/// agents. Tests of one belief set share their run.
fn trace(
    args: &GenerateArgs,
    compilation: &CompilationResult,
    program: &Program,
    suite: &Suite,
    generated: &GeneratedSuite,
    to: &mut ResultsFolder,
) -> Result<Vec<PathBuf>, CommandFault> {
    let folder = traces_of(&suite.name);
    // An earlier generation may have had more tests.
    to.clear(&folder)?;
    let place = |span| compilation.files.place(span);
    let mut runs: BTreeMap<u64, String> = BTreeMap::new();
    let mut paths = Vec::new();
    for (number, origin) in (1..).zip(&generated.origins) {
        let name = format!("{}.t{number:03}", suite.name);
        let Some(chosen) = InspectedRun::of_test(suite, &name, origin, args.seed) else { continue };
        let text = match runs.entry(origin.number) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => {
                new.insert(traced(&chosen.inspect(program, LogDetail::Reasons), args.json, &place)?)
            }
        };
        let (ending, heading) =
            if args.json { ("jsonl", String::new()) } else { ("log", chosen.heading(program, false) + "\n") };
        let name = folder.join(format!("t{number:03}.{ending}"));
        paths.push(to.write(&name, &(heading + text.as_str()))?);
    }
    Ok(paths)
}

/// The log of a run: for a person with how it ended, or as lines of JSON.
fn traced(
    inspection: &ModelInspection,
    json: bool,
    place: &dyn Fn(Span) -> String,
) -> Result<String, CommandFault> {
    let picked = ReasoningFilter { all: true, ..ReasoningFilter::default() };
    if json {
        return json_lines(inspection, &picked, place);
    }
    let end = ending(&ModelRunEnd::of(inspection, &picked, place), false);
    Ok(reasoning(inspection, &picked, false, place) + &end)
}

/// The suites of these names; all, without names.
///
/// # Errors
/// A name that is no suite's.
pub fn chosen<'p>(program: &'p Program, names: &[String]) -> Result<Vec<&'p Suite>, CommandFault> {
    for name in names {
        if program.suites.iter().all(|s| s.name != *name) {
            let known: Vec<&str> = program.suites.iter().map(|s| s.name.as_str()).collect();
            return Err(format!("no suite `{name}`; the scenario has: {}", known.join(", ")));
        }
    }
    let suites: Vec<&Suite> =
        program.suites.iter().filter(|s| names.is_empty() || names.contains(&s.name)).collect();
    if suites.is_empty() {
        return Err("the scenario has no suite to generate tests from".to_owned());
    }
    Ok(suites)
}

/// Writes a suite's tests; gives the file's path.
///
/// # Errors
/// A file that cannot be written.
pub fn save(folder: &Path, program: &Program, generated: &GeneratedSuite) -> Result<PathBuf, CommandFault> {
    let path = folder.join(file_of(generated));
    files::write(&path, &write(program, &generated.tests))?;
    Ok(path)
}

/// The file of a suite's tests.
fn file_of(generated: &GeneratedSuite) -> PathBuf {
    PathBuf::from(format!("{}.hri", generated.suite))
}

/// What was generated, in a few lines.
#[must_use]
pub fn describe(generated: &GeneratedSuite) -> String {
    let mut out = format!(
        "{} (by {}): {} abstract tests, {} concrete\n",
        generated.suite,
        generated.method.word(),
        generated.abstract_tests,
        generated.tests.len()
    );
    for note in &generated.notes {
        out += &format!("  {note}\n");
    }
    let count = |status| generated.goals.iter().filter(|g| g.status == status).count();
    if !generated.goals.is_empty() {
        out += &format!(
            "  goals: {} reached, {} unreachable, {} inconclusive\n",
            count(GoalStatus::Reached),
            count(GoalStatus::Unreachable),
            count(GoalStatus::Inconclusive)
        );
    }
    for goal in generated.goals.iter().filter(|g| g.status != GoalStatus::Reached) {
        let status = if goal.status == GoalStatus::Inconclusive { "inconclusive" } else { "unreachable" };
        out += &format!("  {status}: {}: {}\n", goal.goal, goal.reason);
    }
    out
}
