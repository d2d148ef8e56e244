//! Bodies of several shapes: as one shape of the engine, with what is measured of them, and their masses.

use hrdsl_ir::{
    solid::{PlacedSolid, SolidBody, SolidGeometry, SolidMass},
    world::{Body, BodyId, BodyMotion, BodyShape, World},
};
use nalgebra::Matrix3;
use rapier3d::prelude::*;

use super::bodies::{index, start_of};
use crate::{
    error::SimulationError,
    hulls::hulls_of,
    math::{BodyFrame, SpaceVector, from_rpy, from_vector, to_pose, v3},
};

/// Sizes below this are taken as this, m: descriptions have sheets without a thickness.
const THINNEST: f64 = 1e-4;
/// The radius of what stands for a frame, m: it is a place.
const FRAME: f32 = 1e-5;
/// A body's smallest moment of inertia is at least that of a ball of this radius, m.
const SMALLEST: f64 = 5e-3;
/// What moves and has no mass has this part of the mass that hangs on it, and at least so much, kg.
const PART_OF_LOAD: f64 = 0.02;
const LIGHTEST: f64 = 0.01;

/// What is measured of a body of several shapes, in its own frame.
pub struct SolidExtent {
    plain: Vec<(BodyFrame, BodyShape)>,
    corners: Vec<SpaceVector>,
    /// The middle of the box around it, and from there to an end along its longest edge.
    pub middle: SpaceVector,
    pub half: SpaceVector,
    pub is_frame: bool,
}

