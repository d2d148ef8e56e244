//! `hrdsl mutate`: small faults of the code under test, and which of them its tests would notice.

mod files_to_mutate;
mod of_models;
mod show;

use std::{collections::BTreeMap, path::PathBuf, time::Instant};

use hrdsl_compiler::CompilationResult;
use hrdsl_ir::{Program, system::SystemUnderTest, test::Test};
use hrdsl_runtime::{
    campaign::{CampaignSetup, CompiledMutants, ListedMutant, SingleRun},
    mutation::{
        MutantOutcome, MutantSample, MutationCampaign, MutationPlan, add_up, propose, run_controls,
        run_originals, run_plan, run_sentinels,
    },
    results::{MutantFate, MutationAbout, MutationReport},
};

use super::campaign::{
    CampaignArgs, chosen_system, generate_suites, progress_bar, selected, stop_flag, system_file,
};
use crate::{exit::CommandExit, fault::CommandFault, files, input, results_folder::ResultsFolder, terminal};
use files_to_mutate::{bare, measured};

/// What `-o` writes, the report for machines last.
const NAMES: [&str; 2] = ["mutation.txt", "mutation.json"];

/// Put small faults into the code under test, and say which of them its tests notice.
///
/// Tests run on the code as it is first, with code coverage; then on each mutant (one small change at one place, in memory only) those that reach
/// it, until one notices: a requirement is violated, the run leaves its prediction or its model, or the code breaks off, and the original's run of
/// the same test does not. Mutants that survive are listed with where they first differ, and requirements that would notice.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  hrdsl mutate scenario.hri\n  hrdsl mutate scenario.hri tests.hri --sample 40 --seed 1\n  hrdsl mutate scenario.hri --suite bdi_tests -n 8 --operator time --operator deadline\n  hrdsl mutate scenario.hri tests.hri --matrix -o out\n  hrdsl mutate scenario.hri --models --latency 200ms\n  hrdsl mutate scenario.hri tests.hri --min-score 80 --json"
)]
pub struct MutateArgs {
    #[command(flatten)]
    campaign: CampaignArgs,
    /// Only mutants of this operator; may be given several times.
    #[arg(long, value_name = "NAME")]
    operator: Vec<String>,
    /// Only so many mutants, drawn by --seed.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    sample: Option<u32>,
    /// Mutants of the automata that play the system, instead of its code: which of them the code's runs contradict.
    #[arg(long)]
    models: bool,
    /// Run all tests that reach a mutant, instead of until the first that notices it: for the whole score of each oracle and method.
    #[arg(long)]
    matrix: bool,
    /// Exit with 1 if less than so many percent of the mutants are noticed.
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    min_score: Option<f64>,
    /// Print the report as JSON.
    #[arg(long)]
    json: bool,
    /// A folder for the report: mutation.json and mutation.txt.
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
}

fn percent(text: &str) -> Result<f64, String> {
    let number: f64 = text.trim_end_matches('%').parse().map_err(|e| format!("{e}"))?;
    if (0.0..=100.0).contains(&number) { Ok(number) } else { Err("it is from 0 to 100".to_owned()) }
}

/// What came of the mutants.
struct MutationRuns {
    plan: MutationPlan,
    sentinels: Vec<MutantOutcome>,
    mutants: Vec<MutantOutcome>,
}

/// # Errors
/// As of `sim`, and code that has no file of Python, or one that cannot be compiled.
pub fn run(args: &MutateArgs) -> Result<CommandExit, CommandFault> {
    let given = &args.campaign;
    let beside = system_file(given)?;
    let beside: Vec<&str> = beside.as_deref().into_iter().collect();
    let compilation = input::load_beside(&given.file, &given.tests, &beside)?;
    let Some(program) = input::report_errors(&given.file, &compilation) else {
        return Ok(CommandExit::Errors);
    };
    let dir = files::folder(&given.file);
    let chosen = chosen_system(program, given.system.as_deref())?;
    let system = &if args.models { bare(chosen) } else { measured(chosen, &dir)? };
    let folder = args.out.as_ref().map(|out| ResultsFolder::open(out, &NAMES)).transpose()?;
    let generated = generate_suites(given, program, &|_| Ok(()))?;
    let tests = selected(given, program, &generated)?;
    let interfaces = input::interface_table(&compilation, system)?;
    let hidden = args.out.iter().cloned().chain([dir.join("hrdsl-out")]);
    let hidden = hidden.filter_map(|folder| folder.canonicalize().ok()).collect();
    let mut campaign = given.setup(program, system, interfaces, hidden, stop_flag(false)?)?;
    given.plan_forks(&mut campaign)?;
    let begun = Instant::now();
    let Some(originals) = originals(&campaign, &tests)? else {
        terminal::say_line("interrupted, before anything was known of a mutant");
        return Ok(CommandExit::Interrupted);
    };
    let faster = simulated(&originals) / begun.elapsed().as_secs_f64().max(1e-6);
    let runs = if args.models {
        Some(of_models::contradicted(args, &compilation, &campaign, &originals)?)
    } else {
        mutants(args, &campaign, (&tests, &originals), listed(args, &campaign)?, faster)?
    };
    let Some(mut runs) = runs else { return Ok(CommandExit::Findings) };
    if !campaign.stop.is_set() {
        let compile = |more: &str| with_more(args, &beside, more);
        propose(program, &campaign.conformance, &originals, &mut runs.mutants, &compile);
    }
    let report = report(args, program, system, &originals, runs);
    finish(args, &report, folder)
}

