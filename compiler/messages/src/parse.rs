//! Reading a definition: parts, lines, and what stands on a line.
//!
//! Every line is looked at, whatever is wrong with those before it; a line at fault declares nothing.

use std::collections::BTreeMap;

use hrdsl_source::{FileId, Span};

use crate::{
    definition::{
        ActionDefinition, ElementCount, FieldElement, MessageConstant, MessageDefinition, MessageField,
        MessageFieldType, ServiceDefinition,
    },
    fault::{MessageFault, MessageFaultKind},
    limits::{MOST_BYTES, MOST_FAULTS, MOST_MEMBERS},
    name::{InterfaceName, InterfaceSpace, NamedPart, RosVersion},
    placed::PlacedText,
    primitive::PrimitiveType,
    types::read_type,
    value::{MessageValue, QuoteScan, ValueProblem, list_pieces, read_value},
};

/// The text of one definition, and where it is.
#[derive(Clone, Copy, Debug)]
pub struct DefinitionText<'a> {
    pub version: RosVersion,
    /// The package that it belongs to, and its name, which is that of its file.
    pub package: &'a str,
    pub name: &'a str,
    pub file: FileId,
    /// The byte of the file at which the text begins.
    pub start: usize,
    pub text: &'a str,
}

/// What a definition says, as far as it can be understood.
#[derive(Clone, Debug, PartialEq)]
pub enum InterfaceDefinition {
    Message(MessageDefinition),
    Service(ServiceDefinition),
    Action(ActionDefinition),
}

/// Reads a `.msg`, `.srv` or `.action`, whichever the space says.
#[must_use]
pub fn parse_definition(
    source: DefinitionText<'_>,
    space: InterfaceSpace,
) -> (InterfaceDefinition, Vec<MessageFault>) {
    let mut faults = FaultList::default();
    let text = PlacedText { file: source.file, at: source.start, text: bounded(source, &mut faults) };
    let text = text.after("\u{feff}").unwrap_or(text);
    let name = InterfaceName::new(source.package, space, source.name);
    if let Some(rule) = NamedPart::Interface.broken_rule(source.version, source.name) {
        let kind = MessageFaultKind::BadName { part: space.noun(), name: source.name.to_owned() };
        faults.say(kind.at(text.part(0, "").span(), format!("rename the file: {rule}")));
    }
    let mut parts = sections(text, space, source.version, &mut faults).into_iter();
    let mut part = |suffix: &str| {
        let name = part_name(&name, suffix, source.version);
        // `sections` gives as many as the space has.
        let text = parts.next().unwrap_or(text.part(text.text.len(), ""));
        MessageParser { version: source.version, faults: &mut faults, names: BTreeMap::new() }
            .message(name, text)
    };
    let definition = match space {
        InterfaceSpace::Msg => InterfaceDefinition::Message(part("")),
        InterfaceSpace::Srv => {
            let (request, response) = (part("Request"), part("Response"));
            InterfaceDefinition::Service(ServiceDefinition { name, request, response })
        }
        InterfaceSpace::Action => {
            let (goal, result, feedback) = (part("Goal"), part("Result"), part("Feedback"));
            InterfaceDefinition::Action(ActionDefinition { name, goal, result, feedback })
        }
    };
    (definition, faults.list)
}

/// The name of a part: ROS 1 appends a word, and keeps what an action is made of among the messages.
pub(crate) fn part_name(of: &InterfaceName, suffix: &str, version: RosVersion) -> InterfaceName {
    if suffix.is_empty() {
        return of.clone();
    }
    let (space, joint) = match (version, of.space) {
        (RosVersion::Ros1, InterfaceSpace::Action) => (InterfaceSpace::Msg, ""),
        (RosVersion::Ros1, space) => (space, ""),
        (RosVersion::Ros2, space) => (space, "_"),
    };
    InterfaceName::new(&of.package, space, format!("{}{joint}{suffix}", of.name))
}

