//! `drives DEVICE`: what the usual messages of robots tell a device, as a rule of a command.

use hrdsl_ir::{
    binding::{CommandArgument, MessageEffect, MessageRule, MessageRules, MessageStep},
    device::{CommandParam, DeviceBody, DeviceSort},
    world::DeviceCommandId,
};
use hrdsl_messages::InterfaceName;
use hrdsl_syntax::ast::TopicOutSyntax;

use super::scope::BindingScope;
use crate::check::checker::Checker;
use crate::{TypedExpr, report::bindings};

/// A message that drives devices of a sort, by which command.
struct DeviceDrive {
    sort: DeviceSort,
    package: &'static str,
    message: &'static str,
    command: &'static str,
    /// As a person says it.
    says: &'static str,
}

const DRIVES: [DeviceDrive; 4] = [
    DeviceDrive {
        sort: DeviceSort::Arm,
        package: "std_msgs",
        message: "Float64",
        command: "aim",
        says: "`std_msgs/Float64` aims one joint of an arm",
    },
    DeviceDrive {
        sort: DeviceSort::Arm,
        package: "trajectory_msgs",
        message: "JointTrajectory",
        command: "follow",
        says: "`trajectory_msgs/JointTrajectory` moves an arm",
    },
    DeviceDrive {
        sort: DeviceSort::Base,
        package: "geometry_msgs",
        message: "Twist",
        command: "drive",
        says: "`geometry_msgs/Twist` drives a base",
    },
    DeviceDrive {
        sort: DeviceSort::Base,
        package: "geometry_msgs",
        message: "TwistStamped",
        command: "drive",
        says: "`geometry_msgs/TwistStamped`, too",
    },
];

impl<'a> Checker<'a> {
    /// Adds the rule.
    pub(super) fn driven(
        &mut self,
        scope: BindingScope<'a>,
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
            let written = message.written(scope.library.version());
            let issue =
                bindings::no_way_to_drive(body.sort().name(), &written, &ways.join(", "), device.span);
            self.report(issue);
            return;
        };
        if drive.command == "aim" && !topic.name.text.contains('*') {
            self.report(bindings::no_wildcard(topic.name.span));
            return;
        }
        let kind = self.s.device_kinds.iter().find(|kind| kind.sort == body.sort());
        // INVARIANT: the library declares the commands above; a test compiles a drive of each.
        let Some(command) = kind.and_then(|kind| kind.command(drive.command)) else { return };
        let joints = self.joint_texts(device, body, &topic.entries);
        let args = match drive.command {
            "aim" => vec![
                Some(CommandArgument::Wildcard { names: joints }),
                Some(CommandArgument::Sequence(vec![MessageStep::Field("data".to_owned())])),
            ],
            "drive" => self.twist(body, command, drive.message == "TwistStamped"),
            _ => vec![
                Some(CommandArgument::TrackPositions { names: joints }),
                Some(CommandArgument::TrackTimes),
            ],
        };
        let effect = MessageEffect::Command { device: self.device_id(body), command, args };
        rules.rules.push(MessageRule { guard: None, rising: false, effect, origin: device.span });
    }

    /// What a twist says of the parameters of `drive`: x looks forward, y to the left, z up.
    fn twist(
        &self,
        body: DeviceBody,
        command: DeviceCommandId,
        stamped: bool,
    ) -> Vec<Option<CommandArgument<TypedExpr>>> {
        let params = self.command_params(body, command);
        let argument = |param: &CommandParam| {
            let (part, axis) = match param.name.as_str() {
                "forward" => ("linear", "x"),
                "sideways" => ("linear", "y"),
                "turn" => ("angular", "z"),
                _ => return None,
            };
            let path = stamped.then_some("twist").into_iter().chain([part, axis]);
            Some(CommandArgument::Sequence(path.map(|s| MessageStep::Field(s.to_owned())).collect()))
        };
        params.iter().map(argument).collect()
    }
}
