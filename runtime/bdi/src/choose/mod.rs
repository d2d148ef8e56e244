//! Belief-space exploration: which beliefs the agents of a test start with.
//!
//! [`factors`] turns a suite's choices into dimensions with finitely many alternatives each; [`explore`] picks points of
//! the space that they span, [`BeliefExplorer`] in batches, so that [`FactorLearner`] can learn from what they bring. Where choices have
//! conditions, [`BeliefExplorer::of`] keeps to what these allow, and [`allows`] says whether they allow a set.

mod allowed_rows;
mod construct;
mod cover;
mod explore;
mod factors;
mod fewer;
mod judge;
mod learn;
mod sets;
mod space;
mod tuples;
mod within;

pub use explore::{BeliefExplorer, ExploredBeliefs, explore};
pub use factors::{BeliefFactor, ChooseError, FactorAlternative, MAX_ALTERNATIVES, factors};
pub use judge::allows;
pub use learn::FactorLearner;
pub use sets::{BATCH, MAX_SETS};
pub use tuples::SetTuples;
