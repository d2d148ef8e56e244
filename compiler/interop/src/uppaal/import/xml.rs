//! The XML of a model: templates with their locations and transitions, and the pieces of text in them.

use std::collections::BTreeMap;

use hrdsl_source::{FileId, Span};
use roxmltree::{Document, Node, ParsingOptions};

use super::{
    branches::{BranchingTransitions, TransitionEnd},
    fault::{UppaalFault, unsupported},
    lex::UppaalFragment,
};
use crate::exchange::note::NoteSeverity;

#[derive(Debug, Default)]
pub struct UppaalModel {
    pub declaration: UppaalFragment,
    pub templates: Vec<UppaalTemplate>,
    /// What instantiates templates, and the line that says what the system is made of.
    pub system: Vec<UppaalFragment>,
    pub queries: Vec<QueryText>,
    /// What is of no account for the behaviour.
    pub skipped: Vec<(Span, NoteSeverity, String)>,
}

#[derive(Debug)]
pub struct UppaalTemplate {
    pub name: String,
    pub parameters: UppaalFragment,
    pub declaration: UppaalFragment,
    pub locations: Vec<UppaalLocation>,
    /// The index of the initial location.
    pub initial: usize,
    pub transitions: Vec<UppaalTransition>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UppaalLocationKind {
    Normal,
    Urgent,
    Committed,
}

#[derive(Debug)]
pub struct UppaalLocation {
    pub name: Option<String>,
    pub span: Span,
    pub kind: UppaalLocationKind,
    pub invariant: UppaalFragment,
    /// `exponentialrate`
    pub rate: String,
    pub comment: String,
}

#[derive(Debug, Default)]
pub struct UppaalTransition {
    pub from: usize,
    pub to: usize,
    pub select: UppaalFragment,
    pub guard: UppaalFragment,
    pub sync: UppaalFragment,
    pub assign: UppaalFragment,
    /// Of a branch: how likely it is.
    pub probability: String,
    /// What surrounds the system moves so, and not the system.
    pub uncontrollable: bool,
    pub comment: String,
}

#[derive(Debug)]
pub struct QueryText {
    pub formula: UppaalFragment,
    pub comment: String,
}

/// Reads a model, and what is wrong with it.
///
/// # Errors
/// It is no model at all.
pub fn read(file: FileId, text: &str) -> Result<(UppaalModel, Vec<UppaalFault>), Vec<UppaalFault>> {
    if let Some((at, message)) = refused(text) {
        return Err(vec![UppaalFault { span: Span::new(file, at, at), message }]);
    }
    let options = ParsingOptions { allow_dtd: true, nodes_limit: 1_000_000, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|e| {
        let at = offset(text, e.pos());
        let message = format!("this is not XML as UPPAAL writes it: {}", without_place(&e.to_string()));
        vec![UppaalFault { span: Span::new(file, at, at), message }]
    })?;
    let mut reader = UppaalReader {
        file,
        text,
        faults: Vec::new(),
        model: UppaalModel::default(),
        ids: BTreeMap::new(),
        branching: BranchingTransitions::default(),
        uncontrollable: None,
    };
    let root = document.root_element();
    if root.tag_name().name() == "nta" {
        reader.nta(root);
    } else {
        let message = format!("expected the element `nta` of a model, found `{}`", root.tag_name().name());
        reader.fault(root, message);
        return Err(reader.faults);
    }
    if let Some((span, count)) = reader.uncontrollable {
        reader.model.skipped.push((span, NoteSeverity::Info, uncontrollable(count)));
    }
    Ok((reader.model, reader.faults))
}

impl UppaalModel {
    /// Whether each template has a location to begin in, so that what is wrong beside can be told, too.
    pub fn begins(&self) -> bool {
        self.templates.iter().all(|template| template.initial < template.locations.len())
    }
}

/// What is said of transitions that are not controllable.
pub fn uncontrollable(count: usize) -> String {
    let many = if count == 1 { "a transition".to_owned() } else { format!("{count} transitions") };
    format!("`controllable=\"false\"` of {many} is kept as a comment: only strategies for games ask for it")
}

/// The most attributes of an element; UPPAAL writes a few.
const ATTRIBUTES: usize = 100;

/// What no model has and what takes the reader of XML without end: entities, and elements with many attributes.
fn refused(text: &str) -> Option<(usize, String)> {
    let mut at = 0;
    while let Some(start) = text[at..].find('<').map(|i| at + i) {
        let rest = &text[start..];
        if rest.starts_with("<!ENTITY") {
            return Some((
                start,
                "entities are not read: write what they stand for in their place".to_owned(),
            ));
        }
        let skip = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];
        at = match skip.iter().find(|(begin, _)| rest.starts_with(begin)) {
            Some((_, end)) => rest.find(end).map_or(text.len(), |i| start + i + end.len()),
            None if rest.starts_with("<!") => start + 2,
            None => {
                let (end, attributes) = tag(rest);
                if attributes > ATTRIBUTES {
                    return Some((start, format!("this element has more than {ATTRIBUTES} attributes")));
                }
                start + end
            }
        };
    }
    None
}

