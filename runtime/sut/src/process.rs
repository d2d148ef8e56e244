//! The process under test: runs in a cell with pipes of its own, and is spoken to in lock-step.
//!
//! One poll loop in the calling thread reads the requests, drains the output, watches the limits and notices the end; there are
//! no threads.

use std::{
    fs::File,
    io,
    os::fd::{AsFd, BorrowedFd, OwnedFd},
    time::{Duration, Instant},
};

use hrdsl_ir::Nanos;
use hrdsl_results::FileCoverage;
use rustix::{
    event::{PollFd, PollFlags, Timespec, poll},
    io::Errno,
};

use crate::{
    cell::{
        handle::CellHandle,
        message::{CellRequest, KeptFiles},
    },
    coverage::{self, ProgramLines},
    error::{ProgramFailure, SutError},
    exit::ProgramExit,
    fork_server::ForkServer,
    launch::LaunchSpec,
    limits::{LimitOverrun, ProgramLimits, StopFlag},
    output::CapturedOutput,
    patience::{LOOK, WaitBudget},
    pipes::{LineBuffer, ProcessStream, coverage_file, pipes_for_child},
    protocol::{self, HarnessReply, ProgramRequest, ProtocolLine, RefusedLine, ReplyAnswer, ReplyLine},
};

/// A request longer than this is rubbish.
const LONGEST_LINE: usize = 1 << 20;

/// More malformed requests one after the other come from no program that reads its replies.
const MOST_REFUSED: usize = 1_000;

/// Reads of a stream that empty a pipe as large as the kernel lets programs make it.
const READS_OF_A_PIPE: usize = 16;

/// How long a program may work on its coverage after it was asked to terminate.
const LAST_WORDS: Duration = Duration::from_millis(500);

/// A program under test, running. Dropping it kills it and whatever it started.
#[derive(Debug)]
pub struct SutProcess {
    cell: CellHandle,
    /// `None` once every writer has closed it.
    requests: Option<OwnedFd>,
    /// `None` once the program was told to finish.
    replies: Option<OwnedFd>,
    stdout: ProcessStream,
    stderr: ProcessStream,
    inbox: LineBuffer,
    outbox: Vec<u8>,
    chunk: Box<[u8]>,
    limits: ProgramLimits,
    stop: StopFlag,
    begun: Instant,
    /// When the supervisor was last asked what the program uses.
    asked: Instant,
    time: Nanos,
    /// The version of the protocol that its last hello said; until then 1.
    version: u32,
    /// How many lines it has written.
    lines: u64,
    /// What goes with the next reply.
    refused: Vec<RefusedLine>,
    /// What is to be said of it as long as it has made no request; then nothing.
    silence: &'static str,
    /// Whether it has gone over a limit.
    overran: bool,
    coverage: Option<(File, Vec<String>)>,
}

/// What is left of a program that has ended.
#[derive(Clone, Debug)]
pub struct FinishedProcess {
    pub exit: ProgramExit,
    pub output: CapturedOutput,
    /// `None` if it was not asked for, or the program was killed before it could be written.
    pub coverage: Option<Vec<FileCoverage>>,
    /// At which lines it was when; `None` if that was not asked for, or there is no coverage.
    pub lines: Option<ProgramLines>,
    /// Whether it ever started another process.
    pub others: bool,
    /// The files that it wrote, if they were to be kept.
    pub kept: Option<KeptFiles>,
    /// Processor time of all that it started, too.
    pub cpu: Duration,
}

/// What a turn of the poll loop waits for, besides output and the program's end.
#[derive(Clone, Copy, PartialEq, Eq)]
enum PollTarget {
    Request,
    RoomToReply,
    End,
}

/// What a turn of the poll loop found.
enum PollOutcome {
    Something,
    Ended,
}

impl SutProcess {
    /// Starts the program of a launch in a cell.
    ///
    /// # Errors
    /// [`SutError::Absent`] if something to run does not exist; [`SutError::Environment`] if the command asks for an
    /// interpreter that was not prepared; [`SutError::Io`] if the system refuses pipes, a cell or a process.
    pub fn spawn(launch: &LaunchSpec) -> Result<Self, SutError> {
        Self::spawn_with(launch, None)
    }

    /// Lets a fork server, which was started for such a launch, make the cell and the program.
    ///
    /// # Errors
    /// As [`spawn`](Self::spawn); [`SutError::Io`], too, if the server has ended and cannot be started again.
    pub fn fork(launch: &LaunchSpec, server: &mut ForkServer) -> Result<Self, SutError> {
        Self::spawn_with(launch, Some(server))
    }

