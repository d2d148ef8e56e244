//! Files and streams: reading text, writing it, and compiling one scenario.

use std::{
    collections::BTreeMap,
    fs,
    io::{Read, Write},
    path::{Path, PathBuf},
};

use hrdsl_compiler::{Compilation, Input, Loader, Source, ast, compile_with};
use hrdsl_ir::Program;
use hrdsl_source::{Diagnostic, FileId, Files, printable_line};

pub use crate::terminal::{print, print_data};
use crate::{reach::Reach, render, terminal};

/// A failure that is no diagnostic: a file, an argument.
pub type Fault = String;

/// What the text of a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A scenario of its own.
    Scenario,
    /// Tests in the vocabulary of a scenario.
    Tests,
    /// Declarations that scenarios use.
    Module,
}

/// What a file is, by what it holds. A file of tests may begin with the line `scenario NAME` of its scenario; a scenario
/// without any declaration has nothing that tests could speak of.
#[must_use]
pub fn kind_of(file: &ast::File) -> Kind {
    let is_test = |item: &ast::Item| matches!(item.kind, ast::ItemKind::Test(_));
    let is_unread = |item: &ast::Item| matches!(item.kind, ast::ItemKind::Error);
    if file.items.iter().any(is_test) && file.items.iter().all(|item| is_test(item) || is_unread(item)) {
        Kind::Tests
    } else if file.scenario.is_some() {
        Kind::Scenario
    } else {
        Kind::Module
    }
}

/// Reads a text file.
///
/// # Errors
/// The file's name and what is wrong with it.
pub fn read(path: &Path) -> Result<String, Fault> {
    let fault = |e: std::io::Error| match e.kind() {
        std::io::ErrorKind::NotFound => format!("no such file: {}", terminal::shown(path)),
        _ => format!("cannot read {}: {e}", terminal::shown(path)),
    };
    let mut bytes = Vec::new();
    // One byte more than the compiler takes, so that it says that the file is too large; what never ends is not read on.
    fs::File::open(path)
        .and_then(|file| file.take(hrdsl_compiler::MAX_BYTES as u64 + 1).read_to_end(&mut bytes))
        .map_err(fault)?;
    text(bytes, &terminal::shown(path))
}

/// The files that `use "…"` names, relative to the file that uses them.
pub struct Disk {
    reach: Reach,
    /// That of the file; `None`: standard input has none.
    folder: Option<PathBuf>,
}

impl Disk {
    /// For a file that was named on the command line, or for standard input.
    #[must_use]
    pub fn of(file: Option<&Path>) -> Self {
        let folder = file.and_then(Path::parent).map(Path::to_path_buf);
        Self { reach: Reach::of(file, &["hri"]), folder }
    }
}

impl Loader for Disk {
    fn load(&self, from: &str, path: &str) -> Result<Source, String> {
        let (file, text) = self.reach.read(from, path)?;
        Ok(Source { name: file.display().to_string(), text })
    }

    fn is_file(&self, path: &str) -> Option<bool> {
        self.folder.as_ref().map(|folder| folder.join(path).is_file())
    }
}

/// Reads all of stdin.
///
/// # Errors
/// What is wrong with it.
pub fn read_stdin() -> Result<String, Fault> {
    let mut bytes = Vec::new();
    std::io::stdin()
        .lock()
        .read_to_end(&mut bytes)
        .map_err(|e| format!("cannot read standard input: {e}"))?;
    text(bytes, "standard input")
}

fn text(bytes: Vec<u8>, name: &str) -> Result<String, Fault> {
    String::from_utf8(bytes)
        .map_err(|e| format!("{name} is not UTF-8 text (byte {})", e.utf8_error().valid_up_to()))
}

/// Writes a file, and the folders above it.
///
/// # Errors
/// The file's name and what is wrong.
pub fn write(path: &Path, text: &str) -> Result<(), Fault> {
    let fault = |e: std::io::Error| format!("cannot write {}: {e}", terminal::shown(path));
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(fault)?;
    }
    fs::write(path, text).map_err(fault)
}

/// Puts another text in a file's place, all of it or nothing: it is written beside the file, and renamed.
///
/// # Errors
/// The file's name and what is wrong.
pub fn replace(path: &Path, text: &str) -> Result<(), Fault> {
    let fault = |e: std::io::Error| format!("cannot write {}: {e}", terminal::shown(path));
    // Of a link, what it leads to is replaced.
    let target = path.canonicalize().map_err(fault)?;
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    let beside = target.with_file_name(format!(".{name}.{}.tmp", std::process::id()));
    let written = (|| {
        let mut file = fs::File::create_new(&beside)?;
        file.write_all(text.as_bytes())?;
        file.set_permissions(fs::metadata(&target)?.permissions())?;
        file.sync_all()?;
        fs::rename(&beside, &target)
    })();
    written.map_err(|e| {
        // What is left of the attempt is of no use; that it cannot be removed changes nothing.
        let _ = fs::remove_file(&beside);
        fault(e)
    })
}