/// Where a tag ends, and how many values in quotes it has.
fn tag(text: &str) -> (usize, usize) {
    let (mut quote, mut values) = (None, 0);
    for (i, c) in text.bytes().enumerate().skip(1) {
        match (quote, c) {
            (Some(q), c) if q == c => quote = None,
            (Some(_), _) => {}
            (None, b'"' | b'\'') => {
                quote = Some(c);
                values += 1;
            }
            (None, b'>' | b'<') => return (i, values),
            (None, _) => {}
        }
    }
    (text.len(), values)
}

/// The byte of a place that is given as roxmltree does, in characters.
fn offset(text: &str, at: roxmltree::TextPos) -> usize {
    let mut start = 0;
    for _ in 1..at.row {
        start = text[start..].find('\n').map_or(text.len(), |i| start + i + 1);
    }
    let column = (at.col as usize).saturating_sub(1);
    text[start..].char_indices().nth(column).map_or(text.len(), |(i, _)| start + i)
}

/// Without ` at 3:4` at its end.
fn without_place(message: &str) -> &str {
    match message.rsplit_once(" at ") {
        Some((said, place)) if place.chars().all(|c| c.is_ascii_digit() || c == ':') => said,
        Some(_) | None => message,
    }
}

/// Elements that change nothing of what a model does.
const IDLE: &[&str] = &["nail", "label-position", "lsc", "imports", "name", "option", "expect", "result"];

struct UppaalReader<'t> {
    file: FileId,
    text: &'t str,
    faults: Vec<UppaalFault>,
    model: UppaalModel,
    /// The locations of the present template, by id.
    ids: BTreeMap<String, usize>,
    /// Its branchpoints.
    branching: BranchingTransitions,
    /// The first transition of the model that is not controllable, and how many there are.
    uncontrollable: Option<(Span, usize)>,
}

