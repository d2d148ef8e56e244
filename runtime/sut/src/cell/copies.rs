//! The fallback where namespaces are refused: the program runs in a copy of the project's folder.

use std::{
    fs::{self, File, FileTimes, Permissions},
    io,
    os::unix::fs::{PermissionsExt, symlink},
    path::{Path, PathBuf},
};

/// A folder for a cell, removed when dropped, whatever the program has made of it.
pub(super) struct CellFolder(tempfile::TempDir);

impl CellFolder {
    pub(super) fn make() -> io::Result<Self> {
        let temporary = std::env::temp_dir().canonicalize()?;
        Ok(Self(tempfile::Builder::new().prefix("hrdsl-cell-").tempdir_in(temporary)?))
    }

    pub(super) fn path(&self) -> &Path {
        self.0.path()
    }
}

impl Drop for CellFolder {
    fn drop(&mut self) {
        empty(self.path());
    }
}

/// Removes all that is in a folder: also what lies deeper than a path can say or files can be open at once, and what its
/// owner has locked. Each folder is moved to the top before it is looked into.
fn empty(top: &Path) {
    let unlock = |folder: &Path| fs::set_permissions(folder, Permissions::from_mode(0o700));
    let mut open = vec![top.to_owned()];
    let mut moved = 0_u64;
    while let Some(folder) = open.pop() {
        let _ = unlock(&folder);
        let Ok(entries) = fs::read_dir(&folder) else { continue };
        for entry in entries.filter_map(Result::ok).collect::<Vec<_>>() {
            let path = entry.path();
            if !entry.file_type().is_ok_and(|kind| kind.is_dir()) {
                let _ = fs::remove_file(path);
                continue;
            }
            let _ = unlock(&path);
            moved += 1;
            let to = top.join(format!(".removed-{moved}"));
            open.push(if fs::rename(&path, &to).is_ok() { to } else { path });
        }
        if folder != top {
            let _ = fs::remove_dir(folder);
        }
    }
}

/// A copy of the project's folder, in the folder of a cell.
pub(super) struct ProjectCopy {
    folder: PathBuf,
    original: PathBuf,
}

impl ProjectCopy {
    /// Copies the project's folder into `folder`, but for what is `hidden`. Virtual environments are linked to: programs do
    /// not write into them, and they are large.
    pub(super) fn make(folder: PathBuf, original: &Path, hidden: &[PathBuf]) -> io::Result<Self> {
        let copy = Self { folder, original: original.to_owned() };
        copy_folder(original, &copy.project(), hidden)?;
        fs::create_dir(copy.home())?;
        fs::create_dir(copy.temporary())?;
        Ok(copy)
    }

    pub(super) fn project(&self) -> PathBuf {
        self.folder.join("project")
    }

    pub(super) fn home(&self) -> PathBuf {
        self.folder.join("home")
    }

    pub(super) fn temporary(&self) -> PathBuf {
        self.folder.join("tmp")
    }

    /// A word of the command: a path into the project's folder leads into the copy.
    pub(super) fn moved(&self, word: &Path) -> PathBuf {
        match word.strip_prefix(&self.original) {
            Ok(rest) if !is_virtual_environment(word.ancestors(), &self.original) => {
                self.project().join(rest)
            }
            Ok(_) | Err(_) => word.to_owned(),
        }
    }

    /// Whether a file of the copy is as it was in the original.
    pub(super) fn is_unchanged(&self, path: &Path) -> bool {
        let Ok(rest) = path.strip_prefix(self.project()) else { return false };
        let (Ok(now), Ok(before)) = (path.symlink_metadata(), self.original.join(rest).symlink_metadata())
        else {
            return false;
        };
        now.is_symlink() && before.is_symlink()
            || now.len() == before.len() && now.modified().ok() == before.modified().ok()
    }
}

fn is_virtual_environment<'a>(folders: impl Iterator<Item = &'a Path>, root: &Path) -> bool {
    folders.take_while(|f| *f != root).any(|f| f.join("pyvenv.cfg").is_file())
}

fn copy_folder(from: &Path, to: &Path, hidden: &[PathBuf]) -> io::Result<()> {
    fs::create_dir(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let (source, target) = (entry.path(), to.join(entry.file_name()));
        let kind = entry.file_type()?;
        if hidden.contains(&source) {
            continue;
        }
        if kind.is_symlink() {
            symlink(fs::read_link(&source)?, &target)?;
        } else if kind.is_dir() {
            if source.join("pyvenv.cfg").is_file() {
                symlink(&source, &target)?;
            } else {
                copy_folder(&source, &target, hidden)?;
            }
        } else if kind.is_file() {
            copy_file(&source, &target)?;
        }
        // Sockets, pipes and devices are left out: a copy of them would be another one.
    }
    fs::set_permissions(to, fs::metadata(from)?.permissions())
}

/// Copies a file with its permissions and times, by which compiled Python files are known to be fresh.
fn copy_file(from: &Path, to: &Path) -> io::Result<()> {
    fs::copy(from, to)?;
    let is = fs::metadata(from)?;
    let times = FileTimes::new().set_accessed(is.accessed()?).set_modified(is.modified()?);
    // A file that may not be written may not be opened for writing either; its times can be set all the same.
    File::open(to)?.set_times(times)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_deep_or_locked_is_removed_all_the_same() {
        let folder = CellFolder::make().unwrap();
        let top = folder.path().to_owned();
        // Folders around one another, since no path leads so deep.
        let (inner, outer) = (top.join("inner"), top.join("outer"));
        fs::create_dir(&inner).unwrap();
        for _ in 0..3000 {
            fs::create_dir(&outer).unwrap();
            fs::rename(&inner, outer.join("inner")).unwrap();
            fs::rename(&outer, &inner).unwrap();
        }
        fs::create_dir_all(top.join("locked/in")).unwrap();
        fs::write(top.join("locked/in/file"), "").unwrap();
        symlink("/", top.join("locked/link")).unwrap();
        for path in ["locked/in", "locked"] {
            fs::set_permissions(top.join(path), Permissions::from_mode(0o000)).unwrap();
        }
        drop(folder);
        assert!(!top.exists());
    }
}
