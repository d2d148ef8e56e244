//! Linear programs in whole numbers, solved exactly: least and greatest values of a sum under bounds on sums.
//!
//! The simplex method with a tableau of whole numbers over one common denominator, which is the determinant of the basis
//! (Edmonds 1967, Bareiss 1968: the divisions leave no remainder), and Bland's rule (1977), which never goes round in a circle. What
//! does not fit into 128 bits is an error, never a rounded number.

/// `Σ factors · x ≤ most`, with a factor for each variable.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LinearBound {
    pub factors: Vec<i128>,
    pub most: i128,
}

/// What is known of a program.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LinearSolution {
    /// No values of at least 0 keep all bounds.
    Infeasible,
    /// The sum has no greatest value.
    Unbounded,
    /// A vertex with the greatest value of the sum: each variable's numerator, over this denominator of at least 1.
    Vertex { values: Vec<i128>, over: i128 },
}

/// A number leaves 128 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LinearOverflow;

/// Rows `basic + Σ row · others = right`, all over `over`; the last row is that of the sum.
struct Tableau {
    rows: Vec<Vec<i128>>,
    /// By row: the variable in the basis.
    basis: Vec<usize>,
    over: i128,
}

/// The variables of at least 0 that keep the bounds and make `Σ goal · x` greatest.
///
/// # Errors
/// A number leaves 128 bits.
pub(crate) fn greatest(bounds: &[LinearBound], goal: &[i128]) -> Result<LinearSolution, LinearOverflow> {
    let count = goal.len();
    // Columns: the variables, a slack for each bound, the helper that makes all bounds keep at first, the right side.
    let helper = count + bounds.len();
    let width = helper + 2;
    let mut rows = Vec::with_capacity(bounds.len() + 1);
    for (i, bound) in bounds.iter().enumerate() {
        let mut row = vec![0; width];
        row[..count].copy_from_slice(&bound.factors);
        row[count + i] = 1;
        row[helper] = -1;
        row[width - 1] = bound.most;
        rows.push(row);
    }
    // First the least helper: minus it is greatest.
    let mut last = vec![0; width];
    last[helper] = 1;
    rows.push(last);
    let mut t = Tableau { rows, basis: (count..helper).collect(), over: 1 };
    let worst = (0..bounds.len()).min_by_key(|&i| bounds[i].most).filter(|&i| bounds[i].most < 0);
    if let Some(worst) = worst {
        t.pivot(worst, helper)?;
        t.climb(helper + 1)?;
        if t.rows[bounds.len()][width - 1] < 0 {
            return Ok(LinearSolution::Infeasible);
        }
        t.leave(helper)?;
    }
    // Then the sum that was asked for, without the helper.
    let mut last = vec![0; width];
    for (x, factor) in goal.iter().enumerate() {
        last[x] = factor.checked_neg().and_then(|f| f.checked_mul(t.over)).ok_or(LinearOverflow)?;
    }
    let end = bounds.len();
    t.rows[end] = last;
    for r in 0..end {
        t.clear(end, r)?;
    }
    if !t.climb(helper)? {
        return Ok(LinearSolution::Unbounded);
    }
    let mut values = vec![0; count];
    for (r, &x) in t.basis.iter().enumerate().filter(|(_, x)| **x < count) {
        values[x] = t.rows[r][width - 1];
    }
    Ok(LinearSolution::Vertex { values, over: t.over })
}

impl Tableau {
    /// Goes up until the sum is greatest, by columns before `columns`; `false`: it has no end.
    fn climb(&mut self, columns: usize) -> Result<bool, LinearOverflow> {
        let end = self.basis.len();
        loop {
            let Some(column) = (0..columns).find(|&c| self.rows[end][c] < 0) else { return Ok(true) };
            let Some(row) = self.blocking(column)? else { return Ok(false) };
            self.pivot(row, column)?;
        }
    }

    /// The row whose variable becomes 0 first, of those the one with the least number.
    fn blocking(&self, column: usize) -> Result<Option<usize>, LinearOverflow> {
        let mut best: Option<usize> = None;
        for r in (0..self.basis.len()).filter(|&r| self.rows[r][column] > 0) {
            let Some(b) = best else {
                best = Some(r);
                continue;
            };
            let right = |r: usize| self.rows[r].last().copied().unwrap_or(0);
            let mine = right(r).checked_mul(self.rows[b][column]).ok_or(LinearOverflow)?;
            let its = right(b).checked_mul(self.rows[r][column]).ok_or(LinearOverflow)?;
            if mine < its || (mine == its && self.basis[r] < self.basis[b]) {
                best = Some(r);
            }
        }
        Ok(best)
    }

    /// A variable of value 0 leaves the basis, if it is in it.
    fn leave(&mut self, variable: usize) -> Result<(), LinearOverflow> {
        let Some(row) = self.basis.iter().position(|&x| x == variable) else { return Ok(()) };
        match (0..variable).find(|&c| self.rows[row][c] != 0) {
            Some(column) => self.pivot(row, column),
            // INVARIANT: the row says 0 = 0, and never changes anything.
            None => Ok(()),
        }
    }

