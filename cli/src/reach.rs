//! Which files a text may name (`use "…"`, what a program includes): regular ones below the project's folder. So a text from
//! elsewhere, checked where others read what is said about it, shows nobody's other files.

use std::{
    cell::RefCell,
    collections::BTreeSet,
    fs,
    io::Read as _,
    path::{Component, Path, PathBuf},
    sync::OnceLock,
};

use hrdsl_compiler::{ModuleLoader, ModuleText, RobotEntry, RobotReader, WorkspaceEntry, WorkspaceReader};

use crate::{
    covered_files,
    fault::CommandFault,
    files::{folder as folder_of, read},
    terminal::shown,
};

static ALLOWED: OnceLock<Vec<PathBuf>> = OnceLock::new();

/// Settles what `--allow-path` opens, for the whole process.
///
/// # Errors
/// A folder that is not there.
pub fn allow(folders: &[PathBuf]) -> Result<(), CommandFault> {
    let whole = |folder: &PathBuf| match folder.canonicalize() {
        Ok(whole) if whole.is_dir() => Ok(whole),
        Ok(_) | Err(_) => Err(format!("--allow-path: there is no folder {}", shown(folder))),
    };
    let folders = folders.iter().map(whole).collect::<Result<Vec<_>, _>>()?;
    ALLOWED.get_or_init(|| folders);
    Ok(())
}

/// The folders whose files a text may name.
#[derive(Clone, Debug)]
pub struct FileReach {
    folders: Vec<PathBuf>,
    /// How the names of such files end, of which a text is read.
    endings: &'static [&'static str],
}

impl FileReach {
    /// Of a file that was named on the command line, or of standard input.
    #[must_use]
    pub fn of(file: Option<&Path>, endings: &'static [&'static str]) -> Self {
        let folder = file.map_or_else(|| PathBuf::from("."), folder_of);
        let own = folder.canonicalize().unwrap_or(folder);
        let project = own.ancestors().find(|f| f.join(".git").exists()).map(Path::to_owned);
        let allowed = ALLOWED.get().cloned().unwrap_or_default();
        Self { folders: std::iter::once(project.unwrap_or(own)).chain(allowed).collect(), endings }
    }

    /// The real place of a file or folder, if it may be named.
    fn whole(&self, path: &Path) -> Result<PathBuf, String> {
        let Ok(whole) = path.canonicalize() else { return Err(format!("there is no {}", shown(path))) };
        if self.folders.iter().any(|f| whole.starts_with(f)) {
            return Ok(whole);
        }
        let first = shown(&self.folders[0]);
        Err(format!("{} is outside of {first}; `--allow-path DIR` opens another folder", shown(path)))
    }

    /// The file that a path means in the file called `from`, and its text.
    ///
    /// # Errors
    /// Why it is not read, as the end of a sentence.
    pub fn read(&self, from: &str, path: &str) -> Result<(PathBuf, String), String> {
        let file = tidy(&folder_of(Path::new(from)).join(path));
        if !file.exists() {
            return Err(format!("there is no file {}", shown(&file)));
        }
        let whole = self.whole(&file)?;
        // What is no file may have no end, or wait for somebody to write.
        if !fs::metadata(&whole).is_ok_and(|m| m.is_file()) {
            return Err(format!("{} is no regular file", shown(&file)));
        }
        let ending = whole.extension().and_then(|e| e.to_str()).unwrap_or_default();
        if !self.endings.contains(&ending) {
            let endings = self.endings.iter().map(|e| format!("`.{e}`")).collect::<Vec<_>>().join(" or ");
            return Err(format!("the name of {} does not end in {endings}", shown(&file)));
        }
        let text = read(&file)?;
        Ok((file, text))
    }
}

/// The files that `use "…"` names, relative to the file that uses them.
pub struct DiskModules {
    reach: FileReach,
    /// That of the file; `None`: standard input has none.
    folder: Option<PathBuf>,
    /// Where meshes that are not there have something in their place: their paths.
    gone: Option<RefCell<BTreeSet<String>>>,
}

impl DiskModules {
    /// For a file that was named on the command line, or for standard input.
    #[must_use]
    pub fn of(file: Option<&Path>) -> Self {
        let folder = file.and_then(Path::parent).map(Path::to_path_buf);
        Self { reach: FileReach::of(file, &["hri"]), folder, gone: None }
    }

    /// The same, for commands that only look at what was recorded: a mesh that is not there has a small one in its place.
    #[must_use]
    pub fn to_look(file: Option<&Path>) -> Self {
        Self { gone: Some(RefCell::default()), ..Self::of(file) }
    }

    /// The meshes that were not there when they were read.
    #[must_use]
    pub fn gone(&self) -> Vec<String> {
        self.gone.iter().flat_map(|gone| gone.borrow().iter().cloned().collect::<Vec<_>>()).collect()
    }
}

impl ModuleLoader for DiskModules {
    fn load(&self, from: &str, path: &str) -> Result<ModuleText, String> {
        let (file, text) = self.reach.read(from, path)?;
        Ok(ModuleText { name: file.display().to_string(), text })
    }

