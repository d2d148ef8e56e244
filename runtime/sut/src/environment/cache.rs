//! The cache: folders that are made once, beside their place, and moved there when they are whole.
//!
//! Each has a manifest inside, written last, by which it is checked at every start; and a lock beside, so that of
//! several processes one makes it and the others wait. A lock's file is never removed: who waits for it must wait for
//! the same one.

use std::{
    ffi::OsStr,
    fs::{self, File, TryLockError},
    io::{self, ErrorKind},
    os::unix::fs::MetadataExt,
    path::{Path, PathBuf},
    time::Instant,
};

use serde::{Deserialize, Serialize};
use tempfile::TempDir;
use walkdir::WalkDir;

use super::preparation::PreparationStep;
use crate::error::SutError;

/// In each folder that was made.
const MANIFEST: &str = ".hrdsl-manifest.json";
/// Tells backup programs, and us, that a folder is a cache (bford.info/cachedir).
const TAG: (&str, &str) = ("CACHEDIR.TAG", "Signature: 8a477f597d28d172789f06886806bc55\n# Made by hrdsl.\n");

pub(super) type PreparationListener<'a> = &'a dyn Fn(PreparationStep<'_>);

pub(super) struct EnvironmentCache<'a> {
    dir: PathBuf,
    pub listen: PreparationListener<'a>,
}

/// A folder of the cache.
pub(super) struct CachePart<'a> {
    pub kind: &'a str,
    /// Made from all that the folder is made from.
    pub key: String,
    /// What it has, in words.
    pub what: &'a str,
}

/// Where a part is made.
pub(super) struct MakingPart {
    /// What becomes the part.
    pub folder: PathBuf,
    /// For everything that is needed on the way.
    pub scratch: PathBuf,
}

impl<'a> EnvironmentCache<'a> {
    /// Makes the folder, and removes what interrupted processes have left there.
    pub(super) fn open(dir: &Path, listen: PreparationListener<'a>) -> Result<Self, SutError> {
        fs::create_dir_all(dir).map_err(SutError::io(format!("cannot make {}", dir.display())))?;
        let dir = dir.canonicalize().map_err(SutError::io("cannot find the cache"))?;
        let tag = dir.join(TAG.0);
        if !tag.exists() {
            // A cache that cannot be written may still have all that is needed.
            let _ = fs::write(&tag, TAG.1);
        }
        let cache = Self { dir, listen };
        cache.sweep();
        Ok(cache)
    }

