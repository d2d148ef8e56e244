//! The process under test: spawned with pipes of its own, spoken to in lock-step, killed with all its children.
//!
//! One poll loop in the calling thread reads the requests, drains the output and notices the end; there are no threads.

use std::{
    fmt, io,
    os::fd::{AsFd, AsRawFd, OwnedFd},
    os::unix::process::{CommandExt, ExitStatusExt},
    process::{Child, ExitStatus, Stdio},
    sync::{Mutex, PoisonError},
    time::{Duration, Instant},
};

use hrdsl_ir::Nanos;
use rustix::{
    event::{PollFd, PollFlags, Timespec, poll},
    fs::{OFlags, fcntl_getfl, fcntl_setfl},
    io::{Errno, FdFlags, fcntl_setfd},
    pipe::{PipeFlags, pipe_with},
    process::{Pid, Signal, WaitId, WaitIdOptions, kill_process_group, waitid},
};
use tempfile::TempPath;

use crate::{
    Answer, FileCoverage, Launch, Output, Reply, Request, SutError, coverage,
    launch::absent,
    output::Capture,
    protocol::{self, Line},
};

/// A request longer than this is rubbish.
const LONGEST_LINE: usize = 1 << 20;

/// How long a program may take to write its coverage after it was asked to terminate.
const LAST_WORDS: Duration = Duration::from_millis(500);

/// Between looks at a child whose end cannot be polled for.
const LOOK: Duration = Duration::from_millis(10);

/// A program under test, running. Dropping it kills it and its whole process group.
///
/// A child of the program that makes itself a session of its own (a daemon) leaves the group, and is not killed.
#[derive(Debug)]
pub struct Process {
    child: Child,
    /// Readable when the child has ended; `None` where the system has no such thing.
    ended: Option<OwnedFd>,
    /// `None` once every writer has closed it.
    requests: Option<OwnedFd>,
    /// `None` once the program was told to finish.
    replies: Option<OwnedFd>,
    stdout: Stream,
    stderr: Stream,
    /// Bytes from the program that are not yet read as requests.
    inbox: Vec<u8>,
    /// How many bytes of the inbox are known to have no line end.
    scanned: usize,
    outbox: Vec<u8>,
    chunk: Box<[u8]>,
    budget: Duration,
    time: Nanos,
    status: Option<ExitStatus>,
    coverage: Option<(TempPath, Vec<String>)>,
}

#[derive(Debug)]
struct Stream {
    fd: Option<OwnedFd>,
    capture: Capture,
}

/// How a program ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    Code(i32),
    Signal(i32),
    /// It did not end by itself in time.
    Killed,
}

impl fmt::Display for Exit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Exit::Code(code) => write!(f, "exit code {code}"),
            Exit::Signal(signal) => write!(f, "signal {signal}"),
            Exit::Killed => write!(f, "killed"),
        }
    }
}

/// What is left of a program that has ended.
#[derive(Clone, Debug)]
pub struct Finished {
    pub exit: Exit,
    pub output: Output,
    /// `None` if it was not asked for, or the program was killed before it could be written.
    pub coverage: Option<Vec<FileCoverage>>,
}

/// What a turn of the poll loop waits for, besides output and the program's end.
#[derive(Clone, Copy, PartialEq, Eq)]
enum For {
    Request,
    RoomToReply,
    End,
}

/// What a turn of the poll loop found.
enum Found {
    Something,
    TimeUp,
    Ended,
}

