//! What an expression can be, and what a condition leaves of its variables, as intervals of whole numbers.

use crate::{
    BinaryOp, InferredType, NumberFunction, TypedExpr, TypedExprKind, UnaryOp, VariableRef,
    interval::{MAX, MIN, ValueInterval},
    leaves,
    lint::plan_terms::same,
};

/// The intervals of names: those given, as far as conditions have not left less of them.
#[derive(Clone, Debug)]
pub(crate) struct IntervalEnv<'a> {
    pub own: &'a [ValueInterval],
    pub shared: &'a [ValueInterval],
    pub signals: &'a [ValueInterval],
    pub locals: Vec<ValueInterval>,
    /// What is known to be less; few.
    pub less: Vec<(VariableRef, ValueInterval)>,
    /// Compound expressions that a condition speaks of, with what it leaves of them.
    terms: Vec<(TypedExpr, ValueInterval)>,
}

impl<'a> IntervalEnv<'a> {
    pub fn new(own: &'a [ValueInterval], shared: &'a [ValueInterval], locals: Vec<ValueInterval>) -> Self {
        Self { own, shared, signals: &[], locals, less: Vec::new(), terms: Vec::new() }
    }

    pub fn get(&self, leaf: VariableRef) -> ValueInterval {
        if let Some((_, known)) = self.less.iter().find(|(l, _)| *l == leaf) {
            return *known;
        }
        let (list, i): (&[ValueInterval], u16) = match leaf {
            VariableRef::Local(i) => (&self.locals, i),
            VariableRef::Own(i) => (self.own, i),
            VariableRef::Shared(i) => (self.shared, i),
            VariableRef::Signal(s) => (self.signals, s.0),
        };
        list.get(usize::from(i)).copied().unwrap_or(ValueInterval::ALL)
    }

    /// A variable has a new value.
    pub fn assign(&mut self, leaf: VariableRef, to: ValueInterval) {
        self.terms.clear();
        self.set(leaf, to);
    }

    /// Less is known to be possible of a name.
    pub fn set(&mut self, leaf: VariableRef, to: ValueInterval) {
        match self.less.iter_mut().find(|(l, _)| *l == leaf) {
            Some(known) => known.1 = to,
            None => self.less.push((leaf, to)),
        }
    }

    /// What is known if one of two holds.
    pub fn or(&self, other: &Self) -> Self {
        let known = self.less.iter().filter(|(leaf, _)| other.less.iter().any(|(l, _)| l == leaf));
        let less = known.map(|(leaf, i)| (*leaf, i.join(other.get(*leaf)))).collect();
        Self { less, ..self.clone() }
    }

    /// What an expression can be.
    pub fn eval(&self, e: &TypedExpr) -> ValueInterval {
        if !matches!(e.ty, InferredType::Bool | InferredType::Int | InferredType::Unknown) {
            return ValueInterval::ALL;
        }
        match &e.kind {
            TypedExprKind::Const(value) => ValueInterval::value(*value),
            TypedExprKind::Leaf(leaf) => self.get(*leaf),
            TypedExprKind::Element(place) => {
                let all = leaves(place).into_iter().map(|l| self.get(l));
                all.reduce(ValueInterval::join).unwrap_or(ValueInterval::ALL)
            }
            TypedExprKind::Apply(_, _, ty) => ValueInterval::of(*ty),
            TypedExprKind::Term(_) | TypedExprKind::Error if e.ty == InferredType::Bool => {
                ValueInterval::MAYBE
            }
            TypedExprKind::Term(_) | TypedExprKind::List(..) | TypedExprKind::Error => ValueInterval::ALL,
            TypedExprKind::Unary(UnaryOp::Neg, a) => self.eval(a).neg(),
            TypedExprKind::Unary(UnaryOp::Not, a) => ValueInterval::bool(self.truth(a).map(|b| !b)),
            TypedExprKind::Binary(op, a, b) => {
                let value = self.binary(*op, a, b);
                let known = self.terms.iter().rev().find(|(t, _)| same(t, e));
                known.and_then(|(_, k)| k.meet(value)).unwrap_or(value)
            }
            TypedExprKind::If(c, a, b) => {
                let side = |want: bool, e: &TypedExpr| {
                    let mut env = self.clone();
                    env.narrow(c, want).then(|| env.eval(e))
                };
                match (side(true, a), side(false, b)) {
                    (Some(a), Some(b)) => a.join(b),
                    (Some(one), None) | (None, Some(one)) => one,
                    (None, None) => ValueInterval::ALL,
                }
            }
            TypedExprKind::Call(f, args) => {
                let args: Vec<ValueInterval> = args.iter().map(|a| self.eval(a)).collect();
                match (f, args.as_slice()) {
                    (NumberFunction::Abs, [a]) => a.abs(),
                    (NumberFunction::Min, [a, b]) => a.min(*b),
                    (NumberFunction::Max, [a, b]) => a.max(*b),
                    (
                        NumberFunction::Abs
                        | NumberFunction::Min
                        | NumberFunction::Max
                        | NumberFunction::Norm,
                        _,
                    ) => ValueInterval::ALL,
                }
            }
        }
    }

