//! States of groups as postures of the arms that have their joints.

use hrdsl_ir::world::{Arm, NamedPosture};
use hrdsl_robots::SrdfState;
use hrdsl_syntax::ast::WorldMemberKind as Member;

use crate::check::world::phase::WorldPhase;
use crate::check::{state::robot::PlacedRobot, world::parts::PlacedMember};

impl<'a> WorldPhase<'_, 'a> {
    pub(in crate::check::world) fn described_postures(&mut self, p: &PlacedMember<'a>) {
        if !matches!(p.member.kind, Member::Robot(_)) {
            return;
        }
        let (Some(placed), Some(world)) = (self.robot_at(&p.prefix), &self.s.world) else { return };
        let Some(semantics) = &placed.reading.semantics else { return };
        let mut found: Vec<(usize, NamedPosture)> = Vec::new();
        for (at, arm) in world.arms.iter().enumerate() {
            for state in &semantics.states {
                let Some(angles) = angles(arm, state, placed) else { continue };
                let known = |(of, posture): &(usize, NamedPosture)| *of == at && posture.name == state.name;
                if !found.iter().any(known) {
                    found.push((at, NamedPosture { name: state.name.clone(), angles, points: Vec::new() }));
                }
            }
        }
        for (at, posture) in found {
            if let Some(arm) = self.world_mut().arms.get_mut(at) {
                arm.postures.push(posture);
            }
        }
    }
}

/// Those of all joints of an arm, if the state has them, and they are within the limits.
fn angles(arm: &Arm, state: &SrdfState, placed: &PlacedRobot) -> Option<Vec<f64>> {
    let angle = |joint: &crate::JointId| {
        let (_, joint) = placed.joint_of(*joint)?;
        let (_, values) = state.values.iter().find(|(name, _)| *name == joint.name)?;
        let [value] = values.as_slice() else { return None };
        let fits = !joint.kind.has_range()
            || joint.limits.is_none_or(|limits| (limits.lower..=limits.upper).contains(value));
        fits.then_some(*value)
    };
    arm.joints.iter().map(angle).collect()
}