/// All mutants of the code, in the order of its files.
fn listed(args: &MutateArgs, campaign: &CampaignSetup<'_>) -> Result<Vec<ListedMutant>, CommandFault> {
    let files = campaign.system.coverage();
    let listed = campaign.env.list_mutants(&campaign.dir, &files, &args.operator)?;
    if listed.is_empty() {
        return Err(format!("there is no mutant of {}", files.join(", ")));
    }
    Ok(listed)
}

/// Runs the tests on the code as it is. `None`: it was interrupted.
fn originals(campaign: &CampaignSetup<'_>, tests: &[Test]) -> Result<Option<Vec<SingleRun>>, CommandFault> {
    let bar = progress_bar(tests.len(), "tests of the original");
    let originals = run_originals(campaign, tests, |_| bar.inc(1))?;
    bar.finish_and_clear();
    let failing = originals.iter().flatten().filter(|run| fails(run)).count();
    if failing > 0 {
        terminal::say_line(format_args!(
            "note: {failing} of {} tests fail on the code as it is; what they are blamed for already notices no mutant",
            tests.len()
        ));
    }
    Ok(originals)
}

fn fails(run: &SingleRun) -> bool {
    run.result.error.is_some() || run.result.has_failed()
}

fn simulated(originals: &[SingleRun]) -> f64 {
    originals.iter().map(|run| run.result.duration).sum()
}

/// Runs the mutants, after the controls and the sentinels. `faster`: how many seconds are simulated in one, with all workers. `None`: the code
/// as it is does not repeat, which was said.
fn mutants(
    args: &MutateArgs,
    campaign: &CampaignSetup<'_>,
    (tests, originals): (&[Test], &[SingleRun]),
    listed: Vec<ListedMutant>,
    faster: f64,
) -> Result<Option<MutationRuns>, CommandFault> {
    let plan = MutationPlan::new(listed, originals, sample(args));
    let codes = compiled(campaign, &plan)?;
    let system = &bare(campaign.system);
    let campaign = CampaignSetup { system, ..campaign.clone() };
    let setup = MutationCampaign { campaign, tests, originals, codes: &codes, matrix: args.matrix };
    say_cost(args, &plan, plan.simulated(originals) / faster.max(1e-6));
    let bar = progress_bar(tests.len() * codes.len(), "controls");
    let unlike = run_controls(&setup, || bar.inc(1))?;
    bar.finish_and_clear();
    for (file, test) in &unlike {
        terminal::say_line(format_args!(
            "error: {file} as it is does not do the same twice in {test}, so that a mutant of it cannot be told from it; \
             `hrdsl sim --check-determinism` says where it differs"
        ));
    }
    if !unlike.is_empty() {
        return Ok(None);
    }
    let sentinels = run_sentinels(&setup, &plan, |_| ())?;
    let is_dead = |sentinel: &MutantOutcome| sentinel.fate == MutantFate::Killed;
    if !sentinels.iter().any(is_dead) {
        let not_run = |fate: Option<MutantFate>| fate.unwrap_or(MutantFate::NotRun);
        let mutants = plan.mutants.iter().map(|planned| {
            MutantOutcome::not_run(planned.mutant.clone(), not_run(planned.known), planned.tests.len())
        });
        let mutants = mutants.collect();
        return Ok(Some(MutationRuns { plan, sentinels, mutants }));
    }
    let begun = Instant::now();
    let bar = progress_bar(plan.mutants.len(), "mutants");
    let killed = std::sync::atomic::AtomicUsize::new(0);
    let mutants = run_plan(&setup, &plan, |outcome| {
        let is_killed = usize::from(outcome.fate == MutantFate::Killed);
        let killed = killed.fetch_add(is_killed, std::sync::atomic::Ordering::Relaxed) + is_killed;
        bar.set_message(format!("{killed} killed"));
        bar.inc(1);
    })?;
    bar.finish_and_clear();
    let (ran, seconds) = (mutants.iter().filter(|m| m.ran > 0).count(), begun.elapsed().as_secs_f64());
    terminal::say_line(format_args!(
        "{ran} mutants ran in {seconds:.1} s of wall time, {} at once: {:.1} in a second",
        setup.campaign.jobs,
        ran as f64 / seconds.max(1e-6)
    ));
    Ok(Some(MutationRuns { plan, sentinels, mutants }))
}

