//! What the tests share: folders of this machine, and files that stand in the test.

#![allow(clippy::disallowed_methods, reason = "the tests read their fixtures")]
#![allow(dead_code, reason = "each test uses a part of it")]

use std::{collections::BTreeMap, fs, path::Path};

use hrdsl_robots::{PackageTable, RobotEntry, RobotReader, RobotReading, RobotRequest, read_robot};
use hrdsl_source::{SourceFiles, Span};

/// A folder of this machine: paths are taken from it.
pub struct RobotFolder<'a>(pub &'a Path);

impl RobotReader for RobotFolder<'_> {
    fn bytes(&self, file: &str) -> Result<Vec<u8>, String> {
        fs::read(self.0.join(file)).map_err(|error| error.to_string())
    }

    fn entries(&self, folder: &str) -> Result<Vec<RobotEntry>, String> {
        let entries = fs::read_dir(self.0.join(folder)).map_err(|_| "there is no such folder".to_owned())?;
        let entry = |e: fs::DirEntry| RobotEntry {
            name: e.file_name().to_string_lossy().into_owned(),
            is_folder: e.path().is_dir(),
        };
        Ok(entries.flatten().map(entry).collect())
    }

    fn is_file(&self, file: &str) -> bool {
        self.0.join(file).is_file()
    }
}

/// Files by their paths.
#[derive(Clone, Debug, Default)]
pub struct FilesInMemory(pub BTreeMap<String, Vec<u8>>);

impl FilesInMemory {
    pub fn with(mut self, path: &str, bytes: impl Into<Vec<u8>>) -> Self {
        self.0.insert(path.to_owned(), bytes.into());
        self
    }
}

impl RobotReader for FilesInMemory {
    fn bytes(&self, file: &str) -> Result<Vec<u8>, String> {
        self.0.get(file).cloned().ok_or_else(|| "there is no such file".to_owned())
    }

    fn entries(&self, folder: &str) -> Result<Vec<RobotEntry>, String> {
        let inside: Vec<&str> =
            self.0.keys().filter_map(|path| path.strip_prefix(folder)?.strip_prefix('/')).collect();
        let entry = |rest: &&str| RobotEntry {
            name: rest.split('/').next().unwrap_or_default().to_owned(),
            is_folder: rest.contains('/'),
        };
        let mut entries: Vec<RobotEntry> = inside.iter().map(entry).collect();
        entries.dedup();
        if entries.is_empty() { Err("there is no such folder".to_owned()) } else { Ok(entries) }
    }
}

/// Reads `r.urdf` of these files, with all that is given.
pub fn read(
    reader: &dyn RobotReader,
    path: &str,
    arguments: &[(&str, &str)],
    packages: &PackageTable,
    files: &mut SourceFiles,
) -> RobotReading {
    let place = Span::new(files.add("scenario", ""), 0, 0);
    let arguments: Vec<(String, String)> =
        arguments.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect();
    let request = RobotRequest { arguments: &arguments, ..RobotRequest::new(path, place, packages) };
    read_robot(&request, files, reader)
}

/// What is wrong, a line each: `file:line:column word: message (help: …)`.
pub fn told(files: &SourceFiles, reading: &RobotReading) -> Vec<String> {
    let line = |fault: &hrdsl_robots::RobotFault| {
        let place = files.place(fault.place.span);
        format!("{place} {}: {} (help: {})", fault.kind.word(), fault.kind, fault.help)
    };
    reading.faults.iter().map(line).collect()
}
