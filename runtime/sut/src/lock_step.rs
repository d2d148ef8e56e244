//! A process as the harness's system: it asks one thing at a time, and simulated time stands still until it waits.

use hrdsl_harness::{
    AwaitedPort, CallRequest, CanceledGoals, CommandRequest, LogRecord, MachineDeclaration, MachineEdge,
    MachineStep, ParameterRequest, RequestTicket, SystemActor, SystemAnswer, SystemArgument, SystemFault,
    SystemFaultKind, SystemRequest,
};
use hrdsl_ir::{Nanos, value::nanos};

use crate::{
    error::{ProgramFailure, SutError},
    process::SutProcess,
    protocol::{HarnessReply, MessageRequest, ProgramRequest, ProtocolArgument, RefusedLine, ReplyAnswer},
};

/// A running [`SutProcess`] behind the seam.
pub struct LockStep<'r> {
    process: &'r mut SutProcess,
    /// The program's name in the scenario.
    name: String,
    /// Whether it waits for an answer.
    waits: bool,
    /// What it is answered is to its hello.
    greets: bool,
    /// Requests without a reply that the harness has not yet answered, by their lines.
    one_way: Vec<u64>,
    /// What has failed in the program, as it says. It ends the test when the program next waits for a reply: until then it
    /// writes, and that belongs to what is told.
    failure: Option<ProgramFailure>,
}

impl<'r> LockStep<'r> {
    #[must_use]
    pub fn new(process: &'r mut SutProcess, name: &str) -> Self {
        let name = name.to_owned();
        Self { process, name, waits: false, greets: false, one_way: Vec::new(), failure: None }
    }
}

impl SystemActor for LockStep<'_> {
    fn is_ready(&self) -> bool {
        !self.waits
    }

    fn next(&mut self, now: Nanos) -> Result<Option<(RequestTicket, SystemRequest)>, SystemFault> {
        let request = match self.process.next() {
            // It hears of that now, and not when something else happens, if ever.
            Ok(ProgramRequest::Wait { .. }) if self.process.has_refused() => {
                ProgramRequest::Wait { until: Some(now), give_up: None }
            }
            Ok(request) => request,
            Err(error) => return Err(self.fault(error)),
        };
        let line = RequestTicket(self.process.line());
        if let ProgramRequest::Failed { text, node } = &request {
            self.failure.get_or_insert_with(|| ProgramFailure::new(node, text));
        }
        if request.is_one_way() {
            self.one_way.push(line.0);
        } else {
            if let Some(failure) = self.failure.take() {
                return Err(self.process.failed(failure).into());
            }
            self.waits = true;
            self.greets = matches!(request, ProgramRequest::Hello { .. });
        }
        Ok(Some((line, meant(request))))
    }

    fn answer(&mut self, line: RequestTicket, now: Nanos, answer: SystemAnswer) -> Result<(), SystemFault> {
        if let Some(at) = self.one_way.iter().position(|l| *l == line.0) {
            self.one_way.swap_remove(at);
            if let SystemAnswer::Refused { error, help } = answer {
                self.process.refuse(RefusedLine { line: line.0, error, help });
            }
            return Ok(());
        }
        self.waits = false;
        let version = self.process.version();
        let answer = if std::mem::take(&mut self.greets) && version > 1 {
            ReplyAnswer::Hello { version, program: self.name.clone() }
        } else {
            said(answer)
        };
        Ok(self.process.reply(&HarnessReply { time: now, answer })?)
    }
}

impl LockStep<'_> {
    /// What ends the test: of a program that has ended, what it said before that had failed.
    fn fault(&mut self, error: SutError) -> SystemFault {
        match self.failure.take() {
            Some(failure) if matches!(error, SutError::Exited { .. }) => self.process.failed(failure).into(),
            Some(_) | None => error.into(),
        }
    }
}

