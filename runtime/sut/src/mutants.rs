//! Mutants of files of Python, listed and compiled by the SDK (`sdk/python/hrdsl/mutation`).

use std::{
    path::{Path, PathBuf},
    process::Output,
};

use serde::{Deserialize, Serialize};

use crate::environment::PythonEnv;

/// The number of the mutant that raises at once, of every file.
const SENTINEL: u32 = 0;

/// A mutant of a file, which the runner puts in its place in memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LaunchMutant {
    /// From the folder of the program.
    pub file: String,
    /// The mutant compiled, in a file that the program's cell shows
    /// ([`PythonEnv::compile_mutants`]).
    pub code: PathBuf,
}

impl LaunchMutant {
    /// As the runner reads it (`sdk/python/hrdsl/mutated.py`).
    pub(crate) fn words(&self) -> String {
        serde_json::json!({ "file": self.file, "code": self.code.to_string_lossy() }).to_string()
    }
}

/// One small change of a file of Python.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ListedMutant {
    /// As it was asked for.
    pub file: String,
    /// From 1, of all mutants of the file; 0 is the sentinel.
    pub number: u32,
    /// Where the change is, from 1.
    pub line: u32,
    /// Where the statements begin that it changes, from 1, in order.
    pub lines: Vec<u32>,
    /// What kind of change it is.
    pub operator: String,
    /// The change in words.
    pub what: String,
    /// `equivalent`, `duplicate` or `invalid` if it is not worth a run; empty if it is.
    pub needless: String,
}

impl ListedMutant {
    /// The mutant of a file that raises at once.
    #[must_use]
    pub fn sentinel(file: &str) -> Self {
        Self {
            file: file.to_owned(),
            number: SENTINEL,
            line: 1,
            lines: Vec::new(),
            operator: "sentinel".to_owned(),
            what: "the file raises at once".to_owned(),
            needless: String::new(),
        }
    }
}

/// Mutants of one file that are ready to run, until this is dropped.
#[derive(Debug)]
pub struct CompiledMutants {
    file: String,
    folder: tempfile::TempDir,
}

impl CompiledMutants {
    /// What a launch is given to run this mutant, which must be one that was compiled.
    #[must_use]
    pub fn launch(&self, number: u32) -> LaunchMutant {
        self.named(&number.to_string())
    }

    /// What a launch is given to run the file as it is, in the way of a mutant.
    #[must_use]
    pub fn launch_original(&self) -> LaunchMutant {
        self.named("original")
    }

    fn named(&self, name: &str) -> LaunchMutant {
        LaunchMutant { file: self.file.clone(), code: self.folder.path().join(format!("{name}.code")) }
    }
}

#[derive(Deserialize)]
struct MutantList {
    mutants: Vec<ListedMutant>,
}

impl PythonEnv {
    /// All mutants of these files, which lie in `dir`; or those of some operators. The list of a file is kept, since to make it takes a
    /// compilation of each mutant.
    ///
    /// # Errors
    /// What is wrong: a file that cannot be read or compiled, an operator that is none; an interpreter that cannot be started.
    pub fn list_mutants(
        &self,
        dir: &Path,
        files: &[String],
        operators: &[String],
    ) -> Result<Vec<ListedMutant>, String> {
        let mut words: Vec<PathBuf> = ["list", "--json", "--cache"].map(PathBuf::from).to_vec();
        words.push(self.mutants.clone());
        if !operators.is_empty() {
            words.push("--operator".into());
            words.extend(operators.iter().map(PathBuf::from));
        }
        words.push("--".into());
        words.extend(files.iter().map(PathBuf::from));
        let output = self.mutation(dir, &words)?;
        let read = serde_json::from_slice(&output.stdout);
        let MutantList { mutants } = read.map_err(|e| fault(&e.to_string()))?;
        Ok(mutants)
    }

    /// Compiles mutants of a file in `dir`, and its sentinel.
    ///
    /// # Errors
    /// As of [`list_mutants`](Self::list_mutants), and a number that no mutant has.
    pub fn compile_mutants(
        &self,
        dir: &Path,
        file: &str,
        numbers: &[u32],
    ) -> Result<CompiledMutants, String> {
        let folder = tempfile::Builder::new().prefix("run-").tempdir_in(&self.mutants);
        let folder = folder.map_err(|e| format!("cannot write to {}: {e}", self.mutants.display()))?;
        let mut words: Vec<PathBuf> = vec!["codes".into(), "--to".into(), folder.path().to_owned()];
        words.extend(["--".into(), PathBuf::from(file)]);
        words.extend([SENTINEL].iter().chain(numbers).map(|number| number.to_string().into()));
        self.mutation(dir, &words)?;
        Ok(CompiledMutants { file: file.to_owned(), folder })
    }

    fn mutation(&self, dir: &Path, words: &[PathBuf]) -> Result<Output, String> {
        let output = self.ask_script("mutation/__main__.py", words, dir).map_err(|e| e.to_string())?;
        if output.status.success() {
            return Ok(output);
        }
        Err(fault(String::from_utf8_lossy(&output.stderr).trim()))
    }
}

fn fault(detail: &str) -> String {
    format!("cannot make mutants: {}", detail.trim_start_matches("error: "))
}