    fn binary(&self, op: BinaryOp, a: &TypedExpr, b: &TypedExpr) -> ValueInterval {
        match op {
            BinaryOp::And => match (self.truth(a), self.truth(b)) {
                (Some(false), _) | (_, Some(false)) => ValueInterval::NO,
                (Some(true), Some(true)) => ValueInterval::YES,
                (Some(true) | None, _) => ValueInterval::MAYBE,
            },
            BinaryOp::Or => match (self.truth(a), self.truth(b)) {
                (Some(true), _) | (_, Some(true)) => ValueInterval::YES,
                (Some(false), Some(false)) => ValueInterval::NO,
                (Some(false) | None, _) => ValueInterval::MAYBE,
            },
            BinaryOp::Add => self.eval(a).add(self.eval(b)),
            BinaryOp::Sub => self.eval(a).sub(self.eval(b)),
            BinaryOp::Mul => self.eval(a).mul(self.eval(b)),
            BinaryOp::Div => self.eval(a).div(self.eval(b)),
            BinaryOp::Rem => self.eval(a).rem(self.eval(b)),
            BinaryOp::Eq | BinaryOp::Ne | BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge => {
                if matches!(a.ty, InferredType::Float(_)) || matches!(b.ty, InferredType::Float(_)) {
                    return ValueInterval::MAYBE;
                }
                self.eval(a).compare(op, self.eval(b))
            }
        }
    }

    /// The truth of a condition, if it is always the same.
    pub fn truth(&self, e: &TypedExpr) -> Option<bool> {
        self.eval(e).truth()
    }

    /// Leaves only what agrees with the condition's being `want`; `false`: nothing does.
    pub fn assume(&mut self, e: &TypedExpr, want: bool) -> bool {
        // The second time the first part of a conjunction knows what the others left.
        self.narrow(e, want) && self.narrow(e, want)
    }

    fn narrow(&mut self, e: &TypedExpr, want: bool) -> bool {
        match (&e.kind, want) {
            (TypedExprKind::Unary(UnaryOp::Not, a), _) => self.narrow(a, !want),
            (TypedExprKind::Binary(BinaryOp::And, a, b), true)
            | (TypedExprKind::Binary(BinaryOp::Or, a, b), false) => {
                self.narrow(a, want) && self.narrow(b, want)
            }
            (TypedExprKind::Binary(BinaryOp::Or, a, b), true)
            | (TypedExprKind::Binary(BinaryOp::And, a, b), false) => {
                let (mut left, mut right) = (self.clone(), self.clone());
                match (left.narrow(a, want), right.narrow(b, want)) {
                    (true, true) => self.less = left.or(&right).less,
                    (true, false) => self.less = left.less,
                    (false, true) => self.less = right.less,
                    (false, false) => return false,
                }
                true
            }
            (TypedExprKind::Binary(op, a, b), _) => self.narrow_comparison(*op, a, b, want),
            (
                TypedExprKind::Const(_)
                | TypedExprKind::Leaf(_)
                | TypedExprKind::Term(_)
                | TypedExprKind::Unary(UnaryOp::Neg, _)
                | TypedExprKind::If(..)
                | TypedExprKind::Call(..)
                | TypedExprKind::List(..)
                | TypedExprKind::Element(_)
                | TypedExprKind::Apply(..)
                | TypedExprKind::Error,
                _,
            ) => self.leave(e, ValueInterval::bool(Some(want))),
        }
    }

