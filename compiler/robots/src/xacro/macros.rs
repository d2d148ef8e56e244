//! `xacro:macro` and its calls.

use hrdsl_source::nearest;

use super::{
    expand::{ExpandResult, XacroExpander, as_literal},
    parameters::{MacroParameter, parameters},
    scope::{ScopeId, XacroMacro, XacroSymbol},
    text::XacroText,
    value::XacroValue,
};
use crate::{
    fault::{RobotFault, RobotFaultKind, RobotPlace},
    xml::{XmlElement, XmlNode},
};

impl XacroExpander<'_> {
    pub(super) fn define_macro(&mut self, element: &XmlElement, scope: ScopeId) -> ExpandResult<()> {
        let written = element.needs_name("name")?;
        let name = written.value.strip_prefix("xacro:").unwrap_or(&written.value);
        let place = self.placed(element.place_of(written));
        if name.contains('.') || name == "call" {
            let kind = RobotFaultKind::BadName(name.to_owned(), "macro");
            return Err(kind.at(place, "write another, without a point: points belong to namespaces"));
        }
        let params = element.attribute("params");
        let definition = XacroMacro {
            parameters: params.map(|params| parameters(&params.value)).unwrap_or_default(),
            place: params.map_or(place, |params| element.place_of(params)),
            body: element.clone(),
        };
        self.scopes.set_macro(scope, name, definition);
        Ok(())
    }

    /// `<xacro:NAME …>` or `<xacro:call macro="NAME" …>`
    pub(super) fn call_macro(
        &mut self,
        element: &XmlElement,
        word: &str,
        scope: ScopeId,
    ) -> ExpandResult<Vec<XmlNode>> {
        if word == "call" {
            let name = self.text_of(element, element.needs("macro")?, scope)?;
            let mut call = element.clone();
            call.attributes.retain(|attribute| attribute.name != "macro");
            return self.call_named(&call, &name, scope);
        }
        self.call_named(element, word, scope)
    }

    fn call_named(&mut self, element: &XmlElement, name: &str, scope: ScopeId) -> ExpandResult<Vec<XmlNode>> {
        let place = self.placed(element.place);
        let Some((home, definition)) = self.resolved_macro(name, scope) else {
            let names = self.scopes.macro_names(scope);
            let help = match nearest(name, names.iter().map(String::as_str)) {
                Some(near) => format!("write `<xacro:{near}`"),
                None => "declare it, or include the file that does".to_owned(),
            };
            return Err(RobotFaultKind::UnknownMacro(name.to_owned()).at(place, help));
        };
        let blocks = self.blocks(element, scope)?;
        let inner = self.scopes.open(home, false);
        let expanded = self.deeper(place, |expander| {
            let mut left = definition.parameters.clone();
            expander.bind_given(element, name, scope, inner, &mut left)?;
            expander.bind_blocks(blocks, name, place, inner, &mut left)?;
            expander.bind_defaults(&definition, name, place, scope, inner, left)?;
            let outer_call = expander.call.replace(element.place.span);
            let expanded = expander.children(&definition.body.children, inner, &mut Vec::new());
            expander.call = outer_call;
            expanded
        });
        self.scopes.close(inner);
        expanded
    }

    /// A macro, and the scope that its own is opened in: that of the caller, or that of its namespace.
    fn resolved_macro(&self, name: &str, scope: ScopeId) -> Option<(ScopeId, std::rc::Rc<XacroMacro>)> {
        if let Some(found) = self.scopes.find_macro(scope, name) {
            return Some((scope, found));
        }
        let (spaces, last) = name.rsplit_once('.')?;
        let mut home = scope;
        for space in spaces.split('.') {
            home = self.scopes.space(home, space)?;
        }
        Some((home, self.scopes.find_macro(home, last)?))
    }

    /// The elements that are given, expanded where the macro is called.
    fn blocks(&mut self, element: &XmlElement, scope: ScopeId) -> ExpandResult<Vec<XmlElement>> {
        let nodes = self.children(&element.children, scope, &mut Vec::new())?;
        let elements = nodes.into_iter().filter_map(|node| match node {
            XmlNode::Element(element) => Some(element),
            XmlNode::Text(_) => None,
        });
        Ok(elements.collect())
    }

    fn bind_given(
        &mut self,
        element: &XmlElement,
        name: &str,
        scope: ScopeId,
        inner: ScopeId,
        left: &mut Vec<MacroParameter>,
    ) -> ExpandResult<()> {
        for attribute in &element.attributes {
            let place = self.placed(element.place_of(attribute));
            let Some(at) = left.iter().position(|parameter| parameter.name == attribute.name) else {
                let near = nearest(&attribute.name, left.iter().map(|parameter| parameter.name.as_str()));
                let help = near.map_or("take it out".to_owned(), |near| format!("write `{near}`"));
                let problem = format!("has no parameter `{}`", attribute.name);
                return Err(wrong_call(name, problem, place, help));
            };
            left.remove(at);
            let value = self.value(XacroText { text: &attribute.value, place }, scope)?;
            self.scopes.set(inner, &attribute.name, XacroSymbol::Value(as_literal(value)));
        }
        Ok(())
    }

    fn bind_blocks(
        &mut self,
        blocks: Vec<XmlElement>,
        name: &str,
        place: RobotPlace,
        inner: ScopeId,
        left: &mut Vec<MacroParameter>,
    ) -> ExpandResult<()> {
        let mut blocks = blocks.into_iter();
        for parameter in left.extract_if(.., |parameter| parameter.is_block()) {
            let Some(block) = blocks.next() else {
                let problem = format!("needs the block `{}`", parameter.name);
                return Err(wrong_call(name, problem, place, "write an element into the call"));
            };
            self.scopes.set_block(inner, &parameter.name, block);
        }
        match blocks.next() {
            Some(block) => {
                let problem = format!("has no parameter for the block `<{}>`", block.name);
                Err(wrong_call(
                    name,
                    problem,
                    self.placed(block.place),
                    "take it out, or put one element around the blocks",
                ))
            }
            None => Ok(()),
        }
    }

    fn bind_defaults(
        &mut self,
        definition: &XacroMacro,
        name: &str,
        place: RobotPlace,
        scope: ScopeId,
        inner: ScopeId,
        left: Vec<MacroParameter>,
    ) -> ExpandResult<()> {
        for parameter in left {
            let forwarded: Option<XacroValue> = if parameter.forwards {
                self.property_value(scope, &parameter.name).map_err(|fault| fault.at(place))?
            } else {
                None
            };
            let value = match (forwarded, &parameter.default) {
                (Some(value), _) => value,
                (None, Some(default)) => {
                    self.value(XacroText { text: default, place: self.placed(definition.place) }, scope)?
                }
                (None, None) => {
                    let problem = format!("needs the parameter `{}`", parameter.name);
                    let help = format!("write `{}=\"…\"`", parameter.name);
                    return Err(wrong_call(name, problem, place, help));
                }
            };
            self.scopes.set(inner, &parameter.name, XacroSymbol::Value(as_literal(value)));
        }
        Ok(())
    }
}

fn wrong_call(name: &str, problem: String, place: RobotPlace, help: impl Into<Box<str>>) -> RobotFault {
    RobotFaultKind::WrongCall { name: name.to_owned(), problem }.at(place, help)
}
