//! `hrdsl run`: the agents of a scenario, or of Jason's programs, alone, with what they print.

use std::path::{Path, PathBuf};

use hrdsl_compiler::{CompilationResult, InputFile, compile_beside};
use hrdsl_interop::{
    ImportNote, NoteSeverity,
    agentspeak::{self, AgentSpeakOptions},
};
use hrdsl_ir::{Nanos, Program, bdi::AgentId, suite::PlayerRef};
use hrdsl_runtime::testgen::{
    model_run::{LogDetail, LogLine, ModelInspection, ModelRunOptions, inspect},
    seed_of,
};
use serde::Serialize;

use super::{
    import::{DiskPrograms, source},
    inspect::{
        reasoning::{ModelRunEnd, ReasoningFilter},
        time,
    },
};
use crate::{
    exit::CommandExit,
    fault::CommandFault,
    input,
    reach::{DiskModules, FileReach},
    terminal,
};

/// Run agents alone, in virtual time, and print what they print: of a scenario, or of programs of Jason.
///
/// They hold their own beliefs only; `hrdsl inspect` gives them those of a suite, and says why they do what they do.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  hrdsl run house.hri
  hrdsl run house.mas2j
  hrdsl run robot.asl owner.asl --until '10 s'
  hrdsl run house.hri --agent Robot --agent Owner --cycles 10000
  hrdsl run robot.asl --json | jq -r 'select(.kind == \"does\") | .text'")]
pub struct RunArgs {
    /// A scenario (`.hri`), or programs (`.asl`, one agent each) and projects (`.mas2j`) of Jason.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Only these agents; may be given several times.
    #[arg(long, value_name = "NAME")]
    agent: Vec<String>,
    /// When the run ends if the agents go on, like `10 s` or `5 min`.
    #[arg(long, value_name = "T", value_parser = time, default_value = "5 min")]
    until: Nanos,
    /// So many cycles of one agent at one instant are too many.
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(1..))]
    cycles: u64,
    /// What is random comes from this.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Print lines of JSON, one for each line that is printed or action that is done.
    #[arg(long)]
    json: bool,
}

/// # Errors
/// A file or an agent that does not exist.
pub fn run(args: &RunArgs) -> Result<CommandExit, CommandFault> {
    let Some(compilation) = compiled(&args.files)? else { return Ok(CommandExit::Errors) };
    let Some(program) = input::report_errors(&args.files[0], &compilation) else {
        return Ok(CommandExit::Errors);
    };
    let players = players(program, &args.agent)?;
    let seed = seed_of(args.seed, 1);
    let options =
        ModelRunOptions { cycles: args.cycles, ..ModelRunOptions::new(seed, args.until, LogDetail::Steps) };
    let inspection = inspect(program, &players, &[], &options);
    print(&inspection, args.json)?;
    Ok(concluded(&inspection))
}

/// The scenario, or what the programs become; `None`: what is wrong with them was said.
fn compiled(files: &[PathBuf]) -> Result<Option<CompilationResult>, CommandFault> {
    let ends = |path: &PathBuf, endings: &[&str]| {
        path.extension().and_then(|e| e.to_str()).is_some_and(|e| endings.contains(&e))
    };
    if files.iter().all(|f| ends(f, &["asl", "mas2j"])) {
        return imported(files);
    }
    match files {
        [file] if ends(file, &["hri"]) => Ok(Some(input::load(file, &[])?)),
        [_] | [] => Err(format!(
            "{} is neither a scenario (.hri) nor a program (.asl) or project (.mas2j) of Jason",
            files.first().map(|f| terminal::shown(f)).unwrap_or_default()
        )),
        [_, _, ..] => {
            Err("give one scenario (.hri), or programs (.asl) and projects (.mas2j) only".to_owned())
        }
    }
}

