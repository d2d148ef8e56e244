//! A network made ready to explore, what is asked of it, and what may happen in it: the discrete half and the zone graph.

pub(crate) mod actions;
pub(crate) mod bounds;
pub(crate) mod by_location;
pub(crate) mod code;
mod compile;
mod compiler;
mod enumeration;
pub(crate) mod error;
mod functions;
pub(crate) mod graph;
pub(crate) mod model;
pub(crate) mod number;
pub(crate) mod open;
pub(crate) mod parts;
pub mod query;
mod scope;
pub(crate) mod selects;
pub(crate) mod semantics;
mod signals;
pub(crate) mod well_formed;
mod width;
