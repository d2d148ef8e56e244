//! What an installation depends on, as far as it can be known without asking an index.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use super::{
    digest::PartsHasher,
    named::{self, LocalKind, LocalRequirement},
    probe::ProbedInterpreter,
    requirements::{EnvVarLookup, PipRequirements, RequirementLine},
};
use crate::error::SutError;

/// A name for all that an installation depends on.
pub(super) struct PackagesKey {
    pub name: String,
    /// Whether archives of sources are among it: what pip built of one it keeps under its file's name, whatever is
    /// in the file by now.
    pub has_sources: bool,
}

impl PackagesKey {
    pub(super) fn new(
        probe: &ProbedInterpreter,
        requirements: &PipRequirements,
        variables: EnvVarLookup<'_>,
    ) -> Result<Self, SutError> {
        let mut maker =
            KeyMaker { print: PartsHasher::of(&[&probe.tag, &probe.base]), has_sources: false, variables };
        maker.requirements(requirements)?;
        for (section, name, value) in &probe.pip {
            maker.option(section, name, value, &requirements.folder)?;
        }
        Ok(Self { name: maker.print.finish(), has_sources: maker.has_sources })
    }
}

struct KeyMaker<'a> {
    print: PartsHasher,
    has_sources: bool,
    variables: EnvVarLookup<'a>,
}

impl KeyMaker<'_> {
    fn requirements(&mut self, requirements: &PipRequirements) -> Result<(), SutError> {
        for lines in [&requirements.lines, &requirements.constraints] {
            self.print.part(&(lines.len() as u64).to_le_bytes());
            lines.iter().try_for_each(|line| self.line(line))?;
        }
        Ok(())
    }

    fn line(&mut self, line: &RequirementLine) -> Result<(), SutError> {
        let Some(local) = &line.local else {
            self.print.part(line.expanded.as_bytes());
            return Ok(());
        };
        // Not the path: the same contents elsewhere are the same.
        local.around().iter().for_each(|text| self.print.part(text.as_bytes()));
        self.has_sources |= local.is_archive_of_sources();
        self.local(local).map_err(|e| line.origin.error(e, "pip could not read it either"))
    }

    fn local(&mut self, local: &LocalRequirement) -> Result<(), SutError> {
        match local.kind {
            LocalKind::Folder => {
                self.print.part(b"folder");
                self.print.folder(&local.path)
            }
            LocalKind::File => {
                self.print.part(local.path.file_name().unwrap_or_default().as_encoded_bytes());
                self.print.file(&local.path)
            }
            LocalKind::Links => self.links(&local.path),
            LocalKind::Repository => self.repository(&local.path),
        }
    }

    /// A page, or the files of a folder.
    fn links(&mut self, path: &Path) -> Result<(), SutError> {
        if path.is_file() {
            return self.print.file(path);
        }
        for file in files_of(path).map_err(SutError::io(format!("cannot read {}", path.display())))? {
            self.has_sources |= named::is_archive_of_sources(&file);
            self.print.part(file.file_name().unwrap_or_default().as_encoded_bytes());
            self.print.file(&file)?;
        }
        self.print.part(b"end");
        Ok(())
    }

    /// Where its branches and tags are.
    fn repository(&mut self, path: &Path) -> Result<(), SutError> {
        self.print.part(path.as_os_str().as_encoded_bytes());
        let inner = path.join(".git");
        let folder = if inner.is_dir() { inner } else { path.to_owned() };
        for file in ["HEAD", "packed-refs"].map(|name| folder.join(name)) {
            if file.is_file() {
                self.print.file(&file)?;
            }
        }
        if folder.join("refs").is_dir() {
            self.print.folder(&folder.join("refs"))?;
        }
        Ok(())
    }

    /// An option of pip's configuration; pip splits those that may be given several times at blanks.
    fn option(&mut self, section: &str, name: &str, value: &str, folder: &Path) -> Result<(), SutError> {
        [section, name, value].iter().for_each(|text| self.print.part(text.as_bytes()));
        let paths = value.split_whitespace().filter_map(named::path_of).map(|path| folder.join(path));
        for path in paths.filter(|path| path.exists()) {
            match name {
                "find-links" => self.links(&path)?,
                "constraint" => {
                    let found = PipRequirements::read_constraints(&path, folder, self.variables)?;
                    self.requirements(&found)?;
                }
                "requirement" => self.requirements(&PipRequirements::read(&path, self.variables)?)?,
                _ => {}
            }
        }
        Ok(())
    }
}

fn files_of(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        files.push(entry?.path());
    }
    files.retain(|path| path.is_file());
    files.sort();
    Ok(files)
}
