//! The world as data: bodies, joints, actuators, sensors, and the rules by which it makes events.
//!
//! Lengths in metres, angles in radians; x forward, y left, z up; orientations as roll, pitch, yaw about the fixed axes
//! (the convention of URDF).

use hrdsl_source::Span;
use serde::{Deserialize, Serialize};

pub use crate::shape::{BodyShape, Vec3};
pub use crate::world_ids::{
    ArmId, BaseId, BodyId, BodyRef, CurrentId, DeviceCommandId, DeviceId, DeviceKindId, FigureId, GripperId,
    JointId, LaserId, SignalId,
};
pub use crate::world_point::WorldPoint;
pub use crate::world_posture::{NamedPosture, PosturePoint};

use crate::{
    device::{Device, DeviceCommand, DeviceKind},
    event::{ActorId, EventId},
    expr::Expr,
    sensor::ImperfectSensor,
    solid::{SharedData, SolidBody},
    value::{Nanos, Type},
};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct World {
    /// The physics step.
    pub step: Nanos,
    /// Signals are sampled into the trace at this period, and at every event.
    pub sample: Nanos,
    pub gravity: Vec3,
    pub bodies: Vec<Body>,
    pub joints: Vec<Joint>,
    pub arms: Vec<Arm>,
    pub grippers: Vec<Gripper>,
    pub bases: Vec<Base>,
    pub lasers: Vec<Laser>,
    pub figures: Vec<Figure>,
    /// What the system can command or read: the arms, then the grippers, the bases, the lasers. Then what it can tell them.
    pub devices: Vec<Device>,
    pub device_kinds: Vec<DeviceKind>,
    pub currents: Vec<CurrentBody>,
    /// Those signals and devices that are read otherwise than they are.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sensors: Vec<ImperfectSensor>,
    pub rules: Vec<WorldRule>,
    pub origin: Span,
}

impl World {
    #[must_use]
    pub fn device(&self, id: DeviceId) -> &Device {
        &self.devices[usize::from(id.0)]
    }

    /// The device of this name.
    #[must_use]
    pub fn device_named(&self, name: &str) -> Option<DeviceId> {
        let at = self.devices.iter().position(|d| d.name == name)?;
        u16::try_from(at).ok().map(DeviceId)
    }

    #[must_use]
    pub fn kind_of(&self, device: &Device) -> &DeviceKind {
        &self.device_kinds[usize::from(device.kind.0)]
    }

    /// A command that a device knows.
    #[must_use]
    pub fn command(&self, device: DeviceId, command: DeviceCommandId) -> &DeviceCommand {
        &self.kind_of(self.device(device)).commands[usize::from(command.0)]
    }
}

/// A rigid body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// `robot.palm`
    pub name: String,
    pub motion: BodyMotion,
    pub shape: BodyShape,
    /// Where it starts, in the world.
    pub position: Vec3,
    pub rotation: Vec3,
    /// Kilograms; of no effect on bodies that are neither dynamic nor guided.
    pub mass: f64,
    /// The spring constant of its surface against what can move, N/m; `None`: it does not yield.
    pub stiffness: Option<f64>,
    /// Ghosts collide with nothing but are seen by distances and contacts.
    pub ghost: bool,
    /// Of a body that has more than one shape, or a mass of its own: that, in the place of `shape` and `mass`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solid: Option<SharedData<SolidBody>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BodyMotion {
    Fixed,
    Dynamic,
    /// Moved by actions only; pushes dynamic bodies.
    Kinematic,
    /// Drawn by a spring to where actions send it, and pushed by what it meets: the body of somebody alive.
    Guided,
}

/// The width of the limits of a hinge that has none, rad: they are as far from 0 on both sides.
pub const ENDLESS: f64 = 2e6;

/// A joint with one degree of freedom; where the bodies start it is at [`JointDrive::start`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    pub name: String,
    pub parent: BodyId,
    pub child: BodyId,
    pub motion: JointMotion,
    /// The joint's place at the start, in the world.
    pub anchor: Vec3,
    /// A unit vector at the start, in the world.
    pub axis: Vec3,
    /// Radians of a hinge, metres of a slider.
    pub lo: f64,
    pub hi: f64,
    pub drive: JointDrive,
}

impl Joint {
    /// Whether it cannot move: it makes its two bodies one.
    #[must_use]
    pub fn is_rigid(&self) -> bool {
        self.lo == 0.0 && self.hi == 0.0 || self.drive.held
    }

