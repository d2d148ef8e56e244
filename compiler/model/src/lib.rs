//! AST → [`Scenario`]: every name resolved to an id, every expression typed and its constants folded. What does not fit is
//! said where it was written, with the nearest right name; nothing stops at the first error.

mod check;
mod expr;
mod lint;
mod nearest;
mod noun;
mod report;
mod resolution;
mod scenario;
mod types;
pub mod world;

pub use check::{INTERNAL_ACTIONS, InternalAction, Slot};
pub use check::{resolve, resolve_alone, resolve_part};
pub use expr::{BinaryOp, EvalError, Expr, ExprKind, Index, Leaf, NumberFunction, Place, UnaryOp, leaves};
pub use lint::lint;
pub use nearest::{distance, nearest};
pub use report::world::LIBRARY_PARTS;
pub use resolution::{DefinedType, Definition, Resolutions};
pub use scenario::*;
pub use types::{Dim, Kind, Of, UNITS, Unit, type_named, type_names};
