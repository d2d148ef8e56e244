//! Devices: what the system can command, as the library declares it, and the primitives of the world that it is declared by.
//!
//! A *kind* of device has commands, each of which does one *primitive*: what a world knows how to begin. Which commands there
//! are, what they are called, what they take and what must be true at their end is data. The primitives, with the names and
//! types of what they take, are the table here: [`DevicePrimitive`]. So it is with the states that the system can ask for; what
//! a world can tell is in [`DeviceState`].

use std::{collections::BTreeMap, fmt};

use serde::{Deserialize, Serialize};

pub use crate::device_sort::DeviceSort;
use crate::{
    Unit,
    device_state::DeviceState,
    sensor::SensorSource,
    shape::Vec3,
    world::{ArmId, BaseId, DeviceCommandId, DeviceKindId, GripperId, LaserId, SignalTerm},
};

/// What a device is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DeviceBody {
    Arm(ArmId),
    Gripper(GripperId),
    Base(BaseId),
    Laser(LaserId),
}

impl DeviceBody {
    #[must_use]
    pub fn sort(self) -> DeviceSort {
        match self {
            DeviceBody::Arm(_) => DeviceSort::Arm,
            DeviceBody::Gripper(_) => DeviceSort::Gripper,
            DeviceBody::Base(_) => DeviceSort::Base,
            DeviceBody::Laser(_) => DeviceSort::Laser,
        }
    }

    /// What a sensor reads of it; `None`: it tells nothing.
    #[must_use]
    pub fn source(self) -> Option<SensorSource> {
        match self {
            DeviceBody::Arm(arm) => Some(SensorSource::Arm(arm)),
            DeviceBody::Base(base) => Some(SensorSource::Base(base)),
            DeviceBody::Laser(laser) => Some(SensorSource::Laser(laser)),
            DeviceBody::Gripper(_) => None,
        }
    }
}

/// Something that the system can command.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Device {
    /// `robot.arm`
    pub name: String,
    pub kind: DeviceKindId,
    pub body: DeviceBody,
}

/// What all devices of a kind can be told.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DeviceKind {
    pub name: String,
    pub doc: String,
    pub sort: DeviceSort,
    pub commands: Vec<DeviceCommand>,
    pub states: Vec<DeclaredState>,
}

impl DeviceKind {
    /// The command of this name.
    #[must_use]
    pub fn command(&self, name: &str) -> Option<DeviceCommandId> {
        let at = self.commands.iter().position(|c| c.name == name)?;
        u16::try_from(at).ok().map(DeviceCommandId)
    }

    /// The first command that does this: the library's own, if a scenario declares another one beside it.
    #[must_use]
    pub fn command_doing(&self, primitive: DevicePrimitive) -> Option<DeviceCommandId> {
        let at = self.commands.iter().position(|c| c.primitive == primitive)?;
        u16::try_from(at).ok().map(DeviceCommandId)
    }

    /// What the world tells when the system asks for this; `None`: devices of this kind have no such state.
    #[must_use]
    pub fn state(&self, name: &str) -> Option<DeviceState> {
        self.states.iter().find(|s| s.name == name).map(|s| s.told)
    }

    /// ``an arm tells `joints`, `speeds` and `tool` ``
    #[must_use]
    pub fn tells(&self) -> String {
        let names: Vec<String> = self.states.iter().map(|state| format!("`{}`", state.name)).collect();
        let names = match names.as_slice() {
            [] => "nothing".to_owned(),
            [one] => one.clone(),
            [first @ .., last] => format!("{} and {last}", first.join(", ")),
        };
        format!("{} tells {names}", self.with_article())
    }

    /// The command that ends what the device is doing, if there is one.
    #[must_use]
    pub fn stop(&self) -> Option<&DeviceCommand> {
        self.commands.iter().find(|c| c.primitive.is_stop())
    }

    /// `an arm`
    #[must_use]
    pub fn with_article(&self) -> String {
        let article = if self.name.starts_with(['a', 'e', 'i', 'o']) { "an" } else { "a" };
        format!("{article} {}", self.name)
    }
}

/// `command close do close_fingers expect holds else "…"`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DeviceCommand {
    pub name: String,
    pub doc: String,
    /// In the order of the declaration.
    pub params: Vec<CommandParam>,
    pub primitive: DevicePrimitive,
    /// What must be true when the primitive has ended.
    pub expect: Option<Expectation>,
}

