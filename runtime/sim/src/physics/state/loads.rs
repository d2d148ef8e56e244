//! What rigid contacts did in the last step.

use crate::math::SpaceVector;

/// The mean force over the step on the second of each pair of bodies, N; its opposite is on the first, whose number is the lower one.
///
/// What floats add up to must not depend on the engine's own order: so pairs are in the order of their bodies.
#[derive(Clone, Debug, Default)]
pub struct ContactLoads {
    of: Vec<((usize, usize), SpaceVector)>,
}

impl ContactLoads {
    /// A force on `b` of `a`.
    pub fn add(&mut self, a: usize, b: usize, force: SpaceVector) {
        let (pair, force) = if a < b { ((a, b), force) } else { ((b, a), -force) };
        let at = self.place(pair).unwrap_or_else(|at| {
            self.of.insert(at, (pair, SpaceVector::zeros()));
            at
        });
        self.of[at].1 += force;
    }

    /// Where a pair is, or would be.
    fn place(&self, pair: (usize, usize)) -> Result<usize, usize> {
        self.of.binary_search_by_key(&pair, |(known, _)| *known)
    }

    /// Adds those of a part of a step, which is so much of the step.
    pub fn add_part(&mut self, part: &ContactLoads, share: f64) {
        for ((a, b), force) in &part.of {
            self.add(*a, *b, force * share);
        }
    }

    /// What another step told of pairs that this one says nothing of, if it still holds.
    pub fn take_over(&mut self, before: ContactLoads, holds: impl Fn(usize, usize) -> bool) {
        for ((a, b), force) in before.of {
            if let Err(at) = self.place((a, b))
                && holds(a, b)
            {
                self.of.insert(at, ((a, b), force));
            }
        }
    }

    /// All pairs, in order, with the force on the second.
    pub fn pairs(&self) -> impl Iterator<Item = (usize, usize, SpaceVector)> + '_ {
        self.of.iter().map(|((a, b), force)| (*a, *b, *force))
    }

    /// The force on a body of each other.
    pub fn on(&self, body: usize) -> impl Iterator<Item = (usize, SpaceVector)> + '_ {
        self.of.iter().filter_map(move |((a, b), force)| {
            if *b == body { Some((*a, *force)) } else { (*a == body).then_some((*b, -force)) }
        })
    }
}
