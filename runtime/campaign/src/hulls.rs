//! The hulls of a world's meshes, kept in a folder from one campaign to the next.

use std::{
    fs,
    path::{Path, PathBuf},
};

use hrdsl_ir::Program;
use hrdsl_sim::{HullStore, warm_hulls};

/// A file for each mesh. What cannot be written is found again the next time.
struct HullFolder {
    folder: PathBuf,
}

impl HullStore for HullFolder {
    fn load(&self, key: &str) -> Option<Vec<u8>> {
        fs::read(self.folder.join(key)).ok()
    }

    fn save(&self, key: &str, bytes: &[u8]) {
        // Whole or not at all: others may look for it at this moment.
        let beside = self.folder.join(format!("{key}.{}", std::process::id()));
        let written = fs::create_dir_all(&self.folder).and_then(|()| fs::write(&beside, bytes));
        if written.and_then(|()| fs::rename(&beside, self.folder.join(key))).is_err() {
            let _ = fs::remove_file(&beside);
        }
    }
}

/// What became of the meshes of a world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FoundHulls {
    pub meshes: usize,
    pub hulls: usize,
    /// How far corners of the meshes' pieces lie outside of their hulls, at most, m.
    pub error: f64,
}

/// Finds the convex hulls that the meshes of the program's world touch as, in `cache` if they are there.
#[must_use]
pub fn find_hulls(program: &Program, cache: &Path) -> FoundHulls {
    let Some(world) = &program.world else { return FoundHulls::default() };
    let (meshes, hulls, error) = warm_hulls(world, &HullFolder { folder: cache.join("hulls") });
    FoundHulls { meshes, hulls, error }
}
