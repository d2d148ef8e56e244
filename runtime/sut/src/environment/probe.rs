//! What an interpreter says about itself.

use std::{
    io::ErrorKind,
    path::{Path, PathBuf},
    process::Output,
};

use percent_encoding::percent_decode_str;
use serde::Deserialize;

use super::{
    install::{command, last_lines},
    preparation::HookedPackage,
};
use crate::error::SutError;

const PROBE: &str = include_str!("probe.py");

#[derive(Deserialize)]
pub(super) struct ProbedInterpreter {
    /// Of a virtual environment its own link, behind any wrapper on the path.
    pub executable: PathBuf,
    /// The installation that it belongs to: what is built here links with that.
    pub base: String,
    pub version: (u32, u32, u32),
    /// Names the version, implementation and platform: compiled packages of one do not load in another.
    pub tag: String,
    /// Where it searches for modules.
    pub path: Vec<String>,
    hooked: Vec<EditableHook>,
    /// Of pip's configuration the options that decide what is installed: section, name, value.
    pub pip: Vec<(String, String, String)>,
}

#[derive(Deserialize)]
struct EditableHook {
    package: String,
    url: String,
}

impl ProbedInterpreter {
    pub(super) fn hooked(&self) -> Vec<HookedPackage> {
        let folder = |url: &str| {
            let path = url.strip_prefix("file://")?;
            Some(percent_decode_str(path).decode_utf8_lossy().into_owned())
        };
        let hooked =
            |hook: &EditableHook| HookedPackage { package: hook.package.clone(), folder: folder(&hook.url) };
        self.hooked.iter().map(hooked).collect()
    }
}

/// Asks the interpreter that `word` means for a program in `dir`. `python` and `python3` stand for each other where
/// there is only one of them.
pub(super) fn ask(word: &str, dir: &Path, with_pip: bool) -> Result<ProbedInterpreter, SutError> {
    let other = match word {
        "python" => "python3",
        "python3" => "python",
        _ => return ask_one(word, dir, with_pip),
    };
    ask_one(word, dir, with_pip).or_else(|error| ask_one(other, dir, with_pip).map_err(|_| error))
}

/// A word with a slash is relative to `dir`, one without is searched for on the path.
fn ask_one(word: &str, dir: &Path, with_pip: bool) -> Result<ProbedInterpreter, SutError> {
    let program = if word.contains('/') { dir.join(word) } else { PathBuf::from(word) };
    let shown = program.display();
    let mut command = command(&program);
    // Isolated and in the program's folder: a tool that chooses versions by folder chooses as it does for the
    // program, and no module there is taken for one of the standard library.
    command.current_dir(dir).args(["-I", "-c", PROBE]).args(with_pip.then_some("pip"));
    let output = command.output().map_err(|e| {
        if e.kind() != ErrorKind::NotFound {
            SutError::io(format!("cannot start {shown}"))(e)
        } else if dir.is_dir() {
            let looked_for = format!("`{shown}` (install Python 3.8 or newer, or name another one in `run`)");
            SutError::Absent { what: "Python", looked_for }
        } else {
            SutError::Absent { what: "folder of the program", looked_for: dir.display().to_string() }
        }
    })?;
    match told(&output) {
        Some(probe) if probe.version >= (3, 8, 0) => Ok(probe),
        Some(ProbedInterpreter { version: (major, minor, micro), .. }) => Err(SutError::Environment {
            what: format!("`{shown}` is Python {major}.{minor}.{micro}"),
            detail: "Python 3.8 or newer is needed".to_owned(),
        }),
        None => Err(SutError::Environment {
            what: format!("`{shown}` does not say what it is: is it Python 3.8 or newer?"),
            detail: last_lines(&output),
        }),
    }
}

/// The last line is the answer; hooks of `site` may have printed before.
fn told(output: &Output) -> Option<ProbedInterpreter> {
    let last = output.stdout.trim_ascii_end().rsplit(|&b| b == b'\n').next()?;
    serde_json::from_slice(last).ok().filter(|_| output.status.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The search path that an interpreter tells, in an environment with these variables.
    fn path_of(program: &Path, variables: &[(&str, &Path)]) -> Vec<PathBuf> {
        let mut command = command(program);
        command.args(["-I", "-c", PROBE]).envs(variables.iter().copied());
        let told = told(&command.output().unwrap()).unwrap();
        told.path.into_iter().map(PathBuf::from).collect()
    }

    /// `-I` alone would leave them out. What `PYTHONPATH` names, the program finds by itself.
    #[test]
    fn the_users_own_packages_are_searched_before_the_systems() {
        let folder = tempfile::tempdir().unwrap();
        let python = ask("python3", folder.path(), false).unwrap();
        let (major, minor, _) = python.version;
        let own = folder.path().join(format!("lib/python{major}.{minor}/site-packages"));
        let beside = folder.path().join("beside");
        std::fs::create_dir_all(&own).unwrap();
        std::fs::create_dir(&beside).unwrap();
        std::fs::write(own.join("beside.pth"), beside.display().to_string()).unwrap();
        let base: &[(&str, &Path)] = &[("PYTHONUSERBASE", folder.path()), ("PYTHONPATH", &beside)];

        let path = path_of(&python.executable, base);
        let at = |wanted: &dyn Fn(&Path) -> bool| path.iter().position(|folder| wanted(folder));
        let place = at(&|folder| folder == own).unwrap();
        assert_eq!(at(&|folder| folder == beside), Some(place + 1), "{path:?}");
        let shared = at(&|folder| folder != own && folder.ends_with("site-packages"));
        assert!(shared.is_none_or(|shared| shared > place), "{path:?}");

        let without = path_of(&python.executable, &[base[0], ("PYTHONNOUSERSITE", Path::new("1"))]);
        assert!(!without.contains(&own));
        let made = command(&python.executable)
            .args(["-m", "venv", "--without-pip"])
            .arg(folder.path().join("venv"))
            .status();
        assert!(made.unwrap().success());
        let virtual_path = path_of(&folder.path().join("venv/bin/python"), base);
        assert!(!virtual_path.contains(&own) && virtual_path.iter().any(|f| f.starts_with(folder.path())));
    }

    #[test]
    fn what_is_no_python_is_said_so() {
        let folder = tempfile::tempdir().unwrap();
        let said = |word: &str, dir: &Path| ask(word, dir, false).map(|_| ()).unwrap_err().to_string();
        let there = folder.path();
        assert!(said("python3-of-nowhere", there).contains("`python3-of-nowhere`"));
        assert!(said("bin/python", there).contains(&there.join("bin/python").display().to_string()));
        assert!(said("python3", &there.join("none")).contains("folder of the program"));
        assert!(said("/bin/false", there).contains("is it Python 3.8 or newer?"));
    }
}
