//! Covering arrays that are known by construction: no search finds smaller ones where they fit exactly.
//!
//! - t + 1 factors: all rows of the t larger ones, and their sum (Bush, *Annals of Mathematical Statistics* 23(3), 1952, for
//!   factors of one size).
//! - q + 1 factors of q alternatives, q a prime power: polynomials over the field of q elements (Bush, the same).
//! - Pairs of more factors, q²−q rows for q times as many and one: Stevens and Mendelsohn, *Journal of Combinatorial Designs* 7(3),
//!   1999.
//! - Pairs of factors of two: Kleitman and Spencer, *Discrete Mathematics* 6(3), 1973; Katona, *Periodica Mathematica
//!   Hungarica* 3(1–2), 1973. They are optimal.
//!
//! Factors with fewer alternatives take the remainder: a pair that is to occur does so, since each remainder is of some alternative.

use super::{
    cover::next_group,
    sets::{AlternativeRow, row_at},
};

/// The constructions that fit, each of fewer than `limit` rows. Rows may occur twice if sizes differ.
pub(super) fn constructions(sizes: &[u32], strength: usize, limit: usize) -> Vec<Vec<AlternativeRow>> {
    let made = [
        sum_of_the_others(sizes, strength, limit),
        field_of(sizes).and_then(|field| field.array(sizes.len(), strength, limit)),
        binary(sizes, strength, limit),
    ];
    let fit = |mut rows: Vec<AlternativeRow>| {
        for row in &mut rows {
            row.truncate(sizes.len());
            row.iter_mut().zip(sizes).for_each(|(a, size)| *a %= size);
        }
        rows
    };
    made.into_iter().flatten().map(fit).collect()
}

/// One factor more than the strength: the smallest, the last of several, is the sum of the others, which take all rows.
fn sum_of_the_others(sizes: &[u32], strength: usize, limit: usize) -> Option<Vec<AlternativeRow>> {
    let smallest =
        (0..sizes.len()).rev().min_by_key(|f| sizes[*f]).filter(|_| sizes.len() == strength + 1)?;
    let mut others = sizes.to_vec();
    others.remove(smallest);
    let count = others.iter().try_fold(1usize, |n, size| n.checked_mul(*size as usize))?;
    let rows = (0..count as u128).map(|index| {
        let mut row = row_at(&others, index);
        row.insert(smallest, row.iter().sum::<u32>());
        row
    });
    (count < limit).then(|| rows.collect())
}

/// Pairs of factors of two: no row but the first has only zeros; each factor has a different half, or one more, of the others.
fn binary(sizes: &[u32], strength: usize, limit: usize) -> Option<Vec<AlternativeRow>> {
    if strength != 2 || sizes.iter().any(|size| *size > 2) {
        return None;
    }
    let fits = |n: &usize| {
        let half = n.div_ceil(2);
        // (n − 1 over half), up to where it is enough.
        let sets = (0..half).try_fold(1usize, |sets, i| sets.checked_mul(n - 1 - i).map(|s| s / (i + 1)));
        sets.is_none_or(|sets| sets >= sizes.len())
    };
    let count = (4..limit).find(fits)?;
    let mut rows = vec![AlternativeRow::new(); count];
    let mut ones: Vec<usize> = (0..count.div_ceil(2)).collect();
    for _ in sizes {
        // The first row, at 0, has zeros alone.
        rows.iter_mut()
            .zip(0..)
            .for_each(|(row, at)| row.push(u32::from(at > 0 && ones.contains(&(at - 1)))));
        next_group(&mut ones, count - 1);
    }
    Some(rows)
}

/// A finite field: its elements are numbers whose digits to the base of its characteristic are the coefficients of polynomials.
struct FiniteField {
    characteristic: u32,
    /// What x to the power of the degree is, from the constant on.
    reduction: Vec<u32>,
    /// How many elements it has.
    order: u32,
}

/// The field of prime order, of 4, 8, 9 or 16, with the least that is enough for the largest factor.
fn field_of(sizes: &[u32]) -> Option<FiniteField> {
    let largest = sizes.iter().copied().max().filter(|n| *n <= 1000)?;
    (largest.max(2)..).find_map(FiniteField::new)
}