/// The text, if it is not too long to be read.
fn bounded<'a>(source: DefinitionText<'a>, faults: &mut FaultList) -> &'a str {
    if source.text.len() <= MOST_BYTES {
        return source.text;
    }
    let kind = MessageFaultKind::TooMuch { what: "bytes of a definition", limit: MOST_BYTES as u64 };
    faults.say(kind.at(Span::new(source.file, source.start, source.start), "split it into several messages"));
    ""
}

/// What is said of one definition; beyond a limit only that there is more.
#[derive(Default)]
struct FaultList {
    list: Vec<MessageFault>,
}

impl FaultList {
    fn say(&mut self, fault: MessageFault) {
        if self.list.len() < MOST_FAULTS {
            self.list.push(fault);
        } else if self.list.len() == MOST_FAULTS {
            let kind = MessageFaultKind::TooMuch {
                what: "faults of a definition that are told",
                limit: MOST_FAULTS as u64,
            };
            self.list.push(kind.at(fault.span, "fix those before it first"));
        }
    }
}

/// The parts between the lines `---`, as many as the space has: what lies beyond is said and left out.
fn sections<'a>(
    text: PlacedText<'a>,
    space: InterfaceSpace,
    version: RosVersion,
    faults: &mut FaultList,
) -> Vec<PlacedText<'a>> {
    let (wanted, what, expected, help) = match space {
        InterfaceSpace::Msg => (1, "a message", "one part", "take the line out"),
        InterfaceSpace::Srv => (
            2,
            "a service",
            "two parts: a request, a response",
            "write one line `---` between request and response",
        ),
        InterfaceSpace::Action => (
            3,
            "an action",
            "three parts: a goal, a result, a feedback",
            "write a line `---` after the goal, and one after the result",
        ),
    };
    let is_border = |line: PlacedText<'_>| match version {
        RosVersion::Ros1 => line.text.starts_with("---"),
        RosVersion::Ros2 => line.text.trim_end() == "---",
    };
    let borders: Vec<PlacedText<'a>> = text.lines().filter(|line| is_border(*line)).collect();
    let wrong = |found: usize| {
        let found = if found == 1 { "one".to_owned() } else { found.to_string() };
        MessageFaultKind::WrongSections { what, expected, found }
    };
    if let Some(border) = borders.get(wanted - 1) {
        faults.say(wrong(borders.len() + 1).at(border.span(), help));
    } else if borders.len() + 1 < wanted {
        let end = text.text.trim_end().len();
        faults.say(wrong(borders.len() + 1).at(text.part(end, "").span(), help));
    }
    let mut parts = Vec::new();
    let mut start = text.at;
    let piece = |start: usize, end: usize| {
        let piece = text.text.get(start - text.at..end - text.at).unwrap_or_default();
        text.part(start - text.at, piece)
    };
    for border in borders.iter().take(wanted - 1) {
        parts.push(piece(start, border.at));
        let behind = text.text.get(border.at - text.at..).unwrap_or_default();
        start = behind.find('\n').map_or(text.at + text.text.len(), |n| border.at + n + 1);
    }
    let end = borders.get(wanted - 1).map_or(text.at + text.text.len(), |b| b.at);
    parts.push(piece(start, end));
    parts.resize(wanted, text.part(text.text.len(), ""));
    parts
}

/// Reads the lines of one message.
struct MessageParser<'a> {
    version: RosVersion,
    faults: &'a mut FaultList,
    /// What is declared so far, and where.
    names: BTreeMap<String, Span>,
}

