//! What goes in and out of an agent: the events that it reasons about and the actions that it does.

use hrdsl_ir::{EventId, Span, Value, bdi::TriggerOn};
use smallvec::SmallVec;

/// The arguments of an event; `None` is an argument that a test goal leaves open.
pub type Args = SmallVec<[Option<Value>; 4]>;

/// Ground arguments.
pub(crate) type Ground = SmallVec<[Value; 4]>;

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
/// [`Machine::stimulus_done`](crate::Machine::stimulus_done) with the token.
#[derive(Clone, Debug, PartialEq)]
pub struct Action {
    pub token: ActionToken,
    pub event: EventId,
    /// In the order, and of the types, of the event's parameters.
    pub args: Vec<Value>,
}

/// An event in the agent's queue.
#[derive(Clone, Debug)]
pub(crate) struct Event {
    pub on: TriggerOn,
    pub args: Args,
    /// The intention that waits for the event's plan; `None`: the plan becomes an intention of its own.
    pub of: Option<u32>,
    /// What posted a goal: a step, or the agent.
    pub origin: Span,
}