    fn narrow_comparison(&mut self, op: BinaryOp, a: &TypedExpr, b: &TypedExpr, want: bool) -> bool {
        if matches!(a.ty, InferredType::Float(_)) || matches!(b.ty, InferredType::Float(_)) {
            return true;
        }
        let op = if want { op } else { negated(op) };
        let (x, y) = (self.eval(a), self.eval(b));
        let (left, right) = match op {
            BinaryOp::Lt => (below(y.hi - 1), above(x.lo + 1)),
            BinaryOp::Le => (below(y.hi), above(x.lo)),
            BinaryOp::Gt => (above(y.lo + 1), below(x.hi - 1)),
            BinaryOp::Ge => (above(y.lo), below(x.hi)),
            BinaryOp::Eq => (y, x),
            BinaryOp::Ne => (without(x, y), without(y, x)),
            BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div => return true,
            BinaryOp::Rem | BinaryOp::And | BinaryOp::Or => return true,
        };
        self.leave(a, left) && self.leave(b, right)
    }

    /// Leaves of an expression's variables what makes it lie in an interval, where that is easy to tell.
    fn leave(&mut self, e: &TypedExpr, into: ValueInterval) -> bool {
        let Some(into) = self.eval(e).meet(into) else { return false };
        match &e.kind {
            TypedExprKind::Leaf(leaf) => {
                self.set(*leaf, into);
                true
            }
            TypedExprKind::Unary(UnaryOp::Neg, a) => {
                self.leave(a, ValueInterval { lo: -into.hi, hi: -into.lo })
            }
            TypedExprKind::Binary(op, a, b) => {
                self.terms.push((e.clone(), into));
                let (x, y) = (self.eval(a), self.eval(b));
                match op {
                    BinaryOp::Add => self.leave(a, wide_sub(into, y)) && self.leave(b, wide_sub(into, x)),
                    BinaryOp::Sub => {
                        let sum = ValueInterval { lo: into.lo + y.lo, hi: into.hi + y.hi };
                        self.leave(a, sum) && self.leave(b, wide_sub(x, into))
                    }
                    BinaryOp::Mul | BinaryOp::Div | BinaryOp::Rem | BinaryOp::And | BinaryOp::Or => true,
                    BinaryOp::Eq
                    | BinaryOp::Ne
                    | BinaryOp::Lt
                    | BinaryOp::Le
                    | BinaryOp::Gt
                    | BinaryOp::Ge => true,
                }
            }
            TypedExprKind::Const(_)
            | TypedExprKind::Term(_)
            | TypedExprKind::Unary(UnaryOp::Not, _)
            | TypedExprKind::If(..)
            | TypedExprKind::Call(..)
            | TypedExprKind::List(..)
            | TypedExprKind::Element(_)
            | TypedExprKind::Apply(..)
            | TypedExprKind::Error => true,
        }
    }
}

/// A difference that is not cut to 64 bits: it is only met with what is.
fn wide_sub(a: ValueInterval, b: ValueInterval) -> ValueInterval {
    ValueInterval { lo: a.lo - b.hi, hi: a.hi - b.lo }
}

fn below(hi: i128) -> ValueInterval {
    ValueInterval { lo: MIN - 1, hi }
}

fn above(lo: i128) -> ValueInterval {
    ValueInterval { lo, hi: MAX + 1 }
}

/// `x` without the one value that `y` is, if it is an end of `x`.
fn without(x: ValueInterval, y: ValueInterval) -> ValueInterval {
    if y.lo != y.hi {
        return x;
    }
    ValueInterval { lo: x.lo + i128::from(x.lo == y.lo), hi: x.hi - i128::from(x.hi == y.lo) }
}

fn negated(op: BinaryOp) -> BinaryOp {
    match op {
        BinaryOp::Eq => BinaryOp::Ne,
        BinaryOp::Ne => BinaryOp::Eq,
        BinaryOp::Lt => BinaryOp::Ge,
        BinaryOp::Le => BinaryOp::Gt,
        BinaryOp::Gt => BinaryOp::Le,
        BinaryOp::Ge => BinaryOp::Lt,
        BinaryOp::Add
        | BinaryOp::Sub
        | BinaryOp::Mul
        | BinaryOp::Div
        | BinaryOp::Rem
        | BinaryOp::And
        | BinaryOp::Or => op,
    }
}

#[cfg(test)]
pub(super) mod tests;
