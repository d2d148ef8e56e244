//! AST → [`Scenario`]: every name resolved to an id, every expression typed and its constants folded. What does not fit is
//! said where it was written, with the nearest right name; nothing stops at the first error.
//!
//! The check goes in phases ([`resolve`] has them in their order). Each is a type that says what it takes and what it gives; what the
//! scenario has in common with the Program is of the Program's types from the start.
#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod check;
mod descriptions;
mod expr;
mod interval;
mod lint;
mod measures;
mod noun;
mod provenance;
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
