//! Arguments of events and orders, as the system writes them.

use hrdsl_ir::Value;

/// An argument of an event or an order, as the system wrote it: what it means, its declaration tells.
#[derive(Clone, Debug, PartialEq)]
pub enum SystemArgument {
    /// The name of a value of an enumeration, perhaps.
    Text(String),
    /// A place (x, y, z; metres) or joint angles (radians).
    Numbers(Vec<f64>),
    Scalar(Value),
}
