//! A folder for results, given by `-o`: nobody's files are lost in it, and what is in it belongs together.
//!
//! A file of ours in it, [`MARKER`], lists what hrdsl has written there, and is locked while somebody writes. A run collects its
//! results in a folder beside them; when it is over, what the marker lists is removed, and the new results take their
//! places by renaming.

use std::{
    fs::{self, File, TryLockError},
    io::{Read, Seek, Write},
    path::{Component, Path, PathBuf},
};

use crate::{fault::CommandFault, files, terminal::shown};

/// Lists what hrdsl wrote, one path a line, after a line that says what it is. `check` skips what it lists.
pub const MARKER: &str = ".hrdsl-results";
/// The folder of a campaign's recordings.
pub const TRACES: &str = "traces";
/// The folder of what can be looked at of its tests.
pub const REPLAYS: &str = "replays";
/// Where results are collected until the run is over.
const STAGING: &str = ".hrdsl-partial";
const FIRST_LINE: &str = "hrdsl results 1";

/// The files in and below a folder that hrdsl has written, by its list.
#[must_use]
pub fn written(dir: &Path) -> Vec<PathBuf> {
    let text = fs::read_to_string(dir.join(MARKER)).unwrap_or_default();
    listed(&text).unwrap_or_default().iter().map(|path| dir.join(path)).collect()
}

/// What a marker lists; `None` if it is of another version.
fn listed(marker: &str) -> Option<Vec<PathBuf>> {
    let mut lines = marker.lines();
    if !matches!(lines.next(), None | Some(FIRST_LINE)) {
        return None;
    }
    // A path that leads out of the folder is none of ours, whoever wrote it there.
    let is_inside = |p: &PathBuf| p.components().all(|c| matches!(c, Component::Normal(_)));
    Some(lines.map(PathBuf::from).filter(is_inside).collect())
}

/// A folder that hrdsl writes to; nobody else can write to it meanwhile.
pub struct ResultsFolder {
    dir: PathBuf,
    marker: File,
    /// What is there of an earlier run: files, relative to the folder.
    listed: Vec<PathBuf>,
    /// Whether the folder was made for this.
    is_new: bool,
}

impl ResultsFolder {
    /// Opens or makes a folder, to [write](Self::write) files into it one by one, beside what is there.
    ///
    /// # Errors
    /// Who else is writing, or why the folder cannot be written.
    pub fn beside(dir: &Path) -> Result<Self, CommandFault> {
        refuse_link(dir)?;
        let is_new = !dir.exists();
        fs::create_dir_all(dir).map_err(|e| format!("cannot make {}: {e}", shown(dir)))?;
        let (marker, listed) = open_marker(dir)?;
        Ok(Self { dir: dir.to_owned(), marker, listed, is_new })
    }

    /// Opens or makes a folder, in which `names` are to be [published](Self::publish). Dropped before that, it leaves the
    /// folder as it was.
    ///
    /// # Errors
    /// What would be lost or overwritten, who else is writing, or why the folder cannot be written.
    pub fn open(dir: &Path, names: &[&str]) -> Result<Self, CommandFault> {
        let folder = Self::beside(dir)?;
        for name in names {
            folder.refuse_foreign(Path::new(name))?;
        }
        refuse_link(&folder.staging())?;
        folder.clear_staging()?;
        fs::create_dir(folder.staging()).map_err(|e| format!("cannot write to {}: {e}", shown(dir)))?;
        Ok(folder)
    }

    /// Writes a file of ours, in the place of an earlier one or of none.
    ///
    /// # Errors
    /// A file that is somebody else's, or that cannot be written.
    pub fn write(&mut self, name: &Path, text: &str) -> Result<PathBuf, CommandFault> {
        self.refuse_foreign(name)?;
        if !self.listed.iter().any(|l| l == name) {
            self.listed.push(name.to_owned());
            // Listed first: what is there and not listed is not ours.
            let listed = self.listed.clone();
            self.write_marker(listed.iter())?;
        }
        let path = self.dir.join(name);
        files::write(&path, text)?;
        Ok(path)
    }

