//! What is bound to a middleware: which messages of the system's programs mean what in the scenario, as data.
//!
//! The scenario takes part in the middleware's graph like a further program: it publishes what the world shows, hears what the
//! programs say, and serves what they ask.

use std::collections::BTreeMap;

use hrdsl_source::Span;
use serde::{Deserialize, Serialize};

use crate::{
    device_state::DeviceState,
    event::{EventId, EventPattern},
    expr::Expr,
    value::{Nanos, Type},
    world::{DeviceCommandId, DeviceId, SignalId},
};

/// Which client libraries the programs use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MiddlewareKind {
    Ros1,
    Ros2,
}

impl MiddlewareKind {
    /// As it is written, and as the programs' environment tells it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            MiddlewareKind::Ros1 => "ros1",
            MiddlewareKind::Ros2 => "ros2",
        }
    }
}

/// All that a system's programs share with the scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MiddlewareBinding<E = Expr> {
    pub kind: MiddlewareKind,
    /// Where the packages of the workspaces are, by name.
    pub packages: BTreeMap<String, String>,
    pub inputs: Vec<TopicInput<E>>,
    pub outputs: Vec<TopicOutput<E>>,
    pub services: Vec<BoundService<E>>,
    pub actions: Vec<BoundAction<E>>,
    pub groups: Vec<PlanningGroup>,
    /// With which the programs begin: JSON by names from the root.
    pub parameters: BTreeMap<String, String>,
    pub transitions: Vec<TransitionRule>,
    pub origin: Span,
}

impl<E> MiddlewareBinding<E> {
    /// The signals that messages of the scenario hold.
    pub fn signals(&self) -> impl Iterator<Item = SignalId> {
        let inputs = self.inputs.iter().map(|input| &input.message);
        let answers = self.services.iter().map(|service| &service.response);
        let results = self.actions.iter().map(|action| &action.result);
        let gaps = inputs.chain(answers).chain(results).flat_map(MessageTemplate::leaves);
        gaps.flat_map(GapValue::reads).filter_map(|read| match read {
            GapRead::Signal(signal) => Some(*signal),
            GapRead::Argument { .. } => None,
        })
    }
}

/// A topic that the scenario publishes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TopicInput<E = Expr> {
    pub topic: String,
    pub interface: String,
    /// Between two messages; `None`: one at each event that it speaks of.
    pub period: Option<Nanos>,
    /// Who subscribes later gets the last one.
    pub latched: bool,
    pub message: MessageTemplate<E>,
    pub origin: Span,
}

/// A message with gaps for values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MessageTemplate<E = Expr> {
    /// JSON around the gaps: one piece more than there are.
    pub text: Vec<String>,
    pub gaps: Vec<MessageGap<E>>,
}

impl<E> MessageTemplate<E> {
    /// All that stands in its gaps, those of what stands there, too.
    #[must_use]
    pub fn leaves(&self) -> Vec<&GapValue<E>> {
        let mut all = Vec::new();
        self.collect(&mut all);
        all
    }

    fn collect<'t>(&'t self, all: &mut Vec<&'t GapValue<E>>) {
        self.gaps.iter().for_each(|gap| gap.value.collect(all));
    }

    /// Whether something that happens sets a part of it.
    #[must_use]
    pub fn is_of_events(&self) -> bool {
        self.leaves().iter().any(|value| value.is_of_events())
    }
}

/// What stands in a gap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MessageGap<E = Expr> {
    pub value: GapValue<E>,
    pub scalar: MessageScalar,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GapValue<E = Expr> {
    /// True from when one of these has happened, for so long; of a time of zero, at that instant.
    Held { events: Vec<EventPattern>, time: Nanos },
    /// `Expr::Var(i)` is `reads[i]`.
    Value { value: E, reads: Vec<GapRead> },
    /// The time of the message, as clocks of the programs tell it.
    Now,
    /// What a device tells of itself, such as the `ranges` of a laser.
    Told { device: DeviceId, what: DeviceState, numbers: ToldNumbers },
    /// The same in every message, as JSON.
    Fixed(String),
    /// Several values at once: those of a row, or of a message in the message.
    Whole(MessageTemplate<E>),
    /// What stands in the first case that holds; in none, this JSON.
    Chosen { cases: Vec<GapCase<E>>, otherwise: String },
}

/// What stands in a gap under a condition.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GapCase<E = Expr> {
    /// One of [`MessageRules::conditions`]; `None`: always.
    pub condition: Option<u16>,
    pub gap: MessageGap<E>,
}

/// Which of the numbers that a device tells stand in a gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ToldNumbers {
    /// All of them, as a sequence.
    All,
    /// The one at this place, counted from 0.
    One(u16),
}

