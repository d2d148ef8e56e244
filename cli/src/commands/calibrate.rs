//! `hrdsl calibrate`: the bounds of the system's model that recordings contradict, and which would fit.

use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
};

use hrdsl_compiler::CompilationResult;
use hrdsl_ir::{Nanos, Program, ta::ClockOp, value::seconds};
use hrdsl_runtime::{
    conformance::{ContradictedBound, ModelCalibration, RecordedRun, calibrate},
    judge::recorded_run,
    results::{ConformanceOutcome, ConformanceVerdict},
};
use hrdsl_source::printable_line;
use serde::Serialize;

use super::judge::{opened, paths};
use crate::{
    exit::CommandExit,
    fault::CommandFault,
    files, input,
    observation::{ObservationArgs, line},
    terminal,
};

/// Recordings that depart although no bound explains it that are listed, at most.
const UNEXPLAINED: usize = 3;

/// Compare the times of the system's model with recordings: which of its bounds they contradict, what was observed, and which bounds would fit.
///
/// The model is the automaton (or are the automata) that plays the system under test. Nothing is run, and no file is changed.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  hrdsl calibrate scenario.hri hrdsl-out/handover\n  hrdsl calibrate scenario.hri robot.jsonl --latency 50ms\n  hrdsl calibrate scenario.hri hrdsl-out/handover --json"
)]
pub struct CalibrateArgs {
    /// The scenario.
    file: PathBuf,
    /// Recordings (`.jsonl`, `.mcap`), or folders with recordings in them; of the results of `sim`, those in traces/.
    #[arg(required = true)]
    recordings: Vec<PathBuf>,
    /// Print what was found as JSON; times are seconds.
    #[arg(long)]
    json: bool,
    /// Take recordings of another scenario, or of other events and signals, too, as long as every name in them is known.
    #[arg(long)]
    changed: bool,
    #[command(flatten)]
    observation: ObservationArgs,
}

/// What `--json` prints.
#[derive(Serialize)]
struct CalibrationDocument<'a> {
    format: &'static str,
    version: u32,
    scenario: &'a str,
    models: Vec<CalibratedModel>,
}

#[derive(Serialize)]
struct CalibratedModel {
    model: String,
    recordings: usize,
    /// How many conform to the model as it is, and with the bounds that fit.
    conform: usize,
    would_conform: usize,
    bounds: Vec<CalibratedBound>,
}

#[derive(Serialize)]
struct CalibratedBound {
    place: String,
    line: Option<usize>,
    bound: String,
    recordings: usize,
    count: usize,
    known: usize,
    least: Option<f64>,
    greatest: Option<f64>,
    fits: Vec<String>,
}

/// # Errors
/// A file that cannot be read, a recording that is of something else, or a scenario without a model of its system.
pub fn run(args: &CalibrateArgs) -> Result<CommandExit, CommandFault> {
    let compilation = input::load(&args.file, &[])?;
    let Some(program) = input::report_errors(&args.file, &compilation) else {
        return Ok(CommandExit::Errors);
    };
    let options = args.observation.options(program)?;
    let paths = paths(&args.recordings)?;
    let runs = paths.iter().map(|path| recorded(program, path, args.changed));
    let runs = runs.collect::<Result<Vec<_>, _>>()?;
    let models = calibrate(program, &runs, &options);
    if models.is_empty() {
        return Err("no automaton plays the system under test: there is no model to calibrate".to_owned());
    }
    if args.json {
        terminal::print_data(&json(program, &compilation, &models)?)?;
    } else {
        let page = models.iter().map(|model| told(&compilation, &paths, model));
        terminal::print(&page.collect::<Vec<_>>().join("\n"))?;
    }
    Ok(CommandExit::Ok)
}

fn recorded(program: &Program, path: &Path, changed: bool) -> Result<RecordedRun, CommandFault> {
    let run = recorded_run(program, opened(path)?, changed);
    run.map_err(|e| format!("{}: {e}", terminal::shown(path)))
}

fn conforming(verdicts: &[ConformanceVerdict]) -> usize {
    verdicts.iter().filter(|v| v.outcome == ConformanceOutcome::Conforms).count()
}

