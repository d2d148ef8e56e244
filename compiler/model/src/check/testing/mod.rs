//! What is judged and how it is tested: requirements, coverage, suites, tests, the system under test.

pub(super) mod coverage;
pub(super) mod requirement;
pub(super) mod suite;
mod suite_goals;
pub(super) mod system;
pub(super) mod test;
