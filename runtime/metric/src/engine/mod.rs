//! The engine: formulas over signals that come piece by piece, in time linear in the pieces and memory for what the windows hold.

pub(crate) mod extremum;
pub(crate) mod node;
pub(crate) mod opening;
pub(crate) mod piece;
pub(crate) mod reach;
