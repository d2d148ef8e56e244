//! What players and the world want to happen.

use hrdsl_ir::{EventId, Value, world::WorldAction};
use hrdsl_trace::MachineStep;

/// What a player wants to happen now.
#[derive(Clone, Debug)]
pub enum PlayerMessage {
    /// An event or stimulus of the player's actor happens.
    Event { event: EventId, args: Vec<Value> },
    /// The world changes; `vars` are the values of the action's variables.
    Act { action: WorldAction, vars: Vec<Value> },
    /// A state machine of the player's was declared or has moved: that is written down, and nobody hears of it.
    Machine(MachineStep),
}
