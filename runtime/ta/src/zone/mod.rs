//! Sets of clock valuations: zones as matrices, unions of them, and what keeps their number finite.

mod bound;
pub(crate) mod constraint;
pub mod dbm;
pub(crate) mod diagonals;
pub(crate) mod extrapolation;
pub mod federation;
