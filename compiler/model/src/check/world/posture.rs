//! Postures of arms: angles of all joints under a name, by which programs ask for them, and what an arm goes through on its way there.

use hrdsl_ir::world::{JointMotion, NamedPosture, PosturePoint};
use hrdsl_syntax::ast::{ExprSyntax, ExprSyntaxKind as Syntax, WorldMemberKind as Member};

use crate::check::world::parts::PlacedMember;
use crate::check::{template::CheckerPhase, world::phase::WorldPhase};
use crate::{
    Dimension, JointId,
    noun::Noun,
    report::{
        names, types,
        world::{no_angles, no_point},
    },
};

/// What limits may be exceeded by, from being written in decimal degrees.
const ROUNDING: f64 = 1e-9;

impl<'a> WorldPhase<'_, 'a> {
    pub(super) fn posture(&mut self, p: &PlacedMember<'a>) {
        let Member::Posture(posture) = &p.member.kind else { return };
        let arm = self.world_name(Noun::Arm, &posture.arm.names, &p.prefix);
        let joints = arm.and_then(|arm| self.world_mut().arms.get(usize::from(arm)));
        let joints = joints.map(|arm| arm.joints.clone());
        let Syntax::List { items, rest: None } = &posture.angles.kind else {
            self.report(no_angles(posture.angles.span));
            return;
        };
        let is_timed = items.iter().any(|item| matches!(item.kind, Syntax::Tuple(_)));
        let points = if is_timed { self.points(items, joints.as_deref()) } else { Some(Vec::new()) };
        let angles = match &points {
            Some(points) if is_timed => points.last().map(|point| point.angles.clone()),
            Some(_) => self.angles(&posture.angles, joints.as_deref()),
            None => None,
        };
        let (Some(arm), Some(angles), Some(points)) = (arm, angles, points) else { return };
        let name = &posture.name;
        let Some(arm) = self.world_mut().arms.get_mut(usize::from(arm)) else { return };
        if arm.postures.iter().any(|known| known.name == name.text) {
            self.report(names::duplicate(Noun::Posture, &name.text, name.span, None));
            return;
        }
        arm.postures.push(NamedPosture { name: name.text.clone(), angles, points });
    }

    /// Points on the way of a posture: `(angles, time)`, in order of time.
    fn points(&mut self, items: &[ExprSyntax], joints: Option<&[JointId]>) -> Option<Vec<PosturePoint>> {
        let mut points = Vec::new();
        let mut before: Option<f64> = None;
        for item in items {
            let parts = if let Syntax::Tuple(parts) = &item.kind { parts.as_slice() } else { &[] };
            let [angles, time] = parts else {
                self.report(no_point(item.span));
                return None;
            };
            let (read, at) = (self.angles(angles, joints), self.quantity_of(time, Dimension::TIME));
            if let Some(at) = at {
                if at < 0.0 || before.is_some_and(|before| at <= before) {
                    let rule = "later than that of the point before it, and not before the beginning";
                    self.report(types::must_be("the time of a point", rule, time.span));
                }
                before = Some(at);
            }
            points.push(read.zip(at).map(|(angles, time)| PosturePoint { time, angles }));
        }
        points.into_iter().collect()
    }

    /// The angles of all joints of an arm; without an arm they are only looked at.
    fn angles(&mut self, written: &ExprSyntax, joints: Option<&[JointId]>) -> Option<Vec<f64>> {
        let Syntax::List { items, rest: None } = &written.kind else {
            self.report(no_angles(written.span));
            return None;
        };
        // Of a slider it is a length; where there is no joint, an angle is as good as anything.
        let joint = |at: usize| joints.and_then(|joints| joints.get(at));
        let sizes: Vec<Dimension> = (0..items.len()).map(|at| self.size_of(joint(at))).collect();
        let angles = items.iter().zip(sizes).map(|(e, size)| self.quantity_of(e, size));
        let angles: Vec<Option<f64>> = angles.collect();
        let joints = joints?;
        if joints.len() != items.len() {
            let want = format!("a list of {} angles", joints.len());
            self.report(types::other_shape(&want, &format!("one of {}", items.len()), written.span));
            return None;
        }
        for ((joint, angle), written) in joints.iter().zip(&angles).zip(items) {
            self.within_limits(*joint, *angle, written);
        }
        angles.into_iter().collect()
    }

    /// Of what dimension the place of a joint is.
    fn size_of(&mut self, joint: Option<&JointId>) -> Dimension {
        let joint = joint.and_then(|joint| self.world_mut().joints.get(usize::from(joint.0)));
        match joint.map(|joint| joint.motion) {
            Some(JointMotion::Slider) => Dimension::LENGTH,
            Some(JointMotion::Hinge) | None => Dimension::ANGLE,
        }
    }

    fn within_limits(&mut self, joint: JointId, angle: Option<f64>, written: &ExprSyntax) {
        let Some(joint) = self.world_mut().joints.get(usize::from(joint.0)) else { return };
        let Some(angle) = angle else { return };
        if angle < joint.lo - ROUNDING || angle > joint.hi + ROUNDING {
            let (unit, what, of_unit) = match joint.motion {
                JointMotion::Hinge => ("deg", "angle", f64::to_degrees as fn(f64) -> f64),
                JointMotion::Slider => ("cm", "place", (|x| x * 100.0) as fn(f64) -> f64),
            };
            let rounded = |x: f64| (of_unit(x) * 10.0).round() / 10.0;
            let rule =
                format!("between its limits, {} {unit} .. {} {unit}", rounded(joint.lo), rounded(joint.hi));
            let issue = types::must_be(&format!("the {what} of `{}`", joint.name), &rule, written.span);
            self.report(issue);
        }
    }
}
