//! Postures of arms: angles of all joints under a name, by which programs ask for them.

use hrdsl_ir::world::NamedPosture;
use hrdsl_syntax::ast::{ExprSyntax, ExprSyntaxKind as Syntax, WorldMemberKind as Member};

use crate::check::{checker::Checker, world::parts::PlacedMember};
use crate::{
    Dimension, JointId,
    noun::Noun,
    report::{names, types, world::no_angles},
};

/// What limits may be exceeded by, from being written in decimal degrees.
const ROUNDING: f64 = 1e-9;

impl<'a> Checker<'a> {
    pub(super) fn posture(&mut self, p: &PlacedMember<'a>) {
        let Member::Posture(posture) = &p.member.kind else { return };
        let arm = self.world_name(Noun::Arm, &posture.arm.names, &p.prefix);
        let Syntax::List { items, rest: None } = &posture.angles.kind else {
            self.report(no_angles(posture.angles.span));
            return;
        };
        let angles: Vec<Option<f64>> = items.iter().map(|e| self.quantity_of(e, Dimension::ANGLE)).collect();
        let Some(arm) = arm else { return };
        let joints = match self.world_mut().arms.get(usize::from(arm)) {
            Some(arm) => arm.joints.clone(),
            None => return,
        };
        if joints.len() != items.len() {
            let want = format!("a list of {} angles", joints.len());
            self.report(types::other_shape(&want, &format!("one of {}", items.len()), posture.angles.span));
            return;
        }
        for ((joint, angle), written) in joints.iter().zip(&angles).zip(items) {
            self.within_limits(*joint, *angle, written);
        }
        let Some(angles) = angles.into_iter().collect::<Option<Vec<f64>>>() else { return };
        let name = &posture.name;
        let Some(arm) = self.world_mut().arms.get_mut(usize::from(arm)) else { return };
        if arm.postures.iter().any(|known| known.name == name.text) {
            self.report(names::duplicate(Noun::Posture, &name.text, name.span, None));
            return;
        }
        arm.postures.push(NamedPosture { name: name.text.clone(), angles });
    }

    fn within_limits(&mut self, joint: JointId, angle: Option<f64>, written: &ExprSyntax) {
        let Some(joint) = self.world_mut().joints.get(usize::from(joint.0)) else { return };
        let Some(angle) = angle else { return };
        if angle < joint.lo - ROUNDING || angle > joint.hi + ROUNDING {
            let degrees = |x: f64| (x.to_degrees() * 10.0).round() / 10.0;
            let rule = format!("between its limits, {} deg .. {} deg", degrees(joint.lo), degrees(joint.hi));
            let issue = types::must_be(&format!("the angle of `{}`", joint.name), &rule, written.span);
            self.report(issue);
        }
    }
}
