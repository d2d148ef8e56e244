//! The supervisor's own process: makes the cell, starts the program, waits, and ends everything.
//!
//! There are two of it: the one that the harness starts waits; its child does the rest. With namespaces, the first enters them
//! and the child is the first process in them. With copies, the first has the cell's folder, and cleans up if the program
//! kills its parent.

use std::{
    ffi::OsString,
    io::{self, Write},
    mem::MaybeUninit,
    os::{
        fd::{AsFd, AsRawFd, BorrowedFd, OwnedFd},
        unix::process::CommandExt,
    },
    path::{Path, PathBuf},
    process::{Child, Command, ExitCode, Stdio},
};

use nix::{
    sys::{
        signal::{SigSet, SigmaskHow, Signal, kill},
        signalfd::{SfdFlags, SignalFd},
        wait::{Id, WaitPidFlag, WaitStatus, waitid},
    },
    unistd::Pid,
};
use rustix::{
    event::{PollFd, PollFlags, poll},
    fs::{Mode, OFlags, open},
    io::Errno,
    net::{RecvAncillaryBuffer, RecvAncillaryMessage, RecvFlags, recvmsg},
    process::{
        DumpableBehavior, set_child_subreaper, set_dumpable_behavior, set_parent_process_death_signal,
    },
};

use super::{
    copies::{CellFolder, ProjectCopy},
    descendants,
    keep::keep,
    limits,
    message::{CELL_FOLDER, CellEnding, CellIsolation, CellOrder, CellReport, CellRequest, KeptFiles},
    namespaces, rights,
    view::PrivateView,
};
use crate::exit::ProgramExit;

/// The word with which the supervisor starts itself again, inside the cell.
const INSIDE: &str = "inside";

/// Runs a cell; what [`Supervisor`](super::Supervisor) starts must call this, with its remaining arguments, before anything
/// else. Standard input is the connection to the harness.
#[must_use]
pub fn supervise(args: &[OsString]) -> ExitCode {
    let Some(control) = std::io::stdin().as_fd().try_clone_to_owned().ok() else { return ExitCode::FAILURE };
    let mut control = ControlSocket { socket: control, inbox: Vec::new() };
    let words: Vec<&str> = args.iter().filter_map(|a| a.to_str()).collect();
    // A debugger on the terminal is interrupted there; whoever supervises it goes on.
    let interrupts = SigSet::from(Signal::SIGINT);
    let _ = interrupts.thread_block();
    let result = match words[..] {
        ["namespaces", "network"] => enter_and_wait(true, args),
        ["namespaces", _] => enter_and_wait(false, args),
        ["copies", _] => adopt_and_wait(args),
        ["copies", _, INSIDE] => run(&mut control, false),
        ["namespaces", _, INSIDE] => run(&mut control, true),
        _ => Err(SetupRefusal::of("the supervisor", io::ErrorKind::InvalidInput.into())),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(refusal) => {
            let SetupRefusal { absent, what, why } = refusal;
            control.report(&CellReport::Refused { absent, what, why });
            ExitCode::FAILURE
        }
    }
}

struct SetupRefusal {
    absent: bool,
    what: String,
    why: String,
}

impl SetupRefusal {
    fn of(what: impl Into<String>, why: io::Error) -> Self {
        Self { absent: false, what: what.into(), why: why.to_string() }
    }
}

fn enter_and_wait(network: bool, args: &[OsString]) -> Result<(), SetupRefusal> {
    namespaces::enter(network).map_err(|(what, why)| SetupRefusal::of(what, why))?;
    // It reports; nothing is left to say here.
    let _ =
        again(args).spawn().map_err(|e| SetupRefusal::of("the first process of the namespaces", e))?.wait();
    Ok(())
}

/// Has the folder of a cell without namespaces, in which the other supervisor works. What is left of the program when that one
/// has ended, however it has, comes to this process and ends.
fn adopt_and_wait(args: &[OsString]) -> Result<(), SetupRefusal> {
    adopt()?;
    let folder = CellFolder::make().map_err(|e| SetupRefusal::of("a folder for copies", e))?;
    let other = again(args).env("TMPDIR", folder.path()).spawn();
    let other =
        Pid::from_raw(other.map_err(|e| SetupRefusal::of("the other supervisor", e))?.id().cast_signed());
    loop {
        match waitid(Id::Pid(other), WaitPidFlag::WEXITED | WaitPidFlag::WSTOPPED) {
            // The program must not keep its supervisor from watching it.
            Ok(WaitStatus::Stopped(..)) => drop(kill(other, Signal::SIGCONT)),
            Err(nix::errno::Errno::EINTR) => {}
            Ok(_) | Err(_) => break,
        }
    }
    descendants::end_all(false);
    Ok(())
}