impl Process {
    /// Starts the program.
    ///
    /// # Errors
    /// [`SutError::Absent`] if there is no such program, script or folder; [`SutError::Io`] if the system refuses.
    pub fn spawn(launch: &Launch) -> Result<Self, SutError> {
        let coverage = if launch.coverage.is_empty() { None } else { Some(coverage_file(launch)?) };
        let mut command = launch.command(coverage.as_ref().map(|(path, _)| &**path))?;
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).process_group(0);
        let pipes = SutError::io("cannot make pipes");
        let (mut child, requests, replies) = {
            // Between making the pipes inheritable and closing our copies, no other child may be started: it would
            // hold them open, and the end of this one would go unnoticed.
            static SPAWN: Mutex<()> = Mutex::new(());
            let _alone = SPAWN.lock().unwrap_or_else(PoisonError::into_inner);
            let (requests, its_requests, its_replies, replies) = pipes_for_child().map_err(pipes)?;
            command.env("HRDSL_REQUEST_FD", its_requests.as_raw_fd().to_string());
            command.env("HRDSL_REPLY_FD", its_replies.as_raw_fd().to_string());
            let child = command.spawn().map_err(|e| match e.kind() {
                io::ErrorKind::NotFound => {
                    absent("program", command.get_program().to_string_lossy().into_owned())
                }
                _ => SutError::io(format!("cannot start {}", command.get_program().to_string_lossy()))(e),
            })?;
            (child, requests, replies)
        };
        let stdout = Stream::new(child.stdout.take().map(Into::into), launch.output_limit);
        let stderr = Stream::new(child.stderr.take().map(Into::into), launch.output_limit);
        Ok(Self {
            ended: end_of(&child),
            child,
            requests: Some(requests),
            replies: Some(replies),
            stdout,
            stderr,
            inbox: Vec::new(),
            scanned: 0,
            outbox: Vec::new(),
            chunk: vec![0; 1 << 16].into_boxed_slice(),
            budget: launch.budget,
            time: 0,
            status: None,
            coverage,
        })
    }

    /// Waits for the next request, at most for the budget. Requests that make no sense whatever the scenario (unknown
    /// kind, wrong types, another protocol version) are refused here, and the wait goes on.
    ///
    /// # Errors
    /// [`SutError::Exited`], [`SutError::Hung`], [`SutError::Rubbish`]; [`SutError::Io`] if the system fails. After an
    /// error, [`finish`](Self::finish) is the only sensible call.
    #[allow(clippy::should_implement_trait)] // not an iterator: each request must be answered first
    pub fn next(&mut self) -> Result<Request, SutError> {
        let until = Instant::now() + self.budget;
        loop {
            if let Some(line) = self.take_line()? {
                match protocol::parse(&line) {
                    Line::Request(request) => return Ok(request),
                    Line::Rubbish(why) => return Err(self.rubbish(&line, why)),
                    Line::Refused(error) => {
                        let answer = Answer::Error { error, help: Some("see spec/protocol.md".to_owned()) };
                        self.reply(&Reply { time: self.time, answer })?;
                        continue;
                    }
                }
            }
            match self.turn(For::Request, until)? {
                Found::Something => {}
                Found::TimeUp => return Err(self.hung("make a request")),
                // What it wrote before it ended comes first.
                Found::Ended if self.inbox.contains(&b'\n') => {}
                Found::Ended => return Err(self.exited()),
            }
        }
    }

    /// Answers the request. That the program has ended meanwhile is for [`next`](Self::next) to say.
    ///
    /// # Errors
    /// [`SutError::Hung`] if the program does not read its replies; [`SutError::Io`] if the system fails.
    pub fn reply(&mut self, reply: &Reply) -> Result<(), SutError> {
        self.time = reply.time;
        self.outbox.clear();
        serde_json::to_writer(&mut self.outbox, reply)
            .map_err(|e| SutError::io("cannot write a reply")(io::Error::other(e)))?;
        self.outbox.push(b'\n');
        let mut sent = 0;
        let mut until = None;
        while sent < self.outbox.len() {
            let Some(fd) = &self.replies else { return Ok(()) };
            match rustix::io::write(fd, &self.outbox[sent..]) {
                Ok(n) => sent += n,
                Err(Errno::INTR) => {}
                Err(Errno::AGAIN) => {
                    let until = *until.get_or_insert_with(|| Instant::now() + self.budget);
                    match self.turn(For::RoomToReply, until)? {
                        Found::Something => {}
                        Found::TimeUp => return Err(self.hung("read its replies")),
                        Found::Ended => return Ok(()),
                    }
                }
                Err(Errno::PIPE) => {
                    self.replies = None;
                    return Ok(());
                }
                Err(e) => return Err(SutError::io("cannot reply to the program")(e.into())),
            }
        }
        Ok(())
    }

    /// Ends the program: it gets `grace` to end by itself, then half a second to write its coverage on SIGTERM, then
    /// it is killed. Its children are killed in any case.
    #[must_use]
    pub fn finish(mut self, grace: Duration) -> Finished {
        // A program that still waits for a reply learns that there is none.
        self.replies = None;
        let mut exit = None;
        if self.wait_for_end(grace).is_none() {
            exit = Some(Exit::Killed);
            self.signal(Signal::TERM);
            self.wait_for_end(LAST_WORDS);
        }
        if self.status.is_none() {
            self.signal(Signal::KILL);
            self.status = self.child.wait().ok();
            self.drain();
        }
        let exit = exit.or(self.status.map(exit_of)).unwrap_or(Exit::Killed);
        let coverage = self.coverage.take().and_then(|(path, files)| coverage::read(&path, &files));
        Finished { exit, output: self.output(), coverage }
    }

    /// What the program has written to its output so far.
    #[must_use]
    pub fn output(&self) -> Output {
        Output { stdout: self.stdout.capture.captured(), stderr: self.stderr.capture.captured() }
    }

    // ── errors ──

    fn exited(&mut self) -> SutError {
        let exit = self.status.map_or(Exit::Killed, exit_of);
        SutError::Exited { exit, output: Box::new(self.output()) }
    }

    fn hung(&self, what: &'static str) -> SutError {
        SutError::Hung { what, budget: self.budget, output: Box::new(self.output()) }
    }

    fn rubbish(&self, line: &[u8], why: String) -> SutError {
        let line = String::from_utf8_lossy(&line[..line.len().min(200)]).into_owned();
        SutError::Rubbish { line, why, output: Box::new(self.output()) }
    }

    // ── the poll loop ──

    /// The next whole line from the program, if it is here.
    fn take_line(&mut self) -> Result<Option<Vec<u8>>, SutError> {
        let Some(end) = self.inbox[self.scanned..].iter().position(|&b| b == b'\n') else {
            self.scanned = self.inbox.len();
            if self.scanned > LONGEST_LINE {
                return Err(self.rubbish(&self.inbox, format!("a line longer than {LONGEST_LINE} bytes")));
            }
            return Ok(None);
        };
        let end = self.scanned + end;
        self.scanned = 0;
        let mut line = if end + 1 == self.inbox.len() {
            std::mem::take(&mut self.inbox)
        } else {
            self.inbox.drain(..=end).collect()
        };
        line.truncate(end);
        Ok(Some(line))
    }

    /// Waits once, until `until` at the latest; reads whatever there is.
    fn turn(&mut self, what: For, until: Instant) -> Result<Found, SutError> {
        let fail = || SutError::io("cannot wait for the program");
        let left = until.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Ok(Found::TimeUp);
        }
        let ready = self.poll(what, left).map_err(|e| fail()(e.into()))?;
        if ready.stdout {
            self.stdout.read(&mut self.chunk);
        }
        if ready.stderr {
            self.stderr.read(&mut self.chunk);
        }
        if ready.requests {
            self.read_requests();
        }
        if ready.ended || (self.ended.is_none() && self.has_ended()) {
            // The group may have other members, who may hold the pipes: nothing more is to be waited for. They are
            // killed before the child is reaped, while its number cannot be another's.
            self.signal(Signal::KILL);
            self.status = Some(self.child.wait().map_err(fail())?);
            self.drain();
            return Ok(Found::Ended);
        }
        Ok(Found::Something)
    }

    /// Whether the child has ended; it is left to be reaped.
    fn has_ended(&self) -> bool {
        let Some(pid) = i32::try_from(self.child.id()).ok().and_then(Pid::from_raw) else { return false };
        let how = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        !matches!(waitid(WaitId::Pid(pid), how), Ok(None))
    }

    fn poll(&self, what: For, left: Duration) -> Result<Ready, Errno> {
        let blind = self.ended.is_none();
        let left = if blind { left.min(LOOK) } else { left };
        let left = Timespec {
            tv_sec: left.as_secs().try_into().unwrap_or(i64::MAX),
            tv_nsec: left.subsec_nanos().into(),
        };
        let mut fds: [Option<(&OwnedFd, PollFlags)>; 5] = [
            self.requests.as_ref().map(|fd| (fd, PollFlags::IN)),
            self.stdout.fd.as_ref().map(|fd| (fd, PollFlags::IN)),
            self.stderr.fd.as_ref().map(|fd| (fd, PollFlags::IN)),
            self.ended.as_ref().map(|fd| (fd, PollFlags::IN)),
            self.replies.as_ref().filter(|_| what == For::RoomToReply).map(|fd| (fd, PollFlags::OUT)),
        ];
        if self.inbox.len() > LONGEST_LINE && what != For::Request {
            // Nobody takes lines now; the program waits.
            fds[0] = None;
        }
        // A fixed array, since `poll` takes no holes: places without a descriptor repeat the first, for nothing.
        let Some(spare) = fds.iter().flatten().next().map(|(fd, _)| *fd) else {
            std::thread::sleep(LOOK);
            return Ok(Ready::default());
        };
        let mut polled = fds.map(|fd| match fd {
            Some((fd, flags)) => PollFd::new(fd, flags),
            None => PollFd::new(spare, PollFlags::empty()),
        });
        match poll(&mut polled, Some(&left)) {
            Ok(_) | Err(Errno::INTR) => {}
            Err(e) => return Err(e),
        }
        let is = |k: usize| fds[k].is_some() && !polled[k].revents().is_empty();
        Ok(Ready { requests: is(0), stdout: is(1), stderr: is(2), ended: is(3) })
    }

    fn read_requests(&mut self) {
        let Some(fd) = &self.requests else { return };
        match rustix::io::read(fd, &mut *self.chunk) {
            Ok(0) => self.requests = None,
            Ok(n) => self.inbox.extend_from_slice(&self.chunk[..n]),
            Err(Errno::AGAIN | Errno::INTR) => {}
            Err(_) => self.requests = None,
        }
    }

    /// Reads what is left in the pipes, which nobody fills any more.
    fn drain(&mut self) {
        while self.stdout.read(&mut self.chunk) {}
        while self.stderr.read(&mut self.chunk) {}
        let mut before = usize::MAX;
        while self.requests.is_some() && before != self.inbox.len() && self.inbox.len() <= LONGEST_LINE {
            before = self.inbox.len();
            self.read_requests();
        }
    }

    fn wait_for_end(&mut self, time: Duration) -> Option<ExitStatus> {
        let until = Instant::now() + time;
        while self.status.is_none() {
            self.inbox.clear();
            self.scanned = 0;
            match self.turn(For::End, until) {
                Ok(Found::Something | Found::Ended) => {}
                Ok(Found::TimeUp) | Err(_) => break,
            }
        }
        self.status
    }

    /// Sends a signal to the program and all its children that have not left its group.
    fn signal(&self, signal: Signal) {
        if let Some(group) = i32::try_from(self.child.id()).ok().and_then(Pid::from_raw) {
            let _ = kill_process_group(group, signal);
        }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if self.status.is_none() {
            self.signal(Signal::KILL);
            let _ = self.child.wait();
        }
    }
}

