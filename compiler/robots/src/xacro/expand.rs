//! The expansion: elements in their order, each by what it is.

use std::{collections::BTreeMap, rc::Rc};

use hrdsl_source::{SourceFiles, Span, nearest};

use super::{
    evaluate::{ExprNames, evaluate},
    parse::parse_expression,
    scope::{ScopeId, TOP, XacroScopes, XacroSymbol},
    text::{TextPiece, XacroText, pieces},
    value::{EvalFault, EvalResult, XacroValue, wrong},
    written::{literal, written},
};
use crate::{
    fault::{RobotFault, RobotFaultKind, RobotPlace},
    files::{package::PackageTable, reader::RobotReader},
    limits::{MOST_COMPUTED_BYTES, MOST_ELEMENTS, MOST_EXPANSION_DEPTH},
    xml::{XmlAttribute, XmlElement, XmlNode, XmlText},
};

/// What an expansion is given besides the files.
pub(crate) struct XacroRequest<'a> {
    /// The file of the description.
    pub path: &'a str,
    /// `NAME:=VALUE` of the command line.
    pub arguments: &'a [(String, String)],
    /// What `$(env NAME)` is: nothing is taken from the process.
    pub environment: &'a [(String, String)],
    pub packages: &'a PackageTable,
    pub reader: &'a dyn RobotReader,
}

/// Expands a description; the first fault ends it.
pub(crate) fn expand_xacro(
    root: &XmlElement,
    request: &XacroRequest,
    files: &mut SourceFiles,
    warnings: &mut Vec<RobotFault>,
) -> Result<XmlElement, RobotFault> {
    let mut expander = XacroExpander {
        request,
        files,
        warnings,
        scopes: XacroScopes::new(),
        arguments: request.arguments.iter().cloned().collect(),
        stack: vec![request.path.to_owned()],
        depth: 0,
        elements: 0,
        computed: 0,
        call: None,
    };
    expander.element(root, TOP)
}

pub(super) type ExpandResult<T> = Result<T, RobotFault>;

pub(super) struct XacroExpander<'a> {
    pub request: &'a XacroRequest<'a>,
    pub files: &'a mut SourceFiles,
    pub warnings: &'a mut Vec<RobotFault>,
    pub scopes: XacroScopes,
    /// Of the command line, and of `<xacro:arg>` where that gives none.
    pub arguments: BTreeMap<String, String>,
    /// The files that include each other, the current one last.
    pub stack: Vec<String>,
    depth: usize,
    elements: usize,
    computed: usize,
    /// The innermost call of a macro.
    pub call: Option<Span>,
}