    fn spawn_with(launch: &LaunchSpec, server: Option<&mut ForkServer>) -> Result<Self, SutError> {
        let io = || SutError::io("cannot make pipes");
        let (requests, its_requests, its_replies, replies) = pipes_for_child().map_err(io())?;
        let kept = if server.is_none() { launch.kept_folder()? } else { None };
        let mut descriptors = vec![its_requests.as_fd(), its_replies.as_fd()];
        let mut names = vec!["HRDSL_REQUEST_FD", "HRDSL_REPLY_FD"];
        let measures = !launch.coverage.is_empty();
        let memory = if measures { Some(coverage_file().map_err(io())?) } else { None };
        if let Some(memory) = &memory {
            descriptors.push(memory.as_fd());
            names.push("HRDSL_COVERAGE_FD");
        }
        let mut cell = if let Some(server) = server {
            server.cell(launch, &descriptors)?
        } else {
            let order = launch.order(names.into_iter().map(str::to_owned).collect())?;
            descriptors.extend(kept.as_ref().map(AsFd::as_fd));
            CellHandle::start(&launch.cells.supervisor, &order, &descriptors)?
        };
        let stdout = ProcessStream::new(cell.stdout.take(), launch.output_kept);
        let stderr = ProcessStream::new(cell.stderr.take(), launch.output_kept);
        Ok(Self {
            cell,
            requests: Some(requests),
            replies: Some(replies),
            stdout,
            stderr,
            inbox: LineBuffer::default(),
            outbox: Vec::new(),
            chunk: vec![0; 1 << 16].into_boxed_slice(),
            limits: launch.limits,
            stop: launch.stop.clone(),
            begun: Instant::now(),
            asked: Instant::now(),
            time: 0,
            version: 1,
            lines: 0,
            refused: Vec::new(),
            silence: launch.silence(),
            overran: false,
            coverage: memory.map(|file| (file, launch.coverage.clone())),
        })
    }

