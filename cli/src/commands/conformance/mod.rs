//! `hrdsl conformance`: whether a client library, in whatever language, speaks the protocol as `spec/protocol.md` has it.

mod case;
mod compare;

use std::path::PathBuf;

use hrdsl_compiler::{CompilationResult, InputFile, compile};
use hrdsl_ir::{Program, system::SystemUnderTest};
use hrdsl_runtime::{
    campaign::{
        CampaignSetup, CellSettings, ForkPlan, ProgramLimits, ProgramOutput, PythonEnv, StopFlag,
        SupervisorCommand, prepare,
    },
    conformance::ConformanceOptions,
};
use serde_json::Value;

use self::{
    case::ConformanceCase,
    compare::{CaseDifference, of_events, of_log, of_output, skipped},
};
use super::campaign;
use crate::{exit::CommandExit, fault::CommandFault, files, input, installing::InstallProgress, terminal};

/// So many of the last lines that a driver wrote on standard error are shown.
const LAST_LINES: usize = 10;

/// Test a client library, in any language, against the protocol.
///
/// COMMAND is a driver: a small program that is written with the library, does what it is told, and says what came of it. Each
/// case runs it with a real harness; its last argument is a file whose lines are the steps. What a driver has to do is said in
/// spec/protocol.md.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  hrdsl conformance -- ./driver
  hrdsl conformance --case actions --case services -- node driver.js
  hrdsl conformance --protocol 1 -- python3 driver.py
  hrdsl conformance --list")]
pub struct ConformanceArgs {
    /// Only this case; may be given several times.
    #[arg(long, value_name = "NAME")]
    case: Vec<String>,
    /// The version of the protocol that the library speaks; with 1, the cases that need 2 are left out.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=2))]
    protocol: u32,
    /// Print the cases with what each shows, and run none.
    #[arg(long)]
    list: bool,
    /// The driver and its arguments.
    #[arg(last = true, value_name = "COMMAND", required_unless_present = "list")]
    command: Vec<String>,
}

/// What became of a case.
enum CaseVerdict {
    Passed,
    /// The driver says why it leaves it out.
    Skipped(String),
    Failed(String),
}

/// # Errors
/// A case that there is not, a driver that cannot be started, or what it needs cannot be installed.
pub fn run(args: &ConformanceArgs) -> Result<CommandExit, CommandFault> {
    let cases = chosen(args)?;
    if args.list {
        let lines = cases.iter().map(|case| format!("{:<14} {}\n", case.name, case.title));
        terminal::print(&lines.collect::<String>())?;
        return Ok(CommandExit::Ok);
    }
    let stop = campaign::stop_flag(false)?;
    let mut suite = ConformanceRun::new(args, stop)?;
    let (mut passed, mut left_out, mut failed) = (0, 0, 0);
    for case in &cases {
        match suite.verdict(case)? {
            CaseVerdict::Passed => {
                passed += 1;
                terminal::print(&format!("{}: passed\n", case.name))?;
            }
            CaseVerdict::Skipped(why) => {
                left_out += 1;
                terminal::print(&format!("{}: skipped ({why})\n", case.name))?;
            }
            CaseVerdict::Failed(why) => {
                failed += 1;
                terminal::print(&format!("{}: FAILED\n{why}", case.name))?;
            }
        }
        if suite.stop.is_set() {
            return Ok(CommandExit::Interrupted);
        }
    }
    let (total, word) = (cases.len(), if cases.len() == 1 { "case" } else { "cases" });
    terminal::print(&format!("{total} {word}: {passed} passed, {left_out} skipped, {failed} failed\n"))?;
    Ok(if failed > 0 { CommandExit::Findings } else { CommandExit::Ok })
}

fn chosen(args: &ConformanceArgs) -> Result<Vec<ConformanceCase>, CommandFault> {
    let mut cases = case::all()?;
    for name in &args.case {
        if !cases.iter().any(|case| case.name == name) {
            let known: Vec<&str> = cases.iter().map(|case| case.name).collect();
            return Err(format!("no case is called `{name}`; there are {}", known.join(", ")));
        }
    }
    cases.retain(|case| args.case.is_empty() || args.case.iter().any(|name| case.name == name));
    cases.retain(|case| case.version <= args.protocol);
    if cases.is_empty() {
        return Err("no case is left: those that were named need version 2 of the protocol".to_owned());
    }
    Ok(cases)
}

/// What all cases have in common.
struct ConformanceRun<'a> {
    command: &'a [String],
    /// The folder in which drivers run.
    dir: PathBuf,
    /// For the files of steps.
    steps: ScriptFolder,
    cells: CellSettings,
    /// What drivers in Python need, once it is prepared.
    env: Option<PythonEnv>,
    stop: StopFlag,
}

impl<'a> ConformanceRun<'a> {
    fn new(args: &'a ConformanceArgs, stop: StopFlag) -> Result<Self, CommandFault> {
        let dir = std::env::current_dir().map_err(|e| format!("cannot find the present folder: {e}"))?;
        // One without a slash is searched for as any command is.
        let driver = args.command.first().filter(|word| word.contains('/'));
        if let Some(driver) = driver.filter(|driver| !dir.join(driver).is_file()) {
            return Err(format!("there is no driver {}", terminal::shown(driver.as_ref())));
        }
        let supervisor = SupervisorCommand::this_program(campaign::SUPERVISE);
        let cells = CellSettings::probe(supervisor, &dir, None).map_err(|e| e.to_string())?;
        Ok(Self { command: &args.command, dir, steps: ScriptFolder::new()?, cells, env: None, stop })
    }

