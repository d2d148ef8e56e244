//! `from DEVICE`: what a device tells of itself, in the fields of the usual messages of robots.

use hrdsl_ir::{
    binding::{GapValue, MessageGap, MessageScalar, ToldNumbers},
    device::{DeviceBody, DeviceSort},
    device_state::DeviceState,
    world::Laser,
};
use hrdsl_messages::InterfaceName;
use hrdsl_syntax::ast::TopicInSyntax;

use super::fields::FieldValues;
use crate::check::{binding::phase::BindingPhase, template::CheckerPhase};
use crate::{TypedExpr, report::bindings};

/// A message that holds what devices of a sort tell.
struct DeviceSource {
    sort: DeviceSort,
    package: &'static str,
    message: &'static str,
    /// As a person says it.
    says: &'static str,
}

const SOURCES: [DeviceSource; 3] = [
    DeviceSource {
        sort: DeviceSort::Laser,
        package: "sensor_msgs",
        message: "LaserScan",
        says: "`sensor_msgs/LaserScan` comes from a laser",
    },
    DeviceSource {
        sort: DeviceSort::Base,
        package: "nav_msgs",
        message: "Odometry",
        says: "`nav_msgs/Odometry` comes from a base",
    },
    DeviceSource {
        sort: DeviceSort::Arm,
        package: "sensor_msgs",
        message: "JointState",
        says: "`sensor_msgs/JointState` comes from an arm",
    },
];

impl<'a> BindingPhase<'_, 'a> {
    /// The fields that the device fills; `rate` is that of the topic, Hz.
    pub(super) fn source(
        &mut self,
        topic: &TopicInSyntax,
        message: &InterfaceName,
        rate: Option<f64>,
    ) -> FieldValues {
        let Some(device) = &topic.from else { return FieldValues::new() };
        let sorts: Vec<DeviceSort> = SOURCES.iter().map(|s| s.sort).collect();
        let Some(body) = self.device_of(device, &sorts, "") else { return FieldValues::new() };
        let is = |s: &&DeviceSource| {
            s.sort == body.sort() && s.package == message.package && s.message == message.name
        };
        if !SOURCES.iter().any(|s| is(&s)) {
            let ways: Vec<&str> = SOURCES.iter().map(|s| s.says).collect();
            let written = message.written(self.library.version());
            let issue = bindings::no_source(body.sort().name(), &written, &ways.join(", "), device.span);
            self.report(issue);
            return FieldValues::new();
        }
        let mut fields = ToldFields { device: self.device_id(body), fields: FieldValues::new() };
        match body {
            DeviceBody::Arm(_) => fields.arm(self.joint_texts(device, body, &topic.entries)),
            DeviceBody::Base(id) => {
                let base = self.s.world.as_ref().and_then(|world| world.bases.get(usize::from(id.0)));
                let frame = base.and_then(|base| self.link_name(base.body));
                fields.base(frame.as_deref().unwrap_or("base_link"));
            }
            DeviceBody::Laser(id) => {
                let lasers = self.s.world.as_ref().map_or(&[][..], |world| &world.lasers);
                if let Some(laser) = lasers.get(usize::from(id.0)) {
                    let frame = self.link_name(laser.body);
                    fields.laser(laser, rate, frame.as_deref().unwrap_or("laser"));
                }
            }
            DeviceBody::Gripper(_) => {}
        }
        fields.fields
    }

    /// What its description calls a body; `None`: it has none.
    fn link_name(&self, body: crate::BodyId) -> Option<String> {
        let link = self.robots.iter().find_map(|placed| Some((placed.link_of(body)?, placed.robot()?)));
        link.and_then(|(link, robot)| robot.link(link)).map(|link| link.name.clone())
    }
}

/// The fields of one device.
struct ToldFields {
    device: hrdsl_ir::world::DeviceId,
    fields: FieldValues,
}

impl ToldFields {
    fn add(&mut self, field: &str, value: GapValue<TypedExpr>, scalar: MessageScalar) {
        self.fields.insert(field.to_owned(), MessageGap { value, scalar });
    }

    fn told(&mut self, field: &str, what: DeviceState, numbers: ToldNumbers) {
        let value = GapValue::Told { device: self.device, what, numbers };
        self.add(field, value, MessageScalar::Float);
    }

    fn number(&mut self, field: &str, number: f64) {
        self.add(field, GapValue::Fixed(format!("{number:?}")), MessageScalar::Float);
    }

    fn text(&mut self, field: &str, text: &str) {
        self.add(field, GapValue::Fixed(json(text)), MessageScalar::Text);
    }

    fn arm(&mut self, joints: Vec<String>) {
        let names: Vec<String> = joints.iter().map(|name| json(name)).collect();
        self.add("name", GapValue::Fixed(format!("[{}]", names.join(","))), MessageScalar::Text);
        self.told("position", DeviceState::JointAngles, ToldNumbers::All);
        self.told("velocity", DeviceState::JointSpeeds, ToldNumbers::All);
    }

    fn base(&mut self, frame: &str) {
        self.text("header.frame_id", "odom");
        self.text("child_frame_id", frame);
        for (at, axis) in (0u16..).zip(["x", "y"]) {
            self.told(&format!("pose.pose.position.{axis}"), DeviceState::BasePose, ToldNumbers::One(at));
            self.told(&format!("twist.twist.linear.{axis}"), DeviceState::BaseVelocity, ToldNumbers::One(at));
        }
        for (at, axis) in (0u16..).zip(["x", "y", "z", "w"]) {
            let field = format!("pose.pose.orientation.{axis}");
            self.told(&field, DeviceState::BaseOrientation, ToldNumbers::One(at));
        }
        self.told("twist.twist.angular.z", DeviceState::BaseVelocity, ToldNumbers::One(2));
    }

    fn laser(&mut self, laser: &Laser, rate: Option<f64>, frame: &str) {
        self.text("header.frame_id", frame);
        self.number("angle_min", laser.lo);
        self.number("angle_max", laser.hi);
        let steps = f64::from(laser.beams.max(2) - 1);
        self.number("angle_increment", (laser.hi - laser.lo) / steps);
        self.number("scan_time", rate.map_or(0.0, |rate| 1.0 / rate));
        self.number("range_min", laser.nearest);
        self.number("range_max", laser.farthest);
        self.told("ranges", DeviceState::BeamRanges, ToldNumbers::All);
    }
}

/// A text as JSON.
fn json(text: &str) -> String {
    // INVARIANT: text has a JSON form.
    serde_json::to_string(text).unwrap_or_default()
}
