//! YAML, which maps and xacro's `load_yaml` read.

mod read;
mod scalar;
pub(crate) mod value;

pub(crate) use read::read_yaml;
