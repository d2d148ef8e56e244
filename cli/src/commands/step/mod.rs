//! `hrdsl step`: a network is walked through by hand, transition by transition.

mod command;
mod show;

use std::{
    io::{self, BufRead, IsTerminal},
    path::{Path, PathBuf},
};

use hrdsl_ir::Program;
use hrdsl_runtime::prove::{WalkSession, WitnessTrace};
use hrdsl_source::printable;

use crate::{
    edge_sources::EdgeSources, exit::CommandExit, fault::CommandFault, files, input, recorded_run, terminal,
};
use command::StepCommand;

/// Walk through a network of automata: see what can happen and when, choose, go back, replay a run.
///
/// All clocks that are possible are carried along, so that each time shown is exact. Commands are read from the terminal, or from
/// standard input; `help` lists them.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  hrdsl step scenario.hri
  hrdsl step scenario.hri --network house --replay found.json
  printf '1 @ 10 s\\nrandom 5\\ntrace\\n' | hrdsl step scenario.hri --seed 7
  printf 'random 20\\njson\\n' | hrdsl step scenario.hri --quiet > walk.json")]
pub struct StepArgs {
    /// The scenario.
    file: PathBuf,
    /// The network to walk through, if there are several.
    #[arg(long, value_name = "NAME")]
    network: Option<String>,
    /// Go along this run first: JSON of `prove` or `step`, or UPPAAL's .xtr.
    #[arg(long, value_name = "TRACE")]
    replay: Option<PathBuf>,
    /// What `random` draws comes from this.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Print only what `list`, `trace`, `json` and `help` are asked for.
    #[arg(long)]
    quiet: bool,
}

/// A walk with whom it is for.
struct InteractiveWalk<'a> {
    program: &'a Program,
    network: usize,
    session: WalkSession<'a>,
    sources: &'a EdgeSources<'a>,
    quiet: bool,
}

/// # Errors
/// A file, a name that does not exist, or, unless somebody sits at the terminal, a command that is not understood or not possible.
pub fn run(args: &StepArgs) -> Result<CommandExit, CommandFault> {
    let compilation = input::load(&args.file, &[])?;
    let Some(program) = input::report_errors(&args.file, &compilation) else {
        return Ok(CommandExit::Errors);
    };
    let network = chosen(program, args.network.as_deref())?;
    let sources = EdgeSources::of(&compilation);
    let session = match WalkSession::new(program, &program.networks[network], args.seed) {
        Ok(session) => session,
        Err(fault) => {
            terminal::say_line(format_args!("network `{}`: {fault}", program.networks[network].name));
            return Ok(CommandExit::Errors);
        }
    };
    let mut walk = InteractiveWalk { program, network, session, sources: &sources, quiet: args.quiet };
    let by_hand = io::stdin().is_terminal();
    if by_hand {
        terminal::say_line("`help` says what can be typed");
    }
    if let Some(file) = &args.replay {
        walk.replay(file, None)?;
    }
    walk.tell()?;
    for line in (TypedLines { by_hand }) {
        let line = line.map_err(|e| format!("cannot read the commands: {e}"))?;
        let done = match command::read(&line) {
            Ok(StepCommand::Quit) => break,
            Ok(command) => walk.obey(command),
            Err(wrong) => Err(wrong),
        };
        if let Err(wrong) = done {
            if !by_hand {
                return Err(format!("`{}`: {wrong}", line.trim()));
            }
            terminal::say_line(wrong);
        }
    }
    Ok(CommandExit::Ok)
}

/// The lines that are typed, after a prompt if somebody sees it.
struct TypedLines {
    by_hand: bool,
}

impl Iterator for TypedLines {
    type Item = io::Result<String>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.by_hand {
            terminal::say("> ");
        }
        let mut line = String::new();
        match io::stdin().lock().read_line(&mut line) {
            Ok(0) => None,
            Ok(_) => Some(Ok(line)),
            Err(e) => Some(Err(e)),
        }
    }
}

