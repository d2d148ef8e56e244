//! Questions that look at each symbolic state as a whole, beside the goals of a search.

use crate::{
    network::{error::ModelError, model::CompiledNetwork},
    zone::{
        dbm::{Dbm, DbmBound, DbmNumber},
        extrapolation::ActiveClocks,
    },
};

/// Looks at the symbolic states that a search expands: at all of them but those that another covers.
pub(crate) trait StateProbe: Sync {
    /// Calls `f` with each place of the state that it reads.
    fn each_place(&self, model: &CompiledNetwork, f: &mut dyn FnMut(u32));

    /// Whether anything can be found in some zone of the discrete state.
    ///
    /// # Errors
    /// If something has no value there.
    fn matters(&self, state: &[i64]) -> Result<bool, ModelError>;

    /// What is to be found in a symbolic state.
    ///
    /// # Errors
    /// If something has no value there.
    fn look(&self, at: &ProbedState, out: &mut Vec<ProbeFinding>) -> Result<(), ModelError>;
}

/// A symbolic state that is looked at.
pub(crate) struct ProbedState<'a> {
    pub node: u32,
    pub state: &'a [i64],
    pub frame: &'a ActiveClocks,
    /// Of the clocks of the frame, extrapolated.
    pub zone: &'a Dbm,
}

/// Something that was found in the symbolic state of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ProbeFinding {
    pub node: u32,
    /// Which of the questions it is an answer to.
    pub question: usize,
    pub value: ProbeValue,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ProbeValue {
    /// Some of its valuations meet the formula, at this [arrival](super::expand::arrival) if times are asked for.
    Met { arrival: i64 },
    /// A bound of the measure.
    Bound { value: i64, attained: bool },
    /// The measure is beyond what is told apart.
    Beyond,
    /// The measure grows for ever.
    ForEver,
}

/// The zone over all clocks, the reference included: of those that do not matter nothing is known.
pub(crate) fn spread(dim: usize, frame: &ActiveClocks, zone: &Dbm) -> Dbm {
    let mut all = Dbm::universe(dim);
    let mut there = vec![false; dim];
    frame.clocks.iter().for_each(|&x| there[usize::from(x)] = true);
    for (i, &x) in frame.clocks.iter().enumerate() {
        for (j, &y) in frame.clocks.iter().enumerate() {
            all.put(usize::from(x), usize::from(y), zone.at(i, j));
        }
        for y in (0..dim).filter(|&y| !there[y]) {
            all.put(usize::from(x), y, zone.at(i, 0));
        }
    }
    all
}

/// The zone in wide numbers.
pub(super) fn widened<N: DbmNumber>(zone: &Dbm<N>, out: &mut Dbm) {
    out.resize(zone.dim());
    for i in 0..zone.dim() {
        for j in 0..zone.dim() {
            let bound = if i == j { DbmBound::LE_ZERO } else { zone.at(i, j) };
            out.put(i, j, bound);
        }
    }
}
