//! What robot code in Python needs, installed once into a cache folder: the SDK, coverage.py, its own requirements.
//!
//! Each part has a folder of its own, named by what it was made from, so that nothing is ever changed in place: two
//! processes that prepare the same part both make it and one wins the rename.

use std::{
    ffi::OsStr,
    fmt::Write as _,
    fs,
    io::ErrorKind,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
};

use serde::Deserialize;
use sha2::{Digest, Sha256};

use crate::SutError;

/// The newest coverage.py for each Python; pinned, since its tracer's packing of line numbers is read directly.
const COVERAGE: &str = "\
coverage==7.17.3; python_version >= '3.11'
coverage==7.16.2; python_version == '3.10'
coverage==7.10.7; python_version == '3.9'
coverage==7.6.1; python_version == '3.8'
";

macro_rules! sdk {
    ($($file:literal),* $(,)?) => {
        &[$(($file, include_str!(concat!("../../../sdk/python/hrdsl/", $file)))),*]
    };
}

/// The SDK, file by file.
const SDK: &[(&str, &str)] = sdk![
    "__init__.py",
    "chance.py",
    "cover.py",
    "dates.py",
    "debug.py",
    "errors.py",
    "files.py",
    "link.py",
    "machine.py",
    "node.py",
    "replace.py",
    "run.py",
    "runner.py",
    "virtual.py",
];

/// An interpreter, and where the modules are that programs under test need.
#[derive(Clone, Debug)]
pub struct PythonEnv {
    /// The interpreter's version.
    version: String,
    /// The word by which the interpreter was looked for.
    pub(crate) word: String,
    /// The interpreter itself, behind any wrapper on the path.
    pub(crate) python: PathBuf,
    /// The folder that has the package `hrdsl`.
    pub(crate) sdk: PathBuf,
    /// The folder that has coverage.py.
    pub(crate) coverage: PathBuf,
    /// The folder for static analyses of source files.
    pub(crate) analyses: PathBuf,
    /// Where modules are searched for, after the standard library.
    pub(crate) path: Vec<String>,
}

/// What an interpreter says about itself.
#[derive(Deserialize)]
struct Probe {
    executable: PathBuf,
    version: (u32, u32),
    /// Names the version, implementation and platform: compiled packages of one do not load in another.
    tag: String,
    path: Vec<String>,
}

const PROBE: &str = "import sys, json; json.dump({'executable': sys.executable, 'version': sys.version_info[:2], \
    'tag': '%s-%s-%s' % (sys.version.split()[0], sys.implementation.cache_tag, sys.platform), \
    'path': [p for p in sys.path if p]}, sys.stdout)";

impl PythonEnv {
    /// Installs what is missing under `cache_dir`, for the `python3` on the path; quick when all is there.
    ///
    /// `requirements` is the `requirements.txt` beside the robot code, if it has one. Packages come from where pip is
    /// configured to get them (an index, `PIP_FIND_LINKS`, `PIP_NO_INDEX`, …).
    ///
    /// # Errors
    /// [`SutError::Absent`] without Python or requirements file; [`SutError::Environment`] with pip's last lines if it
    /// fails; [`SutError::Io`] if the cache cannot be written.
    pub fn prepare(cache_dir: &Path, requirements: Option<&Path>) -> Result<Self, SutError> {
        Self::prepare_with("python3", cache_dir, requirements)
    }

    /// The interpreter's version, in full.
    #[must_use]
    pub fn version(&self) -> &str {
        &self.version
    }

    /// As [`prepare`](Self::prepare), for another interpreter: a name on the path, or a path.
    ///
    /// # Errors
    /// As [`prepare`](Self::prepare).
    pub fn prepare_with(
        python: &str,
        cache_dir: &Path,
        requirements: Option<&Path>,
    ) -> Result<Self, SutError> {
        fs::create_dir_all(cache_dir)
            .map_err(SutError::io(format!("cannot make {}", cache_dir.display())))?;
        let cache = cache_dir.canonicalize().map_err(SutError::io("cannot find the cache"))?;
        let probe = probe(python)?;
        let made_from: Vec<&str> = [probe.tag.as_str()]
            .into_iter()
            .chain(SDK.iter().flat_map(|&(name, text)| [name, text]))
            .collect();
        let sdk = made(&cache, "sdk", &made_from, |dir| write_sdk(&probe.executable, dir))?;
        let coverage = made(&cache, "coverage", &[&probe.tag, COVERAGE], |dir| {
            let list = dir.join("requirements.txt");
            fs::write(&list, COVERAGE).map_err(SutError::io("cannot write the list of packages"))?;
            install(&probe.executable, &list, dir)
        })?;
        let analyses = cache.join("analyses");
        fs::create_dir_all(&analyses).map_err(SutError::io(format!("cannot make {}", analyses.display())))?;
        let mut path = Vec::new();
        if let Some(list) = requirements {
            let text = read_requirements(list)?;
            let dir =
                made(&cache, "packages", &[&probe.tag, &text], |dir| install(&probe.executable, list, dir))?;
            path.push(dir.to_string_lossy().into_owned());
        }
        path.extend(probe.path);
        Ok(Self {
            version: probe.tag,
            word: python.to_owned(),
            python: probe.executable,
            sdk,
            coverage,
            analyses,
            path,
        })
    }
}

