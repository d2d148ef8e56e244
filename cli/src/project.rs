//! The files that `hrdsl check` is given: what each of them is, and which tests belong to which scenario.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

use hrdsl_compiler::{CompilationResult, InputFile, ParsedFile, ast, compile_parsed};
use hrdsl_ir::Program;
use hrdsl_source::FileId;

use crate::{fault::CommandFault, files, reach::DiskModules, results_folder, terminal};

/// Folders that hold no scenarios of one's own.
const SKIPPED: [&str; 3] = ["target", "node_modules", "hrdsl-out"];

/// What the text of a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SourceKind {
    /// A scenario of its own.
    Scenario,
    /// Tests in the vocabulary of a scenario.
    Tests,
    /// Systems that play an actor of a scenario.
    System,
    /// Declarations that scenarios use.
    Module,
}

/// What a file is, by what it holds. A file of tests may begin with the line `scenario NAME` of its scenario; a scenario
/// without any declaration has nothing that tests could speak of.
#[must_use]
pub fn kind_of(file: &ast::FileSyntax) -> SourceKind {
    let is_test = |item: &ast::ItemSyntax| matches!(item.kind, ast::ItemSyntaxKind::Test(_));
    let is_unread = |item: &ast::ItemSyntax| matches!(item.kind, ast::ItemSyntaxKind::Error);
    let is_system = |item: &ast::ItemSyntax| matches!(item.kind, ast::ItemSyntaxKind::System(_));
    if file.items.iter().any(is_test) && file.items.iter().all(|item| is_test(item) || is_unread(item)) {
        SourceKind::Tests
    } else if file.scenario.is_some() {
        SourceKind::Scenario
    } else if file.items.iter().any(is_system)
        && file.items.iter().all(|item| is_system(item) || is_unread(item))
    {
        SourceKind::System
    } else {
        SourceKind::Module
    }
}

/// One text.
#[derive(Clone, Debug)]
pub struct ProjectSource {
    /// `None`: standard input.
    pub path: Option<PathBuf>,
    /// As it is shown.
    pub name: String,
    parsed: ParsedFile,
    pub kind: SourceKind,
    /// Given on the command line by itself, not found in a folder.
    named: bool,
    /// Where it is, without links.
    place: Option<PathBuf>,
    /// Where the files are that it uses.
    uses: Vec<PathBuf>,
}

/// What is compiled together: a scenario (or module), and the files of tests and of systems that belong to it, by index in the
/// sources.
#[derive(Clone, Debug)]
pub struct CompilationUnit {
    pub head: usize,
    pub tests: Vec<usize>,
    pub systems: Vec<usize>,
}

/// What became of a unit.
pub struct CheckedUnit {
    pub unit: CompilationUnit,
    pub compilation: CompilationResult,
}

impl CheckedUnit {
    /// The program, if there is neither an error nor a denied warning.
    #[must_use]
    pub fn program(&self) -> Option<&Program> {
        self.compilation.program.as_ref().filter(|_| !self.compilation.has_errors())
    }
}

/// All that is checked.
#[derive(Clone, Debug)]
pub struct CheckedProject {
    pub sources: Vec<ProjectSource>,
    pub units: Vec<CompilationUnit>,
}

impl CheckedProject {
    /// Finds and reads the files; `-` is standard input, and a folder stands for all `.hri` files in and below it.
    ///
    /// # Errors
    /// A file that cannot be read, a folder without scenarios, tests whose scenario is not among the files.
    pub fn open(paths: &[PathBuf]) -> Result<Self, CommandFault> {
        let mut sources = Vec::new();
        let mut seen: Vec<PathBuf> = Vec::new();
        for path in paths {
            if path.as_os_str() == "-" {
                if sources.iter().all(|s: &ProjectSource| s.path.is_some()) {
                    sources.push(ProjectSource::new(None, files::read_stdin()?, true));
                }
                continue;
            }
            let folder = path.is_dir();
            let files = if folder { walk(path)? } else { vec![path.clone()] };
            if files.is_empty() {
                return Err(format!("no .hri file in {} or the folders in it", terminal::shown(path)));
            }
            for file in files {
                let text = files::read_scenario(&file)?;
                let place = file.canonicalize().unwrap_or_else(|_| file.clone());
                match seen.iter().position(|s| *s == place) {
                    Some(_) if folder => {}
                    Some(_) => sources.iter_mut().filter(|s| s.is_at(&place)).for_each(|s| s.named = true),
                    None => {
                        seen.push(place);
                        sources.push(ProjectSource::new(Some(file), text, !folder));
                    }
                }
            }
        }
        let units = units(&sources)?;
        Ok(Self { sources, units })
    }

