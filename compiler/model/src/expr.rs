//! Typed expressions: names resolved, units converted, constants folded, with the spans of the source.

use hrdsl_source::Span;
use serde::Serialize;

use crate::{FunctionId, InferredType, SignalId, SignalTerm, Type, Value};

pub use hrdsl_ir::expr::{BinaryOp, EvalError, NumberFunction, UnaryOp};

/// A typed expression.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TypedExpr {
    pub kind: TypedExprKind,
    pub ty: InferredType,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TypedExprKind {
    Const(Value),
    Leaf(VariableRef),
    /// A measurement of the world.
    Term(SignalTerm),
    Unary(UnaryOp, Box<TypedExpr>),
    Binary(BinaryOp, Box<TypedExpr>, Box<TypedExpr>),
    If(Box<TypedExpr>, Box<TypedExpr>, Box<TypedExpr>),
    Call(NumberFunction, Vec<TypedExpr>),
    /// `[a, b | rest]`
    List(Vec<TypedExpr>, Option<Box<TypedExpr>>),
    /// `a[i]`: an element of an array of variables that is chosen at run time. Automata only.
    Element(Box<TypedLvalue>),
    /// A function of automata, applied; with the type of its value.
    Apply(FunctionId, Vec<TypedExpr>, Type),
    /// Has a diagnostic.
    Error,
}

/// A variable, perhaps one that indices choose among several.
pub type TypedLvalue = hrdsl_ir::expr::Lvalue<TypedExpr, VariableRef>;
pub type TypedIndex = hrdsl_ir::expr::ArrayIndex<TypedExpr>;

