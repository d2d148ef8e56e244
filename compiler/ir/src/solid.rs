//! What bodies of descriptions and maps are made of: several placed shapes, meshes among them, and masses of their own.

use std::{ops::Deref, sync::Arc};

use hrdsl_source::Span;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::{
    shape::{BodyShape, Vec3},
    world_ids::BodyId,
};

/// Data that many share, and none changes.
#[derive(Debug, PartialEq)]
pub struct SharedData<T>(Arc<T>);

impl<T> SharedData<T> {
    pub fn new(data: T) -> Self {
        Self(Arc::new(data))
    }
}

impl<T> Clone for SharedData<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T> Deref for SharedData<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0
    }
}

impl<T: Serialize> Serialize for SharedData<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.serialize(serializer)
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for SharedData<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        T::deserialize(deserializer).map(Self::new)
    }
}

/// What takes the place of a body's one shape and its mass. Without shapes it is a mere frame, which nothing meets.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SolidBody {
    pub shapes: Vec<PlacedSolid>,
    /// `None`: it has no mass of its own, since it is one with a body that has.
    pub mass: Option<SolidMass>,
    /// Bodies that it never touches.
    pub exempt: Vec<BodyId>,
    /// Where it is described.
    pub origin: Span,
}

/// One of a body's shapes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlacedSolid {
    /// In the body's own frame.
    pub position: Vec3,
    pub rotation: Vec3,
    pub geometry: SolidGeometry,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SolidGeometry {
    Plain(BodyShape),
    /// It touches as the convex hulls do that cover it.
    Mesh(SharedData<SolidMesh>),
}

/// A surface of triangles, in metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidMesh {
    /// Of the points and triangles: equal ones have the same.
    pub digest: String,
    pub points: Vec<[f32; 3]>,
    /// Numbers of points, counter-clockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// A mass, and how it is spread.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidMass {
    /// Kilograms.
    pub mass: f64,
    /// The centre of mass in the body's frame, m.
    pub centre: Vec3,
    /// About the centre, along the axes of the body's frame, row by row, kg·m².
    pub inertia: [Vec3; 3],
}

impl SolidBody {
    /// Whether it is a place rather than a thing.
    #[must_use]
    pub fn is_frame(&self) -> bool {
        self.shapes.is_empty()
    }
}
