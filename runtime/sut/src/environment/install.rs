//! Installing by pip, from a file of requirements that is written for it: with copies in place of local folders.

use std::{
    ffi::OsStr,
    fs,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
    time::Instant,
};

use super::{
    cache::{MakingPart, PreparationListener},
    local,
    named::{self, LocalKind},
    preparation::PreparationStep,
    requirements::{PipRequirements, RequirementLine},
    watch::{PipSaid, watch},
};
use crate::error::SutError;

/// How much of what pip said is passed on when it fails.
const LAST_LINES: usize = 16;
const LONGEST_LINE: usize = 240;

/// What is installed, and how.
pub(super) struct PipOrder<'a> {
    pub python: &'a Path,
    pub requirements: &'a PipRequirements,
    /// In words.
    pub what: &'a str,
    /// Whether pip must build anew what it may have built before under the same name.
    pub afresh: bool,
    pub listen: PreparationListener<'a>,
}

/// Installs by the interpreter's own pip or, if it has none, by that of a virtual environment made for this.
pub(super) fn install(order: &PipOrder<'_>, making: &MakingPart) -> Result<(), SutError> {
    let written = WrittenList::new(order.requirements, &making.scratch)?;
    let mut said = pip(order, order.python, &written, making)?;
    if said.stderr.last().is_some_and(|line| line.ends_with("No module named pip")) {
        let python = virtual_environment(order.python, &making.scratch.join("venv"))?;
        said = pip(order, &python, &written, making)?;
    }
    if said.status.success() { Ok(()) } else { Err(failure(order, &written, &said)) }
}

/// Makes a virtual environment; its interpreter.
fn virtual_environment(python: &Path, place: &Path) -> Result<PathBuf, SutError> {
    let output = run(command(python).args(["-I", "-m", "venv"]).arg(place))?;
    if !output.status.success() {
        return Err(SutError::Environment {
            what: format!("{} has no pip, and cannot make a virtual environment", python.display()),
            detail: format!(
                "{}\ninstall pip for it (on Debian: python3-pip or python3-venv)",
                last_lines(&output)
            ),
        });
    }
    Ok(place.join("bin").join("python"))
}

fn pip(
    order: &PipOrder<'_>,
    python: &Path,
    written: &WrittenList,
    making: &MakingPart,
) -> Result<PipSaid, SutError> {
    // Without modules of the folder in which it runs.
    let mut command = command(python);
    command.args(["-I", "-m", "pip", "install", "--no-input", "--disable-pip-version-check"]);
    command.args(["--no-warn-script-location", "--progress-bar", "off", "--target"]).arg(&making.folder);
    command.arg("--requirement").arg(&written.requirements);
    if !order.requirements.constraints.is_empty() {
        command.arg("--constraint").arg(&written.constraints);
    }
    command.args(order.afresh.then_some("--no-cache-dir"));
    // Older versions do not know these as options. A user's own defaults do not go with a target.
    command.envs([
        ("PIP_ROOT_USER_ACTION", "ignore"),
        ("PIP_USER", "0"),
        ("PIP_REQUIRE_VIRTUALENV", "0"),
        ("GIT_OPTIONAL_LOCKS", "0"),
    ]);
    command.env_remove("PIP_PREFIX").env_remove("PIP_QUIET");
    let temporary = making.scratch.join("tmp");
    fs::create_dir_all(&temporary).map_err(SutError::io("cannot make a temporary folder"))?;
    command.env("TMPDIR", temporary).current_dir(&order.requirements.folder);
    let start = Instant::now();
    watch(&mut command, &|doing| {
        let doing = written.original(doing);
        (order.listen)(PreparationStep::Working {
            what: order.what,
            doing: &doing,
            elapsed: start.elapsed(),
        });
    })
}

fn failure(order: &PipOrder<'_>, written: &WrittenList, said: &PipSaid) -> SutError {
    let lines = if said.stderr.is_empty() { &said.stdout } else { &said.stderr };
    let last = lines[lines.len().saturating_sub(LAST_LINES)..].iter();
    let mut text = written.original(&last.map(|line| shortened(line)).collect::<Vec<_>>().join("\n"));
    let mut required = blamed(order.requirements, &text);
    // Errors of a build do not say which package it was.
    let is_about = |line: &&String| ["Collecting ", "Processing "].iter().any(|word| line.starts_with(word));
    if let (true, Some(about)) = (required.is_empty(), said.stdout.iter().rfind(is_about)) {
        text = format!("{}\n{text}", written.original(about));
        required = blamed(order.requirements, &text);
    }
    let advice = "without a network, give pip a folder of wheels by PIP_FIND_LINKS and PIP_NO_INDEX";
    SutError::Environment {
        what: format!("pip could not install {}", order.what),
        detail: format!("{text}\n{required}{advice}"),
    }
}

/// The requirements that pip's errors name, a line for each.
fn blamed(requirements: &PipRequirements, text: &str) -> String {
    let blamed = |line: &&RequirementLine| line.name.is_some() && is_blamed(line, text);
    let lines = requirements.all_lines().filter(blamed);
    lines.map(|line| format!("required at {}: {}\n", line.origin, line.text)).collect()
}