impl UppaalReader<'_> {
    fn fault(&mut self, node: Node<'_, '_>, message: impl Into<String>) {
        let span = self.span(node);
        self.faults.push(UppaalFault { span, message: message.into() });
    }

    fn unsupported(&mut self, node: Node<'_, '_>, what: &str) {
        let fault = unsupported(self.span(node), what);
        self.faults.push(fault);
    }

    fn span(&self, node: Node<'_, '_>) -> Span {
        let range = node.range();
        Span::new(self.file, range.start, range.end)
    }

    fn nta(&mut self, root: Node<'_, '_>) {
        for node in root.children().filter(Node::is_element) {
            match node.tag_name().name() {
                "declaration" => self.model.declaration = self.piece(node),
                "template" => self.template(node),
                "instantiation" | "system" => {
                    let piece = self.piece(node);
                    self.model.system.push(piece);
                }
                "queries" => self.queries(node),
                "lsc" => self.unsupported(node, "live sequence charts (`lsc`)"),
                name if IDLE.contains(&name) => {}
                name => self.unknown(node, name),
            }
        }
    }

    fn unknown(&mut self, node: Node<'_, '_>, name: &str) {
        let within = node.parent_element().map_or("", |p| p.tag_name().name());
        self.fault(node, format!("an element `{name}` in `{within}` is not known"));
    }

    fn template(&mut self, node: Node<'_, '_>) {
        let child = |name: &str| node.children().find(|n| n.tag_name().name() == name);
        let Some(name) = child("name").and_then(|n| n.text()).map(str::trim).filter(|n| !n.is_empty()) else {
            return self.fault(node, "this template has no name");
        };
        self.ids.clear();
        let mut template = UppaalTemplate {
            name: name.to_owned(),
            parameters: child("parameter").map(|n| self.piece(n)).unwrap_or_default(),
            declaration: child("declaration").map(|n| self.piece(n)).unwrap_or_default(),
            locations: Vec::new(),
            initial: 0,
            transitions: Vec::new(),
        };
        for part in node.children().filter(Node::is_element) {
            match part.tag_name().name() {
                "location" => self.location(part, &mut template),
                "branchpoint" => match part.attribute("id") {
                    Some(id) => drop(self.branching.points.insert(id.to_owned())),
                    None => self.fault(part, "this branchpoint has no id"),
                },
                "name" | "parameter" | "declaration" | "init" | "transition" => {}
                name if IDLE.contains(&name) => {}
                name => self.unknown(part, name),
            }
        }
        self.initial(node, &mut template);
        let before = self.faults.len();
        for part in node.children().filter(|n| n.has_tag_name("transition")) {
            self.transition(part, &mut template);
        }
        match std::mem::take(&mut self.branching).joined() {
            Ok(joined) => template.transitions.extend(joined),
            // A branch that is missing may be one of the transitions that could not be read.
            Err(_) if self.faults.len() > before => {}
            Err(faults) => self.faults.extend(faults),
        }
        self.model.templates.push(template);
    }

    fn initial(&mut self, node: Node<'_, '_>, template: &mut UppaalTemplate) {
        let Some(init) = node.children().find(|n| n.has_tag_name("init")) else {
            let name = &template.name;
            return self.fault(node, format!("the template `{name}` has no initial location: write `<init ref=\"…\"/>` with the id of one"));
        };
        let id = init.attribute("ref").unwrap_or_default();
        match self.ids.get(id) {
            Some(at) => template.initial = *at,
            None => self.fault(init, format!("there is no location with the id `{id}`")),
        }
    }

    fn location(&mut self, node: Node<'_, '_>, template: &mut UppaalTemplate) {
        let Some(id) = node.attribute("id") else { return self.fault(node, "this location has no id") };
        let mut location = UppaalLocation {
            name: None,
            span: self.span(node),
            kind: UppaalLocationKind::Normal,
            invariant: UppaalFragment::default(),
            rate: String::new(),
            comment: String::new(),
        };
        for part in node.children().filter(Node::is_element) {
            match part.tag_name().name() {
                "name" => {
                    location.name = part.text().map(|t| t.trim().to_owned()).filter(|t| !t.is_empty());
                }
                "urgent" if location.kind != UppaalLocationKind::Committed => {
                    location.kind = UppaalLocationKind::Urgent
                }
                "urgent" => {}
                "committed" => location.kind = UppaalLocationKind::Committed,
                "label" => self.location_label(part, &mut location),
                name if IDLE.contains(&name) => {}
                name => self.unknown(part, name),
            }
        }
        self.ids.entry(id.to_owned()).or_insert(template.locations.len());
        template.locations.push(location);
    }

    fn location_label(&mut self, part: Node<'_, '_>, location: &mut UppaalLocation) {
        match part.attribute("kind").unwrap_or_default() {
            "invariant" => location.invariant = self.piece(part),
            "exponentialrate" => location.rate = comment(part),
            "comments" => location.comment = comment(part),
            kind @ ("testcodeEnter" | "testcodeExit") => self.skip(part, kind),
            kind => self.fault(part, format!("a label `{kind}` of a location is not known")),
        }
    }

    fn skip(&mut self, part: Node<'_, '_>, kind: &str) {
        self.leave_out(part, &format!("`{kind}` is code for tests: a scenario has no place for it"));
    }

    fn leave_out(&mut self, part: Node<'_, '_>, why: &str) {
        let span = self.span(part);
        self.model.skipped.push((span, NoteSeverity::LeftOut, why.to_owned()));
    }

    fn transition(&mut self, node: Node<'_, '_>, template: &mut UppaalTemplate) {
        let end = |reader: &mut Self, name: &str| {
            let Some(part) = node.children().find(|n| n.has_tag_name(name)) else {
                reader.fault(node, format!("this transition has no `{name}`"));
                return None;
            };
            let id = part.attribute("ref").unwrap_or_default();
            if reader.branching.points.contains(id) {
                return Some(TransitionEnd::Branchpoint(id.to_owned()));
            }
            let known = reader.ids.get(id).copied();
            if known.is_none() {
                reader.fault(part, format!("there is no location with the id `{id}`"));
            }
            known.map(TransitionEnd::Location)
        };
        let ends = (end(self, "source"), end(self, "target"));
        let uncontrollable = node.attribute("controllable") == Some("false");
        let mut transition = UppaalTransition { uncontrollable, ..UppaalTransition::default() };
        if uncontrollable {
            let (span, count) = self.uncontrollable.unwrap_or((self.span(node), 0));
            self.uncontrollable = Some((span, count + 1));
        }
        for part in node.children().filter(Node::is_element) {
            match part.tag_name().name() {
                "label" => self.transition_label(part, &mut transition),
                "source" | "target" => {}
                name if IDLE.contains(&name) => {}
                name => self.unknown(part, name),
            }
        }
        let (Some(from), Some(to)) = ends else { return };
        match self.branching.keep((from, to), self.span(node), transition) {
            Ok(transition) => template.transitions.extend(transition),
            Err(fault) => self.faults.push(fault),
        }
    }

    fn transition_label(&mut self, part: Node<'_, '_>, transition: &mut UppaalTransition) {
        match part.attribute("kind").unwrap_or_default() {
            "select" => transition.select = self.piece(part),
            "guard" => transition.guard = self.piece(part),
            "synchronisation" => transition.sync = self.piece(part),
            "assignment" => transition.assign = self.piece(part),
            "comments" => transition.comment = comment(part),
            "probability" => transition.probability = comment(part),
            kind @ "testcode" => self.skip(part, kind),
            kind => self.fault(part, format!("a label `{kind}` of a transition is not known")),
        }
    }

    fn queries(&mut self, node: Node<'_, '_>) {
        for query in node.children().filter(|n| n.has_tag_name("query")) {
            let child = |name: &str| query.children().find(|n| n.has_tag_name(name));
            let formula = child("formula").map(|n| self.piece(n)).unwrap_or_default();
            if !formula.is_blank() {
                let comment = child("comment").map(comment).unwrap_or_default();
                self.model.queries.push(QueryText { formula, comment });
            }
        }
    }

    /// The text of an element, each character with its place.
    fn piece(&self, node: Node<'_, '_>) -> UppaalFragment {
        let mut chars = Vec::new();
        for part in node.children().filter(Node::is_text) {
            let range = part.range();
            let raw = self.text.get(range.clone()).unwrap_or_default();
            place_all(part.text().unwrap_or_default(), raw, range.start, &mut chars);
        }
        let range = node.range();
        let end = chars.last().map_or(range.start, |(at, c): &(u32, char)| *at as usize + c.len_utf8());
        UppaalFragment { file: self.file, chars, end: end as u32 }
    }
}

/// The characters of `text`, which `raw` at the byte `start` stands for.
fn place_all(text: &str, raw: &str, start: usize, out: &mut Vec<(u32, char)>) {
    let mut at = 0;
    for c in text.chars() {
        for mark in ["<![CDATA[", "]]>"] {
            while raw.get(at..).is_some_and(|r| r.starts_with(mark)) && !mark.starts_with(c) {
                at += mark.len();
            }
        }
        out.push(((start + at.min(raw.len())) as u32, c));
        let rest = raw.get(at..).unwrap_or_default();
        at += match rest.chars().next() {
            Some('&') if !rest.starts_with("&&") => rest.find(';').map_or(1, |i| i + 1),
            Some('\r') if rest.starts_with("\r\n") => 2,
            Some(r) => r.len_utf8(),
            None => 0,
        };
    }
}

fn comment(node: Node<'_, '_>) -> String {
    let text: String = node.children().filter_map(|n| n.text()).collect();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
