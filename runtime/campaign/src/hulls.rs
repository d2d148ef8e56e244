//! The hulls of a world's meshes, found before its first test.

use hrdsl_ir::Program;
use hrdsl_sim::{HullStore, warm_hulls};

/// What became of the meshes of a world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FoundHulls {
    pub meshes: usize,
    pub hulls: usize,
    /// How far corners of the meshes' pieces lie outside of their hulls, at most, m.
    pub error: f64,
}

/// Finds the convex hulls that the meshes of the program's world touch as, in the store if they are there.
pub fn find_hulls(program: &Program, store: &dyn HullStore) -> FoundHulls {
    let Some(world) = &program.world else { return FoundHulls::default() };
    let (meshes, hulls, error) = warm_hulls(world, store);
    FoundHulls { meshes, hulls, error }
}
