//! The compiler: `.hri` text to [`Program`]. It is pure: text comes in as [`InputFile`]s, nothing touches files or clocks.
//!
//! # Steps
//! 1. [`hrdsl_syntax::parse`]: text → AST, of the scenario and the files of tests
//! 2. [`modules::load`]: the modules that are used, and those that they use; [`modules::load_devices`]: what devices can do
//! 3. `descriptions::load`: the robots and maps that it is made from; [`hrdsl_model::resolve_part`]: AST → [`Scenario`], every name resolved, every expression typed
//! 4. [`hrdsl_model::lint`]: what is well formed and yet cannot be meant; `allow` takes away what is
//! 5. [`lower::lower`]: [`Scenario`] → [`Program`], if there were no errors
//!
//! [`compile`] does them all. [`recheck`] does the first three for one declaration whose text has changed.
#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod allow;
mod beside;
mod descriptions;
mod formula_reading;
mod interfaces;
pub mod lower;
pub mod modules;
pub mod pages;
pub mod reading;
mod recheck;
mod spoken;

use std::sync::Arc;

use hrdsl_ir::{Program, binding::MiddlewareKind};
use hrdsl_messages::{InterfaceTable, MessageLibrary, RosVersion};
pub use hrdsl_messages::{WorkspaceEntry, WorkspaceReader};
use hrdsl_model::{DescriptionLibrary, KnownSources, Scenario};
pub use hrdsl_robots::{RobotEntry, RobotReader};
use hrdsl_source::{Diagnostic, FileId, SourceFiles};
pub use hrdsl_syntax::{GRAMMAR, MAX_BYTES, ast, format, parse, token};

pub use modules::{LibraryOnlyLoader, ModuleLoader, ModuleText, is_file_pattern};
pub use recheck::{RecheckResult, recheck};

/// A file: its name as it is to be shown, and its text.
#[derive(Clone, Copy, Debug)]
pub struct InputFile<'a> {
    pub name: &'a str,
    pub text: &'a str,
}

/// The text of a scenario, or of a module that stands alone, read: whoever has to look into it before can have it compiled without
/// reading it again.
#[derive(Clone, Debug)]
pub struct ParsedFile {
    text: String,
    syntax: Arc<ast::FileSyntax>,
    /// What is wrong with the text.
    diagnostics: Vec<Diagnostic>,
}

impl ParsedFile {
    #[must_use]
    pub fn of(text: String) -> ParsedFile {
        let (syntax, diagnostics) = parse(FileId(0), &text);
        ParsedFile { text, syntax: Arc::new(syntax), diagnostics }
    }

    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    #[must_use]
    pub fn syntax(&self) -> &ast::FileSyntax {
        &self.syntax
    }
}

/// What became of a scenario and its tests.
#[derive(Clone, Debug)]
pub struct CompilationResult {
    /// The scenario or module (always [`FileId`] 0), the files of tests, then the modules that are used, and the library's
    /// devices.
    pub files: SourceFiles,
    /// By [`FileId`].
    pub ast: Vec<Arc<ast::FileSyntax>>,
    /// Which of them are modules, in the order in which their declarations come.
    pub modules: Vec<usize>,
    /// The definitions of the versions of ROS that its systems use.
    pub interfaces: Vec<MessageLibrary>,
    /// The robots and maps that it is made from.
    pub descriptions: DescriptionLibrary,
    /// As far as it could be resolved; `None` if the scenario is no text that can be looked at.
    pub scenario: Option<Scenario>,
    /// `Some` if and only if there are no errors.
    pub program: Option<Program>,
    /// By file, then by place.
    pub diagnostics: Vec<Diagnostic>,
}

impl CompilationResult {
    /// Whether something is wrong with the text.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(Diagnostic::is_error)
    }

    /// Whether the first file is a module, which is checked by itself and has nothing to run.
    #[must_use]
    pub fn is_module(&self) -> bool {
        modules::is_module(&self.ast[0])
    }

    /// The table of all interfaces that programs on a middleware can use, as `spec/messages.md` describes it; `None`: no system
    /// uses this middleware.
    #[must_use]
    pub fn interface_table(&self, middleware: MiddlewareKind) -> Option<InterfaceTable> {
        let version = match middleware {
            MiddlewareKind::Ros1 => RosVersion::Ros1,
            MiddlewareKind::Ros2 => RosVersion::Ros2,
        };
        let library = self.interfaces.iter().find(|library| library.version() == version);
        library.and_then(interfaces::table)
    }

    /// How many declarations the first file has.
    #[must_use]
    pub fn declarations(&self) -> usize {
        let declares = |i: &&ast::ItemSyntax| {
            !matches!(i.kind, ast::ItemSyntaxKind::Use(_) | ast::ItemSyntaxKind::Allow(_))
        };
        self.ast[0].items.iter().filter(declares).count()
    }
}

