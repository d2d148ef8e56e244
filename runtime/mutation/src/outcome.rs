//! What became of a mutant.

use std::collections::BTreeMap;

use hrdsl_campaign::ListedMutant;
use hrdsl_results::{MutantFate, NoticedTest, ProposedRequirement, RunDifference, TestMethod};

/// A mutant with all that its runs came to.
#[derive(Clone, Debug)]
pub struct MutantOutcome {
    pub mutant: ListedMutant,
    pub fate: MutantFate,
    /// How many tests reach it.
    pub reached: usize,
    /// How many of them ran.
    pub ran: usize,
    /// In the order in which they ran: the first, or all of them if all were asked for.
    pub noticed: Vec<NoticedTest>,
    /// Seconds that its runs simulated, by the method of the test.
    pub simulated: BTreeMap<TestMethod, f64>,
    /// Of one that survived: where its first other run goes another way.
    pub difference: Option<RunDifference>,
    /// Of one that survived: its first runs that are not the original's, each with the place of its test among the tests, and its recording.
    pub other_runs: Vec<(usize, String)>,
    /// Of one that survived: requirements that would notice it, each tried.
    pub proposals: Vec<ProposedRequirement>,
}

impl MutantOutcome {
    /// One that no test has run yet.
    #[must_use]
    pub fn not_run(mutant: ListedMutant, fate: MutantFate, reached: usize) -> Self {
        Self {
            mutant,
            fate,
            reached,
            ran: 0,
            noticed: Vec::new(),
            simulated: BTreeMap::new(),
            difference: None,
            other_runs: Vec::new(),
            proposals: Vec::new(),
        }
    }
}
