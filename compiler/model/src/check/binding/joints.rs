//! What programs call the joints of an arm, where that differs from their names in the scenario.

use hrdsl_ir::device::DeviceBody;
use hrdsl_syntax::ast::{BindingEntry, BindingEntryKind as Entry, NameSyntax, PathSyntax, TextSyntax};

use crate::check::{binding::phase::BindingPhase, template::CheckerPhase};
use crate::{
    noun::Noun,
    report::{bindings, names},
};

impl BindingPhase<'_, '_> {
    /// The names of an arm's joints to the programs, from its base: those of the table in the block, or its own.
    pub(super) fn joint_texts(
        &mut self,
        device: &PathSyntax,
        body: DeviceBody,
        entries: &[BindingEntry],
    ) -> Vec<String> {
        let joints = self.arm_joints(body);
        let own = self.joint_own_names(body);
        let mut given: Vec<Option<&TextSyntax>> = vec![None; joints.len()];
        let mut is_table = false;
        for entry in entries {
            let Entry::Joint { part, joint } = &entry.kind else { continue };
            if !matches!(body, DeviceBody::Arm(_)) {
                self.report(bindings::no_joints(entry.span));
                continue;
            }
            is_table = true;
            self.joint_named(part, joint, &joints, &mut given);
        }
        if !is_table {
            return own;
        }
        let missing: Vec<&str> = own
            .iter()
            .zip(&given)
            .filter(|(_, text)| text.is_none())
            .map(|(joint, _)| joint.as_str())
            .collect();
        if !missing.is_empty() {
            self.report(bindings::joints_missing(&missing, device.span));
        }
        own.into_iter().zip(given).map(|(own, text)| text.map_or(own, |text| text.text.clone())).collect()
    }

    /// `"shoulder" = shoulder_flexor`
    fn joint_named<'e>(
        &mut self,
        part: &'e TextSyntax,
        joint: &NameSyntax,
        joints: &[String],
        given: &mut [Option<&'e TextSyntax>],
    ) {
        let Some(at) = joints.iter().position(|full| last_name(full) == joint.text) else {
            let own: Vec<String> = joints.iter().map(|full| last_name(full)).collect();
            let near = own.iter().map(String::as_str);
            self.report(names::unknown(Noun::Joint, &joint.text, joint.span, near));
            return;
        };
        if let Some(full) = joints.get(at) {
            self.refer(joint, self.world.names.place_of(Noun::Joint, full));
        }
        if part.text.is_empty() || part.text.contains('/') {
            self.report(bindings::bad_joint_text(part.span));
        } else if let Some(first) = given.iter().flatten().find(|known| known.text == part.text) {
            self.report(names::duplicate(Noun::Joint, &part.text, part.span, Some(first.span)));
        }
        let Some(place) = given.get_mut(at) else { return };
        match place {
            Some(first) => {
                let first = first.span;
                self.report(bindings::joint_named_twice(&joint.text, joint.span, first));
            }
            None => *place = Some(part),
        }
    }

    /// What its description calls each of an arm's joints; otherwise the end of its name.
    fn joint_own_names(&self, body: DeviceBody) -> Vec<String> {
        let (Some(world), DeviceBody::Arm(arm)) = (&self.s.world, body) else { return Vec::new() };
        let joints = world.arms.get(usize::from(arm.0)).map(|a| a.joints.as_slice()).unwrap_or_default();
        let joints = joints.iter().filter_map(|id| world.joints.get(usize::from(id.0)));
        joints.map(|joint| joint.own_name.clone().unwrap_or_else(|| last_name(&joint.name))).collect()
    }

    /// The joints of an arm, from its base, by their full names.
    fn arm_joints(&self, body: DeviceBody) -> Vec<String> {
        let (Some(world), DeviceBody::Arm(arm)) = (&self.s.world, body) else { return Vec::new() };
        let joints = world.arms.get(usize::from(arm.0)).map(|a| a.joints.as_slice()).unwrap_or_default();
        let name = |id: &crate::JointId| world.joints.get(usize::from(id.0)).map(|j| j.name.clone());
        joints.iter().filter_map(name).collect()
    }
}

/// `hip` of `robot.hip`
fn last_name(full: &str) -> String {
    full.rsplit('.').next().unwrap_or(full).to_owned()
}
