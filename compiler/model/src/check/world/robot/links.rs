//! The links of a description as bodies, and how its names are written.

use std::{collections::BTreeMap, sync::Arc};

use hrdsl_robots::{RobotPlace, RobotReading};
use hrdsl_syntax::{
    ast::{PartSyntax, WorldMemberKind as Member},
    token::{KEYWORDS, KeywordClass},
};

use crate::check::{state::robot::PlacedRobot, world::parts::PlacedMember};
use crate::check::{template::CheckerPhase, world::phase::WorldPhase};
use crate::{
    BodyId, BodyMotion,
    descriptions::DescriptionRequest,
    noun::Noun,
    report::world::{bad_world, unlike_names},
    world::TypedBody,
};

use super::start::StartValues;

impl<'a> WorldPhase<'_, 'a> {
    /// The bodies of a part's description. What is wrong with the description itself was said when it was read.
    pub(in crate::check::world) fn described_bodies(&mut self, p: &PlacedMember<'a>) {
        if !matches!(p.member.kind, Member::Robot(_)) {
            return;
        }
        let Some((part, reading)) = self.reading_of(p) else {
            // Nothing is known of what it has.
            self.world.names.broken.insert(p.prefix.trim_end_matches('.').to_owned());
            return;
        };
        let Some(robot) = reading.robot.as_ref() else { return };
        let root_motion = motion_of_root(part);
        let start = StartValues::of(self, part, &reading);
        let poses = robot.link_poses(&start.values);
        let link = |of: &hrdsl_robots::UrdfLink| (of.name.clone(), of.place);
        let Some(names) = self.spelled(robot.links.iter().map(link), Noun::Body) else {
            self.world.names.broken.insert(p.prefix.trim_end_matches('.').to_owned());
            return;
        };
        let mut maker = std::mem::take(&mut self.solids);
        let mut bodies = Vec::new();
        for ((at, link), (name, pose)) in robot.links.iter().enumerate().zip(names.iter().zip(&poses)) {
            let is_root = robot.root.0 == at;
            let motion = if is_root { root_motion } else { BodyMotion::Dynamic };
            let full = format!("{}{name}", p.prefix);
            let span = link.place.span;
            self.world.names.members += 1;
            let (issues, table) = (&mut self.checker.issues, &mut self.checker.world.names.bodies);
            let Some(id) = issues.declare_as(table, Noun::Body, &full, span) else { continue };
            let (solid, shape) = maker.solid(link, &reading);
            let own_name = (*name != link.name).then(|| link.name.clone());
            let ghost = solid.is_frame();
            bodies.push(BodyId(id));
            self.world_mut().bodies.push(TypedBody {
                name: full,
                motion,
                shape,
                frame: p.frame,
                position: pose.translation,
                rotation: pose.rpy(),
                mass: link.inertial.map_or(0.0, |inertial| inertial.mass),
                ghost,
                stiffness: None,
                graspable: false,
                solid: Some(hrdsl_ir::solid::SharedData::new(solid)),
                own_name,
                span,
            });
        }
        self.solids = maker;
        let (joints, values) = (Vec::new(), start.values);
        let whole = bodies.len() == robot.links.len();
        let placed = PlacedRobot { prefix: p.prefix.clone(), reading, bodies, joints, values, poses };
        if whole {
            self.robots.push(placed);
        }
    }

    /// The part that a member is of, and its description, if nothing is wrong with that.
    fn reading_of(&self, p: &PlacedMember<'a>) -> Option<(&'a PartSyntax, Arc<RobotReading>)> {
        let is = |part: &&'a PartSyntax| part.description.as_ref().is_some_and(|d| d.span == p.member.span);
        let part = self.parts.values().map(|(part, _)| *part).find(is)?;
        let library = self.source.descriptions?;
        let reading = library.robot(p.member.span.file, &DescriptionRequest::of(part)?)?;
        reading.is_sound().then_some((part, reading))
    }

    /// The description of the part with this prefix.
    pub(in crate::check) fn robot_at(&self, prefix: &str) -> Option<&PlacedRobot> {
        self.robots.iter().find(|robot| robot.prefix == prefix)
    }

    /// Names of a description as they are written in the language; `None`: two are written alike.
    pub(super) fn spelled(
        &mut self,
        names: impl Iterator<Item = (String, RobotPlace)>,
        noun: Noun,
    ) -> Option<Vec<String>> {
        let mut known: BTreeMap<String, (String, RobotPlace)> = BTreeMap::new();
        let (mut all, before) = (Vec::new(), self.issues.list.len());
        for (name, place) in names {
            let spelling = spelling(&name);
            if let Some((first, at)) = known.get(&spelling) {
                self.report(unlike_names(noun, &name, first, &spelling, place.span, at.span));
            } else {
                known.insert(spelling.clone(), (name, place));
            }
            all.push(spelling);
        }
        (self.issues.list.len() == before).then_some(all)
    }

    /// What only a part from a description has.
    pub(in crate::check::world) fn of_descriptions(&mut self, p: &PlacedMember<'a>) {
        let kind = &p.member.kind;
        let words = [
            ("packages", matches!(kind, Member::Packages(_))),
            ("argument", matches!(kind, Member::Argument { .. })),
            ("semantics", matches!(kind, Member::Semantics(_))),
            ("start", matches!(kind, Member::Start(_))),
        ];
        let Some((word, _)) = words.into_iter().find(|(_, is)| *is) else { return };
        let prefix = p.prefix.trim_end_matches('.');
        if self.robot_at(&p.prefix).is_none() && !self.world.names.broken.contains(prefix) {
            let message = format!("`{word}` speaks of a description, and nothing here is made from one");
            let help = "write it in a part that is: `part NAME from \"robot.urdf\" { … }`";
            self.report(bad_world(p.member.span, message, help));
        }
    }
}

/// Without a base, a robot stands fixed.
fn motion_of_root(part: &PartSyntax) -> BodyMotion {
    let base =
        part.members.iter().find_map(|m| if let Member::Base(base) = &m.kind { Some(base) } else { None });
    match base.map(|base| base.motion.as_ref()) {
        Some(Some(motion)) if motion.text == "dynamic" => BodyMotion::Dynamic,
        Some(_) => BodyMotion::Kinematic,
        None => BodyMotion::Fixed,
    }
}

/// A name of a description as a name of the language: what names cannot have is `_`, and so is what is added to those that begin
/// with a digit, and to words that are no names.
pub(super) fn spelling(name: &str) -> String {
    let fits = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c } else { '_' };
    let mut spelling: String = name.chars().map(fits).collect();
    if spelling.starts_with(|c: char| c.is_ascii_digit()) || spelling.is_empty() {
        spelling.insert(0, '_');
    }
    let taken = |class| matches!(class, KeywordClass::Reserved | KeywordClass::Hard);
    if spelling == "_" || KEYWORDS.iter().any(|k| k.word == spelling && taken(k.class)) {
        spelling.push('_');
    }
    spelling
}

#[cfg(test)]
mod tests {
    use super::spelling;

    #[test]
    fn names_are_spelled_so_that_the_language_takes_them() {
        let told = ["panda_link0", "left-wheel link", "2f_85", "in", "not", "_", "", "gelenk_ä", "arm"]
            .map(spelling);
        assert_eq!(
            told,
            ["panda_link0", "left_wheel_link", "_2f_85", "in_", "not_", "__", "__", "gelenk__", "arm"]
        );
    }
}
