//! The files that a program wrote, copied out of its cell before it is gone.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use super::message::{CELL_FOLDER, KeptFiles};

/// At most so many files are kept of one cell.
const MOST_FILES: u64 = 10_000;

/// Copies the regular files of some folders for which `is_new` holds, of at most so many bytes: a file may be much longer than
/// what it has on the disk. Each folder is given as the program knows it, and as it is found; its files are kept in
/// `project/`, `home/`, `tmp/` or `elsewhere/`.
pub(super) fn keep(
    folders: &[(PathBuf, PathBuf)],
    project: &Path,
    to: &Path,
    most_bytes: u64,
    is_new: &dyn Fn(&Path) -> bool,
) -> KeptFiles {
    let mut keeper = FileKeeper { kept: KeptFiles::default(), most_bytes, bytes: 0 };
    for (known_as, found_at) in folders {
        keeper.keep_folder(known_as, found_at, &|path| to.join(place(path, project)), is_new);
    }
    keeper.kept
}

struct FileKeeper {
    kept: KeptFiles,
    most_bytes: u64,
    bytes: u64,
}

/// Where a file of the cell is kept.
fn place(path: &Path, project: &Path) -> PathBuf {
    if let Ok(rest) = path.strip_prefix(project) {
        return Path::new("project").join(rest);
    }
    match (path.strip_prefix(CELL_FOLDER), path.strip_prefix("/")) {
        (Ok(rest), _) => rest.to_owned(),
        (Err(_), Ok(rest)) => Path::new("elsewhere").join(rest),
        (Err(_), Err(_)) => Path::new("elsewhere").join(path),
    }
}

impl FileKeeper {
    fn keep_folder(
        &mut self,
        known_as: &Path,
        found_at: &Path,
        target: &dyn Fn(&Path) -> PathBuf,
        is_new: &dyn Fn(&Path) -> bool,
    ) {
        let Ok(entries) = fs::read_dir(found_at) else { return };
        let mut entries: Vec<_> = entries.filter_map(Result::ok).collect();
        entries.sort_by_key(fs::DirEntry::file_name);
        for entry in entries {
            let (known_as, found_at) = (known_as.join(entry.file_name()), entry.path());
            let Ok(kind) = entry.file_type() else { continue };
            if kind.is_dir() {
                // Compiled Python is of no interest to anybody.
                if entry.file_name() != "__pycache__" {
                    self.keep_folder(&known_as, &found_at, target, is_new);
                }
            } else if kind.is_file() && is_new(&found_at) {
                self.keep_file(&found_at, &target(&known_as));
            }
        }
    }

    fn keep_file(&mut self, from: &Path, to: &Path) {
        let kept = &mut self.kept;
        if kept.files >= MOST_FILES {
            if kept.files == MOST_FILES {
                kept.failures.push(format!("only the first {MOST_FILES} files are kept"));
                kept.files += 1;
            }
            return;
        }
        let length = fs::symlink_metadata(from).map_or(0, |is| is.len());
        if self.bytes.saturating_add(length) > self.most_bytes {
            let most = self.most_bytes;
            kept.failures.push(format!(
                "{}: with its {length} bytes, more than {most} (`memory`) would be kept",
                from.display()
            ));
            return;
        }
        self.bytes += length;
        let copied: io::Result<()> =
            to.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| fs::copy(from, to)).map(drop);
        match copied {
            Ok(()) => kept.files += 1,
            Err(e) => kept.failures.push(format!("{}: {e}", from.display())),
        }
    }
}