    /// The same cache with another listener.
    pub(super) fn silent(&self) -> EnvironmentCache<'static> {
        EnvironmentCache { dir: self.dir.clone(), listen: &|_| {} }
    }

    /// A folder that needs no making.
    pub(super) fn folder(&self, name: &str) -> Result<PathBuf, SutError> {
        let folder = self.dir.join(name);
        fs::create_dir_all(&folder).map_err(self.fault())?;
        Ok(folder)
    }

    /// The folder of the part; if it is not there, or damaged, it is filled beside and moved into its place.
    pub(super) fn made(
        &self,
        part: &CachePart<'_>,
        fill: impl FnOnce(&MakingPart) -> Result<(), SutError>,
    ) -> Result<PathBuf, SutError> {
        let name = format!("{}-{}", part.kind, part.key);
        let place = self.dir.join(&name);
        if damage(&place).is_none() {
            return Ok(place);
        }
        let _lock = self.lock(&name, part.what)?;
        // Somebody else may have made it meanwhile.
        let Some(why) = damage(&place) else { return Ok(place) };
        let temporary = tempfile::Builder::new().prefix(&temporary_prefix(&name)).tempdir_in(&self.dir);
        let temporary = temporary.map_err(self.fault())?;
        if place.exists() {
            (self.listen)(PreparationStep::Damaged { what: part.what, why: &why });
            fs::rename(&place, temporary.path().join("damaged")).map_err(self.fault())?;
        }
        let start = Instant::now();
        (self.listen)(PreparationStep::Started { what: part.what });
        self.fill(&temporary, &place, fill)?;
        (self.listen)(PreparationStep::Finished { what: part.what, elapsed: start.elapsed() });
        Ok(place)
    }

    fn fill(
        &self,
        temporary: &TempDir,
        place: &Path,
        fill: impl FnOnce(&MakingPart) -> Result<(), SutError>,
    ) -> Result<(), SutError> {
        let at = |name: &str| temporary.path().join(name);
        let making = MakingPart { folder: at("made"), scratch: at("scratch") };
        fs::create_dir(&making.folder).map_err(self.fault())?;
        fs::create_dir(&making.scratch).map_err(self.fault())?;
        fill(&making)?;
        let manifest = serde_json::to_vec(&FolderManifest::of(&making.folder)).map_err(io::Error::other);
        let written = manifest.and_then(|text| fs::write(making.folder.join(MANIFEST), text));
        written.map_err(self.fault())?;
        fs::rename(&making.folder, place).map_err(self.fault())
    }

    /// Waits, and says so, while another process makes the same.
    fn lock(&self, name: &str, what: &str) -> Result<File, SutError> {
        let file = File::create(self.lock_file(name)).map_err(self.fault())?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                (self.listen)(PreparationStep::Waiting { what });
                file.lock().map_err(self.fault())?;
            }
            // A file system without locks: two processes may make the same, and one of them fails.
            Err(TryLockError::Error(e)) if e.kind() == ErrorKind::Unsupported => {}
            Err(TryLockError::Error(e)) => return Err(self.fault()(e)),
        }
        Ok(file)
    }

    fn lock_file(&self, name: &str) -> PathBuf {
        self.dir.join(format!(".{name}.lock"))
    }

    /// Removes the temporary folders that nobody works in. What cannot be removed stays for another time.
    fn sweep(&self) {
        let Ok(entries) = fs::read_dir(&self.dir) else { return };
        for entry in entries.flatten() {
            let name = entry.file_name();
            let Some(made) = name_of_temporary(&name) else { continue };
            let lock = File::create(self.lock_file(made));
            if lock.is_ok_and(|lock| lock.try_lock().is_ok() && entry.path().is_dir()) {
                let _ = fs::remove_dir_all(entry.path());
            }
        }
    }

    fn fault(&self) -> impl FnOnce(io::Error) -> SutError + use<> {
        SutError::io(format!("cannot write to {}", self.dir.display()))
    }
}

/// Of the temporary folders in which the part is made.
fn temporary_prefix(name: &str) -> String {
    format!(".{name}.making-")
}

/// The name of the part that is made in a temporary folder.
fn name_of_temporary(name: &OsStr) -> Option<&str> {
    let (made, _) = name.to_str()?.strip_prefix('.')?.rsplit_once(".making-")?;
    Some(made)
}

/// Each file with its size and the second of its last change: archives keep no more.
#[derive(Serialize, Deserialize)]
struct FolderManifest {
    files: Vec<(String, u64, i64)>,
}

impl FolderManifest {
    fn of(folder: &Path) -> Self {
        let mut files = Vec::new();
        for entry in WalkDir::new(folder).sort_by_file_name().into_iter().flatten() {
            let Ok(relative) = entry.path().strip_prefix(folder) else { continue };
            if let (true, Some(name), Ok(data)) =
                (entry.file_type().is_file(), relative.to_str(), entry.metadata())
            {
                files.push((name.to_owned(), data.len(), data.mtime()));
            }
        }
        Self { files }
    }
}

/// What is wrong with a part, if anything. Files that came later are nobody's damage.
fn damage(place: &Path) -> Option<String> {
    let Some(manifest) = fs::read(place.join(MANIFEST)).ok() else {
        return Some(format!("{} is missing", place.join(MANIFEST).display()));
    };
    let Ok(FolderManifest { files }) = serde_json::from_slice(&manifest) else {
        return Some(format!("{} cannot be read", place.join(MANIFEST).display()));
    };
    files.into_iter().find_map(|(name, size, time)| {
        let path = place.join(name);
        match fs::symlink_metadata(&path) {
            Ok(data) if data.len() == size && data.mtime() == time => None,
            Ok(_) => Some(format!("{} has changed", path.display())),
            Err(_) => Some(format!("{} is missing", path.display())),
        }
    })
}

#[cfg(test)]
mod tests {
    use std::{cell::RefCell, sync::mpsc::channel};

    use super::*;

