//! Packages: which folder `package://NAME` and `$(find NAME)` stand for.

use std::collections::BTreeMap;

use hrdsl_source::{FileId, SourceFiles, nearest};

use super::{
    path::{folder_of, joined},
    reader::{RobotEntry, RobotReader, path_beside, read_text, whole_path},
};
use crate::{
    fault::{RobotFault, RobotFaultKind, RobotPlace, say},
    limits::{MOST_FOLDER_DEPTH, MOST_FOLDERS},
    xml::read_xml,
};

/// Files that say that nothing below their folder is of the workspace.
const IGNORED: [&str; 3] = ["COLCON_IGNORE", "CATKIN_IGNORE", "AMENT_IGNORE"];
const MANIFEST: &str = "package.xml";

/// The folders of packages, by their names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PackageTable {
    folders: BTreeMap<String, String>,
}

impl PackageTable {
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a package by its name and folder; an earlier one of this name gives way.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, folder: impl Into<String>) -> Self {
        self.folders.insert(name.into(), folder.into());
        self
    }

    /// Adds the packages below a folder: a workspace, a folder of packages, or an installed `share`, in which each has its
    /// `package.xml`, too. Those that the table has already stay. `place` is where the folder is named.
    pub fn search(
        &mut self,
        reader: &dyn RobotReader,
        files: &mut SourceFiles,
        folder: &str,
        place: RobotPlace,
    ) -> Vec<RobotFault> {
        let mut search =
            PackageSearch { reader, files, place, folders: 0, faults: Vec::new(), found: BTreeMap::new() };
        search.read(folder.trim_end_matches('/'));
        let PackageSearch { found, faults, .. } = search;
        for (name, folder) in found {
            self.folders.entry(name).or_insert(folder);
        }
        faults
    }

    /// Where the package of this name is.
    #[must_use]
    pub fn folder(&self, name: &str) -> Option<&str> {
        self.folders.get(name).map(String::as_str)
    }

    /// All of them, in the order of their names.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.folders.iter().map(|(name, folder)| (name.as_str(), folder.as_str()))
    }

    /// The folder of a package that a file names: that of the table; or else a folder above the file that is called so, by its
    /// `package.xml` or its own name, or that has one of that name in it: descriptions are often handed on without their workspace.
    pub(crate) fn found_from(&self, name: &str, file: &str, reader: &dyn RobotReader) -> Option<String> {
        if let Some(folder) = self.folder(name) {
            return Some(folder.to_owned());
        }
        if name.is_empty() || name == ".." {
            return None;
        }
        let whole = whole_path(reader, folder_of(file));
        let mut above = whole.as_str();
        let found = loop {
            if above.rsplit('/').next() == Some(name) || is_package(name, above, reader) {
                break above.to_owned();
            }
            let inside = joined(above, name);
            if reader.entries(&inside).is_ok() {
                break inside;
            }
            if above.is_empty() || above == "/" {
                return None;
            }
            above = folder_of(above);
        };
        Some(path_beside(reader, "", &found))
    }

    /// That there is no such package, with the nearest name.
    pub(crate) fn unknown(&self, name: &str, place: RobotPlace) -> RobotFault {
        let near = nearest(name, self.folders.keys().map(String::as_str));
        let help = match near {
            Some(near) => format!("write `{near}`, or name the workspace that has `{name}`"),
            None => format!("name the workspace that has `{name}`: a folder with its `package.xml`"),
        };
        RobotFaultKind::UnknownPackage(name.to_owned()).at(place, help)
    }
}

struct PackageSearch<'a> {
    reader: &'a dyn RobotReader,
    files: &'a mut SourceFiles,
    place: RobotPlace,
    folders: usize,
    found: BTreeMap<String, String>,
    faults: Vec<RobotFault>,
}

impl PackageSearch<'_> {
    fn read(&mut self, folder: &str) {
        let mut waiting = vec![(folder.to_owned(), 0)];
        while let Some((folder, depth)) = waiting.pop() {
            self.folders += 1;
            if self.folders > MOST_FOLDERS {
                let kind = RobotFaultKind::TooMuch { what: "folders of a workspace", limit: MOST_FOLDERS };
                return say(&mut self.faults, kind.at(self.place, "name a folder that holds less"));
            }
            let mut entries = match self.reader.entries(&folder) {
                Ok(entries) => entries,
                Err(reason) => {
                    let kind = RobotFaultKind::Unreadable { path: folder, reason };
                    say(&mut self.faults, kind.at(self.place, "name a folder that can be read"));
                    continue;
                }
            };
            entries.sort();
            if IGNORED.iter().any(|mark| has_file(&entries, mark)) {
                continue;
            }
            if has_file(&entries, MANIFEST) {
                self.package(&folder);
                continue;
            }
            if depth >= MOST_FOLDER_DEPTH {
                continue;
            }
            // The last is taken first.
            let below = entries.iter().rev().filter(|e| e.is_folder && !e.name.starts_with('.'));
            waiting.extend(below.map(|e| (format!("{folder}/{}", e.name), depth + 1)));
        }
    }

    fn package(&mut self, folder: &str) {
        match self.name_of(folder) {
            Ok((name, place)) => match self.found.get(&name) {
                Some(first) => {
                    let help = format!("remove one; that in {first} is read");
                    let kind = RobotFaultKind::DuplicatePackage(name);
                    say(&mut self.faults, kind.warned(place, help));
                }
                None => drop(self.found.insert(name, folder.to_owned())),
            },
            Err(fault) => say(&mut self.faults, fault),
        }
    }

    fn name_of(&mut self, folder: &str) -> Result<(String, RobotPlace), RobotFault> {
        let (file, text) = read_text(self.reader, self.files, &format!("{folder}/{MANIFEST}"), self.place)?;
        let root = read_xml(file, &text)?;
        let named = root.elements().find(|child| child.name == "name").filter(|_| root.name == "package");
        let name = named.map(|child| (child.text().trim().to_owned(), child.place));
        name.filter(|(name, _)| !name.is_empty()).ok_or_else(|| {
            let help = "write `<package><name>my_robot</name>…</package>`";
            RobotFaultKind::MalformedManifest.at(root.place, help)
        })
    }
}

/// Whether a folder's manifest gives it this name. One that cannot be read gives it none.
fn is_package(name: &str, folder: &str, reader: &dyn RobotReader) -> bool {
    let manifest = joined(folder, MANIFEST);
    let text = reader.bytes(&manifest).ok().and_then(|bytes| String::from_utf8(bytes).ok());
    let root = text.and_then(|text| read_xml(FileId::default(), &text).ok());
    root.is_some_and(|root| root.elements().any(|child| child.name == "name" && child.text().trim() == name))
}

fn has_file(entries: &[RobotEntry], name: &str) -> bool {
    entries.iter().any(|e| !e.is_folder && e.name == name)
}
