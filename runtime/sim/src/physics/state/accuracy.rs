//! How far the engine strays from what cannot be: rigid bodies that are in each other, joints that are beyond their limits or come apart.
//!
//! The solver keeps all of it only nearly. The worst of a run is kept, so that whoever reads its results can see what they rest on. Surfaces
//! that yield are meant to be pressed in, and pairs that overlap by design never meet: neither counts.

use rapier3d::prelude::*;

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
    /// Looks at all contacts as the last step began; `robots` gives for each body a number of what it is joined to. Gives the depth of
    /// the deepest, m.
    pub fn look_at_contacts(&mut self, world: &PhysicsWorld, robots: &[usize]) -> f64 {
        let mut depth_of_all: f64 = 0.0;
        for pair in world.contact_pairs() {
            let depth = |manifold: &ContactManifold| {
                manifold.points.iter().map(|point| -f64::from(point.dist)).fold(0.0, f64::max)
            };
            let deepest = pair.solver_manifolds().iter().map(depth).fold(0.0, f64::max);
            if deepest <= 0.0 {
                continue;
            }
            depth_of_all = depth_of_all.max(deepest);
            let number = |handle| {
                world.colliders.get(handle).and_then(|collider| usize::try_from(collider.user_data).ok())
            };
            let (Some(a), Some(b)) = (number(pair.collider1), number(pair.collider2)) else { continue };
            let worst = if robots.get(a) == robots.get(b) { &mut self.own } else { &mut self.others };
            if worst.is_none_or(|(depth, ..)| deepest > depth) {
                *worst = Some((deepest, a.min(b), a.max(b)));
            }
        }
        depth_of_all
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