    /// Compiles one unit.
    #[must_use]
    pub fn compile(&self, unit: &CompilationUnit) -> CompilationResult {
        let input = |i: usize| InputFile { name: &self.sources[i].name, text: self.sources[i].text() };
        let tests: Vec<InputFile<'_>> = unit.tests.iter().map(|i| input(*i)).collect();
        let head = self.sources[unit.head].path.as_deref();
        let folder = head.map_or(PathBuf::from("."), files::folder);
        let system = |i: &usize| {
            let path = self.sources[*i].path.as_ref()?;
            Some(files::relative(path, &folder).display().to_string())
        };
        let systems: Vec<String> = unit.systems.iter().filter_map(system).collect();
        let systems: Vec<&str> = systems.iter().map(String::as_str).collect();
        let ProjectSource { name, parsed, .. } = &self.sources[unit.head];
        compile_parsed(name, parsed.clone(), &tests, &systems, &DiskModules::of(head))
    }

    /// The source that is this file of a compilation; `None` for the modules that come with hrdsl.
    #[must_use]
    pub fn source(&self, compilation: &CompilationResult, file: FileId) -> Option<usize> {
        let name = &compilation.files.get(file)?.name;
        self.sources.iter().position(|s| s.name == *name)
    }
}

impl ProjectSource {
    fn new(path: Option<PathBuf>, text: String, named: bool) -> Self {
        let name = path.as_ref().map_or("<stdin>".to_owned(), |p| p.display().to_string());
        let parsed = ParsedFile::of(text);
        let syntax = parsed.syntax();
        let said = kind_of(syntax);
        // Without a place a system cannot be seen from a scenario's folder.
        let is_lost = path.is_none() && matches!(said, SourceKind::System);
        let kind = if is_lost { SourceKind::Module } else { said };
        let uses = used_files(syntax, &path.as_ref().map_or(PathBuf::from("."), |p| files::folder(p)));
        let place = path.as_ref().and_then(|p| p.canonicalize().ok());
        Self { path, name, parsed, kind, named, place, uses }
    }

    #[must_use]
    pub fn text(&self) -> &str {
        self.parsed.text()
    }

    /// Puts another text in place of this one.
    pub fn rewrite(&mut self, text: String) {
        self.parsed = ParsedFile::of(text);
    }

    fn is_at(&self, place: &Path) -> bool {
        self.place.as_deref() == Some(place)
    }

    /// The folder that it is in, whole; of standard input the present one.
    fn folder(&self) -> PathBuf {
        let folder = self.path.as_ref().map_or(PathBuf::from("."), |p| files::folder(p));
        folder.canonicalize().unwrap_or(folder)
    }

    fn is_called(&self, name: &str) -> bool {
        self.path.as_ref().and_then(|p| p.file_name()).is_some_and(|n| n == name)
    }
}

/// All `.hri` files in and below a folder, in order. Hidden folders, build folders and links to folders are left out.
pub fn walk(root: &Path) -> Result<Vec<PathBuf>, CommandFault> {
    let mut files = Vec::new();
    let mut folders = vec![root.to_owned()];
    let mut written = BTreeSet::new();
    while let Some(folder) = folders.pop() {
        // What hrdsl wrote itself is looked at only if its folder is named; what somebody else put beside it, always.
        if folder != root {
            written.extend(results_folder::written(&folder));
        }
        let fault = |e: std::io::Error| format!("cannot read {}: {e}", terminal::shown(&folder));
        for entry in fs::read_dir(&folder).map_err(fault)? {
            let entry = entry.map_err(fault)?;
            let (name, path) = (entry.file_name(), entry.path());
            let name = name.to_string_lossy();
            if entry.file_type().map_err(fault)?.is_dir() {
                if !name.starts_with('.') && !SKIPPED.contains(&&*name) {
                    folders.push(path);
                }
            } else if path.extension().is_some_and(|e| e == "hri")
                && path.is_file()
                && !written.contains(&path)
            {
                files.push(path.strip_prefix(".").map(Path::to_owned).unwrap_or(path));
            }
        }
    }
    files.sort();
    Ok(files)
}

