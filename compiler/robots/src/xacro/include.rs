//! `xacro:include`, and the YAML files that expressions load.

use hrdsl_source::Span;

use super::{
    expand::{ExpandResult, XacroExpander},
    scope::ScopeId,
    value::{EvalFault, EvalResult, XacroValue},
    yaml::value_of,
};
use crate::{
    fault::{RobotFaultKind, RobotPlace},
    files::reader::{path_beside, read_text},
    xml::{XmlElement, XmlNode, read_xml},
    yaml::read_yaml,
};

impl XacroExpander<'_> {
    pub(super) fn include(&mut self, element: &XmlElement, scope: ScopeId) -> ExpandResult<Vec<XmlNode>> {
        let attribute = element.needs_name("filename")?;
        let place = self.placed(element.place_of(attribute));
        let written = self.text_of(element, attribute, scope)?;
        if written.contains(['*', '?', '[']) {
            let kind = RobotFaultKind::NotDone("pattern for files".to_owned());
            return Err(kind.at(place, "include each file by its name"));
        }
        let path = path_beside(self.request.reader, self.file(), &written);
        let optional = element.attribute("optional").is_some_and(|optional| optional.value == "true");
        if optional && !self.request.reader.is_file(&path) {
            return Ok(Vec::new());
        }
        let inner = match element.attribute("ns") {
            Some(ns) => {
                let name = self.text_of(element, ns, scope)?;
                let space = self.scopes.open(scope, true);
                self.scopes.set_space(scope, &name, space);
                space
            }
            None => scope,
        };
        self.deeper(place, |expander| {
            let (file, text) = read_text(expander.request.reader, expander.files, &path, place)?;
            let root = read_xml(file, &text)?;
            expander.stack.push(path);
            let expanded = expander.children(&root.children, inner, &mut Vec::new());
            expander.stack.pop();
            expanded
        })
    }

    /// `xacro.load_yaml(path)`
    pub(super) fn load_yaml(&mut self, written: &str) -> EvalResult<XacroValue> {
        let path = path_beside(self.request.reader, self.file(), written);
        // Whoever evaluates the expression knows its place.
        let nowhere = RobotPlace::default();
        let read = read_text(self.request.reader, self.files, &path, nowhere);
        let (file, text) = read.map_err(|fault| EvalFault { place: None, ..EvalFault::from(fault) })?;
        let yaml = read_yaml(&text).map_err(|fault| {
            let span = Span::new(file, fault.at, (fault.at + 1).min(text.len()));
            let kind = RobotFaultKind::BadYaml(fault.reason);
            EvalFault { kind, help: "write it in another way".into(), place: Some(span.into()) }
        })?;
        value_of(&yaml)
    }
}
