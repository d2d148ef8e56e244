//! The seam to the system: what plays the system actor, be it a process in lock-step or a robot outside.
//!
//! A system asks, and is answered. A request need not be answered before the next one comes: each has a [`RequestTicket`], and
//! whoever waits for nothing goes on asking. A process in lock-step has at most one request open. What comes meanwhile (events,
//! ends of commands, messages of other programs) waits for it as [`SystemArrival`]s.

use std::{collections::BTreeMap, fmt};

use hrdsl_ir::{Nanos, Value};
use hrdsl_trace::MachineStep;

use crate::{
    argument::SystemArgument,
    command::CommandRequest,
    fault::SystemFault,
    log::LogRecord,
    port::{AwaitedPort, GoalEnd, MessageText, PortDeclaration, PortListing, QosPolicy},
    world::{MotionPlanRequest, PlannedPoint},
};

/// Whatever plays the system actor.
pub trait SystemActor {
    /// Whether it may ask something now: if not, it is not asked before it was answered, or time has passed.
    fn is_ready(&self) -> bool;

    /// What it asks next at this instant; `None`: nothing more.
    ///
    /// # Errors
    /// What it did that no system should.
    fn next(&mut self, now: Nanos) -> Result<Option<(RequestTicket, SystemRequest)>, SystemFault>;

    /// The answer to one of its requests.
    ///
    /// # Errors
    /// What it did that no system should.
    fn answer(&mut self, ticket: RequestTicket, now: Nanos, answer: SystemAnswer) -> Result<(), SystemFault>;
}

/// Tells the open requests of a system apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct RequestTicket(pub u64);

/// What a system asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum SystemRequest {
    /// What time is it?
    Now,
    /// Make an event of the scenario happen.
    Emit {
        event: String,
        args: BTreeMap<String, SystemArgument>,
    },
    /// Tell it when this time has passed.
    Sleep {
        time: Nanos,
    },
    /// Take the first of these events out of the mailbox, or tell it when one comes.
    WaitFor {
        events: Vec<String>,
        timeout: Option<Nanos>,
    },
    /// Forget these events in the mailbox; none named: all.
    Drop {
        events: Vec<String>,
    },
    /// The present value of a signal.
    Read {
        signal: String,
    },
    /// Let a device do something, and answer when that has ended.
    Command(CommandRequest),
    /// Let a device do something; that it has ended will arrive, by this number of the program's own.
    Begin {
        call: u64,
        command: CommandRequest,
    },
    /// Answer when something has arrived; or when it is `until`; or when it is `give_up` and nothing else happens any more at
    /// that instant. What has arrived already is the answer at once.
    Wait {
        until: Option<Nanos>,
        give_up: Option<Nanos>,
    },
    /// Open a port to other programs.
    Open(PortDeclaration),
    Close {
        port: u64,
    },
    /// What is open, and an arrival when that changes.
    List,
    /// It waits until somebody is at a name; that is all it says.
    Await(AwaitedPort),
    Publish {
        port: u64,
        message: MessageText,
    },
    /// Do something about a call of a service or a goal of an action.
    Call(CallRequest),
    /// Numbers that a device can tell of itself: the angles of its joints, the place of its tool.
    State {
        device: String,
        what: String,
    },
    /// A free path of an arm to a target.
    Plan {
        device: String,
        wanted: MotionPlanRequest,
        form: PlanForm,
    },
    /// A state machine of its own was declared, was begun or has moved.
    Machine(MachineStep),
    /// What all programs of the system share.
    Parameter(ParameterRequest),
    /// It logs something, which changes nothing.
    Log(LogRecord),
    /// It has come to its normal end.
    Done,
}