fn used_files(file: &ast::FileSyntax, folder: &Path) -> Vec<PathBuf> {
    let used = file.items.iter().filter_map(|item| {
        if let ast::ItemSyntaxKind::Use(ast::ModuleSyntax::File(path)) = &item.kind {
            Some(folder.join(&path.text))
        } else {
            None
        }
    });
    used.filter_map(|path| path.canonicalize().ok()).collect()
}

/// The places of all files that scenarios use, and those use in turn. They are checked with the scenario, whose names they may
/// speak of.
fn parts_of_scenarios(sources: &[ProjectSource]) -> BTreeSet<&Path> {
    let scenarios = sources.iter().filter(|s| s.kind == SourceKind::Scenario);
    let mut waiting: Vec<&Path> = scenarios.flat_map(|s| &s.uses).map(PathBuf::as_path).collect();
    let mut parts = BTreeSet::new();
    while let Some(place) = waiting.pop() {
        if parts.insert(place) {
            waiting.extend(
                sources.iter().filter(|s| s.is_at(place)).flat_map(|s| &s.uses).map(PathBuf::as_path),
            );
        }
    }
    parts
}

fn units(sources: &[ProjectSource]) -> Result<Vec<CompilationUnit>, CommandFault> {
    let parts = parts_of_scenarios(sources);
    let has_owner = |s: &ProjectSource| matches!(s.kind, SourceKind::Tests | SourceKind::System);
    let is_part = |s: &ProjectSource| {
        s.kind == SourceKind::Module && !s.named && s.place.as_deref().is_some_and(|p| parts.contains(p))
    };
    let head = |(i, s): (usize, &ProjectSource)| {
        (!has_owner(s) && !is_part(s)).then(|| CompilationUnit {
            head: i,
            tests: Vec::new(),
            systems: Vec::new(),
        })
    };
    let mut units: Vec<CompilationUnit> = sources.iter().enumerate().filter_map(head).collect();
    let scenarios: Vec<(usize, PathBuf)> = sources
        .iter()
        .enumerate()
        .filter(|(_, s)| s.kind == SourceKind::Scenario)
        .map(|(i, s)| (i, s.folder()))
        .collect();
    for (i, source) in sources.iter().enumerate().filter(|(_, s)| has_owner(s)) {
        let owner = owner(source, sources, &scenarios)?;
        for unit in units.iter_mut().filter(|u| u.head == owner) {
            match source.kind {
                SourceKind::System => unit.systems.push(i),
                SourceKind::Tests | SourceKind::Scenario | SourceKind::Module => unit.tests.push(i),
            }
        }
    }
    Ok(units)
}

/// The scenario that tests or systems belong to: the only one that was named, otherwise the nearest in the folders above.
fn owner(
    file: &ProjectSource,
    sources: &[ProjectSource],
    scenarios: &[(usize, PathBuf)],
) -> Result<usize, CommandFault> {
    let named: Vec<usize> = scenarios.iter().map(|s| s.0).filter(|i| sources[*i].named).collect();
    if let [only] = named[..] {
        return Ok(only);
    }
    let holds = if file.kind == SourceKind::System { "a system" } else { "tests" };
    let own = file.folder();
    for folder in own.ancestors() {
        let here: Vec<usize> = scenarios.iter().filter(|(_, f)| f == folder).map(|(i, _)| *i).collect();
        match (here[..].iter().find(|i| sources[**i].is_called("scenario.hri")), &here[..]) {
            (Some(scenario), _) | (None, [scenario]) => return Ok(*scenario),
            (None, []) => {}
            (None, several) => {
                let names: Vec<&str> = several.iter().map(|i| sources[*i].name.as_str()).collect();
                return Err(format!(
                    "{} holds {holds}, and it is not clear of which scenario: {}; name the scenario, as in `hrdsl check {} {}`",
                    file.name,
                    names.join(", "),
                    names[0],
                    file.name
                ));
            }
        }
    }
    let whose = if file.kind == SourceKind::System { "its" } else { "their" };
    Err(format!(
        "{} holds {holds}, and {whose} scenario is not among the files; name it, as in `hrdsl check scenario.hri {}`",
        file.name, file.name
    ))
}