/// All variables that an lvalue may stand for.
#[must_use]
pub fn leaves(place: &TypedLvalue) -> Vec<VariableRef> {
    let mut leaves = vec![place.slot];
    for index in &place.indices {
        let steps = |l: &VariableRef| {
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
pub enum VariableRef {
    /// A stimulus's parameters, then its samples; a plan's variables; an edge's selects, then what it binds.
    Local(u16),
    /// A variable of the automaton.
    Own(u16),
    /// A variable shared by all automata.
    Shared(u16),
    Signal(SignalId),
}

/// The operators that compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ComparisonOp {
    Eq,
    Ne,
    Lt,
    Le,
    Gt,
    Ge,
}

impl ComparisonOp {
    /// `None`: the operator compares nothing.
    pub fn of(op: BinaryOp) -> Option<Self> {
        match op {
            BinaryOp::Eq => Some(Self::Eq),
            BinaryOp::Ne => Some(Self::Ne),
            BinaryOp::Lt => Some(Self::Lt),
            BinaryOp::Le => Some(Self::Le),
            BinaryOp::Gt => Some(Self::Gt),
            BinaryOp::Ge => Some(Self::Ge),
            BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div | BinaryOp::Rem => None,
            BinaryOp::And | BinaryOp::Or => None,
        }
    }

    /// What holds where this does not.
    pub fn negated(self) -> Self {
        match self {
            Self::Eq => Self::Ne,
            Self::Ne => Self::Eq,
            Self::Lt => Self::Ge,
            Self::Le => Self::Gt,
            Self::Gt => Self::Le,
            Self::Ge => Self::Lt,
        }
    }

    /// The same with the sides exchanged.
    pub fn mirrored(self) -> Self {
        match self {
            Self::Eq => Self::Eq,
            Self::Ne => Self::Ne,
            Self::Lt => Self::Gt,
            Self::Le => Self::Ge,
            Self::Gt => Self::Lt,
            Self::Ge => Self::Le,
        }
    }
}

impl VariableRef {
    /// The variable so many places after it.
    #[must_use]
    pub fn plus(self, n: u16) -> Self {
        match self {
            VariableRef::Local(i) => VariableRef::Local(i.saturating_add(n)),
            VariableRef::Own(i) => VariableRef::Own(i.saturating_add(n)),
            VariableRef::Shared(i) => VariableRef::Shared(i.saturating_add(n)),
            VariableRef::Signal(_) => self,
        }
    }
}

impl TypedExpr {
    pub(crate) fn error(span: Span) -> Self {
        TypedExpr { kind: TypedExprKind::Error, ty: InferredType::Unknown, span }
    }

    pub(crate) fn value(value: Value, ty: InferredType, span: Span) -> Self {
        TypedExpr { kind: TypedExprKind::Const(value), ty, span }
    }

    /// The value, if it is a constant.
    #[must_use]
    pub fn constant(&self) -> Option<Value> {
        if let TypedExprKind::Const(value) = self.kind { Some(value) } else { None }
    }

    /// The value as at run time, with `vars` giving those of the variables; `None`: it has none, or it takes what is not known.
    /// `&&` and `||` are short-circuit: the right side may be unknown, or have no value, where the left one decides.
    pub(crate) fn value_with(&self, vars: &dyn Fn(VariableRef) -> Option<Value>) -> Option<Value> {
        match &self.kind {
            TypedExprKind::Const(value) => Some(*value),
            TypedExprKind::Leaf(leaf) => vars(*leaf),
            TypedExprKind::Unary(op, a) => hrdsl_ir::expr::unary(*op, a.value_with(vars)?).ok(),
            TypedExprKind::Binary(op @ (BinaryOp::And | BinaryOp::Or), a, b) => {
                let left = a.value_with(vars)?.as_bool()?;
                if left == (*op == BinaryOp::Or) { Some(Value::Bool(left)) } else { b.value_with(vars) }
            }
            TypedExprKind::Binary(op, a, b) => {
                hrdsl_ir::expr::binary(*op, a.value_with(vars)?, b.value_with(vars)?).ok()
            }
            TypedExprKind::If(c, a, b) => {
                let taken = if c.value_with(vars)?.as_bool()? { a } else { b };
                taken.value_with(vars)
            }
            TypedExprKind::Call(f, args) => {
                let args: Option<Vec<Value>> = args.iter().map(|a| a.value_with(vars)).collect();
                hrdsl_ir::expr::call(*f, &args?).ok()
            }
            // What only a run knows.
            TypedExprKind::Term(_)
            | TypedExprKind::List(..)
            | TypedExprKind::Element(_)
            | TypedExprKind::Apply(..)
            | TypedExprKind::Error => None,
        }
    }

    /// Calls `f` with each variable that the expression may read, as often as it occurs; without what functions read.
    pub fn each_leaf(&self, f: &mut dyn FnMut(VariableRef)) {
        self.each(&mut |e| {
            if let TypedExprKind::Leaf(leaf) = &e.kind {
                f(*leaf);
            } else if let TypedExprKind::Element(place) = &e.kind {
                leaves(place).into_iter().for_each(&mut *f);
            }
        });
    }

    /// Calls `f` with the expression and each part of it, the whole first.
    pub fn each(&self, f: &mut dyn FnMut(&TypedExpr)) {
        f(self);
        self.operands().into_iter().for_each(|operand| operand.each(f));
    }

    /// The expressions that it is made of.
    pub(crate) fn operands(&self) -> Vec<&TypedExpr> {
        match &self.kind {
            TypedExprKind::Const(_)
            | TypedExprKind::Leaf(_)
            | TypedExprKind::Term(_)
            | TypedExprKind::Error => Vec::new(),
            TypedExprKind::Unary(_, a) => vec![a],
            TypedExprKind::Binary(_, a, b) => vec![a, b],
            TypedExprKind::If(c, a, b) => vec![c, a, b],
            TypedExprKind::Call(_, args) | TypedExprKind::Apply(_, args, _) => args.iter().collect(),
            TypedExprKind::Element(place) => place.indices.iter().map(|i| &i.at).collect(),
            TypedExprKind::List(items, rest) => items.iter().chain(rest.as_deref()).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expr(kind: TypedExprKind, ty: InferredType) -> TypedExpr {
        TypedExpr { kind, ty, span: Span::default() }
    }

    fn both(op: BinaryOp, a: &TypedExpr, b: &TypedExpr) -> TypedExpr {
        expr(TypedExprKind::Binary(op, a.clone().into(), b.clone().into()), InferredType::Bool)
    }

    #[test]
    fn the_left_side_may_decide_alone() {
        let truth = |b| TypedExpr::value(Value::Bool(b), InferredType::Bool, Span::default());
        let (yes, no) = (truth(true), truth(false));
        let known = expr(TypedExprKind::Leaf(VariableRef::Local(0)), InferredType::Bool);
        let unknown = expr(TypedExprKind::Leaf(VariableRef::Local(1)), InferredType::Bool);
        let value = |op, a, b| {
            both(op, a, b).value_with(&|leaf| (leaf == VariableRef::Local(0)).then_some(Value::Bool(true)))
        };
        assert_eq!(value(BinaryOp::And, &no, &unknown), Some(Value::Bool(false)));
        assert_eq!(value(BinaryOp::Or, &known, &unknown), Some(Value::Bool(true)));
        assert_eq!(value(BinaryOp::And, &known, &yes), Some(Value::Bool(true)));
        assert_eq!(value(BinaryOp::Or, &no, &no), Some(Value::Bool(false)));
        // What stands on the left is looked at first, and may have no value.
        assert_eq!(value(BinaryOp::And, &unknown, &no), None);
        assert_eq!(value(BinaryOp::Or, &unknown, &yes), None);
        assert_eq!(value(BinaryOp::And, &yes, &unknown), None);
    }
}