/// Makes this process the parent of all below it that lose theirs.
fn adopt() -> Result<(), SetupRefusal> {
    set_child_subreaper(Some(rustix::process::getpid()))
        .map_err(|e| SetupRefusal::of("adoption of processes", e.into()))
}

/// The command that starts this program once more, inside the cell.
fn again(args: &[OsString]) -> Command {
    let own = std::env::current_exe();
    // The link of the process, since the file may have been replaced by a newer one meanwhile.
    let link = PathBuf::from("/proc/self/exe");
    let own = if link.exists() { link } else { own.unwrap_or(link) };
    let before: Vec<OsString> = std::env::args_os().skip(1).collect();
    debug_assert!(before.ends_with(args));
    let mut command = Command::new(own);
    command.args(before).arg(INSIDE);
    command
}

/// The supervisor's end of the connection.
struct ControlSocket {
    socket: OwnedFd,
    inbox: Vec<u8>,
}

impl ControlSocket {
    /// The harness may be gone; then the next look at the socket says so.
    fn report(&mut self, report: &CellReport) {
        if let Ok(mut line) = serde_json::to_vec(report) {
            line.push(b'\n');
            let _ = std::fs::File::from(match self.socket.try_clone() {
                Ok(socket) => socket,
                Err(_) => return,
            })
            .write_all(&line);
        }
    }

    /// The order, and the program's descriptors; `None` if the harness is gone.
    fn order(&mut self) -> io::Result<Option<(CellOrder, Vec<OwnedFd>)>> {
        let mut descriptors = Vec::new();
        loop {
            if let Some(line) = self.take_line() {
                return Ok(Some((serde_json::from_slice(&line)?, descriptors)));
            }
            let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(8))];
            let mut ancillary = RecvAncillaryBuffer::new(&mut space);
            let mut chunk = [0; 4096];
            let mut parts = [io::IoSliceMut::new(&mut chunk)];
            // Inherited by the program, since they are not closed at its start.
            let got = recvmsg(&self.socket, &mut parts, &mut ancillary, RecvFlags::empty())?;
            for message in ancillary.drain() {
                if let RecvAncillaryMessage::ScmRights(rights) = message {
                    descriptors.extend(rights);
                }
            }
            if got.bytes == 0 {
                return Ok(None);
            }
            self.inbox.extend_from_slice(&chunk[..got.bytes]);
        }
    }

    fn take_line(&mut self) -> Option<Vec<u8>> {
        let end = self.inbox.iter().position(|b| *b == b'\n')?;
        let mut line: Vec<u8> = self.inbox.drain(..=end).collect();
        line.pop();
        Some(line)
    }

    /// Reads what there is; whether the harness is still there.
    fn read(&mut self) -> bool {
        let mut chunk = [0; 256];
        match rustix::io::read(&self.socket, &mut chunk) {
            Ok(0) => false,
            Ok(n) => {
                self.inbox.extend_from_slice(&chunk[..n]);
                true
            }
            Err(Errno::INTR | Errno::AGAIN) => true,
            Err(_) => false,
        }
    }
}

/// Where the program runs, and what is left of it.
enum CellPlace {
    Namespaces(PrivateView),
    Copy(ProjectCopy),
}