    fn pivot(&mut self, row: usize, column: usize) -> Result<(), LinearOverflow> {
        if self.rows[row][column] < 0 {
            // The denominator stays positive.
            self.rows[row].iter_mut().for_each(|n| *n = -*n);
        }
        let by = self.rows[row][column];
        let through = self.rows[row].clone();
        for (r, line) in self.rows.iter_mut().enumerate() {
            let factor = line[column];
            if r != row {
                combine(line, by, &through, factor, self.over)?;
            }
        }
        self.basis[row] = column;
        self.over = by;
        Ok(())
    }

    /// Takes the basic variable of a row out of another row, whose denominator is that of the tableau.
    fn clear(&mut self, of: usize, row: usize) -> Result<(), LinearOverflow> {
        let factor = self.rows[of][self.basis[row]];
        let through = self.rows[row].clone();
        let over = self.over;
        combine(&mut self.rows[of], over, &through, factor, over)
    }
}

/// `line = (line · by - through · factor) / over`, without a remainder.
fn combine(
    line: &mut [i128],
    by: i128,
    through: &[i128],
    factor: i128,
    over: i128,
) -> Result<(), LinearOverflow> {
    for (n, t) in line.iter_mut().zip(through) {
        let (a, b) = (n.checked_mul(by), t.checked_mul(factor));
        let sum = a.zip(b).and_then(|(a, b)| a.checked_sub(b));
        *n = sum.ok_or(LinearOverflow)? / over;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn bound(factors: &[i128], most: i128) -> LinearBound {
        LinearBound { factors: factors.to_vec(), most }
    }

    #[test]
    fn a_vertex_may_be_a_fraction() {
        // 2x + y ≤ 4, x + 2y ≤ 5: x + y is greatest at (1, 2); 3x ≤ 2 moves it to (2/3, 13/6).
        let mut all = vec![bound(&[2, 1], 4), bound(&[1, 2], 5)];
        assert_eq!(greatest(&all, &[1, 1]), Ok(LinearSolution::Vertex { values: vec![3, 6], over: 3 }));
        all.push(bound(&[3, 0], 2));
        let Ok(LinearSolution::Vertex { values, over }) = greatest(&all, &[1, 1]) else { panic!() };
        assert_eq!((values[0] * 3, values[1] * 6), (2 * over, 13 * over));
    }

    #[test]
    fn no_end_and_no_beginning() {
        assert_eq!(greatest(&[bound(&[-1, 1], -2)], &[0, 1]), Ok(LinearSolution::Unbounded));
        assert_eq!(greatest(&[bound(&[1], -1)], &[0]), Ok(LinearSolution::Infeasible));
        assert_eq!(greatest(&[bound(&[1], 1), bound(&[-1], -2)], &[1]), Ok(LinearSolution::Infeasible));
        assert_eq!(greatest(&[], &[0]), Ok(LinearSolution::Vertex { values: vec![0], over: 1 }));
    }

    #[test]
    fn what_does_not_fit_is_said() {
        let huge = 1 << 100;
        let all = [bound(&[huge, 1], huge), bound(&[1, huge], huge)];
        assert_eq!(greatest(&all, &[1, 1]), Err(LinearOverflow));
    }

    proptest! {
        /// Against all points of a grid: with two variables and small bounds every vertex of integers is on it.
        #[test]
        fn it_agrees_with_a_grid(
            all in prop::collection::vec((-2i128..3, -2i128..3, -6i128..7), 0..6),
            goal in (-2i128..3, -2i128..3),
        ) {
            let mut bounds: Vec<LinearBound> = all.iter().map(|b| bound(&[b.0, b.1], b.2)).collect();
            bounds.push(bound(&[1, 0], 6));
            bounds.push(bound(&[0, 1], 6));
            // In sixtieths: determinants of two such rows are at most 8 and divide 840; the best of a finer grid is at most the vertex.
            let scale = 840;
            let keeps = |x: i128, y: i128| bounds.iter().all(|b| b.factors[0] * x + b.factors[1] * y <= b.most * scale);
            let solution = greatest(&bounds, &[goal.0, goal.1]).unwrap();
            let mut best: Option<i128> = None;
            for x in 0..=36 {
                for y in 0..=36 {
                    let (x, y) = (x * scale / 6, y * scale / 6);
                    if keeps(x, y) {
                        let sum = goal.0 * x + goal.1 * y;
                        best = Some(best.map_or(sum, |b| b.max(sum)));
                    }
                }
            }
            match solution {
                LinearSolution::Vertex { values, over } => {
                    let (x, y) = (values[0], values[1]);
                    prop_assert!(x >= 0 && y >= 0 && over >= 1);
                    for b in &bounds {
                        prop_assert!(b.factors[0] * x + b.factors[1] * y <= b.most * over);
                    }
                    let sum = (goal.0 * x + goal.1 * y) * scale;
                    prop_assert!(best.is_none_or(|best| best * over <= sum));
                }
                LinearSolution::Infeasible => prop_assert_eq!(best, None),
                LinearSolution::Unbounded => prop_assert!(false, "the box has an end"),
            }
        }
    }
}
