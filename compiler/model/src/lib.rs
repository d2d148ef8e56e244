//! AST → [`Scenario`]: every name resolved to an id, every expression typed and its constants folded. What does not fit is
//! said where it was written, with the nearest right name; nothing stops at the first error.

mod check;
mod expr;
mod lint;
mod nearest;
mod noun;
mod query;
mod report;
mod scenario;
mod types;
mod value;
pub mod world;

pub use check::{INTERNAL_ACTIONS, InternalAction, Slot};
pub use check::{resolve, resolve_part};
pub use expr::{Expr, ExprKind, Function, Index, Leaf, Place, Term};
pub use lint::lint;
pub use nearest::{distance, nearest};
pub use query::{Ask, ClockBound, Formula, Linear, Measure, Query};
pub use report::world::LIBRARY_PARTS;
pub use scenario::*;
pub use types::{Dim, Kind, Of, Type, UNITS, Unit};
pub use value::{Elements, FoldError, Text, Value};
