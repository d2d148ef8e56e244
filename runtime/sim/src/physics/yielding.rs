//! Contacts with what yields: the surfaces of people are springs, and the force of a blow is that of ISO/TS 15066.
//!
//! A body with a stiffness meets whatever can move as a mass on a spring: its surface gives way by δ, and pushes back with k δ (ISO/TS
//! 15066:2016, Annex A, equation A.5, where E = F²/2k). A blow at the speed v of two masses whose reduced mass is μ comes to v √(k μ).
//! When the surface springs back, it gives less than it took: unloading is stiffer, by a constant factor (Walton and Braun 1986), so
//! that a body leaves as [`RESTITUTION`](super::state::yielding::RESTITUTION) says, and the peak is as without it. The force acts on the middle of what yields, and
//! friction across it.
//!
//! Blows last for few milliseconds: a step in which such bodies meet is divided, as finely as stiffness and masses ask for.

use hrdsl_ir::world::{BodyId, BodyMotion, ContactPhase, World};
use rapier3d::prelude::*;

use super::division::{NEAR, SweptBodies};
use super::state::{
    adapter::PhysicsAdapter,
    bodies::{body_id, index},
    loads::ContactLoads,
    yielding::{YieldingContact, YieldingPair},
};
use crate::math::{SpaceVector, from_vector, to_vector};

/// How fast a dent comes back while something is still pressed into it, s: an assumption, too.
const RECOVERY: f64 = 0.1;
/// What friction is on all surfaces.
const FRICTION: f64 = 0.8;
/// Which part of 1/ω a part of a step may last: in a blow, and when surfaces hardly move any more.
const FINE: f64 = 0.25;
const COARSE: f64 = 0.5;
/// Below this speed of approach it is no blow, m/s.
const SLOW: f64 = 0.02;
/// The most parts of a step.
const MOST_PARTS: f64 = 64.0;
/// What begins again within this time is the same contact, s.
const SAME: f64 = 0.1;

/// What is found of a pair before its surfaces meet.
pub(super) struct NearPair {
    pub at: usize,
    /// The frequency of its masses on its spring, 1/s.
    frequency: f64,
    /// m/s
    approach: f64,
}

impl PhysicsAdapter {
    /// Finds what yields, and what it may meet: everything that can move and is not of the same figure.
    pub(super) fn find_yielding(&mut self, world: &World, figure_of: &[Option<usize>]) {
        for (i, body) in world.bodies.iter().enumerate() {
            let Some(stiffness) = body.stiffness.filter(|_| !body.ghost) else { continue };
            for j in 0..world.bodies.len() {
                let root = index(self.parts[j].root);
                let is_own = i == j || (figure_of[i].is_some() && figure_of[i] == figure_of[j]);
                let is_met = world.bodies[j].stiffness.is_some() && j < i;
                let is_frame = self.world.colliders.get(self.parts[j].collider).is_none();
                if is_own
                    || is_met
                    || is_frame
                    || self.parts[j].ghost
                    || world.bodies[root].motion == BodyMotion::Fixed
                {
                    continue;
                }
                let stiffness =
                    world.bodies[j].stiffness.map_or(stiffness, |k| 1.0 / (1.0 / k + 1.0 / stiffness));
                let pair = YieldingPair { soft: i, other: j, stiffness, is_suspended: false };
                self.yielding.add(pair, figure_of[i]);
                self.exempt.yields(i, j);
                self.filter(i);
                self.filter(j);
            }
        }
    }

    /// A hand holds a body, or no longer: meanwhile it does not press it.
    pub(super) fn suspend(&mut self, a: BodyId, b: BodyId, is_suspended: bool) {
        let (a, b) = (index(a), index(b));
        for (at, pair) in self.yielding.pairs.iter_mut().enumerate() {
            if (pair.soft, pair.other) == (a, b) || (pair.soft, pair.other) == (b, a) {
                pair.is_suspended = is_suspended;
                self.yielding.contacts.remove(&at);
            }
        }
    }

    /// The pairs that may touch within a step.
    pub(super) fn near_pairs(&mut self, swept: &SweptBodies, dt: f64) -> Vec<NearPair> {
        self.yielding.contacts.retain(|_, contact| {
            (contact.peaks, contact.impulse, contact.force) = ([0.0; 2], 0.0, 0.0);
            contact.parted += dt;
            contact.parted < SAME
        });
        let mut near = Vec::new();
        let groups =
            self.yielding.groups.iter().filter(|group| swept.may_any_meet(&group.softs, &group.others));
        for (at, pair) in
            groups.flat_map(|group| group.pairs.clone()).map(|at| (at, &self.yielding.pairs[at]))
        {
            let (soft, other) = (pair.soft, pair.other);
            if pair.is_suspended || !swept.may_meet(soft, other) {
                continue;
            }
            let reach = NEAR + (swept.speeds[soft] + swept.speeds[other]) * dt;
            let Some(found) = self.closest(soft, other, reach) else { continue };
            let (a, b) =
                (&self.world.bodies[self.parts[soft].handle], &self.world.bodies[self.parts[other].handle]);
            let inverse =
                |body: &RigidBody| if body.is_dynamic() { 1.0 / f64::from(body.mass()) } else { 0.0 };
            let approach =
                from_vector(a.linvel() - b.velocity_at_point(found.point2)).dot(&from_vector(found.normal1));
            // Those that cannot meet within the step need no finer one.
            if f64::from(found.dist) > approach.max(0.0) * dt + NEAR {
                continue;
            }
            let frequency = (pair.stiffness * (inverse(a) + inverse(b))).sqrt();
            near.push(NearPair { at, frequency, approach });
        }
        near
    }

