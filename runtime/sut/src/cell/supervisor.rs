//! The supervisor's own process: makes the cell, starts the program, waits, and ends everything.
//!
//! There are two of it: the one that the harness starts waits; its child does the rest. With namespaces, the first enters them
//! and the child is the first process in them. With copies, the first has the cell's folder, and cleans up if the program
//! kills its parent. In the cell of a fork's program there is only the second, which the fork server has forked.

use std::{
    ffi::OsString,
    io,
    os::{
        fd::{AsFd, AsRawFd, OwnedFd},
        unix::process::CommandExt,
    },
    path::{Path, PathBuf},
    process::{Child, Command, ExitCode, Stdio},
    time::Duration,
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
    fs::{Mode, OFlags, open},
    io::{FdFlags, fcntl_setfd},
    process::{
        DumpableBehavior, set_child_subreaper, set_dumpable_behavior, set_parent_process_death_signal,
    },
};

use super::{
    control::ControlSocket,
    copies::{CellFolder, ProjectCopy},
    descendants,
    keep::keep,
    limits,
    message::{CELL_FOLDER, CellEnding, CellOrder, CellReport, KeptFiles, SERVER},
    namespaces, rights,
    view::{PrivateView, make_read_only},
    watch::ProgramWatch,
};
use crate::{exit::ProgramExit, processor::ProcessorClocks};

/// The word with which the supervisor starts itself again, inside the cell.
const INSIDE: &str = "inside";
/// The word with which the first process of a cell, which a fork server has forked, becomes its supervisor; then come the number of
/// its child, the program, and of a descriptor on which that waits.
const FORKED: &str = "forked";

