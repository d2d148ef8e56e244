//! What depends on the surfaces of bodies: distances, lines of sight, beams, and what is in the way.

use hrdsl_ir::world::{BodyId, BodyMotion, BodyShape};
use rapier3d::parry::{self, bounding_volume::BoundingVolume};
use rapier3d::prelude::*;

use super::state::{
    adapter::PhysicsAdapter,
    bodies::{body_id, index},
    solid::lowest_of,
};
use crate::math::{BodyFrame, SpaceVector, angle_between, from_vector, to_pose, to_vector};

impl PhysicsAdapter {
    /// Between the surfaces; 0 if they touch or overlap.
    pub fn distance(&self, a: BodyId, b: BodyId) -> f64 {
        let (pa, pb) = (to_pose(&self.pose(a)), to_pose(&self.pose(b)));
        // The engine knows how to measure between all shapes that a scenario can name.
        parry::query::distance(&pa, self.shape(a), &pb, self.shape(b))
            .map_or(f64::NAN, |d| f64::from(d.distance))
    }

    /// From a point to the body's surface; 0 within.
    pub fn distance_to_point(&self, body: BodyId, point: SpaceVector) -> f64 {
        f64::from(self.shape(body).distance_to_point(&to_pose(&self.pose(body)), to_vector(point), true))
    }

    /// The point of a body that is nearest to another.
    pub fn nearest_point(&self, body: BodyId, point: SpaceVector) -> SpaceVector {
        let found = self.shape(body).project_point(&to_pose(&self.pose(body)), to_vector(point), true);
        from_vector(found.point)
    }

    fn shape(&self, body: BodyId) -> &dyn parry::shape::Shape {
        &*self.parts[index(body)].surface
    }

    /// Whether a straight line from the centre of `a` meets `b` before any other solid body.
    pub fn visible(&self, a: BodyId, b: BodyId) -> bool {
        let from = self.pose(a).at;
        let there = self.pose(b);
        let part = &self.parts[index(b)];
        let (middle, half) = match &part.extent {
            Some(extent) => (there.point(extent.middle), extent.half),
            None => (there.at, half_length(part.shape)),
        };
        let third = there.turn * (half / 3.0);
        [SpaceVector::zeros(), third, -third]
            .iter()
            .any(|offset| self.line_reaches(a, from, b, middle + offset))
    }

    fn line_reaches(&self, a: BodyId, from: SpaceVector, b: BodyId, to: SpaceVector) -> bool {
        let ray = Ray::new(to_vector(from), to_vector(to - from));
        // A mere frame is a place that a ray would miss.
        let is_frame = self.parts[index(b)].extent.as_ref().is_some_and(|extent| extent.is_frame);
        let hit = if is_frame { Some(1.0) } else { self.cast(b, &ray, 1.0) };
        let Some(hit) = hit else { return false };
        let own = self.root(a);
        (0..self.parts.len()).all(|i| {
            let part = &self.parts[i];
            let other = body_id(i);
            other == b
                || part.ghost
                || part.root == own
                || self.cast(other, &ray, hit).is_none_or(|t| t >= hit)
        })
    }

    fn cast(&self, body: BodyId, ray: &Ray, far: f32) -> Option<f32> {
        self.shape(body).cast_ray(&to_pose(&self.pose(body)), ray, far, true)
    }

    /// All bodies that are no ghosts.
    pub fn solids(&self) -> impl Iterator<Item = BodyId> + '_ {
        (0..self.parts.len()).map(body_id).filter(|b| !self.parts[index(*b)].ghost)
    }

    pub fn is_ghost(&self, body: BodyId) -> bool {
        self.parts[index(body)].ghost
    }

    /// The box around the body, if it were there.
    pub fn aabb(&self, body: BodyId, there: &Pose) -> parry::bounding_volume::Aabb {
        self.shape(body).compute_aabb(there)
    }

    /// How far two bodies would be apart, if they were there, m; negative: how deep in each other. `None`: farther than `far`.
    pub fn gap(&self, a: BodyId, at: &Pose, b: BodyId, there: &Pose, far: f32) -> Option<f32> {
        // The engine knows how to measure between all shapes that a scenario can name.
        let contact = parry::query::contact(at, self.shape(a), there, self.shape(b), far).ok().flatten();
        contact.map(|c| c.dist)
    }

    /// Whether nothing moves the body, nor what it is rigidly one with.
    pub fn is_fixed(&self, body: BodyId) -> bool {
        self.motion(body) == BodyMotion::Fixed
    }

    /// How deep the body, if it were there, would be in the other, m; 0 if they do not overlap.
    pub fn depth(&self, body: BodyId, there: &BodyFrame, other: BodyId) -> f64 {
        let (own, at) = (self.shape(body), to_pose(there));
        let (shape, place) = (self.shape(other), to_pose(&self.pose(other)));
        if !own.compute_aabb(&at).intersects(&shape.compute_aabb(&place)) {
            return 0.0;
        }
        // The engine knows how to measure between all shapes that a scenario can name.
        let contact = parry::query::contact(&at, own, &place, shape, 0.0).ok().flatten();
        contact.map_or(0.0, |c| f64::from(-c.dist).max(0.0))
    }

    /// A sphere around the body: its centre and its radius, m.
    pub fn sphere_around(&self, body: BodyId) -> (SpaceVector, f64) {
        let sphere = self.shape(body).compute_bounding_sphere(&to_pose(&self.pose(body)));
        (from_vector(sphere.center), f64::from(sphere.radius))
    }

    /// How far the direction that was vertical at the start has been tipped from it, rad.
    pub fn tilt(&self, body: BodyId) -> f64 {
        let upright = self.start(body).turn.inverse() * SpaceVector::z();
        angle_between(&(self.pose(body).turn * upright), &SpaceVector::z())
    }

    /// The height of the body's lowest point above z = 0, m.
    pub fn lowest(&self, body: BodyId) -> f64 {
        let BodyFrame { at, turn } = self.pose(body);
        let up = turn.inverse() * SpaceVector::z();
        let part = &self.parts[index(body)];
        at.z - part.extent.as_ref().map_or_else(|| lowest_of(part.shape, up), |extent| extent.below(up))
    }

    /// How far it is to the body's surface (m) from a place in a direction of length 1, if it is not farther than so much.
    pub fn ranger(&self, body: BodyId) -> impl Fn(SpaceVector, SpaceVector, f64) -> Option<f64> + '_ {
        let (shape, pose) = (self.shape(body), to_pose(&self.pose(body)));
        move |from, direction, far| {
            let ray = Ray::new(to_vector(from), to_vector(direction));
            shape.cast_ray(&pose, &ray, far as f32, true).map(f64::from)
        }
    }
}

/// From the centre to an end, along the longest axis.
fn half_length(shape: BodyShape) -> SpaceVector {
    match shape {
        BodyShape::Box { size: [x, y, z] } => {
            if x >= y && x >= z {
                SpaceVector::x() * (x / 2.0)
            } else if y >= z {
                SpaceVector::y() * (y / 2.0)
            } else {
                SpaceVector::z() * (z / 2.0)
            }
        }
        BodyShape::Sphere { radius } => SpaceVector::z() * radius,
        BodyShape::Capsule { radius, length } => SpaceVector::z() * (length / 2.0 + radius),
        BodyShape::Cylinder { length, .. } => SpaceVector::z() * (length / 2.0),
    }
}
