//! What programs find out about their middleware: a file of JSON, the same for all tests (`spec/protocol.md`).

use std::collections::BTreeMap;

use hrdsl_ir::{Program, binding::MiddlewareBinding, device::DeviceBody};
use serde::Serialize;
use serde_json::value::RawValue;

/// How long an arm takes to its full speed, in seconds (`spec/world.md`).
const RAMP: f64 = 0.5;

#[derive(Serialize)]
struct WrittenBinding<'a> {
    ros: u8,
    base_frame: &'static str,
    groups: BTreeMap<&'a str, WrittenGroup<'a>>,
    packages: &'a BTreeMap<String, String>,
    /// With which each program of ROS 1 begins, by their names from the root.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    parameters: BTreeMap<&'a str, Box<RawValue>>,
    interfaces: Option<Box<RawValue>>,
}

#[derive(Serialize)]
struct WrittenGroup<'a> {
    device: &'a str,
    joints: Vec<WrittenJoint<'a>>,
    /// The link that is brought to places.
    tip: &'a str,
    /// Named postures: the angles of the joints, in their order, in radians.
    states: BTreeMap<&'a str, &'a [f64]>,
}

#[derive(Serialize)]
struct WrittenJoint<'a> {
    name: &'a str,
    /// Radians.
    lower: f64,
    upper: f64,
    /// rad/s
    velocity: f64,
    /// In the mean, while the joint comes to its speed, rad/s²
    acceleration: f64,
}

/// Where a middleware's own tools would find modules of the workspace's packages: in ROS 1 below `src`, in ROS 2 in the package's
/// folder.
pub(crate) fn module_folders(binding: &MiddlewareBinding) -> Vec<String> {
    let folder = |package: &String| match binding.kind {
        hrdsl_ir::binding::MiddlewareKind::Ros1 => format!("{package}/src"),
        hrdsl_ir::binding::MiddlewareKind::Ros2 => package.clone(),
    };
    binding.packages.values().map(folder).collect()
}

/// The text of that file.
pub(crate) fn binding_text<'p>(
    program: &'p Program,
    binding: &'p MiddlewareBinding,
    interfaces: &str,
) -> String {
    let ros = match binding.kind {
        hrdsl_ir::binding::MiddlewareKind::Ros1 => 1,
        hrdsl_ir::binding::MiddlewareKind::Ros2 => 2,
    };
    let groups = binding.groups.iter().filter_map(|group| {
        let world = program.world.as_ref()?;
        let device = world.device(group.device);
        let DeviceBody::Arm(arm) = device.body else { return None };
        let arm = world.arms.get(usize::from(arm.0))?;
        let joint = |(id, name): (&hrdsl_ir::world::JointId, &'p String)| {
            let joint = world.joints.get(usize::from(id.0))?;
            let velocity = joint.drive.speed.map_or(arm.max_speed, |own| own.min(arm.max_speed));
            let acceleration = group.acceleration.unwrap_or(velocity / RAMP);
            Some(WrittenJoint { name, lower: joint.lo, upper: joint.hi, velocity, acceleration })
        };
        let joints = arm.joints.iter().zip(&group.joints).filter_map(joint).collect();
        let states = arm.postures.iter().map(|p| (p.name.as_str(), p.angles.as_slice())).collect();
        Some((group.name.as_str(), WrittenGroup { device: &device.name, joints, tip: &group.tip, states }))
    });
    let parameter = |(name, json): (&'p String, &String)| {
        Some((name.as_str(), RawValue::from_string(json.clone()).ok()?))
    };
    let written = WrittenBinding {
        ros,
        base_frame: "world",
        groups: groups.collect(),
        packages: &binding.packages,
        parameters: binding.parameters.iter().filter_map(parameter).collect(),
        interfaces: RawValue::from_string(interfaces.to_owned()).ok(),
    };
    // INVARIANT: plain data has a text.
    serde_json::to_string(&written).unwrap_or_default()
}
