//! The seam to the world: what the harness asks of whatever holds the bodies, be it simulated or not.

use std::collections::BTreeMap;

use hrdsl_ir::{
    Nanos, Value,
    world::{RuleOn, SignalId, WorldAction},
};

use crate::system::SystemArgument;

/// A world in which actors act. Times are those of the harness's clock; the calls come in the order of time.
pub trait World {
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

    /// Begins what the system orders a device to do. A later order to the same device replaces it.
    ///
    /// # Errors
    /// An order that makes no sense, or one that cannot be done.
    fn order(&mut self, order: &DeviceOrder) -> Result<Begun, OrderError>;

    /// The orders that have ended since the last call, in the order in which they did, and why those failed that did.
    fn take_ended(&mut self) -> Vec<(OrderId, Result<(), String>)>;
}

/// What the system orders a device to do, as it said it.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceOrder {
    /// `robot.arm`
    pub device: String,
    /// `move_to`
    pub verb: String,
    pub args: BTreeMap<String, SystemArgument>,
}

/// An order under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct OrderId(pub u64);

/// An order that was begun.
#[derive(Clone, Debug, PartialEq)]
pub struct Begun {
    pub id: OrderId,
    /// What rules of the world may wait for.
    pub sign: Option<RuleOn>,
}

/// Why an order was not begun.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OrderError {
    /// It makes no sense: no such device or verb, or other arguments than it takes.
    Refused {
        error: String,
        /// What to write instead.
        help: Option<String>,
    },
    /// It makes sense, and cannot be done as things are.
    Failed(String),
}