/// A line of pip may hold all versions of a project.
fn shortened(line: &str) -> String {
    match line.char_indices().nth(LONGEST_LINE) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.to_owned(),
    }
}

/// Whether pip's errors name a requirement: its path, or its project as a word.
fn is_blamed(line: &RequirementLine, text: &str) -> bool {
    if let Some(local) = &line.local {
        return text.contains(&*local.path.to_string_lossy());
    }
    let Some(name) = named::project(&line.expanded) else { return text.contains(&line.expanded) };
    let same = |word: &str| {
        named::project(word).is_some_and(|word| normal(word.trim_end_matches('.')) == normal(name))
    };
    text.lines()
        .filter(|line| line.trim_start().starts_with("ERROR"))
        .any(|line| line.split([' ', '\'', '"', ',']).any(same))
}

/// A project's name as the index compares it.
pub(super) fn normal(name: &str) -> String {
    name.to_ascii_lowercase().replace(['_', '.'], "-")
}

/// The files that pip reads, and the copies that they name.
struct WrittenList {
    requirements: PathBuf,
    constraints: PathBuf,
    /// What pip may say, and what is meant.
    instead: Vec<(String, String)>,
}

impl WrittenList {
    fn new(requirements: &PipRequirements, scratch: &Path) -> Result<Self, SutError> {
        let at = |name: &str| scratch.join(name);
        let mut written = Self {
            requirements: at("requirements.txt"),
            constraints: at("constraints.txt"),
            instead: Vec::new(),
        };
        for (file, lines) in [
            (written.requirements.clone(), &requirements.lines),
            (written.constraints.clone(), &requirements.constraints),
        ] {
            let mut text = String::new();
            for (at, line) in lines.iter().enumerate() {
                text += &written.line(line, scratch)?;
                text.push('\n');
                let place = format!("{} (line {})", file.display(), at + 1);
                written
                    .instead
                    .push((place, format!("{} (line {})", line.origin.file.display(), line.origin.line)));
            }
            fs::write(&file, text).map_err(SutError::io(format!("cannot write {}", file.display())))?;
        }
        Ok(written)
    }

    fn line(&mut self, line: &RequirementLine, scratch: &Path) -> Result<String, SutError> {
        let Some(local) = &line.local else { return Ok(line.text.clone()) };
        match local.kind {
            LocalKind::File | LocalKind::Repository => Ok(line.text.clone()),
            LocalKind::Links => Ok(local.with(&local.path)),
            LocalKind::Folder => {
                let original = local.path.canonicalize().unwrap_or_else(|_| local.path.clone());
                let name = original.file_name().unwrap_or(OsStr::new("project"));
                let copy = scratch.join("local").join(self.instead.len().to_string()).join(name);
                local::copy(&original, &copy)?;
                self.instead
                    .push((copy.to_string_lossy().into_owned(), local.path.to_string_lossy().into_owned()));
                Ok(local.with(&copy))
            }
        }
    }

    /// What pip says, in the user's own names.
    fn original(&self, text: &str) -> String {
        self.instead.iter().fold(text.to_owned(), |text, (said, meant)| text.replace(said, meant))
    }
}

pub(super) fn command(program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(program);
    command.stdin(Stdio::null()).env_remove("PYTHONHASHSEED").env_remove("PYTHONSAFEPATH");
    command
}

pub(super) fn run(command: &mut Command) -> Result<Output, SutError> {
    let what = format!("cannot start {}", command.get_program().to_string_lossy());
    command.output().map_err(SutError::io(what))
}

pub(super) fn last_lines(output: &Output) -> String {
    let text = [output.stdout.as_slice(), &output.stderr].map(String::from_utf8_lossy).concat();
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
    lines[lines.len().saturating_sub(LAST_LINES)..].join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An environment without pip stands for a system whose Python has none.
    #[test]
    fn a_virtual_environment_serves_where_there_is_no_pip() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let made = run(command("python3").args(["-m", "venv", "--without-pip"]).arg(at("bare"))).unwrap();
        assert!(made.status.success());
        let making = MakingPart { folder: at("made"), scratch: at("scratch") };
        fs::create_dir(&making.scratch).unwrap();
        let requirements = PipRequirements::built_in("--no-index", folder.path());
        let python = &at("bare/bin/python");
        let order =
            PipOrder { python, requirements: &requirements, what: "nothing", afresh: false, listen: &|_| {} };
        install(&order, &making).unwrap();
        assert!(at("scratch/venv").is_dir());
    }

    #[test]
    fn errors_are_traced_to_their_requirements() {
        let requirements = PipRequirements::built_in("Py_Yaml==9\nother", Path::new("/"));
        let text = "ERROR: No matching distribution found for py-yaml==9\nnote: other";
        assert_eq!(blamed(&requirements, text), "required at built in:1: Py_Yaml==9\n");
        assert_eq!(shortened(&"é".repeat(300)).chars().count(), LONGEST_LINE + 1);
    }
}