#[derive(Default)]
struct Ready {
    requests: bool,
    stdout: bool,
    stderr: bool,
    ended: bool,
}

impl Stream {
    fn new(fd: Option<OwnedFd>, limit: usize) -> Self {
        let fd = fd.filter(|fd| unblock(fd).is_ok());
        Self { fd, capture: Capture::new(limit) }
    }

    /// Reads once; whether there may be more.
    fn read(&mut self, chunk: &mut [u8]) -> bool {
        let Some(fd) = &self.fd else { return false };
        match rustix::io::read(fd, &mut *chunk) {
            Ok(0) => self.fd = None,
            Ok(n) => self.capture.push(&chunk[..n]),
            Err(Errno::INTR) => return true,
            Err(Errno::AGAIN) => return false,
            Err(_) => self.fd = None,
        }
        self.fd.is_some()
    }
}

fn exit_of(status: ExitStatus) -> Exit {
    match (status.code(), status.signal()) {
        (Some(code), _) => Exit::Code(code),
        (None, Some(signal)) => Exit::Signal(signal),
        (None, None) => Exit::Killed,
    }
}

fn unblock(fd: impl AsFd) -> io::Result<()> {
    let flags = fcntl_getfl(&fd)?;
    fcntl_setfl(&fd, flags | OFlags::NONBLOCK)?;
    Ok(())
}

