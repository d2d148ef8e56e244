//! Surfaces that yield, and what is known of two that press on each other.

use std::{collections::BTreeMap, ops::Range};

use crate::math::SpaceVector;

/// The speed after a blow, of that before: an assumption; peaks do not depend on it.
pub const RESTITUTION: f64 = 0.5;

/// What lasts longer is quasi-static (ISO/TS 15066:2016, 5.5.4), s.
const TRANSIENT: f64 = 0.5;
/// For how long it counts what has held a body against a contact, s: what holds it in one part of a step, and not in the next, clamps it
/// all the same.
const REMEMBERED: f64 = 0.1;

/// A body that yields, and one that can move and may meet it.
pub struct YieldingPair {
    pub soft: usize,
    pub other: usize,
    /// N/m; of two bodies that yield, both springs in series.
    pub stiffness: f64,
    /// A hand does not press what it holds.
    pub is_suspended: bool,
}

/// Pairs that follow one another, and whose yielding bodies are of one figure, or one and the same: mostly nothing is near any of them.
pub struct YieldingGroup {
    figure: Option<usize>,
    pub pairs: Range<usize>,
    pub softs: Vec<usize>,
    pub others: Vec<usize>,
}

/// All such pairs, and those of them whose surfaces press on each other, or did of late.
#[derive(Default)]
pub struct YieldingPairs {
    pub pairs: Vec<YieldingPair>,
    pub groups: Vec<YieldingGroup>,
    /// By number of the pair.
    pub contacts: BTreeMap<usize, YieldingContact>,
}

impl YieldingPairs {
    /// Adds a pair whose yielding body is of a figure, or of none.
    pub fn add(&mut self, pair: YieldingPair, figure: Option<usize>) {
        let at = self.pairs.len();
        let is_same = |group: &&mut YieldingGroup| {
            group.softs.contains(&pair.soft) || (figure.is_some() && group.figure == figure)
        };
        if let Some(group) = self.groups.last_mut().filter(is_same) {
            group.pairs.end = at + 1;
            for (known, body) in [(&mut group.softs, pair.soft), (&mut group.others, pair.other)] {
                if !known.contains(&body) {
                    known.push(body);
                }
            }
        } else {
            let (softs, others) = (vec![pair.soft], vec![pair.other]);
            self.groups.push(YieldingGroup { figure, pairs: at..at + 1, softs, others });
        }
        self.pairs.push(pair);
    }

    /// The pairs that are, or were of late, in contact, in order, each with its number.
    pub fn touching(&self) -> impl Iterator<Item = (usize, &YieldingPair, &YieldingContact)> + '_ {
        self.contacts.iter().map(|(at, contact)| (*at, &self.pairs[*at], contact))
    }
}

/// Two surfaces that press on each other.
#[derive(Clone, Copy, Debug)]
pub struct YieldingContact {
    /// How deep the surface has been pressed in, m.
    pub deepest: f64,
    /// On the body that yields, of length 1.
    pub normal: SpaceVector,
    /// The force in the last part of a step, N; the greatest in the last step while the contact was transient, and quasi-static; and the
    /// impulse over the step, N·s.
    pub force: f64,
    pub peaks: [f64; 2],
    pub impulse: f64,
    /// What it has pushed of late, and what else has held the body against it meanwhile, N·s.
    pub pushed: f64,
    pub held: f64,
    /// For how long they have met, and for how long they have been apart since, s.
    pub age: f64,
    pub parted: f64,
}

impl YieldingContact {
    pub fn new(normal: SpaceVector) -> Self {
        let (peaks, zero) = ([0.0; 2], 0.0);
        YieldingContact {
            deepest: zero,
            normal,
            force: zero,
            peaks,
            impulse: zero,
            pushed: zero,
            held: zero,
            age: zero,
            parted: zero,
        }
    }

    /// The greatest force in the last step, N.
    pub fn peak(&self) -> f64 {
        self.peaks[0].max(self.peaks[1])
    }

    /// A part of a step in which something else held the body against the contact with so much, N.
    pub fn note(&mut self, against: f64, h: f64) {
        let kept = (1.0 - h / REMEMBERED).max(0.0);
        self.pushed = self.pushed * kept + self.force * h;
        self.held = self.held * kept + against.min(self.force) * h;
        let is_clamped = self.held > self.pushed / 2.0;
        let peak = &mut self.peaks[usize::from(self.age > TRANSIENT || is_clamped)];
        *peak = peak.max(self.force);
    }

    /// The force of a surface that is pressed in by so much, N.
    pub fn force_at(&self, depth: f64, stiffness: f64) -> f64 {
        let back = stiffness / (RESTITUTION * RESTITUTION);
        let dent = self.deepest * (1.0 - RESTITUTION * RESTITUTION);
        if depth >= self.deepest { stiffness * depth } else { (back * (depth - dent)).max(0.0) }
    }
}
