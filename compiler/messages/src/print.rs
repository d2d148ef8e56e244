//! Writing a definition, so that it reads as the same: without comments, with the packages of all types.

use std::fmt::Write as _;

use crate::{
    definition::{ActionDefinition, MessageDefinition, ServiceDefinition},
    name::RosVersion,
    parse::InterfaceDefinition,
};

impl MessageDefinition {
    /// The lines of a `.msg`: the constants, then the fields.
    #[must_use]
    pub fn written(&self, version: RosVersion) -> String {
        let mut text = String::new();
        for constant in &self.constants {
            let value = constant.value.written(version);
            // Writing into a text never fails.
            let _ = writeln!(text, "{} {}={value}", constant.of.word(), constant.name);
        }
        for field in &self.fields {
            let default = field.default.as_ref().map(|d| format!(" {}", d.written(version)));
            let _ =
                writeln!(text, "{} {}{}", field.of.written(version), field.name, default.unwrap_or_default());
        }
        text
    }
}

impl InterfaceDefinition {
    /// The text of its file.
    #[must_use]
    pub fn written(&self, version: RosVersion) -> String {
        let parts = match self {
            Self::Message(message) => vec![message],
            Self::Service(ServiceDefinition { request, response, .. }) => vec![request, response],
            Self::Action(ActionDefinition { goal, result, feedback, .. }) => vec![goal, result, feedback],
        };
        let parts: Vec<String> = parts.into_iter().map(|part| part.written(version)).collect();
        parts.join("---\n")
    }
}
