//! The runtime: from a `Program` to a report.
//!
//! # Steps
//!
//! 1. [`testgen::generate`] makes a suite's tests: by agents, by search, at random; [`testgen::write`] prints them;
//! 2. [`campaign::prepare`] installs what the code under test needs;
//! 3. [`campaign::CampaignSetup::run`] runs the tests in parallel: each in a [`harness`] whose players make one
//!    `Trace`, which [`judge`] judges;
//! 4. [`judge::tally`] adds up the tests to [`results`];
//! 5. [`report`] shows them: on a terminal, as JUnit XML, as a page;
//! 6. [`recording`] keeps what could be seen of a run in a file, and [`viewer`] shows it on a page.
//!
//! Besides, [`prove`] asks the networks of automata themselves, and [`mutation`] asks the tests which faults of the code they would notice. Each of these is a crate, for a build that leaves out what it
//! does not need.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::wildcard_enum_match_arm))]

pub use hrdsl_campaign as campaign;
pub use hrdsl_conformance as conformance;
pub use hrdsl_harness as harness;
pub use hrdsl_judge as judge;
pub use hrdsl_mutation as mutation;
pub use hrdsl_prove as prove;
pub use hrdsl_recording as recording;
pub use hrdsl_report as report;
pub use hrdsl_results as results;
pub use hrdsl_testgen as testgen;
pub use hrdsl_viewer as viewer;
