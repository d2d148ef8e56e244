//! A private view of the file system: everything that the machine has can be read, and what is written stays in memory of
//! the cell's own.
//!
//! A new root is put together from overlays, whose lower layers are the machine's folders and whose upper layers lie in
//! one file system in memory. An overlay takes no other mounts along: what is mounted below its folder is mounted in it, too. The
//! kernel does not allow one over a folder that has mounts below it when these came from a more privileged namespace; such folders
//! are made anew and their entries mounted one by one.

use std::{
    ffi::CString,
    fs::{self, DirBuilder, Permissions},
    io,
    os::{
        fd::{AsRawFd, OwnedFd},
        unix::{
            ffi::OsStringExt,
            fs::{DirBuilderExt, MetadataExt, PermissionsExt, chown, symlink},
        },
    },
    path::{Path, PathBuf},
};

use rustix::{
    fs::{CWD, FileType, Mode, OFlags, mknodat, open},
    io::Errno,
    mount::{
        MountFlags, MountPropagationFlags, UnmountFlags, mount, mount_bind, mount_bind_recursive,
        mount_change, mount_remount, unmount,
    },
    process::pivot_root,
};

/// Where the layers lie until the new root is entered. The machine's own folder is kept open before it is covered.
const SCRATCH: &str = "/tmp";

/// File systems that are windows into the kernel: there is nothing to keep apart in them.
const KERNEL: [&str; 16] = [
    "autofs",
    "binfmt_misc",
    "bpf",
    "cgroup",
    "cgroup2",
    "configfs",
    "debugfs",
    "devpts",
    "devtmpfs",
    "efivarfs",
    "fusectl",
    "mqueue",
    "pstore",
    "securityfs",
    "sysfs",
    "tracefs",
];

/// Of those, the ones in which programs make entries of their own as a matter of course: terminals, queues.
const USED_BY_NAME: [&str; 2] = ["devpts", "mqueue"];

/// In `/proc`, what is no process: settings of the kernel, which are those of the whole machine.
const SETTINGS: [&str; 5] = ["sys", "sysrq-trigger", "irq", "bus", "fs"];

/// Where something is mounted.
#[derive(Debug, PartialEq, Eq)]
struct MountPoint {
    at: PathBuf,
    /// Of file system.
    kind: String,
    is_read_only: bool,
}

impl MountPoint {
    fn is_of_kernel(&self) -> bool {
        KERNEL.contains(&self.kind.as_str())
    }

    /// Whether what is written there by name could be seen by others.
    fn has_settings(&self) -> bool {
        !USED_BY_NAME.contains(&self.kind.as_str())
    }
}

/// What went wrong, and where.
pub(super) type ViewError = (String, io::Error);

/// The view of one cell.
pub(super) struct PrivateView {
    /// Mount points of the machine; a later one covers an earlier one.
    mounts: Vec<MountPoint>,
    /// The machine's folder that the layers cover.
    covered: OwnedFd,
    /// The file system in memory that has the layers.
    layers: OwnedFd,
    /// The program's own folders.
    own: Vec<PathBuf>,
    /// The overlays: the folder, and its upper layer.
    overlays: Vec<(PathBuf, PathBuf)>,
    /// Folders over which no overlay could be made.
    pub read_only: Vec<PathBuf>,
    /// The machine's mounts are of this process's own namespace of users.
    is_privileged: bool,
}

