//! Names for what is installed, made from all that it is made from.

use std::{fmt::Write as _, fs::File, io, path::Path};

use sha2::{Digest, Sha256};

use super::local;
use crate::error::SutError;

/// A hash of parts that are told apart: `ab`, `c` is not `a`, `bc`.
pub(super) struct PartsHasher(Sha256);

impl PartsHasher {
    pub(super) fn new() -> Self {
        Self(Sha256::new())
    }

    pub(super) fn of(parts: &[&str]) -> Self {
        let mut all = Self::new();
        parts.iter().for_each(|part| all.part(part.as_bytes()));
        all
    }

    pub(super) fn part(&mut self, bytes: &[u8]) {
        self.0.update((bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }

    /// A file's contents.
    pub(super) fn file(&mut self, path: &Path) -> Result<(), SutError> {
        let fail = || SutError::io(format!("cannot read {}", path.display()));
        let mut inner = Sha256::new();
        let mut file = File::open(path).map_err(fail())?;
        io::copy(&mut file, &mut HashWriter(&mut inner)).map_err(fail())?;
        self.part(&inner.finalize());
        Ok(())
    }

    /// The names and contents of all files that belong to a folder.
    pub(super) fn folder(&mut self, folder: &Path) -> Result<(), SutError> {
        for content in local::contents(folder)? {
            self.part(content.relative.as_os_str().as_encoded_bytes());
            self.part(&[u8::from(content.executable)]);
            self.file(&content.path)?;
        }
        self.part(b"end");
        Ok(())
    }

    pub(super) fn finish(self) -> String {
        self.0.finalize().iter().take(8).fold(String::new(), |mut text, byte| {
            let _ = write!(text, "{byte:02x}");
            text
        })
    }
}

struct HashWriter<'a>(&'a mut Sha256);

impl io::Write for HashWriter<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_told_apart() {
        assert_ne!(PartsHasher::of(&["ab", "c"]).finish(), PartsHasher::of(&["a", "bc"]).finish());
        assert_eq!(PartsHasher::of(&["a"]).finish().len(), 16);
    }
}
