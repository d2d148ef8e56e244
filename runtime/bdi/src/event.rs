//! What goes in and out of an agent: the events that it reasons about, the actions that it does, the messages it sends.

use hrdsl_ir::{
    EventId, Symbol, Value,
    bdi::{ContentId, Performative, TriggerOn},
};
use smallvec::SmallVec;

use crate::belief::{FactAnnotations, GroundArguments};

/// The arguments of an event; `None` is an argument that is open: a query or a goal is to give it a value.
pub type EventArguments = SmallVec<[Option<Value>; 2]>;

/// Names one action of one agent until it is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ActionToken(u64);

impl ActionToken {
    pub(crate) fn new(place: u32, serial: u32) -> Self {
        Self(u64::from(place) << 32 | u64::from(serial))
    }

    /// The intention's place, and the serial number of the action.
    pub(crate) fn parts(self) -> (u32, u32) {
        ((self.0 >> 32) as u32, self.0 as u32)
    }
}

/// A stimulus, or a plain event, that the agent does now. Its intention goes on when the harness calls
/// [`stimulus_done`](crate::AgentSociety::stimulus_done) with the token.
#[derive(Clone, Debug, PartialEq)]
pub struct AgentAction {
    pub token: ActionToken,
    pub event: EventId,
    /// In the order, and of the types, of the event's parameters.
    pub args: Vec<Value>,
}

/// An event in the agent's queue. It is moved often, and so it is kept small.
#[derive(Clone, Debug)]
pub(crate) struct QueuedEvent {
    pub on: TriggerOn,
    /// The plan and the site of the step that posted a goal.
    pub by: Option<(u16, u16)>,
    /// The intention that waits for the event's plan; `None`: the plan becomes an intention of its own.
    pub of: Option<u32>,
    /// Of a goal: the other agent that asked for it.
    pub told: Option<Symbol>,
    pub args: EventArguments,
    pub more: Option<Box<EventExtras>>,
}

/// What few events have.
#[derive(Clone, Debug, Default)]
pub(crate) struct EventExtras {
    annotations: FactAnnotations,
    reply: Option<ReplyAddress>,
}

impl QueuedEvent {
    pub fn new(on: TriggerOn, args: EventArguments) -> Self {
        Self { on, by: None, of: None, told: None, args, more: None }
    }

    #[must_use]
    pub fn annotated(mut self, annotations: FactAnnotations) -> Self {
        if !annotations.is_empty() {
            self.more.get_or_insert_default().annotations = annotations;
        }
        self
    }

    /// Another agent asked, and waits for the answer of this test goal.
    #[must_use]
    pub fn asked(mut self, reply: ReplyAddress) -> Self {
        self.more.get_or_insert_default().reply = Some(reply);
        self
    }

    /// Of a belief that was added those that are new, of one that left those it had.
    pub fn annotations(&self) -> Option<&FactAnnotations> {
        self.more.as_ref().map(|m| &m.annotations).filter(|a| !a.is_empty())
    }

    pub fn reply(&self) -> Option<ReplyAddress> {
        self.more.as_ref().and_then(|m| m.reply)
    }
}

/// To whom an answer goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ReplyAddress {
    pub to: u16,
    pub content: ContentId,
    /// The question's number, if the asker waits; else the answer is told.
    pub question: Option<u64>,
}

/// What an agent says to another.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum SpeechAct {
    /// Any performative that needs no answer waited for.
    /// What is told has annotations besides its source, as the receiver declares them.
    Say { performative: Performative, content: ContentId, args: EventArguments, annotations: FactAnnotations },
    /// `.ask`, `.ask_all`: the asker waits for the answer to its question of this number.
    Ask { question: u64, content: ContentId, args: EventArguments, all: bool },
    /// The answers to a question: one, or of `.ask_all` any number; `None` if there is no answer.
    Answer { question: u64, content: ContentId, all: bool, answers: Option<Vec<EventArguments>> },
}

/// A message on its way.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct OutgoingMail {
    /// The agent's place in the society.
    pub to: u16,
    pub speech: SpeechAct,
}

/// What waits to be taken in.
#[derive(Clone, Debug)]
pub(crate) enum IncomingItem {
    Perceived { event: EventId, args: GroundArguments },
    Heard { from: u16, speech: SpeechAct },
}
