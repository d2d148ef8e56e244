//! Bounds on differences of clocks, and the numbers in few bits that matrices keep of them.

use std::fmt;

/// An upper bound `< c` or `≤ c` on a difference of clocks, or none.
///
/// Packed as `2c` for `< c` and `2c + 1` for `≤ c`, so that the order of the packed numbers is the order of strength.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct DbmBound(i64);

impl DbmBound {
    /// No bound.
    pub const INFINITY: DbmBound = DbmBound(i64::MAX);
    /// `≤ 0`
    pub const LE_ZERO: DbmBound = DbmBound(1);
    /// `< 0`
    pub const LT_ZERO: DbmBound = DbmBound(0);

    /// `≤ c`; `c` must be within ±2⁶⁰.
    #[must_use]
    pub fn le(c: i64) -> Self {
        DbmBound(2 * c + 1)
    }

    /// `< c`; `c` must be within ±2⁶⁰.
    #[must_use]
    pub fn lt(c: i64) -> Self {
        DbmBound(2 * c)
    }

    #[must_use]
    pub fn is_infinite(self) -> bool {
        self == DbmBound::INFINITY
    }

    /// The number; meaningless for no bound.
    #[must_use]
    pub fn value(self) -> i64 {
        self.0 >> 1
    }

    #[must_use]
    pub fn is_strict(self) -> bool {
        self.0 & 1 == 0
    }

    /// The bound of a sum of two bounded differences.
    #[must_use]
    pub fn plus(self, other: DbmBound) -> DbmBound {
        if self.is_infinite() || other.is_infinite() {
            DbmBound::INFINITY
        } else {
            DbmBound(self.0 + other.0 - ((self.0 | other.0) & 1))
        }
    }

    /// `x - y ≺ c` fails exactly if `y - x` keeps the negated bound. Not for no bound.
    #[must_use]
    pub fn negated(self) -> DbmBound {
        DbmBound(1 - self.0)
    }
}

impl fmt::Debug for DbmBound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_infinite() {
            f.write_str("<inf")
        } else {
            write!(f, "{}{}", if self.is_strict() { "<" } else { "<=" }, self.value())
        }
    }
}

/// A bound as matrices keep it: [`DbmBound`]'s packed number in few bits, with the greatest number for no bound.
///
/// INVARIANT: numbers stay so small that the sum of three bounds does not overflow: who chooses the width sees to it.
pub trait DbmNumber:
    Copy + Ord + Default + fmt::Debug + std::hash::Hash + Send + Sync + Into<i64> + 'static
{
    const INFINITY: Self;
    /// `≤ 0`
    const LE_ZERO: Self;
    /// Less than all bounds.
    const LEAST: Self;
    /// How many of them are worked on at once.
    const LANES: usize;

    /// The bound must be within the width.
    fn of(bound: DbmBound) -> Self;

    fn bound(self) -> DbmBound {
        if self == Self::INFINITY { DbmBound::INFINITY } else { DbmBound(self.into()) }
    }

    /// The sum of bounds.
    fn plus(self, other: Self) -> Self;

    /// The bound with a number of units more; not for no bound.
    fn shifted(self, units: i64) -> Self;

    /// `row[l] = min(row[l], to + through[l])`; `to` must be a bound, and both whole lanes.
    fn relax(row: &mut [Self], to: Self, through: &[Self]);

    /// What is added to a bound, and which of that one's bits count, in the sum with this bound.
    fn addend(self) -> (Self, Self);

    /// The least sum of `row[l]` and the bound whose addend is `base[l]`, `mask[l]`; without any, no bound. All are whole lanes.
    fn least_sum(row: &[Self], base: &[Self], mask: &[Self]) -> Self;

    /// Pushes the least of `row[l]`, `column[l] + more` and `most[l]` for each `l`: none of the sums overflows.
    fn least_of(row: &[Self], column: &[Self], most: &[Self], more: Self, out: &mut Vec<Self>);

    /// Bounds above `most`, or above that of their column, are none afterwards. Returns whether any was lost. All are whole lanes.
    fn drop_above(row: &mut [Self], most: Self, columns: &[Self]) -> bool;

    /// As a word of a hash.
    fn word(self) -> u64 {
        let n: i64 = self.into();
        n as u64
    }
}

