//! How finely a step is divided: by what may meet within it, and how fast.
//!
//! The engine looks for contacts once in each step of its own, and no farther than a few centimetres around a surface: what comes from
//! farther away in that time, or swings round in it, is found inside of the other, and put out of it again only slowly. So a step in
//! which rigid bodies come together fast is done in parts, as one in which surfaces yield is.

use rapier3d::parry::{self, bounding_volume::Aabb, bounding_volume::BoundingVolume};
use rapier3d::prelude::*;

use super::SUBSTEPS;
use super::joints::STRAINED;
use super::state::{
    adapter::PhysicsAdapter,
    bodies::{body_id, index},
    guide::StepPart,
    loads::ContactLoads,
};
use crate::math::from_vector;
use hrdsl_ir::world::BodyMotion;

/// How far bodies may be apart to count as near, besides what they can do in a step, m.
pub(super) const NEAR: f64 = 2e-3;
/// Nearer than that they touch, m: what slides along something does not come to hit it.
const TOUCHING: f64 = 1e-4;
/// How much nearer to each other rigid surfaces come in a part of a step, m: the engine looks much farther around a surface, but what
/// is light takes a blow, and turns, within it.
const WAY: f64 = 1.25e-3;
/// How far the weight of a robot that falls, or lies, may move its surfaces in one, m.
const PUSHED: f64 = 3e-4;
/// The most parts that rigid bodies ask for.
const MOST_PARTS: f64 = 32.0;

/// How often the solver goes over all joints and contacts in parts shorter than those of an undivided step, at least: with two, an arm of
/// seven joints would give way to what it strikes as if it were a tenth lighter.
const SWEEPS_OF_SHORT: usize = 4;
/// So deep in each other the solver has not made bodies part as they came, m: light ones that heavy ones press, say, to the floor. What it
/// then does in a hurry, and does not take back, would fling the heavy one off.
const TOO_DEEP: f64 = 1e-3;
/// How often the solver goes over all joints and contacts while a robot or a person falls, or lies, or a light tip takes a blow: a robot of
/// 66 kg that falls on a finger of 50 g would tear it off, and so would a leg of 500 g that is drawn along it, unless that hands on what it
/// takes. And while something fast strikes another, which hands the blow on, to the floor that it lies on, say; while a joint is pressed
/// beyond its limit, or bodies are too deep in each other.
pub(super) const MANY_SWEEPS: usize = 64;
/// Where one is heavier than the other by more than so many times, more often in proportion: what comes to a light lever on its stop goes
/// on by as much as one is lighter than the other, in each of them.
const RATIO: f64 = 16.0;
/// The most: more often, in proportion, too, where a joint of what falls is farther apart than strained.
const MOST_SWEEPS: usize = 256;

/// What joints ask of the solver.
#[derive(Default)]
pub(super) struct JointStrain {
    /// Whether a robot, or a person, falls or lies.
    pub falls: bool,
    /// How far the two sides of the worst joint of those are apart, m.
    pub apart: f64,
    /// Whether something takes a blow, or a joint is pressed beyond its limit.
    pub blow: bool,
    /// How many times as heavy what strikes is as what it strikes, or the other way round; 0 where nothing does.
    pub ratio: f64,
}

impl JointStrain {
    /// How often the solver must go over all joints and contacts, where it usually does so often, and bodies are so deep in each other, m.
    fn sweeps(&self, usual: usize, deepest: f64) -> usize {
        if !self.falls && !self.blow && deepest < TOO_DEEP {
            return usual;
        }
        // A robot that falls on its own hand hands a blow on through all of its joints.
        let fall = if self.falls && self.blow { 2.0 } else { 1.0 };
        let times = (self.apart / STRAINED).max(self.ratio / RATIO).max(fall);
        let many = (MANY_SWEEPS as f64 * times) as usize;
        usual.max(many.min(MOST_SWEEPS))
    }
}

/// What comes together fast within a step.
struct RigidApproach {
    parts: f64,
    /// As [`JointStrain::ratio`].
    ratio: f64,
}

/// How far a blow, or a push, may move surfaces in a part of a step, m.
fn way_of_blows(strikes: bool, falls: bool) -> f64 {
    match (strikes, falls) {
        (true, _) => WAY,
        (false, true) => PUSHED,
        (false, false) => 0.0,
    }
}

/// Where bodies can be within a step: of each its greatest speed, m/s, and the box that it stays in; and which of them are fast. Without
/// what yields, and what is fast, nobody asks for the boxes.
pub(super) struct SweptBodies {
    pub speeds: Vec<f64>,
    fast: Vec<usize>,
    boxes: Vec<Aabb>,
}

impl SweptBodies {
    pub(super) fn may_meet(&self, a: usize, b: usize) -> bool {
        self.boxes[a].intersects(&self.boxes[b])
    }

    /// Whether some of the bodies may meet some of the others.
    pub(super) fn may_any_meet(&self, some: &[usize], others: &[usize]) -> bool {
        let around = some.iter().map(|body| self.boxes[*body]).reduce(|a, b| a.merged(&b));
        around.is_some_and(|around| others.iter().any(|other| self.boxes[*other].intersects(&around)))
    }
}

