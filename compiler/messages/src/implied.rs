//! What services and actions imply: the messages and services that ROS's generators make of them.

use hrdsl_source::Span;

use crate::{
    definition::{
        ActionDefinition, ElementCount, FieldElement, MessageDefinition, MessageField, MessageFieldType,
        ServiceDefinition,
    },
    name::{InterfaceName, InterfaceSpace, RosVersion},
    parse::part_name,
    primitive::PrimitiveType,
};

/// A field of what is implied: its name, and what it holds.
type ImpliedField = (&'static str, FieldElement);

/// The names of all that an action is on the wire.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ActionInterfaces {
    /// Five topics: goal and cancel to the server; status, feedback and result from it.
    Ros1 {
        action: InterfaceName,
        action_goal: InterfaceName,
        action_result: InterfaceName,
        action_feedback: InterfaceName,
        /// `actionlib_msgs/GoalID`
        cancel: InterfaceName,
        /// `actionlib_msgs/GoalStatusArray`
        status: InterfaceName,
    },
    /// Three services and two topics.
    Ros2 {
        send_goal: InterfaceName,
        get_result: InterfaceName,
        feedback_message: InterfaceName,
        /// `action_msgs/srv/CancelGoal`
        cancel: InterfaceName,
        /// `action_msgs/msg/GoalStatusArray`
        status: InterfaceName,
    },
}

impl ActionInterfaces {
    /// Those of an action.
    #[must_use]
    pub fn of(action: &InterfaceName, version: RosVersion) -> Self {
        let part = |suffix| part_name(action, suffix, version);
        match version {
            RosVersion::Ros1 => Self::Ros1 {
                action: part("Action"),
                action_goal: part("ActionGoal"),
                action_result: part("ActionResult"),
                action_feedback: part("ActionFeedback"),
                cancel: InterfaceName::message("actionlib_msgs", "GoalID"),
                status: InterfaceName::message("actionlib_msgs", "GoalStatusArray"),
            },
            RosVersion::Ros2 => Self::Ros2 {
                send_goal: part("SendGoal"),
                get_result: part("GetResult"),
                feedback_message: part("FeedbackMessage"),
                cancel: InterfaceName::new("action_msgs", InterfaceSpace::Srv, "CancelGoal"),
                status: InterfaceName::message("action_msgs", "GoalStatusArray"),
            },
        }
    }
}

/// The messages and services that an action implies, besides those of its three parts.
pub(crate) fn implied_by(
    action: &ActionDefinition,
    version: RosVersion,
) -> (Vec<MessageDefinition>, Vec<ServiceDefinition>) {
    let span = action.goal.span.to(action.feedback.span);
    let message = |name, fields: Vec<ImpliedField>| implied_message(name, fields, version, span);
    let held = |part: &MessageDefinition| FieldElement::Message(part.name.clone());
    match ActionInterfaces::of(&action.name, version) {
        ActionInterfaces::Ros1 { action: whole, action_goal, action_result, action_feedback, .. } => {
            let header = || ("header", embedded("std_msgs", "Header"));
            let status = || ("status", embedded("actionlib_msgs", "GoalStatus"));
            let id = ("goal_id", embedded("actionlib_msgs", "GoalID"));
            let parts = [
                ("action_goal", &action_goal),
                ("action_result", &action_result),
                ("action_feedback", &action_feedback),
            ];
            let parts = parts.map(|(name, of)| (name, FieldElement::Message(of.clone()))).to_vec();
            let messages = vec![
                message(action_goal, vec![header(), id, ("goal", held(&action.goal))]),
                message(action_result, vec![header(), status(), ("result", held(&action.result))]),
                message(action_feedback, vec![header(), status(), ("feedback", held(&action.feedback))]),
                message(whole, parts),
            ];
            (messages, Vec::new())
        }
        ActionInterfaces::Ros2 { send_goal, get_result, feedback_message, .. } => {
            let id = || ("goal_id", embedded("unique_identifier_msgs", "UUID"));
            let stamp = ("stamp", embedded("builtin_interfaces", "Time"));
            let accepted = ("accepted", FieldElement::Primitive(PrimitiveType::Bool));
            let status = ("status", FieldElement::Primitive(PrimitiveType::Int8));
            let service = |name: InterfaceName, request, response| ServiceDefinition {
                request: message(part_name(&name, "Request", version), request),
                response: message(part_name(&name, "Response", version), response),
                name,
            };
            let services = vec![
                service(send_goal, vec![id(), ("goal", held(&action.goal))], vec![accepted, stamp]),
                service(get_result, vec![id()], vec![status, ("result", held(&action.result))]),
            ];
            let feedback = vec![id(), ("feedback", held(&action.feedback))];
            (vec![message(feedback_message, feedback)], services)
        }
    }
}

fn embedded(package: &str, name: &str) -> FieldElement {
    FieldElement::Message(InterfaceName::message(package, name))
}

fn implied_message(
    name: InterfaceName,
    fields: Vec<ImpliedField>,
    version: RosVersion,
    span: Span,
) -> MessageDefinition {
    let field = |(name, element): ImpliedField| MessageField {
        name: name.to_owned(),
        of: MessageFieldType { element, count: ElementCount::One },
        default: None,
        span,
        type_span: span,
    };
    let fields = fields.into_iter().map(field).collect();
    let mut message = MessageDefinition { name, constants: Vec::new(), fields, text: String::new(), span };
    message.text = message.written(version);
    message
}