fn read_requirements(list: &Path) -> Result<String, SutError> {
    fs::read_to_string(list).map_err(|e| match e.kind() {
        ErrorKind::NotFound => {
            SutError::Absent { what: "list of requirements", looked_for: list.display().to_string() }
        }
        _ => SutError::io(format!("cannot read {}", list.display()))(e),
    })
}

fn probe(python: &str) -> Result<Probe, SutError> {
    let output = command(python).args(["-c", PROBE]).output().map_err(|e| match e.kind() {
        ErrorKind::NotFound => SutError::Absent {
            what: "Python",
            looked_for: format!("`{python}` (install Python 3.8 or newer)"),
        },
        _ => SutError::io(format!("cannot start {python}"))(e),
    })?;
    let probe: Option<Probe> = serde_json::from_slice(&output.stdout).ok();
    match probe {
        Some(probe) if output.status.success() && probe.version >= (3, 8) => Ok(probe),
        Some(probe) => Err(SutError::Environment {
            what: format!("`{python}` is Python {}.{}", probe.version.0, probe.version.1),
            detail: "Python 3.8 or newer is needed".to_owned(),
        }),
        None => Err(SutError::Environment {
            what: format!("`{python}` does not say what it is"),
            detail: last_lines(&output),
        }),
    }
}

/// The folder `cache/kind-<digest of made_from>`; if it is not there, it is filled beside and moved into its place.
fn made(
    cache: &Path,
    kind: &str,
    made_from: &[&str],
    fill: impl FnOnce(&Path) -> Result<(), SutError>,
) -> Result<PathBuf, SutError> {
    let place = cache.join(format!("{kind}-{}", digest(made_from)));
    if place.is_dir() {
        return Ok(place);
    }
    let io = || SutError::io(format!("cannot write to {}", cache.display()));
    let temporary = tempfile::Builder::new().prefix(&format!(".{kind}-")).tempdir_in(cache).map_err(io())?;
    let inner = temporary.path().join("made");
    fs::create_dir(&inner).map_err(io())?;
    fill(&inner)?;
    match fs::rename(&inner, &place) {
        Ok(()) => Ok(place),
        // Somebody else was quicker, and made the same.
        Err(_) if place.is_dir() => Ok(place),
        Err(e) => Err(io()(e)),
    }
}

