//! The search for goals: zones with one time for all automata, many goals at once, no state twice.

mod arrive;
pub(crate) mod batch;
mod counter_steps;
mod covering;
mod crew;
mod discrete;
pub(crate) mod expand;
pub(crate) mod goals;
mod hash_index;
pub(crate) mod monotone;
pub(crate) mod options;
pub(crate) mod probe;
mod reach_of_counter;
pub(crate) mod report;
pub(crate) mod round_search;
pub(crate) mod rounds;
pub(crate) mod slice;
pub(crate) mod start;
mod state_test;
mod stepper;
pub(crate) mod store;
pub(crate) mod threads;
pub(crate) mod waiting;