impl PrivateView {
    /// Puts the new root together, with layers of at most `size` bytes. Folders of `own` are layers of their own, so that
    /// they can be written to whoever owns the folders above them; what is `hidden` is not there.
    pub(super) fn assemble(size: u64, own: &[PathBuf], hidden: &[PathBuf]) -> Result<Self, ViewError> {
        let at = |what: &str| {
            let what = what.to_owned();
            move |e: Errno| (what, io::Error::from(e))
        };
        mount_change("/", MountPropagationFlags::REC | MountPropagationFlags::PRIVATE).map_err(at("/"))?;
        let mounts = mounts().map_err(|e| ("/proc/self/mountinfo".to_owned(), e))?;
        let covered = open(SCRATCH, OFlags::PATH | OFlags::CLOEXEC, Mode::empty()).map_err(at(SCRATCH))?;
        let memory = |options: String, target: &Path| {
            let options = CString::new(options).unwrap_or_default();
            mount("hrdsl", target, "tmpfs", MountFlags::empty(), &*options)
                .map_err(at("a file system in memory"))
        };
        memory(format!("size={size},mode=700"), Path::new(SCRATCH))?;
        let layers = open(SCRATCH, OFlags::PATH | OFlags::CLOEXEC, Mode::empty()).map_err(at(SCRATCH))?;
        let mut view = Self {
            mounts,
            covered,
            layers,
            own: own.to_vec(),
            overlays: Vec::new(),
            read_only: Vec::new(),
            is_privileged: has_all_users(),
        };
        let root = root();
        fs::create_dir(&root).map_err(|e| (SCRATCH.to_owned(), e))?;
        // Files of folders that are made anew are copied into it.
        memory(format!("size={size},mode=755"), &root)?;
        view.folder(Path::new("/"))?;
        for folder in own {
            view.own_layer(folder)?;
        }
        // What is below a hidden folder is hidden with it.
        let mut hidden = hidden.to_vec();
        hidden.sort();
        hidden.dedup_by(|next, first| next.starts_with(first));
        for folder in &hidden {
            view.hide(folder).map_err(|e| (folder.display().to_string(), e))?;
        }
        Ok(view)
    }

    /// Makes the new root the root.
    pub(super) fn enter(&self) -> Result<(), ViewError> {
        let at = |what: &'static str| move |e: Errno| (what.to_owned(), io::Error::from(e));
        std::env::set_current_dir(root()).map_err(|e| ("the new root".to_owned(), e))?;
        pivot_root(".", ".").map_err(at("the new root"))?;
        unmount(".", UnmountFlags::DETACH).map_err(at("the old root"))?;
        std::env::set_current_dir("/").map_err(|e| ("the new root".to_owned(), e))
    }

    /// Each overlaid folder with what was written into it, as it is reached after [`enter`](Self::enter).
    pub(super) fn written(&self) -> Vec<(PathBuf, PathBuf)> {
        let layers = PathBuf::from(format!("/proc/self/fd/{}", self.layers.as_raw_fd()));
        let layer = |upper: &Path| layers.join(upper.strip_prefix(SCRATCH).unwrap_or(upper));
        self.overlays.iter().map(|(folder, upper)| (folder.clone(), layer(upper))).collect()
    }

    /// A folder of the machine and all below it.
    fn folder(&mut self, path: &Path) -> Result<(), ViewError> {
        let here = self.mounts.iter().rev().find(|mount| mount.at == path).map(|mount| mount.kind.clone());
        match here.as_deref() {
            Some("proc") => return self.processes(path),
            Some(kind) if KERNEL.contains(&kind) => return self.window(path),
            Some(_) | None => {}
        }
        if !self.has_mounts_below(path) {
            return self.layer(path);
        }
        if self.is_privileged && self.layer_around(path)? { Ok(()) } else { self.entries(path) }
    }

    /// One overlay for a folder with mounts below, each of which is then mounted in it: far fewer mounts than one for each entry. The kernel
    /// allows that to who owns those mounts. False: it does not here.
    fn layer_around(&mut self, path: &Path) -> Result<bool, ViewError> {
        let fail = |e: io::Error| (path.display().to_string(), e);
        let (host, target) = (self.host(path), inside(path));
        if !target.exists() {
            make_like(&host, &target).map_err(fail)?;
        }
        if self.overlay(path, &host).is_err() {
            return Ok(false);
        }
        let mut below: Vec<PathBuf> = self
            .mounts
            .iter()
            .map(|mount| mount.at.clone())
            .filter(|at| at != path && at.starts_with(path))
            .collect();
        below.sort();
        // What is mounted below one of them comes with that.
        below.dedup_by(|next, first| next.starts_with(first));
        for at in below {
            let host = self.host(&at);
            match fs::symlink_metadata(&host) {
                Ok(is) if is.is_dir() => self.folder(&at)?,
                Ok(_) => {
                    let place = inside(&at);
                    bind_read_only(&host, &place).map_err(|e| (at.display().to_string(), e.into()))?;
                }
                // Covered by another mount, or removed meanwhile.
                Err(_) => {}
            }
        }
        Ok(true)
    }

