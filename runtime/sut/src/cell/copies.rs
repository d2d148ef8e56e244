//! The fallback where namespaces are refused: the program runs in a copy of the project's folder.

use std::{
    fs::{self, File, FileTimes},
    io,
    os::unix::fs::symlink,
    path::{Path, PathBuf},
};

/// A cell's folder, with the copy in it; removed when dropped.
pub(super) struct Copy {
    folder: tempfile::TempDir,
    original: PathBuf,
}

impl Copy {
    /// Copies the folder, but for what is `hidden`. Virtual environments are linked to: programs do not write into them,
    /// and they are large.
    pub(super) fn make(original: &Path, hidden: &[PathBuf]) -> io::Result<Self> {
        let folder = tempfile::Builder::new().prefix("hrdsl-cell-").tempdir()?;
        let copy = Self { folder, original: original.to_owned() };
        copy_folder(original, &copy.project(), hidden)?;
        fs::create_dir(copy.home())?;
        fs::create_dir(copy.temporary())?;
        Ok(copy)
    }

    pub(super) fn project(&self) -> PathBuf {
        self.folder.path().join("project")
    }

    pub(super) fn home(&self) -> PathBuf {
        self.folder.path().join("home")
    }

    pub(super) fn temporary(&self) -> PathBuf {
        self.folder.path().join("tmp")
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
