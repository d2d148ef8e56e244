//! From the words of a command to a process that can be started: Python scripts go through the SDK's runner.

use std::{
    ffi::OsString,
    path::{Path, PathBuf},
    process::Command,
    time::Duration,
};

use crate::{PythonEnv, SutError};

/// All that determines a run of the program under test.
#[derive(Clone, Debug)]
pub struct Launch {
    /// The command's words. If the first is `python`, `python3` or `python3.x`, the script runs through the SDK's
    /// runner: with simulated time, seeded chance and coverage.
    pub command: Vec<String>,
    /// The folder in which it runs; the words and `coverage` are relative to it.
    pub dir: PathBuf,
    /// The test's seed: of the program's random numbers and hashes.
    pub seed: u64,
    /// The Python files whose coverage is measured; empty: none.
    pub coverage: Vec<String>,
    pub env: PythonEnv,
    /// Wall time within which the program must make its next request, or take a reply.
    pub budget: Duration,
    /// How many bytes of each output stream are kept.
    pub output_limit: usize,
}

/// How a command is started.
enum Kind<'a> {
    /// The interpreter's flags, and the script or `-m module` with its arguments.
    Script {
        flags: &'a [String],
        script: &'a [String],
    },
    /// An interpreter that is not given a script.
    Interpreter,
    Other,
}

impl Launch {
    /// The command to start, without pipes; the coverage goes to `out`.
    pub(crate) fn command(&self, out: Option<&Path>) -> Result<Command, SutError> {
        if !self.dir.is_dir() {
            return Err(absent("folder of the program", self.dir.display().to_string()));
        }
        let Some(word) = self.command.first() else {
            return Err(absent("program", "an empty command".to_owned()));
        };
        let mut command = match self.kind(word) {
            Kind::Script { flags, script } => self.script(word, flags, script, out)?,
            Kind::Interpreter => self.plain(&self.interpreter(word)?),
            Kind::Other => self.plain(&self.program(word)),
        };
        command.current_dir(&self.dir);
        command.env("HRDSL_SEED", self.seed.to_string());
        command.env("PYTHONHASHSEED", (self.seed % (1 << 32)).to_string());
        command.env("PYTHONIOENCODING", "utf-8:backslashreplace");
        command.env("TZ", "UTC");
        command.env_remove("PYTHONSAFEPATH");
        Ok(command)
    }

    fn kind(&self, word: &str) -> Kind<'_> {
        if !is_python(word) {
            return Kind::Other;
        }
        let words = &self.command[1..];
        let mut at = 0;
        while let Some(flag) = words.get(at) {
            match flag.as_str() {
                "-m" => return Kind::Script { flags: &words[..at], script: &words[at..] },
                "-c" | "-" => return Kind::Interpreter,
                "-W" | "-X" => at += 2,
                flag if flag.starts_with('-') => at += 1,
                _ => return Kind::Script { flags: &words[..at], script: &words[at..] },
            }
        }
        Kind::Interpreter
    }

    fn script(
        &self,
        word: &str,
        flags: &[String],
        script: &[String],
        out: Option<&Path>,
    ) -> Result<Command, SutError> {
        let file = self.dir.join(&script[0]);
        if script[0] != "-m" && !file.is_file() {
            return Err(absent("script", file.display().to_string()));
        }
        let env = &self.env;
        let mut command = Command::new(self.interpreter(word)?);
        // Without `site`: its hooks can cost more than all else. The runner sets the search path instead.
        command.arg("-S").args(flags).arg(env.sdk.join("hrdsl").join("run.py"));
        if let Some(out) = out {
            for file in &self.coverage {
                command.arg("--coverage").arg(file);
            }
            command.arg("--coverage-out").arg(out);
        }
        command.args(script);
        command.env_remove("PYTHONUNBUFFERED"); // the runner writes line by line
        command.env("HRDSL_SYS_PATH", join(env.path.iter().map(OsString::from)));
        command.env("HRDSL_COVERAGE_PACKAGE", &env.coverage);
        command.env("HRDSL_COVERAGE_CACHE", &env.analyses);
        Ok(command)
    }

    /// A command that is started as it is; any Python below it finds the SDK.
    fn plain(&self, program: &Path) -> Command {
        let mut command = Command::new(program);
        command.args(&self.command[1..]);
        let before = std::env::var_os("PYTHONPATH");
        let folders = [self.env.sdk.clone().into_os_string()].into_iter();
        command
            .env("PYTHONPATH", join(folders.chain(self.env.path.first().map(OsString::from)).chain(before)));
        command
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
    fn program(&self, word: &str) -> PathBuf {
        if word.contains('/') { self.dir.join(word) } else { PathBuf::from(word) }
    }
}

pub(crate) fn absent(what: &'static str, looked_for: String) -> SutError {
    SutError::Absent { what, looked_for }
}

fn join(folders: impl Iterator<Item = OsString>) -> OsString {
    // A folder whose name has the separator in it cannot be searched; the others still can.
    std::env::join_paths(folders.filter(|f| std::env::join_paths([f]).is_ok())).unwrap_or_default()
}

pub(crate) fn is_python(word: &str) -> bool {
    let name = word.rsplit('/').next().unwrap_or(word);
    name.strip_prefix("python")
        .is_some_and(|rest| rest.is_empty() || rest == "3" || rest.strip_prefix("3.").is_some_and(is_number))
}

fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::is_python;

    #[test]
    fn which_words_are_python() {
        for word in ["python", "python3", "python3.8", "python3.14", "/usr/bin/python3", "venv/bin/python"] {
            assert!(is_python(word), "{word}");
        }
        for word in ["pythonista", "python2", "python3.", "python3.x", "ipython", "robot", ""] {
            assert!(!is_python(word), "{word}");
        }
    }
}
