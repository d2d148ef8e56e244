//! Points: where an environment actor sends something.

use serde::{Deserialize, Serialize};

use crate::{expr::Expr, world_ids::BodyRef};

/// A point: a place in the world, or relative to a body's centre (in world axes) at the time of the action.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorldPoint<E = Expr> {
    pub of: Option<BodyRef>,
    /// Metres.
    pub offset: [E; 3],
    /// Boxes that the point is then brought into, one after the other: the lower and the upper corner of each.
    #[serde(default = "Vec::new", skip_serializing_if = "Vec::is_empty")]
    pub within: Vec<[WorldPoint<E>; 2]>,
}

impl<E> WorldPoint<E> {
    /// A point that no box limits.
    #[must_use]
    pub fn free(of: Option<BodyRef>, offset: [E; 3]) -> Self {
        Self { of, offset, within: Vec::new() }
    }

    pub(crate) fn lower(&self, f: &dyn Fn(&E) -> Expr) -> WorldPoint {
        let within = self.within.iter().map(|corners| corners.each_ref().map(|at| at.lower(f))).collect();
        WorldPoint { of: self.of, offset: self.offset.each_ref().map(f), within }
    }
}
