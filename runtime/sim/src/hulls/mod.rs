//! Meshes as convex hulls, which is how they touch: found once for each mesh, and kept by its digest.
//!
//! The same mesh gives the same hulls, whether they were found now or come from a store.

mod decompose;
mod keep;
mod reduce;

pub(crate) use keep::hulls_of;
pub use keep::{HullStore, warm_hulls};

use rapier3d::prelude::*;

/// What takes the place of a mesh.
#[derive(Clone, Debug)]
pub(crate) struct MeshHulls {
    pub pieces: Vec<ConvexPiece>,
    /// How far points of the whole pieces lie outside of those that have fewer corners, at most, m.
    pub error: f32,
}

/// A convex piece: the corners of its hull, and the shape that the engine makes of them.
#[derive(Clone, Debug)]
pub(crate) struct ConvexPiece {
    pub corners: Vec<Vector>,
    pub shape: SharedShape,
}

impl ConvexPiece {
    /// `None`: the corners are those of nothing solid.
    fn new(corners: Vec<Vector>) -> Option<ConvexPiece> {
        let shape = SharedShape::convex_hull(&corners)?;
        Some(ConvexPiece { corners, shape })
    }
}
