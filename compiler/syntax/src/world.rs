//! The abstract syntax tree of worlds and devices.

use hrdsl_source::Span;
use serde::Serialize;

use crate::expr::{
    AllowSyntax, CallSyntax, ExprSyntax, NameSyntax, ParamSyntax, PathSyntax, RangeSyntax, TextSyntax,
    TypeExpr,
};

/// `part bert2 { … }`: a reusable piece of world, in its own coordinates.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartSyntax {
    pub name: NameSyntax,
    pub params: Option<Vec<ParamSyntax>>,
    /// `from "robot.urdf"`: a [`WorldMemberKind::Robot`]
    pub description: Option<Box<WorldMember>>,
    pub members: Vec<WorldMember>,
}

/// `world { … }`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorldSyntax {
    pub members: Vec<WorldMember>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorldMember {
    pub doc: String,
    pub kind: WorldMemberKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum WorldMemberKind {
    /// `step 10 ms`
    Step(ExprSyntax),
    /// `sample 50 ms`
    Sample(ExprSyntax),
    /// `gravity (0, 0, -9.81)`: m/s², bare numbers
    Gravity(ExprSyntax),
    /// `part robot = bert2 at (0 m, 0 m, 0 m)`; turned about z by `rotated (0 deg, 0 deg, 90 deg)`
    Part {
        name: NameSyntax,
        of: NameSyntax,
        args: Option<Vec<ExprSyntax>>,
        place: Box<PlaceSyntax>,
        turn: Option<TurnSyntax>,
    },
    Body(BodySyntax),
    Joint(Box<JointSyntax>),
    Arm(Box<ArmSyntax>),
    Gripper(Box<GripperSyntax>),
    Base(Box<BaseSyntax>),
    Laser(Box<LaserSyntax>),
    Limb(Box<LimbSyntax>),
    Figure(Box<FigureSyntax>),
    /// `laser eye: base_scan_link`: as its description says
    Scanner {
        name: NameSyntax,
        body: NameSyntax,
    },
    /// `from "robot.urdf"`, before the members of a part: what the description says that it is made of
    Robot(TextSyntax),
    /// `packages "ros_ws/src"`: where packages are searched for
    Packages(TextSyntax),
    /// `argument "hand" = "true"`: of xacro
    Argument {
        name: TextSyntax,
        value: TextSyntax,
    },
    /// `semantics "robot.srdf"`
    Semantics(TextSyntax),
    /// `start "ready", finger = 2 cm`: where joints are at the start
    Start(Vec<StartSyntax>),
    Walls(Box<WallsSyntax>),
    Posture(Box<PostureSyntax>),
    /// `current leg in leg1, leg2 by robot.grip`
    Current {
        name: NameSyntax,
        of: Vec<PathSyntax>,
        by: PathSyntax,
    },
    /// `signal gaze: bool to robot = …`
    Signal {
        name: NameSyntax,
        ty: TypeExpr,
        to: Vec<NameSyntax>,
        value: ExprSyntax,
        #[serde(skip_serializing_if = "Vec::is_empty")]
        sensing: Vec<SensorClause>,
    },
    Rule(RuleSyntax),
    Allow(AllowSyntax),
    Error,
}

/// `body palm: dynamic box(4 cm, 8 cm, 8 cm) at (…) rotated (…) mass 0.4 kg stiffness 75 N/mm ghost graspable`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BodySyntax {
    pub name: NameSyntax,
    /// `fixed`, `dynamic`, `kinematic`, `guided`
    pub motion: NameSyntax,
    /// `box`, `sphere`, `capsule`, `cylinder`
    pub shape: NameSyntax,
    pub sizes: Vec<ExprSyntax>,
    pub place: Box<PlaceSyntax>,
    pub turn: Option<TurnSyntax>,
    pub mass: Option<ExprSyntax>,
    pub stiffness: Option<ExprSyntax>,
    pub ghost: bool,
    pub graspable: bool,
}

/// Where something starts: `at (…)`, `on table at (…)`, `left of robot by 30 cm`, `on table behind cup by 5 cm`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlaceSyntax {
    /// What it stands on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub on: Option<PathSyntax>,
    /// A place; on something, two lengths from the middle of its top.
    pub at: Option<ExprSyntax>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beside: Option<BesideSyntax>,
}

