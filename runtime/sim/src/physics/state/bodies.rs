//! Bodies by their numbers, where they start, and what is said of a number that nothing has.

use hrdsl_ir::world::{Body, BodyId};

use crate::{
    error::SimulationError,
    math::{BodyFrame, from_rpy, v3},
};

pub fn index(body: BodyId) -> usize {
    usize::from(body.0)
}

pub fn body_id(i: usize) -> BodyId {
    BodyId(u16::try_from(i).unwrap_or(u16::MAX))
}

pub fn bad(what: String, kind: &'static str, index: usize) -> SimulationError {
    SimulationError::BadReference { what, kind, index }
}

pub fn start_of(body: &Body) -> BodyFrame {
    BodyFrame::new(v3(body.position), from_rpy(body.rotation))
}