/// Makes the cell, runs the program in it, and ends it.
fn run(control: &mut ControlSocket, alone: bool) -> Result<(), SetupRefusal> {
    if alone {
        // The outer supervisor is its only parent, and has one thread.
        set_parent_process_death_signal(Some(rustix::process::Signal::KILL))
            .map_err(|e| SetupRefusal::of("its end", e.into()))?;
    } else {
        adopt()?;
    }
    let Some((order, descriptors)) = control.order().map_err(|e| SetupRefusal::of("the order", e))? else {
        return Ok(());
    };
    if !order.terminal {
        // No terminal: what the program opens or is sent there is not for it.
        let _ = rustix::process::setsid();
    }
    let chlds = SigSet::from(Signal::SIGCHLD);
    chlds.thread_block().map_err(|e| SetupRefusal::of("signals", e.into()))?;
    let ended = SignalFd::with_flags(&chlds, SfdFlags::SFD_CLOEXEC | SfdFlags::SFD_NONBLOCK)
        .map_err(|e| SetupRefusal::of("signals", e.into()))?;
    let keep_to =
        order.keep.as_ref().map(|to| open(Path::new(to), OFlags::PATH | OFlags::CLOEXEC, Mode::empty()));
    let keep_to = keep_to.transpose().map_err(|e| SetupRefusal::of("the folder for files", e.into()))?;
    let place = make(&order)?;
    let fixed_addresses = limits::fix_addresses();
    limits::limit_resources(order.memory);
    // What this process has open (folders of the machine among them) is not for the program to find in /proc.
    set_dumpable_behavior(DumpableBehavior::NotDumpable)
        .map_err(|e| SetupRefusal::of("a supervisor of its own", e.into()))?;
    rights::give_up().map_err(|e| SetupRefusal::of("the program's rights", e.into()))?;
    let child = if order.command.is_empty() { None } else { Some(start(&order, &place, &descriptors)?) };
    drop(descriptors);
    control.report(&started(fixed_addresses, &place, &order));
    let Some(child) = child else { return Ok(()) };
    let mut watch = ProgramWatch { control, ended, others: false, main: None };
    let there = watch.wait(&child);
    let usage = descendants::usage();
    watch.others |= descendants::end_all(alone);
    if there {
        let kept = keep_to.as_ref().map(|to| keep_files(&place, &order, to));
        let ending = CellEnding {
            exit: watch.main.unwrap_or(ProgramExit::Killed),
            others: watch.others,
            cpu: usage.cpu.max(descendants::usage().cpu),
            kept,
        };
        control.report(&CellReport::Ended(ending));
    }
    Ok(())
}

fn make(order: &CellOrder) -> Result<CellPlace, SetupRefusal> {
    let dir = PathBuf::from(&order.dir);
    let hidden: Vec<PathBuf> = order.hidden.iter().map(PathBuf::from).collect();
    match order.isolation {
        CellIsolation::Namespaces => {
            if !order.network {
                namespaces::bring_up_loopback().map_err(|e| SetupRefusal::of("the loopback interface", e))?;
            }
            let own = [dir, "/tmp".into(), "/var/tmp".into()];
            let refusal = |(what, why)| SetupRefusal::of(format!("a private view of {what}"), why);
            let view = PrivateView::assemble(order.memory, &own, &hidden).map_err(refusal)?;
            view.enter().map_err(refusal)?;
            for folder in ["home", "tmp"] {
                let folder = Path::new(CELL_FOLDER).join(folder);
                std::fs::create_dir_all(folder).map_err(|e| SetupRefusal::of(CELL_FOLDER, e))?;
            }
            Ok(CellPlace::Namespaces(view))
        }
        CellIsolation::Copies => {
            let copy = ProjectCopy::make(std::env::temp_dir(), &dir, &hidden)
                .map_err(|e| SetupRefusal::of(format!("a copy of {}", dir.display()), e))?;
            Ok(CellPlace::Copy(copy))
        }
    }
}

fn started(fixed_addresses: bool, place: &CellPlace, order: &CellOrder) -> CellReport {
    let (moved, read_only) = match place {
        CellPlace::Namespaces(view) => {
            (Vec::new(), view.read_only.iter().map(|p| p.clone().into_os_string()).collect())
        }
        CellPlace::Copy(copy) => {
            let own = Path::new(CELL_FOLDER);
            let moved = [
                (copy.project(), PathBuf::from(&order.dir)),
                (copy.home(), own.join("home")),
                (copy.temporary(), own.join("tmp")),
            ];
            (moved.map(|(from, to)| (from.into_os_string(), to.into_os_string())).into(), Vec::new())
        }
    };
    CellReport::Started { fixed_addresses, moved, read_only }
}

