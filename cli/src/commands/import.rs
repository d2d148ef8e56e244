//! `hrdsl import`: programs of other tools to scenarios.

use std::path::{Path, PathBuf};

use clap::Subcommand;
use hrdsl_interop::{
    ForeignLoader, ForeignSource, ImportNote, ImportedScenario, NoteSeverity, SyntaxError,
    agentspeak::{self, AgentSpeakOptions},
    tchecker, uppaal,
};
use serde::Serialize;

use crate::{exit::CommandExit, fault::CommandFault, files, reach::FileReach, terminal};

/// Make a scenario from the programs of another tool.
///
/// What a scenario cannot say is left out, with a comment at its place and a row of the report.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  hrdsl import agentspeak house.mas2j -o house.hri
  hrdsl import agentspeak robot.asl owner.asl --name house > house.hri
  hrdsl import agentspeak house.mas2j --strict --json | jq .notes
  hrdsl import uppaal gate.xml gate.q -o gate.hri
  hrdsl import tchecker fischer.txt -o fischer.hri")]
pub struct ImportArgs {
    #[command(subcommand)]
    from: ImportFormat,
}

#[derive(Subcommand)]
enum ImportFormat {
    Agentspeak(AgentSpeak),
    Uppaal(UppaalImportArgs),
    Tchecker(TcheckerImportArgs),
}

/// From Jason's AgentSpeak: agents with their beliefs, rules, goals and plans.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  hrdsl import agentspeak house.mas2j -o house.hri
  hrdsl import agentspeak robot.asl owner.asl --name house > house.hri")]
struct AgentSpeak {
    /// Programs (`.asl`, one agent each) and projects (`.mas2j`).
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The scenario's name; otherwise that of the project or of the first file.
    #[arg(long, value_name = "SCENARIO")]
    name: Option<String>,
    #[command(flatten)]
    to: ImportOutputArgs,
}

/// From UPPAAL: templates, declarations and queries; each process becomes an automaton.
///
/// What a scenario cannot say (rates, probabilities, priorities) ends the import with its name and place; a query that
/// cannot be asked is left out.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  hrdsl import uppaal gate.xml -o gate.hri
  hrdsl import uppaal gate.xml gate.q -o gate.hri
  hrdsl import uppaal fischer.xta -o fischer.hri
  hrdsl import uppaal gate.xml --strict --json | jq .notes")]
struct UppaalImportArgs {
    /// The model, in UPPAAL's XML (`.xml`) or as text (`.xta`, `.ta`).
    #[arg(value_name = "MODEL")]
    model: PathBuf,
    /// Queries (`.q`) in the place of those in the model; otherwise the file of this kind beside the model, if there is one.
    #[arg(value_name = "QUERIES.q")]
    queries: Option<PathBuf>,
    /// The scenario's name; otherwise that of the file.
    #[arg(long, value_name = "SCENARIO")]
    name: Option<String>,
    #[command(flatten)]
    to: ImportOutputArgs,
}

/// From TChecker's text format: each process becomes an automaton, each synchronisation a multi-way channel, each label a query.
///
/// What a scenario cannot say (a clock that is set under a condition) ends the import with its place.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  hrdsl import tchecker fischer.txt -o fischer.hri
  hrdsl import tchecker csmacd.tck --name csma_cd > csma_cd.hri")]
struct TcheckerImportArgs {
    /// The system.
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The scenario's name; otherwise that of the system.
    #[arg(long, value_name = "SCENARIO")]
    name: Option<String>,
    #[command(flatten)]
    to: ImportOutputArgs,
}

/// Where what is imported goes.
#[derive(clap::Args)]
struct ImportOutputArgs {
    /// The file to write; otherwise the scenario goes to stdout.
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print the report as JSON on stdout, with the scenario if it is not written to a file.
    #[arg(long)]
    json: bool,
    /// Exit with 1 if anything is left out.
    #[arg(long)]
    strict: bool,
}

/// Files that programs and projects name, relative to them.
pub struct DiskPrograms(pub FileReach);

impl ForeignLoader for DiskPrograms {
    fn load(&self, from: &str, path: &str) -> Result<ForeignSource, String> {
        let (file, text) = self.0.read(from, path)?;
        Ok(ForeignSource { text, name: file.display().to_string() })
    }
}

/// # Errors
/// A file that cannot be read or written.
pub fn run(args: &ImportArgs) -> Result<CommandExit, CommandFault> {
    match &args.from {
        ImportFormat::Agentspeak(args) => from_agentspeak(args),
        ImportFormat::Uppaal(args) => from_uppaal(args),
        ImportFormat::Tchecker(args) => {
            let options = tchecker::TcheckerOptions { name: args.name.clone() };
            finished(&args.to, tchecker::import(&source(&args.file)?, &options))
        }
    }
}

