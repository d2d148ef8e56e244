//! Expressions as trees.

use super::value::XacroValue;

#[derive(Clone, Debug)]
pub(super) enum XacroExpr {
    Value(XacroValue),
    Name(String),
    List(Vec<XacroExpr>),
    Tuple(Vec<XacroExpr>),
    Dict(Vec<(XacroExpr, XacroExpr)>),
    Not(Box<XacroExpr>),
    Negative(Box<XacroExpr>),
    Positive(Box<XacroExpr>),
    Binary(XacroArithmetic, Box<XacroExpr>, Box<XacroExpr>),
    /// `a < b <= c`
    Compare(Box<XacroExpr>, Vec<(XacroComparison, XacroExpr)>),
    And(Box<XacroExpr>, Box<XacroExpr>),
    Or(Box<XacroExpr>, Box<XacroExpr>),
    If {
        condition: Box<XacroExpr>,
        yes: Box<XacroExpr>,
        no: Box<XacroExpr>,
    },
    Index(Box<XacroExpr>, Box<XacroExpr>),
    Slice(Box<XacroExpr>, [Option<Box<XacroExpr>>; 3]),
    Attribute(Box<XacroExpr>, String),
    Call(Box<XacroExpr>, Vec<XacroExpr>),
    /// `[item for names in over if condition]`
    Each {
        item: Box<XacroExpr>,
        names: Vec<String>,
        over: Box<XacroExpr>,
        condition: Option<Box<XacroExpr>>,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum XacroArithmetic {
    Add,
    Subtract,
    Multiply,
    Divide,
    FloorDivide,
    Modulo,
    Power,
}

impl XacroArithmetic {
    pub fn sign(self) -> &'static str {
        match self {
            Self::Add => "+",
            Self::Subtract => "-",
            Self::Multiply => "*",
            Self::Divide => "/",
            Self::FloorDivide => "//",
            Self::Modulo => "%",
            Self::Power => "**",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum XacroComparison {
    Equal,
    NotEqual,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    In,
    NotIn,
    Is,
    IsNot,
}
