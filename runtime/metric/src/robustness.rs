//! Robustness: by how much a formula holds, and whether it does, in one number.

use std::{fmt, ops::Not};

/// By how much a formula holds at a moment. The number is positive where it holds, and negative where it does not; at zero the sign of the zero
/// tells: `x < 3` at 3 is −0, `x <= 3` is +0. So satisfaction is never lost beside the number.
///
/// It is kept as the place of the number among all floats ([`f64::total_cmp`]), an integer: the lesser of two is one comparison, and the
/// opposite is the complement of all bits.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Robustness(i64);

const MAGNITUDE: i64 = i64::MAX;

impl Robustness {
    /// What always holds.
    pub const TRUE: Self = Self::of_bits(f64::INFINITY.to_bits());
    /// What never holds.
    pub const FALSE: Self = Self::of_bits(f64::NEG_INFINITY.to_bits());

    const fn of_bits(bits: u64) -> Self {
        let bits = bits.cast_signed();
        Self(bits ^ ((bits >> 63) & MAGNITUDE))
    }

    /// The robustness of `0 < value` if `strict`, otherwise that of `0 <= value`. `None`: the value is no number.
    #[inline]
    #[must_use]
    pub fn of(value: f64, strict: bool) -> Option<Self> {
        if value.is_nan() {
            return None;
        }
        // Adding zero makes one zero of both.
        let known = Self::of_bits((value + 0.0).to_bits());
        Some(if strict && value == 0.0 { !known } else { known })
    }

    #[inline]
    #[must_use]
    pub fn of_truth(truth: bool) -> Self {
        if truth { Self::TRUE } else { Self::FALSE }
    }

    #[inline]
    #[must_use]
    pub fn holds(self) -> bool {
        self.0 >= 0
    }

    /// The number, with the sign of its zero.
    #[must_use]
    pub fn number(self) -> f64 {
        f64::from_bits((self.0 ^ ((self.0 >> 63) & MAGNITUDE)).cast_unsigned())
    }

    /// The complement if `mask` is −1, the same if it is 0.
    #[inline]
    pub(crate) fn masked(self, mask: i64) -> Self {
        Self(self.0 ^ mask)
    }
}

impl Not for Robustness {
    type Output = Self;

    #[inline]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl fmt::Debug for Robustness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.number())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_and_opposite_are_those_of_the_numbers() {
        let numbers = [f64::NEG_INFINITY, -2.5, -1e-300, -0.0, 0.0, 5e-324, 1.0, f64::MAX, f64::INFINITY];
        let place = |x: f64| Robustness::of_bits(x.to_bits());
        for pair in numbers.windows(2) {
            assert!(place(pair[0]) < place(pair[1]), "{pair:?}");
        }
        for x in numbers {
            assert_eq!(place(x).number().to_bits(), x.to_bits());
            assert_eq!((!place(x)).number().to_bits(), (-x).to_bits());
            assert_eq!(place(x).holds(), x.is_sign_positive());
        }
    }

    #[test]
    fn zero_remembers_whether_it_holds() {
        for zero in [0.0, -0.0] {
            assert!(!Robustness::of(zero, true).unwrap().holds(), "0 < 0");
            assert!(Robustness::of(zero, false).unwrap().holds(), "0 <= 0");
            assert!((!Robustness::of(zero, true).unwrap()).holds(), "not 0 < 0");
        }
        assert_eq!(Robustness::of(f64::NAN, true), None);
        assert_eq!(Robustness::of(f64::INFINITY, true), Some(Robustness::TRUE));
    }
}
