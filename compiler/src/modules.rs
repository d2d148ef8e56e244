//! `use`: the modules that a scenario needs, from the library and from files, each once, in the order of their first use.

use std::sync::Arc;

use hrdsl_messages::WorkspaceReader;
use hrdsl_robots::RobotReader;
use hrdsl_source::{Diagnostic, DiagnosticCode, SourceFiles, Span};
use hrdsl_syntax::ast::{self, ItemSyntaxKind, ModuleSyntax};

/// The most modules that one scenario uses, its modules' modules included.
const MAX_MODULES: usize = 1000;

/// The text of a file that `use "…"` names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModuleText {
    /// As it is to be shown; two of the same name are one module.
    pub name: String,
    pub text: String,
}

/// Reads the files that are used; the compiler itself touches none.
pub trait ModuleLoader {
    /// The file that `path` means in the file called `from`.
    ///
    /// # Errors
    /// Why it cannot be read, as the end of a sentence: "there is no such file".
    fn load(&self, from: &str, path: &str) -> Result<ModuleText, String>;

    /// Who reads the folders of ROS workspaces, whose paths are relative to the file called `from`; `None`: nobody.
    fn workspaces(&self, _from: &str) -> Option<Box<dyn WorkspaceReader + '_>> {
        None
    }

    /// Who reads descriptions of robots and maps, whose paths begin with the folder of the file that names them; `None`: nobody.
    fn robots(&self) -> Option<Box<dyn RobotReader + '_>> {
        None
    }

    /// Whether `path`, or a pattern such as `src/*.py`, means a file, from the scenario's folder; `None`: nobody knows.
    fn means_a_file(&self, _path: &str) -> Option<bool> {
        None
    }
}

/// Whether the name of a file that `coverage` has is a pattern, which may mean several.
#[must_use]
pub fn is_file_pattern(name: &str) -> bool {
    name.contains(['*', '?', '['])
}

/// Where there are no files: only modules of the library can be used.
pub struct LibraryOnlyLoader;

impl ModuleLoader for LibraryOnlyLoader {
    fn load(&self, _from: &str, _path: &str) -> Result<ModuleText, String> {
        Err("there are no files here".to_owned())
    }
}

/// Adds the modules used by the files so far, and by modules.
pub fn load(
    files: &mut SourceFiles,
    ast: &mut Vec<Arc<ast::FileSyntax>>,
    diagnostics: &mut Vec<Diagnostic>,
    loader: &dyn ModuleLoader,
) {
    let mut known: Vec<String> = files.iter().map(|(_, f)| f.name.clone()).collect();
    let first = ast.len();
    let mut next = 0;
    while next < ast.len() {
        for used in uses(&ast[next]) {
            let from = known[next].clone();
            let source = match find(&used, &from, loader) {
                Ok(source) => source,
                Err(issue) => {
                    diagnostics.push(issue);
                    continue;
                }
            };
            if known.contains(&source.name) {
                let whole = source.name == known[0] && !is_module(&ast[0]);
                diagnostics.extend((whole || source.name == from).then(|| not_a_module(&used)));
                continue;
            }
            if ast.len() - first >= MAX_MODULES {
                let message = format!("more than {MAX_MODULES} modules are used");
                diagnostics.push(Diagnostic::error(DiagnosticCode::TOO_DEEP, span_of(&used), message));
                return;
            }
            let id = files.add(source.name.clone(), source.text.as_str());
            known.push(source.name);
            let (file, issues) = hrdsl_syntax::parse(id, &source.text);
            diagnostics.extend(issues);
            diagnostics.extend(misplaced(&file));
            ast.push(Arc::new(file));
        }
        next += 1;
    }
}

/// Lets a file use further ones, as if it said so at its end.
pub fn also_use(file: &mut ast::FileSyntax, paths: &[&str]) {
    let span = Span::default();
    for path in paths {
        let text = ast::TextSyntax { text: (*path).to_owned(), span };
        let kind = ItemSyntaxKind::Use(ModuleSyntax::File(text));
        file.items.push(ast::ItemSyntax { doc: String::new(), kind, span });
    }
}