/// What a program does about calls of services and goals of actions, its own and those of others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CallRequest {
    /// Ask a service, or send an action a goal: the answer will arrive by this number of the program's own.
    Begin {
        port: u64,
        call: u64,
        message: MessageText,
    },
    /// Answer such a call, by the number with which it arrived.
    Respond {
        call: u64,
        answer: Result<MessageText, String>,
    },
    /// Take a goal on; `text` says why, or how, to the client.
    Accept {
        call: u64,
        text: String,
    },
    Feedback {
        call: u64,
        message: MessageText,
    },
    /// Say whether a goal whose client wants it to end will be canceled.
    AnswerCancel {
        call: u64,
        granted: bool,
        text: String,
    },
    Finish {
        call: u64,
        end: GoalEnd,
        message: MessageText,
        text: String,
    },
    /// Ask for the end of a goal.
    Cancel(CanceledGoals),
}

impl From<CallRequest> for SystemRequest {
    fn from(request: CallRequest) -> Self {
        SystemRequest::Call(request)
    }
}

/// What a program asks of the parameters of the system, by names with slashes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ParameterRequest {
    Get { name: String },
    Set { name: String, value: MessageText },
    Delete { name: String },
}

/// What a system wants to know of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanForm {
    /// The posture at its end.
    End,
    /// Its corners, one after the other, with both ends.
    Corners,
    /// Its points with their times.
    Timed,
}

/// Which goals a client wants to end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CanceledGoals {
    /// One of its own, by its number for it.
    Own(u64),
    /// All that the server of an action has, by the client's port.
    AllAt(u64),
}

/// What the harness answers.
#[derive(Clone, Debug, PartialEq)]
pub enum SystemAnswer {
    /// To now, emit, sleep and drop.
    Ok,
    /// To a wait: the event that came, and when it happened.
    Event { name: String, args: BTreeMap<String, Value>, time: Nanos },
    /// To a wait: its time is over.
    TimedOut,
    /// To read.
    Value(Value),
    /// To state and plan.
    Numbers(Vec<f64>),
    /// To a question for a parameter: the text of its value.
    Json(MessageText),
    /// To a plan with times.
    Way(Vec<PlannedPoint>),
    /// To a command: it ended, well or for this reason not.
    Ended(Result<(), String>),
    /// To a wait: what has arrived, in the order in which it did.
    Arrived { arrivals: Vec<SystemArrival>, gave_up: bool },
    /// To a list.
    Listed(Vec<PortListing>),
    /// To any request: it makes no sense.
    Refused {
        error: String,
        /// What to write instead.
        help: Option<String>,
    },
}

/// What comes to a program without an answer of its own.
#[derive(Clone, Debug, PartialEq)]
pub enum SystemArrival {
    /// An event that its actor hears, and when it happened.
    Event {
        name: String,
        args: BTreeMap<String, Value>,
        time: Nanos,
    },
    /// A command that it began has ended.
    Ended {
        call: u64,
        how: Result<(), String>,
    },
    /// To a subscriber.
    Message {
        port: u64,
        message: MessageText,
    },
    /// To a publisher and a subscriber: nothing passes between them, since one requests more than the other offers.
    Incompatible {
        port: u64,
        policy: QosPolicy,
    },
    /// To a server: a request or a goal, and the number to answer by.
    Called {
        port: u64,
        call: u64,
        message: MessageText,
    },
    /// To a client: the answer to its call; why there is none.
    Answered {
        call: u64,
        answer: Result<MessageText, String>,
    },
    /// To a client of an action: the server has taken the goal on.
    Accepted {
        call: u64,
        text: String,
    },
    Feedback {
        call: u64,
        message: MessageText,
    },
    /// To a client that wants its goal to end: whether the server cancels it.
    CancelAnswered {
        call: u64,
        granted: bool,
        text: String,
    },
    Finished {
        call: u64,
        end: GoalEnd,
        message: MessageText,
        text: String,
    },
    /// To a server of actions: the client wants the goal to end.
    Canceled {
        port: u64,
        call: u64,
    },
    /// Ports were opened or closed since it asked for the list.
    Changed,
}

impl fmt::Display for SystemArgument {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SystemArgument::Text(text) => write!(f, "{text:?}"),
            SystemArgument::Scalar(value) => write!(f, "{value}"),
            SystemArgument::Numbers(numbers) => write!(f, "{numbers:?}"),
        }
    }
}
