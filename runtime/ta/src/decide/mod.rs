//! What is asked of a network, decided: by the search for goals, with probes that look at its states, or by a walk of the zone graph.

pub(crate) mod answer;
mod cells;
mod chosen;
pub(crate) mod deadlock;
pub(crate) mod explore;
pub(crate) mod extremum;
pub(crate) mod fastest;
#[cfg(test)]
mod interpreter_tests;
mod known_states;
mod liveness;
mod places;
mod standing_bounds;
mod standing_delays;
mod standing_fastest;
mod standing_runs;
mod stopwatch;
pub(crate) mod unread;
mod unread_queries;
mod words;
mod zeno;
