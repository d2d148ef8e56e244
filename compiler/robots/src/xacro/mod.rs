//! xacro: macros, properties and expressions of descriptions, expanded here, without Python.

mod evaluate;
mod expand;
mod functions;
mod include;
mod lex;
mod macros;
mod methods;
mod operate;
mod parameters;
mod parse;
mod property;
mod scope;
mod substitute;
mod syntax;
mod text;
mod value;
mod written;
mod yaml;

pub(crate) use expand::{XacroRequest, expand_xacro};
