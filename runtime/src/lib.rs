//! The runtime: from a [`Program`](hrdsl_ir::Program) to a report.
//!
//! # Steps
//!
//! 1. [`testgen::generate`] makes a suite's tests: by agents, by search, at random; [`testgen::write`] prints them;
//! 2. [`campaign::prepare`] installs what the code under test needs;
//! 3. [`campaign::Campaign::run`] runs the tests in parallel: each in a [`harness`] whose players make one
//!    [`Trace`](hrdsl_trace::Trace), which [`judge`] judges;
//! 4. [`tally`] adds up the tests to [`results`];
//! 5. [`report`] shows them: on a terminal, as JUnit XML, as a page.

pub mod campaign;
pub mod model_run;
pub mod prove;
pub mod reasoning;
mod tally;
pub mod testgen;

pub use hrdsl_harness as harness;
pub use hrdsl_judge as judge;
pub use hrdsl_report as report;
pub use hrdsl_results as results;
pub use tally::tally;