impl<E> GapValue<E> {
    fn collect<'v>(&'v self, all: &mut Vec<&'v GapValue<E>>) {
        match self {
            GapValue::Whole(template) => template.collect(all),
            GapValue::Chosen { cases, .. } => cases.iter().for_each(|case| case.gap.value.collect(all)),
            GapValue::Held { .. }
            | GapValue::Value { .. }
            | GapValue::Now
            | GapValue::Told { .. }
            | GapValue::Fixed(_) => all.push(self),
        }
    }

    /// What its expression reads, if it is one.
    #[must_use]
    pub fn reads(&self) -> &[GapRead] {
        if let GapValue::Value { reads, .. } = self { reads } else { &[] }
    }

    /// After which events it is true, and for how long.
    #[must_use]
    pub fn as_held(&self) -> Option<(&[EventPattern], Nanos)> {
        if let GapValue::Held { events, time } = self { Some((events, *time)) } else { None }
    }

    /// The device that tells it.
    #[must_use]
    pub fn teller(&self) -> Option<DeviceId> {
        if let GapValue::Told { device, .. } = self { Some(*device) } else { None }
    }

    /// Whether this occurrence of an event sets it.
    #[must_use]
    pub fn is_set_by(&self, event: EventId, args: &[crate::Value]) -> bool {
        let is_argument =
            |read: &GapRead| matches!(read, GapRead::Argument { event: of, .. } if *of == event);
        let holds =
            matches!(self, GapValue::Held { events, .. } if events.iter().any(|p| p.matches(event, args)));
        holds || self.reads().iter().any(is_argument)
    }

    fn is_of_events(&self) -> bool {
        let is_argument = |read: &GapRead| matches!(read, GapRead::Argument { .. });
        matches!(self, GapValue::Held { .. }) || self.reads().iter().any(is_argument)
    }
}

/// What an expression in a gap may read.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GapRead {
    Signal(SignalId),
    /// An argument of the last occurrence of an event; before the first, `initial`.
    Argument {
        event: EventId,
        param: u16,
        initial: crate::Value,
    },
}

/// What a field can hold, as far as a binding is concerned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MessageScalar {
    Bool,
    /// A whole number of `lo..=hi`.
    Int {
        lo: i64,
        hi: i64,
    },
    Float,
    Text,
    /// Seconds and nanoseconds.
    Time,
    /// An angle about the vertical, as a quaternion.
    Heading,
}

/// A topic that the scenario hears.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TopicOutput<E = Expr> {
    /// `*` stands for one or more characters that are no `/`.
    pub topic: String,
    pub interface: String,
    pub rules: MessageRules<E>,
    pub origin: Span,
}

/// What a message makes happen, rule by rule.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MessageRules<E = Expr> {
    /// What the rules read of the message: `Expr::Var(i)` is `reads[i]`.
    pub reads: Vec<MessageRead>,
    pub rules: Vec<MessageRule<E>>,
    /// On which fields of the answer depend, as truth values.
    pub conditions: Vec<E>,
}

/// What is read at a place in a message.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MessageRead {
    pub path: Vec<MessageStep>,
    /// How many elements the sequence there has, instead of what stands there.
    pub length: bool,
    pub ty: Type,
    /// Of text: what it is compared with. What is read is whether they are the same, since a text that became a value would be
    /// kept for as long as the process lives.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub same_as: Option<TextOperand>,
}

/// What a text in a message is compared with.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TextOperand {
    Literal(String),
    /// The text at another place of the message.
    Place(Vec<MessageStep>),
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MessageStep {
    Field(String),
    Element(u32),
}

/// `pose.position.x`, `ranges[0]`
#[must_use]
pub fn place_text(path: &[MessageStep]) -> String {
    let mut text = String::new();
    for step in path {
        match step {
            MessageStep::Field(name) if text.is_empty() => text.push_str(name),
            MessageStep::Field(name) => {
                text.push('.');
                text.push_str(name);
            }
            MessageStep::Element(at) => {
                text.push('[');
                text.push_str(&at.to_string());
                text.push(']');
            }
        }
    }
    text
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MessageRule<E = Expr> {
    /// A boolean; `None`: always.
    pub guard: Option<E>,
    /// Only if it was false, or there was none, at the message before.
    pub rising: bool,
    pub effect: MessageEffect<E>,
    pub origin: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MessageEffect<E = Expr> {
    Emit {
        event: EventId,
        args: Vec<E>,
    },
    /// The numbers of each argument that is given, in the order of the command's parameters.
    Command {
        device: DeviceId,
        command: DeviceCommandId,
        args: Vec<Option<CommandArgument<E>>>,
    },
}

/// An argument of a command.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CommandArgument<E = Expr> {
    /// One number, or as many as the parameter has.
    Numbers(Vec<E>),
    /// All numbers of a sequence in the message, or the one that stands there.
    Sequence(Vec<MessageStep>),
    /// Which of these the `*` of the topic stands for, counted from 0. A message of any other topic is not heard.
    Wildcard { names: Vec<String> },
    /// Of a joint trajectory, the angles of these joints at each point.
    TrackPositions { names: Vec<String> },
    /// Of a joint trajectory, the time of each point.
    TrackTimes,
    /// The angles of the arm's posture of this name.
    Posture(TextOperand),
}

/// A service that the scenario serves; it answers at once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoundService<E = Expr> {
    pub service: String,
    pub interface: String,
    pub rules: MessageRules<E>,
    pub response: MessageTemplate<E>,
    pub origin: Span,
}

/// An action that the scenario serves. A goal that no rule fits is rejected; one that commands a device ends with the command.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoundAction<E = Expr> {
    pub action: String,
    pub interface: String,
    pub rules: MessageRules<E>,
    pub result: MessageTemplate<E>,
    pub origin: Span,
}

/// A name under which the programs plan the motions of an arm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanningGroup {
    pub name: String,
    pub device: DeviceId,
    /// What the programs call the joints, from the base to the tip.
    pub joints: Vec<String>,
    /// What they call the link that is brought to places.
    pub tip: String,
    /// Of each joint, rad/s²; `None`: that of the arm.
    pub acceleration: Option<f64>,
}

/// What a transition of a program's state machine means.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TransitionRule {
    pub from: String,
    pub to: String,
    pub event: EventId,
    pub args: Vec<crate::Value>,
    pub origin: Span,
}
