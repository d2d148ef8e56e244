//! How far the engine strays from what cannot be: rigid bodies that are in each other, joints that are beyond their limits or come apart.
//!
//! The solver keeps all of it only nearly. The worst of a run is kept, so that whoever reads its results can see what they rest on. Surfaces
//! that yield are meant to be pressed in, and pairs that overlap by design never meet: neither counts.

/// Two bodies by number, and how deep they were in each other, m.
pub(crate) type PenetratingPair = (f64, usize, usize);

/// The worst of all steps so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct AccuracyWatch {
    /// Of two bodies of one robot, and of any two others.
    pub own: Option<PenetratingPair>,
    pub others: Option<PenetratingPair>,
    /// A joint, and how far it was beyond a limit, rad or m.
    pub beyond: Option<(f64, usize)>,
    /// A joint, and how far its two sides were apart, m.
    pub apart: Option<(f64, usize)>,
}

/// What is less is rounding, m.
const EXACT: f64 = 1e-5;

impl AccuracyWatch {
    /// Looks at two bodies that are so deep in each other, m, and are of one robot or not.
    pub fn look_at_depth(&mut self, depth: f64, (a, b): (usize, usize), is_own: bool) {
        let worst = if is_own { &mut self.own } else { &mut self.others };
        if worst.is_none_or(|(deepest, ..)| depth > deepest) {
            *worst = Some((depth, a.min(b), a.max(b)));
        }
    }

    /// Looks at one joint: where it is, and where it ends.
    pub fn look_at_joint(&mut self, joint: usize, at: f64, (lo, hi): (f64, f64)) {
        let by = (lo - at).max(at - hi);
        if by > 0.0 && self.beyond.is_none_or(|(worst, _)| by > worst) {
            self.beyond = Some((by, joint));
        }
    }

    /// Looks at how far the two sides of a joint are apart, m.
    pub fn look_at_gap(&mut self, joint: usize, apart: f64) {
        if apart > EXACT && self.apart.is_none_or(|(worst, _)| apart > worst) {
            self.apart = Some((apart, joint));
        }
    }
}