impl SolidExtent {
    /// How far its lowest point is below its origin, m; `up` is the vertical in its own frame.
    pub fn below(&self, up: SpaceVector) -> f64 {
        let plain = self
            .plain
            .iter()
            .map(|(frame, shape)| lowest_of(*shape, frame.turn.inverse() * up) - frame.at.dot(&up));
        let corners = self.corners.iter().map(|corner| -corner.dot(&up));
        plain.chain(corners).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// The shape of a solid, and what is measured of it.
///
/// # Errors
/// If a measure is no number that it can have.
pub fn solid_shape(solid: &SolidBody, name: &str) -> Result<(SharedShape, SolidExtent), SimulationError> {
    let (mut parts, mut plain, mut corners) = (Vec::new(), Vec::new(), Vec::new());
    for placed in &solid.shapes {
        let frame = frame_of(placed, name)?;
        match &placed.geometry {
            SolidGeometry::Plain(shape) => {
                let shape = thickened(*shape);
                parts.push((to_pose(&frame), shape_of(shape, name)?));
                plain.push((frame, shape));
            }
            SolidGeometry::Mesh(mesh) => {
                for piece in &hulls_of(mesh).pieces {
                    parts.push((to_pose(&frame), piece.shape.clone()));
                    corners.extend(piece.corners.iter().map(|corner| frame.point(from_vector(*corner))));
                }
            }
        }
    }
    let shape = joined(parts);
    let around = shape.compute_local_aabb();
    let half = from_vector(around.half_extents());
    let longest = if solid.is_frame() { SpaceVector::zeros() } else { longest_axis(half) };
    let (middle, is_frame) = (from_vector(around.center()), solid.is_frame());
    if is_frame {
        corners.push(SpaceVector::zeros());
    }
    Ok((shape, SolidExtent { plain, corners, middle, half: longest, is_frame }))
}

fn frame_of(placed: &PlacedSolid, name: &str) -> Result<BodyFrame, SimulationError> {
    if placed.position.iter().chain(&placed.rotation).all(|x| x.is_finite()) {
        Ok(BodyFrame::new(v3(placed.position), from_rpy(placed.rotation)))
    } else {
        Err(SimulationError::BadNumber { what: format!("a measure of body `{name}`") })
    }
}

fn thickened(shape: BodyShape) -> BodyShape {
    match shape {
        BodyShape::Box { size } => BodyShape::Box { size: size.map(|x| x.max(THINNEST)) },
        BodyShape::Sphere { radius } => BodyShape::Sphere { radius: radius.max(THINNEST) },
        BodyShape::Capsule { radius, length } => {
            BodyShape::Capsule { radius: radius.max(THINNEST), length: length.max(THINNEST) }
        }
        BodyShape::Cylinder { radius, length } => {
            BodyShape::Cylinder { radius: radius.max(THINNEST), length: length.max(THINNEST) }
        }
    }
}

/// Shapes that are made of others are taken apart: the engine knows no compounds of compounds.
fn joined(parts: Vec<(Pose, SharedShape)>) -> SharedShape {
    let mut flat: Vec<(Pose, SharedShape)> = Vec::new();
    for (pose, shape) in parts {
        match shape.as_compound() {
            Some(inner) => flat.extend(inner.shapes().iter().map(|(at, s)| (pose * *at, s.clone()))),
            None => flat.push((pose, shape)),
        }
    }
    match flat.as_slice() {
        [] => SharedShape::ball(FRAME),
        [(pose, shape)] if *pose == Pose::IDENTITY => shape.clone(),
        _ => SharedShape::compound(flat),
    }
}

fn longest_axis(half: SpaceVector) -> SpaceVector {
    let axis = half.iamax();
    let mut longest = SpaceVector::zeros();
    longest[axis] = half[axis];
    longest
}

/// The mass of all that is rigidly one with a body, if a description says it: in the body's frame, with what rotors add to its
/// inertia.
pub fn described_mass(world: &World, roots: &[BodyId], id: BodyId, rotors: f64) -> Option<MassProperties> {
    let root = &world.bodies[index(id)];
    if root.solid.is_none() || root.motion != BodyMotion::Dynamic {
        return None;
    }
    let into = start_of(root).inverse();
    let own = world.bodies.iter().zip(roots).filter(|(_, of)| **of == id);
    let masses: Vec<(BodyFrame, SolidMass)> =
        own.filter_map(|(body, _)| Some((into.then(&start_of(body)), body.solid.as_ref()?.mass?))).collect();
    let mass: f64 = masses.iter().map(|(_, m)| m.mass).sum();
    let centre = |(frame, m): &(BodyFrame, SolidMass)| frame.point(v3(m.centre)) * m.mass;
    let (mass, centre, mut inertia) = if mass > 0.0 {
        let centre = masses.iter().map(centre).sum::<SpaceVector>() / mass;
        (mass, centre, masses.iter().map(|(frame, m)| about(centre, frame, m)).sum::<Matrix3<f64>>())
    } else {
        // The joints at a shoulder are often joined by mere frames.
        ((load(world, roots, id) * PART_OF_LOAD).max(LIGHTEST), SpaceVector::zeros(), Matrix3::zeros())
    };
    let least = 0.4 * mass * SMALLEST * SMALLEST;
    let firm = inertia - Matrix3::identity() * least;
    if firm.cholesky().is_none() {
        // What no body can have is that of a ball.
        inertia = Matrix3::identity() * (inertia.trace() / 3.0).max(least);
    }
    inertia += Matrix3::identity() * rotors;
    let column = |i: usize| crate::math::to_vector(inertia.column(i).into_owned());
    let inertia = Mat3::from_cols(column(0), column(1), column(2));
    Some(MassProperties::with_inertia_matrix(crate::math::to_vector(centre), mass as f32, inertia))
}

/// The inertia of a mass about another point than its own centre (Steiner).
fn about(point: SpaceVector, frame: &BodyFrame, mass: &SolidMass) -> Matrix3<f64> {
    let rows = mass.inertia;
    let own = Matrix3::from_fn(|i, j| rows[i][j]);
    let turn = frame.turn.to_rotation_matrix();
    let way = frame.point(v3(mass.centre)) - point;
    let moved = Matrix3::identity() * way.norm_squared() - way * way.transpose();
    turn.matrix() * own * turn.matrix().transpose() + moved * mass.mass
}

/// The mass of all that hangs on a body by joints, kg.
fn load(world: &World, roots: &[BodyId], id: BodyId) -> f64 {
    let mut below = vec![id];
    let mut next = 0;
    while let Some(at) = below.get(next).copied() {
        next += 1;
        for joint in &world.joints {
            let (parent, child) = (roots[index(joint.parent)], roots[index(joint.child)]);
            if parent == at && !below.contains(&child) {
                below.push(child);
            }
        }
    }
    let mass = |(body, root): (&hrdsl_ir::world::Body, &BodyId)| {
        let own = body.solid.as_ref().map_or(Some(body.mass), |solid| solid.mass.map(|m| m.mass));
        own.filter(|_| *root != id && below.contains(root)).unwrap_or_default()
    };
    world.bodies.iter().zip(roots).map(mass).sum()
}

/// The shape of a body, and what is measured of it if it has several.
pub fn surface_of(body: &Body) -> Result<(SharedShape, Option<SolidExtent>), SimulationError> {
    if !body.position.iter().chain(&body.rotation).all(|x| x.is_finite()) {
        return Err(SimulationError::BadNumber { what: format!("a measure of body `{}`", body.name) });
    }
    match &body.solid {
        Some(solid) => solid_shape(solid, &body.name).map(|(shape, extent)| (shape, Some(extent))),
        None => Ok((shape_of(body.shape, &body.name)?, None)),
    }
}

fn shape_of(shape: BodyShape, name: &str) -> Result<SharedShape, SimulationError> {
    let measures: Vec<f64> = match shape {
        BodyShape::Box { size } => size.to_vec(),
        BodyShape::Sphere { radius } => vec![radius],
        BodyShape::Capsule { radius, length } | BodyShape::Cylinder { radius, length } => {
            vec![radius, length]
        }
    };
    if measures.iter().any(|m| !m.is_finite() || *m <= 0.0) {
        return Err(SimulationError::BadNumber { what: format!("a measure of body `{name}`") });
    }
    let half = |x: f64| (x / 2.0) as f32;
    Ok(match shape {
        BodyShape::Box { size } => SharedShape::cuboid(half(size[0]), half(size[1]), half(size[2])),
        BodyShape::Sphere { radius } => SharedShape::ball(radius as f32),
        BodyShape::Capsule { radius, length } => SharedShape::capsule_z(half(length), radius as f32),
        // The engine's cylinder lies along y.
        BodyShape::Cylinder { radius, length } => SharedShape::compound(vec![(
            Pose::from_parts(Vector::ZERO, Rotation::from_xyzw(SQRT_HALF, 0.0, 0.0, SQRT_HALF)),
            SharedShape::cylinder(half(length), radius as f32),
        )]),
    })
}

const SQRT_HALF: f32 = std::f32::consts::FRAC_1_SQRT_2;

/// How far the lowest point of a shape is below its centre, m; `up` is the vertical in its own frame.
pub fn lowest_of(shape: BodyShape, up: SpaceVector) -> f64 {
    let round = |radius: f64| radius * (1.0 - up.z * up.z).max(0.0).sqrt();
    match shape {
        BodyShape::Box { size: [x, y, z] } => (x * up.x.abs() + y * up.y.abs() + z * up.z.abs()) / 2.0,
        BodyShape::Sphere { radius } => radius,
        BodyShape::Capsule { radius, length } => radius + length / 2.0 * up.z.abs(),
        BodyShape::Cylinder { radius, length } => round(radius) + length / 2.0 * up.z.abs(),
    }
}