/// `left of robot by 30 cm`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BesideSyntax {
    pub side: PlaceSide,
    pub of: PathSyntax,
    pub by: ExprSyntax,
}

/// A side of something, as it looks itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PlaceSide {
    Left,
    Right,
    Ahead,
    Behind,
}

/// `rotated (0 deg, 0 deg, 90 deg)`, `facing robot`
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TurnSyntax {
    Rotated(ExprSyntax),
    Facing(PathSyntax),
}

/// `joint j: parent -> child at (…) axis (0, 0, 1) limits -60 deg .. 60 deg effort 40 Nm speed 1 rad/s rotor 0.1 kgm^2 damping
/// 2 Nms/rad friction 1 Nm`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointSyntax {
    pub name: NameSyntax,
    pub parent: NameSyntax,
    pub child: NameSyntax,
    pub at: ExprSyntax,
    pub axis: ExprSyntax,
    pub limits: RangeSyntax,
    pub effort: Option<ExprSyntax>,
    pub speed: Option<ExprSyntax>,
    pub rotor: Option<ExprSyntax>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damping: Option<ExprSyntax>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction: Option<ExprSyntax>,
    pub mimic: Option<MimicSyntax>,
}

/// `mimic left times -1`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MimicSyntax {
    pub joint: NameSyntax,
    pub times: Option<ExprSyntax>,
}

/// `shoulder, elbow`, or `group "arm"` of the semantics of a description
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum JointListSyntax {
    Names(Vec<NameSyntax>),
    Group(TextSyntax),
}

impl Default for JointListSyntax {
    fn default() -> Self {
        Self::Names(Vec::new())
    }
}

/// Where joints start.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StartSyntax {
    /// As in this state of a group.
    State(TextSyntax),
    Joint {
        joint: NameSyntax,
        value: ExprSyntax,
    },
}

/// `walls hall from "map.yaml" height 2 m at (0 m, 0 m, 0 m)`: the walls of an occupancy map
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WallsSyntax {
    pub name: NameSyntax,
    pub path: TextSyntax,
    pub height: ExprSyntax,
    pub at: ExprSyntax,
    pub rotated: Option<ExprSyntax>,
}

/// `arm a: j1, j2 tip palm tool (8 cm, 0 m, 0 m) speed 0.2 rad/s contact 60 N avoids people`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ArmSyntax {
    pub name: NameSyntax,
    pub joints: JointListSyntax,
    pub tip: NameSyntax,
    pub tool: ExprSyntax,
    pub speed: ExprSyntax,
    pub contact: Option<ExprSyntax>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub avoids: Option<NameSyntax>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sensing: Vec<SensorClause>,
}

/// `gripper g: palm fingers left, right tool (8 cm, 0 m, 0 m) reach 4 cm delay 500 ms force 40 N`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GripperSyntax {
    pub name: NameSyntax,
    pub palm: NameSyntax,
    pub fingers: JointListSyntax,
    pub tool: ExprSyntax,
    pub reach: ExprSyntax,
    pub delay: ExprSyntax,
    pub force: Option<ExprSyntax>,
}

/// `base b: platform speed 0.5 m/s turn 1 rad/s acceleration 1 m/s^2`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BaseSyntax {
    pub name: NameSyntax,
    /// `dynamic`, before a link of a description
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<NameSyntax>,
    pub body: NameSyntax,
    pub speed: ExprSyntax,
    /// `sideways 0.3 m/s`: without turning, after `speed`
    pub sideways: Option<ExprSyntax>,
    pub turn: ExprSyntax,
    pub acceleration: ExprSyntax,
    /// `timeout 500 ms`: how long a set-point is in force, at the end
    pub timeout: Option<ExprSyntax>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sensing: Vec<SensorClause>,
}