/// `x >= 20 s`
fn bound_text(clock: &str, (op, time): (ClockOp, Nanos)) -> String {
    let op = match op {
        ClockOp::Lt => "<",
        ClockOp::Le => "<=",
        ClockOp::Eq => "==",
        ClockOp::Ge => ">=",
        ClockOp::Gt => ">",
    };
    format!("{clock} {op} {} s", seconds(time))
}

fn fits_text(bound: &ContradictedBound) -> Vec<String> {
    bound.fits.iter().map(|fit| bound_text(&bound.clock, *fit)).collect()
}

fn times(count: usize) -> String {
    if count == 1 { "once".to_owned() } else { format!("{count} times") }
}

/// What is known of the values of a bound's clock.
fn observed_text(bound: &ContradictedBound) -> String {
    let hidden = bound.count - bound.known;
    match bound.observed {
        Some((least, most)) => {
            let known = times(bound.known);
            let (least, most) = (seconds(least), seconds(most));
            let seen = if least == most {
                format!("observed {least:.3} s, {known}")
            } else {
                format!("observed {least:.3} s to {most:.3} s, {known}")
            };
            let more = format!(", and {} behind a silent edge", times(hidden));
            seen + if hidden > 0 { &more } else { "" }
        }
        None if hidden > 0 => format!("a silent edge hides its times, {}", times(hidden)),
        None => "no edge was taken that shows its times".to_owned(),
    }
}

fn fitting_text(bound: &ContradictedBound) -> String {
    match fits_text(bound).as_slice() {
        [] => "no time would fit: it would have to go".to_owned(),
        fits => format!("{} would fit", fits.join(" && ")),
    }
}

/// A model's page.
fn told(compilation: &CompilationResult, paths: &[PathBuf], found: &ModelCalibration) -> String {
    let all = found.before.len();
    let mut page = format!(
        "{}: {} of {all} recordings conform to it as it is\n",
        found.model,
        conforming(&found.before)
    );
    for bound in &found.contradicted {
        let at = bound.place.origin.and_then(|span| line(compilation, span));
        let at = at.map_or(String::new(), |line| format!(" (line {line})"));
        let place = &bound.place.name;
        let stands = bound_text(&bound.clock, bound.bound);
        // Writing to a string cannot fail.
        let _ = writeln!(page, "  {place}{at}: {stands} is contradicted by {} of them", bound.recordings);
        let _ = writeln!(page, "    {}; {}", observed_text(bound), fitting_text(bound));
    }
    if !found.contradicted.is_empty() {
        let _ = writeln!(page, "  with these bounds {} of {all} conform", conforming(&found.after));
    }
    let unexplained: Vec<_> = paths
        .iter()
        .zip(found.after.iter().zip(&found.explicable))
        .filter_map(|(path, (verdict, explicable))| Some((path, verdict.sentence()?, *explicable)))
        .collect();
    for (path, why, explicable) in unexplained.iter().take(UNEXPLAINED) {
        let who = if *explicable { "these bounds do not explain" } else { "no bound explains" };
        let _ = writeln!(page, "  {who} {}: {}", terminal::shown(path), printable_line(why));
    }
    if unexplained.len() > UNEXPLAINED {
        let _ = writeln!(page, "  and {} more", unexplained.len() - UNEXPLAINED);
    }
    page
}

fn json(
    program: &Program,
    compilation: &CompilationResult,
    models: &[ModelCalibration],
) -> Result<String, CommandFault> {
    let bound = |bound: &ContradictedBound| CalibratedBound {
        place: bound.place.name.clone(),
        line: bound.place.origin.and_then(|span| line(compilation, span)),
        bound: bound_text(&bound.clock, bound.bound),
        recordings: bound.recordings,
        count: bound.count,
        known: bound.known,
        least: bound.observed.map(|(least, _)| seconds(least)),
        greatest: bound.observed.map(|(_, most)| seconds(most)),
        fits: fits_text(bound),
    };
    let model = |found: &ModelCalibration| CalibratedModel {
        model: found.model.clone(),
        recordings: found.before.len(),
        conform: conforming(&found.before),
        would_conform: conforming(&found.after),
        bounds: found.contradicted.iter().map(bound).collect(),
    };
    files::json(&CalibrationDocument {
        format: "hrdsl-calibration",
        version: 1,
        scenario: &program.name,
        models: models.iter().map(model).collect(),
    })
}
