//! Of which single values a message consists, and its text with all of them at their defaults.

use hrdsl_ir::binding::{MessageScalar, MessageStep};
use hrdsl_messages::{
    ElementCount, FieldElement, InterfaceName, MessageField, MessageLibrary, PrimitiveType, RosVersion,
};

/// The most single values that a message may have to be bound.
const MOST_SCALARS: usize = 100_000;

/// A message, taken apart.
#[derive(Debug)]
pub(super) struct MessageShape {
    pub fields: Vec<(String, FieldShape)>,
}

/// What a field holds.
#[derive(Debug)]
pub(super) enum FieldShape {
    /// One value, with its default as JSON.
    Scalar(MessageScalar, String),
    Message(MessageShape),
    /// As many as there are.
    Array(Vec<FieldShape>),
    /// Any number of them; empty at first. Of numbers, or of something else.
    Sequence {
        numbers: bool,
    },
}

impl MessageShape {
    /// `None`: it is too large.
    pub fn new(library: &MessageLibrary, name: &InterfaceName) -> Option<Self> {
        let mut left = MOST_SCALARS;
        shape(library, name, &mut left)
    }

    /// What lies at a place.
    pub fn at(&self, path: &[MessageStep]) -> Option<&FieldShape> {
        let (first, rest) = path.split_first()?;
        let MessageStep::Field(name) = first else { return None };
        let field = self.fields.iter().find(|(n, _)| n == name).map(|(_, shape)| shape)?;
        field.at(rest)
    }

    /// All single values, with their places.
    pub fn scalars(&self) -> Vec<(Vec<MessageStep>, MessageScalar)> {
        let mut all = Vec::new();
        self.collect(&mut Vec::new(), &mut all);
        all
    }

    fn collect(&self, path: &mut Vec<MessageStep>, all: &mut Vec<(Vec<MessageStep>, MessageScalar)>) {
        for (name, field) in &self.fields {
            path.push(MessageStep::Field(name.clone()));
            field.collect(path, all);
            path.pop();
        }
    }

    /// JSON, with what `gap` gives at its places left out: the text before the first of them goes with it, and so on.
    pub fn text(&self, gap: &mut dyn FnMut(&[MessageStep]) -> bool) -> Vec<String> {
        let mut pieces = vec![String::new()];
        self.write(&mut Vec::new(), gap, &mut pieces);
        pieces
    }

    fn write(
        &self,
        path: &mut Vec<MessageStep>,
        gap: &mut dyn FnMut(&[MessageStep]) -> bool,
        pieces: &mut Vec<String>,
    ) {
        add(pieces, "{");
        for (at, (name, field)) in self.fields.iter().enumerate() {
            let comma = if at > 0 { "," } else { "" };
            add(pieces, &format!("{comma}\"{name}\":"));
            path.push(MessageStep::Field(name.clone()));
            field.write(path, gap, pieces);
            path.pop();
        }
        add(pieces, "}");
    }
}

fn add(pieces: &mut [String], text: &str) {
    if let Some(last) = pieces.last_mut() {
        last.push_str(text);
    }
}

impl FieldShape {
    fn at(&self, path: &[MessageStep]) -> Option<&FieldShape> {
        match (path.split_first(), self) {
            (None, _) => Some(self),
            (Some((MessageStep::Field(_), _)), FieldShape::Message(message)) => message.at(path),
            (Some((MessageStep::Element(at), rest)), FieldShape::Array(elements)) => {
                elements.get(usize::try_from(*at).ok()?)?.at(rest)
            }
            (Some(_), _) => None,
        }
    }

    fn collect(&self, path: &mut Vec<MessageStep>, all: &mut Vec<(Vec<MessageStep>, MessageScalar)>) {
        match self {
            FieldShape::Scalar(scalar, _) => all.push((path.clone(), *scalar)),
            FieldShape::Message(message) => message.collect(path, all),
            FieldShape::Array(elements) => {
                for (at, element) in (0u32..).zip(elements) {
                    path.push(MessageStep::Element(at));
                    element.collect(path, all);
                    path.pop();
                }
            }
            FieldShape::Sequence { .. } => {}
        }
    }