    /// Whether it turns round and round.
    #[must_use]
    pub fn is_endless(&self) -> bool {
        self.motion == JointMotion::Hinge && self.hi - self.lo >= ENDLESS
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JointMotion {
    /// About its axis.
    Hinge,
    /// Along its axis.
    Slider,
}

/// What moves a joint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointDrive {
    /// The greatest torque (N·m), or force of a slider (N), of its motor; `None`: as much as is needed.
    pub effort: Option<f64>,
    /// The greatest speed that its motor is asked for, rad/s or m/s; `None`: that of its arm.
    pub speed: Option<f64>,
    /// The inertia of a hinge's rotor about the joint's axis, as a gear multiplies it, kg·m².
    pub rotor: f64,
    /// What the joint says at the start, rad or m.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub start: f64,
    /// What brakes it at a speed of 1, N·m·s/rad or N·s/m, and at any speed, N·m or N.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub damping: f64,
    #[serde(default, skip_serializing_if = "is_zero")]
    pub friction: f64,
    /// It stays as it starts, whatever its limits.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub held: bool,
    /// What it follows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mimic: Option<JointMimic>,
}

/// A gear to another joint: the joint is where the other is, times a factor, plus an offset.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointMimic {
    pub joint: JointId,
    pub factor: f64,
    /// rad or m
    pub offset: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands in references")]
fn is_zero(x: &f64) -> bool {
    *x == 0.0
}

/// A chain of joints under motor control, from the base to the tip, with a small kinematic planner.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Arm {
    pub name: String,
    pub joints: Vec<JointId>,
    /// The body that is brought to a place.
    pub tip: BodyId,
    /// The point of the tip that is brought there, in the tip's own frame.
    pub tool: Vec3,
    /// The controller's limit on each joint's speed, rad/s (m/s of a slider), unless the program asks for less.
    pub max_speed: f64,
    /// It stops when what it meets presses it harder than this, N; `None`: it does not feel contacts.
    pub contact_limit: Option<f64>,
    /// Its planner knows where people are, too.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub avoids_people: bool,
    /// In the order of the text; each name once.
    pub postures: Vec<NamedPosture>,
}

/// A hand: it holds what its fingers close on, or, without fingers of its own, what is within reach when it closes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gripper {
    pub name: String,
    pub palm: BodyId,
    /// Joints that move fingers: closed at their upper limits, open at their lower. None: a hand that is one body.
    pub fingers: Vec<JointId>,
    /// Those of them that are closed at their lower limits, and open at their upper.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reversed: Vec<JointId>,
    /// The point between the fingers, in the palm's frame.
    pub tool: Vec3,
    /// A hand without fingers takes a body if the distance from that point to its surface is at most this; any hand loses one that
    /// comes to be farther than this and some more.
    pub reach: f64,
    /// Time from the command until it holds, or lets go; in which fingers go all their way.
    pub delay: Nanos,
    /// With how much each finger presses, N. What it holds bears as much as friction on both sides does.
    pub force: f64,
    /// What it can hold.
    pub holds: Vec<BodyId>,
}

/// A kinematic body that drives on a level plane, with all that is joined to it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Base {
    pub name: String,
    pub body: BodyId,
    /// Forward and backward, m/s.
    pub max_speed: f64,
    /// To either side without turning, m/s; 0 of a base that cannot.
    pub max_sideways: f64,
    /// About the vertical, rad/s.
    pub max_turn: f64,
    /// Of the speed along the plane, m/s². The turn rate comes to its limit in the time in which the speed comes to its own.
    pub acceleration: f64,
    /// How long a set-point is in force; `None`: until the next.
    pub timeout: Option<Nanos>,
}

/// A planar laser scanner: beams in the plane through its place, level in the frame of its body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Laser {
    pub name: String,
    pub body: BodyId,
    /// Where the beams begin, in the body's own frame, m.
    pub at: Vec3,
    /// The angles of the first and the last beam from the body's x axis, to the left about its z axis, rad.
    pub lo: f64,
    pub hi: f64,
    /// How many beams there are, at even angles.
    pub beams: u16,
    /// The nearest and the farthest surface that is measured, m.
    pub nearest: f64,
    pub farthest: f64,
}

impl Laser {
    /// The angle from one beam to the next, rad; 0 of a single beam.
    #[must_use]
    pub fn increment(&self) -> f64 {
        if self.beams < 2 { 0.0 } else { (self.hi - self.lo) / f64::from(self.beams - 1) }
    }