    fn part() -> CachePart<'static> {
        CachePart { kind: "x", key: "1".to_owned(), what: "x" }
    }

    fn fill(making: &MakingPart) -> Result<(), SutError> {
        fs::write(making.folder.join("all"), "12").map_err(SutError::io("write"))
    }

    fn kept(dir: &Path) -> Vec<String> {
        let names = fs::read_dir(dir).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
        names.filter(|name| !name.ends_with(".lock") && name != TAG.0).collect()
    }

    #[test]
    fn a_folder_is_made_once_and_never_half() {
        let dir = tempfile::tempdir().unwrap();
        let cache = EnvironmentCache::open(dir.path(), &|_| {}).unwrap();
        let fail = cache.made(&part(), |making| {
            fs::write(making.folder.join("half"), "").unwrap();
            Err(SutError::Environment { what: "w".into(), detail: "d".into() })
        });
        assert!(fail.is_err());
        assert!(kept(dir.path()).is_empty(), "nothing stays behind");
        let first = cache.made(&part(), fill).unwrap();
        let again = cache.made(&part(), |_| panic!("made twice")).unwrap();
        assert_eq!(first, again);
        assert_eq!(kept(dir.path()), ["x-1"]);
    }

    #[test]
    fn damage_is_told_and_repaired() {
        let dir = tempfile::tempdir().unwrap();
        let told = RefCell::new(Vec::new());
        let listen = |step: PreparationStep<'_>| {
            if let PreparationStep::Damaged { why, .. } = step {
                told.borrow_mut().push(why.to_owned());
            }
        };
        let cache = EnvironmentCache::open(dir.path(), &listen).unwrap();
        let place = cache.made(&part(), fill).unwrap();
        fs::write(place.join("of a program"), "").unwrap();
        cache.made(&part(), |_| panic!("a file more is no damage")).unwrap();
        fs::write(place.join("all"), "1").unwrap();
        cache.made(&part(), fill).unwrap();
        let time = fs::File::open(place.join("all")).unwrap();
        time.set_modified(std::time::UNIX_EPOCH).unwrap();
        cache.made(&part(), fill).unwrap();
        fs::remove_file(place.join("all")).unwrap();
        cache.made(&part(), fill).unwrap();
        let ends: Vec<bool> = ["all has changed", "all has changed", "all is missing"]
            .iter()
            .zip(told.borrow().iter())
            .map(|(end, why)| why.ends_with(end))
            .collect();
        assert_eq!(ends, [true; 3], "{:?}", told.borrow());
    }

    /// The second says that it waits, and makes nothing; meanwhile nobody sweeps away what the first is making.
    #[test]
    fn a_second_maker_waits_for_the_first() {
        let dir = tempfile::tempdir().unwrap();
        let (waits, waiting) = channel();
        let (begins, begun) = channel();
        std::thread::scope(|scope| {
            scope.spawn(|| {
                let first = EnvironmentCache::open(dir.path(), &|_| {}).unwrap();
                let made = first.made(&part(), move |making| {
                    begins.send(()).unwrap();
                    waiting.recv().unwrap();
                    fill(making)
                });
                made.unwrap();
            });
            begun.recv().unwrap();
            let listen = |step: PreparationStep<'_>| match step {
                PreparationStep::Waiting { .. } => waits.send(()).unwrap(),
                other => panic!("{other:?}"),
            };
            let second = EnvironmentCache::open(dir.path(), &listen).unwrap();
            let place = second.made(&part(), |_| panic!("made twice")).unwrap();
            assert!(place.join("all").exists());
        });
    }

    #[test]
    fn what_nobody_works_in_is_swept_away() {
        let dir = tempfile::tempdir().unwrap();
        let left = dir.path().join(format!("{}abc", temporary_prefix("x-1")));
        fs::create_dir(&left).unwrap();
        fs::write(left.join("half"), "").unwrap();
        let lock = File::create(dir.path().join(".x-1.lock")).unwrap();
        lock.lock().unwrap();
        EnvironmentCache::open(dir.path(), &|_| {}).unwrap();
        assert!(left.exists(), "somebody works there");
        drop(lock);
        EnvironmentCache::open(dir.path(), &|_| {}).unwrap();
        assert!(!left.exists());
    }
}
