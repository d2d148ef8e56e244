//! Local folders that are installed: what belongs to their contents, and copies of them to build from.

use std::{
    fs, io,
    os::unix::fs::{PermissionsExt, symlink},
    path::{Path, PathBuf},
};

use walkdir::{DirEntry, WalkDir};

use crate::error::SutError;

/// A file of a folder's contents.
pub(super) struct LocalContent {
    pub relative: PathBuf,
    /// Where its bytes are.
    pub path: PathBuf,
    pub executable: bool,
}

/// The files that belong to what is built from a folder, sorted; links are followed.
pub(super) fn contents(folder: &Path) -> Result<Vec<LocalContent>, SutError> {
    let walk = WalkDir::new(folder).follow_links(true).sort_by_file_name().into_iter();
    let mut contents = Vec::new();
    for entry in walk.filter_entry(|entry| !is_left_out(entry)) {
        let entry = match entry {
            Ok(entry) => entry,
            // A link that leads nowhere, or back to a folder above, adds nothing.
            Err(e) if e.loop_ancestor().is_some() || e.path().is_some_and(Path::is_symlink) => continue,
            Err(e) => return Err(SutError::io(format!("cannot read {}", folder.display()))(e.into())),
        };
        if !entry.file_type().is_file() {
            continue;
        }
        let read = || SutError::io(format!("cannot read {}", entry.path().display()));
        let mode = entry.metadata().map_err(|e| read()(e.into()))?.permissions().mode();
        let relative = entry.path().strip_prefix(folder).map_err(|e| read()(io::Error::other(e)))?;
        contents.push(LocalContent {
            relative: relative.to_owned(),
            path: entry.path().to_owned(),
            executable: mode & 0o111 != 0,
        });
    }
    Ok(contents)
}

/// What tools leave in a folder, and what has a life of its own there.
fn is_left_out(entry: &DirEntry) -> bool {
    if entry.depth() == 0 {
        return false;
    }
    let name = entry.file_name().to_string_lossy();
    if name == ".git" {
        return true;
    }
    if !entry.file_type().is_dir() {
        return false;
    }
    let has = |file: &str| entry.path().join(file).exists();
    // What setuptools has built before lies in `build`, unless that is a package of this name.
    let is_built = entry.depth() == 1 && name == "build" && !has("__init__.py");
    is_built
        || matches!(&*name, "__pycache__" | "hrdsl-out")
        || name.ends_with(".egg-info")
        || has("pyvenv.cfg")
        || has("CACHEDIR.TAG")
}

/// Copies a folder's contents to a place that does not exist yet.
pub(super) fn copy(folder: &Path, to: &Path) -> Result<(), SutError> {
    let fail = |path: &Path| SutError::io(format!("cannot copy {}", path.display()));
    fs::create_dir_all(to).map_err(fail(folder))?;
    for content in contents(folder)? {
        let place = to.join(&content.relative);
        if let Some(parent) = place.parent() {
            fs::create_dir_all(parent).map_err(fail(&content.path))?;
        }
        fs::copy(&content.path, &place).map_err(fail(&content.path))?;
    }
    // Some builds ask git for the version. A file `.git` (of a worktree) may hold a path relative to itself.
    let git = folder.join(".git");
    if git.is_dir() {
        symlink(&git, to.join(".git")).map_err(fail(&git))?;
    } else if let Some(leads_to) = fs::read_to_string(&git).ok().as_deref().and_then(git_folder) {
        let text = format!("gitdir: {}\n", folder.join(leads_to).display());
        fs::write(to.join(".git"), text).map_err(fail(&git))?;
    }
    Ok(())
}

fn git_folder(text: &str) -> Option<&str> {
    text.strip_prefix("gitdir:").map(str::trim)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(files: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for file in files {
            let path = folder.path().join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, file).unwrap();
        }
        folder
    }

    fn names(folder: &Path) -> Vec<String> {
        contents(folder).unwrap().iter().map(|c| c.relative.display().to_string()).collect()
    }

    #[test]
    fn contents_are_what_a_project_is_built_from() {
        let folder = folder(&[
            "a.py",
            "src/build/kept.py",
            "build/lib/a.py",
            "x.egg-info/PKG-INFO",
            "src/__pycache__/a.pyc",
            ".git/HEAD",
            "env/pyvenv.cfg",
            "env/lib/b.py",
            ".pytest_cache/CACHEDIR.TAG",
            "hrdsl-out/s/report.html",
        ]);
        assert_eq!(names(folder.path()), ["a.py", "src/build/kept.py"]);
        let package = self::folder(&["build/__init__.py"]);
        assert_eq!(names(package.path()), ["build/__init__.py"]);
    }

    #[test]
    fn links_are_followed_and_never_for_ever() {
        let (project, other) = (folder(&["a.py"]), folder(&["deep/b.py"]));
        let at = |name: &str| project.path().join(name);
        symlink(other.path().join("deep"), at("linked")).unwrap();
        symlink(project.path(), at("round")).unwrap();
        symlink("nowhere", at("dangling")).unwrap();
        assert_eq!(names(project.path()), ["a.py", "linked/b.py"]);
    }

    #[test]
    fn a_copy_has_its_modes_and_leads_to_its_repository() {
        let project = folder(&["bin/tool", ".git/HEAD", "build/old"]);
        let tool = project.path().join("bin/tool");
        fs::set_permissions(&tool, fs::Permissions::from_mode(0o755)).unwrap();
        let to = tempfile::tempdir().unwrap();
        copy(project.path(), &to.path().join("copy")).unwrap();
        let copied = contents(&to.path().join("copy")).unwrap();
        assert_eq!(copied.iter().map(|c| c.executable).collect::<Vec<_>>(), [true]);
        assert_eq!(fs::read_to_string(to.path().join("copy/.git/HEAD")).unwrap(), ".git/HEAD");

        let worktree = folder(&["a.py"]);
        fs::write(worktree.path().join(".git"), "gitdir: ../main/.git/worktrees/w\n").unwrap();
        copy(worktree.path(), &to.path().join("worktree")).unwrap();
        let leads_to = format!("gitdir: {}/../main/.git/worktrees/w\n", worktree.path().display());
        assert_eq!(fs::read_to_string(to.path().join("worktree/.git")).unwrap(), leads_to);
    }
}
