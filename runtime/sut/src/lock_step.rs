//! A process as the harness's system: it asks one thing at a time, and simulated time stands still until it waits.

use hrdsl_harness::{
    CommandRequest, RequestTicket, SystemActor, SystemAnswer, SystemArgument, SystemFault, SystemFaultKind,
    SystemRequest,
};
use hrdsl_ir::{Nanos, value::nanos};

use crate::{
    error::SutError,
    process::SutProcess,
    protocol::{HarnessReply, ProgramRequest, ProtocolArgument, ReplyAnswer},
};

/// A running [`SutProcess`] behind the seam.
pub struct LockStep<'r> {
    process: &'r mut SutProcess,
    /// Whether it waits for an answer.
    waits: bool,
}

impl<'r> LockStep<'r> {
    #[must_use]
    pub fn new(process: &'r mut SutProcess) -> Self {
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
        Ok(self.process.reply(&HarnessReply { time: now, answer: said(answer) })?)
    }
}

fn meant(request: ProgramRequest) -> SystemRequest {
    let arguments = |args: std::collections::BTreeMap<String, ProtocolArgument>| {
        args.into_iter().map(|(name, arg)| (name, argument(arg))).collect()
    };
    match request {
        ProgramRequest::Hello { .. } | ProgramRequest::Now => SystemRequest::Now,
        ProgramRequest::Emit { event, args } => SystemRequest::Emit { event, args: arguments(args) },
        ProgramRequest::Sleep { seconds } => SystemRequest::Sleep { time: nanos(seconds) },
        ProgramRequest::WaitFor { events, timeout } => {
            SystemRequest::WaitFor { events, timeout: timeout.map(nanos) }
        }
        ProgramRequest::Drop { events } => SystemRequest::Drop { events },
        ProgramRequest::Read { signal } => SystemRequest::Read { signal },
        ProgramRequest::Act { on, command, args, wait: _ } => {
            SystemRequest::Command(CommandRequest { device: on, command, args: arguments(args) })
        }
        ProgramRequest::Done => SystemRequest::Done,
    }
}

fn argument(arg: ProtocolArgument) -> SystemArgument {
    match arg {
        ProtocolArgument::Text(text) => SystemArgument::Text(text),
        ProtocolArgument::Numbers(numbers) => SystemArgument::Numbers(numbers),
        ProtocolArgument::Scalar(value) => SystemArgument::Scalar(value),
    }
}

fn said(answer: SystemAnswer) -> ReplyAnswer {
    match answer {
        SystemAnswer::Ok => ReplyAnswer::Ok,
        SystemAnswer::Event { name, args, time } => ReplyAnswer::Event { name, args, time },
        SystemAnswer::TimedOut => ReplyAnswer::TimedOut,
        SystemAnswer::Value(value) => ReplyAnswer::Value(value),
        SystemAnswer::Ended(how) => ReplyAnswer::Acted(how),
        SystemAnswer::Refused { error, help } => ReplyAnswer::Error { error, help },
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
