//! What players and the world want to happen.

use hrdsl_ir::{EventId, Value, world::WorldAction};

/// What a player wants to happen now.
#[derive(Clone, Debug)]
pub enum PlayerMessage {
    /// An event or stimulus of the player's actor happens.
    Event { event: EventId, args: Vec<Value> },
    /// The world changes; `vars` are the values of the action's variables.
    Act { action: WorldAction, vars: Vec<Value> },
}
