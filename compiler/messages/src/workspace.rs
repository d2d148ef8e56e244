//! The packages of a workspace: where they are, and their definitions.
//!
//! A folder with a `package.xml` is a package, and nothing below it is another. A workspace with a folder `src` keeps its packages
//! there; what lies beside it is built from them. Any other folder is searched as it is: one of packages, or an installed `share`.

use std::collections::BTreeMap;

use hrdsl_source::{FileId, SourceFiles, Span};

use crate::{
    fault::{MessageFault, MessageFaultKind},
    limits::{MOST_FILES, MOST_FOLDER_DEPTH, MOST_FOLDERS},
    manifest::package_name,
    name::{InterfaceSpace, RosVersion},
    parse::{DefinitionText, parse_definition},
    standard::{ReadDefinition, space_and_name},
};

/// Files that say that nothing below their folder is of the workspace.
const IGNORED: [&str; 3] = ["COLCON_IGNORE", "CATKIN_IGNORE", "AMENT_IGNORE"];
const MANIFEST: &str = "package.xml";

/// Reads the folders of a workspace; nothing else here touches files. Paths are joined by `/`.
pub trait WorkspaceReader {
    /// What a folder holds, in any order. Links are followed.
    ///
    /// # Errors
    /// Why it cannot be read, as the end of a sentence: "there is no such folder".
    fn entries(&self, folder: &str) -> Result<Vec<WorkspaceEntry>, String>;

    /// Where a folder is, as programs find it that run elsewhere.
    fn place(&self, folder: &str) -> String {
        folder.to_owned()
    }

    /// The text of a file. More than [`MOST_BYTES`](crate::limits::MOST_BYTES) need not be read.
    ///
    /// # Errors
    /// The same.
    fn text(&self, file: &str) -> Result<String, String>;
}

/// A file or a folder.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct WorkspaceEntry {
    pub name: String,
    pub is_folder: bool,
}

/// What a workspace holds.
pub(crate) struct ReadWorkspace {
    /// Packages with definitions.
    pub packages: BTreeMap<String, Vec<ReadDefinition>>,
    /// Where all packages are that have a name, those without definitions among them.
    pub folders: BTreeMap<String, String>,
    /// What is wrong with it.
    pub faults: Vec<MessageFault>,
}

/// Reads the packages below a folder.
pub(crate) fn read_workspace(
    version: RosVersion,
    files: &mut SourceFiles,
    reader: &dyn WorkspaceReader,
    path: &str,
    place: Span,
) -> ReadWorkspace {
    let search = WorkspaceSearch {
        version,
        files,
        reader,
        place,
        folders: 0,
        texts: 0,
        packages: BTreeMap::new(),
        places: BTreeMap::new(),
        faults: Vec::new(),
    };
    search.read(path)
}

struct FoundPackage {
    definitions: Vec<ReadDefinition>,
    /// The name in its `package.xml`, and the folder.
    span: Span,
    folder: String,
}

struct WorkspaceSearch<'a> {
    version: RosVersion,
    files: &'a mut SourceFiles,
    reader: &'a dyn WorkspaceReader,
    place: Span,
    /// How many folders and files were looked at.
    folders: usize,
    texts: usize,
    packages: BTreeMap<String, FoundPackage>,
    places: BTreeMap<String, String>,
    faults: Vec<MessageFault>,
}