impl DeviceCommand {
    /// What the primitive is to do, of arguments that fit the parameters; `None` if they do not.
    #[must_use]
    pub fn call(&self, args: &BTreeMap<&str, Vec<f64>>) -> Option<PrimitiveCall> {
        self.primitive.call(&|name| args.get(name).map(Vec::as_slice))
    }
}

/// `move_to(to, speed?)`
impl fmt::Display for DeviceCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)?;
        if self.params.is_empty() {
            return Ok(());
        }
        let param = |p: &CommandParam| format!("{}{}", p.name, if p.optional { "?" } else { "" });
        write!(f, "({})", self.params.iter().map(param).collect::<Vec<_>>().join(", "))
    }
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CommandParam {
    pub name: String,
    pub ty: CommandType,
    pub optional: bool,
}

/// What an argument of a command is: a quantity, or several.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CommandType {
    /// In which it is counted.
    pub unit: Unit,
    pub count: NumberCount,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NumberCount {
    One,
    /// An array of so many.
    Array(u16),
    /// A list of any length.
    List,
}

/// `3 numbers in m`
impl fmt::Display for CommandType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.count {
            NumberCount::One => f.write_str("a number")?,
            NumberCount::Array(n) => write!(f, "{n} numbers")?,
            NumberCount::List => f.write_str("a list of numbers")?,
        }
        match self.unit.symbol() {
            "" => Ok(()),
            symbol => write!(f, " in {symbol}"),
        }
    }
}

/// `state joints from joint_angles`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DeclaredState {
    pub name: String,
    pub doc: String,
    pub told: DeviceState,
}

/// What must be true of the device when a command has ended; if it is not, the command has failed, and this is why.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Expectation {
    pub measure: DeviceMeasure,
    pub is: bool,
    pub otherwise: String,
}

/// What a device can say of itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DeviceMeasure {
    /// `holds(g)`
    Holds,
}

impl DeviceMeasure {
    pub const ALL: [DeviceMeasure; 1] = [DeviceMeasure::Holds];

    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            DeviceMeasure::Holds => "holds",
        }
    }

    /// What it is a measurement of.
    #[must_use]
    pub fn sort(self) -> DeviceSort {
        match self {
            DeviceMeasure::Holds => DeviceSort::Gripper,
        }
    }

    /// The measurement of this device; `None`: it has none.
    #[must_use]
    pub fn of(self, body: DeviceBody) -> Option<SignalTerm> {
        match (self, body) {
            (DeviceMeasure::Holds, DeviceBody::Gripper(gripper)) => Some(SignalTerm::HoldsAny(gripper)),
            (DeviceMeasure::Holds, DeviceBody::Arm(_) | DeviceBody::Base(_) | DeviceBody::Laser(_)) => None,
        }
    }
}

/// What a world knows how to begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DevicePrimitive {
    /// An arm brings its tool point to a place in the world.
    ReachPoint,
    /// An arm brings its joints to these angles, in its own order of them.
    ReachJoints,
    /// An arm brings its joints through the postures of a trajectory, each at its time.
    FollowJoints,
    /// An arm's motor aims at an angle from now on, as one set-point of a stream.
    AimJoint,
    /// An arm comes to a stop.
    StopJoints,
    /// A gripper closes; what is within reach is held.
    CloseFingers,
    /// A gripper opens; what was held is let go.
    OpenFingers,
    /// A base drives at a speed from now on, as one set-point of a stream.
    DriveWheels,
    /// A base comes to a stop.
    StopWheels,
}

/// A parameter that a primitive takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PrimitiveParam {
    pub name: &'static str,
    pub ty: CommandType,
    /// The primitive can do without.
    pub optional: bool,
}

/// The place, or the angles.
pub const TO: &str = "to";
/// The angles of all joints, posture after posture.
pub const POSITIONS: &str = "positions";
/// The time of each posture, from the beginning.
pub const TIMES: &str = "times";
/// Which joint, from the base, counted from 0.
pub const JOINT: &str = "joint";
/// No joint goes faster.
pub const SPEED: &str = "speed";
/// How fast along the way the base looks.
pub const FORWARD: &str = "forward";
/// How fast about the vertical, to the left.
pub const TURN: &str = "turn";
/// How fast to the left, without turning.
pub const SIDEWAYS: &str = "sideways";

const fn param(name: &'static str, unit: Unit, count: NumberCount, optional: bool) -> PrimitiveParam {
    PrimitiveParam { name, ty: CommandType { unit, count }, optional }
}

