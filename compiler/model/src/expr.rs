//! Typed expressions: names resolved, units converted, constants folded, with the spans of the source.

use hrdsl_source::Span;
use serde::Serialize;

use crate::{FunctionId, Kind, SignalId, Term, Type, Value};

pub use hrdsl_ir::expr::{BinaryOp, EvalError, Function as NumberFunction, UnaryOp};

/// A typed expression.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Expr {
    pub kind: ExprKind,
    pub ty: Kind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ExprKind {
    Const(Value),
    Leaf(Leaf),
    /// A measurement of the world.
    Term(Term),
    Unary(UnaryOp, Box<Expr>),
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    If(Box<Expr>, Box<Expr>, Box<Expr>),
    Call(NumberFunction, Vec<Expr>),
    /// `[a, b | rest]`
    List(Vec<Expr>, Option<Box<Expr>>),
    /// `a[i]`: an element of an array of variables that is chosen at run time. Automata only.
    Element(Box<Place>),
    /// A function of automata, applied; with the type of its value.
    Apply(FunctionId, Vec<Expr>, Type),
    /// Has a diagnostic.
    Error,
}

/// A variable, perhaps one that indices choose among several.
pub type Place = hrdsl_ir::expr::Place<Expr, Leaf>;
pub type Index = hrdsl_ir::expr::Index<Expr>;

/// All variables that an lvalue may stand for.
#[must_use]
pub fn leaves(place: &Place) -> Vec<Leaf> {
    let mut leaves = vec![place.slot];
    for index in &place.indices {
        let steps = |l: &Leaf| {
            let l = *l;
            (0..index.count).map(move |n| l.plus(n.saturating_mul(index.stride)))
        };
        leaves = leaves.iter().flat_map(steps).collect();
    }
    leaves
}

/// A name that has a value at run time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Leaf {
    /// A stimulus's parameters, then its samples; a plan's variables; an edge's selects, then what it binds.
    Local(u16),
    /// A variable of the automaton.
    Own(u16),
    /// A variable shared by all automata.
    Shared(u16),
    Signal(SignalId),
}

impl Leaf {
    /// The variable so many places after it.
    #[must_use]
    pub fn plus(self, n: u16) -> Self {
        match self {
            Leaf::Local(i) => Leaf::Local(i.saturating_add(n)),
            Leaf::Own(i) => Leaf::Own(i.saturating_add(n)),
            Leaf::Shared(i) => Leaf::Shared(i.saturating_add(n)),
            Leaf::Signal(_) => self,
        }
    }
}

impl Expr {
    pub(crate) fn error(span: Span) -> Self {
        Expr { kind: ExprKind::Error, ty: Kind::Unknown, span }
    }

    pub(crate) fn value(value: Value, ty: Kind, span: Span) -> Self {
        Expr { kind: ExprKind::Const(value), ty, span }
    }

    /// The value, if it is a constant.
    #[must_use]
    pub fn constant(&self) -> Option<Value> {
        match self.kind {
            ExprKind::Const(value) => Some(value),
            ExprKind::Leaf(_)
            | ExprKind::Term(_)
            | ExprKind::Unary(..)
            | ExprKind::Binary(..)
            | ExprKind::If(..)
            | ExprKind::Call(..)
            | ExprKind::List(..)
            | ExprKind::Element(_)
            | ExprKind::Apply(..)
            | ExprKind::Error => None,
        }
    }

    /// Calls `f` with each variable that the expression may read, as often as it occurs; without what functions read.
    pub fn each_leaf(&self, f: &mut dyn FnMut(Leaf)) {
        self.each(&mut |e| match &e.kind {
            ExprKind::Leaf(leaf) => f(*leaf),
            ExprKind::Element(place) => leaves(place).into_iter().for_each(&mut *f),
            ExprKind::Const(_)
            | ExprKind::Term(_)
            | ExprKind::Unary(..)
            | ExprKind::Binary(..)
            | ExprKind::If(..)
            | ExprKind::Call(..)
            | ExprKind::List(..)
            | ExprKind::Apply(..)
            | ExprKind::Error => {}
        });
    }

    /// Calls `f` with the expression and each part of it, the whole first.
    pub fn each(&self, f: &mut dyn FnMut(&Expr)) {
        f(self);
        match &self.kind {
            ExprKind::Const(_) | ExprKind::Leaf(_) | ExprKind::Term(_) | ExprKind::Error => {}
            ExprKind::Unary(_, a) => a.each(f),
            ExprKind::Binary(_, a, b) => {
                a.each(f);
                b.each(f);
            }
            ExprKind::If(c, a, b) => {
                c.each(f);
                a.each(f);
                b.each(f);
            }
            ExprKind::Call(_, args) | ExprKind::Apply(_, args, _) => args.iter().for_each(|a| a.each(f)),
            ExprKind::Element(place) => place.indices.iter().for_each(|i| i.at.each(f)),
            ExprKind::List(items, rest) => {
                items.iter().for_each(|e| e.each(f));
                rest.iter().for_each(|e| e.each(f));
            }
        }
    }
}