impl XacroExpander<'_> {
    /// The file that is being read.
    pub fn file(&self) -> &str {
        self.stack.last().map(String::as_str).unwrap_or_default()
    }

    pub fn placed(&self, place: RobotPlace) -> RobotPlace {
        RobotPlace { span: place.span, call: place.call.or(self.call) }
    }

    /// Goes one macro, include or block down.
    pub fn deeper<T>(
        &mut self,
        place: RobotPlace,
        expand: impl FnOnce(&mut Self) -> ExpandResult<T>,
    ) -> ExpandResult<T> {
        if self.depth >= MOST_EXPANSION_DEPTH {
            let kind = RobotFaultKind::TooMuch {
                what: "macros and includes within each other",
                limit: MOST_EXPANSION_DEPTH,
            };
            return Err(kind.at(self.placed(place), "let the macro that calls itself come to an end"));
        }
        self.depth += 1;
        let expanded = expand(self);
        self.depth -= 1;
        expanded
    }

    /// An element that is no word of xacro: its attributes and what is in it.
    fn element(&mut self, element: &XmlElement, scope: ScopeId) -> ExpandResult<XmlElement> {
        let place = self.placed(element.place);
        self.elements += 1;
        if self.elements > MOST_ELEMENTS {
            let kind = RobotFaultKind::TooMuch { what: "elements of a description", limit: MOST_ELEMENTS };
            return Err(kind.at(place, "describe a smaller robot"));
        }
        let mut attributes = Vec::new();
        for attribute in element.attributes.iter().filter(|a| !a.name.starts_with("xacro:")) {
            let value = self.text_of(element, attribute, scope)?;
            attributes.push(XmlAttribute { value, ..attribute.clone() });
        }
        let children = self.children(&element.children, scope, &mut attributes)?;
        Ok(XmlElement { name: element.name.clone(), place, attributes, children })
    }

    /// All children, expanded; `attributes` are those of the element around them.
    pub fn children(
        &mut self,
        nodes: &[XmlNode],
        scope: ScopeId,
        attributes: &mut Vec<XmlAttribute>,
    ) -> ExpandResult<Vec<XmlNode>> {
        let mut expanded = Vec::new();
        for node in nodes {
            match node {
                XmlNode::Text(text) if text.text.contains('$') => {
                    let place = self.placed(text.span.into());
                    let value = self.value(XacroText { text: &text.text, place }, scope)?;
                    expanded.push(XmlNode::Text(XmlText { text: written(&value), span: text.span }));
                }
                XmlNode::Text(text) => expanded.push(XmlNode::Text(text.clone())),
                XmlNode::Element(element) => self.node(element, scope, attributes, &mut expanded)?,
            }
        }
        Ok(expanded)
    }

    fn node(
        &mut self,
        element: &XmlElement,
        scope: ScopeId,
        attributes: &mut Vec<XmlAttribute>,
        expanded: &mut Vec<XmlNode>,
    ) -> ExpandResult<()> {
        let Some(word) = element.name.strip_prefix("xacro:") else {
            expanded.push(XmlNode::Element(self.element(element, scope)?));
            return Ok(());
        };
        match word {
            "property" => self.property(element, scope)?,
            "macro" => self.define_macro(element, scope)?,
            "arg" => self.argument(element, scope)?,
            "if" | "unless" => {
                if self.condition(element, scope)? == (word == "if") {
                    expanded.extend(self.children(&element.children, scope, attributes)?);
                }
            }
            "include" => expanded.extend(self.include(element, scope)?),
            "insert_block" => expanded.extend(self.insert_block(element, scope)?),
            "attribute" => {
                let name = self.text_of(element, element.needs("name")?, scope)?;
                let written = element.needs("value")?;
                let value = self.text_of(element, written, scope)?;
                attributes.retain(|attribute| attribute.name != name);
                attributes.push(XmlAttribute { name, value, span: written.span });
            }
            "element" => {
                let name = self.text_of(element, element.needs("xacro:name")?, scope)?;
                let renamed = XmlElement { name, ..element.clone() };
                self.node(&renamed, scope, attributes, expanded)?;
            }
            _ => expanded.extend(self.call_macro(element, word, scope)?),
        }
        Ok(())
    }

    /// `<xacro:arg name="…" default="…"/>`
    fn argument(&mut self, element: &XmlElement, scope: ScopeId) -> ExpandResult<()> {
        let name = &element.needs_name("name")?.value;
        if !self.arguments.contains_key(name) {
            let default = element.needs("default")?;
            let value = self.text_of(element, default, scope)?;
            self.arguments.insert(name.clone(), value);
        }
        Ok(())
    }

    fn condition(&mut self, element: &XmlElement, scope: ScopeId) -> ExpandResult<bool> {
        let attribute = element.needs("value")?;
        let place = self.placed(element.place_of(attribute));
        let value = self.value(XacroText { text: &attribute.value, place }, scope)?;
        truth(&value).ok_or_else(|| {
            let kind = RobotFaultKind::NoCondition(written(&value));
            kind.at(place, "write true or false, 1 or 0, or an expression such as `${a == b}`")
        })
    }

    fn insert_block(&mut self, element: &XmlElement, scope: ScopeId) -> ExpandResult<Vec<XmlNode>> {
        let attribute = element.needs_name("name")?;
        let name = &attribute.value;
        let place = element.place_of(attribute);
        let (block, content_only) = match self.scopes.block(scope, &format!("**{name}")) {
            Some(block) => (Some(block), true),
            None => (self.scopes.block(scope, &format!("*{name}")), false),
        };
        let Some(block) = block else {
            let names = self.scopes.block_names(scope);
            let near = nearest(name, names.iter().map(String::as_str));
            let help = match near {
                Some(near) => format!("write `{near}`"),
                None => format!("make it a parameter of the macro: `params=\"*{name}\"`"),
            };
            return Err(RobotFaultKind::UnknownBlock(name.clone()).at(self.placed(place), help));
        };
        self.deeper(place, |expander| {
            if content_only {
                expander.children(&block.children, scope, &mut Vec::new())
            } else {
                Ok(vec![XmlNode::Element(expander.element(&block, scope)?)])
            }
        })
    }

    /// The text that an attribute comes to.
    pub fn text_of(
        &mut self,
        element: &XmlElement,
        attribute: &XmlAttribute,
        scope: ScopeId,
    ) -> ExpandResult<String> {
        let place = self.placed(element.place_of(attribute));
        let value = self.value(XacroText { text: &attribute.value, place }, scope)?;
        Ok(written(&value))
    }

    /// The value that a text comes to: that of its expression, if it is nothing else.
    pub fn value(&mut self, text: XacroText, scope: ScopeId) -> ExpandResult<XacroValue> {
        let found = pieces(text.text).map_err(|fault| fault.at(text.place))?;
        if let [TextPiece::Plain(_)] | [] = found.as_slice() {
            // Also `$${`, of which a dollar sign goes.
            let plain = found.first().map(|piece| self.piece(text, piece, scope)).transpose()?;
            return Ok(plain.unwrap_or(XacroValue::Text(Rc::from(""))));
        }
        let mut values = Vec::new();
        for piece in &found {
            values.push(self.piece(text, piece, scope)?);
        }
        let value = match values.as_slice() {
            [one] => one.clone(),
            many => {
                let joined: String = many.iter().map(written).collect();
                XacroValue::text(joined).map_err(|fault| fault.at(text.place))?
            }
        };
        if let XacroValue::Text(text) = &value {
            self.computed += text.len();
        }
        if self.computed > MOST_COMPUTED_BYTES {
            let kind =
                RobotFaultKind::TooMuch { what: "bytes of computed texts", limit: MOST_COMPUTED_BYTES };
            return Err(kind.at(text.place, "compute less"));
        }
        Ok(value)
    }

    fn piece(&mut self, text: XacroText, piece: &TextPiece, scope: ScopeId) -> ExpandResult<XacroValue> {
        match piece {
            TextPiece::Plain(range) => {
                XacroValue::text(text.part(range.clone()).text).map_err(|fault| fault.at(text.place))
            }
            TextPiece::Expression(range) => {
                let inside = text.part(range.clone());
                // `$(arg x)` may stand within.
                let source = self.inner(inside, scope)?;
                self.computed += source.len();
                self.expression(&source, scope).map_err(|fault| fault.at(inside.place))
            }
            TextPiece::Substitution(range) => {
                let inside = text.part(range.clone());
                let source = self.inner(inside, scope)?;
                self.substitution(&source, scope).map_err(|fault| fault.at(inside.place))
            }
        }
    }

    /// What stands in braces or parentheses, itself expanded.
    fn inner(&mut self, inside: XacroText, scope: ScopeId) -> ExpandResult<String> {
        if !inside.text.contains('$') {
            return Ok(inside.text.to_owned());
        }
        self.deeper(inside.place, |expander| Ok(written(&expander.value(inside, scope)?)))
    }

    pub fn expression(&mut self, source: &str, scope: ScopeId) -> EvalResult<XacroValue> {
        let expr = parse_expression(source)?;
        evaluate(&expr, &mut ScopedNames { expander: self, scope })
    }

    /// The value of the property of this name, evaluated if nobody asked for it before.
    pub fn property_value(&mut self, scope: ScopeId, name: &str) -> EvalResult<Option<XacroValue>> {
        let Some((home, symbol)) = self.scopes.symbol(scope, name) else { return Ok(None) };
        match symbol {
            XacroSymbol::Value(value) => Ok(Some(value)),
            XacroSymbol::Busy => wrong(
                format!("`{name}` needs its own value"),
                "let it depend on other properties, or write `lazy_eval=\"false\"`",
            ),
            XacroSymbol::Text(text, place) => {
                self.scopes.set(home, name, XacroSymbol::Busy);
                let value =
                    self.deeper(place, |expander| expander.value(XacroText { text: &text, place }, home));
                let value = match value {
                    Ok(value) => as_literal(value),
                    Err(fault) => {
                        self.scopes.set(home, name, XacroSymbol::Text(text, place));
                        return Err(EvalFault::from(fault));
                    }
                };
                self.scopes.set(home, name, XacroSymbol::Value(value.clone()));
                Ok(Some(value))
            }
        }
    }
}