/// Compiles a scenario with the tests that belong to it; it can use modules of the library.
#[must_use]
pub fn compile(scenario: InputFile<'_>, tests: &[InputFile<'_>]) -> CompilationResult {
    compile_with(scenario, tests, &LibraryOnlyLoader)
}

/// Compiles a scenario, or a module by itself; `loader` reads the files that it uses.
#[must_use]
pub fn compile_with(
    scenario: InputFile<'_>,
    tests: &[InputFile<'_>],
    loader: &dyn ModuleLoader,
) -> CompilationResult {
    compile_beside(scenario, tests, &[], loader)
}

/// The same, as if the scenario used these files, too, after those that it names.
#[must_use]
pub fn compile_beside(
    scenario: InputFile<'_>,
    tests: &[InputFile<'_>],
    beside: &[&str],
    loader: &dyn ModuleLoader,
) -> CompilationResult {
    compile_parsed(scenario.name, ParsedFile::of(scenario.text.to_owned()), tests, beside, loader)
}

/// The same, of a scenario whose text has been read.
#[must_use]
pub fn compile_parsed(
    name: &str,
    scenario: ParsedFile,
    tests: &[InputFile<'_>],
    beside: &[&str],
    loader: &dyn ModuleLoader,
) -> CompilationResult {
    let mut files = SourceFiles::default();
    files.add(name, scenario.text);
    let mut ast = vec![scenario.syntax];
    let mut diagnostics = scenario.diagnostics;
    for input in tests {
        let id = files.add(input.name, input.text);
        let (file, issues) = hrdsl_syntax::parse(id, input.text);
        ast.push(Arc::new(file));
        diagnostics.extend(issues);
    }
    let first_module = ast.len();
    if !beside.is_empty() {
        modules::also_use(Arc::make_mut(&mut ast[0]), beside);
    }
    modules::load(&mut files, &mut ast, &mut diagnostics, loader);
    let devices = modules::load_devices(&mut files, &mut ast);

    let tests: Vec<&ast::FileSyntax> = ast[1..first_module].iter().map(AsRef::as_ref).collect();
    // The library's devices come first: what a scenario adds to them is what is there twice.
    let devices = devices.filter(|at| *at >= first_module);
    let others = (first_module..ast.len()).filter(|at| Some(*at) != devices);
    let modules: Vec<usize> = devices.into_iter().chain(others).collect();
    let used: Vec<&ast::FileSyntax> = modules.iter().map(|at| &*ast[*at]).collect();
    let alone = modules::is_module(&ast[0]);
    if !alone {
        diagnostics.extend(unnamed(&ast[0], &diagnostics));
    }
    let missing = diagnostics.iter().any(|d| d.code == hrdsl_source::DiagnosticCode::UNKNOWN_MODULE);
    let interfaces = interfaces::load(&mut files, &ast, loader);
    let descriptions = descriptions::load(&mut files, &ast, &mut diagnostics, loader);
    let known =
        KnownSources { missing_modules: missing, interfaces: &interfaces, descriptions: Some(&descriptions) };
    let (resolved, issues) = hrdsl_model::resolve_part(&ast[0], &used, &tests, known);
    diagnostics.extend(issues);
    if !alone && !diagnostics.iter().any(Diagnostic::is_error) {
        diagnostics.extend(hrdsl_model::lint(&resolved));
        spoken::doubt(&files, &ast, &mut diagnostics);
        diagnostics.extend(beside::missing(&ast, loader));
    }
    allow::apply(&ast, &mut diagnostics);
    diagnostics.sort_by_key(|d| (d.span(), d.code));

    let program = (!diagnostics.iter().any(Diagnostic::is_error)).then(|| lower::lower(&resolved, &files));
    CompilationResult {
        files,
        ast,
        modules,
        interfaces,
        descriptions,
        scenario: Some(resolved),
        program,
        diagnostics,
    }
}

/// A scenario without its `scenario` line. If something could not be read, that may have been it.
fn unnamed(file: &ast::FileSyntax, so_far: &[Diagnostic]) -> Option<Diagnostic> {
    let unread = so_far.iter().any(|d| d.span().file == FileId(0) && d.is_error());
    (file.scenario.is_none() && !unread).then(|| {
        let span = hrdsl_source::Span::new(FileId(0), 0, 0);
        Diagnostic::error(hrdsl_source::DiagnosticCode::MISSING_DECLARATION, span, "the scenario has no name")
            .help("begin with `scenario NAME`")
    })
}
