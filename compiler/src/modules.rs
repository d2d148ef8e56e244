//! `use`: the standard modules that a scenario needs, each once, in the order in which they are first used.

use hrdsl_source::{Code, Diagnostic, Files};
use hrdsl_syntax::ast::{self, ItemKind};

/// Adds the modules used by the files so far, and by modules.
pub fn load(files: &mut Files, ast: &mut Vec<ast::File>, diagnostics: &mut Vec<Diagnostic>) {
    let mut loaded: Vec<String> = Vec::new();
    let mut next = 0;
    while next < ast.len() {
        for path in uses(&ast[next]) {
            let name = path.names.iter().map(|n| n.text.as_str()).collect::<Vec<_>>().join(".");
            if loaded.contains(&name) {
                continue;
            }
            let Some(text) = hrdsl_stdlib::module(&name) else {
                diagnostics.push(unknown(&name, &path));
                continue;
            };
            let id = files.add(name.clone(), text);
            loaded.push(name);
            let (file, issues) = hrdsl_syntax::parse(id, text);
            ast.push(file);
            diagnostics.extend(issues);
        }
        next += 1;
    }
}

fn uses(file: &ast::File) -> Vec<ast::Path> {
    let path =
        |item: &ast::Item| if let ItemKind::Use(path) = &item.kind { Some(path.clone()) } else { None };
    file.items.iter().filter_map(path).collect()
}

/// HR0104, at the first name that differs from those of the nearest module.
fn unknown(name: &str, path: &ast::Path) -> Diagnostic {
    let names: Vec<&str> = hrdsl_stdlib::MODULES.iter().map(|m| m.0).collect();
    let near = hrdsl_model::nearest(name, names.iter().copied());
    let parts = near.unwrap_or_default().split('.').map(Some).chain(std::iter::repeat(None));
    let wrong = path.names.iter().zip(parts).find(|(n, part)| Some(n.text.as_str()) != *part);
    let span = if near.is_some() { wrong.map_or(path.span, |(n, _)| n.span) } else { path.span };
    let error = Diagnostic::error(Code::UNKNOWN_MODULE, span, format!("no module is called `{name}`"));
    match near {
        Some(near) => error.help(format!("did you mean `{near}`?")),
        None => error.help(format!("the modules are: `{}`", names.join("`, `"))),
    }
}