    fn write(
        &self,
        path: &mut Vec<MessageStep>,
        gap: &mut dyn FnMut(&[MessageStep]) -> bool,
        pieces: &mut Vec<String>,
    ) {
        if gap(path) {
            pieces.push(String::new());
            return;
        }
        match self {
            FieldShape::Scalar(_, default) => add(pieces, default),
            FieldShape::Message(message) => message.write(path, gap, pieces),
            FieldShape::Array(elements) => {
                add(pieces, "[");
                for (at, element) in (0u32..).zip(elements) {
                    add(pieces, if at > 0 { "," } else { "" });
                    path.push(MessageStep::Element(at));
                    element.write(path, gap, pieces);
                    path.pop();
                }
                add(pieces, "]");
            }
            FieldShape::Sequence { .. } => add(pieces, "[]"),
        }
    }
}

fn shape(library: &MessageLibrary, name: &InterfaceName, left: &mut usize) -> Option<MessageShape> {
    let definition = &library.message(name)?.definition;
    let field = |f: &MessageField| Some((f.name.clone(), field_shape(library, f, left)?));
    Some(MessageShape { fields: definition.fields.iter().map(field).collect::<Option<_>>()? })
}

fn field_shape(library: &MessageLibrary, field: &MessageField, left: &mut usize) -> Option<FieldShape> {
    let numbers = match &field.of.element {
        FieldElement::Primitive(primitive) => {
            !primitive.is_text() && !matches!(primitive, PrimitiveType::Time | PrimitiveType::Duration)
        }
        FieldElement::BoundedText(..) | FieldElement::Message(_) => false,
    };
    match field.of.count {
        ElementCount::Any | ElementCount::AtMost(_) => Some(FieldShape::Sequence { numbers }),
        ElementCount::Exactly(n) => {
            let elements = (0..n).map(|_| element_shape(library, field, left));
            Some(FieldShape::Array(elements.collect::<Option<_>>()?))
        }
        ElementCount::One => {
            let default = field.default.as_ref().and_then(|d| serde_json::to_string(d).ok());
            match (element_shape(library, field, left)?, default) {
                (FieldShape::Scalar(scalar, _), Some(default)) => Some(FieldShape::Scalar(scalar, default)),
                (shape, _) => Some(shape),
            }
        }
    }
}

fn element_shape(library: &MessageLibrary, field: &MessageField, left: &mut usize) -> Option<FieldShape> {
    *left = left.checked_sub(1)?;
    let version = library.version();
    Some(match &field.of.element {
        FieldElement::Primitive(primitive) => {
            let (scalar, default) = scalar(*primitive, version);
            FieldShape::Scalar(scalar, default.to_owned())
        }
        FieldElement::BoundedText(..) => FieldShape::Scalar(MessageScalar::Text, "\"\"".to_owned()),
        FieldElement::Message(name) if is_time(name) => {
            FieldShape::Scalar(MessageScalar::Time, "{\"sec\":0,\"nanosec\":0}".to_owned())
        }
        FieldElement::Message(name) => FieldShape::Message(shape(library, name, left)?),
    })
}

/// In ROS 2 a time is a message.
fn is_time(name: &InterfaceName) -> bool {
    name.package == "builtin_interfaces" && matches!(name.name.as_str(), "Time" | "Duration")
}

fn scalar(primitive: PrimitiveType, version: RosVersion) -> (MessageScalar, &'static str) {
    if let Some((lo, hi)) = primitive.range(version) {
        let clamp = |n: i128| i64::try_from(n).unwrap_or(if n < 0 { i64::MIN } else { i64::MAX });
        return (MessageScalar::Int { lo: clamp(lo), hi: clamp(hi) }, "0");
    }
    match primitive {
        PrimitiveType::Bool => (MessageScalar::Bool, "false"),
        PrimitiveType::String | PrimitiveType::WideString => (MessageScalar::Text, "\"\""),
        PrimitiveType::Time | PrimitiveType::Duration => (MessageScalar::Time, "{\"secs\":0,\"nsecs\":0}"),
        PrimitiveType::Float32
        | PrimitiveType::Float64
        | PrimitiveType::Byte
        | PrimitiveType::Char
        | PrimitiveType::Int8
        | PrimitiveType::Uint8
        | PrimitiveType::Int16
        | PrimitiveType::Uint16
        | PrimitiveType::Int32
        | PrimitiveType::Uint32
        | PrimitiveType::Int64
        | PrimitiveType::Uint64 => (MessageScalar::Float, "0.0"),
    }
}