fn sample(args: &MutateArgs) -> Option<MutantSample> {
    args.sample.map(|count| MutantSample { count: count as usize, seed: args.campaign.seed })
}

/// The mutants of the plan that are run, compiled, by their files.
fn compiled(
    campaign: &CampaignSetup<'_>,
    plan: &MutationPlan,
) -> Result<BTreeMap<String, CompiledMutants>, CommandFault> {
    let mut numbers: BTreeMap<&str, Vec<u32>> = BTreeMap::new();
    for planned in &plan.mutants {
        let of_file = numbers.entry(&planned.mutant.file).or_default();
        of_file.extend(planned.known.is_none().then_some(planned.mutant.number));
    }
    let compile = |(file, numbers): (&str, Vec<u32>)| {
        let codes = campaign.env.compile_mutants(&campaign.dir, file, &numbers);
        codes.map(|codes| (file.to_owned(), codes))
    };
    numbers.into_iter().map(compile).collect()
}

/// What is to be expected, before it begins. Wall time is said here and nowhere else.
fn say_cost(args: &MutateArgs, plan: &MutationPlan, seconds: f64) {
    let mutants = plan.mutants.iter().filter(|planned| planned.known.is_none()).count();
    let most = if args.matrix { "" } else { "at most " };
    terminal::say_line(format_args!(
        "{mutants} mutants to run, {most}{} runs: {most}about {seconds:.0} s of wall time, by the times of the original",
        plan.runs()
    ));
}

/// The scenario with more text at its end; `None` if that has errors.
fn with_more(args: &MutateArgs, beside: &[&str], more: &str) -> Option<Program> {
    let compilation: CompilationResult =
        input::load_with(&args.campaign.file, &args.campaign.tests, beside, more).ok()?;
    compilation.program
}

fn report(
    args: &MutateArgs,
    program: &Program,
    system: &SystemUnderTest,
    originals: &[SingleRun],
    runs: MutationRuns,
) -> MutationReport {
    let about = MutationAbout {
        scenario: program.name.clone(),
        system: system.name.clone(),
        tests: originals.len(),
        failing: originals.iter().filter(|run| fails(run)).count(),
        seed: args.campaign.seed,
        matrix: args.matrix,
        models: args.models,
        operators: args.operator.clone(),
    };
    add_up(about, &runs.plan, sample(args), runs.sentinels, runs.mutants)
}

/// Writes and prints the report, and says how it ends.
fn finish(
    args: &MutateArgs,
    report: &MutationReport,
    folder: Option<ResultsFolder>,
) -> Result<CommandExit, CommandFault> {
    let (json, text) = (report.to_json().map_err(|e| e.to_string())?, show::text(report));
    if let Some(folder) = folder {
        for (name, content) in NAMES.into_iter().zip([&text, &json]) {
            files::write(&folder.staging().join(name), content)?;
        }
        folder.publish(&NAMES)?;
    }
    if args.json {
        terminal::print_data(&json)?;
    } else {
        terminal::print(&text)?;
    }
    let unmeasured: Vec<&str> = report.unmeasured().collect();
    for file in &unmeasured {
        terminal::say_line(if args.models {
            format!(
                "error: no run of the code contradicts a model in {file} that can do nothing: the tests measure nothing of it. Do runs conform to \
                     the model as it is (`hrdsl sim`)?"
            )
        } else {
            format!(
                "error: no test notices that {file} raises at once: the tests measure nothing of it. Is it what `run` starts, and are there \
                     requirements?"
            )
        });
    }
    let is_below = |least: f64| report.score.is_none_or(|score| score * 100.0 < least);
    Ok(if report.interrupted && unmeasured.is_empty() {
        CommandExit::Interrupted
    } else if !unmeasured.is_empty() {
        CommandExit::Findings
    } else if args.min_score.is_some_and(is_below) {
        terminal::say_line("the score is below --min-score");
        CommandExit::Errors
    } else {
        CommandExit::Ok
    })
}