fn from_agentspeak(args: &AgentSpeak) -> Result<CommandExit, CommandFault> {
    let mut files = Vec::new();
    for path in &args.files {
        if !path.extension().is_some_and(|e| e == "asl" || e == "mas2j") {
            return Err(format!(
                "{} is neither a program (.asl) nor a project (.mas2j)",
                terminal::shown(path)
            ));
        }
        files.push(source(path)?);
    }
    let imported = agentspeak::import(
        &files,
        &DiskPrograms(FileReach::of(args.files.first().map(PathBuf::as_path), &["asl"])),
        &AgentSpeakOptions { name: args.name.clone() },
    );
    finished(&args.to, imported)
}

fn from_uppaal(args: &UppaalImportArgs) -> Result<CommandExit, CommandFault> {
    if args.model.extension().is_some_and(|e| e == "q") {
        return Err(format!(
            "{} is a file of queries: name the model (.xml) before it",
            terminal::shown(&args.model)
        ));
    }
    let model = source(&args.model)?;
    let beside = Some(args.model.with_extension("q")).filter(|path| args.queries.is_none() && path.is_file());
    let queries = args.queries.as_deref().or(beside.as_deref()).map(source).transpose()?;
    let options = uppaal::UppaalOptions { name: args.name.clone() };
    let mut imported = uppaal::import(&model, queries.as_ref(), &options);
    if let (Ok(imported), Some(path)) = (&mut imported, &beside) {
        let message = "its queries are asked, since it stands beside the model".to_owned();
        let file = path.display().to_string();
        imported.notes.push(ImportNote {
            file,
            line: 1,
            column: 1,
            severity: NoteSeverity::Info,
            message,
            help: None,
        });
    }
    finished(&args.to, imported)
}

/// A file as it is named on the command line.
///
/// # Errors
/// A file that cannot be read.
pub fn source(path: &Path) -> Result<ForeignSource, CommandFault> {
    Ok(ForeignSource { name: path.display().to_string(), text: files::read(path)? })
}

fn finished(
    to: &ImportOutputArgs,
    imported: Result<ImportedScenario, Vec<SyntaxError>>,
) -> Result<CommandExit, CommandFault> {
    match imported {
        Ok(imported) => imported_to(to, &imported),
        Err(errors) => {
            if to.json {
                print(&ImportDocument {
                    errors: errors.iter().map(ImportNoteRow::of_error).collect(),
                    ..ImportDocument::default()
                })?;
            }
            errors.iter().for_each(|e| terminal::say_line(format_args!("error: {e}")));
            Ok(CommandExit::Errors)
        }
    }
}

fn imported_to(args: &ImportOutputArgs, imported: &ImportedScenario) -> Result<CommandExit, CommandFault> {
    if let Some(path) = &args.out {
        files::write(path, &imported.text)?;
    }
    if args.json {
        let text = args.out.is_none().then_some(imported.text.as_str());
        let notes = imported.notes.iter().map(ImportNoteRow::of_note).collect();
        print(&ImportDocument { text, notes, ..ImportDocument::default() })?;
    } else {
        if args.out.is_none() {
            terminal::print_data(&imported.text)?;
        }
        imported.notes.iter().for_each(terminal::say_line);
    }
    let left_out = imported.notes.iter().filter(|n| n.severity == NoteSeverity::LeftOut).count();
    if left_out > 0 {
        terminal::say_line(format_args!("{left_out} left out"));
    }
    Ok(if args.strict && left_out > 0 { CommandExit::Errors } else { CommandExit::Ok })
}

fn print(document: &ImportDocument<'_>) -> Result<(), CommandFault> {
    terminal::print_data(&files::json(document)?)
}

#[derive(Serialize)]
struct ImportDocument<'a> {
    format: &'static str,
    version: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    text: Option<&'a str>,
    notes: Vec<ImportNoteRow<'a>>,
    errors: Vec<ImportNoteRow<'a>>,
}

impl Default for ImportDocument<'_> {
    fn default() -> Self {
        Self { format: "hrdsl-import", version: 1, text: None, notes: Vec::new(), errors: Vec::new() }
    }
}

#[derive(Serialize)]
struct ImportNoteRow<'a> {
    file: &'a str,
    line: u32,
    column: u32,
    severity: &'static str,
    message: &'a str,
    help: Option<&'a str>,
}

impl<'a> ImportNoteRow<'a> {
    fn of_note(note: &'a ImportNote) -> Self {
        let ImportNote { file, line, column, severity, message, help } = note;
        let (line, column) = (*line, *column);
        Self { file, line, column, severity: severity.word(), message, help: help.as_deref() }
    }

    fn of_error(error: &'a SyntaxError) -> Self {
        let SyntaxError { file, line, column, message } = error;
        Self { file, line: *line, column: *column, severity: "error", message, help: None }
    }
}
