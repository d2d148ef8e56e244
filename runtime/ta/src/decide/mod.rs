//! What is asked of a network, decided: by the searches for goals, or by walks of the zone graph where these do not suffice.

pub(crate) mod answer;
mod cells;
pub(crate) mod deadlock;
pub(crate) mod explore;
pub(crate) mod extremum;
pub(crate) mod fastest;
#[cfg(test)]
mod interpreter_tests;
mod known_states;
mod liveness;
mod places;
