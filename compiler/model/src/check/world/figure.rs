//! People: limbs, and the figures that they are of.

use hrdsl_ir::world::{Figure, Limb};
use hrdsl_syntax::ast::{NameSyntax, WorldMemberKind as Member};

use crate::check::world::parts::PlacedMember;
use crate::check::{template::CheckerPhase, world::phase::WorldPhase};
use crate::{
    BodyId, BodyMotion, Dimension,
    noun::Noun,
    report::{types, world::bad_world},
};

use super::LENGTH;

impl<'a> WorldPhase<'_, 'a> {
    pub(super) fn limb(&mut self, p: &PlacedMember<'a>) {
        let Member::Limb(limb) = &p.member.kind else { return };
        if !(3..=4).contains(&limb.bodies.len()) {
            let message = "a limb hangs on a body, has two bones, and perhaps something at its end";
            let help = "write `limb arm: trunk -> upper_arm -> forearm -> hand at SHOULDER, ELBOW, WRIST`";
            self.report(bad_world(limb.name.span, message, help));
        }
        if limb.pivots.len() != 3 {
            let span = limb.pivots.first().map_or(limb.name.span, |first| first.span);
            let help = "give the places of shoulder, elbow and wrist, or of hip, knee and ankle";
            self.report(bad_world(span, "a limb turns about three points", help));
        }
        let bodies = self.guided_bodies(&limb.bodies, &p.prefix);
        let pivots: Vec<Option<[f64; 3]>> =
            limb.pivots.iter().map(|pivot| self.vector(pivot, LENGTH)).collect();
        let full = format!("{}{}", p.prefix, limb.name.text);
        let (issues, table) = (&mut self.checker.issues, &mut self.checker.world.names.limbs);
        if issues.declare_as(table, Noun::Limb, &full, limb.name.span).is_some() {
            let body = |i: usize| bodies.get(i).copied().flatten();
            let pivot = |i: usize| p.frame.place(pivots.get(i).copied().flatten().unwrap_or_default());
            self.world_mut().limbs.push(Limb {
                name: full,
                of: body(0).unwrap_or(BodyId(0)),
                upper: body(1).unwrap_or(BodyId(0)),
                lower: body(2).unwrap_or(BodyId(0)),
                end: body(3),
                pivots: [pivot(0), pivot(1), pivot(2)],
            });
        }
    }

    pub(super) fn figure(&mut self, p: &PlacedMember<'a>) {
        let Member::Figure(figure) = &p.member.kind else { return };
        let name = &figure.name;
        if figure.bodies.len() != 3 {
            let help = "write `figure all: pelvis -> trunk -> head at HIP …`";
            self.report(bad_world(name.span, "a figure is a pelvis, a trunk and a head", help));
        }
        let bodies = self.guided_bodies(&figure.bodies, &p.prefix);
        let hip = self.vector(&figure.hip, LENGTH).unwrap_or_default();
        let speed = self.more_than_zero(&figure.speed, Dimension::SPEED, "the speed");
        let turn = self.more_than_zero(&figure.turn, Dimension::ANGULAR_SPEED, "the speed of a turn");
        let mass = self.more_than_zero(&figure.mass, Dimension::MASS, "a mass");
        let body = |i: usize| bodies.get(i).copied().flatten().unwrap_or(BodyId(0));
        let (pelvis, trunk, head) = (body(0), body(1), body(2));
        let mut limbs = Vec::new();
        for limb in &figure.limbs {
            let id = self.world_name(Noun::Limb, std::slice::from_ref(limb), &p.prefix);
            let known = id.and_then(|id| self.world_mut().limbs.get(usize::from(id)).cloned());
            let Some(known) = known else { continue };
            if bodies.iter().all(Option::is_some) && known.of != pelvis && known.of != trunk {
                let message =
                    format!("the limb `{}` hangs neither on the trunk nor on the pelvis", limb.text);
                self.report(bad_world(limb.span, message, "begin the limb with one of the figure's bodies"));
            }
            limbs.push(known);
        }
        let full = format!("{}{}", p.prefix, name.text);
        let (issues, table) = (&mut self.checker.issues, &mut self.checker.world.names.figures);
        if issues.declare_as(table, Noun::Figure, &full, name.span).is_some() {
            self.world_mut().figures.push(Figure {
                name: full,
                pelvis,
                trunk,
                head,
                hip: p.frame.place(hip),
                limbs,
                speed: speed.unwrap_or(0.0),
                turn: turn.unwrap_or(0.0),
                mass: mass.unwrap_or(0.0),
            });
        }
        self.in_one_figure(&figure.bodies, &bodies);
    }

    /// Bodies of somebody alive.
    fn guided_bodies(&mut self, names: &[NameSyntax], prefix: &str) -> Vec<Option<BodyId>> {
        let mut found = Vec::new();
        for name in names {
            let body = self.local_body(name, prefix);
            let motion = body.and_then(|id| self.world_mut().bodies.get(usize::from(id.0)).map(|b| b.motion));
            if motion.is_some_and(|motion| motion != BodyMotion::Guided) {
                let message = format!("the body `{}` of a figure is not guided", name.text);
                self.report(bad_world(name.span, message, "declare the body as `guided`"));
            }
            found.push(body);
        }
        found
    }

    /// A body is of one figure.
    fn in_one_figure(&mut self, names: &[NameSyntax], bodies: &[Option<BodyId>]) {
        for (name, body) in names.iter().zip(bodies) {
            let Some(body) = body else { continue };
            let of = |f: &&Figure| [f.pelvis, f.trunk, f.head].contains(body);
            let figures: Vec<String> =
                self.world_mut().figures.iter().filter(of).map(|f| f.name.clone()).collect();
            if let [first, _, ..] = figures.as_slice() {
                let message = format!("`{}` is of the figure `{first}` already", name.text);
                self.report(types::no_value("this body", name.span).help(message));
            }
        }
    }
}
