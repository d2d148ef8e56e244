//! What programs find out about their middleware: a file of JSON, the same for all tests (`spec/protocol.md`).

use std::collections::BTreeMap;

use hrdsl_ir::{Program, binding::MiddlewareBinding, device::DeviceBody};
use serde::Serialize;
use serde_json::value::RawValue;

#[derive(Serialize)]
struct WrittenBinding<'a> {
    ros: u8,
    base_frame: &'static str,
    groups: BTreeMap<&'a str, WrittenGroup<'a>>,
    packages: &'a BTreeMap<String, String>,
    interfaces: Option<Box<RawValue>>,
}

#[derive(Serialize)]
struct WrittenGroup<'a> {
    device: &'a str,
    joints: Vec<WrittenJoint<'a>>,
}

#[derive(Serialize)]
struct WrittenJoint<'a> {
    name: &'a str,
    /// Radians.
    lower: f64,
    upper: f64,
    /// rad/s
    velocity: f64,
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
pub(crate) fn binding_text(program: &Program, binding: &MiddlewareBinding) -> String {
    let ros = match binding.kind {
        hrdsl_ir::binding::MiddlewareKind::Ros1 => 1,
        hrdsl_ir::binding::MiddlewareKind::Ros2 => 2,
    };
    let groups = binding.groups.iter().filter_map(|group| {
        let world = program.world.as_ref()?;
        let device = world.device(group.device);
        let DeviceBody::Arm(arm) = device.body else { return None };
        let arm = world.arms.get(usize::from(arm.0))?;
        let joint = |id: &hrdsl_ir::world::JointId| {
            let joint = world.joints.get(usize::from(id.0))?;
            let name = joint.name.rsplit('.').next().unwrap_or(&joint.name);
            Some(WrittenJoint { name, lower: joint.lo, upper: joint.hi, velocity: arm.max_speed })
        };
        let joints = arm.joints.iter().filter_map(joint).collect();
        Some((group.name.as_str(), WrittenGroup { device: &device.name, joints }))
    });
    let written = WrittenBinding {
        ros,
        base_frame: "world",
        groups: groups.collect(),
        packages: &binding.packages,
        interfaces: RawValue::from_string(binding.interfaces.clone()).ok(),
    };
    // INVARIANT: plain data has a text.
    serde_json::to_string(&written).unwrap_or_default()
}
