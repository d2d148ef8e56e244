//! The robot's code on a page: read from the scenario's folder, and compared with what ran.

use std::{
    collections::BTreeMap,
    path::{Component, Path, PathBuf},
};

use hrdsl_runtime::{
    recording::checksum,
    viewer::{SharedAssets, ViewDocument, document::ViewSourceFile, replay::WrittenUnits},
};
use hrdsl_source::SourceFiles;

use crate::files;

/// A longer file of code is not put on a page, in bytes.
const LONGEST: usize = 1 << 20;

/// The files of code that runs of a page name, each read once.
pub struct CodeSources {
    folder: PathBuf,
    /// The text of each with its checksum, or why there is none.
    texts: BTreeMap<String, Result<(String, u32), String>>,
    /// In which units the scenario writes its limits.
    units: WrittenUnits,
}

impl CodeSources {
    /// Those of the scenario in this file.
    pub fn beside(scenario: &Path) -> Self {
        let folder = scenario.parent().filter(|folder| !folder.as_os_str().is_empty());
        Self::within(folder.unwrap_or(Path::new(".")))
    }

    /// Those in a folder.
    pub fn within(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), texts: BTreeMap::new(), units: WrittenUnits::default() }
    }

    /// The same, with the units in which the texts of the scenario are written.
    #[must_use]
    pub fn written_as(mut self, texts: &SourceFiles) -> Self {
        self.units = WrittenUnits::of(texts.iter().map(|(_, file)| &*file.text));
        self
    }

    /// In which units the scenario writes its limits.
    pub fn units(&self) -> &WrittenUnits {
        &self.units
    }

    /// Reads the files that a run names, and notes in its document which are not there, or are others by now.
    pub fn take(&mut self, document: &mut ViewDocument) {
        for ViewSourceFile { name, crc, .. } in &document.files {
            let folder = &self.folder;
            let read = self.texts.entry(name.clone()).or_insert_with(|| read(folder, name));
            match read {
                Ok((_, now)) if crc.is_some_and(|then| then != *now) => document
                    .notes
                    .push(format!("The code in {name} has changed since: it is shown as it is now.")),
                Ok(_) => {}
                Err(why) => document.notes.push(format!("The code in {name} cannot be shown: {why}.")),
            }
        }
    }

    /// Puts those that the runs of a page name among what they share.
    pub fn put<'d>(&self, assets: &mut SharedAssets, runs: impl IntoIterator<Item = &'d ViewDocument>) {
        for file in runs.into_iter().flat_map(|run| &run.files) {
            if let Some(Ok((text, _))) = self.texts.get(&file.name) {
                assets.files.insert(file.name.clone(), text.clone());
            }
        }
    }
}

/// A recording comes from anywhere: what it names is read only below the scenario's folder.
fn read(folder: &Path, name: &str) -> Result<(String, u32), String> {
    let path = Path::new(name);
    let is_below = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    let is_inside = || {
        let (folder, file) = (folder.canonicalize().ok()?, folder.join(path).canonicalize().ok()?);
        Some(file.starts_with(folder))
    };
    if !is_below || is_inside() == Some(false) {
        return Err("it is not in the scenario's folder".to_owned());
    }
    let text = files::read(&folder.join(path))?;
    if text.len() > LONGEST {
        return Err(format!("it has more than {} MB", LONGEST >> 20));
    }
    let sum = checksum(text.as_bytes());
    Ok((text, sum))
}
