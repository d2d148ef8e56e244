//! What robot code in Python needs, installed once into a cache folder: the SDK, coverage.py, its own requirements.
//!
//! Each part has a folder of its own, named by all that it is made from (`key`), so that nothing is ever changed in
//! place; `cache` makes it, and makes it again when it is damaged; `install` lets pip fill it.

mod cache;
mod digest;
mod install;
mod key;
mod local;
mod named;
mod options;
mod preparation;
mod probe;
mod requirements;
mod watch;
pub(crate) mod word;

use std::{
    fs,
    path::{Path, PathBuf},
    process::Output,
};

use cache::{CachePart, EnvironmentCache, MakingPart, PreparationListener};
use digest::PartsHasher;
use install::{PipOrder, command, install, normal, run};
use key::PackagesKey;
use probe::ProbedInterpreter;
use requirements::PipRequirements;

pub use preparation::{HookedPackage, PreparationStep};

use crate::error::SutError;

use word::is_python;

/// The newest coverage.py for each Python; pinned, since its tracer's packing of line numbers is read directly.
const COVERAGE: &str = "\
coverage==7.17.3; python_version >= '3.11'
coverage==7.16.2; python_version == '3.10'
coverage==7.10.7; python_version == '3.9'
coverage==7.6.1; python_version == '3.8'
";

include!(concat!(env!("OUT_DIR"), "/sdk.rs"));

/// An interpreter, and where the modules are that programs under test need.
#[derive(Clone, Debug)]
pub struct PythonEnv {
    /// The word by which the interpreter was looked for.
    pub(crate) word: String,
    /// The interpreter itself, behind any wrapper on the path; of a virtual environment its own link.
    pub(crate) python: PathBuf,
    version: (u32, u32, u32),
    /// The folder that has the package `hrdsl`.
    pub(crate) sdk: PathBuf,
    /// The folder that has coverage.py.
    pub(crate) coverage: PathBuf,
    /// The folder for static analyses of source files.
    pub(crate) analyses: PathBuf,
    /// The folder for texts that programs read: what is bound to their middleware.
    texts: PathBuf,
    /// The folder for lists of mutants, and for those that are run.
    pub(crate) mutants: PathBuf,
    /// Where modules are searched for, after the standard library.
    pub(crate) path: Vec<String>,
}

/// What an environment is prepared for.
#[derive(Clone, Copy, Debug)]
pub struct EnvironmentNeeds<'a> {
    /// The interpreter: a name on the path, or a path relative to `dir`.
    pub python: &'a str,
    /// The folder in which the program runs.
    pub dir: &'a Path,
    /// The `requirements.txt` beside the robot code, if it has one.
    pub requirements: Option<&'a Path>,
    /// Where everything is kept.
    pub cache: &'a Path,
}

