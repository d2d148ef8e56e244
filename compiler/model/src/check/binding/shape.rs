//! Of which single values a message consists, and its text with all of them at their defaults.

use hrdsl_ir::binding::{MessageScalar, MessageStep};
use hrdsl_messages::{
    ElementCount, FieldElement, InterfaceName, MessageField, MessageLibrary, PrimitiveType, RosVersion,
};

/// The most single values that a message may have to be bound.
const MOST_SCALARS: usize = 100_000;

/// A message, taken apart.
#[derive(Debug, Default)]
pub(super) struct MessageShape {
    /// `None`: there is no message.
    pub interface: Option<InterfaceName>,
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
    /// Any number of these, or at most so many; empty at first.
    Sequence {
        of: Box<FieldShape>,
        most: Option<u32>,
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

    /// All single values that are named by fields alone, with their places.
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

    /// JSON, with what is a gap left out: the text before the first of them goes with it, and so on.
    pub fn text(&self, gaps: &mut dyn MessageGaps) -> Vec<String> {
        let mut pieces = vec![String::new()];
        self.write(&mut Vec::new(), gaps, &mut pieces);
        pieces
    }

    fn write(&self, path: &mut Vec<MessageStep>, gaps: &mut dyn MessageGaps, pieces: &mut Vec<String>) {
        add(pieces, "{");
        for (at, (name, field)) in self.fields.iter().enumerate() {
            let comma = if at > 0 { "," } else { "" };
            add(pieces, &format!("{comma}\"{name}\":"));
            path.push(MessageStep::Field(name.clone()));
            field.write(path, gaps, pieces);
            path.pop();
        }
        add(pieces, "}");
    }
}

/// Where the text of a message has gaps.
pub(super) trait MessageGaps {
    /// Whether there is one at this place; asked once for each, in the order of the text.
    fn is_gap(&mut self, path: &[MessageStep]) -> bool;
    /// How many elements are written of the sequence at this place.
    fn length(&self, path: &[MessageStep]) -> u32;
}

/// The text of a message, or of a part of one, without gaps.
struct NoGaps;

impl MessageGaps for NoGaps {
    fn is_gap(&mut self, _: &[MessageStep]) -> bool {
        false
    }

    fn length(&self, _: &[MessageStep]) -> u32 {
        0
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
            (Some((MessageStep::Element(_), rest)), FieldShape::Sequence { of, .. }) => of.at(rest),
            (Some(_), _) => None,
        }
    }

    fn collect(&self, path: &mut Vec<MessageStep>, all: &mut Vec<(Vec<MessageStep>, MessageScalar)>) {
        match self {
            FieldShape::Scalar(scalar, _) => all.push((path.clone(), *scalar)),
            FieldShape::Message(message) => message.collect(path, all),
            FieldShape::Array(_) | FieldShape::Sequence { .. } => {}
        }
    }

    /// JSON, with all values at their defaults.
    pub fn default_text(&self) -> String {
        let mut pieces = vec![String::new()];
        self.write(&mut Vec::new(), &mut NoGaps, &mut pieces);
        pieces.concat()
    }

    /// The last index that an element can have; `None`: it has no elements.
    pub fn last_index(&self) -> Option<i64> {
        match self {
            FieldShape::Array(elements) => i64::try_from(elements.len()).ok().map(|n| n - 1),
            FieldShape::Sequence { most, .. } => Some(i64::from(most.unwrap_or(u32::MAX)) - 1),
            FieldShape::Scalar(..) | FieldShape::Message(_) => None,
        }
    }

    /// Whether all that it holds are numbers, in a row.
    pub fn is_numbers(&self) -> bool {
        let is_number = |shape: &FieldShape| {
            matches!(shape, FieldShape::Scalar(MessageScalar::Float | MessageScalar::Int { .. }, _))
        };
        match self {
            FieldShape::Array(elements) => elements.iter().all(is_number),
            FieldShape::Sequence { of, .. } => is_number(of),
            FieldShape::Scalar(..) | FieldShape::Message(_) => false,
        }
    }

    fn write(&self, path: &mut Vec<MessageStep>, gaps: &mut dyn MessageGaps, pieces: &mut Vec<String>) {
        if gaps.is_gap(path) {
            pieces.push(String::new());
            return;
        }
        match self {
            FieldShape::Array(elements) => write_row(elements.iter(), path, gaps, pieces),
            FieldShape::Sequence { of, .. } => {
                let length = usize::try_from(gaps.length(path)).unwrap_or(usize::MAX);
                write_row(std::iter::repeat_n(&**of, length), path, gaps, pieces);
            }
            FieldShape::Scalar(_, default) => add(pieces, default),
            FieldShape::Message(message) => message.write(path, gaps, pieces),
        }
    }
}

fn write_row<'s>(
    elements: impl Iterator<Item = &'s FieldShape>,
    path: &mut Vec<MessageStep>,
    gaps: &mut dyn MessageGaps,
    pieces: &mut Vec<String>,
) {
    add(pieces, "[");
    for (at, element) in (0u32..).zip(elements) {
        add(pieces, if at > 0 { "," } else { "" });
        path.push(MessageStep::Element(at));
        element.write(path, gaps, pieces);
        path.pop();
    }
    add(pieces, "]");
}

fn shape(library: &MessageLibrary, name: &InterfaceName, left: &mut usize) -> Option<MessageShape> {
    let definition = &library.message(name)?.definition;
    let field = |f: &MessageField| Some((f.name.clone(), field_shape(library, f, left)?));
    let fields = definition.fields.iter().map(field).collect::<Option<_>>()?;
    Some(MessageShape { interface: Some(name.clone()), fields })
}

fn field_shape(library: &MessageLibrary, field: &MessageField, left: &mut usize) -> Option<FieldShape> {
    let mut sequence =
        |most| Some(FieldShape::Sequence { of: Box::new(element_shape(library, field, left)?), most });
    match field.of.count {
        ElementCount::Any => sequence(None),
        ElementCount::AtMost(most) => sequence(Some(most)),
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
