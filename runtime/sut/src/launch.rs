//! From the words of a command to a process that can be started: Python scripts go through the SDK's runner.

use std::{
    ffi::OsString,
    os::fd::OwnedFd,
    path::{Path, PathBuf},
};

use rustix::fs::{Mode, OFlags, open};

use crate::{
    cell::{
        cells::CellSettings,
        message::{CellIsolation, CellOrder},
    },
    environment::{PythonEnv, word::is_python},
    error::{SutError, silence},
    limits::{ProgramLimits, StopFlag},
    mutants::LaunchMutant,
    start,
};

/// All that determines a run of the program under test.
#[derive(Clone, Debug)]
pub struct LaunchSpec {
    /// The command's words. If the first is `python`, `python3` or `python3.x`, the script runs through the SDK's
    /// runner: with simulated time, seeded chance and coverage.
    pub command: Vec<String>,
    /// The folder in which it runs; the words and `coverage` are relative to it.
    pub dir: PathBuf,
    /// The test's seed: of the program's random numbers.
    pub seed: u64,
    /// The seed of the hashes of texts, which Python takes at its start: the same in all tests of a campaign.
    pub hash_seed: u32,
    /// The Python files whose coverage is measured; empty: none.
    pub coverage: Vec<String>,
    /// Whether to measure, too, at which of their lines it is when.
    pub lines: bool,
    pub env: PythonEnv,
    /// What the program is told of its middleware, if the scenario binds one.
    pub middleware: Option<LaunchMiddleware>,
    /// Variables of the environment that the program gets besides the [default](DEFAULT_VARIABLES), with their values.
    pub variables: Vec<(OsString, OsString)>,
    pub cells: CellSettings,
    pub limits: ProgramLimits,
    /// How many bytes of each output stream are kept.
    pub output_kept: usize,
    /// Where to put the files that it writes, if they are to be kept.
    pub keep: Option<PathBuf>,
    /// Set when everything is to end.
    pub stop: StopFlag,
    /// What is run in the place of one of its files of Python, if anything.
    pub mutant: Option<LaunchMutant>,
}

/// The variable that tells the runner of a mutant.
const MUTANT: &str = "HRDSL_MUTANT";

/// A middleware whose client libraries the program finds, with what the scenario says of it.
#[derive(Clone, Debug)]
pub struct LaunchMiddleware {
    /// `ros1` or `ros2`.
    pub name: &'static str,
    /// A file of JSON (`spec/protocol.md`).
    pub binding: PathBuf,
    /// Folders in which modules are searched for, before those that are installed.
    pub modules: Vec<String>,
}

/// The variables of the harness's environment that every program gets. Others are named in the scenario.
pub const DEFAULT_VARIABLES: [&str; 2] = ["PATH", "LD_LIBRARY_PATH"];

/// A command with the variables that belong to it.
struct StartCommand {
    command: Vec<OsString>,
    env: Vec<(OsString, OsString)>,
}

/// How a command is started.
enum CommandKind<'a> {
    /// The interpreter's flags, and the script, `-m module` or `-c code` with its arguments.
    Script {
        flags: &'a [String],
        script: &'a [String],
    },
    /// An interpreter that is not given a script.
    Interpreter,
    Other,
}

impl LaunchSpec {
    /// The order for a cell in which the program runs. `descriptors` are the variables that tell the numbers of those that
    /// go with it, before the folder for files if there is one.
    pub(crate) fn order(&self, descriptors: Vec<String>) -> Result<CellOrder, SutError> {
        if !self.dir.is_dir() {
            return Err(absent("folder of the program", self.dir.display().to_string()));
        }
        let dir = self.dir.canonicalize().map_err(SutError::io("cannot find the folder of the program"))?;
        let Some(word) = self.command.first() else {
            return Err(absent("program", "an empty command".to_owned()));
        };
        if let Some(advice) = start::advice(word, &self.command[1..], &dir) {
            return Err(absent("program", advice));
        }
        let mut start = match self.kind(word) {
            CommandKind::Script { flags, script } => self.script(word, flags, script)?,
            CommandKind::Interpreter => self.plain(self.interpreter(word)?.into_os_string()),
            CommandKind::Other => self.plain(self.program(word, &dir)),
        };
        start.env.splice(0..0, self.variables());
        Ok(CellOrder {
            isolation: self.cells.isolation,
            command: start.command,
            env: start.env,
            dir: dir.into_os_string(),
            hidden: self.cells.hidden.iter().map(|f| f.clone().into_os_string()).collect(),
            descriptors,
            memory: self.limits.memory,
            keep: self.keep.is_some(),
            network: self.cells.network,
            terminal: self.cells.terminal,
        })
    }