macro_rules! number {
    ($t:ty, $lanes:expr) => {
        impl DbmNumber for $t {
            const INFINITY: Self = <$t>::MAX;
            const LE_ZERO: Self = 1;
            const LEAST: Self = <$t>::MIN;
            const LANES: usize = $lanes;

            #[inline]
            fn of(bound: DbmBound) -> Self {
                if bound.is_infinite() { Self::INFINITY } else { bound.0 as $t }
            }

            #[inline]
            fn plus(self, other: Self) -> Self {
                if self == Self::INFINITY || other == Self::INFINITY {
                    Self::INFINITY
                } else {
                    self.wrapping_add(other).wrapping_sub((self | other) & 1)
                }
            }

            #[inline]
            fn shifted(self, units: i64) -> Self {
                self.wrapping_add((2 * units) as $t)
            }

            #[inline]
            fn addend(self) -> (Self, Self) {
                // The sum is strict if one of the two is; with no bound it is none.
                match (self == Self::INFINITY, self & 1) {
                    (true, _) => (self, 0),
                    (false, 0) => (self, !1),
                    (false, _) => (self & !1, !0),
                }
            }

            #[inline]
            fn drop_above(row: &mut [Self], most: Self, columns: &[Self]) -> bool {
                let mut lost = [false; $lanes];
                for (row, columns) in
                    row.as_chunks_mut::<$lanes>().0.iter_mut().zip(columns.as_chunks::<$lanes>().0)
                {
                    let gone: [bool; $lanes] =
                        std::array::from_fn(|l| (row[l] > most.min(columns[l])) & (row[l] != Self::INFINITY));
                    *row = std::array::from_fn(|l| if gone[l] { Self::INFINITY } else { row[l] });
                    lost = std::array::from_fn(|l| lost[l] | gone[l]);
                }
                lost.contains(&true)
            }

            #[inline]
            fn least_sum(row: &[Self], base: &[Self], mask: &[Self]) -> Self {
                // Rows are whole lanes: loops of a length that is known become instructions on vectors, without a rest.
                let (row, base, mask) =
                    (row.as_chunks::<$lanes>().0, base.as_chunks::<$lanes>().0, mask.as_chunks::<$lanes>().0);
                let mut least = [Self::INFINITY; $lanes];
                for ((row, base), mask) in row.iter().zip(base).zip(mask) {
                    let sum: [Self; $lanes] = std::array::from_fn(|l| base[l].wrapping_add(row[l] & mask[l]));
                    least = std::array::from_fn(|l| {
                        least[l].min(if row[l] == Self::INFINITY { row[l] } else { sum[l] })
                    });
                }
                least.into_iter().fold(Self::INFINITY, Self::min)
            }

            #[inline]
            fn least_of(row: &[Self], column: &[Self], most: &[Self], more: Self, out: &mut Vec<Self>) {
                let lines = row.iter().zip(column).zip(most);
                out.extend(lines.map(|((&b, &c), &m)| b.min(c.wrapping_add(more)).min(m)));
            }

            #[inline]
            fn relax(row: &mut [Self], to: Self, through: &[Self]) {
                let (base, mask) = to.addend();
                for (row, through) in
                    row.as_chunks_mut::<$lanes>().0.iter_mut().zip(through.as_chunks::<$lanes>().0)
                {
                    let sum: [Self; $lanes] = std::array::from_fn(|l| base.wrapping_add(through[l] & mask));
                    *row = std::array::from_fn(|l| {
                        row[l].min(if through[l] == Self::INFINITY { through[l] } else { sum[l] })
                    });
                }
            }
        }
    };
}

number!(i16, 8);
number!(i32, 4);
number!(i64, 2);