/// A text that looks like a number or a boolean is one.
pub(super) fn as_literal(value: XacroValue) -> XacroValue {
    if let XacroValue::Text(text) = &value { literal(text).unwrap_or(value) } else { value }
}

/// What a condition comes to.
pub(super) fn truth(value: &XacroValue) -> Option<bool> {
    if let XacroValue::Text(text) = value {
        match &**text {
            "true" | "True" => Some(true),
            "false" | "False" => Some(false),
            other => super::written::whole(other.trim()).map(|number| number != 0),
        }
    } else {
        Some(value.is_true())
    }
}

/// The names that an expression in a scope sees.
struct ScopedNames<'e, 'a> {
    expander: &'e mut XacroExpander<'a>,
    scope: ScopeId,
}

impl ExprNames for ScopedNames<'_, '_> {
    fn lookup(&mut self, path: &[String]) -> EvalResult<Option<(XacroValue, usize)>> {
        let Some((first, rest)) = path.split_first() else { return Ok(None) };
        if let Some(value) = self.expander.property_value(self.scope, first)? {
            return Ok(Some((value, 1)));
        }
        let (Some(space), Some(second)) = (self.expander.scopes.space(self.scope, first), rest.first())
        else {
            return Ok(None);
        };
        match self.expander.property_value(space, second)? {
            Some(value) => Ok(Some((value, 2))),
            None => wrong(
                format!("`{first}` has no property `{second}`"),
                "look into the file that is included under this name",
            ),
        }
    }

    fn outer(&mut self, name: &str, arguments: &[XacroValue]) -> EvalResult<XacroValue> {
        self.expander.outer(name, arguments)
    }

    fn all_names(&self) -> Vec<String> {
        self.expander.scopes.names(self.scope)
    }
}