impl PhysicsAdapter {
    /// Does a step, in as many parts as the bodies that meet ask for.
    pub(super) fn step_parts(&mut self) {
        let dt = f64::from(self.world.integration_parameters.dt);
        let swept = self.swept(dt);
        let near = self.near_pairs(&swept, dt);
        let coming = self.rigid_parts(&swept, dt);
        let strikes = coming.ratio > 0.0;
        let asked = coming.parts.max(self.parts_for_stops(dt).min(MOST_PARTS));
        let parts = near.iter().map(|pair| pair.parts(dt)).fold(asked, f64::max);
        let h = dt / parts;
        let times = (self.substeps() as f64 / parts).ceil() as usize;
        self.world.integration_parameters.dt = h as f32;
        let sweeps = if parts > SUBSTEPS as f64 { self.sweeps.max(SWEEPS_OF_SHORT) } else { self.sweeps };
        let mut loads = ContactLoads::default();
        let mut done = 0.0;
        while done < parts {
            self.divide(h, times);
            self.draw_guided(StepPart { done: done / parts, h, dt });
            for pair in &near {
                self.press(pair.at, h);
            }
            self.lead_on((done + 1.0) / parts);
            let mut strain = self.ease_joints();
            self.tell_stops(way_of_blows(strikes, strain.falls));
            strain.blow |= strikes;
            strain.ratio = coming.ratio;
            self.world.integration_parameters.num_internal_pgs_iterations =
                strain.sweeps(sweeps, self.deepest);
            self.step_within_ends();
            let part = self.look_at_contacts();
            self.note_presses(&near, &part, h);
            loads.add_part(&part, 1.0 / parts);
            done += 1.0;
        }
        self.keep_loads(loads);
        self.end_guided(dt);
        self.look_at_boxes();
        self.led.clear();
        self.world.integration_parameters.dt = dt as f32;
    }

    /// Lets the solver divide a part of a step, which takes so long, s, so often.
    pub(super) fn divide(&mut self, h: f64, times: usize) {
        self.part = (h, times);
        self.world.integration_parameters.num_solver_iterations = times;
        self.keep_mending();
    }

    /// What no world of these bodies can do without: a step of the engine.
    pub(super) fn step_engine(&mut self) {
        match self.clock {
            Some(clock) => {
                self.engine_time.measure(clock, || self.world.step_with_events(&self.exempt, &()));
            }
            None => self.world.step_with_events(&self.exempt, &()),
        }
    }

    /// A step of the engine and nothing else.
    pub(crate) fn step_bare(&mut self) {
        self.step_engine();
        self.place_joints();
        self.look_at_boxes();
    }

    /// Where everything can be within the next step, found once: of each body it is asked for many times.
    fn swept(&self, dt: f64) -> SweptBodies {
        let speeds: Vec<f64> = (0..self.parts.len()).map(|part| self.speed_of(part)).collect();
        let is_fast = |part: &usize| self.is_loose_or_led(*part) && speeds[*part] * dt > WAY;
        let fast: Vec<usize> = (0..self.parts.len()).filter(is_fast).collect();
        let boxes = if fast.is_empty() && self.yielding.pairs.is_empty() {
            Vec::new()
        } else {
            speeds.iter().enumerate().map(|(part, speed)| self.box_at_speed(part, *speed, dt)).collect()
        };
        SweptBodies { speeds, fast, boxes }
    }

    /// How many parts the rigid bodies ask for that may meet within a step, and what strikes what.
    fn rigid_parts(&self, swept: &SweptBodies, dt: f64) -> RigidApproach {
        let mut found = RigidApproach { parts: 1.0, ratio: 0.0 };
        for one in &swept.fast {
            for other in 0..self.parts.len() {
                if swept.may_meet(*one, other) && self.meet_rigidly(*one, other) {
                    let asked = (self.approach(*one, other, swept, dt) * dt / WAY).ceil();
                    if asked > 1.0 {
                        found.ratio = found.ratio.max(self.mass_ratio(*one, other));
                    }
                    found.parts = found.parts.max(asked);
                }
            }
        }
        found.parts = found.parts.min(MOST_PARTS);
        found
    }

    /// How many times as heavy one of two bodies is as the other; 1 if one is not moved by forces.
    fn mass_ratio(&self, a: usize, b: usize) -> f64 {
        let mass = |part: usize| {
            let body = &self.world.bodies[self.parts[part].handle];
            body.is_dynamic().then(|| f64::from(body.mass()))
        };
        let (Some(a), Some(b)) = (mass(a), mass(b)) else { return 1.0 };
        (a / b).max(b / a)
    }

    /// Whether forces alone move a body, or it is led whatever is in its way.
    fn is_loose_or_led(&self, part: usize) -> bool {
        let body = &self.world.bodies[self.parts[part].handle];
        let is_solid =
            !self.parts[part].ghost && self.world.colliders.get(self.parts[part].collider).is_some();
        let guide = &self.guides[index(self.parts[part].root)];
        is_solid && guide.is_none() && (body.is_kinematic() || body.is_dynamic() && !body.is_sleeping())
    }