    fn has_mounts_below(&self, path: &Path) -> bool {
        self.mounts.iter().any(|mount| mount.at != path && mount.at.starts_with(path))
    }

    /// A folder made anew, each of whose entries is mounted or linked.
    fn entries(&mut self, path: &Path) -> Result<(), ViewError> {
        let host = self.host(path);
        let fail = |e: io::Error| (path.display().to_string(), e);
        let target = inside(path);
        make_like(&host, &target).map_err(fail)?;
        // What may not be listed may not be read either.
        let Ok(entries) = fs::read_dir(&host) else { return Ok(()) };
        for entry in entries.filter_map(Result::ok) {
            let name = entry.file_name();
            let (source, place) = (host.join(&name), target.join(&name));
            let Ok(kind) = entry.file_type() else { continue };
            if kind.is_symlink() {
                let Ok(to) = fs::read_link(&source) else { continue };
                symlink(to, &place).map_err(fail)?;
            } else if kind.is_dir() {
                match self.folder(&path.join(&name)) {
                    // Others make and remove folders meanwhile, above all temporary ones.
                    Err(_) if !source.exists() => {}
                    result => result?,
                }
            } else {
                self.file(&path.join(&name), kind.is_file())?;
            }
        }
        Ok(())
    }

    /// A file in a folder that was made anew: a copy in the program's own folders, elsewhere, or where there is no room for it, one that
    /// can be read. One that cannot be either (another user's) is there, and empty.
    fn file(&self, path: &Path, is_regular: bool) -> Result<(), ViewError> {
        let (host, target) = (self.host(path), inside(path));
        if is_regular && self.own.iter().any(|own| path.starts_with(own)) {
            if fs::copy(&host, &target).is_ok() {
                return Ok(());
            }
            // Half a file would be read as a whole one: what has no room can at least be read.
            let _ = fs::remove_file(&target);
        }
        fs::write(&target, "").map_err(|e| (path.display().to_string(), e))?;
        let _ = bind_read_only(&host, &target);
        Ok(())
    }

    /// A folder without mounts below: an overlay, or where that is not allowed, a bind that cannot be written to.
    fn layer(&mut self, path: &Path) -> Result<(), ViewError> {
        let fail = |e: io::Error| (path.display().to_string(), e);
        let (host, target) = (self.host(path), inside(path));
        // In an overlay it is there, and like the machine's already.
        if !target.exists() {
            make_like(&host, &target).map_err(fail)?;
        }
        match self.overlay(path, &host) {
            Ok(()) => Ok(()),
            Err(_) => {
                self.read_only.push(path.to_owned());
                bind_read_only(&host, &target).map_err(|e| fail(e.into()))
            }
        }
    }

    /// A folder that must be the cell's own; one with mounts below was made anew already.
    fn own_layer(&mut self, path: &Path) -> Result<(), ViewError> {
        if self.has_mounts_below(path)
            || self.overlays.iter().any(|(at, _)| at == path)
            || !self.host(path).is_dir()
        {
            return Ok(());
        }
        let host = self.host(path);
        self.overlay(path, &host).map_err(|e| (path.display().to_string(), e))
    }

    fn overlay(&mut self, path: &Path, host: &Path) -> io::Result<()> {
        let upper = Path::new(SCRATCH).join(format!("upper{}", self.overlays.len()));
        let work = Path::new(SCRATCH).join(format!("work{}", self.overlays.len()));
        // One that could not be mounted may have left its own there.
        make_like(host, &upper)?;
        if !work.exists() {
            fs::create_dir(&work)?;
        }
        // Named by its descriptor: a path would have to be escaped, and might be covered.
        let lower = open(host, OFlags::PATH | OFlags::CLOEXEC, Mode::empty())?;
        let options = format!(
            "lowerdir=/proc/self/fd/{},upperdir={},workdir={},userxattr",
            lower.as_raw_fd(),
            upper.display(),
            work.display()
        );
        mount("hrdsl", inside(path), "overlay", MountFlags::empty(), &*CString::new(options)?)?;
        self.overlays.push((path.to_owned(), upper));
        Ok(())
    }

