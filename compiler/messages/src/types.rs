//! The type of a field, as it is written: `float32[36]`, `string<=10[<=5]`, `geometry_msgs/Pose[]`.

use crate::{
    definition::{ElementCount, FieldElement, MessageFieldType},
    fault::{MessageFault, MessageFaultKind},
    name::{InterfaceName, InterfaceSpace, NamedPart, RosVersion, is_identifier},
    placed::PlacedText,
    primitive::PrimitiveType,
};

/// The package that every message's header comes from, in ROS 1 even where `Header` stands alone.
const HEADER: (&str, &str) = ("std_msgs", "Header");

/// Reads a type; a message without a package is one of `package`.
pub(crate) fn read_type(
    written: PlacedText<'_>,
    package: &str,
    version: RosVersion,
) -> Result<MessageFieldType, MessageFault> {
    let (element, array) = written.split_before(|c| c == '[');
    let count = if array.is_empty() { ElementCount::One } else { read_count(written, array, version)? };
    Ok(MessageFieldType { element: read_element(element, package, version)?, count })
}

fn malformed(written: PlacedText<'_>, help: &str) -> MessageFault {
    MessageFaultKind::MalformedType(written.text.to_owned()).at(written.span(), help)
}

fn read_count(
    written: PlacedText<'_>,
    array: PlacedText<'_>,
    version: RosVersion,
) -> Result<ElementCount, MessageFault> {
    let help = match version {
        RosVersion::Ros1 => "write `TYPE[]` for any number of elements, or `TYPE[3]`, without blanks",
        RosVersion::Ros2 => "write `TYPE[]`, `TYPE[3]` or `TYPE[<=3]`, without blanks",
    };
    let inner = array.text.strip_prefix('[').and_then(|a| a.strip_suffix(']'));
    let inner = inner.ok_or_else(|| malformed(written, help))?;
    if inner.is_empty() {
        return Ok(ElementCount::Any);
    }
    let (is_bound, digits) = match inner.strip_prefix("<=") {
        Some(digits) => (true, digits),
        None => (false, inner),
    };
    let number = read_count_number(digits).ok_or_else(|| malformed(written, help))?;
    match (is_bound, version) {
        (false, _) => Ok(ElementCount::Exactly(number)),
        (true, RosVersion::Ros2) => Ok(ElementCount::AtMost(number)),
        (true, RosVersion::Ros1) => {
            let kind = MessageFaultKind::OtherVersion { what: "bounds of arrays", version };
            Err(kind.at(array.span(), "write `[]`"))
        }
    }
}

/// From 1: an array of nothing would be no field.
fn read_count_number(digits: &str) -> Option<u32> {
    let is_number = digits.starts_with(|c: char| c.is_ascii_digit() && c != '0');
    digits.parse().ok().filter(|_| is_number)
}

fn read_element(
    written: PlacedText<'_>,
    package: &str,
    version: RosVersion,
) -> Result<FieldElement, MessageFault> {
    let (word, bound) = written.split_before(|c| c == '<');
    let primitive = PrimitiveType::of_word(word.text);
    if !bound.is_empty() {
        return read_bound(written, primitive, bound, version);
    }
    match primitive {
        Some(primitive) if primitive.is_in(version) => Ok(FieldElement::Primitive(primitive)),
        Some(other) => Err(of_other_version(other, word, version)),
        None => read_reference(word, package, version).map(FieldElement::Message),
    }
}

fn of_other_version(primitive: PrimitiveType, word: PlacedText<'_>, version: RosVersion) -> MessageFault {
    let (what, help) = match primitive {
        PrimitiveType::Time => ("primitive type `time`", "write `builtin_interfaces/Time`"),
        PrimitiveType::Duration => ("primitive type `duration`", "write `builtin_interfaces/Duration`"),
        PrimitiveType::WideString => ("type `wstring`", "write `string`, which holds UTF-8"),
        PrimitiveType::Bool | PrimitiveType::Byte | PrimitiveType::Char => ("such type", "write `uint8`"),
        PrimitiveType::Int8 | PrimitiveType::Int16 | PrimitiveType::Int32 => ("such type", "write `int64`"),
        PrimitiveType::Uint8 | PrimitiveType::Uint16 | PrimitiveType::Uint32 => {
            ("such type", "write `uint64`")
        }
        PrimitiveType::Int64 | PrimitiveType::Uint64 => ("such type", "write `float64`"),
        PrimitiveType::Float32 | PrimitiveType::Float64 | PrimitiveType::String => {
            ("such type", "write `string`")
        }
    };
    MessageFaultKind::OtherVersion { what, version }.at(word.span(), help)
}

fn read_bound(
    written: PlacedText<'_>,
    primitive: Option<PrimitiveType>,
    bound: PlacedText<'_>,
    version: RosVersion,
) -> Result<FieldElement, MessageFault> {
    let help = "only strings have bounds: write `string<=10`, without blanks";
    let most = bound.text.strip_prefix("<=").and_then(read_count_number);
    let (Some(primitive), Some(most)) = (primitive.filter(|p| p.is_text()), most) else {
        return Err(malformed(written, help));
    };
    match version {
        RosVersion::Ros2 => Ok(FieldElement::BoundedText(primitive, most)),
        RosVersion::Ros1 => {
            let kind = MessageFaultKind::OtherVersion { what: "bounds of strings", version };
            Err(kind.at(bound.span(), "write `string`"))
        }
    }
}

fn read_reference(
    written: PlacedText<'_>,
    package: &str,
    version: RosVersion,
) -> Result<InterfaceName, MessageFault> {
    let help = match version {
        RosVersion::Ros1 => "write a primitive type such as `float32`, or `PACKAGE/NAME`",
        RosVersion::Ros2 => {
            "write a primitive type such as `float32`, or `PACKAGE/NAME` or `PACKAGE/msg/NAME`"
        }
    };
    let is_long =
        written.text.split('/').any(|part| NamedPart::Package.broken_rule(RosVersion::Ros1, part).is_some());
    if is_long {
        return Err(malformed(written, help));
    }
    if is_identifier(written.text) {
        let is_header = version == RosVersion::Ros1 && written.text == HEADER.1;
        return Ok(InterfaceName::message(if is_header { HEADER.0 } else { package }, written.text));
    }
    let read = InterfaceName::read(written.text, InterfaceSpace::Msg);
    let read = read.filter(|_| version == RosVersion::Ros2 || written.text.matches('/').count() == 1);
    read.ok_or_else(|| malformed(written, help))
}

impl FieldElement {
    /// As it is written in a definition, a message with its package.
    #[must_use]
    pub fn written(&self, version: RosVersion) -> String {
        match self {
            Self::Primitive(primitive) => primitive.word().to_owned(),
            Self::BoundedText(primitive, most) => format!("{}<={most}", primitive.word()),
            Self::Message(name) => name.in_field(version),
        }
    }
}

impl ElementCount {
    /// As it is written behind the type of the elements.
    #[must_use]
    pub fn written(self) -> String {
        match self {
            Self::One => String::new(),
            Self::Any => "[]".to_owned(),
            Self::Exactly(number) => format!("[{number}]"),
            Self::AtMost(number) => format!("[<={number}]"),
        }
    }
}

impl MessageFieldType {
    /// As it is written in a definition.
    #[must_use]
    pub fn written(&self, version: RosVersion) -> String {
        self.element.written(version) + &self.count.written()
    }
}
