//! Where the joints of a description are at the start.

use hrdsl_robots::{RobotReading, SrdfState, UrdfJoint, UrdfJointKind};
use hrdsl_syntax::ast::{
    ExprSyntax, NameSyntax, PartSyntax, StartSyntax, TextSyntax, WorldMemberKind as Member,
};

use crate::check::{template::CheckerPhase, world::phase::WorldPhase};
use crate::{
    Dimension,
    noun::Noun,
    report::{names, types, world::bad_world},
};

use super::links::spelling;

/// What limits may be exceeded by, from being written in decimals.
const ROUNDING: f64 = 1e-9;

/// By joint, those that mimic with what they follow.
pub(super) struct StartValues {
    pub values: Vec<f64>,
}

impl StartValues {
    /// What a part says of the start; all other joints are at 0, or in the middle of their limits if these do not have it.
    pub fn of(world: &mut WorldPhase<'_, '_>, part: &PartSyntax, reading: &RobotReading) -> Self {
        let Some(robot) = &reading.robot else { return Self { values: Vec::new() } };
        let mut values: Vec<f64> = robot.joints.iter().map(by_itself).collect();
        for member in &part.members {
            let Member::Start(starts) = &member.kind else { continue };
            for start in starts {
                match start {
                    StartSyntax::State(name) => world.start_as(name, reading, &mut values),
                    StartSyntax::Joint { joint, value } => {
                        world.start_at(joint, value, reading, &mut values);
                    }
                }
            }
        }
        Self { values: robot.followed(&values) }
    }
}

fn by_itself(joint: &UrdfJoint) -> f64 {
    match joint.limits {
        Some(limits) if joint.kind.has_range() && !(limits.lower..=limits.upper).contains(&0.0) => {
            (limits.lower + limits.upper) / 2.0
        }
        Some(_) | None => 0.0,
    }
}

impl WorldPhase<'_, '_> {
    /// `start "ready"`
    fn start_as(&mut self, name: &TextSyntax, reading: &RobotReading, values: &mut [f64]) {
        let (Some(robot), Some(semantics)) = (&reading.robot, &reading.semantics) else {
            let message = "states of groups are in the semantics of a description, and none are named";
            self.report(bad_world(name.span, message, "write `semantics \"robot.srdf\"`"));
            return;
        };
        let found: Vec<&SrdfState> =
            semantics.states.iter().filter(|state| state.name == name.text).collect();
        if found.is_empty() {
            let near = semantics.states.iter().map(|state| state.name.as_str());
            self.report(names::unknown(Noun::Posture, &name.text, name.span, near));
        }
        // Several groups may have a state of this name.
        for (joint, given) in found.iter().flat_map(|state| &state.values) {
            let Some(id) = robot.joint_named(joint) else { continue };
            let of = robot.joint(id).filter(|joint| joint.kind.has_one_value());
            if let (Some(joint), [value], Some(slot)) = (of, given.as_slice(), values.get_mut(id.0))
                && within(joint, *value)
            {
                *slot = *value;
            }
        }
    }

    /// `start elbow = 90 deg`
    fn start_at(
        &mut self,
        name: &NameSyntax,
        value: &ExprSyntax,
        reading: &RobotReading,
        values: &mut [f64],
    ) {
        let Some(robot) = &reading.robot else { return };
        let Some(at) = robot.joints.iter().position(|joint| spelling(&joint.name) == name.text) else {
            let near: Vec<String> = robot.joints.iter().map(|joint| spelling(&joint.name)).collect();
            self.report(names::unknown(Noun::Joint, &name.text, name.span, near.iter().map(String::as_str)));
            return;
        };
        let Some(joint) = robot.joints.get(at) else { return };
        self.refer(name, Some(joint.place.span));
        let dim = if joint.kind == UrdfJointKind::Prismatic { Dimension::LENGTH } else { Dimension::ANGLE };
        let Some(given) = self.quantity_of(value, dim) else { return };
        if !joint.kind.has_one_value() || joint.mimic.is_some() {
            let why = if joint.mimic.is_some() { "follows another" } else { "does not move" };
            let message = format!("the joint `{}` {why}", name.text);
            self.report(bad_world(name.span, message, "leave it out"));
        } else if !within(joint, given) {
            let what = format!("the start of `{}`", name.text);
            self.report(types::must_be(&what, "within the limits of the description", value.span));
        } else if let Some(slot) = values.get_mut(at) {
            *slot = given;
        }
    }
}

fn within(joint: &UrdfJoint, value: f64) -> bool {
    let inside = |l: hrdsl_robots::UrdfLimits| (l.lower - ROUNDING..=l.upper + ROUNDING).contains(&value);
    !joint.kind.has_range() || joint.limits.is_none_or(inside)
}