impl PythonEnv {
    /// Installs what is missing in the cache; quick when all is there. `listen` is told what happens.
    ///
    /// Packages come from where pip is configured to get them (an index, `PIP_FIND_LINKS`, `PIP_NO_INDEX`, …). They
    /// are installed again when anything changes that can be known without asking there: the requirements and what
    /// they include, the contents of the local folders and files that they name, pip's configuration, the interpreter.
    ///
    /// # Errors
    /// [`SutError::Absent`] without Python or requirements file; [`SutError::Environment`] with pip's last lines if it
    /// fails, or the line of the requirements that is at fault; [`SutError::Io`] if the cache cannot be written.
    pub fn prepare(
        needs: &EnvironmentNeeds<'_>,
        listen: &dyn Fn(PreparationStep<'_>),
    ) -> Result<Self, SutError> {
        let cache = EnvironmentCache::open(needs.cache, listen)?;
        let dir = std::path::absolute(needs.dir)
            .map_err(SutError::io(format!("cannot find {}", needs.dir.display())))?;
        let probe = probe::ask(needs.python, &dir, needs.requirements.is_some())?;
        let sdk = sdk(&cache, &probe)?;
        let coverage = coverage(&cache, &probe)?;
        let analyses = cache.folder("analyses")?;
        let texts = cache.folder("bindings")?;
        let mutants = cache.folder("mutants")?;
        let list = needs.requirements.map(std::path::absolute).transpose();
        let list = list.map_err(SutError::io("cannot find the requirements"))?;
        let requirements = list.map(|list| PipRequirements::read(&list, &variable)).transpose()?;
        say_hooked(&probe, requirements.as_ref(), listen);
        let mut path = Vec::new();
        if let Some(requirements) = requirements.filter(|found| found.named().next().is_some()) {
            let dir = packages(&cache, &probe, &requirements, needs.requirements)?;
            path.push(dir.to_string_lossy().into_owned());
        }
        path.extend(probe.path);
        let word = needs.python.to_owned();
        Ok(Self {
            word,
            python: probe.executable,
            version: probe.version,
            sdk,
            coverage,
            analyses,
            texts,
            mutants,
            path,
        })
    }

    /// The word that names the interpreter, of the first of these commands that runs Python itself; else `python3`.
    pub fn interpreter_of<'c>(commands: impl IntoIterator<Item = &'c [String]>) -> &'c str {
        let mut words = commands.into_iter().filter_map(|c| c.first()).map(String::as_str);
        words.find(|word| is_python(word)).unwrap_or("python3")
    }

    /// Makes beforehand what follows from the texts of the measured files alone, so that the first test does not differ from
    /// the others. Gives a line about each file that cannot be measured: it is missing, or has a syntax error.
    ///
    /// # Errors
    /// [`SutError::Io`] if the interpreter cannot be started.
    pub fn analyse(&self, dir: &Path, files: &[String]) -> Result<Vec<String>, SutError> {
        if files.is_empty() {
            return Ok(Vec::new());
        }
        let mut command = install::command(&self.python);
        command.args(["-S", "-E"]).arg(self.sdk.join("hrdsl").join("cover.py")).arg("--analyse");
        command.arg("--package").arg(&self.coverage).arg("--cache").arg(&self.analyses).args(files);
        let output = command.current_dir(dir).output().map_err(SutError::io("cannot start Python"))?;
        Ok(String::from_utf8_lossy(&output.stderr).lines().map(str::to_owned).collect())
    }

    /// What a script of the SDK says that is started with these words in a folder; the script is a path below the package `hrdsl`.
    pub(crate) fn ask_script(&self, script: &str, words: &[PathBuf], dir: &Path) -> Result<Output, SutError> {
        let mut command = install::command(&self.python);
        command.args(["-S", "-E", "-B"]).arg(self.sdk.join("hrdsl").join(script)).args(words);
        install::run(command.current_dir(dir))
    }

    /// Keeps a text for programs to read, in a file that is called by what is in it.
    ///
    /// # Errors
    /// [`SutError::Io`] if the cache cannot be written.
    pub fn kept(&self, text: &str) -> Result<PathBuf, SutError> {
        let file = self.texts.join(PartsHasher::of(&[text]).finish());
        let io = || SutError::io(format!("cannot write {}", file.display()));
        if fs::read(&file).is_ok_and(|there| there == text.as_bytes()) {
            return Ok(file);
        }
        // Beside it first: another process may be reading it.
        let mut made = tempfile::NamedTempFile::new_in(&self.texts).map_err(io())?;
        std::io::Write::write_all(&mut made, text.as_bytes()).map_err(io())?;
        made.persist(&file).map_err(|e| io()(e.error))?;
        Ok(file)
    }

    /// The folder that has coverage.py.
    #[must_use]
    pub fn coverage_package(&self) -> &Path {
        &self.coverage
    }

    /// The interpreter's full version, as `3.11.7`.
    #[must_use]
    pub fn version(&self) -> String {
        let (major, minor, micro) = self.version;
        format!("{major}.{minor}.{micro}")
    }
}

fn variable(name: &str) -> Option<String> {
    std::env::var(name).ok()
}

