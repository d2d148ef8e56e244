//! `hrdsl report`: the reports of a campaign, made again from its results.

use std::path::{Path, PathBuf};

use hrdsl_runtime::{
    report,
    results::{CampaignResults, MutationReport},
};

use super::shown;
use crate::{color, exit::CommandExit, fault::CommandFault, files, results_folder::ResultsFolder, terminal};

/// Make the reports of a campaign again from its results, and print the summary.
///
/// Writes report.html and junit.xml into the folder of the results, or another one. Nothing is run. What `hrdsl mutate` found can be put on the page,
/// so that it says of each requirement which faults it noticed.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  hrdsl report hrdsl-out/handover\n  hrdsl report hrdsl-out/handover -o public\n  hrdsl report hrdsl-out/handover --mutants out/mutation.json\n  hrdsl report hrdsl-out/handover --print junit > junit.xml\n  hrdsl report --schema"
)]
pub struct ReportArgs {
    /// The folder of the results, or a results.json.
    #[arg(required_unless_present = "schema")]
    results: Option<PathBuf>,
    /// The folder to write to, instead of that of the results.
    #[arg(short, long, value_name = "DIR", conflicts_with = "print")]
    out: Option<PathBuf>,
    /// Print one report to standard output, and write nothing.
    #[arg(long, value_enum, value_name = "REPORT")]
    print: Option<ReportFormat>,
    /// The mutation.json of `hrdsl mutate -o`, or its folder, for the page; it is kept with the results.
    #[arg(long, value_name = "FILE")]
    mutants: Option<PathBuf>,
    /// Print the JSON Schema of results.json.
    #[arg(long, exclusive = true)]
    schema: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum ReportFormat {
    /// What `sim` prints at its end.
    Summary,
    /// The page.
    Html,
    /// For continuous integration.
    Junit,
}

/// What `hrdsl mutate -o` writes, beside the results whose report shows it.
const FAULTS: &str = "mutation.json";
/// The columns of a summary.
pub const WIDTH: usize = 100;

/// # Errors
/// Results that cannot be read, or a folder that cannot be written.
pub fn run(args: &ReportArgs) -> Result<CommandExit, CommandFault> {
    let Some(given) = &args.results else {
        terminal::print_data(&CampaignResults::schema().map_err(|e| e.to_string())?)?;
        return Ok(CommandExit::Ok);
    };
    let path = if given.is_dir() { given.join("results.json") } else { given.clone() };
    let text = files::read_whole(&path)?;
    let results =
        CampaignResults::from_json(&text).map_err(|e| format!("{}: {e}", terminal::shown(&path)))?;
    let beside = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match args.print {
        Some(ReportFormat::Summary) => {
            terminal::print(&report::summary(&results, WIDTH, color::stdout_has()))?
        }
        Some(ReportFormat::Html) => {
            let faults = faults(args, &results, beside)?;
            terminal::print_data(&shown::page(&results, shown::read(beside).as_ref(), faults.as_ref()))?;
        }
        Some(ReportFormat::Junit) => terminal::print_data(&report::junit(&results))?,
        None => {
            let out = args.out.as_deref().unwrap_or(beside);
            let faults = faults(args, &results, beside)?;
            let page = write(&results, faults.as_ref(), beside, out)?;
            let summary = report::summary(&results, WIDTH, color::stdout_has());
            terminal::print(&format!("{summary}report: {}\n", terminal::shown(&page)))?;
        }
    }
    Ok(CommandExit::Ok)
}

/// Writes the reports of results that lie in a folder; gives the path of the page.
fn write(
    results: &CampaignResults,
    faults: Option<&MutationReport>,
    beside: &Path,
    to: &Path,
) -> Result<PathBuf, CommandFault> {
    let mut folder = ResultsFolder::beside(to)?;
    folder.write(Path::new("junit.xml"), &report::junit(results))?;
    if let Some(found) = faults {
        // A report that is made again finds them here.
        folder.write(Path::new(FAULTS), &found.to_json().map_err(|e| e.to_string())?)?;
    }
    folder.write(Path::new("report.html"), &shown::page(results, shown::read(beside).as_ref(), faults))
}

/// What `hrdsl mutate` found in the tests of these results: in the file that is given, or beside them.
///
/// # Errors
/// A file that is something else, or of another scenario.
fn faults(
    args: &ReportArgs,
    results: &CampaignResults,
    beside: &Path,
) -> Result<Option<MutationReport>, CommandFault> {
    let path = match &args.mutants {
        Some(given) if given.is_dir() => given.join(FAULTS),
        Some(given) => given.clone(),
        None => beside.join(FAULTS),
    };
    if args.mutants.is_none() && !path.exists() {
        return Ok(None);
    }
    let found = MutationReport::from_json(&files::read_whole(&path)?)
        .map_err(|e| format!("{}: {e}", terminal::shown(&path)))?;
    if found.about.scenario != results.scenario {
        let (of, here) = (&found.about.scenario, &results.scenario);
        return Err(format!(
            "{}: these are faults of the system of scenario `{of}`; the results are of `{here}`",
            terminal::shown(&path)
        ));
    }
    Ok(Some(found))
}
