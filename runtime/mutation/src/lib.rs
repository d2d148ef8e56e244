//! Mutants of the code under test against its tests: which of them would be noticed, by which oracle, and what would notice the others.
//!
//! # Steps
//! 1. [`run_originals`] runs the tests on the code as it is: what each comes to, and which lines it reaches;
//! 2. [`MutationPlan::new`] says which mutants are worth a run, and which tests reach each;
//! 3. [`run_controls`] puts each file in its own place, which must change nothing, and [`run_sentinels`] lets each raise at once, which tests that
//!    measure anything notice;
//! 4. [`run_plan`] runs each mutant against the tests that reach it, until the first that notices it, or against all;
//! 5. [`propose`] looks for requirements that hold in all runs of the original and fail in a run of a mutant that survived, and
//!    tries each before it is proposed;
//! 6. [`add_up`] makes a [`MutationReport`](hrdsl_results::MutationReport) of it.
//!
//! [`ModelMutant`]s are of the models that play the system; [`RecordedRuns`] hold what the code did against them, and nothing is run.
//!
//! A mutant is run by one worker from its first test to its last, so that the number of workers changes nothing.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::wildcard_enum_match_arm))]

mod bounds;
mod candidates;
mod common;
mod contradict;
mod difference;
mod facts;
mod forms;
mod models;
mod oracle;
mod outcome;
mod plan;
mod propose;
mod report;
mod run;

pub use contradict::RecordedRuns;
pub use models::{MODEL_OPERATORS, ModelMutant};
pub use oracle::noticed_by;
pub use outcome::MutantOutcome;
pub use plan::{MutantSample, MutationPlan, PlannedMutant};
pub use propose::propose;
pub use report::add_up;
pub use run::{MutationCampaign, run_controls, run_originals, run_plan, run_sentinels};