    /// Waits for the next request, at most for the budget. Requests that make no sense whatever the scenario (unknown
    /// kind, wrong types, another protocol version) are refused here, and the wait goes on.
    ///
    /// # Errors
    /// [`SutError::Exited`], [`SutError::Overrun`], [`SutError::Rubbish`], [`SutError::Stopped`]; [`SutError::Io`] if the
    /// system fails. After an error, [`finish`](Self::finish) is the only sensible call.
    #[allow(
        clippy::should_implement_trait,
        reason = "no iterator: each request must be answered before the next"
    )]
    pub fn next(&mut self) -> Result<ProgramRequest, SutError> {
        let mut patience = WaitBudget::new(self.limits.budget);
        let mut refused = 0_usize;
        loop {
            if self.inbox.advance() {
                self.lines += 1;
                match protocol::parse(self.inbox.line(), self.version) {
                    ProtocolLine::Request(request) => {
                        if let ProgramRequest::Hello { version, .. } = &request {
                            self.version = *version;
                        }
                        self.silence = "";
                        return Ok(request);
                    }
                    ProtocolLine::Rubbish(why) => return Err(self.rubbish(self.inbox.line(), why)),
                    ProtocolLine::Refused { why: error, waits } => {
                        self.silence = "";
                        refused += 1;
                        if refused > MOST_REFUSED {
                            let why = format!("{MOST_REFUSED} requests were refused, the last since {error}");
                            return Err(self.rubbish(self.inbox.line(), why));
                        }
                        let help = Some("see spec/protocol.md".to_owned());
                        if !waits {
                            self.refuse(RefusedLine { line: self.lines, error, help });
                            continue;
                        }
                        let answer = ReplyAnswer::Error { error, help };
                        self.reply(&HarnessReply { time: self.time, answer })?;
                        // It has asked: the wait for its next request begins.
                        patience = WaitBudget::new(self.limits.budget);
                        continue;
                    }
                }
            }
            if self.inbox.rest().len() > LONGEST_LINE {
                let why = format!("a line longer than {LONGEST_LINE} bytes");
                return Err(self.rubbish(self.inbox.rest(), why));
            }
            match self.turn(PollTarget::Request, &mut patience)? {
                PollOutcome::Something => {}
                // What it wrote before it ended comes first.
                PollOutcome::Ended if self.inbox.has_line() => {}
                PollOutcome::Ended => return Err(self.exited()),
            }
        }
    }

    /// Answers the request. That the program has ended meanwhile is for [`next`](Self::next) to say.
    ///
    /// # Errors
    /// [`SutError::Overrun`] if the program does not read its replies; [`SutError::Io`] if the system fails.
    pub fn reply(&mut self, reply: &HarnessReply) -> Result<(), SutError> {
        if self.overran {
            return Ok(()); // it has had its time, and may read nothing
        }
        self.time = reply.time;
        self.outbox.clear();
        let refused = std::mem::take(&mut self.refused);
        serde_json::to_writer(&mut self.outbox, &ReplyLine { reply, refused: &refused })
            .map_err(|e| SutError::io("cannot write a reply")(io::Error::other(e)))?;
        self.outbox.push(b'\n');
        let mut sent = 0;
        let mut patience = WaitBudget::new(self.limits.budget);
        while sent < self.outbox.len() {
            let Some(fd) = &self.replies else { return Ok(()) };
            match rustix::io::write(fd, &self.outbox[sent..]) {
                Ok(n) => sent += n,
                Err(Errno::INTR) => {}
                Err(Errno::AGAIN) => match self.turn(PollTarget::RoomToReply, &mut patience)? {
                    PollOutcome::Something => {}
                    PollOutcome::Ended => return Ok(()),
                },
                Err(Errno::PIPE) => {
                    self.replies = None;
                    return Ok(());
                }
                Err(e) => return Err(SutError::io("cannot reply to the program")(e.into())),
            }
        }
        Ok(())
    }

    /// A request without a reply was refused: the next reply says so.
    pub fn refuse(&mut self, line: RefusedLine) {
        if self.refused.len() < MOST_REFUSED {
            self.refused.push(line);
        }
    }

    /// Whether the next reply says that something was refused.
    #[must_use]
    pub fn has_refused(&self) -> bool {
        !self.refused.is_empty()
    }

    /// The version of the protocol that it speaks.
    #[must_use]
    pub fn version(&self) -> u32 {
        self.version
    }

    /// The number of the line of its last request, from 1.
    #[must_use]
    pub fn line(&self) -> u64 {
        self.lines
    }

    /// Ends the program: it gets `grace` (of processor time or sleep) to end by itself, unless it has had its time already,
    /// then half a second to write its coverage on SIGTERM, then it is killed. Whatever it started is killed in any case.
    #[must_use]
    pub fn finish(mut self, grace: Duration) -> FinishedProcess {
        // A program that still waits for a reply learns that there is none.
        self.replies = None;
        let mut killed = false;
        let grace = if self.overran { Duration::ZERO } else { grace };
        if !self.wait_for_end(grace) {
            killed = true;
            self.cell.ask(CellRequest::Terminate);
            if !self.wait_for_end(LAST_WORDS) {
                self.cell.ask(CellRequest::Kill);
                let _ = self.cell.await_end(Duration::from_secs(30));
            }
        }
        self.drain();
        let ending = self.cell.ending().cloned();
        let exit = ending.as_ref().filter(|_| !killed).map_or(ProgramExit::Killed, |e| e.exit);
        let measured = self.coverage.take().and_then(|(file, names)| coverage::read(file, &names));
        let (coverage, lines) = measured.map(|code| (code.coverage, code.lines)).unzip();
        let (others, kept, cpu) = ending.map_or_else(Default::default, |e| (e.others, e.kept, e.cpu));
        FinishedProcess { exit, output: self.output(), coverage, lines: lines.flatten(), others, kept, cpu }
    }

    /// What the program has written to its output so far, with the paths of the project.
    #[must_use]
    pub fn output(&self) -> CapturedOutput {
        let moved = &self.cell.moved;
        CapturedOutput {
            stdout: self.stdout.capture.captured(moved),
            stderr: self.stderr.capture.captured(moved),
        }
    }

    /// What of the program has failed, with what it has written until it began to wait for a reply.
    pub(crate) fn failed(&mut self, failure: ProgramFailure) -> SutError {
        for _ in 0..READS_OF_A_PIPE {
            self.stdout.read(&mut self.chunk);
            self.stderr.read(&mut self.chunk);
        }
        SutError::Failed { failure, output: Box::new(self.output()) }
    }

    // ── errors ──

    fn exited(&mut self) -> SutError {
        let exit = self.cell.ending().map_or(ProgramExit::Killed, |e| e.exit);
        SutError::Exited { exit, silence: self.silence, output: Box::new(self.output()) }
    }

    fn overrun(&self, what: PollTarget, overrun: LimitOverrun) -> SutError {
        let what = match what {
            PollTarget::Request => "make a request",
            PollTarget::RoomToReply => "read its replies",
            PollTarget::End => "end",
        };
        SutError::Overrun { what, overrun, silence: self.silence, output: Box::new(self.output()) }
    }

    fn rubbish(&self, line: &[u8], why: String) -> SutError {
        let line = String::from_utf8_lossy(&line[..line.len().min(200)]).into_owned();
        SutError::Rubbish { line, why, output: Box::new(self.output()) }
    }

    // ── the poll loop ──

    /// Waits once, for a look's time at most; reads whatever there is, and watches the limits.
    fn turn(&mut self, what: PollTarget, patience: &mut WaitBudget) -> Result<PollOutcome, SutError> {
        let ready = self.poll(what).map_err(|e| SutError::io("cannot wait for the program")(e.into()))?;
        if ready.stdout {
            self.stdout.read(&mut self.chunk);
        }
        if ready.stderr {
            self.stderr.read(&mut self.chunk);
        }
        if ready.requests {
            self.read_requests();
        }
        if ready.control {
            self.cell.listen();
        }
        if self.cell.ending().is_some() || self.cell.is_lost() {
            // Nobody is left who could write.
            self.drain();
            return Ok(PollOutcome::Ended);
        }
        match self.watch(what, patience) {
            Some(overrun) => {
                self.overran = true;
                Err(self.overrun(what, overrun))
            }
            None if self.stop.is_set() => Err(SutError::Stopped { output: Box::new(self.output()) }),
            None => Ok(PollOutcome::Something),
        }
    }

    /// Which limit the program has gone over, if any.
    fn watch(&mut self, what: PollTarget, patience: &mut WaitBudget) -> Option<LimitOverrun> {
        let limits = self.limits;
        // Output is not counted against a program that is over.
        if what != PollTarget::End
            && self.stdout.capture.bytes() + self.stderr.capture.bytes() > limits.output
        {
            return Some(LimitOverrun::Output(limits.output));
        }
        if let Some(usage) = self.cell.take_usage() {
            if usage.cpu > limits.cpu {
                return Some(LimitOverrun::Cpu(limits.cpu));
            }
            if let Some(overrun) = patience.look(usage) {
                return Some(overrun);
            }
        }
        if self.asked.elapsed() >= LOOK {
            self.asked = Instant::now();
            self.cell.ask(CellRequest::Usage);
        }
        (self.begun.elapsed() > limits.wall).then_some(LimitOverrun::Wall(limits.wall))
    }

    fn poll(&self, what: PollTarget) -> Result<StreamReadiness, Errno> {
        let look = Timespec { tv_sec: 0, tv_nsec: LOOK.subsec_nanos().into() };
        let mut fds: [Option<(BorrowedFd<'_>, PollFlags)>; 5] = [
            self.requests.as_ref().map(|fd| (fd.as_fd(), PollFlags::IN)),
            self.stdout.fd.as_ref().map(|fd| (fd.as_fd(), PollFlags::IN)),
            self.stderr.fd.as_ref().map(|fd| (fd.as_fd(), PollFlags::IN)),
            self.cell.control().map(|fd| (fd, PollFlags::IN)),
            self.replies
                .as_ref()
                .filter(|_| what == PollTarget::RoomToReply)
                .map(|fd| (fd.as_fd(), PollFlags::OUT)),
        ];
        if self.inbox.rest().len() > LONGEST_LINE && what != PollTarget::Request {
            // Nobody takes lines now; the program waits.
            fds[0] = None;
        }
        // A fixed array, since `poll` takes no holes: places without a descriptor repeat the first, for nothing.
        let Some(spare) = fds.iter().flatten().next().map(|(fd, _)| *fd) else {
            return Ok(StreamReadiness::default());
        };
        let mut polled = fds.map(|fd| match fd {
            Some((fd, flags)) => PollFd::from_borrowed_fd(fd, flags),
            None => PollFd::from_borrowed_fd(spare, PollFlags::empty()),
        });
        match poll(&mut polled, Some(&look)) {
            Ok(_) | Err(Errno::INTR) => {}
            Err(e) => return Err(e),
        }
        let is = |k: usize| fds[k].is_some() && !polled[k].revents().is_empty();
        Ok(StreamReadiness { requests: is(0), stdout: is(1), stderr: is(2), control: is(3) })
    }

    fn read_requests(&mut self) {
        let Some(fd) = &self.requests else { return };
        match rustix::io::read(fd, &mut *self.chunk) {
            Ok(0) => self.requests = None,
            Ok(n) => self.inbox.push(&self.chunk[..n]),
            Err(Errno::AGAIN | Errno::INTR) => {}
            Err(_) => self.requests = None,
        }
    }

    /// Reads what is left in the pipes, which nobody fills any more.
    fn drain(&mut self) {
        while self.stdout.read(&mut self.chunk) {}
        while self.stderr.read(&mut self.chunk) {}
        let mut before = usize::MAX;
        while self.requests.is_some()
            && before != self.inbox.rest().len()
            && self.inbox.rest().len() <= LONGEST_LINE
        {
            before = self.inbox.rest().len();
            self.read_requests();
        }
    }

    /// Whether the program ended within its time.
    fn wait_for_end(&mut self, time: Duration) -> bool {
        let mut patience = WaitBudget::new(time);
        while self.cell.ending().is_none() && !self.cell.is_lost() {
            self.inbox.clear();
            match self.turn(PollTarget::End, &mut patience) {
                Ok(PollOutcome::Something | PollOutcome::Ended) => {}
                Err(_) => return false,
            }
        }
        self.cell.ending().is_some()
    }
}

#[derive(Default)]
struct StreamReadiness {
    requests: bool,
    stdout: bool,
    stderr: bool,
    control: bool,
}