/// `laser l: mast at (0 m, 0 m, 20 cm) angles -135 deg .. 135 deg beams 271 range 5 cm .. 10 m`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LaserSyntax {
    pub name: NameSyntax,
    pub body: NameSyntax,
    /// In the body's own frame.
    pub at: ExprSyntax,
    pub angles: RangeSyntax,
    pub beams: ExprSyntax,
    pub range: RangeSyntax,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sensing: Vec<SensorClause>,
}

/// `every 100 ms`, `late 50 ms`, `noise 5 mm`: in what a sensor is worse than the truth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SensorClause {
    pub kind: SensorClauseKind,
    /// One; of `noise` and `drift` one for each dimension.
    pub values: Vec<ExprSyntax>,
    /// Of `outlier`: from where they are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<RangeSyntax>,
    pub span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SensorClauseKind {
    /// The time from one sample to the next.
    Every,
    /// The time from a sample until it can be read.
    Late,
    /// Standard deviations.
    Noise,
    /// Standard deviations after a metre and after a radian.
    Drift,
    /// The probability that a sample is missing.
    Dropout,
    /// The probability that a truth is the other one.
    Flip,
    /// The probability that a quantity is anything in a range: `outlier 1 % in 0 m .. 5 m`.
    Outlier,
}

impl SensorClauseKind {
    /// The word that begins the clause.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            SensorClauseKind::Every => "every",
            SensorClauseKind::Late => "late",
            SensorClauseKind::Noise => "noise",
            SensorClauseKind::Drift => "drift",
            SensorClauseKind::Dropout => "dropout",
            SensorClauseKind::Flip => "flip",
            SensorClauseKind::Outlier => "outlier",
        }
    }
}

/// `limb l: trunk -> upper_arm -> forearm -> hand at SHOULDER, ELBOW, WRIST`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LimbSyntax {
    pub name: NameSyntax,
    /// What it hangs on, its two bones, and perhaps what ends it.
    pub bodies: Vec<NameSyntax>,
    pub pivots: Vec<ExprSyntax>,
}

/// `figure f: pelvis -> trunk -> head at HIP limbs l, r speed 1.4 m/s turn 120 deg/s mass 75 kg`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FigureSyntax {
    pub name: NameSyntax,
    pub bodies: Vec<NameSyntax>,
    pub hip: ExprSyntax,
    pub limbs: Vec<NameSyntax>,
    pub speed: ExprSyntax,
    pub turn: ExprSyntax,
    pub mass: ExprSyntax,
}

/// `posture home: arm at [0 deg, 90 deg]`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PostureSyntax {
    pub name: NameSyntax,
    pub arm: PathSyntax,
    /// Of its joints, from the base to the tip.
    pub angles: ExprSyntax,
}

/// `on e(args) when c emit f(args)`, `on close robot.grip emit f`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RuleSyntax {
    pub on: RuleTriggerSyntax,
    pub when: Option<ExprSyntax>,
    pub emit: CallSyntax,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RuleTriggerSyntax {
    Event(CallSyntax),
    /// The system told a device to do this.
    Commanded {
        command: NameSyntax,
        device: PathSyntax,
    },
}

/// `device gripper { … }`: what all devices of a kind can be told, and what they tell
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DeviceSyntax {
    pub kind: NameSyntax,
    pub members: Vec<DeviceMember>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DeviceMember {
    pub doc: String,
    pub kind: DeviceMemberKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DeviceMemberKind {
    Command(DeviceCommandSyntax),
    State(DeviceStateSyntax),
    Error,
}

/// `command close do close_fingers expect holds else "the gripper closed on nothing"`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DeviceCommandSyntax {
    pub name: NameSyntax,
    pub params: Vec<CommandParamSyntax>,
    pub primitive: NameSyntax,
    pub expect: Option<ExpectationSyntax>,
}

/// `state joints from joint_angles`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DeviceStateSyntax {
    pub name: NameSyntax,
    pub told: NameSyntax,
}

/// `speed: angular_speed?`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CommandParamSyntax {
    pub param: ParamSyntax,
    /// `?`: may be left out
    pub optional: bool,
}

/// `expect not holds else "the gripper still holds something"`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ExpectationSyntax {
    pub negated: bool,
    pub measure: NameSyntax,
    pub otherwise: TextSyntax,
}