#[expect(clippy::too_many_lines, reason = "a flat match, an arm for each request")]
fn meant(request: ProgramRequest) -> SystemRequest {
    let arguments = |args: std::collections::BTreeMap<String, ProtocolArgument>| {
        args.into_iter().map(|(name, arg)| (name, argument(arg))).collect()
    };
    match request {
        // A failure asks for nothing; it is counted as any other request.
        ProgramRequest::Hello { .. } | ProgramRequest::Now | ProgramRequest::Failed { .. } => {
            SystemRequest::Now
        }
        ProgramRequest::Emit { event, args } => SystemRequest::Emit { event, args: arguments(args) },
        ProgramRequest::Sleep { seconds } => SystemRequest::Sleep { time: nanos(seconds) },
        ProgramRequest::WaitFor { events, timeout } => {
            SystemRequest::WaitFor { events, timeout: timeout.map(nanos) }
        }
        ProgramRequest::Drop { events } => SystemRequest::Drop { events },
        ProgramRequest::Read { signal } => SystemRequest::Read { signal },
        ProgramRequest::Act { on, command, args, wait, call } => {
            let command = CommandRequest { device: on, command, args: arguments(args) };
            match call.filter(|_| !wait) {
                Some(call) => SystemRequest::Begin { call, command },
                None => SystemRequest::Command(command),
            }
        }
        ProgramRequest::Wait { until, give_up } => SystemRequest::Wait { until, give_up },
        ProgramRequest::Open(open) => SystemRequest::Open(open.into()),
        ProgramRequest::Close { port } => SystemRequest::Close { port },
        ProgramRequest::List => SystemRequest::List,
        ProgramRequest::Await { kind, name, type_name, give_up } => {
            SystemRequest::Await(AwaitedPort { kind: kind.into(), name, type_name, give_up })
        }
        // INVARIANT: `fault` refuses a request with neither, or with both.
        ProgramRequest::Cancel { call: Some(call), .. } => {
            CallRequest::Cancel(CanceledGoals::Own(call)).into()
        }
        ProgramRequest::Cancel { call: None, port } => {
            CallRequest::Cancel(CanceledGoals::AllAt(port.unwrap_or_default())).into()
        }
        ProgramRequest::Accept { call, text } => CallRequest::Accept { call, text }.into(),
        ProgramRequest::AnswerCancel { call, granted, text } => {
            CallRequest::AnswerCancel { call, granted, text }.into()
        }
        ProgramRequest::State { device, what } => SystemRequest::State { device, what },
        ProgramRequest::Plan(plan) => plan.asked(),
        ProgramRequest::Transition { machine, label, outcome, next } => SystemRequest::Machine(match label {
            Some(from) => {
                let edge = MachineEdge { from, outcome: outcome.unwrap_or_default(), to: next };
                MachineStep::Moved { machine, edge }
            }
            None => MachineStep::Begun { machine, state: next },
        }),
        ProgramRequest::Machine { name, states, transitions, outcomes } => {
            let edge = |(from, outcome, to)| MachineEdge { from, outcome, to };
            let transitions = transitions.into_iter().map(edge).collect();
            let declared = MachineDeclaration { machine: name, states, transitions, outcomes };
            SystemRequest::Machine(MachineStep::Declared(declared))
        }
        ProgramRequest::GetParameter { name } => SystemRequest::Parameter(ParameterRequest::Get { name }),
        ProgramRequest::DeleteParameter { name } => {
            SystemRequest::Parameter(ParameterRequest::Delete { name })
        }
        ProgramRequest::Log { level, node, text } => {
            SystemRequest::Log(LogRecord { level: level.into(), node, text })
        }
        ProgramRequest::Message(request) => carried(request),
        ProgramRequest::Done => SystemRequest::Done,
    }
}

fn carried(request: MessageRequest) -> SystemRequest {
    match request {
        MessageRequest::Publish { port, message } => SystemRequest::Publish { port, message },
        MessageRequest::Call { port, call, message } => CallRequest::Begin { port, call, message }.into(),
        MessageRequest::Respond { call, answer } => CallRequest::Respond { call, answer }.into(),
        MessageRequest::Feedback { call, message } => CallRequest::Feedback { call, message }.into(),
        MessageRequest::Finish { call, end, message, text } => {
            CallRequest::Finish { call, end, message, text }.into()
        }
        MessageRequest::SetParameter { name, value } => {
            SystemRequest::Parameter(ParameterRequest::Set { name, value })
        }
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
        SystemAnswer::Numbers(numbers) => ReplyAnswer::Numbers(numbers),
        SystemAnswer::Json(text) => ReplyAnswer::Json(text),
        SystemAnswer::Way(points) => ReplyAnswer::Way(points),
        SystemAnswer::Ended(how) => ReplyAnswer::Acted(how),
        SystemAnswer::Arrived { arrivals, gave_up } => ReplyAnswer::Arrived { arrivals, gave_up },
        SystemAnswer::Listed(ports) => ReplyAnswer::Listed(ports),
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
            | SutError::Failed { .. }
            | SutError::Rubbish { .. }
            | SutError::Environment { .. }
            | SutError::Io { .. } => SystemFaultKind::Program,
        };
        Self { message: error.to_string(), kind }
    }
}