/// Runs a cell; what a [`SupervisorCommand`](super::SupervisorCommand) starts must call this, with its remaining arguments, before anything
/// else. Standard input is the connection to the harness.
#[must_use]
pub fn supervise(args: &[OsString]) -> ExitCode {
    let Some(control) = std::io::stdin().as_fd().try_clone_to_owned().ok() else { return ExitCode::FAILURE };
    let mut control = ControlSocket::new(control);
    let words: Vec<&str> = args.iter().filter_map(|a| a.to_str()).collect();
    // A debugger on the terminal is interrupted there; whoever supervises it goes on.
    let interrupts = SigSet::from(Signal::SIGINT);
    let _ = interrupts.thread_block();
    let result = match words[..] {
        ["namespaces", "network"] => enter_and_wait(true, args),
        ["namespaces", _] => enter_and_wait(false, args),
        [SERVER, "network"] => enter_and_wait(true, args),
        [SERVER, _] => enter_and_wait(false, args),
        ["copies", _] => adopt_and_wait(args),
        ["copies", _, INSIDE] => run(&mut control, &CellProgram::InCopy),
        ["namespaces", _, INSIDE] => run(&mut control, &CellProgram::InNamespaces),
        [SERVER, _, INSIDE] => run(&mut control, &CellProgram::Server),
        ["namespaces", _, FORKED, program, go] => forked(program, go)
            .ok_or_else(|| SetupRefusal::of("a forked program", io::ErrorKind::InvalidInput.into()))
            .and_then(|program| run(&mut control, &program)),
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

/// What runs in a cell, and how it comes there.
enum CellProgram {
    InNamespaces,
    InCopy,
    /// Forks programs, each into a cell of its own.
    Server,
    /// Has been forked by such a server, and waits for a byte on the descriptor.
    Forked {
        program: Pid,
        go: OwnedFd,
    },
}

impl CellProgram {
    fn is_server(&self) -> bool {
        match self {
            CellProgram::Server => true,
            CellProgram::InNamespaces | CellProgram::InCopy | CellProgram::Forked { .. } => false,
        }
    }

    /// Whether its supervisor is the first process of a namespace, in which there are no others.
    fn is_alone(&self) -> bool {
        match self {
            CellProgram::InCopy => false,
            CellProgram::InNamespaces | CellProgram::Server | CellProgram::Forked { .. } => true,
        }
    }
}

/// Takes over the program that waits in this cell already.
fn forked(program: &str, go: &str) -> Option<CellProgram> {
    let program = Pid::from_raw(program.parse().ok()?);
    let go: i32 = go.parse().ok()?;
    // Opened anew rather than believed: whoever starts this process could have written any number.
    let go = open(format!("/proc/self/fd/{go}"), OFlags::WRONLY | OFlags::CLOEXEC, Mode::empty()).ok()?;
    Some(CellProgram::Forked { program, go })
}

/// Where the program runs, and what is left of it.
enum CellPlace {
    /// The machine itself, to be read only.
    Machine,
    Namespaces(PrivateView),
    Copy(ProjectCopy),
}

/// Makes the cell, runs the program in it, and ends it.
fn run(control: &mut ControlSocket, program: &CellProgram) -> Result<(), SetupRefusal> {
    inherit(program)?;
    let Some((order, mut descriptors)) = control.order().map_err(|e| SetupRefusal::of("the order", e))?
    else {
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
    let keep_to = if order.keep { descriptors.pop() } else { None };
    if let Some(folder) = &keep_to {
        fcntl_setfd(folder, FdFlags::CLOEXEC)
            .map_err(|e| SetupRefusal::of("the folder for files", e.into()))?;
    }
    let place = make(program, &order)?;
    let fixed_addresses = limits::fix_addresses();
    limits::limit_resources(order.memory);
    // What this process has open (folders of the machine among them) is not for the program to find in /proc.
    set_dumpable_behavior(DumpableBehavior::NotDumpable)
        .map_err(|e| SetupRefusal::of("a supervisor of its own", e.into()))?;
    if !program.is_server() {
        rights::give_up().map_err(|e| SetupRefusal::of("the program's rights", e.into()))?;
    }
    let child = begin(program, &order, &place, &descriptors)?;
    drop(descriptors);
    control.report(&started(fixed_addresses, &place, &order));
    if let Some(child) = child {
        let mut watch = ProgramWatch::new(control, ended);
        let is_there = watch.wait(child);
        end(&mut watch, is_there, program, |to| keep_files(&place, &order, to), keep_to.as_ref());
    }
    Ok(())
}

/// Sees to it that nothing of the cell is left when this process, or the one above it, has ended.
fn inherit(program: &CellProgram) -> Result<(), SetupRefusal> {
    match program {
        // The outer supervisor is its only parent, and has one thread.
        CellProgram::InNamespaces | CellProgram::Server => {
            set_parent_process_death_signal(Some(rustix::process::Signal::KILL))
                .map_err(|e| SetupRefusal::of("its end", e.into()))
        }
        CellProgram::InCopy => adopt(),
        // Its parent has ended already; it ends with the namespace around its own.
        CellProgram::Forked { .. } => Ok(()),
    }
}

/// Ends what is left in the cell, and tells the harness, if that is there. What a server has forked goes on without it.
fn end(
    watch: &mut ProgramWatch<'_>,
    is_there: bool,
    program: &CellProgram,
    keep: impl Fn(&OwnedFd) -> KeptFiles,
    keep_to: Option<&OwnedFd>,
) {
    // Nobody is there where the program has ended by itself, as most do: then nothing has to be looked up in `/proc`.
    let are_there = descendants::are_there();
    let usage = || if are_there { descendants::usage().cpu } else { Duration::ZERO };
    let before = usage();
    if !program.is_server() {
        watch.others |= descendants::end_all(program.is_alone());
    }
    if is_there {
        let ending = CellEnding {
            exit: watch.main.unwrap_or(ProgramExit::Killed),
            others: watch.others,
            // What was waited for is known to the microsecond.
            cpu: before.max(usage()).max((ProcessorClocks::SYSTEM.children)()),
            kept: keep_to.map(keep),
        };
        watch.control.report(&CellReport::Ended(ending));
    }
    if program.is_server() {
        if is_there && watch.main.is_some() {
            watch.wait_for_harness();
        }
        descendants::end_all(true);
    }
}

/// Lets the program begin; none, if the order has none.
fn begin(
    program: &CellProgram,
    order: &CellOrder,
    place: &CellPlace,
    descriptors: &[OwnedFd],
) -> Result<Option<Pid>, SetupRefusal> {
    if let CellProgram::Forked { program, go } = program {
        rustix::io::write(go, b"+").map_err(|e| SetupRefusal::of("the forked program", e.into()))?;
        return Ok(Some(*program));
    }
    if order.command.is_empty() {
        return Ok(None);
    }
    let for_forks = match program {
        CellProgram::Server => Some(ForkedCells::make()?),
        CellProgram::InNamespaces | CellProgram::InCopy | CellProgram::Forked { .. } => None,
    };
    let child = start(order, place, descriptors, for_forks.as_ref())?;
    Ok(Some(Pid::from_raw(child.id().cast_signed())))
}

/// What a fork server must have to make cells.
struct ForkedCells {
    /// This program; inherited by the server.
    supervisor: OwnedFd,
}

impl ForkedCells {
    fn make() -> Result<Self, SetupRefusal> {
        let supervisor = open("/proc/self/exe", OFlags::PATH, Mode::empty())
            .map_err(|e| SetupRefusal::of("a fork server", e.into()))?;
        Ok(Self { supervisor })
    }

    /// What it is told.
    fn text(&self, network: bool) -> String {
        let own = std::env::args_os().take_while(|word| word != SERVER);
        let network_word = if network { "network" } else { "loopback" };
        let more = ["namespaces", network_word, FORKED].map(OsString::from);
        let words: Vec<String> = own.chain(more).map(|word| word.to_string_lossy().into_owned()).collect();
        serde_json::json!({
            "supervisor": self.supervisor.as_raw_fd(),
            "words": words,
            "namespaces": namespaces::flags(network).bits(),
            "beyond": rights::beyond_the_cell(),
        })
        .to_string()
    }
}

fn make(program: &CellProgram, order: &CellOrder) -> Result<CellPlace, SetupRefusal> {
    let dir = PathBuf::from(&order.dir);
    let hidden: Vec<PathBuf> = order.hidden.iter().map(PathBuf::from).collect();
    match program {
        CellProgram::Server => {
            // Its forks lay their views over the machine's folders, and an overlay over another may be one too many.
            make_read_only()
                .map_err(|(what, why)| SetupRefusal::of(format!("{what}, to be read only"), why))?;
            Ok(CellPlace::Machine)
        }
        CellProgram::InNamespaces | CellProgram::Forked { .. } => {
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
        CellProgram::InCopy => {
            let copy = ProjectCopy::make(std::env::temp_dir(), &dir, &hidden)
                .map_err(|e| SetupRefusal::of(format!("a copy of {}", dir.display()), e))?;
            Ok(CellPlace::Copy(copy))
        }
    }
}

fn started(fixed_addresses: bool, place: &CellPlace, order: &CellOrder) -> CellReport {
    let (moved, read_only) = match place {
        CellPlace::Machine => (Vec::new(), Vec::new()),
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

fn start(
    order: &CellOrder,
    place: &CellPlace,
    descriptors: &[OwnedFd],
    for_forks: Option<&ForkedCells>,
) -> Result<Child, SetupRefusal> {
    let (dir, home, temporary) = match place {
        CellPlace::Machine | CellPlace::Namespaces(_) => {
            let own = Path::new(CELL_FOLDER);
            (PathBuf::from(&order.dir), own.join("home"), own.join("tmp"))
        }
        CellPlace::Copy(copy) => (copy.project(), copy.home(), copy.temporary()),
    };
    let word = |w: &OsString| match place {
        CellPlace::Machine | CellPlace::Namespaces(_) => w.clone(),
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
    if let Some(cells) = for_forks {
        command.env("HRDSL_FORK_CELL", cells.text(order.network));
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

/// Copies out what the program wrote. `to` was opened before the root changed: the harness's folder is not the one of the
/// same path in here.
fn keep_files(place: &CellPlace, order: &CellOrder, to: &OwnedFd) -> KeptFiles {
    let dir = Path::new(&order.dir);
    let to = PathBuf::from(format!("/proc/self/fd/{}", to.as_raw_fd()));
    let own = Path::new(CELL_FOLDER);
    match place {
        CellPlace::Machine => KeptFiles::default(),
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
