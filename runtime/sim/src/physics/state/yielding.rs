//! Surfaces that yield, and what is known of two that press on each other.

use crate::math::SpaceVector;

/// The speed after a blow, of that before: an assumption; peaks do not depend on it.
pub const RESTITUTION: f64 = 0.5;

/// A body that yields, and one that can move and may meet it.
pub struct YieldingPair {
    pub soft: usize,
    pub other: usize,
    /// N/m; of two bodies that yield, both springs in series.
    pub stiffness: f64,
    /// A hand does not press what it holds.
    pub is_suspended: bool,
    pub contact: Option<YieldingContact>,
}

/// Two surfaces that press on each other.
#[derive(Clone, Copy, Debug)]
pub struct YieldingContact {
    /// How deep the surface has been pressed in, m.
    pub deepest: f64,
    /// On the body that yields, of length 1.
    pub normal: SpaceVector,
    /// The greatest force in the last step, N; and the impulse over it, N·s.
    pub peak: f64,
    pub impulse: f64,
    /// For how long they have met, and for how long they have been apart since, s.
    pub age: f64,
    pub parted: f64,
}

impl YieldingContact {
    /// The force of a surface that is pressed in by so much, N.
    pub fn force_at(&self, depth: f64, stiffness: f64) -> f64 {
        let back = stiffness / (RESTITUTION * RESTITUTION);
        let dent = self.deepest * (1.0 - RESTITUTION * RESTITUTION);
        if depth >= self.deepest { stiffness * depth } else { (back * (depth - dent)).max(0.0) }
    }
}
