//! Space: poses, and which inertias a body can have.

pub(crate) mod inertia;
pub(crate) mod transform;
