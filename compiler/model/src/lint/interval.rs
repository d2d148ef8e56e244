//! What an expression can be, and what a condition leaves of its variables, as intervals of whole numbers.

use crate::{
    BinaryOp, InferredType, NumberFunction, TypedExpr, TypedExprKind, UnaryOp, VariableRef,
    expr::ComparisonOp,
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
        if let TypedExprKind::Unary(UnaryOp::Not, a) = &e.kind {
            return self.narrow(a, !want);
        }
        let TypedExprKind::Binary(op, a, b) = &e.kind else {
            return self.leave(e, ValueInterval::bool(Some(want)));
        };
        match (op, want) {
            (BinaryOp::And, true) | (BinaryOp::Or, false) => self.narrow(a, want) && self.narrow(b, want),
            (BinaryOp::Or, true) | (BinaryOp::And, false) => {
                let (mut left, mut right) = (self.clone(), self.clone());
                match (left.narrow(a, want), right.narrow(b, want)) {
                    (true, true) => self.less = left.or(&right).less,
                    (true, false) => self.less = left.less,
                    (false, true) => self.less = right.less,
                    (false, false) => return false,
                }
                true
            }
            (op, _) => ComparisonOp::of(*op).is_none_or(|op| self.narrow_comparison(op, a, b, want)),
        }
    }

    fn narrow_comparison(&mut self, op: ComparisonOp, a: &TypedExpr, b: &TypedExpr, want: bool) -> bool {
        if matches!(a.ty, InferredType::Float(_)) || matches!(b.ty, InferredType::Float(_)) {
            return true;
        }
        let op = if want { op } else { op.negated() };
        let (x, y) = (self.eval(a), self.eval(b));
        let (left, right) = match op {
            ComparisonOp::Lt => (below(y.hi - 1), above(x.lo + 1)),
            ComparisonOp::Le => (below(y.hi), above(x.lo)),
            ComparisonOp::Gt => (above(y.lo + 1), below(x.hi - 1)),
            ComparisonOp::Ge => (above(y.lo), below(x.hi)),
            ComparisonOp::Eq => (y, x),
            ComparisonOp::Ne => (without(x, y), without(y, x)),
        };
        self.leave(a, left) && self.leave(b, right)
    }

    /// Leaves of an expression's variables what makes it lie in an interval, where that is easy to tell.
    fn leave(&mut self, e: &TypedExpr, into: ValueInterval) -> bool {
        let Some(into) = self.eval(e).meet(into) else { return false };
        if let TypedExprKind::Leaf(leaf) = &e.kind {
            self.set(*leaf, into);
        }
        if let TypedExprKind::Unary(UnaryOp::Neg, a) = &e.kind {
            return self.leave(a, ValueInterval { lo: -into.hi, hi: -into.lo });
        }
        let TypedExprKind::Binary(op, a, b) = &e.kind else { return true };
        self.terms.push((e.clone(), into));
        let (x, y) = (self.eval(a), self.eval(b));
        if *op == BinaryOp::Add {
            return self.leave(a, wide_sub(into, y)) && self.leave(b, wide_sub(into, x));
        }
        if *op == BinaryOp::Sub {
            let sum = ValueInterval { lo: into.lo + y.lo, hi: into.hi + y.hi };
            return self.leave(a, sum) && self.leave(b, wide_sub(x, into));
        }
        true
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

#[cfg(test)]
pub(super) mod tests;
