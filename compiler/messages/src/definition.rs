//! What a definition says: the fields and constants of messages, and the messages of services and actions.

use hrdsl_source::Span;

use crate::{name::InterfaceName, primitive::PrimitiveType, value::MessageValue};

/// A message: what a `.msg` defines, or a part of a `.srv` or `.action`, or what is implied by one.
#[derive(Clone, Debug, PartialEq)]
pub struct MessageDefinition {
    pub name: InterfaceName,
    /// In the order of the text, as are the fields.
    pub constants: Vec<MessageConstant>,
    pub fields: Vec<MessageField>,
    /// As it is written, with its comments.
    pub text: String,
    /// That text's place; of what is implied, the place of what implies it.
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq)]
pub struct MessageField {
    pub name: String,
    pub of: MessageFieldType,
    /// In ROS 2; of a primitive type only.
    pub default: Option<MessageValue>,
    /// Of the name.
    pub span: Span,
    /// Of the type.
    pub type_span: Span,
}

#[derive(Clone, Debug, PartialEq)]
pub struct MessageConstant {
    pub name: String,
    pub of: PrimitiveType,
    pub value: MessageValue,
    /// The value as it is written: ROS 1 sums this text, not the value.
    pub written: String,
    /// Of the name.
    pub span: Span,
}

/// What a field holds: how many of what.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MessageFieldType {
    pub element: FieldElement,
    pub count: ElementCount,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FieldElement {
    Primitive(PrimitiveType),
    /// `string<=10`, `wstring<=10`: the type, and its most characters.
    BoundedText(PrimitiveType, u32),
    Message(InterfaceName),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElementCount {
    One,
    /// `T[]`
    Any,
    /// `T[N]`
    Exactly(u32),
    /// `T[<=N]`
    AtMost(u32),
}

/// What a `.srv` defines.
#[derive(Clone, Debug, PartialEq)]
pub struct ServiceDefinition {
    pub name: InterfaceName,
    pub request: MessageDefinition,
    pub response: MessageDefinition,
}

/// What an `.action` defines.
#[derive(Clone, Debug, PartialEq)]
pub struct ActionDefinition {
    pub name: InterfaceName,
    pub goal: MessageDefinition,
    pub result: MessageDefinition,
    pub feedback: MessageDefinition,
}

impl MessageDefinition {
    /// The messages that it holds, each once, in the order of its fields.
    pub fn embedded(&self) -> impl Iterator<Item = &InterfaceName> {
        let mut seen = Vec::new();
        self.fields.iter().filter_map(|f| f.of.message()).filter(move |name| {
            let is_new = !seen.contains(name);
            if is_new {
                seen.push(*name);
            }
            is_new
        })
    }
}

impl MessageFieldType {
    /// The message that it is made of.
    #[must_use]
    pub fn message(&self) -> Option<&InterfaceName> {
        match &self.element {
            FieldElement::Message(name) => Some(name),
            FieldElement::Primitive(_) | FieldElement::BoundedText(..) => None,
        }
    }
}
