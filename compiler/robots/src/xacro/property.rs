//! `xacro:property`: values and blocks, and the scopes that they are put into.

use super::{
    expand::{ExpandResult, XacroExpander, as_literal, truth},
    functions::global,
    parse::KEYWORDS,
    scope::{ScopeId, TOP, XacroSymbol},
    text::XacroText,
    value::XacroValue,
    written::literal,
};
use crate::{
    fault::{RobotFaultKind, RobotPlace},
    xml::{XmlAttribute, XmlElement},
};

impl XacroExpander<'_> {
    pub(super) fn property(&mut self, element: &XmlElement, scope: ScopeId) -> ExpandResult<()> {
        let written_name = element.needs_name("name")?;
        let place = self.placed(element.place_of(written_name));
        let name = self.text_of(element, written_name, scope)?;
        if !is_identifier(&name) {
            let kind = RobotFaultKind::BadName(name, "property");
            return Err(
                kind.at(place, "write letters, digits and `_`, a letter first, and no word of Python")
            );
        }
        let (value, default) = (element.attribute("value"), element.attribute("default"));
        if self.flag(element, "remove", scope)?.unwrap_or(false) {
            self.scopes.remove(scope, &name);
            return Ok(());
        }
        if value.is_some() && default.is_some() {
            let kind = RobotFaultKind::WrongCall { name, problem: "has a value and a default".to_owned() };
            return Err(kind.at(place, "write one of them"));
        }
        let known =
            || self.scopes.symbol(scope, &name).is_some() || global(std::slice::from_ref(&name)).is_some();
        if default.is_some() && known() {
            return Ok(());
        }
        let lazy = self.flag(element, "lazy_eval", scope)?.unwrap_or(true);
        let (target, lazy) =
            match element.attribute("scope") {
                None => (scope, lazy),
                Some(written) => match (written.value.as_str(), self.scopes.parent(scope)) {
                    ("global", _) => (TOP, false),
                    ("parent", Some(parent)) => (parent, false),
                    ("parent", None) => {
                        let kind = RobotFaultKind::UnknownName {
                            what: "scope around this one",
                            name: "parent".to_owned(),
                        };
                        self.warnings.push(kind.warned(
                            element.place_of(written),
                            "leave `scope` out; only macros have a caller",
                        ));
                        return Ok(());
                    }
                    (other, _) => {
                        let kind = RobotFaultKind::UnknownWord { what: "scope", word: other.to_owned() };
                        return Err(kind.at(element.place_of(written), "write `parent` or `global`"));
                    }
                },
            };
        match value.or(default) {
            Some(attribute) => self.set_property(&name, element, attribute, scope, target, lazy),
            None => {
                self.scopes.set_block(target, &format!("**{name}"), element.clone());
                Ok(())
            }
        }
    }

    fn set_property(
        &mut self,
        name: &str,
        element: &XmlElement,
        attribute: &XmlAttribute,
        scope: ScopeId,
        target: ScopeId,
        lazy: bool,
    ) -> ExpandResult<()> {
        let place = self.placed(element.place_of(attribute));
        let symbol = if lazy {
            match literal(&attribute.value) {
                Some(value) => XacroSymbol::Value(value),
                None => XacroSymbol::Text(attribute.value.as_str().into(), place),
            }
        } else {
            XacroSymbol::Value(as_literal(self.value(XacroText { text: &attribute.value, place }, scope)?))
        };
        self.scopes.set(target, name, symbol);
        Ok(())
    }

    /// An attribute that is true or false.
    fn flag(&mut self, element: &XmlElement, name: &str, scope: ScopeId) -> ExpandResult<Option<bool>> {
        let Some(attribute) = element.attribute(name) else { return Ok(None) };
        let place: RobotPlace = self.placed(element.place_of(attribute));
        let value: XacroValue = self.value(XacroText { text: &attribute.value, place }, scope)?;
        match truth(&value) {
            Some(flag) => Ok(Some(flag)),
            None => {
                Err(RobotFaultKind::NoCondition(attribute.value.clone()).at(place, "write true or false"))
            }
        }
    }
}

fn is_identifier(name: &str) -> bool {
    let starts = name.chars().next().is_some_and(|c| c.is_alphabetic() || c == '_');
    starts
        && !name.starts_with("__")
        && name.chars().all(|c| c.is_alphanumeric() || c == '_')
        && !KEYWORDS.contains(&name)
}