impl MessageParser<'_> {
    fn message(mut self, name: InterfaceName, text: PlacedText<'_>) -> MessageDefinition {
        let mut message = MessageDefinition {
            name,
            constants: Vec::new(),
            fields: Vec::new(),
            text: text.text.to_owned(),
            span: text.span(),
        };
        for line in text.lines() {
            if self.names.len() > MOST_MEMBERS {
                let kind = MessageFaultKind::TooMuch {
                    what: "fields and constants of a message",
                    limit: MOST_MEMBERS as u64,
                };
                self.faults.say(kind.at(line.span(), "put some of them into a message of their own"));
                break;
            }
            self.line(line.trimmed(), &mut message);
        }
        message
    }

    fn line(&mut self, line: PlacedText<'_>, message: &mut MessageDefinition) {
        if line.is_empty() || line.text.starts_with('#') {
            return;
        }
        let (of, rest) = line.split_before(|c| c.is_whitespace() || c == '#');
        if of.text.starts_with("---") {
            let kind = MessageFaultKind::UnexpectedText(line.text.to_owned());
            return self.faults.say(kind.at(line.span(), "write `---` between two parts, alone on its line"));
        }
        let (name, rest) = rest.trimmed().split_before(|c| c.is_whitespace() || matches!(c, '=' | '#'));
        let rest = rest.trimmed();
        if name.is_empty() {
            let help = match of.text.split_once('=') {
                Some((name, value)) if !name.ends_with('<') => format!("write `int32 {name}={value}`"),
                Some(_) | None => "write `TYPE NAME`".to_owned(),
            };
            return self.faults.say(MessageFaultKind::MissingName(of.text.to_owned()).at(of.span(), help));
        }
        let read = read_type(of, &message.name.package, self.version).map_err(|fault| self.faults.say(fault));
        let Some(value) = rest.after("=") else {
            let default = without_comment(rest, self.version);
            return message.fields.extend(self.field(of, read.ok(), name, default));
        };
        message.constants.extend(self.constant(of, read.ok(), name, value));
    }

    fn field(
        &mut self,
        written: PlacedText<'_>,
        of: Option<MessageFieldType>,
        name: PlacedText<'_>,
        default: PlacedText<'_>,
    ) -> Option<MessageField> {
        let is_new = self.declare(NamedPart::Field, name);
        let of = of?;
        let default = if default.is_empty() { Ok(None) } else { self.default(&of, default).map(Some) };
        let default = default.map_err(|fault| self.faults.say(fault)).ok()?;
        is_new.then(|| MessageField {
            name: name.text.to_owned(),
            of,
            default,
            span: name.span(),
            type_span: written.span(),
        })
    }

    fn constant(
        &mut self,
        written: PlacedText<'_>,
        of: Option<MessageFieldType>,
        name: PlacedText<'_>,
        value: PlacedText<'_>,
    ) -> Option<MessageConstant> {
        let is_new = self.declare(NamedPart::Constant, name);
        let primitive = match of? {
            MessageFieldType { element: FieldElement::Primitive(p), count: ElementCount::One }
                if !matches!(p, PrimitiveType::Time | PrimitiveType::Duration) =>
            {
                p
            }
            MessageFieldType { .. } => {
                let kind = MessageFaultKind::ConstantType(written.text.to_owned());
                self.faults.say(kind.at(written.span(), "write `bool`, `string` or a type of numbers"));
                return None;
            }
        };
        // In ROS 1 a text is all the rest of its line.
        let is_rest = self.version == RosVersion::Ros1 && primitive.is_text();
        let value = if is_rest { value.trimmed() } else { without_comment(value, self.version) };
        let read = self.scalar(primitive, value).map_err(|fault| self.faults.say(fault)).ok()?;
        is_new.then(|| MessageConstant {
            name: name.text.to_owned(),
            of: primitive,
            value: read,
            written: value.text.to_owned(),
            span: name.span(),
        })
    }

    /// Whether the name is one, and new.
    fn declare(&mut self, part: NamedPart, name: PlacedText<'_>) -> bool {
        if let Some(rule) = part.broken_rule(self.version, name.text) {
            let kind = MessageFaultKind::BadName { part: part.noun(), name: name.text.to_owned() };
            self.faults.say(kind.at(name.span(), rule));
            return false;
        }
        if let Some(first) = self.names.get(name.text) {
            let kind = MessageFaultKind::DuplicateName(name.text.to_owned());
            self.faults.say(kind.at(name.span(), "give one of them another name").repeats(*first));
            return false;
        }
        self.names.insert(name.text.to_owned(), name.span());
        true
    }

    fn default(&self, of: &MessageFieldType, text: PlacedText<'_>) -> Result<MessageValue, MessageFault> {
        if self.version == RosVersion::Ros1 {
            let kind = MessageFaultKind::UnexpectedText(text.text.to_owned());
            let help =
                "begin a comment with `#`; a constant is `TYPE NAME=VALUE`, and defaults are of ROS 2 alone";
            return Err(kind.at(text.span(), help));
        }
        let (primitive, most) = match of.element {
            FieldElement::Primitive(primitive) => (primitive, None),
            FieldElement::BoundedText(primitive, most) => (primitive, Some(most)),
            FieldElement::Message(_) => {
                let kind = MessageFaultKind::DefaultOfMessage(of.written(self.version));
                return Err(kind.at(text.span(), "take the value out: only primitive types have defaults"));
            }
        };
        let value = |text| self.element(primitive, most, text);
        if of.count == ElementCount::One {
            return value(text);
        }
        let pieces = list_pieces(text.text).ok_or_else(|| {
            let of = of.written(self.version);
            MessageFaultKind::BadValue { value: text.text.to_owned(), of }.at(text.span(), "write `[1, 2]`")
        })?;
        let found = pieces.len() as u64;
        let help = match of.count {
            ElementCount::Exactly(n) if found != u64::from(n) => Some(format!("write {n} values")),
            ElementCount::AtMost(n) if found > u64::from(n) => Some(format!("write at most {n} values")),
            ElementCount::One | ElementCount::Any | ElementCount::Exactly(_) | ElementCount::AtMost(_) => {
                None
            }
        };
        if let Some(help) = help {
            let (value, of) = (format!("a list of {found}"), of.written(self.version));
            return Err(MessageFaultKind::ValueOutOfRange { value, of }.at(text.span(), help));
        }
        let values = pieces.into_iter().map(|(at, piece)| value(text.part(at, piece).trimmed()));
        values.collect::<Result<_, _>>().map(MessageValue::List)
    }

    /// A value of a field, whose text may have a bound.
    fn element(
        &self,
        of: PrimitiveType,
        most: Option<u32>,
        text: PlacedText<'_>,
    ) -> Result<MessageValue, MessageFault> {
        let value = self.scalar(of, text)?;
        if let (MessageValue::Text(inner), Some(most)) = (&value, most)
            && inner.chars().count() as u64 > u64::from(most)
        {
            let (value, of) = (text.text.to_owned(), format!("{}<={most}", of.word()));
            let kind = MessageFaultKind::ValueOutOfRange { value, of };
            return Err(kind.at(text.span(), format!("write at most {most} characters")));
        }
        Ok(value)
    }

    fn scalar(&self, of: PrimitiveType, text: PlacedText<'_>) -> Result<MessageValue, MessageFault> {
        let (value, word) = (text.text.to_owned(), of.word().to_owned());
        read_value(of, text.text, self.version).map_err(|problem| match problem {
            ValueProblem::NotOne(help) => {
                let kind = MessageFaultKind::BadValue { value, of: word };
                kind.at(text.span(), format!("write {help}"))
            }
            ValueProblem::OutOfRange(least, greatest) => {
                let kind = MessageFaultKind::ValueOutOfRange { value, of: word };
                kind.at(text.span(), format!("write a value from {least} to {greatest}"))
            }
        })
    }
}

/// Up to the comment; in ROS 2 a `#` in quotes begins none.
fn without_comment(text: PlacedText<'_>, version: RosVersion) -> PlacedText<'_> {
    let mut quotes = QuoteScan::default();
    let mut begins_comment = |c: char| match version {
        RosVersion::Ros1 => c == '#',
        RosVersion::Ros2 => !quotes.is_inside_after(c) && c == '#',
    };
    let end =
        text.text.char_indices().find(|(_, c)| begins_comment(*c)).map_or(text.text.len(), |(at, _)| at);
    text.part(0, text.text.get(..end).unwrap_or(text.text)).trimmed()
}