    /// A window into the kernel, with all that is mounted below it; but shared memory is the cell's own.
    fn window(&mut self, path: &Path) -> Result<(), ViewError> {
        let fail = |e: io::Error| (path.display().to_string(), e);
        let target = inside(path);
        fs::create_dir_all(&target).map_err(fail)?;
        mount_bind_recursive(self.host(path), &target).map_err(|e| fail(e.into()))?;
        // In the cell of a fork server they are made so once, for all its forks.
        let settings = |mount: &&MountPoint| mount.at.starts_with(path) && !mount.is_read_only;
        for mount in self.mounts.iter().filter(settings).filter(|mount| mount.has_settings()) {
            // Refused only where all of it belongs to another user, whose files cannot be written to anyway.
            let _ = read_only(&inside(&mount.at));
        }
        let shared = target.join("shm");
        if path == Path::new("/dev") && shared.is_dir() {
            mount("hrdsl", &shared, "tmpfs", MountFlags::NOSUID | MountFlags::NODEV, c"size=1g,mode=1777")
                .map_err(|e| fail(e.into()))?;
        }
        Ok(())
    }

    /// The processes of this namespace, or, where parts of the machine's are covered, those of the machine.
    fn processes(&mut self, path: &Path) -> Result<(), ViewError> {
        let target = inside(path);
        fs::create_dir_all(&target).map_err(|e| (path.display().to_string(), e))?;
        let flags = MountFlags::NOSUID | MountFlags::NODEV | MountFlags::NOEXEC;
        match mount("hrdsl", &target, "proc", flags, None) {
            Ok(()) => {
                for settings in SETTINGS.map(|name| target.join(name)) {
                    let _ = bind_read_only(&settings, &settings);
                }
                Ok(())
            }
            Err(_) => self.window(path),
        }
    }

    /// Lets a folder vanish: overlays know a device of number 0 as what was removed.
    fn hide(&self, path: &Path) -> io::Result<()> {
        let Some((folder, upper)) =
            self.overlays.iter().rev().find(|(at, _)| path.starts_with(at) && at != path)
        else {
            return Ok(());
        };
        if !self.host(path).exists() {
            return Ok(());
        }
        let rest = path.strip_prefix(folder).unwrap_or(path);
        let place = upper.join(rest);
        let mut above = folder.clone();
        for part in rest.parent().into_iter().flat_map(Path::components) {
            above.push(part);
            let layer = upper.join(above.strip_prefix(folder).unwrap_or(&above));
            if !layer.exists() {
                make_like(&self.host(&above), &layer)?;
            }
        }
        Ok(mknodat(CWD, &place, FileType::CharacterDevice, Mode::empty(), 0)?)
    }

    /// The path by which a file of the machine is reached while the layers are mounted.
    fn host(&self, path: &Path) -> PathBuf {
        match path.strip_prefix(SCRATCH) {
            Ok(rest) => PathBuf::from(format!("/proc/self/fd/{}", self.covered.as_raw_fd())).join(rest),
            Err(_) => path.to_owned(),
        }
    }
}

/// Lets nothing on the machine be written to in this namespace, but for what goes to the kernel.
pub(super) fn make_read_only() -> Result<(), ViewError> {
    mount_change("/", MountPropagationFlags::REC | MountPropagationFlags::PRIVATE)
        .map_err(|e| ("/".to_owned(), e.into()))?;
    for mount in mounts().map_err(|e| ("/proc/self/mountinfo".to_owned(), e))? {
        if mount.kind == "proc" || !mount.has_settings() {
            continue;
        }
        match read_only(&mount.at) {
            // One that another covers, or of another user, which cannot be written to anyway.
            Ok(()) | Err(Errno::NOENT | Errno::ACCESS) => {}
            Err(_) if mount.is_of_kernel() => {}
            Err(e) => return Err((mount.at.display().to_string(), e.into())),
        }
    }
    Ok(())
}

/// Binds a file or folder so that it can only be read. A remount (below) must repeat what the kernel has locked of the mount that it
/// comes from, which is not told: so it is tried.
fn bind_read_only(source: &Path, target: &Path) -> Result<(), Errno> {
    mount_bind(source, target)?;
    let result = read_only(target);
    if result.is_err() {
        // Rather not there than written to.
        unmount(target, UnmountFlags::DETACH)?;
    }
    result
}

