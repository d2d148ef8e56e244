//! YAML, as much as descriptions use: mappings, sequences, scalars, in blocks and in brackets.

mod block;
mod flow;
mod line;
mod scalar;
pub(crate) mod value;

pub(crate) use block::read_yaml;
