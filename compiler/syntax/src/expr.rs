//! The abstract syntax tree of what every declaration is made of: names, texts, types and expressions.

use hrdsl_source::{BinaryOp, Span, UnaryOp};
use serde::Serialize;

/// An identifier where it was written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct NameSyntax {
    pub text: String,
    pub span: Span,
}

/// `a.b.c`
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PathSyntax {
    /// At least one.
    pub names: Vec<NameSyntax>,
    pub span: Span,
}

/// A string literal, without its quotes and with escapes resolved.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TextSyntax {
    pub text: String,
    pub span: Span,
}

/// `allow HR0107 "why"`
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct AllowSyntax {
    pub code: NameSyntax,
    pub reason: TextSyntax,
}

/// `bool`, `0..LEGS`, `length`, `Pose`, `bool[4]`, …; of a template's parameter also `event`, `actor`, `cover`, …
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TypeExpr {
    Named(NameSyntax),
    Range(ExprSyntax, ExprSyntax),
    /// `bool[4]`
    Array(Box<TypeExpr>, ExprSyntax),
    /// `[0..4]`: a list
    List(Box<TypeExpr>),
    /// Could not be read.
    Error,
}

/// `name: type`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParamSyntax {
    pub name: NameSyntax,
    pub ty: TypeExpr,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ExprSyntax {
    pub kind: ExprSyntaxKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ExprSyntaxKind {
    Bool(bool),
    Int(i64),
    Float(f64),
    /// `10 cm`: the number as written and the unit, not yet looked up.
    Quantity {
        number: f64,
        unit: NameSyntax,
    },
    /// `_`
    Any,
    /// A constant, variable, parameter, belief without arguments, or `person.hand.x`.
    Path(PathSyntax),
    /// `wants(M)`, `distance(person.hand, robot.palm)`, `abs(x)`
    Call {
        callee: PathSyntax,
        args: Vec<ExprSyntax>,
    },
    /// `a[i]`
    Index {
        of: Box<ExprSyntax>,
        index: Box<ExprSyntax>,
    },
    /// `a[i].x`
    Field {
        of: Box<ExprSyntax>,
        name: NameSyntax,
    },
    /// `not a` / `!a`, `-a`
    Unary {
        op: UnaryOp,
        operand: Box<ExprSyntax>,
    },
    Binary {
        op: BinaryOp,
        left: Box<ExprSyntax>,
        right: Box<ExprSyntax>,
    },
    /// `if c { a } else { b }`
    If {
        condition: Box<ExprSyntax>,
        then: Box<ExprSyntax>,
        otherwise: Box<ExprSyntax>,
    },
    /// `(a, b, c)`: a vector; always two or more
    Tuple(Vec<ExprSyntax>),
    /// `"leg"`
    Text(String),
    /// `[a, b | rest]`
    List {
        items: Vec<ExprSyntax>,
        rest: Option<Box<ExprSyntax>>,
    },
    /// `~b(X)`
    Strong(Box<ExprSyntax>),
    /// `b(X)[source(S), sure(9)]`. A single annotation of a name without arguments is an `Index`.
    Annotated {
        of: Box<ExprSyntax>,
        annotations: Vec<ExprSyntax>,
    },
    /// `.count(b(_), N)`
    Internal(CallSyntax),
    /// `X = e`
    Unify {
        left: Box<ExprSyntax>,
        right: Box<ExprSyntax>,
    },
    /// Could not be read.
    Error,
}

/// `name` or `name(args)`: an event, stimulus, belief or goal with arguments.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CallSyntax {
    pub name: NameSyntax,
    /// `None`: no parentheses were written.
    pub args: Option<Vec<ExprSyntax>>,
    pub span: Span,
}

/// A belief as it is matched or made: `~near(X)[source(S)]`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LiteralSyntax {
    /// `~`: strong negation
    pub negated: bool,
    pub call: CallSyntax,
    pub annotations: Vec<ExprSyntax>,
    pub span: Span,
}

/// `lo .. hi` or `lo ..`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RangeSyntax {
    pub lo: ExprSyntax,
    pub hi: Option<ExprSyntax>,
    pub span: Span,
}
