//! The seam to the world: what the harness asks of whatever holds the bodies, be it simulated or not.

use hrdsl_ir::{
    Nanos, Value,
    world::{SignalId, WorldAction},
};

use crate::command::CheckedCommand;

/// A world in which actors act. Times are those of the harness's clock; the calls come in the order of time.
pub trait WorldBackend {
    /// When it next changes by itself; `None`: at rest.
    fn next_wake(&self) -> Option<Nanos>;

    /// Time has come to this.
    fn advance(&mut self, to: Nanos);

    /// The present value of a signal, in the SI unit of its type.
    fn read(&mut self, signal: SignalId) -> Value;

    /// Begins an environment actor's action; `vars` are the values of its variables. Does not wait for its end.
    ///
    /// # Errors
    /// Why the world cannot do it.
    fn act(&mut self, action: &WorldAction, vars: &[Value]) -> Result<(), String>;

    /// Begins a command of the system. Does not wait for its end: devices act side by side. A later command to the same device
    /// replaces it.
    ///
    /// # Errors
    /// Why it cannot be done as things are.
    fn command(&mut self, command: &CheckedCommand<'_>) -> Result<CommandId, String>;

    /// The commands that have ended since the last call, in the order in which they did, and why those failed that did.
    fn take_ended(&mut self) -> Vec<(CommandId, Result<(), String>)>;
}

/// A command under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CommandId(pub u64);
