//! The harness's end of a cell: starts the supervisor, asks it, and reads what it says.

use std::{
    ffi::OsString,
    io::{self, IoSlice},
    mem::MaybeUninit,
    os::fd::{AsFd, BorrowedFd, OwnedFd},
    path::PathBuf,
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

use rustix::{
    event::{PollFd, PollFlags, Timespec, poll},
    io::Errno,
    net::{
        AddressFamily, SendAncillaryBuffer, SendAncillaryMessage, SendFlags, SocketFlags, SocketType,
        sendmsg, socketpair,
    },
};

use super::message::{CellEnding, CellIsolation, CellOrder, CellReport, CellRequest, CellUsage, SERVER};
use crate::error::SutError;

/// How long the supervisor may take to make a cell, and to end it: it only guards.
const PATIENCE: Duration = Duration::from_secs(60);

/// The program that supervises cells: it calls [`supervise`](super::supervise) with what follows these words.
#[derive(Clone, Debug)]
pub struct SupervisorCommand {
    program: PathBuf,
    words: Vec<OsString>,
}

impl SupervisorCommand {
    /// A program of its own.
    #[must_use]
    pub fn program(program: impl Into<PathBuf>) -> Self {
        Self { program: program.into(), words: Vec::new() }
    }

    /// The running program, told by its first argument.
    #[must_use]
    pub fn this_program(word: &str) -> Self {
        // The link of the process leads to the file that runs, even if another has taken its place.
        Self { program: "/proc/self/exe".into(), words: vec![word.into()] }
    }
}

/// A cell with a running program. When it is dropped, everything in it is killed.
#[derive(Debug)]
pub struct CellHandle {
    /// `None` if a fork server has made the cell.
    supervisor: Option<Child>,
    /// Does not block. `None` once the supervisor is gone.
    control: Option<OwnedFd>,
    inbox: Vec<u8>,
    pub(crate) stdout: Option<OwnedFd>,
    pub(crate) stderr: Option<OwnedFd>,
    /// Whether addresses are the same in every run.
    pub(crate) fixed_addresses: bool,
    /// What its paths begin with, and what they stand for.
    pub(crate) moved: Vec<(OsString, OsString)>,
    /// Folders that it can only read, though it should be able to write to them.
    pub(crate) read_only: Vec<OsString>,
    usage: Option<CellUsage>,
    ending: Option<CellEnding>,
}

/// Why there is no cell.
#[derive(Debug)]
pub(crate) struct CellRefusal {
    /// Whether it is the program that does not exist.
    pub absent: bool,
    pub what: String,
    pub why: String,
}

impl From<CellRefusal> for SutError {
    fn from(refusal: CellRefusal) -> Self {
        let CellRefusal { absent, what, why } = refusal;
        if absent {
            return SutError::Absent { what: "program", looked_for: what };
        }
        SutError::Io {
            what: format!("cannot start the program in a cell: {what}"),
            source: io::Error::other(why),
        }
    }
}

impl CellHandle {
    /// Starts a cell and the program in it, which inherits the descriptors.
    pub(crate) fn start(
        supervisor: &SupervisorCommand,
        order: &CellOrder,
        descriptors: &[BorrowedFd<'_>],
    ) -> Result<Self, CellRefusal> {
        let kind = match order.isolation {
            CellIsolation::Namespaces => "namespaces",
            CellIsolation::Copies => "copies",
        };
        Self::start_as(kind, supervisor, order, descriptors)
    }

    /// Starts a fork server in a cell of its own.
    pub(crate) fn start_server(
        supervisor: &SupervisorCommand,
        order: &CellOrder,
        descriptors: &[BorrowedFd<'_>],
    ) -> Result<Self, CellRefusal> {
        Self::start_as(SERVER, supervisor, order, descriptors)
    }

    fn start_as(
        kind: &str,
        supervisor: &SupervisorCommand,
        order: &CellOrder,
        descriptors: &[BorrowedFd<'_>],
    ) -> Result<Self, CellRefusal> {
        let refusal = |what: &str, why: String| CellRefusal { absent: false, what: what.to_owned(), why };
        let (ours, theirs) = control_sockets()?;
        let mut command = Command::new(&supervisor.program);
        command.args(&supervisor.words);
        command.arg(kind);
        command.arg(if order.network { "network" } else { "loopback" });
        command.stdin(Stdio::from(theirs)).stdout(Stdio::piped()).stderr(Stdio::piped()).env_clear();
        // Where copies are made.
        command.envs(std::env::var_os("TMPDIR").map(|folder| ("TMPDIR", folder)));
        if !order.terminal {
            // An interrupt from the terminal is for the harness alone.
            std::os::unix::process::CommandExt::process_group(&mut command, 0);
        }
        let mut child = command
            .spawn()
            .map_err(|e| refusal("its supervisor", format!("{}: {e}", supervisor.program.display())))?;
        // The command holds the other end of the socket.
        drop(command);
        let (stdout, stderr) = (child.stdout.take().map(Into::into), child.stderr.take().map(Into::into));
        Self::of(Some(child), ours, stdout, stderr).begin(order, descriptors)
    }

    /// A cell that a fork server makes: with its end of the connection, to which the supervisor has the other, and what the program
    /// writes. The descriptors are not the program's, which has its own already.
    pub(crate) fn of_fork(
        control: OwnedFd,
        (stdout, stderr): (OwnedFd, OwnedFd),
        order: &CellOrder,
        descriptors: &[BorrowedFd<'_>],
    ) -> Result<Self, CellRefusal> {
        Self::of(None, control, Some(stdout), Some(stderr)).begin(order, descriptors)
    }

    fn of(
        supervisor: Option<Child>,
        control: OwnedFd,
        stdout: Option<OwnedFd>,
        stderr: Option<OwnedFd>,
    ) -> Self {
        Self {
            stdout,
            stderr,
            supervisor,
            control: Some(control),
            inbox: Vec::new(),
            fixed_addresses: false,
            moved: Vec::new(),
            read_only: Vec::new(),
            usage: None,
            ending: None,
        }
    }

    fn begin(mut self, order: &CellOrder, descriptors: &[BorrowedFd<'_>]) -> Result<Self, CellRefusal> {
        // That it cannot be sent is said by what is received, or by nothing being received.
        let _ = self.send_order(order, descriptors);
        self.await_start()
    }

    fn send_order(&mut self, order: &CellOrder, descriptors: &[BorrowedFd<'_>]) -> io::Result<()> {
        let Some(control) = &self.control else { return Ok(()) };
        let mut line = serde_json::to_vec(order)?;
        line.push(b'\n');
        let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(8))];
        let mut rights = SendAncillaryBuffer::new(&mut space);
        if !descriptors.is_empty() {
            rights.push(SendAncillaryMessage::ScmRights(descriptors));
        }
        let mut sent = sendmsg(control, &[IoSlice::new(&line)], &mut rights, SendFlags::NOSIGNAL)?;
        while sent < line.len() {
            let part = [IoSlice::new(&line[sent..])];
            sent += sendmsg(control, &part, &mut SendAncillaryBuffer::default(), SendFlags::NOSIGNAL)?;
        }
        Ok(())
    }

    fn await_start(mut self) -> Result<Self, CellRefusal> {
        let until = Instant::now() + PATIENCE;
        let gone =
            |why: &str| CellRefusal { absent: false, what: "its supervisor".to_owned(), why: why.to_owned() };
        loop {
            if let Some(line) = self.take_line() {
                match serde_json::from_slice(&line) {
                    Ok(CellReport::Started { fixed_addresses, moved, read_only }) => {
                        self.fixed_addresses = fixed_addresses;
                        self.moved = moved;
                        self.read_only = read_only;
                        return Ok(self);
                    }
                    Ok(CellReport::Refused { absent, what, why }) => {
                        return Err(CellRefusal { absent, what, why });
                    }
                    Ok(CellReport::Usage(_) | CellReport::Ended(_)) | Err(_) => {
                        return Err(gone("it said something else than whether the program runs"));
                    }
                }
            }
            match self.wait(until) {
                Ok(true) if self.read() => {}
                Ok(true) => return Err(gone("it ended before the program was started")),
                Ok(false) => return Err(gone("it did not start the program in time")),
                Err(e) => return Err(gone(&e.to_string())),
            }
        }
    }

    /// Waits until there is something to read; whether there is.
    fn wait(&self, until: Instant) -> io::Result<bool> {
        let Some(control) = &self.control else { return Ok(true) };
        let left = until.saturating_duration_since(Instant::now());
        let left = Timespec {
            tv_sec: left.as_secs().try_into().unwrap_or(i64::MAX),
            tv_nsec: left.subsec_nanos().into(),
        };
        match poll(&mut [PollFd::new(control, PollFlags::IN)], Some(&left)) {
            Ok(n) => Ok(n > 0),
            Err(Errno::INTR) => self.wait(until),
            Err(e) => Err(e.into()),
        }
    }

    /// What becomes readable when the supervisor says something.
    pub(crate) fn control(&self) -> Option<BorrowedFd<'_>> {
        self.control.as_ref().map(AsFd::as_fd)
    }

    /// Takes in what the supervisor has said; whether it is still there.
    pub(crate) fn read(&mut self) -> bool {
        let Some(control) = &self.control else { return false };
        let mut chunk = [0; 4096];
        match rustix::io::read(control, &mut chunk) {
            Ok(n) if n > 0 => self.inbox.extend_from_slice(&chunk[..n]),
            Err(Errno::INTR | Errno::AGAIN) => {}
            Ok(_) | Err(_) => {
                self.control = None;
                return false;
            }
        }
        true
    }

    /// Looks at what was said: afterwards [`usage`](Self::take_usage) and [`ending`](Self::ending) are what was said last.
    pub(crate) fn listen(&mut self) {
        self.read();
        while let Some(line) = self.take_line() {
            match serde_json::from_slice(&line) {
                Ok(CellReport::Usage(usage)) => self.usage = Some(usage),
                Ok(CellReport::Ended(ending)) => self.ending = Some(ending),
                Ok(CellReport::Started { .. } | CellReport::Refused { .. }) | Err(_) => {}
            }
        }
    }

    fn take_line(&mut self) -> Option<Vec<u8>> {
        let end = self.inbox.iter().position(|b| *b == b'\n')?;
        let mut line: Vec<u8> = self.inbox.drain(..=end).collect();
        line.pop();
        Some(line)
    }

    /// The answer to the last question about usage, once.
    pub(crate) fn take_usage(&mut self) -> Option<CellUsage> {
        self.usage.take()
    }

    /// How the program ended, and with it everything in the cell.
    pub(crate) fn ending(&self) -> Option<&CellEnding> {
        self.ending.as_ref()
    }

    /// Whether the supervisor is gone without having said how the program ended.
    pub(crate) fn is_lost(&self) -> bool {
        self.control.is_none() && self.ending.is_none()
    }

    pub(crate) fn ask(&mut self, request: CellRequest) {
        let Some(control) = &self.control else { return };
        if let Ok(mut line) = serde_json::to_vec(&request) {
            line.push(b'\n');
            // A supervisor that is gone is noticed when it is listened to.
            let _ = sendmsg(
                control,
                &[IoSlice::new(&line)],
                &mut SendAncillaryBuffer::default(),
                SendFlags::NOSIGNAL,
            );
        }
    }

    /// Waits for the end, at most for so long; how the program ended, if it has.
    pub(crate) fn await_end(&mut self, time: Duration) -> Option<&CellEnding> {
        let until = Instant::now() + time;
        while self.ending.is_none() && self.control.is_some() && self.wait(until).unwrap_or(false) {
            self.listen();
        }
        self.ending.as_ref()
    }
}

impl Drop for CellHandle {
    fn drop(&mut self) {
        self.ask(CellRequest::Kill);
        let _ = self.await_end(PATIENCE);
        self.control = None;
        // It has said its last, or will never say it.
        let Some(supervisor) = &mut self.supervisor else { return };
        if self.ending.is_none() {
            let _ = supervisor.kill();
        }
        let _ = supervisor.wait();
    }
}

/// The harness's end of a connection, and the supervisor's.
pub(crate) fn control_sockets() -> Result<(OwnedFd, OwnedFd), CellRefusal> {
    socketpair(AddressFamily::UNIX, SocketType::STREAM, SocketFlags::CLOEXEC, None).map_err(|e| CellRefusal {
        absent: false,
        what: "a socket".to_owned(),
        why: e.to_string(),
    })
}
