//! One module for each command.

pub mod check;
pub mod emit;
pub mod generate;
pub mod sim;