const JOINT_SPEED: PrimitiveParam = param(SPEED, Unit::RadianPerSecond, NumberCount::One, true);

impl DevicePrimitive {
    pub const ALL: [DevicePrimitive; 9] = [
        DevicePrimitive::ReachPoint,
        DevicePrimitive::ReachJoints,
        DevicePrimitive::FollowJoints,
        DevicePrimitive::AimJoint,
        DevicePrimitive::StopJoints,
        DevicePrimitive::CloseFingers,
        DevicePrimitive::OpenFingers,
        DevicePrimitive::DriveWheels,
        DevicePrimitive::StopWheels,
    ];

    /// As it is written after `do`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            DevicePrimitive::ReachPoint => "reach_point",
            DevicePrimitive::ReachJoints => "reach_joints",
            DevicePrimitive::FollowJoints => "follow_joints",
            DevicePrimitive::AimJoint => "aim_joint",
            DevicePrimitive::StopJoints => "stop_joints",
            DevicePrimitive::CloseFingers => "close_fingers",
            DevicePrimitive::OpenFingers => "open_fingers",
            DevicePrimitive::DriveWheels => "drive_wheels",
            DevicePrimitive::StopWheels => "stop_wheels",
        }
    }

    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|p| p.name() == name)
    }

    /// Whether it ends what the device is doing, and does nothing else.
    #[must_use]
    pub fn is_stop(self) -> bool {
        matches!(self, DevicePrimitive::StopJoints | DevicePrimitive::StopWheels)
    }

    /// What does it.
    #[must_use]
    pub fn sort(self) -> DeviceSort {
        match self {
            DevicePrimitive::ReachPoint
            | DevicePrimitive::ReachJoints
            | DevicePrimitive::FollowJoints
            | DevicePrimitive::AimJoint
            | DevicePrimitive::StopJoints => DeviceSort::Arm,
            DevicePrimitive::CloseFingers | DevicePrimitive::OpenFingers => DeviceSort::Gripper,
            DevicePrimitive::DriveWheels | DevicePrimitive::StopWheels => DeviceSort::Base,
        }
    }

    #[must_use]
    pub fn params(self) -> &'static [PrimitiveParam] {
        match self {
            DevicePrimitive::ReachPoint => {
                const { &[param(TO, Unit::Metre, NumberCount::Array(3), false), JOINT_SPEED] }
            }
            DevicePrimitive::ReachJoints => {
                const { &[param(TO, Unit::Radian, NumberCount::List, false), JOINT_SPEED] }
            }
            DevicePrimitive::FollowJoints => {
                const {
                    &[
                        param(POSITIONS, Unit::Radian, NumberCount::List, false),
                        param(TIMES, Unit::Second, NumberCount::List, false),
                    ]
                }
            }
            DevicePrimitive::AimJoint => {
                const {
                    &[
                        param(JOINT, Unit::None, NumberCount::One, false),
                        param(TO, Unit::Radian, NumberCount::One, false),
                    ]
                }
            }
            DevicePrimitive::DriveWheels => {
                const {
                    &[
                        param(FORWARD, Unit::MetrePerSecond, NumberCount::One, false),
                        param(TURN, Unit::RadianPerSecond, NumberCount::One, false),
                        param(SIDEWAYS, Unit::MetrePerSecond, NumberCount::One, true),
                    ]
                }
            }
            DevicePrimitive::StopJoints
            | DevicePrimitive::CloseFingers
            | DevicePrimitive::OpenFingers
            | DevicePrimitive::StopWheels => &[],
        }
    }

    fn call<'a>(self, arg: &dyn Fn(&str) -> Option<&'a [f64]>) -> Option<PrimitiveCall> {
        let one = |name: &str| arg(name).and_then(|numbers| numbers.first().copied());
        let speed = || one(SPEED);
        Some(match self {
            DevicePrimitive::ReachPoint => {
                PrimitiveCall::ReachPoint { to: arg(TO)?.try_into().ok()?, speed: speed() }
            }
            DevicePrimitive::ReachJoints => {
                PrimitiveCall::ReachJoints { to: arg(TO)?.to_vec(), speed: speed() }
            }
            DevicePrimitive::FollowJoints => PrimitiveCall::FollowJoints {
                positions: arg(POSITIONS)?.to_vec(),
                times: arg(TIMES)?.to_vec(),
            },
            DevicePrimitive::AimJoint => PrimitiveCall::AimJoint { joint: one(JOINT)?, to: one(TO)? },
            DevicePrimitive::StopJoints => PrimitiveCall::StopJoints,
            DevicePrimitive::CloseFingers => PrimitiveCall::CloseFingers,
            DevicePrimitive::OpenFingers => PrimitiveCall::OpenFingers,
            DevicePrimitive::DriveWheels => PrimitiveCall::DriveWheels {
                forward: one(FORWARD)?,
                sideways: one(SIDEWAYS).unwrap_or(0.0),
                turn: one(TURN)?,
            },
            DevicePrimitive::StopWheels => PrimitiveCall::StopWheels,
        })
    }
}

