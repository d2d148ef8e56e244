//! A fork server: an interpreter that has imported what a program will, and is forked for each of its runs
//! (`sdk/python/hrdsl/forkserver.py`).
//!
//! Each fork comes from the same state, whatever ran before: the server itself never learns of a test. So a run in the first fork
//! of a new server and one in the thousandth of an old one are the same to the byte.

use std::{
    io::{self, IoSlice, Read as _},
    mem::MaybeUninit,
    os::fd::{AsFd as _, BorrowedFd, OwnedFd},
    time::{Duration, Instant},
};

use rustix::{
    event::{PollFd, PollFlags, Timespec, poll},
    io::Errno,
    net::{
        AddressFamily, RecvFlags, SendAncillaryBuffer, SendAncillaryMessage, SendFlags, SocketFlags,
        SocketType, recv, sendmsg, socketpair,
    },
    pipe::{PipeFlags, pipe_with},
};
use serde::Deserialize;

use crate::{
    cell::handle::{CellHandle, CellRefusal, control_sockets},
    error::SutError,
    launch::LaunchSpec,
};

/// How long a server may take until it is ready; it only guards.
const PATIENCE: Duration = Duration::from_secs(120);

/// The longest packet that a server sends.
const LONGEST: usize = 1 << 16;

/// How much of a server's last words is told.
const LAST_WORDS: usize = 2000;

/// A fork server that runs, for the launches of one program, which differ in their seeds, in where they keep files and in what of the
/// program is a mutant.
#[derive(Debug)]
pub struct ForkServer {
    /// In which the server runs.
    cell: CellHandle,
    /// The harness's end of the socket that it takes its orders from.
    orders: OwnedFd,
    /// What it has imported.
    modules: Vec<String>,
}

/// What a server says when it is ready.
#[derive(Deserialize)]
struct ServerReady {
    modules: Vec<String>,
}

impl ForkServer {
    /// Finds the modules that servers for such launches can import beforehand: what the program's files import, is none of the
    /// project's own, and leaves nothing behind but modules.
    ///
    /// # Errors
    /// [`SutError::Io`], with what the server said, if there can be none for this program, or on this machine.
    pub fn find_modules(launch: &LaunchSpec) -> Result<Vec<String>, SutError> {
        Ok(Self::begin(launch, None)?.modules)
    }

    /// Starts a server that imports these modules.
    ///
    /// # Errors
    /// [`SutError::Io`], with what the server said, if it did not become ready.
    pub fn start(launch: &LaunchSpec, modules: &[String]) -> Result<Self, SutError> {
        Self::begin(launch, Some(modules))
    }

    fn begin(launch: &LaunchSpec, modules: Option<&[String]>) -> Result<Self, SutError> {
        let order = launch.server_order(modules)?;
        let (orders, its_orders) =
            socketpair(AddressFamily::UNIX, SocketType::SEQPACKET, SocketFlags::CLOEXEC, None)
                .map_err(|e| SutError::io("cannot make a socket")(e.into()))?;
        let mut cell = CellHandle::start_server(&launch.cells.supervisor, &order, &[its_orders.as_fd()])?;
        drop(its_orders);
        match ready(&orders) {
            Ok(ServerReady { modules }) => Ok(Self { cell, orders, modules }),
            Err(why) => {
                let said = last_words(&mut cell);
                let why = if said.is_empty() { why } else { io::Error::other(said) };
                Err(SutError::io("cannot start a fork server")(why))
            }
        }
    }