/// Adds the library's devices, which every scenario has, unless they are there; gives the module's place.
pub fn load_devices(files: &mut SourceFiles, ast: &mut Vec<Arc<ast::FileSyntax>>) -> Option<usize> {
    let text = hrdsl_stdlib::module(hrdsl_stdlib::DEVICES)?;
    let known = files.iter().position(|(_, file)| file.name == hrdsl_stdlib::DEVICES || file.text == text);
    known.or_else(|| {
        let id = files.add(hrdsl_stdlib::DEVICES, text);
        ast.push(Arc::new(hrdsl_syntax::parse(id, text).0));
        Some(ast.len() - 1)
    })
}

/// Whether a file that stands alone is a module: it has no name, and nothing that only a scenario has.
#[must_use]
pub fn is_module(file: &ast::FileSyntax) -> bool {
    let of_scenario =
        |item: &ast::ItemSyntax| only_in_scenario(&item.kind).is_some() || item.kind == ItemSyntaxKind::Error;
    file.scenario.is_none() && !file.items.is_empty() && !file.items.iter().any(of_scenario)
}

/// What only a scenario can have.
fn only_in_scenario(kind: &ItemSyntaxKind) -> Option<&'static str> {
    kind.rules().only_in_scenario
}

/// HR0106
fn misplaced(module: &ast::FileSyntax) -> Vec<Diagnostic> {
    let line = module.scenario.iter().map(|name| (name.span, "a `scenario` line"));
    let items = module.items.iter().filter_map(|i| Some((i.span, only_in_scenario(&i.kind)?)));
    let error = |(span, what): (Span, &str)| {
        Diagnostic::error(
            DiagnosticCode::MODULE_ITEM,
            span,
            format!("a module has no {}", what.trim_start_matches("a ")),
        )
        .here("this file is used as a module")
        .help("move this to the scenario, or share a template that the scenario makes an instance of")
    };
    line.chain(items).map(error).collect()
}

fn find(used: &ModuleSyntax, from: &str, loader: &dyn ModuleLoader) -> Result<ModuleText, Diagnostic> {
    match used {
        ModuleSyntax::Library(path) => {
            let name = path.names.iter().map(|n| n.text.as_str()).collect::<Vec<_>>().join(".");
            match hrdsl_stdlib::module(&name) {
                Some(text) => Ok(ModuleText { name, text: text.to_owned() }),
                None => Err(unknown(&name, path)),
            }
        }
        ModuleSyntax::File(path) => loader.load(from, &path.text).map_err(|why| {
            let message = format!("cannot use `{}`: {why}", path.text);
            Diagnostic::error(DiagnosticCode::UNKNOWN_MODULE, path.span, message)
                .help("the path is relative to the file that uses it")
        }),
    }
}

fn uses(file: &ast::FileSyntax) -> Vec<ModuleSyntax> {
    let used =
        |i: &ast::ItemSyntax| if let ItemSyntaxKind::Use(used) = &i.kind { Some(used.clone()) } else { None };
    file.items.iter().filter_map(used).collect()
}

fn span_of(used: &ModuleSyntax) -> Span {
    match used {
        ModuleSyntax::Library(path) => path.span,
        ModuleSyntax::File(path) => path.span,
    }
}

/// HR0106
fn not_a_module(used: &ModuleSyntax) -> Diagnostic {
    Diagnostic::error(
        DiagnosticCode::MODULE_ITEM,
        span_of(used),
        "a scenario is no module, and no file uses itself",
    )
    .help("take the line away, or move what is shared to a file of its own")
}

/// HR0104, at the first name that differs from those of the nearest module.
fn unknown(name: &str, path: &ast::PathSyntax) -> Diagnostic {
    let names: Vec<&str> = hrdsl_stdlib::MODULES.iter().map(|m| m.0).collect();
    let near = hrdsl_source::nearest(name, names.iter().copied());
    let parts = near.unwrap_or_default().split('.').map(Some).chain(std::iter::repeat(None));
    let wrong = path.names.iter().zip(parts).find(|(n, part)| Some(n.text.as_str()) != *part);
    let span = if near.is_some() { wrong.map_or(path.span, |(n, _)| n.span) } else { path.span };
    let error =
        Diagnostic::error(DiagnosticCode::UNKNOWN_MODULE, span, format!("no module is called `{name}`"));
    match near {
        Some(near) => error.help(format!("did you mean `{near}`?")),
        None => error.help(format!("the modules are: `{}`", names.join("`, `"))),
    }
}