/// Makes a mount one that can only be read.
fn read_only(target: &Path) -> Result<(), Errno> {
    let locked = [MountFlags::NOSUID, MountFlags::NODEV, MountFlags::NOEXEC];
    let mut result = Ok(());
    for which in 0..1 << locked.len() {
        let some = locked.iter().enumerate().filter(|(k, _)| which >> k & 1 == 1).map(|(_, flag)| *flag);
        let flags = some.fold(MountFlags::BIND | MountFlags::RDONLY, |all, flag| all | flag);
        result = mount_remount(target, flags, c"");
        if result.is_ok() {
            break;
        }
    }
    result
}

fn root() -> PathBuf {
    Path::new(SCRATCH).join("root")
}

/// The place of a folder of the machine in the new root.
fn inside(path: &Path) -> PathBuf {
    root().join(path.strip_prefix("/").unwrap_or(path))
}

/// Makes a folder with the permissions and, where it is allowed, the owner of another.
fn make_like(model: &Path, folder: &Path) -> io::Result<()> {
    let is = fs::metadata(model)?;
    if !folder.exists() {
        DirBuilder::new().recursive(true).mode(0o755).create(folder)?;
    }
    let _ = chown(folder, Some(is.uid()), Some(is.gid()));
    // Whoever may not give files away becomes their owner; the machine's own permissions still hold below.
    fs::set_permissions(folder, Permissions::from_mode(is.mode() & 0o7777))
}

/// Whether this is the machine's own namespace of users, as user_namespaces(7) has it.
fn has_all_users() -> bool {
    let map = fs::read_to_string("/proc/self/uid_map").unwrap_or_default();
    map.split_whitespace().eq(["0", "0", "4294967295"])
}

/// The mount points of this namespace.
fn mounts() -> io::Result<Vec<MountPoint>> {
    let text = fs::read("/proc/self/mountinfo")?;
    Ok(text.split(|b| *b == b'\n').filter_map(mount_point).collect())
}

/// A line of `mountinfo`, as proc(5) has it: `… root mount-point options … - kind source …`.
fn mount_point(line: &[u8]) -> Option<MountPoint> {
    let mut fields = line.split(|b| *b == b' ');
    let path = unescaped(fields.nth(4)?);
    let is_read_only = fields.next()?.split(|b| *b == b',').any(|option| option == b"ro");
    let kind = fields.skip_while(|f| *f != b"-").nth(1)?;
    let at = PathBuf::from(std::ffi::OsString::from_vec(path));
    Some(MountPoint { at, kind: String::from_utf8_lossy(kind).into_owned(), is_read_only })
}

/// Blanks and the like are written as three octal digits after a backslash.
fn unescaped(text: &[u8]) -> Vec<u8> {
    let mut out = Vec::with_capacity(text.len());
    let mut at = 0;
    while let Some(&byte) = text.get(at) {
        let octal =
            text.get(at + 1..at + 4).filter(|d| byte == b'\\' && d.iter().all(|b| (b'0'..b'8').contains(b)));
        match octal {
            Some(digits) => {
                out.push(digits.iter().fold(0_u8, |n, d| n.wrapping_mul(8).wrapping_add(d - b'0')));
                at += 4;
            }
            None => {
                out.push(byte);
                at += 1;
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mount_points_are_read_with_blanks_in_them() {
        let line =
            br"36 35 98:0 /mnt1 /mnt\040two\134 rw,noatime master:1 - ext3 /dev/root rw,errors=continue";
        let (at, kind) = (PathBuf::from("/mnt two\\"), "ext3".to_owned());
        assert_eq!(mount_point(line), Some(MountPoint { at, kind, is_read_only: false }));
        assert_eq!(mount_point(b""), None);
    }

    #[test]
    fn a_mount_is_read_only_by_its_own_options_not_by_those_of_its_file_system() {
        let is_read_only = |line: &[u8]| mount_point(line).map(|mount| mount.is_read_only);
        assert_eq!(is_read_only(b"1 0 0:5 / /sys nosuid,ro shared:7 - sysfs sysfs rw"), Some(true));
        assert_eq!(
            is_read_only(b"1 0 0:5 / /sys rw,noatime - sysfs sysfs ro,errors=remount-ro"),
            Some(false)
        );
    }
}