    /// The first and the last beam between two angles, which are both among them; `None`: there is no beam.
    #[must_use]
    pub fn beams_between(&self, from: f64, to: f64) -> Option<(u16, u16)> {
        let slack = 1e-6 * if self.beams < 2 { 1.0 } else { self.increment() };
        let angle = |beam: u16| self.lo + f64::from(beam) * self.increment();
        let mut within = (0..self.beams).filter(|beam| (from - slack..=to + slack).contains(&angle(*beam)));
        within.next().map(|first| (first, within.next_back().unwrap_or(first)))
    }
}

/// Somebody with a trunk on legs: guided bodies that go where one of them is sent, and keep their balance, or fall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    pub name: String,
    pub pelvis: BodyId,
    pub trunk: BodyId,
    pub head: BodyId,
    /// About which the trunk leans, at the start, in the world.
    pub hip: Vec3,
    /// On the trunk or on the pelvis: arms and legs.
    pub limbs: Vec<Limb>,
    /// Of its walk, m/s.
    pub speed: f64,
    /// About the vertical, rad/s.
    pub turn: f64,
    /// Of all of it, kg: the masses of its bodies are those that a contact feels.
    pub mass: f64,
}

/// An arm or a leg: two bones between three pivots, and perhaps a hand.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limb {
    pub name: String,
    /// The trunk or the pelvis of its figure.
    pub of: BodyId,
    pub upper: BodyId,
    pub lower: BodyId,
    /// What ends it, and goes to places.
    pub end: Option<BodyId>,
    /// The shoulder, the elbow and the wrist, or the hip, the knee and the ankle, at the start, in the world.
    pub pivots: [Vec3; 3],
}

/// A name for one of several bodies: the one that the gripper holds; or, if none, the first that no gripper has yet
/// taken; or the last.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CurrentBody {
    pub name: String,
    pub of: Vec<BodyId>,
    pub by: GripperId,
}

/// `on trigger when guard emit event(args)`: what the world answers as an environment actor, or what it sees the system do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorldRule<E = Expr> {
    pub on: RuleTrigger<E>,
    /// A boolean over signals: `Expr::Var(i)` is `signals[i]`.
    pub guard: Option<E>,
    pub event: EventId,
    pub args: Vec<E>,
    pub signals: Vec<SignalId>,
    pub origin: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RuleTrigger<E = Expr> {
    Event(crate::event::EventPattern),
    /// The system told a device to do this.
    Commanded {
        device: DeviceId,
        command: DeviceCommandId,
    },
    /// A boolean over the rule's signals, as its guard is, became true, or ceased to be; it counts as true as soon as it has
    /// held for so long.
    Edge {
        rising: bool,
        condition: E,
        held: Nanos,
    },
}

/// A named quantity of the world, read by the robot code, by rules, and by requirements.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Signal {
    /// `gaze`, or for an unnamed term of a requirement its text.
    pub name: String,
    pub ty: Type,
    /// The actors that can read it.
    pub to: Vec<ActorId>,
    /// What is measured; `Expr::Var(i)` in `value` is `terms[i]`.
    pub terms: Vec<SignalTerm>,
    pub value: Expr,
    /// A requirement reads it: it is sampled into the trace.
    pub recorded: bool,
    pub origin: Span,
}