/// A document as JSON, for people to read and machines to parse.
///
/// # Errors
/// A number that JSON cannot hold.
pub fn json(document: &impl serde::Serialize) -> Result<String, Fault> {
    serde_json::to_string_pretty(document).map(|text| text + "\n").map_err(|e| format!("cannot print: {e}"))
}

/// Compiles a scenario and files of tests; a folder stands for the `.hri` files in it.
///
/// # Errors
/// A file that cannot be read.
pub fn load(scenario: &Path, tests: &[PathBuf]) -> Result<Compilation, Fault> {
    let text = read(scenario)?;
    let name = scenario.display().to_string();
    let mut files = Vec::new();
    for path in tests {
        for file in expand(path)? {
            files.push((file.display().to_string(), read(&file)?));
        }
    }
    let tests: Vec<Input<'_>> = files.iter().map(|(name, text)| Input { name, text }).collect();
    Ok(compile_with(Input { name: &name, text: &text }, &tests, &Disk::of(Some(scenario))))
}

fn expand(path: &Path) -> Result<Vec<PathBuf>, Fault> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let entries = fs::read_dir(path).map_err(|e| format!("cannot read {}: {e}", terminal::shown(path)))?;
    let mut files: Vec<PathBuf> = entries
        .filter_map(Result::ok)
        .map(|e| e.path())
        .filter(|p| p.extension().is_some_and(|e| e == "hri"))
        .collect();
    files.sort();
    if files.is_empty() {
        return Err(format!("no .hri file in {}", terminal::shown(path)));
    }
    Ok(files)
}

/// The folder of a scenario, where its robot code is.
#[must_use]
pub fn folder(scenario: &Path) -> PathBuf {
    match scenario.parent() {
        Some(folder) if folder.as_os_str().is_empty() => PathBuf::from("."),
        Some(folder) => folder.to_owned(),
        None => PathBuf::from("."),
    }
}

/// Shows the diagnostics on stderr, at most so many of each file (0: all): errors before warnings, in the order of the text.
pub fn show(files: &Files, diagnostics: &[&Diagnostic], most: usize) {
    let mut by_file: BTreeMap<FileId, Vec<&Diagnostic>> = BTreeMap::new();
    for diagnostic in diagnostics {
        by_file.entry(diagnostic.span().file).or_default().push(diagnostic);
    }
    for (file, all) in by_file {
        let (errors, warnings): (Vec<&Diagnostic>, Vec<&Diagnostic>) = all.iter().partition(|d| d.is_error());
        let most = if most == 0 { all.len() } else { most };
        let (shown, rest) = (most.min(errors.len()), most.saturating_sub(errors.len()).min(warnings.len()));
        let (mut left_errors, mut left_warnings) = (shown, rest);
        for diagnostic in all {
            let left = if diagnostic.is_error() { &mut left_errors } else { &mut left_warnings };
            if *left > 0 {
                *left -= 1;
                terminal::say(render::diagnostic(files, diagnostic));
            }
        }
        let (errors, warnings) = (errors.len() - shown, warnings.len() - rest);
        if errors + warnings > 0 {
            let name = files.get(file).map_or("?", |f| &f.name);
            let (name, more) = (printable_line(name), render::totals(errors, warnings));
            terminal::say_line(format_args!(
                "{name}: {more} more are not shown (`hrdsl check --max-findings 0` shows all)"
            ));
        }
    }
}

/// Shows the diagnostics on stderr; gives the program, which there is if none of them is an error.
pub fn report(compilation: &Compilation) -> Option<&Program> {
    let all: Vec<&Diagnostic> = compilation.diagnostics.iter().collect();
    show(&compilation.files, &all, render::SHOWN);
    let errors = all.iter().filter(|d| d.is_error()).count();
    if !all.is_empty() {
        terminal::say_line(render::totals(errors, all.len() - errors));
    }
    compilation.program.as_ref()
}

/// Shows the errors on stderr, and how many warnings there are: who runs tests has seen them, or can.
pub fn report_errors<'c>(scenario: &Path, compilation: &'c Compilation) -> Option<&'c Program> {
    let (errors, warnings): (Vec<_>, Vec<_>) = compilation.diagnostics.iter().partition(|d| d.is_error());
    show(&compilation.files, &errors, render::SHOWN);
    if !errors.is_empty() {
        terminal::say_line(render::totals(errors.len(), 0));
    }
    if !warnings.is_empty() {
        let (count, them) =
            (render::totals(0, warnings.len()), if warnings.len() == 1 { "it" } else { "them" });
        terminal::say_line(format_args!(
            "{count} (`hrdsl check {}` shows {them})",
            terminal::shown(scenario)
        ));
    }
    compilation.program.as_ref()
}