    fn workspaces(&self, from: &str) -> Option<Box<dyn WorkspaceReader + '_>> {
        Some(Box::new(DiskWorkspace { reach: &self.reach, folder: folder_of(Path::new(from)) }))
    }

    fn robots(&self) -> Option<Box<dyn RobotReader + '_>> {
        Some(Box::new(DiskRobots { reach: &self.reach, gone: self.gone.as_ref() }))
    }

    fn means_a_file(&self, path: &str) -> Option<bool> {
        self.folder.as_ref().map(|folder| covered_files::is_there(folder, path))
    }
}

/// Descriptions of robots with their meshes, and maps.
struct DiskRobots<'r> {
    reach: &'r FileReach,
    gone: Option<&'r RefCell<BTreeSet<String>>>,
}

/// More than any mesh or picture has that is read.
const MOST_OF_A_MESH: u64 = (256 << 20) + 1;

impl RobotReader for DiskRobots<'_> {
    fn bytes(&self, file: &str) -> Result<Vec<u8>, String> {
        let file = tidy(Path::new(file));
        if !file.exists() {
            let stand_in = self.gone.and_then(|gone| Some((gone, stand_in(&file)?)));
            let Some((gone, stand_in)) = stand_in else { return Err("there is no such file".to_owned()) };
            gone.borrow_mut().insert(shown(&file));
            return Ok(stand_in.as_bytes().to_vec());
        }
        let whole = self.reach.whole(&file)?;
        // What is no file may have no end, or wait for somebody to write.
        if !fs::metadata(&whole).is_ok_and(|m| m.is_file()) {
            return Err("it is no regular file".to_owned());
        }
        let mut bytes = Vec::new();
        let file = fs::File::open(&whole).map_err(|e| e.to_string())?;
        file.take(MOST_OF_A_MESH).read_to_end(&mut bytes).map_err(|e| e.to_string())?;
        Ok(bytes)
    }

    fn entries(&self, folder: &str) -> Result<Vec<RobotEntry>, String> {
        let folder = tidy(Path::new(folder));
        if !folder.is_dir() {
            return Err("there is no such folder".to_owned());
        }
        let whole = self.reach.whole(&folder)?;
        let entries = fs::read_dir(whole).map_err(|e| e.to_string())?;
        let entry = |e: fs::DirEntry| RobotEntry {
            name: e.file_name().to_string_lossy().into_owned(),
            is_folder: e.path().is_dir(),
        };
        Ok(entries.filter_map(Result::ok).map(entry).collect())
    }

    fn working_folder(&self) -> String {
        std::env::current_dir().map_or_else(|_| String::new(), |folder| folder.to_string_lossy().into_owned())
    }

    fn is_file(&self, file: &str) -> bool {
        self.reach.whole(&tidy(Path::new(file))).is_ok_and(|whole| whole.is_file())
    }
}

/// What stands for a mesh of this name: a tetrahedron in the same format. `None`: it is no mesh.
fn stand_in(file: &Path) -> Option<&'static str> {
    match file.extension()?.to_str()?.to_ascii_lowercase().as_str() {
        "stl" => Some(include_str!("stand_in/mesh.stl")),
        "obj" => Some(include_str!("stand_in/mesh.obj")),
        "dae" => Some(include_str!("stand_in/mesh.dae")),
        _ => None,
    }
}

/// The ROS workspaces that a file names, relative to its folder.
struct DiskWorkspace<'r> {
    reach: &'r FileReach,
    folder: PathBuf,
}

/// More of a file than any definition has.
const MOST_OF_A_DEFINITION: u64 = 2 << 20;

impl WorkspaceReader for DiskWorkspace<'_> {
    fn entries(&self, folder: &str) -> Result<Vec<WorkspaceEntry>, String> {
        let folder = tidy(&self.folder.join(folder));
        let whole = self.reach.whole(&folder)?;
        let entries = fs::read_dir(whole).map_err(|e| e.to_string())?;
        let entry = |e: fs::DirEntry| WorkspaceEntry {
            name: e.file_name().to_string_lossy().into_owned(),
            is_folder: e.path().is_dir(),
        };
        Ok(entries.filter_map(Result::ok).map(entry).collect())
    }

    fn place(&self, folder: &str) -> String {
        let place = self.folder.join(folder);
        place.canonicalize().unwrap_or(place).display().to_string()
    }

    fn text(&self, file: &str) -> Result<String, String> {
        let whole = self.reach.whole(&self.folder.join(file))?;
        if !fs::metadata(&whole).is_ok_and(|m| m.is_file()) {
            return Err("it is no regular file".to_owned());
        }
        let mut text = String::new();
        let file = fs::File::open(&whole).map_err(|e| e.to_string())?;
        file.take(MOST_OF_A_DEFINITION).read_to_string(&mut text).map_err(|e| e.to_string())?;
        Ok(text)
    }
}

/// The same path without `.` and, where a folder can be taken back, without `..`: one file has one name.
fn tidy(path: &Path) -> PathBuf {
    let mut tidy = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if matches!(tidy.components().next_back(), Some(Component::Normal(_))) => {
                tidy.pop();
            }
            Component::ParentDir | Component::Normal(_) | Component::RootDir | Component::Prefix(_) => {
                tidy.push(part);
            }
        }
    }
    if tidy.as_os_str().is_empty() { PathBuf::from(".") } else { tidy }
}
