//! `$(…)`: arguments, packages, the environment; and the functions of xacro's own.

use hrdsl_source::nearest;

use super::{
    evaluate::{ExprNames, evaluate},
    expand::{XacroExpander, as_literal},
    parse::parse_expression,
    scope::ScopeId,
    value::{EvalFault, EvalResult, XacroValue, not_done, wrong},
    written::written,
};
use crate::{
    fault::{RobotFaultKind, RobotPlace},
    files::{
        path::{folder_of, joined},
        reader::whole_path,
    },
};

const COMMANDS: [&str; 6] = ["arg", "find", "env", "optenv", "dirname", "eval"];

impl XacroExpander<'_> {
    /// The text between `$(` and `)`.
    pub(super) fn substitution(&mut self, inside: &str, _: ScopeId) -> EvalResult<XacroValue> {
        let inside = inside.trim();
        let (command, rest) = inside.split_once(char::is_whitespace).unwrap_or((inside, ""));
        let rest = rest.trim();
        match (command, rest) {
            ("arg", name) if !name.is_empty() => self.argument_value(name).and_then(XacroValue::text),
            ("find", name) if !name.is_empty() => self.package_folder(name),
            ("env", name) if !name.is_empty() => match self.environment(name) {
                Some(value) => XacroValue::text(value),
                None => {
                    let kind = RobotFaultKind::NotDone(format!("`$(env {name})` without a given value"));
                    Err(EvalFault::new(kind, format!("give `{name}` a value, or use `$(arg …)`")))
                }
            },
            ("optenv", rest) if !rest.is_empty() => {
                let (name, otherwise) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
                XacroValue::text(self.environment(name).unwrap_or_else(|| otherwise.trim().to_owned()))
            }
            ("dirname", "") => {
                XacroValue::text(whole_path(self.request.reader, folder_of(self.request.path)))
            }
            ("eval", source) if !source.is_empty() => {
                let value = evaluate(&parse_expression(source)?, &mut ArgumentNames { expander: self })?;
                XacroValue::text(written(&value))
            }
            ("cwd" | "anon", _) => {
                not_done(format!("`$({command})`"), "name files from the description's own folder")
            }
            _ => {
                let help = match nearest(command, COMMANDS) {
                    Some(near) => format!("write `$({near} …)`"),
                    None => format!("write one of {}, or `$$(` for what it is", COMMANDS.join(", ")),
                };
                wrong(format!("`$({inside})` is no substitution"), help)
            }
        }
    }

    fn environment(&self, name: &str) -> Option<String> {
        self.request.environment.iter().find(|(known, _)| known == name).map(|(_, value)| value.clone())
    }

    fn argument_value(&self, name: &str) -> EvalResult<String> {
        self.arguments.get(name).cloned().ok_or_else(|| {
            let help = match nearest(name, self.arguments.keys().map(String::as_str)) {
                Some(near) => format!("write `$(arg {near})`"),
                None => {
                    format!("give it, or declare it before: `<xacro:arg name=\"{name}\" default=\"…\"/>`")
                }
            };
            EvalFault::new(RobotFaultKind::UnknownArgument(name.to_owned()), help)
        })
    }

    fn package_folder(&self, name: &str) -> EvalResult<XacroValue> {
        match self.request.packages.found_from(name, self.file(), self.request.reader) {
            Some(folder) => XacroValue::text(whole_path(self.request.reader, &folder)),
            None => {
                let fault = self.request.packages.unknown(name, RobotPlace::default());
                Err(EvalFault { place: None, ..EvalFault::from(fault) })
            }
        }
    }

    /// Calls a function that needs the files or the arguments.
    pub(super) fn outer(&mut self, name: &str, arguments: &[XacroValue]) -> EvalResult<XacroValue> {
        match (name, arguments) {
            ("load_yaml", [XacroValue::Text(path)]) => self.load_yaml(path),
            ("abs_filename", [XacroValue::Text(path)]) => {
                let path = joined(folder_of(self.file()), path);
                XacroValue::text(whole_path(self.request.reader, &path))
            }
            ("arg", [XacroValue::Text(name)]) => self.argument_value(name).and_then(XacroValue::text),
            ("fatal", parts) => {
                let parts: Vec<String> = parts.iter().map(written).collect();
                wrong(format!("the description says: {}", parts.join(" ")), "do as it says")
            }
            ("warning" | "message", _) => XacroValue::text(""),
            _ => wrong(format!("`{name}` has other arguments"), "give it one text"),
        }
    }
}

/// The names that `$(eval …)` sees: the arguments, and functions that do as the other commands.
struct ArgumentNames<'e, 'a> {
    expander: &'e mut XacroExpander<'a>,
}

impl ExprNames for ArgumentNames<'_, '_> {
    fn lookup(&mut self, path: &[String]) -> EvalResult<Option<(XacroValue, usize)>> {
        let value = path.first().and_then(|name| self.expander.arguments.get(name));
        let Some(value) = value else { return Ok(None) };
        Ok(Some((as_literal(XacroValue::text(value)?), 1)))
    }

    fn outer(&mut self, name: &str, arguments: &[XacroValue]) -> EvalResult<XacroValue> {
        self.expander.outer(name, arguments).map(as_literal)
    }

    fn all_names(&self) -> Vec<String> {
        self.expander.arguments.keys().cloned().collect()
    }
}