fn start(order: &CellOrder, place: &CellPlace, descriptors: &[OwnedFd]) -> Result<Child, SetupRefusal> {
    let (dir, home, temporary) = match place {
        CellPlace::Namespaces(_) => {
            let own = Path::new(CELL_FOLDER);
            (PathBuf::from(&order.dir), own.join("home"), own.join("tmp"))
        }
        CellPlace::Copy(copy) => (copy.project(), copy.home(), copy.temporary()),
    };
    let word = |w: &OsString| match place {
        CellPlace::Namespaces(_) => w.clone(),
        CellPlace::Copy(copy) => copy.moved(Path::new(w)).into_os_string(),
    };
    let words: Vec<OsString> = order.command.iter().map(word).collect();
    let mut command = Command::new(&words[0]);
    command.args(&words[1..]).current_dir(dir).env_clear();
    command.envs(order.env.iter().map(|(name, value)| (name, value)));
    command.env("HOME", home).env("TMPDIR", temporary);
    for (name, descriptor) in order.descriptors.iter().zip(descriptors) {
        command.env(name, descriptor.as_raw_fd().to_string());
    }
    command.stdin(Stdio::null());
    if !order.terminal {
        command.process_group(0);
    }
    // A program inherits what is blocked, and expects nothing to be.
    let blocked = SigSet::empty().thread_swap_mask(SigmaskHow::SIG_SETMASK);
    let child = command.spawn();
    if let Ok(blocked) = blocked {
        let _ = blocked.thread_set_mask();
    }
    child.map_err(|e| SetupRefusal {
        absent: e.kind() == io::ErrorKind::NotFound,
        what: words[0].to_string_lossy().into_owned(),
        why: e.to_string(),
    })
}

/// Waits for the program's end and for what the harness asks.
struct ProgramWatch<'c> {
    control: &'c mut ControlSocket,
    ended: SignalFd,
    /// Whether there was ever another process.
    others: bool,
    /// How the program ended.
    main: Option<ProgramExit>,
}

impl ProgramWatch<'_> {
    /// Returns when the program has ended or is to end; whether the harness is still there.
    fn wait(&mut self, child: &Child) -> bool {
        loop {
            self.reap(child);
            if self.main.is_some() {
                return true;
            }
            let control: BorrowedFd<'_> = self.control.socket.as_fd();
            let mut fds = [PollFd::new(&control, PollFlags::IN), PollFd::new(&self.ended, PollFlags::IN)];
            match poll(&mut fds, None) {
                Ok(_) | Err(Errno::INTR) => {}
                Err(_) => return false,
            }
            let (asked, ended) = (!fds[0].revents().is_empty(), !fds[1].revents().is_empty());
            if ended {
                while let Ok(Some(_)) = self.ended.read_signal() {}
            }
            if asked && !self.control.read() {
                return false;
            }
            while let Some(line) = self.control.take_line() {
                match serde_json::from_slice(&line) {
                    Ok(CellRequest::Usage) => self.control.report(&CellReport::Usage(descendants::usage())),
                    Ok(CellRequest::Terminate) => descendants::signal_all(Signal::SIGTERM),
                    Ok(CellRequest::Kill) => return true,
                    Err(_) => return false,
                }
            }
        }
    }

    /// Waits for whoever has ended: the program, or what it left behind.
    fn reap(&mut self, child: &Child) {
        let look = WaitPidFlag::WEXITED | WaitPidFlag::WNOHANG | WaitPidFlag::WNOWAIT;
        while let Ok(status) = waitid(Id::All, look) {
            let (pid, exit) = if let WaitStatus::Exited(pid, code) = status {
                (pid, ProgramExit::Code(code))
            } else if let WaitStatus::Signaled(pid, signal, _) = status {
                (pid, ProgramExit::Signal(signal as i32))
            } else {
                return;
            };
            if pid.as_raw().unsigned_abs() == child.id() {
                // While it is not yet waited for, the kernel still tells.
                self.others |= descendants::had_children(pid.as_raw());
                self.main = Some(exit);
            } else {
                self.others = true;
            }
            let _ = waitid(Id::Pid(pid), WaitPidFlag::WEXITED | WaitPidFlag::WNOHANG);
            if self.main.is_some() {
                return;
            }
        }
    }
}

/// Copies out what the program wrote. `to` was opened before the root changed: the harness's folder is not the one of the
/// same path in here.
fn keep_files(place: &CellPlace, order: &CellOrder, to: &OwnedFd) -> KeptFiles {
    let dir = Path::new(&order.dir);
    let to = PathBuf::from(format!("/proc/self/fd/{}", to.as_raw_fd()));
    let own = Path::new(CELL_FOLDER);
    match place {
        CellPlace::Namespaces(view) => keep(&view.written(), dir, &to, order.memory, &|_| true),
        CellPlace::Copy(copy) => {
            let folders = [
                (dir.to_owned(), copy.project()),
                (own.join("home"), copy.home()),
                (own.join("tmp"), copy.temporary()),
            ];
            keep(&folders, dir, &to, order.memory, &|path| !copy.is_unchanged(path))
        }
    }
}