    fn meet_rigidly(&self, a: usize, b: usize) -> bool {
        !self.exempt.is_left_out(a, b) && self.may_touch(body_id(a), body_id(b))
    }

    /// How fast two surfaces may come together within a step, m/s; 0 if they do not come near.
    fn approach(&self, a: usize, b: usize, swept: &SweptBodies, dt: f64) -> f64 {
        let reach = NEAR + (swept.speeds[a] + swept.speeds[b]) * dt;
        let Some(found) = self.closest(a, b, reach) else { return 0.0 };
        let ((at_a, turning_a), (at_b, turning_b)) = (self.coming(a), self.coming(b));
        let straight = from_vector(at_a - at_b).dot(&from_vector(found.normal1)).max(0.0);
        // Another point than the nearest may swing round.
        let approach = straight + turning_a + turning_b;
        let apart = f64::from(found.dist);
        let comes_near = apart <= approach * dt + NEAR;
        // Or it comes past the nearest, and straight on: what falls beside something, say, with its end on the edge of that.
        let together = f64::from((at_a - at_b).length());
        let is_apart = apart > TOUCHING && together > approach && together * dt > WAY;
        if is_apart && self.will_hit(a, b, at_b - at_a, dt) {
            together
        } else if comes_near {
            approach
        } else {
            0.0
        }
    }

    /// Whether a body that goes straight on at a speed in the frame of another hits it within a step.
    fn will_hit(&self, a: usize, b: usize, speed: Vector, dt: f64) -> bool {
        let collider = |i: usize| self.world.colliders.get(self.parts[i].collider);
        let (Some(one), Some(other)) = (collider(a), collider(b)) else { return false };
        let within = parry::query::ShapeCastOptions::with_max_time_of_impact(dt as f32);
        parry::query::cast_shapes(
            one.position(),
            Vector::ZERO,
            one.shape(),
            other.position(),
            speed,
            other.shape(),
            within,
        )
        .is_ok_and(|hit| hit.is_some())
    }

    /// How fast the middle of a body's surface will go in the next step, m/s, and how much faster its points may go as it turns.
    fn coming(&self, part: usize) -> (Vector, f64) {
        let own = &self.parts[part];
        if own.motion == BodyMotion::Fixed {
            return (Vector::ZERO, 0.0);
        }
        let body = &self.world.bodies[own.handle];
        let led = self.led.iter().find(|(handle, _)| *handle == own.handle);
        let stands = body.linvel() == Vector::ZERO && body.angvel() == AngVector::ZERO && led.is_none();
        if stands || body.is_fixed() {
            return (Vector::ZERO, 0.0);
        }
        let Some(collider) = self.world.colliders.get(own.collider) else { return (Vector::ZERO, 0.0) };
        let turning = f64::from(body.angvel().length() * own.radius);
        let middle = led.map_or_else(
            || body.velocity_at_point(collider.position().translation),
            |(_, to)| (to.translation - body.translation()) / self.step as f32,
        );
        (middle, turning)
    }

    /// No point of a body's surface will be faster in the next step, m/s.
    pub(super) fn speed_of(&self, part: usize) -> f64 {
        let (middle, turning) = self.coming(part);
        f64::from(middle.length()) + turning
    }

    /// Where a body can be within a step.
    pub(super) fn box_in_step(&self, part: usize, dt: f64) -> Aabb {
        self.box_at_speed(part, self.speed_of(part), dt)
    }

    fn box_at_speed(&self, part: usize, speed: f64, dt: f64) -> Aabb {
        // A mere frame has no surface.
        self.box_now(part)
            .map_or_else(Aabb::new_invalid, |around| around.loosened((NEAR / 2.0 + speed * dt) as f32))
    }

    /// The box around a body where it is now; of a mere frame none.
    pub(super) fn box_now(&self, part: usize) -> Option<Aabb> {
        self.boxes[part].map(|(_, around)| around)
    }

    /// The engine has moved bodies: finds the boxes around them.
    pub(super) fn look_at_boxes(&mut self) {
        self.boxes.resize(self.parts.len(), None);
        for (known, part) in self.boxes.iter_mut().zip(&self.parts) {
            if part.motion == BodyMotion::Fixed && known.is_some() {
                continue;
            }
            let Some(collider) = self.world.colliders.get(part.collider) else { continue };
            if known.is_none_or(|(pose, _)| pose != *collider.position()) {
                *known = Some((*collider.position(), collider.compute_aabb()));
            }
        }
    }

    pub(super) fn closest(&self, a: usize, b: usize, far: f64) -> Option<parry::query::Contact> {
        let collider = |i: usize| self.world.colliders.get(self.parts[i].collider);
        let (a, b) = (collider(a)?, collider(b)?);
        // The engine knows how to measure between all shapes that a scenario can name.
        parry::query::contact(a.position(), a.shape(), b.position(), b.shape(), far as f32).ok().flatten()
    }
}
