//! Groups of joints: the names by which programs plan the motions of an arm, and what they are told of it.

use hrdsl_ir::{
    binding::PlanningGroup,
    device::DeviceBody,
    world::{ArmId, DeviceId},
};
use hrdsl_syntax::ast::{BindingEntryKind as Entry, GroupSyntax};

use crate::check::{binding::phase::BindingPhase, template::CheckerPhase};
use crate::{Dimension, noun::Noun, report::bindings};

impl BindingPhase<'_, '_> {
    pub(super) fn planning_group(&mut self, group: &GroupSyntax) -> Option<PlanningGroup> {
        let written = group.acceleration.as_ref();
        let acceleration =
            written.map(|e| self.more_than_zero(e, Dimension::ANGULAR_ACCELERATION, "the acceleration"));
        let arm = self.world_name(Noun::Arm, &group.device.names, "")?;
        let joints = self.joint_texts(&group.device, DeviceBody::Arm(ArmId(arm)), &group.entries);
        for entry in &group.entries {
            match &entry.kind {
                Entry::Field { .. } | Entry::Emit { .. } | Entry::Command { .. } => {
                    self.report(bindings::joints_only(entry.span));
                }
                Entry::Joint { .. } | Entry::Error => {}
            }
        }
        let tip = group.tip.as_ref().map(|tip| tip.text.clone());
        let name = group.name.text.clone();
        let tip = tip.or_else(|| self.tip_name(arm)).unwrap_or_default();
        Some(PlanningGroup { name, device: DeviceId(arm), joints, tip, acceleration: acceleration.flatten() })
    }

    /// The body that an arm brings to places, without the prefix of its part.
    fn tip_name(&self, arm: u16) -> Option<String> {
        let world = self.s.world.as_ref()?;
        let tip = world.arms.get(usize::from(arm))?.tip;
        let body = world.bodies.get(usize::from(tip.0))?;
        body.own_name.clone().or_else(|| body.name.rsplit('.').next().map(str::to_owned))
    }
}
