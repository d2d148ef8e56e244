//! Agents: beliefs, goals, rules, plans and what they do.

pub(super) mod adoption;
pub(super) mod agent;
pub(super) mod context;
pub(super) mod internal;
pub(super) mod internal_table;
pub(super) mod message;
pub(super) mod phase;
pub(super) mod plan;
pub(super) mod rule;
pub(super) mod steps;
pub(super) mod terms;
pub(super) mod wanted;