fn digest(parts: &[&str]) -> String {
    let mut hash = Sha256::new();
    for part in parts {
        hash.update((part.len() as u64).to_le_bytes());
        hash.update(part.as_bytes());
    }
    hash.finalize().iter().take(8).fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

fn write_sdk(python: &Path, dir: &Path) -> Result<(), SutError> {
    let package = dir.join("hrdsl");
    let io = || SutError::io(format!("cannot write to {}", dir.display()));
    fs::create_dir(&package).map_err(io())?;
    for (name, text) in SDK {
        fs::write(package.join(name), text).map_err(io())?;
    }
    // Byte code now, since the programs may be told not to write any. Without it they only start more slowly.
    run(command(python).args(["-m", "compileall", "-q"]).arg(&package)).map(drop)
}

/// Installs a list of packages into a folder, by the interpreter's own pip or, if it has none, by that of a virtual
/// environment made for this.
fn install(python: &Path, list: &Path, dir: &Path) -> Result<(), SutError> {
    let has_pip = run(command(python).args(["-m", "pip", "--version"]))?.status.success();
    if has_pip { pip(python, list, dir) } else { install_by_venv(python, list, dir) }
}

fn install_by_venv(python: &Path, list: &Path, dir: &Path) -> Result<(), SutError> {
    let place = tempfile::tempdir().map_err(SutError::io("cannot make a temporary folder"))?;
    let output = run(command(python).args(["-m", "venv"]).arg(place.path()))?;
    if !output.status.success() {
        return Err(SutError::Environment {
            what: format!("{} has no pip, and cannot make a virtual environment", python.display()),
            detail: format!(
                "{}\ninstall pip for it (on Debian: python3-pip or python3-venv)",
                last_lines(&output)
            ),
        });
    }
    let folder = if cfg!(windows) { "Scripts" } else { "bin" };
    pip(&place.path().join(folder).join("python"), list, dir)
}

fn pip(python: &Path, list: &Path, dir: &Path) -> Result<(), SutError> {
    let list = list.canonicalize().map_err(SutError::io(format!("cannot find {}", list.display())))?;
    let mut command = command(python);
    command.args(["-m", "pip", "install", "--quiet", "--no-input", "--disable-pip-version-check"]);
    command.args(["--no-warn-script-location", "--root-user-action=ignore", "--target"]).arg(dir);
    command.arg("--requirement").arg(&list);
    if let Some(folder) = list.parent() {
        // A requirement may be a path beside the list.
        command.current_dir(folder);
    }
    let output = run(&mut command)?;
    if output.status.success() {
        return Ok(());
    }
    Err(SutError::Environment {
        what: format!("pip could not install {}", list.display()),
        detail: format!(
            "{}\nwithout a network, give pip a folder of wheels by PIP_FIND_LINKS and PIP_NO_INDEX",
            last_lines(&output)
        ),
    })
}

fn command(program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(program);
    command.stdin(Stdio::null()).env_remove("PYTHONHASHSEED").env_remove("PYTHONSAFEPATH");
    command
}

fn run(command: &mut Command) -> Result<Output, SutError> {
    let what = format!("cannot start {}", command.get_program().to_string_lossy());
    command.output().map_err(SutError::io(what))
}

fn last_lines(output: &Output) -> String {
    let text = [output.stdout.as_slice(), &output.stderr].map(String::from_utf8_lossy).concat();
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
    lines[lines.len().saturating_sub(8)..].join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_whole_sdk_is_embedded() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../sdk/python/hrdsl");
        let mut there: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .filter(|name| name.ends_with(".py"))
            .collect();
        there.sort();
        assert_eq!(there, SDK.iter().map(|(name, _)| (*name).to_owned()).collect::<Vec<_>>());
    }

    #[test]
    fn digests_tell_parts_apart() {
        assert_ne!(digest(&["ab", "c"]), digest(&["a", "bc"]));
        assert_eq!(digest(&["a"]).len(), 16);
    }

    #[test]
    fn a_folder_is_made_once_and_never_half() {
        let cache = tempfile::tempdir().unwrap();
        let fail = made(cache.path(), "x", &["1"], |dir| {
            fs::write(dir.join("half"), "").unwrap();
            Err(SutError::Environment { what: "w".into(), detail: "d".into() })
        });
        assert!(fail.is_err());
        assert_eq!(fs::read_dir(cache.path()).unwrap().count(), 0, "nothing stays behind");
        let fill = |dir: &Path| fs::write(dir.join("all"), "").map_err(SutError::io("write"));
        let first = made(cache.path(), "x", &["1"], fill).unwrap();
        let again = made(cache.path(), "x", &["1"], |_| panic!("made twice")).unwrap();
        assert_eq!(first, again);
        assert_eq!(fs::read_dir(cache.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_race_has_one_winner_and_no_loser() {
        let cache = tempfile::tempdir().unwrap();
        let place = made(cache.path(), "x", &["1"], |dir| {
            // The other process comes first.
            made(cache.path(), "x", &["1"], |dir| fs::write(dir.join("all"), "").map_err(SutError::io("w")))?;
            fs::write(dir.join("all"), "").map_err(SutError::io("w"))
        })
        .unwrap();
        assert!(place.join("all").exists());
    }

    #[test]
    fn without_python_or_requirements_it_says_what_it_looked_for() {
        let cache = tempfile::tempdir().unwrap();
        let error = PythonEnv::prepare_with("python3-of-nowhere", cache.path(), None).unwrap_err();
        assert!(error.to_string().contains("`python3-of-nowhere`"), "{error}");
        let error =
            PythonEnv::prepare(cache.path(), Some(Path::new("/nowhere/requirements.txt"))).unwrap_err();
        assert!(
            matches!(&error, SutError::Absent { looked_for, .. } if looked_for.contains("/nowhere/")),
            "{error}"
        );
    }

    #[test]
    fn a_virtual_environment_serves_without_pip() {
        let python = probe("python3").unwrap().executable;
        let dir = tempfile::tempdir().unwrap();
        let list = dir.path().join("none.txt");
        fs::write(&list, "# nothing\n").unwrap();
        install_by_venv(&python, &list, &dir.path().join("target")).unwrap();
        let error = install_by_venv(&python, &list.with_file_name("absent.txt"), dir.path()).unwrap_err();
        assert!(error.to_string().contains("absent.txt"), "{error}");
    }

    #[test]
    fn what_pip_says_is_passed_on() {
        let cache = tempfile::tempdir().unwrap();
        let list = cache.path().join("requirements.txt");
        fs::write(&list, "./no-such-package-beside\n").unwrap();
        let error = PythonEnv::prepare(&cache.path().join("cache"), Some(&list)).unwrap_err();
        assert!(error.to_string().contains("no-such-package-beside"), "{error}");
    }
}
