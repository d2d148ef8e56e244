//! An interpreter of networks of automata by clock regions (Alur and Dill 1994), made from `spec/automata-semantics.md` alone.
//!
//! It shares nothing with the engine but the program form and the operators of expressions. Every state is made, so it is
//! for small networks: a clock is a whole number and the rank of its fraction among the fractions, which is exact.
#![allow(dead_code, unused_imports, reason = "each test binary uses its own part")]

pub mod data;
pub mod graph;
pub mod region;
pub mod steps;
pub mod text;

pub use graph::{Graph, Limits, explore};

use hrdsl_ir::expr::EvalError;

/// What is wrong with the model in a state that can be reached.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    /// An expression without a value.
    Value(EvalError),
    /// A variable leaves its range.
    Range { slot: usize, value: i64 },
    /// An argument is none of the parameter's values.
    Argument(usize),
    /// A clock becomes negative.
    Clock(usize),
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq)]
pub enum Stop {
    Fault(Fault),
    /// The network is not for this interpreter: why.
    Outside(String),
}

impl From<EvalError> for Stop {
    fn from(error: EvalError) -> Self {
        Stop::Fault(Fault::Value(error))
    }
}
