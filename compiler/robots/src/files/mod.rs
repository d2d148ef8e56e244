//! Files: how they are reached, what paths mean, and where packages are.

pub(crate) mod address;
pub(crate) mod package;
pub(crate) mod path;
pub(crate) mod reader;
