//! A process as the harness's system: it asks one thing at a time, and simulated time stands still until it waits.

use hrdsl_harness::{
    CommandRequest, RequestTicket, SystemActor, SystemAnswer, SystemArgument, SystemFault, SystemFaultKind,
    SystemRequest,
};
use hrdsl_ir::{Nanos, value::nanos};

use crate::{
    error::SutError,
    process::Process,
    protocol::{Answer, Arg, Reply, Request},
};

/// A running [`Process`] behind the seam.
pub struct LockStep<'r> {
    process: &'r mut Process,
    /// Whether it waits for an answer.
    waits: bool,
}

impl<'r> LockStep<'r> {
    #[must_use]
    pub fn new(process: &'r mut Process) -> Self {
        Self { process, waits: false }
    }
}

impl SystemActor for LockStep<'_> {
    fn is_ready(&self) -> bool {
        !self.waits
    }

    fn next(&mut self, _: Nanos) -> Result<Option<(RequestTicket, SystemRequest)>, SystemFault> {
        let request = self.process.next()?;
        self.waits = true;
        Ok(Some((RequestTicket::default(), meant(request))))
    }

    fn answer(&mut self, _: RequestTicket, now: Nanos, answer: SystemAnswer) -> Result<(), SystemFault> {
        self.waits = false;
        Ok(self.process.reply(&Reply { time: now, answer: said(answer) })?)
    }
}

fn meant(request: Request) -> SystemRequest {
    let arguments = |args: std::collections::BTreeMap<String, Arg>| {
        args.into_iter().map(|(name, arg)| (name, argument(arg))).collect()
    };
    match request {
        Request::Hello { .. } | Request::Now => SystemRequest::Now,
        Request::Emit { event, args } => SystemRequest::Emit { event, args: arguments(args) },
        Request::Sleep { seconds } => SystemRequest::Sleep { time: nanos(seconds) },
        Request::WaitFor { events, timeout } => {
            SystemRequest::WaitFor { events, timeout: timeout.map(nanos) }
        }
        Request::Drop { events } => SystemRequest::Drop { events },
        Request::Read { signal } => SystemRequest::Read { signal },
        Request::Act { on, command, args, wait: _ } => {
            SystemRequest::Command(CommandRequest { device: on, command, args: arguments(args) })
        }
        Request::Done => SystemRequest::Done,
    }
}

fn argument(arg: Arg) -> SystemArgument {
    match arg {
        Arg::Text(text) => SystemArgument::Text(text),
        Arg::Numbers(numbers) => SystemArgument::Numbers(numbers),
        Arg::Scalar(value) => SystemArgument::Scalar(value),
    }
}

fn said(answer: SystemAnswer) -> Answer {
    match answer {
        SystemAnswer::Ok => Answer::Ok,
        SystemAnswer::Event { name, args, time } => Answer::Event { name, args, time },
        SystemAnswer::TimedOut => Answer::TimedOut,
        SystemAnswer::Value(value) => Answer::Value(value),
        SystemAnswer::Ended(how) => Answer::Acted(how),
        SystemAnswer::Refused { error, help } => Answer::Error { error, help },
    }
}

impl From<SutError> for SystemFault {
    fn from(error: SutError) -> Self {
        let kind = match &error {
            SutError::Overrun { overrun, .. } if overrun.is_of_wall_time() => SystemFaultKind::WallTime,
            SutError::Stopped { .. } => SystemFaultKind::Interrupted,
            SutError::Overrun { .. }
            | SutError::Absent { .. }
            | SutError::Exited { .. }
            | SutError::Rubbish { .. }
            | SutError::Environment { .. }
            | SutError::Io { .. } => SystemFaultKind::Program,
        };
        Self { message: error.to_string(), kind }
    }
}
