//! What decides where a figure's bodies are to be: as long as that is as it was, and they have come there, nobody need find it again.

use crate::math::{BodyFrame, SpaceVector};

/// All that a figure's posture is made of in a step.
#[derive(Clone, Debug)]
pub(super) struct FigureMoment {
    /// Its frame, without what pushes have done to it; and that: m.
    pub own: BodyFrame,
    pub pushed: SpaceVector,
    pub sway: SpaceVector,
    /// How far its trunk is from where it was to be, m.
    pub strayed: SpaceVector,
    /// Where its head is to be, and whether that is a place in the world.
    pub head: (bool, BodyFrame),
    /// The same of each limb; of legs none. And how far its end is from where it was to be, m.
    pub limbs: Vec<(Option<(bool, BodyFrame)>, SpaceVector)>,
}

impl FigureMoment {
    /// Whether it is the very same.
    pub fn is_same(&self, other: &FigureMoment) -> bool {
        let aims = |a: &(bool, BodyFrame), b: &(bool, BodyFrame)| a.0 == b.0 && a.1.is_same(&b.1);
        let limbs = self.limbs.iter().zip(&other.limbs).all(|((a, strayed), (b, other))| {
            strayed == other
                && match (a, b) {
                    (Some(a), Some(b)) => aims(a, b),
                    (None, None) => true,
                    (Some(_), None) | (None, Some(_)) => false,
                }
        });
        limbs
            && self.limbs.len() == other.limbs.len()
            && self.own.is_same(&other.own)
            && self.pushed == other.pushed
            && self.sway == other.sway
            && self.strayed == other.strayed
            && aims(&self.head, &other.head)
    }
}