    /// What is to be said of this program if it makes no request.
    pub(crate) fn silence(&self) -> &'static str {
        let is_of_python = self.command.first().is_some_and(|word| is_python(word));
        silence(self.middleware.as_ref().map(|m| m.name), is_of_python)
    }

    /// The order for the program's own cell, if a fork server makes it: the program is there, and has its descriptors.
    pub(crate) fn forked_order(&self) -> Result<CellOrder, SutError> {
        let order = self.order(Vec::new())?;
        Ok(CellOrder { command: Vec::new(), env: Vec::new(), ..order })
    }

    /// The order for a fork server's cell, which finds the modules to import beforehand unless they are given.
    pub(crate) fn server_order(&self, preload: Option<&[String]>) -> Result<CellOrder, SutError> {
        let mut order = self.order(vec!["HRDSL_FORK_SERVER".to_owned()])?;
        order.env.retain(|(name, _)| name != "HRDSL_SEED" && name != MUTANT);
        let workspaces = self.middleware.iter().flat_map(|m| m.modules.iter().cloned());
        let own: Vec<String> =
            [order.dir.to_string_lossy().into_owned()].into_iter().chain(workspaces).collect();
        let modules = serde_json::json!({ "own": own, "preload": preload }).to_string();
        order.env.push(("HRDSL_FORK_MODULES".into(), modules.into()));
        // Functions of libraries are found at its start, once for all its forks.
        if !order.env.iter().any(|(name, _)| name == "LD_BIND_NOW") {
            order.env.extend([("LD_BIND_NOW".into(), "1".into()), ("HRDSL_FORK_BINDS".into(), "1".into())]);
        }
        Ok(CellOrder { keep: false, ..order })
    }

    /// Whether a fork server can run it: a script of Python, in namespaces, at which nobody debugs.
    #[must_use]
    pub fn can_fork(&self) -> bool {
        let is_script = self.command.first().is_some_and(|word| match self.kind(word) {
            CommandKind::Script { .. } => true,
            CommandKind::Interpreter | CommandKind::Other => false,
        });
        is_script && self.cells.isolation == CellIsolation::Namespaces && !self.cells.terminal
    }

    /// The folder for the files that it writes, if they are to be kept.
    pub(crate) fn kept_folder(&self) -> Result<Option<OwnedFd>, SutError> {
        let Some(folder) = &self.keep else { return Ok(None) };
        let what = || format!("cannot make {}", folder.display());
        std::fs::create_dir_all(folder).map_err(SutError::io(what()))?;
        let opened = open(folder, OFlags::PATH | OFlags::CLOEXEC, Mode::empty());
        Ok(Some(opened.map_err(|e| SutError::io(what())(e.into()))?))
    }

    /// What every program finds in its environment.
    fn variables(&self) -> Vec<(OsString, OsString)> {
        let given = DEFAULT_VARIABLES.iter().filter_map(|name| Some((name.into(), std::env::var_os(name)?)));
        let fixed = [
            ("LANG", "C.UTF-8".to_owned()),
            ("TZ", "UTC".to_owned()),
            ("HRDSL_SEED", self.seed.to_string()),
            ("PYTHONHASHSEED", self.hash_seed.to_string()),
            ("PYTHONIOENCODING", "utf-8:backslashreplace".to_owned()),
            // Before the budget is used up, so that the program itself says where.
            ("HRDSL_BUSY_SECONDS", (self.limits.budget.as_secs_f64() * 0.8).to_string()),
        ];
        let fixed = fixed.into_iter().map(|(name, value)| (name.into(), value.into()));
        let bound = self.middleware.iter().flat_map(|m| {
            [("HRDSL_MIDDLEWARE", m.name.into()), ("HRDSL_BINDING", m.binding.clone().into_os_string())]
        });
        let bound = bound.map(|(name, value)| (name.into(), value));
        let mutant = self.mutant.iter().map(|mutant| (MUTANT.into(), mutant.words().into()));
        given.chain(fixed).chain(bound).chain(self.variables.iter().cloned()).chain(mutant).collect()
    }

    fn kind(&self, word: &str) -> CommandKind<'_> {
        if !is_python(word) {
            return CommandKind::Other;
        }
        let words = &self.command[1..];
        let mut at = 0;
        while let Some(flag) = words.get(at) {
            match flag.as_str() {
                "-m" | "-c" => return CommandKind::Script { flags: &words[..at], script: &words[at..] },
                "-" => return CommandKind::Interpreter,
                "-W" | "-X" => at += 2,
                flag if flag.starts_with('-') => at += 1,
                _ => return CommandKind::Script { flags: &words[..at], script: &words[at..] },
            }
        }
        CommandKind::Interpreter
    }

    fn script(&self, word: &str, flags: &[String], script: &[String]) -> Result<StartCommand, SutError> {
        let file = self.dir.join(&script[0]);
        if !matches!(script[0].as_str(), "-m" | "-c") && !file.is_file() {
            return Err(absent("script", file.display().to_string()));
        }
        let env = &self.env;
        // Without `site`: its hooks can cost more than all else. The runner sets the search path instead.
        let mut command = vec![self.interpreter(word)?.into_os_string(), "-S".into()];
        command.extend(flags.iter().map(OsString::from));
        command.push(env.sdk.join("hrdsl").join("run.py").into_os_string());
        for file in &self.coverage {
            command.extend(["--coverage".into(), OsString::from(file)]);
        }
        command.extend(script.iter().map(OsString::from));
        let modules = self.middleware.iter().flat_map(|m| &m.modules);
        let variables = [
            ("HRDSL_SYS_PATH", join(modules.chain(&env.path).map(OsString::from))),
            ("HRDSL_COVERAGE_PACKAGE", env.coverage.clone().into_os_string()),
            ("HRDSL_COVERAGE_CACHE", env.analyses.clone().into_os_string()),
        ];
        let lines = self.lines.then(|| ("HRDSL_LINES", "1".into()));
        let variables = variables.into_iter().chain(lines);
        Ok(StartCommand { command, env: variables.map(|(name, value)| (name.into(), value)).collect() })
    }

    /// A command that is started as it is; any Python below it finds the SDK.
    fn plain(&self, program: OsString) -> StartCommand {
        let words = self.command[1..].iter().map(OsString::from);
        let folders = [self.env.sdk.clone().into_os_string()].into_iter();
        let path = join(folders.chain(self.env.path.first().map(OsString::from)));
        StartCommand {
            command: [program].into_iter().chain(words).collect(),
            env: vec![("PYTHONPATH".into(), path)],
        }
    }

    /// The interpreter that a word of the command means.
    fn interpreter(&self, word: &str) -> Result<PathBuf, SutError> {
        if word == self.env.word || word == "python" || word == "python3" {
            return Ok(self.env.python.clone());
        }
        Err(SutError::Environment {
            what: format!("the command asks for `{word}`"),
            detail: format!("the environment was prepared for `{}`", self.env.word),
        })
    }

    /// A program with a slash is relative to the folder, one without is searched for on the path.
    fn program(&self, word: &str, dir: &Path) -> OsString {
        if word.contains('/') { dir.join(word).into_os_string() } else { word.into() }
    }
}

pub(crate) fn absent(what: &'static str, looked_for: String) -> SutError {
    SutError::Absent { what, looked_for }
}

fn join(folders: impl Iterator<Item = OsString>) -> OsString {
    // A folder whose name has the separator in it cannot be searched; the others still can.
    std::env::join_paths(folders.filter(|f| std::env::join_paths([f]).is_ok())).unwrap_or_default()
}