/// A primitive with what it takes, in SI units.
#[derive(Clone, Debug, PartialEq)]
pub enum PrimitiveCall {
    ReachPoint {
        to: Vec3,
        speed: Option<f64>,
    },
    ReachJoints {
        to: Vec<f64>,
        speed: Option<f64>,
    },
    /// The angles of all joints, posture after posture; the time of each posture, from now.
    FollowJoints {
        positions: Vec<f64>,
        times: Vec<f64>,
    },
    /// The joint's place in the arm, from the base, counted from 0.
    AimJoint {
        joint: f64,
        to: f64,
    },
    StopJoints,
    CloseFingers,
    OpenFingers,
    /// Forward and to the left, m/s; about the vertical, to the left, rad/s.
    DriveWheels {
        forward: f64,
        sideways: f64,
        turn: f64,
    },
    StopWheels,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_found_by_what_they_do() {
        let command = |name: &str, primitive| DeviceCommand {
            name: name.to_owned(),
            doc: String::new(),
            params: Vec::new(),
            primitive,
            expect: None,
        };
        let kind = DeviceKind {
            name: "base".to_owned(),
            doc: String::new(),
            sort: DeviceSort::Base,
            commands: vec![
                command("stop", DevicePrimitive::DriveWheels),
                command("halt", DevicePrimitive::StopWheels),
                command("crawl", DevicePrimitive::DriveWheels),
            ],
            states: vec![
                DeclaredState { name: "where".into(), doc: String::new(), told: DeviceState::BasePose },
                DeclaredState { name: "pace".into(), doc: String::new(), told: DeviceState::BaseVelocity },
            ],
        };
        assert_eq!(kind.stop().map(|c| c.name.as_str()), Some("halt"));
        assert_eq!(kind.command_doing(DevicePrimitive::DriveWheels), Some(DeviceCommandId(0)));
        assert_eq!(kind.command_doing(DevicePrimitive::AimJoint), None);
        assert_eq!(kind.state("pace"), Some(DeviceState::BaseVelocity));
        assert_eq!(kind.state("base_pose"), None);
        assert_eq!(kind.tells(), "a base tells `where` and `pace`");
    }

    #[test]
    fn each_primitive_is_called_with_the_parameters_of_its_table() {
        for primitive in DevicePrimitive::ALL {
            assert_eq!(DevicePrimitive::named(primitive.name()), Some(primitive));
            let numbers = |ty: CommandType| match ty.count {
                NumberCount::One => vec![1.0],
                NumberCount::Array(n) => vec![1.0; usize::from(n)],
                NumberCount::List => vec![1.0; 9],
            };
            let all: Vec<PrimitiveParam> = primitive.params().to_vec();
            let call = |params: &[PrimitiveParam]| {
                primitive.call(&|name| {
                    let given = params.iter().find(|p| p.name == name)?;
                    Some(numbers(given.ty).leak())
                })
            };
            let needed: Vec<PrimitiveParam> = all.iter().copied().filter(|p| !p.optional).collect();
            assert!(call(&all).is_some(), "{primitive:?}");
            assert!(call(&needed).is_some(), "{primitive:?}");
            for left_out in &needed {
                let rest: Vec<PrimitiveParam> = needed.iter().copied().filter(|p| p != left_out).collect();
                assert_eq!(call(&rest), None, "{primitive:?} needs {}", left_out.name);
            }
        }
    }

    #[test]
    fn types_are_said_in_words() {
        let said = |primitive: DevicePrimitive, at: usize| primitive.params()[at].ty.to_string();
        assert_eq!(said(DevicePrimitive::ReachPoint, 0), "3 numbers in m");
        assert_eq!(said(DevicePrimitive::ReachJoints, 0), "a list of numbers in rad");
        assert_eq!(said(DevicePrimitive::ReachJoints, 1), "a number in rad/s");
    }
}