    /// Runs a case.
    fn verdict(&mut self, case: &ConformanceCase) -> Result<CaseVerdict, CommandFault> {
        let (program, compilation) = compiled(case)?;
        let mut system = program
            .systems
            .first()
            .cloned()
            .ok_or_else(|| format!("the case {} has no system", case.name))?;
        for (declared, driver) in system.programs.iter_mut().zip(&case.programs) {
            let path = self.steps.path.join(format!("{}-{}.steps", case.name, driver.name));
            files::write(&path, &driver.script())?;
            declared.run = self.command.to_vec();
            declared.run.push(path.display().to_string());
        }
        let env = self.environment(&system)?;
        let campaign = CampaignSetup {
            program: &program,
            system: &system,
            interfaces: input::interface_table(&compilation, &system)?,
            dir: self.dir.clone(),
            env,
            seed: 0,
            cells: self.cells.clone(),
            limits: ProgramLimits::default(),
            variables: Vec::new(),
            keep: None,
            forks: ForkPlan::default(),
            jobs: 1,
            stop: self.stop.clone(),
            conformance: ConformanceOptions::default(),
            replays: false,
            clocks: None,
        };
        let found = std::sync::Mutex::new(CaseVerdict::Failed("  it did not run\n".to_owned()));
        campaign.run(&program.tests, |done| {
            let made = events_of(&program, &system, done.recording);
            let log = serde_json::to_value(&done.result.log).map_err(|e| e.to_string())?;
            let verdict = judged(case, done.output, (&made, &log), done.result.error.as_deref());
            *found.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = verdict;
            Ok(())
        })?;
        Ok(found.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner))
    }

    fn environment(&mut self, system: &SystemUnderTest) -> Result<PythonEnv, CommandFault> {
        if let Some(env) = &self.env {
            return Ok(env.clone());
        }
        let console = InstallProgress::default();
        let env = prepare(system, &self.dir, &campaign::cache()?, &|step| console.show(step));
        let env = env.map_err(|e| e.to_string())?;
        self.env = Some(env.clone());
        Ok(env)
    }
}

fn compiled(case: &ConformanceCase) -> Result<(Program, CompilationResult), CommandFault> {
    let (scenario, tests) = (case.scenario(), case.tests());
    let scenario = InputFile { name: "scenario.hri", text: &scenario };
    let mut compilation = compile(scenario, &[InputFile { name: "tests.hri", text: &tests }]);
    let program = compilation.program.take().ok_or_else(|| {
        let first = compilation.diagnostics.iter().find(|d| d.is_error()).map(|d| d.message.clone());
        format!("the case {} has an error: {}", case.name, first.unwrap_or_default())
    })?;
    Ok((program, compilation))
}

/// The events of a recording that the system under test has made.
fn events_of(program: &Program, system: &SystemUnderTest, recording: &str) -> Vec<Value> {
    let is_own = |line: &Value| {
        let name = line.get("event").and_then(Value::as_str);
        name.is_some_and(|name| program.events.iter().any(|e| e.from == system.actor && e.name == name))
    };
    recording.lines().filter_map(|line| serde_json::from_str(line).ok()).filter(is_own).collect()
}

fn judged(
    case: &ConformanceCase,
    output: &[ProgramOutput],
    (made, log): (&[Value], &Value),
    error: Option<&str>,
) -> CaseVerdict {
    if let Some(why) = output.iter().find_map(|o| skipped(&o.output.stdout.text())) {
        return CaseVerdict::Skipped(why);
    }
    let of_program = |driver: &case::CaseProgram| {
        let said = output.iter().find(|o| case.programs.len() == 1 || o.program == driver.name);
        of_output(case, driver, &said.map(|o| o.output.stdout.text()).unwrap_or_default())
    };
    let difference = case.programs.iter().find_map(of_program);
    let difference = difference.or_else(|| of_events(case, made)).or_else(|| of_log(case, log));
    let error = error.and_then(|error| error.lines().next());
    if difference.is_none() && error == case.error.as_deref() {
        return CaseVerdict::Passed;
    }
    let broke_off = match (&case.error, error) {
        (Some(expected), error) if error != Some(expected) => {
            let got = error.unwrap_or("a run that did not break off");
            format!("  the run had to break off: {expected}\n  got      {got}\n")
        }
        (None, Some(error)) => format!("  the run broke off: {error}\n"),
        (None, None) | (Some(_), _) => String::new(),
    };
    CaseVerdict::Failed(complaint(difference, output, &broke_off))
}

/// The first difference, the error of the test, and the last that the drivers wrote.
fn complaint(difference: Option<CaseDifference>, output: &[ProgramOutput], broke_off: &str) -> String {
    let mut text = String::new();
    if let Some(CaseDifference { at, expected, got, place }) = difference {
        text += &format!("  {at}\n  expected {expected}\n  got      {got}\n  the case is {place}\n");
    }
    text += broke_off;
    for written in output {
        let end = written.output.stderr.last_lines(LAST_LINES);
        if !end.is_empty() {
            text += &format!("  standard error of {}:\n", written.program);
            text.extend(end.lines().map(|line| format!("    {line}\n")));
        }
    }
    text
}

/// A folder for the files of steps, which is removed at the end.
struct ScriptFolder {
    path: PathBuf,
}

impl ScriptFolder {
    fn new() -> Result<Self, CommandFault> {
        let path = std::env::temp_dir().join(format!("hrdsl-conformance-{}", std::process::id()));
        std::fs::create_dir(&path).map_err(|e| format!("cannot make {}: {e}", terminal::shown(&path)))?;
        Ok(Self { path })
    }
}

impl Drop for ScriptFolder {
    fn drop(&mut self) {
        // What is left of it harms nobody.
        let _ = std::fs::remove_dir_all(&self.path);
    }
}
