//! Intervals of whole numbers and their arithmetic. `bool` is 0 or 1.
//!
//! INVARIANT: an interval holds every value that the expression can have; an expression without a value (a division by
//! zero, a number beyond 64 bits) is a fault of its own and not in it.

use crate::{BinaryOp, Type, Value};

/// `lo..=hi`, not empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ValueInterval {
    pub lo: i128,
    pub hi: i128,
}

pub(crate) const MIN: i128 = i64::MIN as i128;
pub(crate) const MAX: i128 = i64::MAX as i128;

impl ValueInterval {
    /// Any whole number.
    pub const ALL: Self = Self { lo: MIN, hi: MAX };
    pub const NO: Self = Self { lo: 0, hi: 0 };
    pub const YES: Self = Self { lo: 1, hi: 1 };
    pub const MAYBE: Self = Self { lo: 0, hi: 1 };

    pub fn of(ty: Type) -> Self {
        match ty {
            Type::Bool => Self::MAYBE,
            Type::Int { lo, hi } => Self { lo: lo.into(), hi: hi.into() },
            Type::Float(_) | Type::Enum(_) | Type::Text | Type::List(_) => Self::ALL,
        }
    }

    pub fn value(value: Value) -> Self {
        match value {
            Value::Bool(b) => Self::bool(Some(b)),
            Value::Int(n) => Self { lo: n.into(), hi: n.into() },
            Value::Float(_) | Value::Symbol(_) | Value::Text(_) | Value::List(_) => Self::ALL,
        }
    }

    pub fn bool(b: Option<bool>) -> Self {
        match b {
            Some(true) => Self::YES,
            Some(false) => Self::NO,
            None => Self::MAYBE,
        }
    }

    /// The truth of a condition, if it is always the same.
    pub fn truth(self) -> Option<bool> {
        if self == Self::YES { Some(true) } else { (self == Self::NO).then_some(false) }
    }

    /// The smallest interval with these, cut to what 64 bits hold.
    fn around(corners: &[i128]) -> Self {
        let lo = corners.iter().copied().min().unwrap_or(MIN);
        let hi = corners.iter().copied().max().unwrap_or(MAX);
        Self { lo: lo.clamp(MIN, MAX), hi: hi.clamp(MIN, MAX) }
    }

    pub fn join(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// What is in both; `None`: nothing.
    pub fn meet(self, other: Self) -> Option<Self> {
        let both = Self { lo: self.lo.max(other.lo), hi: self.hi.min(other.hi) };
        (both.lo <= both.hi).then_some(both)
    }

    pub fn within(self, other: Self) -> bool {
        other.lo <= self.lo && self.hi <= other.hi
    }

    /// Nothing is known about one of its ends.
    pub fn is_open(self) -> bool {
        self.lo == MIN || self.hi == MAX
    }

    pub fn add(self, o: Self) -> Self {
        Self::around(&[self.lo + o.lo, self.hi + o.hi])
    }

    pub fn neg(self) -> Self {
        Self::around(&[-self.lo, -self.hi])
    }

    pub fn sub(self, o: Self) -> Self {
        self.add(Self { lo: -o.hi, hi: -o.lo })
    }

    pub fn mul(self, o: Self) -> Self {
        Self::around(&[self.lo * o.lo, self.lo * o.hi, self.hi * o.lo, self.hi * o.hi])
    }

    /// Towards zero; a divisor is at most -1 or at least 1.
    pub fn div(self, o: Self) -> Self {
        let mut corners = Vec::new();
        for divisors in [Self { lo: MIN, hi: -1 }, Self { lo: 1, hi: MAX }] {
            if let Some(d) = o.meet(divisors) {
                corners.extend([self.lo / d.lo, self.lo / d.hi, self.hi / d.lo, self.hi / d.hi]);
            }
        }
        Self::around(&corners)
    }

    /// The remainder has the sign of the dividend and is nearer to zero than the divisor.
    pub fn rem(self, o: Self) -> Self {
        let most = o.lo.abs().max(o.hi.abs()) - 1;
        if o.lo > 0 && self.lo >= 0 && self.hi < o.lo {
            return self;
        }
        if most < 0 {
            return Self::ALL;
        }
        let lo = if self.lo < 0 { self.lo.max(-most) } else { 0 };
        let hi = if self.hi > 0 { self.hi.min(most) } else { 0 };
        Self { lo, hi }
    }

    pub fn abs(self) -> Self {
        let far = Self::around(&[self.lo.abs(), self.hi.abs()]);
        if self.lo <= 0 && self.hi >= 0 { Self { lo: 0, hi: far.hi } } else { far }
    }

    /// Of the smaller of two.
    pub fn min(self, o: Self) -> Self {
        Self { lo: self.lo.min(o.lo), hi: self.hi.min(o.hi) }
    }

    /// Of the larger of two.
    pub fn max(self, o: Self) -> Self {
        Self { lo: self.lo.max(o.lo), hi: self.hi.max(o.hi) }
    }

    pub fn compare(self, op: BinaryOp, o: Self) -> Self {
        let single = self.lo == self.hi && self == o;
        Self::bool(match op {
            BinaryOp::Lt if self.hi < o.lo => Some(true),
            BinaryOp::Lt if self.lo >= o.hi => Some(false),
            BinaryOp::Le if self.hi <= o.lo => Some(true),
            BinaryOp::Le if self.lo > o.hi => Some(false),
            BinaryOp::Eq if single => Some(true),
            BinaryOp::Eq if self.meet(o).is_none() => Some(false),
            BinaryOp::Ne if single => Some(false),
            BinaryOp::Ne if self.meet(o).is_none() => Some(true),
            BinaryOp::Gt => return o.compare(BinaryOp::Lt, self),
            BinaryOp::Ge => return o.compare(BinaryOp::Le, self),
            BinaryOp::Lt | BinaryOp::Le | BinaryOp::Eq | BinaryOp::Ne => None,
            BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div | BinaryOp::Rem => {
                return Self::ALL;
            }
            BinaryOp::And | BinaryOp::Or => None,
        })
    }
}
