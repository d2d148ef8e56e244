//! What the checker knows, in small states: each is filled by one phase and read by those after it, or given to them.

pub(crate) mod function;
pub(crate) mod issues;
pub(crate) mod item;
pub(crate) mod names;
pub(crate) mod phase;
pub(crate) mod record;
pub(crate) mod robot;
pub(crate) mod scope;
pub(crate) mod solids;
pub(crate) mod table;
pub(crate) mod template;
pub(crate) mod world;
