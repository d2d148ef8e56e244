//! SRDF: groups, states, hands, and which links need not be looked at for collisions.

pub(crate) mod joints;
pub(crate) mod model;
pub(crate) mod read;
