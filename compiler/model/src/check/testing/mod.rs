//! What is judged and how it is tested: requirements, coverage, suites, tests, the system under test.

mod coverage;
mod formula;
pub(super) mod phase;
mod requirement;
mod sentence;
mod suite;
mod suite_goals;
mod system;
mod test;
