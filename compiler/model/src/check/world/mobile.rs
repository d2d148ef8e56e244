//! What robots that drive have: bases, and the lasers by which they see their way.

use std::f64::consts::TAU;

use hrdsl_ir::{
    sensor::SensorSource,
    value::nanos,
    world::{Base, BaseId, Laser, LaserId},
};
use hrdsl_syntax::ast::{NameSyntax, WorldMemberKind as Member};

use crate::check::world::{parts::PlacedMember, sensing::SensedKind};
use crate::check::{template::CheckerPhase, world::phase::WorldPhase};
use crate::{
    BodyId, BodyMotion, Dimension,
    noun::Noun,
    report::{types, world::bad_world},
};

use super::LENGTH;

/// More than any scanner has.
const MOST_BEAMS: i64 = 10_000;

/// What the angles of a full turn may have too much, from being written in decimal radians.
const ROUNDING: f64 = 1e-6;

impl<'a> WorldPhase<'_, 'a> {
    pub(super) fn base(&mut self, p: &PlacedMember<'a>) {
        let Member::Base(base) = &p.member.kind else { return };
        let name = &base.name;
        // A link of a description stands for all that is one with it.
        let body = self.local_body(&base.body, &p.prefix).map(|body| self.driven_root(body));
        if let Some(body) = body {
            self.drivable(&base.body, body);
        }
        if let Some(motion) = &base.motion {
            self.motion_of_described(motion, &base.body, body);
        }
        let speed = self.more_than_zero(&base.speed, Dimension::SPEED, "the speed");
        let sideways =
            base.sideways.as_ref().map(|e| self.more_than_zero(e, Dimension::SPEED, "the speed sideways"));
        let turn = self.more_than_zero(&base.turn, Dimension::ANGULAR_SPEED, "the speed of a turn");
        let acceleration =
            self.more_than_zero(&base.acceleration, Dimension::ACCELERATION, "the acceleration");
        let timeout = base.timeout.as_ref().map(|e| self.time(e, "the timeout", false));
        let full = format!("{}{}", p.prefix, name.text);
        let (issues, table) = (&mut self.checker.issues, &mut self.checker.world.names.bases);
        if let Some(id) = issues.declare_as(table, Noun::Base, &full, name.span) {
            self.sensing(&base.sensing, SensedKind::Base, (&full, SensorSource::Base(BaseId(id))));
            self.world_mut().bases.push(Base {
                name: full,
                body: body.unwrap_or(BodyId(0)),
                max_speed: speed.unwrap_or(0.0),
                max_sideways: sideways.flatten().unwrap_or(0.0),
                max_turn: turn.unwrap_or(0.0),
                acceleration: acceleration.unwrap_or(0.0),
                // None at all and none that counts are the same.
                timeout: timeout.flatten().filter(|t| *t > 0.0).map(nanos),
            });
        }
    }

    fn driven_root(&self, body: BodyId) -> BodyId {
        if self.is_of_description(body) { self.rigid_root(body) } else { body }
    }

    fn is_of_description(&self, body: BodyId) -> bool {
        self.robots.iter().any(|robot| robot.link_of(body).is_some())
    }

    /// How a base of a description moves; other bodies say so themselves.
    fn motion_of_described(&mut self, motion: &NameSyntax, name: &NameSyntax, body: Option<BodyId>) {
        self.choice(Noun::Motion, motion, &["dynamic", "kinematic"]);
        if body.is_some_and(|body| !self.is_of_description(body)) {
            let message = format!("how `{}` moves is said where it is declared", name.text);
            let help = format!("leave `{}` out here; write it before the shape of the body", motion.text);
            self.report(bad_world(motion.span, message, help));
        }
    }

    /// `laser eye: base_scan_link`: what the description says of the sensor on this link
    fn scanner(&mut self, p: &PlacedMember<'a>) {
        let Member::Scanner { name, body: link } = &p.member.kind else { return };
        let Some(body) = self.local_body(link, &p.prefix) else { return };
        let Some(robot) = self.robot_at(&p.prefix) else {
            let message = format!("nothing says what `{}` measures", name.text);
            let help =
                "write `at (0 m, 0 m, 0 m) angles -135 deg .. 135 deg beams 271 range 5 cm .. 10 m` after it";
            self.report(bad_world(name.span, message, help));
            return;
        };
        let scan = match robot.sensors_on(body).as_slice() {
            [sensor] => {
                let [roll, pitch, yaw] = sensor.origin.rpy;
                let (horizontal, flat) = (sensor.horizontal, roll == 0.0 && pitch == 0.0);
                let (lo, hi) = (horizontal.min_angle + yaw, horizontal.max_angle + yaw);
                let (nearest, farthest) = (sensor.range_min, sensor.range_max);
                let fits = i64::from(horizontal.samples) <= MOST_BEAMS
                    && (0.0..=TAU + ROUNDING).contains(&(hi - lo))
                    && nearest >= 0.0
                    && farthest > nearest;
                (flat && fits).then(|| Laser {
                    name: format!("{}{}", p.prefix, name.text),
                    body,
                    at: sensor.origin.xyz,
                    lo,
                    hi,
                    beams: u16::try_from(horizontal.samples.max(1)).unwrap_or(1),
                    nearest,
                    farthest,
                })
            }
            _ => None,
        };
        let Some(scan) = scan else {
            let message =
                format!("the description has no planar range sensor on `{}`, or several", link.text);
            let help = "say what it measures: `at (…) angles … beams … range …`";
            self.report(bad_world(link.span, message, help));
            return;
        };
        let (issues, table) = (&mut self.checker.issues, &mut self.checker.world.names.lasers);
        if issues.declare_as(table, Noun::Laser, &scan.name, name.span).is_some() {
            self.world_mut().lasers.push(scan);
        }
    }

    /// A base has a kinematic or dynamic body to itself.
    fn drivable(&mut self, name: &NameSyntax, body: BodyId) {
        let world = self.world_mut();
        let motion = world.bodies.get(usize::from(body.0)).map(|b| b.motion);
        let taken = world.bases.iter().find(|b| b.body == body).map(|b| b.name.clone());
        if matches!(motion, Some(BodyMotion::Fixed | BodyMotion::Guided)) {
            let message =
                format!("a base drives a dynamic or kinematic body, and `{}` is neither", name.text);
            let help = "declare the body as `dynamic`, or as `kinematic` if nothing is to push it";
            self.report(bad_world(name.span, message, help));
        }
        if let Some(other) = taken {
            let message = format!("`{}` is driven by the base `{other}` already", name.text);
            self.report(bad_world(name.span, message, "give each base a body of its own"));
        }
    }

    pub(super) fn lasers(&mut self, p: &PlacedMember<'a>) {
        self.laser(p);
        self.scanner(p);
    }

    fn laser(&mut self, p: &PlacedMember<'a>) {
        let Member::Laser(laser) = &p.member.kind else { return };
        let name = &laser.name;
        let body = self.local_body(&laser.body, &p.prefix).unwrap_or(BodyId(0));
        let at = self.vector(&laser.at, LENGTH).unwrap_or_default();
        let help = "write `angles -135 deg .. 135 deg`";
        let angles =
            self.ends(&laser.angles, Dimension::ANGLE, "a scan goes from one angle to another", help);
        if angles.is_some_and(|(lo, hi)| hi - lo > TAU + ROUNDING) {
            self.report(types::must_be("the angle of a scan", "at most 360 deg", laser.angles.span));
        }
        let beams = self.count(&laser.beams, "the number of beams", 1);
        if beams.is_some_and(|n| n > MOST_BEAMS) {
            let rule = format!("at most {MOST_BEAMS}");
            self.report(types::must_be("the number of beams", &rule, laser.beams.span));
        }
        let help = "write `range 10 cm .. 4 m`";
        let range = self.ends(&laser.range, Dimension::LENGTH, "a range has two ends", help);
        if range.is_some_and(|(lo, hi)| lo < 0.0 || lo == hi) {
            let rule = "at least 0 m at its lower end, and more at its upper";
            self.report(types::must_be("the range", rule, laser.range.span));
        }
        let full = format!("{}{}", p.prefix, name.text);
        let (issues, table) = (&mut self.checker.issues, &mut self.checker.world.names.lasers);
        if let Some(id) = issues.declare_as(table, Noun::Laser, &full, name.span) {
            let (lo, hi) = angles.unwrap_or_default();
            let (nearest, farthest) = range.unwrap_or_default();
            self.world_mut().lasers.push(Laser {
                name: full.clone(),
                body,
                at,
                lo,
                hi,
                beams: beams.and_then(|n| u16::try_from(n).ok()).unwrap_or(1),
                nearest,
                farthest,
            });
            self.sensing(&laser.sensing, SensedKind::Laser, (&full, SensorSource::Laser(LaserId(id))));
        }
    }
}