impl FiniteField {
    fn new(order: u32) -> Option<Self> {
        let (characteristic, reduction) = match order {
            4 => (2, vec![1, 1]),
            8 => (2, vec![1, 1, 0]),
            9 => (3, vec![2, 0]),
            16 => (2, vec![1, 1, 0, 0]),
            _ if !(2..order).any(|d| order.is_multiple_of(d)) => (order, vec![0]),
            _ => return None,
        };
        Some(Self { characteristic, reduction, order })
    }

    fn digits(&self, number: u32) -> Vec<u32> {
        let mut rest = number;
        let digit = |_: &u32| {
            let digit = rest % self.characteristic;
            rest /= self.characteristic;
            digit
        };
        self.reduction.iter().map(digit).collect()
    }

    fn number(&self, digits: &[u32]) -> u32 {
        digits.iter().rev().fold(0, |n, digit| n * self.characteristic + digit % self.characteristic)
    }

    fn sum(&self, a: u32, b: u32) -> u32 {
        let digits: Vec<u32> = self.digits(a).iter().zip(self.digits(b)).map(|(a, b)| a + b).collect();
        self.number(&digits)
    }

    fn product(&self, a: u32, b: u32) -> u32 {
        let b = self.digits(b);
        let mut product = vec![0; b.len()];
        for digit in self.digits(a).into_iter().rev() {
            // The product so far, times x, and the digit's share.
            let top = product.pop().unwrap_or(0);
            product.insert(0, 0);
            for ((place, power), b) in product.iter_mut().zip(&self.reduction).zip(&b) {
                *place = (*place + top * power + digit * b) % self.characteristic;
            }
        }
        self.number(&product)
    }

    /// Rows for so many factors of as many alternatives as the field has elements.
    fn array(&self, factors: usize, strength: usize, limit: usize) -> Option<Vec<AlternativeRow>> {
        let order = self.order as usize;
        let count = order.checked_pow(u32::try_from(strength).ok()?).filter(|count| *count < limit)?;
        if strength > order || (strength > 2 && factors > order + 1) {
            return None;
        }
        // A row for each polynomial: its values, and its leading coefficient.
        let sizes = vec![self.order; strength];
        let values = |index| {
            let polynomial = row_at(&sizes, index);
            let at = |x| polynomial.iter().fold(0, |value, c| self.sum(self.product(value, x), *c));
            (0..self.order).map(at).chain(polynomial.first().copied()).collect()
        };
        let base: Vec<AlternativeRow> = (0..count as u128).map(values).collect();
        let (mut rows, mut columns) = (base.clone(), order + 1);
        while columns < factors {
            let more = &base[order..];
            if rows.len() + more.len() >= limit {
                return None;
            }
            // Each column as often as there are elements, and one of zeros: what is not yet covered are different
            // alternatives in the same column, which the rows of the base have that are no constants.
            for row in &mut rows {
                *row = row.iter().flat_map(|a| std::iter::repeat_n(*a, order)).chain([0]).collect();
            }
            rows.extend(more.iter().map(|row| {
                let again = std::iter::repeat_n(&row[..order], columns).flatten();
                again.chain(row.last()).copied().collect()
            }));
            columns = columns * order + 1;
        }
        Some(rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_fields() {
        for field in (2..=17).filter_map(FiniteField::new) {
            let n = field.order;
            for (a, b) in (0..n * n).map(|i| (i / n, i % n)) {
                assert_eq!(field.sum(a, b), field.sum(b, a));
                assert_eq!(field.product(a, b), field.product(b, a));
                let c = (a + 2 * b + 1) % n;
                let (left, right) =
                    (field.product(a, field.sum(b, c)), field.sum(field.product(a, b), field.product(a, c)));
                assert_eq!(left, right, "{n}");
                assert_eq!(field.product(a, field.product(b, c)), field.product(field.product(a, b), c));
            }
            for a in 1..n {
                assert_eq!((0..n).filter(|b| field.product(a, *b) == 1).count(), 1, "{n} {a}");
            }
        }
        let orders: Vec<u32> = (2..=17).filter(|n| FiniteField::new(*n).is_some()).collect();
        assert_eq!(orders, [2, 3, 4, 5, 7, 8, 9, 11, 13, 16, 17]);
    }
}
