//! The table that a client builds its classes from: plain data, made for JSON. `spec/messages.md` says what each key means.

use serde::Serialize;

use crate::{
    definition::{ElementCount, FieldElement, MessageDefinition},
    implied::ActionInterfaces,
    name::{InterfaceName, InterfaceSpace, RosVersion},
    value::MessageValue,
};

/// Everything that a set of interfaces needs. Two tables of the same definitions are the same text.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InterfaceTable {
    pub version: u32,
    /// 1 or 2.
    pub ros: u8,
    /// Each after those that it holds.
    pub messages: Vec<MessageRow>,
    /// In the order of their names.
    pub services: Vec<ServiceRow>,
    pub actions: Vec<ActionRow>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MessageRow {
    pub name: String,
    /// The Python module that has its class is `package.space`.
    pub package: String,
    pub space: InterfaceSpace,
    pub constants: Vec<ConstantRow>,
    pub fields: Vec<FieldRow>,
    /// Its own definition.
    pub text: String,
    /// The messages in it, and those in them, in the order of the full text.
    pub holds: Vec<String>,
    /// In ROS 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub md5: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConstantRow {
    pub name: String,
    #[serde(rename = "type")]
    pub of: String,
    pub value: MessageValue,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FieldRow {
    pub name: String,
    /// A primitive type, or the name of a message, which has a `/`.
    #[serde(rename = "type")]
    pub of: String,
    /// Of a bounded string.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub characters: Option<u32>,
    /// Of more than one value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub array: Option<ArrayRow>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub default: Option<MessageValue>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ArrayRow {
    Any,
    Exactly(u32),
    AtMost(u32),
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ServiceRow {
    pub name: String,
    pub request: String,
    pub response: String,
    /// In ROS 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub md5: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ActionRow {
    pub name: String,
    pub goal: String,
    pub result: String,
    pub feedback: String,
    #[serde(flatten)]
    pub served: ServedAction,
}

/// By which interfaces an action is served.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum ServedAction {
    Ros1 {
        action: String,
        action_goal: String,
        action_result: String,
        action_feedback: String,
        cancel: String,
        status: String,
    },
    Ros2 {
        send_goal: String,
        get_result: String,
        feedback_message: String,
        cancel: String,
        status: String,
    },
}

impl InterfaceTable {
    /// Of the format. It changes when a key goes or means something else.
    pub const VERSION: u32 = 1;
}

impl MessageRow {
    pub(crate) fn new(
        message: &MessageDefinition,
        version: RosVersion,
        holds: Vec<String>,
        md5: Option<String>,
    ) -> Self {
        let constants = message.constants.iter().map(|constant| ConstantRow {
            name: constant.name.clone(),
            of: constant.of.word().to_owned(),
            value: constant.value.clone(),
        });
        let fields = message.fields.iter().map(|field| {
            let (of, characters) = match &field.of.element {
                FieldElement::Primitive(primitive) => (primitive.word().to_owned(), None),
                FieldElement::BoundedText(primitive, most) => (primitive.word().to_owned(), Some(*most)),
                FieldElement::Message(name) => (name.written(version), None),
            };
            let array = match field.of.count {
                ElementCount::One => None,
                ElementCount::Any => Some(ArrayRow::Any),
                ElementCount::Exactly(number) => Some(ArrayRow::Exactly(number)),
                ElementCount::AtMost(number) => Some(ArrayRow::AtMost(number)),
            };
            FieldRow { name: field.name.clone(), of, characters, array, default: field.default.clone() }
        });
        Self {
            name: message.name.written(version),
            package: message.name.package.clone(),
            space: message.name.space,
            constants: constants.collect(),
            fields: fields.collect(),
            text: message.text.clone(),
            holds,
            md5,
        }
    }
}

impl ServedAction {
    pub(crate) fn new(interfaces: &ActionInterfaces) -> Self {
        match interfaces {
            ActionInterfaces::Ros1 {
                action,
                action_goal,
                action_result,
                action_feedback,
                cancel,
                status,
            } => {
                let written = |name: &InterfaceName| name.written(RosVersion::Ros1);
                Self::Ros1 {
                    action: written(action),
                    action_goal: written(action_goal),
                    action_result: written(action_result),
                    action_feedback: written(action_feedback),
                    cancel: written(cancel),
                    status: written(status),
                }
            }
            ActionInterfaces::Ros2 { send_goal, get_result, feedback_message, cancel, status } => {
                let written = |name: &InterfaceName| name.written(RosVersion::Ros2);
                Self::Ros2 {
                    send_goal: written(send_goal),
                    get_result: written(get_result),
                    feedback_message: written(feedback_message),
                    cancel: written(cancel),
                    status: written(status),
                }
            }
        }
    }
}
