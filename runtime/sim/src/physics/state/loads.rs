//! What rigid contacts did in the last step.

use std::collections::BTreeMap;

use crate::math::SpaceVector;

/// The mean force over the step on the second of each pair of bodies, N; its opposite is on the first, whose number is the lower one.
///
/// What floats add up to must not depend on the engine's own order: so pairs are in the order of their bodies.
#[derive(Clone, Debug, Default)]
pub struct ContactLoads {
    of: BTreeMap<(usize, usize), SpaceVector>,
}

impl ContactLoads {
    /// A force on `b` of `a`.
    pub fn add(&mut self, a: usize, b: usize, force: SpaceVector) {
        let (pair, force) = if a < b { ((a, b), force) } else { ((b, a), -force) };
        *self.of.entry(pair).or_insert_with(SpaceVector::zeros) += force;
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
            if holds(a, b) {
                self.of.entry((a, b)).or_insert(force);
            }
        }
    }

    /// Those that press on each other.
    pub fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.of.keys().copied()
    }

    /// The force on a body of each other.
    pub fn on(&self, body: usize) -> impl Iterator<Item = (usize, SpaceVector)> + '_ {
        self.of.iter().filter_map(move |((a, b), force)| {
            if *b == body { Some((*a, *force)) } else { (*a == body).then_some((*b, -force)) }
        })
    }
}
