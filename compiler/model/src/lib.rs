//! AST → [`Scenario`]: every name resolved to an id, every expression typed and its constants folded. What does not fit is
//! said where it was written, with the nearest right name; nothing stops at the first error.

mod check;
mod descriptions;
mod expr;
mod interval;
mod lint;
mod noun;
mod report;
mod resolution;
mod scenario;
mod types;
pub mod world;

pub use check::{ArgumentSlot, INTERNAL_ACTIONS, InternalAction};
pub use check::{KnownSources, resolve, resolve_alone, resolve_part};
pub use descriptions::{DescriptionLibrary, DescriptionRequest};
pub use expr::{
    BinaryOp, EvalError, NumberFunction, TypedExpr, TypedExprKind, TypedIndex, TypedLvalue, UnaryOp,
    VariableRef, leaves,
};
pub use lint::lint;
pub use report::world::LIBRARY_PARTS;
pub use resolution::{DefinedType, NameDefinition, Resolutions};
pub use scenario::*;
pub use types::{Dimension, InferredType, InternedKind, UNITS, UnitOfMeasure, type_named, type_names};
