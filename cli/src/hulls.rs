//! The folder in which the hulls of meshes are kept from one campaign to the next.

use std::{fs, path::PathBuf};

use hrdsl_runtime::campaign::HullStore;

/// A file for each mesh. What cannot be written is found again the next time.
pub struct HullFolder {
    pub folder: PathBuf,
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