impl WorkspaceSearch<'_> {
    fn read(mut self, path: &str) -> ReadWorkspace {
        let path = path.trim_end_matches('/');
        let source = format!("{path}/src");
        match self.entries(path) {
            Some(entries) if !has(&entries, MANIFEST, false) && has(&entries, "src", true) => {
                self.search(source, 1);
            }
            Some(_) => self.search(path.to_owned(), 0),
            None => {}
        }
        if self.places.is_empty() && self.packages.is_empty() && self.faults.is_empty() {
            let help = "name the folder of a catkin or colcon workspace, or one that holds packages";
            self.faults.push(MessageFaultKind::EmptyWorkspace(path.to_owned()).at(self.place, help));
        }
        let packages = self.packages.into_iter().map(|(name, found)| (name, found.definitions)).collect();
        ReadWorkspace { packages, folders: self.places, faults: self.faults }
    }

    /// Looks for packages in a folder and those below it, in the order of their names.
    fn search(&mut self, folder: String, depth: usize) {
        let mut waiting = vec![(folder, depth)];
        while let Some((folder, depth)) = waiting.pop() {
            let Some(entries) = self.entries(&folder) else { continue };
            if IGNORED.iter().any(|mark| has(&entries, mark, false)) {
                continue;
            }
            if has(&entries, MANIFEST, false) {
                self.package(&folder, &entries);
                continue;
            }
            let below = entries.iter().filter(|e| e.is_folder && !e.name.starts_with('.'));
            if depth >= MOST_FOLDER_DEPTH {
                if below.count() > 0 {
                    self.too_much("folders within folders", MOST_FOLDER_DEPTH);
                }
                continue;
            }
            let below = below.map(|e| (format!("{folder}/{}", e.name), depth + 1));
            // The last is taken first.
            waiting.extend(below.rev());
        }
    }

    fn package(&mut self, folder: &str, entries: &[WorkspaceEntry]) {
        let mut definitions = Vec::new();
        for space in InterfaceSpace::ALL.into_iter().filter(|space| has(entries, space.folder(), true)) {
            let inside = self.entries(&format!("{folder}/{}", space.folder())).unwrap_or_default();
            let paths =
                inside.into_iter().filter(|e| !e.is_folder).map(|e| format!("{}/{}", space.folder(), e.name));
            definitions.extend(paths.filter(|path| space_and_name(path).is_some()));
        }
        if definitions.is_empty() {
            self.without_definitions(folder);
            return;
        }
        let Some((file, text)) = self.file(&format!("{folder}/{MANIFEST}")) else { return };
        let (name, span) = match package_name(self.version, file, &text) {
            Ok(found) => found,
            Err(fault) => return self.faults.push(fault),
        };
        if let Some(first) = self.packages.get(&name) {
            let help = format!(
                "remove one, or put a file `COLCON_IGNORE` into its folder; that in {} is read",
                first.folder
            );
            let kind = MessageFaultKind::DuplicatePackage(name);
            return self.faults.push(kind.at(span, help).repeats(first.span));
        }
        let definitions =
            definitions.iter().filter_map(|path| self.definition(&name, folder, path)).collect();
        self.places.entry(name.clone()).or_insert_with(|| self.reader.place(folder));
        self.packages.insert(name, FoundPackage { definitions, span, folder: folder.to_owned() });
    }

    /// Of a package of programs alone only the place matters; what is wrong with it is nobody's business here.
    fn without_definitions(&mut self, folder: &str) {
        self.texts += 1;
        if self.texts > MOST_FILES {
            return self.too_much("files of a workspace", MOST_FILES);
        }
        let Ok(text) = self.reader.text(&format!("{folder}/{MANIFEST}")) else { return };
        if let Ok((name, _)) = package_name(self.version, FileId(0), &text) {
            self.places.entry(name).or_insert_with(|| self.reader.place(folder));
        }
    }

    /// A definition, by its path in the package.
    fn definition(&mut self, package: &str, folder: &str, path: &str) -> Option<ReadDefinition> {
        let (space, name) = space_and_name(path)?;
        let (file, text) = self.file(&format!("{folder}/{path}"))?;
        let source = DefinitionText { version: self.version, package, name, file, start: 0, text: &text };
        Some(parse_definition(source, space))
    }

    /// What a folder holds, sorted; `None`, and a fault, if it cannot be read.
    fn entries(&mut self, folder: &str) -> Option<Vec<WorkspaceEntry>> {
        self.folders += 1;
        if self.folders > MOST_FOLDERS {
            self.too_much("folders of a workspace", MOST_FOLDERS);
            return None;
        }
        let entries = self.reader.entries(folder).map(|mut entries| {
            entries.sort();
            entries
        });
        self.readable(folder, entries)
    }

    fn file(&mut self, path: &str) -> Option<(FileId, String)> {
        self.texts += 1;
        if self.texts > MOST_FILES {
            self.too_much("files of a workspace", MOST_FILES);
            return None;
        }
        let text = self.reader.text(path);
        let text = self.readable(path, text)?;
        Some((self.files.add(path, text.as_str()), text))
    }

    fn readable<T>(&mut self, path: &str, read: Result<T, String>) -> Option<T> {
        let say = |reason| {
            let kind = MessageFaultKind::Unreadable { path: path.to_owned(), reason };
            self.faults.push(kind.at(self.place, "name a folder that can be read"));
        };
        read.map_err(say).ok()
    }

    /// Said once of each limit.
    fn too_much(&mut self, what: &'static str, limit: usize) {
        let kind = MessageFaultKind::TooMuch { what, limit: limit as u64 };
        if !self.faults.iter().any(|fault| fault.kind == kind) {
            self.faults.push(
                kind.at(self.place, "name a folder that holds less: the one with the packages themselves"),
            );
        }
    }
}

fn has(entries: &[WorkspaceEntry], name: &str, is_folder: bool) -> bool {
    entries.iter().any(|e| e.is_folder == is_folder && e.name == name)
}