    /// Removes what is ours in and below a folder of this folder.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub fn clear(&mut self, below: &Path) -> Result<(), CommandFault> {
        let (old, rest): (Vec<PathBuf>, Vec<PathBuf>) =
            std::mem::take(&mut self.listed).into_iter().partition(|l| l.starts_with(below));
        self.listed = rest;
        for path in &old {
            self.remove(path)?;
        }
        let listed = self.listed.clone();
        self.write_marker(listed.iter())
    }

    /// Where to write results until they are published.
    #[must_use]
    pub fn staging(&self) -> PathBuf {
        self.dir.join(STAGING)
    }

    /// Puts what was collected in the place of what was there; `last` is what readers look for, and appears at the end.
    ///
    /// # Errors
    /// A file that cannot be moved or removed.
    pub fn publish(mut self, last: &[&str]) -> Result<(), CommandFault> {
        let staging = self.staging();
        let new = files_below(&staging)?;
        let old = std::mem::take(&mut self.listed);
        // Whatever happens from here on, what is in the folder is listed.
        self.write_marker(old.iter().chain(&new))?;
        // The reports first: they must not stand beside recordings of another run.
        let is_last = |path: &PathBuf| last.iter().any(|l| path == Path::new(l));
        let (first, rest): (Vec<PathBuf>, Vec<PathBuf>) = old.into_iter().partition(is_last);
        for path in first.into_iter().chain(rest) {
            self.remove(&path)?;
        }
        let mut names: Vec<PathBuf> = Vec::new();
        for path in &new {
            let top = PathBuf::from(path.components().next().map_or(path.as_os_str(), |c| c.as_os_str()));
            if !names.contains(&top) {
                names.push(top);
            }
        }
        names.sort_by_key(is_last);
        for name in names {
            let (from, to) = (staging.join(&name), self.dir.join(&name));
            fs::rename(&from, &to).map_err(|e| format!("cannot write {}: {e}", shown(&to)))?;
        }
        self.write_marker(new.iter())?;
        self.listed = new;
        Ok(())
    }

    fn write_marker<'p>(&mut self, paths: impl Iterator<Item = &'p PathBuf>) -> Result<(), CommandFault> {
        let mut text = format!("{FIRST_LINE}\n");
        for path in paths {
            text.push_str(&path.to_string_lossy());
            text.push('\n');
        }
        // In place, since the lock is on this very file.
        let mut write = || -> std::io::Result<()> {
            self.marker.rewind()?;
            self.marker.write_all(text.as_bytes())?;
            self.marker.set_len(text.len() as u64)
        };
        write().map_err(|e| format!("cannot write {}: {e}", shown(&self.dir.join(MARKER))))
    }

    /// Removes a listed file, and the folders that are empty then.
    fn remove(&self, path: &Path) -> Result<(), CommandFault> {
        let file = self.dir.join(path);
        match fs::remove_file(&file) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                return Err(format!("cannot remove {}: {e}", shown(&file)));
            }
            Ok(()) | Err(_) => {}
        }
        for folder in path.ancestors().skip(1).filter(|f| !f.as_os_str().is_empty()) {
            // One that is not empty stays.
            if fs::remove_dir(self.dir.join(folder)).is_err() {
                break;
            }
        }
        Ok(())
    }

    /// Refuses to write where something lies that is not listed.
    fn refuse_foreign(&self, path: &Path) -> Result<(), CommandFault> {
        let full = self.dir.join(path);
        refuse_link(&full)?;
        let Ok(kind) = fs::symlink_metadata(&full) else { return Ok(()) };
        if !kind.is_dir() {
            return if self.listed.iter().any(|l| l == path) {
                Ok(())
            } else {
                Err(format!(
                    "{} was not written by hrdsl and would be lost; move it, or name another folder with -o",
                    shown(&full)
                ))
            };
        }
        for entry in fs::read_dir(&full).map_err(|e| format!("cannot read {}: {e}", shown(&full)))? {
            let entry = entry.map_err(|e| format!("cannot read {}: {e}", shown(&full)))?;
            self.refuse_foreign(&path.join(entry.file_name()))?;
        }
        Ok(())
    }

    fn clear_staging(&self) -> Result<(), CommandFault> {
        match fs::remove_dir_all(self.staging()) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                Err(format!("cannot clear {}: {e}", shown(&self.staging())))
            }
            Ok(()) | Err(_) => Ok(()),
        }
    }
}

impl Drop for ResultsFolder {
    fn drop(&mut self) {
        // What cannot be removed now is removed by the next run.
        let _ = self.clear_staging();
        if self.listed.is_empty() {
            let _ = fs::remove_file(self.dir.join(MARKER));
            if self.is_new {
                let _ = fs::remove_dir(&self.dir);
            }
        }
    }
}

fn refuse_link(path: &Path) -> Result<(), CommandFault> {
    if path.is_symlink() {
        return Err(format!(
            "{} is a symbolic link, and results are not written through links; name the folder itself with -o",
            shown(path)
        ));
    }
    Ok(())
}

/// The marker, locked, and what it lists.
fn open_marker(dir: &Path) -> Result<(File, Vec<PathBuf>), CommandFault> {
    let path = dir.join(MARKER);
    refuse_link(&path)?;
    let fault = |e: std::io::Error| format!("cannot write {}: {e}", shown(&path));
    let mut file =
        File::options().read(true).write(true).create(true).truncate(false).open(&path).map_err(fault)?;
    match file.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => {
            return Err(format!(
                "another run is writing to {}; wait for it to end, or name another folder with -o",
                shown(dir)
            ));
        }
        Err(TryLockError::Error(e)) => return Err(fault(e)),
    }
    let mut text = String::new();
    file.read_to_string(&mut text).map_err(fault)?;
    match listed(&text) {
        Some(listed) => Ok((file, listed)),
        None => Err(format!("{} is of another version of hrdsl; name another folder with -o", shown(&path))),
    }
}

