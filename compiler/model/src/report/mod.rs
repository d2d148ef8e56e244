//! What the checker has to say: one function for each diagnostic, one file for each group of codes.

pub(crate) mod agents;
pub(crate) mod automata;
pub(crate) mod bindings;
pub(crate) mod coverage;
pub(crate) mod devices;
pub(crate) mod functions;
pub(crate) mod names;
pub(crate) mod queries;
pub(crate) mod requirements;
pub(crate) mod roles;
pub(crate) mod scenario_tests;
pub(crate) mod systems;
pub(crate) mod types;
pub(crate) mod world;