    /// A cell with a fork. The descriptors are those for requests, replies and coverage.
    ///
    /// A server that has ended (somebody has killed it) is started again, once: the fork is the same.
    pub(crate) fn cell(
        &mut self,
        launch: &LaunchSpec,
        descriptors: &[BorrowedFd<'_>],
    ) -> Result<CellHandle, SutError> {
        match self.try_cell(launch, descriptors)? {
            Ok(cell) => Ok(cell),
            Err(_) if self.has_ended() => {
                *self = Self::start(launch, &self.modules)?;
                Ok(self.try_cell(launch, descriptors)??)
            }
            Err(refusal) => Err(refusal.into()),
        }
    }

    fn try_cell(
        &self,
        launch: &LaunchSpec,
        descriptors: &[BorrowedFd<'_>],
    ) -> Result<Result<CellHandle, CellRefusal>, SutError> {
        let io = |e: Errno| SutError::io("cannot make pipes")(e.into());
        let order = launch.forked_order()?;
        let kept = launch.kept_folder()?;
        let (control, its_control) = control_sockets()?;
        let (stdout, its_stdout) = pipe_with(PipeFlags::CLOEXEC).map_err(io)?;
        let (stderr, its_stderr) = pipe_with(PipeFlags::CLOEXEC).map_err(io)?;
        let mut given = vec![its_control.as_fd(), its_stdout.as_fd(), its_stderr.as_fd()];
        given.extend(descriptors);
        if let Err(e) = self.send(launch, &given) {
            let (what, why) = ("a fork server".to_owned(), e.to_string());
            return Ok(Err(CellRefusal { absent: false, what, why }));
        }
        drop((its_control, its_stdout, its_stderr));
        let kept: Vec<_> = kept.iter().map(OwnedFd::as_fd).collect();
        Ok(CellHandle::of_fork(control, (stdout, stderr), &order, &kept))
    }

    fn send(&self, launch: &LaunchSpec, descriptors: &[BorrowedFd<'_>]) -> Result<(), Errno> {
        let mut order = serde_json::json!({ "seed": launch.seed });
        if let (Some(mutant), Some(order)) = (&launch.mutant, order.as_object_mut()) {
            order.insert("mutant".to_owned(), mutant.words().into());
        }
        let text = order.to_string();
        let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(8))];
        let mut rights = SendAncillaryBuffer::new(&mut space);
        rights.push(SendAncillaryMessage::ScmRights(descriptors));
        sendmsg(&self.orders, &[IoSlice::new(text.as_bytes())], &mut rights, SendFlags::NOSIGNAL).map(drop)
    }

    fn has_ended(&mut self) -> bool {
        // Its supervisor may be about to notice.
        self.cell.await_end(Duration::from_secs(1)).is_some() || self.cell.is_lost()
    }
}

/// Waits until the server is ready.
fn ready(orders: &OwnedFd) -> io::Result<ServerReady> {
    let until = Instant::now() + PATIENCE;
    loop {
        let left = until.saturating_duration_since(Instant::now());
        let left = Timespec {
            tv_sec: left.as_secs().try_into().unwrap_or(i64::MAX),
            tv_nsec: left.subsec_nanos().into(),
        };
        match poll(&mut [PollFd::new(orders, PollFlags::IN)], Some(&left)) {
            Ok(0) => {
                return Err(io::Error::other(format!("it was not ready within {} s", PATIENCE.as_secs())));
            }
            Ok(_) => break,
            Err(Errno::INTR) => {}
            Err(e) => return Err(e.into()),
        }
    }
    let mut packet = vec![0; LONGEST];
    let (length, _) = recv(orders, &mut *packet, RecvFlags::empty())?;
    let said = packet.get(..length).unwrap_or_default();
    if said.is_empty() {
        return Err(io::Error::other("it ended before it was ready"));
    }
    Ok(serde_json::from_slice(said)?)
}

/// What the server wrote on standard error before it ended.
fn last_words(cell: &mut CellHandle) -> String {
    let _ = cell.await_end(Duration::from_secs(1));
    let Some(stderr) = cell.stderr.take().filter(|_| cell.ending().is_some()) else { return String::new() };
    let mut said = Vec::new();
    // Its supervisor holds the other end open, and writes nothing.
    let _ = rustix::fs::fcntl_setfl(&stderr, rustix::fs::OFlags::NONBLOCK);
    let _ = std::fs::File::from(stderr).read_to_end(&mut said);
    let from = said.len().saturating_sub(LAST_WORDS);
    String::from_utf8_lossy(said.get(from..).unwrap_or_default()).trim().to_owned()
}
