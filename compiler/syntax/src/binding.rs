//! Bindings as they are written: what programs of a system say and hear on their middleware, and what it means in the scenario.

use hrdsl_source::Span;
use serde::Serialize;

use crate::expr::{CallSyntax, ExprSyntax, NameSyntax, PathSyntax, TextSyntax};

/// `ros1 { topic "/scan" : sensor_msgs/LaserScan in at 10 Hz { … } }`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MiddlewareSyntax {
    /// The keyword.
    pub version: NameSyntax,
    pub members: Vec<BindingMember>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BindingMember {
    pub kind: BindingMemberKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum BindingMemberKind {
    /// `messages "../catkin_ws"`
    Messages(TextSyntax),
    /// `topic "/human_signals" : table_simulator/Human in at 10 Hz { … }`
    TopicIn(TopicInSyntax),
    /// `topic "/gpl_is_ok" : std_msgs/Int8 out { … }`
    TopicOut(TopicOutSyntax),
    /// `service "/get_pose" : my_msgs/GetPose { … }`
    Service(ServedSyntax),
    /// `action "/play_motion" : play_motion_msgs/PlayMotion { … }`
    Action(ServedSyntax),
    /// `group "body_arm" plans robot.arm`
    Group(GroupSyntax),
    /// `parameter "/brew_time" = 2.5`
    Parameter {
        name: TextSyntax,
        value: ExprSyntax,
    },
    /// `transition "Receive1" -> "Timeout1" emit timed_out`
    Transition {
        from: TextSyntax,
        to: TextSyntax,
        emit: CallSyntax,
    },
    Error,
}

/// A topic that the programs hear.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TopicInSyntax {
    pub name: TextSyntax,
    pub interface: InterfaceSyntax,
    /// `at 10 Hz`
    pub rate: Option<ExprSyntax>,
    /// `from robot.laser`: the device that tells what is in it
    pub from: Option<PathSyntax>,
    pub latched: bool,
    pub entries: Vec<BindingEntry>,
}

/// A topic on which they speak.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TopicOutSyntax {
    pub name: TextSyntax,
    pub interface: InterfaceSyntax,
    /// `drives robot.base`
    pub drives: Option<PathSyntax>,
    pub entries: Vec<BindingEntry>,
}

/// A service or an action that the scenario serves.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ServedSyntax {
    pub name: TextSyntax,
    pub interface: InterfaceSyntax,
    pub entries: Vec<BindingEntry>,
}

/// A name under which programs plan the motions of an arm.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GroupSyntax {
    pub name: TextSyntax,
    pub device: PathSyntax,
    /// `acceleration 2 rad/s^2`
    pub acceleration: Option<ExprSyntax>,
    /// `tip "gripper_link"`
    pub tip: Option<TextSyntax>,
    pub entries: Vec<BindingEntry>,
}

/// `std_msgs/Int8`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InterfaceSyntax {
    pub names: Vec<NameSyntax>,
    pub span: Span,
}

impl InterfaceSyntax {
    /// As it is written, without blanks.
    #[must_use]
    pub fn text(&self) -> String {
        self.names.iter().map(|n| n.text.as_str()).collect::<Vec<_>>().join("/")
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BindingEntry {
    pub kind: BindingEntryKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum BindingEntryKind {
    /// `pose.position.x = robot_x`, `success = true when data`
    Field {
        field: FieldSyntax,
        value: ExprSyntax,
        when: Option<ExprSyntax>,
    },
    /// `"shoulder" = shoulder_flexor`: what the programs call a joint
    Joint {
        part: TextSyntax,
        joint: NameSyntax,
    },
    /// `emit decided(true) when data == 1`
    Emit {
        emit: CallSyntax,
        when: Option<ExprSyntax>,
    },
    /// `close robot.grip when data == 1`
    Command {
        command: NameSyntax,
        device: PathSyntax,
        args: Option<Vec<ExprSyntax>>,
        when: Option<ExprSyntax>,
    },
    Error,
}

/// `pose.position.x`, `ranges[0]`, `people[0].position.x`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FieldSyntax {
    pub path: PathSyntax,
    /// An element of it, one of that, and so on.
    pub elements: Vec<ElementSyntax>,
}

/// `[0].position.x`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ElementSyntax {
    pub index: ExprSyntax,
    pub names: Vec<NameSyntax>,
}