/// All files in and below a folder, relative to it, in order; links are files.
///
/// # Errors
/// A folder that cannot be read.
pub fn files_below(root: &Path) -> Result<Vec<PathBuf>, CommandFault> {
    let mut found = Vec::new();
    collect(root, Path::new(""), &mut found)?;
    Ok(found)
}

fn collect(root: &Path, below: &Path, found: &mut Vec<PathBuf>) -> Result<(), CommandFault> {
    let folder = root.join(below);
    let fault = |e: std::io::Error| format!("cannot read {}: {e}", shown(&folder));
    let mut entries = fs::read_dir(&folder).map_err(fault)?.collect::<Result<Vec<_>, _>>().map_err(fault)?;
    entries.sort_by_key(fs::DirEntry::file_name);
    for entry in entries {
        let path = below.join(entry.file_name());
        if entry.file_type().map_err(fault)?.is_dir() {
            collect(root, &path, found)?;
        } else {
            found.push(path);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files(dir: &Path) -> Vec<String> {
        files_below(dir).unwrap().iter().map(|p| p.display().to_string()).filter(|p| p != MARKER).collect()
    }

    fn write(folder: &ResultsFolder, name: &str) {
        let path = folder.staging().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, name).unwrap();
    }

    #[test]
    fn new_results_take_the_place_of_old_ones_and_users_files_stay() {
        let place = tempfile::tempdir().unwrap();
        let dir = place.path().join("out");
        let folder = ResultsFolder::open(&dir, &["traces", "report.html"]).unwrap();
        write(&folder, "traces/a.jsonl");
        write(&folder, "traces/b.jsonl");
        write(&folder, "report.html");
        folder.publish(&["report.html"]).unwrap();
        assert_eq!(files(&dir), ["report.html", "traces/a.jsonl", "traces/b.jsonl"]);
        fs::write(dir.join("notes.txt"), "mine").unwrap();
        let folder = ResultsFolder::open(&dir, &["traces", "report.html"]).unwrap();
        assert!(dir.join("traces/a.jsonl").exists(), "until there is something new, the old is there");
        write(&folder, "traces/b.jsonl");
        folder.publish(&["report.html"]).unwrap();
        assert_eq!(files(&dir), ["notes.txt", "traces/b.jsonl"]);
    }

    #[test]
    fn what_is_not_listed_is_not_overwritten() {
        let place = tempfile::tempdir().unwrap();
        let dir = place.path().join("out");
        fs::create_dir_all(dir.join("traces/deep")).unwrap();
        fs::write(dir.join("traces/deep/mine.txt"), "mine").unwrap();
        let refusal = ResultsFolder::open(&dir, &["traces"]).err().unwrap();
        assert!(refusal.contains("deep/mine.txt was not written by hrdsl"), "{refusal}");
        assert!(ResultsFolder::open(&dir, &["report.html"]).is_ok());
        assert_eq!(files(&dir), ["traces/deep/mine.txt"], "and nothing is left behind");
    }

    #[test]
    fn links_and_other_writers_are_refused() {
        let place = tempfile::tempdir().unwrap();
        let dir = place.path().join("out");
        let first = ResultsFolder::open(&dir, &[]).unwrap();
        let refusal = ResultsFolder::open(&dir, &[]).err().unwrap();
        assert!(refusal.contains("another run is writing to"), "{refusal}");
        drop(first);
        assert!(!dir.exists(), "a folder that got nothing is gone");
        let elsewhere = place.path().join("elsewhere");
        fs::create_dir(&elsewhere).unwrap();
        std::os::unix::fs::symlink(&elsewhere, &dir).unwrap();
        assert!(ResultsFolder::open(&dir, &[]).err().unwrap().contains("is a symbolic link"));
        fs::create_dir(place.path().join("third")).unwrap();
        std::os::unix::fs::symlink(&elsewhere, place.path().join("third/traces")).unwrap();
        assert!(ResultsFolder::open(&place.path().join("third"), &["traces"]).is_err());
        assert_eq!(files(&elsewhere), Vec::<String>::new());
    }

    #[test]
    fn a_marker_cannot_lead_out_of_its_folder() {
        let place = tempfile::tempdir().unwrap();
        let dir = place.path().join("out");
        fs::create_dir(&dir).unwrap();
        fs::write(place.path().join("mine"), "").unwrap();
        fs::write(dir.join(MARKER), format!("{FIRST_LINE}\n../mine\n/etc/passwd\nreport.html\n")).unwrap();
        let folder = ResultsFolder::open(&dir, &["report.html"]).unwrap();
        assert_eq!(folder.listed, [PathBuf::from("report.html")]);
        folder.publish(&[]).unwrap();
        assert!(place.path().join("mine").exists());
    }
}