fn chosen(program: &Program, name: Option<&str>) -> Result<usize, CommandFault> {
    let all: Vec<&str> = program.networks.iter().map(|n| n.name.as_str()).collect();
    match (name, all.as_slice()) {
        (_, []) => Err("the scenario has no network to walk through".to_owned()),
        (None, [_]) => Ok(0),
        (None, _) => Err(format!("say which network to walk through with --network: {}", all.join(", "))),
        (Some(name), _) => all
            .iter()
            .position(|n| *n == name)
            .ok_or_else(|| format!("no network `{name}`; the scenario has: {}", all.join(", "))),
    }
}

impl InteractiveWalk<'_> {
    fn obey(&mut self, command: StepCommand) -> Result<(), String> {
        match command {
            StepCommand::Nothing | StepCommand::Quit => Ok(()),
            StepCommand::Take { choice, at } => {
                let index = choice.checked_sub(1).ok_or("transitions are numbered from 1")?;
                self.session.take(index, at)?;
                self.tell()
            }
            StepCommand::List => terminal::print(&printable(&show::state(&self.session, self.sources))),
            StepCommand::Undo(count) => {
                let left = (0..count).take_while(|_| self.session.undo()).count();
                if left < count {
                    return Err(format!("only {left} could be taken back: this is the start"));
                }
                self.tell()
            }
            StepCommand::Random(count) => self.random(count),
            StepCommand::Reset => {
                self.session.restart();
                self.tell()
            }
            StepCommand::Replay { file, name } => {
                self.replay(&file, name.as_deref())?;
                self.tell()
            }
            StepCommand::Trace => terminal::print(&printable(&self.trace()?.text())),
            StepCommand::Json => terminal::print_data(&files::json(&self.trace()?)?),
            StepCommand::Help => terminal::print(command::HELP),
        }
    }

    /// Where the walk is, unless nobody wants to know.
    fn tell(&self) -> Result<(), String> {
        if self.quiet {
            return Ok(());
        }
        terminal::print(&printable(&show::state(&self.session, self.sources)))
    }

    fn random(&mut self, count: usize) -> Result<(), String> {
        for _ in 0..count {
            let Some(taken) = self.session.take_any() else {
                terminal::say_line("nothing can happen any more");
                break;
            };
            if !self.quiet {
                terminal::print(&printable(&format!("took {}\n", show::what(&taken))))?;
            }
        }
        self.tell()
    }

    /// The walk so far as a run, with the sources of its edges.
    fn trace(&self) -> Result<WitnessTrace, String> {
        let run = self.session.run().map_err(|e| e.to_string())?;
        let network = &self.program.networks[self.network];
        let mut trace = WitnessTrace::from_run(self.program, network, &run);
        trace.locate(&|origin| self.sources.at(origin));
        Ok(trace)
    }

    /// From the start along a recorded run, as far as the network goes along.
    fn replay(&mut self, file: &Path, name: Option<&str>) -> Result<(), String> {
        let network = self.program.networks[self.network].name.clone();
        let mut runs = recorded_run::read(file, self.program, &[network])?;
        let names: Vec<String> = runs.iter().map(|r| r.name.clone()).collect();
        let at = match name {
            Some(name) => runs.iter().position(|r| r.name == name),
            None => (runs.len() == 1).then_some(0),
        };
        let Some(at) = at else {
            return Err(format!(
                "say which run of {} to go along: {}",
                terminal::shown(file),
                names.join(", ")
            ));
        };
        let recorded = runs.swap_remove(at);
        match self.session.replay(&recorded.run).map_err(|e| e.to_string())? {
            None => Ok(()),
            Some(left) => Err(format!(
                "the run leaves the network at step {} of {}: {}",
                left.step,
                recorded.run.steps.len(),
                left.why
            )),
        }
    }
}