/// The packages that no program will find, apart from those that the requirements install.
fn say_hooked(
    probe: &ProbedInterpreter,
    requirements: Option<&PipRequirements>,
    listen: PreparationListener<'_>,
) {
    let lines = || requirements.into_iter().flat_map(PipRequirements::all_lines);
    let names: Vec<String> = lines().filter_map(|line| line.name.as_deref()).map(normal).collect();
    let folder = |path: &Path| path.canonicalize().ok();
    let folders: Vec<PathBuf> = lines().filter_map(|line| folder(&line.local.as_ref()?.path)).collect();
    let mut hooked = probe.hooked();
    hooked.retain(|hook| {
        let place = hook.folder.as_ref().and_then(|place| folder(Path::new(place)));
        !names.contains(&normal(&hook.package)) && !place.is_some_and(|place| folders.contains(&place))
    });
    if !hooked.is_empty() {
        listen(PreparationStep::Hooked { packages: &hooked });
    }
}

/// The variable that names a folder whose SDK is used in the place of the one built in, by those who work on it.
const OTHER_SDK: &str = "HRDSL_SDK";

fn sdk(cache: &EnvironmentCache<'_>, probe: &ProbedInterpreter) -> Result<PathBuf, SutError> {
    if let Some(folder) = variable(OTHER_SDK).filter(|folder| !folder.is_empty()) {
        let what = format!("cannot find {folder}, which {OTHER_SDK} names");
        return Path::new(&folder).canonicalize().map_err(SutError::io(what));
    }
    let made_from: Vec<&str> =
        [probe.tag.as_str()].into_iter().chain(SDK.iter().flat_map(|&(name, text)| [name, text])).collect();
    let part = CachePart { kind: "sdk", key: PartsHasher::of(&made_from).finish(), what: "the SDK" };
    cache.silent().made(&part, |making| write_sdk(&probe.executable, &making.folder))
}

fn write_sdk(python: &Path, dir: &Path) -> Result<(), SutError> {
    let io = || SutError::io(format!("cannot write to {}", dir.display()));
    for (name, text) in SDK {
        let file = dir.join(name);
        if let Some(folder) = file.parent() {
            fs::create_dir_all(folder).map_err(io())?;
        }
        fs::write(file, text).map_err(io())?;
    }
    // Byte code now, since the programs may be told not to write any. Without it they only start more slowly.
    run(command(python).args(["-I", "-m", "compileall", "-q"]).arg(dir)).map(drop)
}

fn coverage(cache: &EnvironmentCache<'_>, probe: &ProbedInterpreter) -> Result<PathBuf, SutError> {
    let part = CachePart {
        kind: "coverage",
        key: PartsHasher::of(&[&probe.tag, COVERAGE]).finish(),
        what: "coverage.py",
    };
    cache.made(&part, |making| {
        let requirements = PipRequirements::built_in(COVERAGE, &making.scratch);
        let python = &probe.executable;
        let listen = cache.listen;
        let order = PipOrder { python, requirements: &requirements, what: part.what, afresh: false, listen };
        install(&order, making)
    })
}

/// Installs the requirements of a list.
fn packages(
    cache: &EnvironmentCache<'_>,
    probe: &ProbedInterpreter,
    requirements: &PipRequirements,
    list: Option<&Path>,
) -> Result<PathBuf, SutError> {
    let key = || PackagesKey::new(probe, requirements, &variable);
    let PackagesKey { name, has_sources } = key()?;
    let what = summary(requirements);
    let part = CachePart { kind: "packages", key: name.clone(), what: &what };
    cache.made(&part, |making: &MakingPart| {
        let (python, listen) = (&probe.executable, cache.listen);
        install(&PipOrder { python, requirements, what: &what, afresh: has_sources, listen }, making)?;
        if key()?.name == name {
            return Ok(());
        }
        let list = list.map_or_else(String::new, |list| format!(" of {}", list.display()));
        Err(SutError::Environment {
            what: format!(
                "the requirements{list}, or a folder that they name, changed while they were installed"
            ),
            detail: "start again when nothing writes there".to_owned(),
        })
    })
}

/// The first requirements, and how many more there are.
fn summary(requirements: &PipRequirements) -> String {
    let names: Vec<&str> = requirements.named().collect();
    match names[..] {
        [a, b, c, _, ..] => format!("{a}, {b}, {c} and {} more", names.len() - 3),
        _ => names.join(", "),
    }
}
