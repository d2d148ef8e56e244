//! `drives DEVICE`: what the usual messages of robots tell a device, as a rule of a command.

use hrdsl_ir::{
    binding::{CommandArgument, MessageEffect, MessageRule, MessageRules, MessageStep},
    device::{self, DevicePrimitive, DeviceSort},
};
use hrdsl_messages::InterfaceName;
use hrdsl_syntax::ast::TopicOutSyntax;

use crate::check::{binding::phase::BindingPhase, template::CheckerPhase};
use crate::{TypedExpr, report::bindings};

/// A message that drives devices of a sort.
struct DeviceDrive {
    sort: DeviceSort,
    package: &'static str,
    message: &'static str,
    how: DriveContent,
    /// As a person says it.
    says: &'static str,
}

/// What such a message holds.
#[derive(Clone, Copy, PartialEq, Eq)]
enum DriveContent {
    /// The angle of one joint, which the topic names.
    OneJoint,
    Trajectory,
    Twist,
    /// A twist below a header.
    StampedTwist,
}

impl DriveContent {
    /// What the world does with it. The command is the one that the library declares for it, whatever its name.
    fn primitive(self) -> DevicePrimitive {
        match self {
            DriveContent::OneJoint => DevicePrimitive::AimJoint,
            DriveContent::Trajectory => DevicePrimitive::FollowJoints,
            DriveContent::Twist | DriveContent::StampedTwist => DevicePrimitive::DriveWheels,
        }
    }

    /// What the message says of a parameter of the command, by the parameter's name, which is the primitive's: x looks forward, y to
    /// the left, z up.
    fn argument(self, param: &str, joints: &[String]) -> Option<CommandArgument<TypedExpr>> {
        let field = |path: &[&str]| {
            CommandArgument::Sequence(path.iter().map(|s| MessageStep::Field((*s).to_owned())).collect())
        };
        let twist = |part: &'static str, axis: &'static str| match self {
            DriveContent::StampedTwist => field(&["twist", part, axis]),
            DriveContent::OneJoint | DriveContent::Trajectory | DriveContent::Twist => field(&[part, axis]),
        };
        match (self, param) {
            (DriveContent::OneJoint, device::JOINT) => {
                Some(CommandArgument::Wildcard { names: joints.to_vec() })
            }
            (DriveContent::OneJoint, device::TO) => Some(field(&["data"])),
            (DriveContent::Trajectory, device::POSITIONS) => {
                Some(CommandArgument::TrackPositions { names: joints.to_vec() })
            }
            (DriveContent::Trajectory, device::TIMES) => Some(CommandArgument::TrackTimes),
            (DriveContent::Twist | DriveContent::StampedTwist, device::FORWARD) => Some(twist("linear", "x")),
            (DriveContent::Twist | DriveContent::StampedTwist, device::SIDEWAYS) => {
                Some(twist("linear", "y"))
            }
            (DriveContent::Twist | DriveContent::StampedTwist, device::TURN) => Some(twist("angular", "z")),
            (
                DriveContent::OneJoint
                | DriveContent::Trajectory
                | DriveContent::Twist
                | DriveContent::StampedTwist,
                _,
            ) => None,
        }
    }
}

const DRIVES: [DeviceDrive; 4] = [
    DeviceDrive {
        sort: DeviceSort::Arm,
        package: "std_msgs",
        message: "Float64",
        how: DriveContent::OneJoint,
        says: "`std_msgs/Float64` aims one joint of an arm",
    },
    DeviceDrive {
        sort: DeviceSort::Arm,
        package: "trajectory_msgs",
        message: "JointTrajectory",
        how: DriveContent::Trajectory,
        says: "`trajectory_msgs/JointTrajectory` moves an arm",
    },
    DeviceDrive {
        sort: DeviceSort::Base,
        package: "geometry_msgs",
        message: "Twist",
        how: DriveContent::Twist,
        says: "`geometry_msgs/Twist` drives a base",
    },
    DeviceDrive {
        sort: DeviceSort::Base,
        package: "geometry_msgs",
        message: "TwistStamped",
        how: DriveContent::StampedTwist,
        says: "`geometry_msgs/TwistStamped`, too",
    },
];

impl<'a> BindingPhase<'_, 'a> {
    /// Adds the rule.
    pub(super) fn driven(
        &mut self,
        topic: &TopicOutSyntax,
        message: &InterfaceName,
        rules: &mut MessageRules<TypedExpr>,
    ) {
        let Some(device) = &topic.drives else { return };
        let sorts: Vec<DeviceSort> = DRIVES.iter().map(|d| d.sort).collect();
        let Some(body) = self.device_of(device, &sorts, "") else { return };
        let is = |d: &&DeviceDrive| {
            d.sort == body.sort() && d.package == message.package && d.message == message.name
        };
        let Some(drive) = DRIVES.iter().find(is) else {
            let ways: Vec<&str> = DRIVES.iter().map(|d| d.says).collect();
            let written = message.written(self.library.version());
            let issue =
                bindings::no_way_to_drive(body.sort().name(), &written, &ways.join(", "), device.span);
            self.report(issue);
            return;
        };
        if drive.how == DriveContent::OneJoint && !topic.name.text.contains('*') {
            self.report(bindings::no_wildcard(topic.name.span));
            return;
        }
        let kind = self.s.device_kinds.iter().find(|kind| kind.sort == body.sort());
        // INVARIANT: the library declares a command for each of them; a test compiles a drive of each.
        let Some(command) = kind.and_then(|kind| kind.command_doing(drive.how.primitive())) else { return };
        let joints = self.joint_texts(device, body, &topic.entries);
        let params = self.command_params(body, command);
        let args = params.iter().map(|param| drive.how.argument(&param.name, &joints)).collect();
        let effect = MessageEffect::Command { device: self.device_id(body), command, args };
        rules.rules.push(MessageRule { guard: None, rising: false, effect, origin: device.span });
    }
}
