//! What text and Program share word for word: the operators of expressions, the kinds of locations.

use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum UnaryOp {
    Not,
    Neg,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BinaryOp {
    Add,
    Sub,
    Mul,
    Div,
    Rem,
    Eq,
    Ne,
    Lt,
    Le,
    Gt,
    Ge,
    And,
    Or,
}

/// What sort of operator one is, by what it takes and gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OperatorSort {
    /// Numbers to a number.
    Arithmetic,
    /// Two values of any one type to a bool.
    Equality,
    /// Numbers to a bool.
    Order,
    /// Bools to a bool.
    Logic,
}

impl BinaryOp {
    #[must_use]
    pub fn sort(self) -> OperatorSort {
        match self {
            BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div | BinaryOp::Rem => {
                OperatorSort::Arithmetic
            }
            BinaryOp::Eq | BinaryOp::Ne => OperatorSort::Equality,
            BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge => OperatorSort::Order,
            BinaryOp::And | BinaryOp::Or => OperatorSort::Logic,
        }
    }
}

/// How time passes in a location of an automaton.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LocationKind {
    Normal,
    /// Time does not pass.
    Urgent,
    /// Time does not pass, and the next transition must involve a committed location.
    Committed,
}
