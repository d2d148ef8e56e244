//! What became of a mutant.

use std::collections::BTreeMap;

use hrdsl_campaign::ListedMutant;
use hrdsl_results::{TestMethod, TestName};
use serde::{Deserialize, Serialize};

use crate::{difference::RunDifference, oracle::MutantOracle};

/// What became of a mutant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MutantFate {
    /// A test noticed it.
    Killed,
    /// Some run went another way, and no oracle minded.
    Survived,
    /// All runs went as the original's. It may do the same as the original always, or only in these tests.
    NotDistinguished,
    /// No test executes what it changes.
    NotReached,
    /// Its bytecode is the original's.
    Equivalent,
    /// Its bytecode is that of an earlier mutant.
    Duplicate,
    /// It does not compile.
    Invalid,
    /// The campaign was interrupted before it was known.
    NotRun,
}

/// A test that noticed a mutant.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct NoticedTest {
    pub test: TestName,
    /// In order; at least one.
    pub oracles: Vec<MutantOracle>,
    /// What broke the test off, if that noticed: its first line and its last.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    #[serde(skip)]
    pub method: TestMethod,
}

/// A requirement that holds in all runs of the original, and fails in a mutant's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProposedRequirement {
    /// As it is written after `require NAME KIND`.
    pub pattern: String,
    /// When it first fails in the mutant's run, in seconds.
    pub time: f64,
}

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
    /// Of one that survived: the place of that run's test among the tests, and its recording.
    pub other_run: Option<(usize, String)>,
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
            other_run: None,
            proposals: Vec::new(),
        }
    }
}