/// Requests: our end, its end; replies: its end, our end. Ours do not block, and only its ends are inherited.
fn pipes_for_child() -> io::Result<(OwnedFd, OwnedFd, OwnedFd, OwnedFd)> {
    let (requests, its_requests) = pipe_with(PipeFlags::CLOEXEC)?;
    let (its_replies, replies) = pipe_with(PipeFlags::CLOEXEC)?;
    unblock(&requests)?;
    unblock(&replies)?;
    fcntl_setfd(&its_requests, FdFlags::empty())?;
    fcntl_setfd(&its_replies, FdFlags::empty())?;
    Ok((requests, its_requests, its_replies, replies))
}

#[cfg(any(target_os = "linux", target_os = "android"))]
fn end_of(child: &Child) -> Option<OwnedFd> {
    let pid = Pid::from_raw(i32::try_from(child.id()).ok()?)?;
    rustix::process::pidfd_open(pid, rustix::process::PidfdFlags::empty()).ok()
}

#[cfg(not(any(target_os = "linux", target_os = "android")))]
fn end_of(_: &Child) -> Option<OwnedFd> {
    None
}

fn coverage_file(launch: &Launch) -> Result<(TempPath, Vec<String>), SutError> {
    let file = tempfile::Builder::new().prefix("hrdsl-coverage-").tempfile();
    let file = file.map_err(SutError::io("cannot make a temporary file"))?;
    Ok((file.into_temp_path(), launch.coverage.clone()))
}