    /// Lets the surfaces of a pair press on each other for a part of a step.
    pub(super) fn press(&mut self, at: usize, h: f64) {
        let YieldingPair { soft, other, stiffness, .. } = self.yielding.pairs[at];
        let Some(found) = self.closest(soft, other, 0.0).filter(|c| c.dist < 0.0) else {
            // A dent is gone when the surfaces have parted.
            if let Some(contact) = self.yielding.contacts.get_mut(&at) {
                (contact.deepest, contact.force) = (0.0, 0.0);
            }
            return;
        };
        let normal = -from_vector(found.normal1);
        let depth = -f64::from(found.dist);
        let new = || YieldingContact::new(normal);
        let contact = self.yielding.contacts.entry(at).or_insert_with(new);
        let force = contact.force_at(depth, stiffness);
        // What was pressed in more deeply comes back.
        contact.deepest = depth.max(contact.deepest - (contact.deepest - depth) * (h / RECOVERY).min(1.0));
        contact.force = force;
        contact.impulse += force * h;
        contact.normal = normal;
        contact.age += h;
        contact.parted = 0.0;
        self.push_apart((soft, other), found.point2, normal * force, h);
    }

    /// After a part of a step: tells contacts in which something else holds the body against it.
    pub(super) fn note_presses(&mut self, near: &[NearPair], loads: &ContactLoads, h: f64) {
        let contacts = &self.yielding.contacts;
        let pressing = |at: usize| contacts.get(&at).copied().filter(|contact| contact.force > 0.0);
        let against: Vec<(usize, f64)> = near
            .iter()
            .filter_map(|pair| pressing(pair.at).map(|contact| (pair.at, contact)))
            .map(|(at, contact)| {
                let soft = self.yielding.pairs[at].soft;
                let others = self.yielding.touching().filter(|(other, ..)| *other != at);
                let others = others.filter_map(|(_, pair, contact)| {
                    let push = contact.normal * contact.force;
                    if pair.soft == soft { Some(push) } else { (pair.other == soft).then_some(-push) }
                });
                let pushes = loads.on(soft).map(|(_, push)| push).chain(others);
                (at, pushes.map(|push| (-push.dot(&contact.normal)).max(0.0)).sum())
            })
            .collect();
        for (at, against) in against {
            if let Some(contact) = self.yielding.contacts.get_mut(&at) {
                contact.note(against, h);
            }
        }
    }

    /// The force on the body that yields, and its opposite on the other; with the friction that goes with it.
    fn push_apart(&mut self, (soft, other): (usize, usize), point: Vector, force: SpaceVector, h: f64) {
        let (a, b) = (self.parts[soft].handle, self.parts[other].handle);
        let (one, two) = (&self.world.bodies[a], &self.world.bodies[b]);
        let yields = self.guides[other].is_some();
        let there = if yields { two.linvel() } else { two.velocity_at_point(point) };
        let slip = from_vector(one.linvel() - there);
        let size = force.norm();
        let across =
            if size > 0.0 { slip - force * (slip.dot(&force) / (size * size)) } else { SpaceVector::zeros() };
        let mass = |body: &RigidBody| if body.is_dynamic() { f64::from(body.mass()) } else { f64::INFINITY };
        let stops = mass(one).min(mass(two)) / 2.0;
        let rub = across.norm();
        let friction = if rub > 0.0 {
            across * (-(FRICTION * size * h).min(stops * rub) / rub)
        } else {
            SpaceVector::zeros()
        };
        let impulse = force * h + friction;
        self.world.bodies[a].apply_impulse(to_vector(impulse), true);
        let two = &mut self.world.bodies[b];
        if yields {
            two.apply_impulse(to_vector(-impulse), true);
        } else if two.is_dynamic() {
            two.apply_impulse_at_point(to_vector(-impulse), point, true);
        }
    }

    // ── What is measured ──

    /// The force on a body of each that it meets in such a contact: the greatest of the last step, N.
    pub(super) fn yielding_pushes(&self, body: BodyId) -> impl Iterator<Item = (BodyId, SpaceVector)> + '_ {
        let own = index(body);
        self.yielding.touching().filter(|(.., contact)| contact.peak() > 0.0).filter_map(
            move |(_, pair, contact)| {
                let push = contact.normal * contact.peak();
                if pair.soft == own {
                    Some((body_id(pair.other), push))
                } else if pair.other == own {
                    Some((body_id(pair.soft), -push))
                } else {
                    None
                }
            },
        )
    }

    /// How hard others, or one of them, press on what yields in contacts of a kind, N.
    pub fn pressed(&self, body: BodyId, by: Option<BodyId>, phase: ContactPhase) -> f64 {
        let own = index(body);
        let of = self.yielding.touching().filter(|(_, pair, _)| {
            let other = if pair.soft == own { pair.other } else { pair.soft };
            (pair.soft == own || pair.other == own) && by.is_none_or(|by| index(by) == other)
        });
        of.map(|(.., contact)| contact.peaks[usize::from(phase == ContactPhase::QuasiStatic)]).sum()
    }

    /// The level part of what pressed on a body in such contacts over the last step, N·s.
    pub fn level_impulse(&self, body: BodyId) -> SpaceVector {
        let own = index(body);
        let mut sum = SpaceVector::zeros();
        for (_, pair, contact) in self.yielding.touching() {
            if pair.soft == own {
                sum += contact.normal * contact.impulse;
            } else if pair.other == own {
                sum -= contact.normal * contact.impulse;
            }
        }
        SpaceVector::new(sum.x, sum.y, 0.0)
    }
}

impl NearPair {
    /// How many parts of a step it asks for.
    pub(super) fn parts(&self, dt: f64) -> f64 {
        let fine = if self.approach > SLOW { FINE } else { COARSE };
        (dt * self.frequency / fine).ceil().clamp(1.0, MOST_PARTS)
    }
}