fn imported(files: &[PathBuf]) -> Result<Option<CompilationResult>, CommandFault> {
    let sources = files.iter().map(|f| source(f)).collect::<Result<Vec<_>, _>>()?;
    let first: Option<&Path> = files.first().map(PathBuf::as_path);
    let loader = DiskPrograms(FileReach::of(first, &["asl"]));
    match agentspeak::import(&sources, &loader, &AgentSpeakOptions::default()) {
        Ok(imported) => {
            let matters = |n: &&ImportNote| n.severity != NoteSeverity::Info;
            imported.notes.iter().filter(matters).for_each(terminal::say_line);
            let input = InputFile { name: "the imported scenario", text: &imported.text };
            Ok(Some(compile_beside(input, &[], &[], &DiskModules::of(None))))
        }
        Err(faults) => {
            faults.iter().for_each(|fault| terminal::say_line(format_args!("error: {fault}")));
            Ok(None)
        }
    }
}

/// The agents of these names, or all.
fn players(program: &Program, names: &[String]) -> Result<Vec<PlayerRef>, CommandFault> {
    let known = || program.agents.iter().map(|a| a.name.as_str()).collect::<Vec<_>>().join(", ");
    if program.agents.is_empty() {
        return Err("the scenario has no agent".to_owned());
    }
    if let Some(name) = names.iter().find(|n| program.agents.iter().all(|a| a.name != **n)) {
        return Err(format!("no agent `{name}`; the scenario has: {}", known()));
    }
    let wanted = (0u16..).zip(&program.agents).filter(|(_, a)| names.is_empty() || names.contains(&a.name));
    Ok(wanted.map(|(id, _)| PlayerRef::Agent(AgentId(id))).collect())
}

/// A line that an agent prints, or an action that it does.
#[derive(Serialize)]
struct AgentOutputLine<'a> {
    /// In nanoseconds.
    time: Nanos,
    agent: &'a str,
    /// `prints` or `does`
    kind: &'static str,
    text: &'a str,
}

impl<'a> AgentOutputLine<'a> {
    fn of(line: &'a LogLine) -> Option<Self> {
        let (kind, text) = if line.kind == "printed" {
            ("prints", line.text.strip_prefix("prints ").unwrap_or(&line.text))
        } else if line.does.is_some() {
            ("does", line.text.split_once(' ').map_or(line.text.as_str(), |(_, step)| step))
        } else {
            return None;
        };
        Some(Self { time: line.time, agent: &line.agent, kind, text })
    }
}

fn print(inspection: &ModelInspection, json: bool) -> Result<(), CommandFault> {
    let mut out = String::new();
    for line in inspection.run.log.iter().filter_map(AgentOutputLine::of) {
        if json {
            out += &serde_json::to_string(&line).map_err(|e| format!("cannot print: {e}"))?;
        } else {
            let does = if line.kind == "does" { "does " } else { "" };
            out += &format!("[{}] {does}{}", line.agent, line.text);
        }
        out.push('\n');
    }
    if json { terminal::print_data(&out) } else { terminal::print(&out) }
}

/// How the run ended, if it is not as it should.
fn concluded(inspection: &ModelInspection) -> CommandExit {
    inspection.run.warnings.iter().for_each(|w| terminal::say_line(format_args!("warning: {w}")));
    let end = ModelRunEnd::of(inspection, &ReasoningFilter::default(), &|_| String::new());
    if end.left_out > 0 {
        terminal::say_line(format_args!("{} entries of the agents' logs were not kept", end.left_out));
    }
    for (agent, plan) in &inspection.blocked {
        terminal::say_line(format_args!(
            "error: deadlock: the atomic plan `{plan}` of {agent} waits, and nothing else of {agent} goes on beside it"
        ));
    }
    if end.is_regular() {
        return if inspection.blocked.is_empty() { CommandExit::Ok } else { CommandExit::Errors };
    }
    terminal::say_line(format_args!("error: {}: {}", end.how, end.why));
    CommandExit::Errors
}