/// A primitive measurement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SignalTerm {
    /// `distance(a, b)`: between the surfaces, m; 0 if they touch or overlap
    Distance(BodyRef, BodyRef),
    /// `range(a, b)`: between the centres, m
    Range(BodyRef, BodyRef),
    /// `angle(a, b)`: between a's own x axis and the direction from a's centre to b's, rad, 0..π
    Angle(BodyRef, BodyRef),
    /// `visible(a, b)`: whether a straight line from a's centre reaches b without meeting another body first, bool.
    /// Lines to b's centre and to points a third of the way to its ends are tried; one suffices.
    Visible(BodyRef, BodyRef),
    /// `b.x`, `b.y`, `b.z`: m
    Coordinate(BodyRef, Axis),
    /// `holds(gripper, b)`: bool
    Holds(GripperId, BodyRef),
    /// `holds(gripper)`: whether it holds anything, bool
    HoldsAny(GripperId),
    /// `joint_speed(arm)`: the largest speed of its joints, rad/s
    JointSpeed(ArmId),
    /// `joint_speed(joint)`: about its axis, rad/s, or along it, m/s
    JointRate(JointId),
    /// `joint_position(joint)`, or of a hinge `joint_angle(joint)`: rad or m
    JointPosition(JointId),
    /// `joint_effort(joint)`, or of a hinge `torque(joint)`: of its motor, about its axis, Nm, or along it, N
    JointEffort(JointId),
    /// `speed(b)`: m/s
    Speed(BodyRef),
    /// `touches(a, b)`: whether one presses on the other, or their surfaces touch or overlap, bool
    Touches(BodyRef, BodyRef),
    /// `force(a, b)`: how hard they press on each other, N
    Force(BodyRef, BodyRef),
    /// `force(b)`: how hard all others press on it, N
    ForceOn(BodyRef),
    /// `transient_force(a, b)`, `quasistatic_force(a, b)`: how hard others, or one, press on what yields in such contacts, N
    Pressed { body: BodyRef, by: Option<BodyRef>, phase: ContactPhase },
    /// `estimated_pressure(a, b, area)`: how hard others, or one, press on it, over an area (m²) that somebody assumes, Pa
    Pressure { body: BodyRef, by: Option<BodyRef>, area: f64 },
    /// `nearest(laser, from, to)`: the least range of all beams from the first to the last, m; infinite if they meet nothing
    Nearest { laser: LaserId, first: u16, last: u16 },
    /// `weight(b)`: how hard others press down on it, N
    Weight(BodyRef),
    /// `tilt(b)`: between the vertical and where its direction points that was vertical at the start, rad, 0..π
    Tilt(BodyRef),
    /// `height(b)`: of its lowest point above z = 0, m
    Height(BodyRef),
    /// `delta(signal, time)`: what it is less what it was so long ago, or at the start; in its own unit
    Delta(SignalId, Nanos),
    /// `reading(signal)`: what the system could read of it, in its own type
    Reading(SignalId),
    /// `heading(b)`: of its own x axis about the vertical, rad, -π..π
    Heading(BodyRef),
    /// A part of the unit quaternion by which it is turned, whose w is not negative.
    Orientation(BodyRef, QuaternionPart),
}

/// Which of the two kinds of ISO/TS 15066, 5.5.2, a contact is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ContactPhase {
    /// A blow: what is hit can recoil.
    Transient,
    /// It lasts, or what is pressed is clamped.
    QuasiStatic,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum QuaternionPart {
    X,
    Y,
    Z,
    W,
}

impl QuaternionPart {
    pub const ALL: [QuaternionPart; 4] =
        [QuaternionPart::X, QuaternionPart::Y, QuaternionPart::Z, QuaternionPart::W];

    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            QuaternionPart::X => "x",
            QuaternionPart::Y => "y",
            QuaternionPart::Z => "z",
            QuaternionPart::W => "w",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    X,
    Y,
    Z,
}

/// A change of the world by an environment actor; variables are those of the stimulus.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WorldAction<E = Expr> {
    /// `move(b, to, over)`: a kinematic or guided body goes to the point on a straight line, in the given seconds; the body
    /// keeps its rotation. Of a figure it is the head, a hand, or the pelvis, which stands for all of it.
    Move { body: BodyId, to: WorldPoint<E>, over: E },
    /// `look(b, at, offset, distance, angle)`: such a body goes, in half a second, to look at a target. The line of
    /// sight runs level through the target's centre, along the body's own x axis at the start of the run. The body goes
    /// to that end of it where it is now, then `offset` to the left as seen from the target, at its present height but
    /// no lower than the target and no more than 10 cm above it (of a figure, see `spec/world.md`), so that `range` is exactly `distance`. It turns
    /// its x axis to the target and then, about the vertical and to its left, until `angle` is what was asked for.
    /// All of this for where the target is at the time of the action. Metres and radians.
    Look { body: BodyId, at: BodyRef, offset: E, distance: E, angle: E },
    /// `grasp(g)`: the gripper closes, and holds the first thing it can from then on.
    Grasp { gripper: GripperId },
    /// `let_go(g)`
    LetGo { gripper: GripperId },
    /// `walk_to(f, …, speed)`: a figure turns to each of the points in turn, and walks there, at no more than this speed, m/s.
    Walk { figure: FigureId, along: Vec<WorldPoint<E>>, speed: E },
    /// `turn_to(f, at)`: a figure turns on the spot until it faces the point.
    Turn { figure: FigureId, to: WorldPoint<E> },
}
