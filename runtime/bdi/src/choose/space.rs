//! The part of a belief space that conditions allow.
//!
//! Factors that conditions tie together, directly or through others, are a *group*; whether a row is allowed is decided
//! for each group by itself, and all other factors are free. A group of few enough rows is gone through once, and what is
//! allowed of it kept; of a larger one a sample is.

use std::collections::BTreeMap;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::sets::{AlternativeRow, shuffle};

/// A group of at most so many rows is gone through.
pub(super) const MAX_ROWS: u128 = 1_000_000;
/// Rows that are drawn of a larger group.
const SAMPLE: usize = 1_000;
/// Attempts to find a row with given alternatives in a larger group.
const ATTEMPTS: usize = 32;
/// How probable it is that an attempt prefers the first alternative of a factor, by turns.
const ODDS: [f64; 4] = [0.0, 0.5, 0.9, 0.99];
/// Alternatives that one attempt tries, and that a search for the next row tries.
const NODES: u64 = 2_000;
const MAX_NODES: u64 = 20_000_000;
/// Answers of a condition that are remembered.
const MAX_MEMO: usize = 200_000;
/// Alternatives that all attempts try together before combinations are given up.
const EFFORT: u64 = 5_000_000;

/// Decides a condition by its number; only the alternatives of the factors in its scope are looked at.
pub(super) type ConditionOracle<'a> = Box<dyn FnMut(usize, &AlternativeRow) -> bool + 'a>;

struct ConditionClause {
    /// Upwards.
    scope: Vec<usize>,
    /// Answers by the alternatives of the scope.
    known: BTreeMap<AlternativeRow, bool>,
}

/// Factors that conditions tie together.
pub(super) struct TiedFactors {
    /// Upwards.
    pub factors: Vec<usize>,
    /// The allowed rows of these factors, one after the other; all of them, in lexicographic order, or a sample.
    rows: Vec<u16>,
    pub exact: bool,
    /// By factors of the group: which combinations of their alternatives are in `rows`, in lexicographic order.
    seen: BTreeMap<Vec<usize>, Vec<bool>>,
}

impl TiedFactors {
    pub fn len(&self) -> usize {
        self.rows.len() / self.factors.len().max(1)
    }

    pub fn row(&self, index: usize) -> &[u16] {
        &self.rows[index * self.factors.len()..(index + 1) * self.factors.len()]
    }

    /// The place of a factor within the group.
    pub fn place(&self, factor: usize) -> Option<usize> {
        self.factors.binary_search(&factor).ok()
    }

    /// The rows that begin like this, of an exact group.
    fn range(&self, prefix: &[u16]) -> std::ops::Range<usize> {
        let bound = |after: bool| {
            let (mut lo, mut hi) = (0, self.len());
            while lo < hi {
                let mid = (lo + hi) / 2;
                let is_before = match self.row(mid)[..prefix.len()].cmp(prefix) {
                    std::cmp::Ordering::Less => true,
                    std::cmp::Ordering::Equal => after,
                    std::cmp::Ordering::Greater => false,
                };
                if is_before { lo = mid + 1 } else { hi = mid }
            }
            lo
        };
        bound(false)..bound(true)
    }
}

/// What a search brought.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum NextRow {
    Row(AlternativeRow),
    /// There is none.
    End,
    /// The search took too long.
    Open,
}

/// The rows that all conditions allow.
pub(super) struct AllowedSpace<'a> {
    pub sizes: Vec<u32>,
    clauses: Vec<ConditionClause>,
    holds: ConditionOracle<'a>,
    pub groups: Vec<TiedFactors>,
    /// By factor: its group; none for a free one.
    pub group_of: Vec<Option<usize>>,
    /// By factor: the conditions that can be decided once it has an alternative, in the order of the factors.
    last: Vec<Vec<usize>>,
    /// A condition that depends on no choice does not hold.
    never: bool,
    /// What is left of [`EFFORT`].
    effort: u64,
    /// How often a group was drawn.
    draws: usize,
}

impl<'a> AllowedSpace<'a> {
    pub fn new(
        sizes: Vec<u32>,
        scopes: Vec<Vec<usize>>,
        holds: ConditionOracle<'a>,
        rng: &mut ChaCha8Rng,
    ) -> Self {
        Self::limited(sizes, scopes, holds, MAX_ROWS, rng)
    }

    /// With groups of more than so many rows taken as too large to go through.
    pub fn limited(
        sizes: Vec<u32>,
        scopes: Vec<Vec<usize>>,
        holds: ConditionOracle<'a>,
        max_rows: u128,
        rng: &mut ChaCha8Rng,
    ) -> Self {
        let mut last = vec![Vec::new(); sizes.len()];
        for (clause, scope) in scopes.iter().enumerate() {
            scope.last().iter().for_each(|f| last[**f].push(clause));
        }
        let (groups, group_of) = tied(&scopes, sizes.len());
        let clause = |scope| ConditionClause { scope, known: BTreeMap::new() };
        let clauses: Vec<ConditionClause> = scopes.into_iter().map(clause).collect();
        let mut space = Self {
            sizes,
            clauses,
            holds,
            groups: Vec::new(),
            group_of,
            last,
            never: false,
            effort: EFFORT,
            draws: 0,
        };
        let start = vec![0; space.sizes.len()];
        let constant: Vec<usize> =
            (0..space.clauses.len()).filter(|c| space.clauses[*c].scope.is_empty()).collect();
        space.never = !constant.into_iter().all(|c| (space.holds)(c, &start));
        for factors in groups {
            let group = space.group(factors, max_rows, rng);
            space.groups.push(group);
        }
        space
    }

    fn group(&mut self, factors: Vec<usize>, max_rows: u128, rng: &mut ChaCha8Rng) -> TiedFactors {
        let size = factors.iter().fold(1u128, |n, f| n.saturating_mul(u128::from(self.sizes[*f])));
        let exact = size <= max_rows;
        let mut group = TiedFactors { factors, rows: Vec::new(), exact, seen: BTreeMap::new() };
        if exact {
            let mut row = vec![0; self.sizes.len()];
            // INVARIANT: a search of a whole group tries fewer alternatives than twice its rows and more.
            let mut nodes = u64::MAX;
            while self.search(&group.factors, &mut row, &mut nodes) == Some(true) {
                group.rows.extend(group.factors.iter().map(|f| row[*f] as u16));
                let Some(end) = group.factors.last() else { break };
                row[*end] += 1;
            }
        } else {
            for attempt in 0..SAMPLE {
                if let Some(row) = self.attempt(&group.factors, &[], attempt, rng) {
                    group.rows.extend(row);
                }
            }
        }
        group
    }

    /// Whether every group was gone through.
    pub fn is_exact(&self) -> bool {
        self.groups.iter().all(|g| g.exact)
    }

    /// Whether the conditions of a group allow a row.
    pub fn allows(&mut self, group: usize, row: &AlternativeRow) -> bool {
        let of = &self.groups[group];
        if of.exact {
            let part: Vec<u16> = of.factors.iter().map(|f| row[*f] as u16).collect();
            return !of.range(&part).is_empty();
        }
        let clauses: Vec<usize> = of.factors.iter().flat_map(|f| self.last[*f].clone()).collect();
        clauses.into_iter().all(|clause| self.decide(clause, row))
    }

    /// How many rows are allowed, if that is known.
    pub fn allowed(&self) -> Option<u128> {
        if self.never || self.empty().is_some_and(|g| g.exact) {
            return Some(0);
        }
        let free = (0..self.sizes.len()).filter(|f| self.group_of[*f].is_none());
        let free = free.fold(1u128, |n, f| n.saturating_mul(u128::from(self.sizes[f])));
        let of = |n: u128, g: &TiedFactors| n.saturating_mul(g.len() as u128);
        self.is_exact().then(|| self.groups.iter().fold(free, of))
    }

    /// A group of which no row is known.
    pub fn empty(&self) -> Option<&TiedFactors> {
        self.groups.iter().find(|g| g.len() == 0)
    }

    fn decide(&mut self, clause: usize, row: &AlternativeRow) -> bool {
        let key: AlternativeRow = self.clauses[clause].scope.iter().map(|f| row[*f]).collect();
        if let Some(known) = self.clauses[clause].known.get(&key) {
            return *known;
        }
        let holds = (self.holds)(clause, row);
        let known = &mut self.clauses[clause].known;
        if known.len() < MAX_MEMO {
            known.insert(key, holds);
        }
        holds
    }

    /// Whether the alternatives up to this factor can stand, as far as is seen from them.
    fn stands(&mut self, factor: usize, row: &AlternativeRow) -> bool {
        if let Some(group) = self.group_of[factor].and_then(|g| self.groups.get(g)).filter(|g| g.exact) {
            let before = group.factors.iter().take_while(|f| **f <= factor);
            let prefix: Vec<u16> = before.map(|f| row[*f] as u16).collect();
            return !group.range(&prefix).is_empty();
        }
        (0..self.last[factor].len()).all(|i| self.decide(self.last[factor][i], row))
    }

    /// Goes to the first allowed row from this one on, in lexicographic order of the factors given; `Some(false)` if there
    /// is none, `None` if that takes too long.
    fn search(&mut self, factors: &[usize], row: &mut AlternativeRow, nodes: &mut u64) -> Option<bool> {
        let (mut depth, mut is_tight) = (0, true);
        while let Some(factor) = factors.get(depth).copied() {
            *nodes = nodes.checked_sub(1)?;
            if row[factor] >= self.sizes[factor] {
                row[factor] = 0;
                let Some(above) = depth.checked_sub(1) else { return Some(false) };
                depth = above;
            } else if self.stands(factor, row) {
                depth += 1;
                continue;
            }
            row[factors[depth]] += 1;
            // What comes after the first step starts anew; after later ones it has done so already.
            if std::mem::take(&mut is_tight) {
                factors[depth + 1..].iter().for_each(|f| row[*f] = 0);
            }
        }
        Some(true)
    }

    /// The first allowed row from this one on, in lexicographic order.
    pub fn next(&mut self, from: &AlternativeRow) -> NextRow {
        let (mut row, mut nodes) = (from.clone(), MAX_NODES);
        if self.never {
            return NextRow::End;
        }
        let all: Vec<usize> = (0..self.sizes.len()).collect();
        match self.search(&all, &mut row, &mut nodes) {
            Some(true) => NextRow::Row(row),
            Some(false) => NextRow::End,
            None => NextRow::Open,
        }
    }

    /// Tries to find a row of these factors with the given alternatives, at random. In turn the first alternatives of the
    /// factors are preferred never, or with odds of 1/2, 9/10 and 99/100: what is not held comes first, and conditions
    /// that few beliefs are held are common.
    fn attempt(
        &mut self,
        factors: &[usize],
        given: &[(usize, u32)],
        attempt: usize,
        rng: &mut ChaCha8Rng,
    ) -> Option<Vec<u16>> {
        let odds = ODDS[attempt % ODDS.len()];
        let orders: Vec<Vec<u32>> = factors
            .iter()
            .map(|factor| {
                if let Some((_, alternative)) = given.iter().find(|(f, _)| f == factor) {
                    return vec![*alternative];
                }
                let mut order: Vec<u32> = (0..self.sizes[*factor]).collect();
                shuffle(&mut order, rng);
                if rng.random_range(0.0..1.0) < odds
                    && let Some(first) = order.iter().position(|a| *a == 0)
                {
                    order.swap(0, first);
                }
                order
            })
            .collect();
        let mut row = vec![0; self.sizes.len()];
        let mut tried = vec![0; factors.len()];
        let mut depth = 0;
        for _ in 0..NODES {
            let Some(factor) = factors.get(depth).copied() else {
                return Some(factors.iter().map(|f| row[*f] as u16).collect());
            };
            self.effort = self.effort.saturating_sub(1);
            match orders[depth].get(tried[depth]) {
                Some(alternative) => {
                    tried[depth] += 1;
                    row[factor] = *alternative;
                    if self.stands(factor, &row) {
                        depth += 1;
                        tried.iter_mut().skip(depth).take(1).for_each(|t| *t = 0);
                    }
                }
                None => depth = depth.checked_sub(1)?,
            }
        }
        None
    }

    /// Which combinations of alternatives of these factors, all of one group, occur in its allowed rows; in
    /// lexicographic order. Those of a larger group that the sample does not have are looked for.
    pub fn seen(&mut self, group: usize, factors: &[usize], rng: &mut ChaCha8Rng) -> Vec<bool> {
        if let Some(seen) = self.groups[group].seen.get(factors) {
            return seen.clone();
        }
        let count: usize = factors.iter().map(|f| self.sizes[*f] as usize).product();
        let (mut seen, mut left) = (vec![false; count], count);
        let of = &self.groups[group];
        let places: Vec<usize> = factors.iter().filter_map(|f| of.place(*f)).collect();
        for row in (0..of.len()).map(|i| of.row(i)) {
            if left == 0 {
                break;
            }
            let at = (places.iter().zip(factors))
                .fold(0, |at, (p, f)| at * self.sizes[*f] as usize + usize::from(row[*p]));
            left -= usize::from(!std::mem::replace(&mut seen[at], true));
        }
        if !of.exact && left > 0 {
            self.look_for(group, factors, &mut seen, rng);
        }
        self.groups[group].seen.insert(factors.to_vec(), seen.clone());
        seen
    }

    fn look_for(&mut self, group: usize, factors: &[usize], seen: &mut [bool], rng: &mut ChaCha8Rng) {
        let all = self.groups[group].factors.clone();
        // What found the last one most often finds the next one, too.
        let mut lean = 0;
        for (at, seen) in seen.iter_mut().enumerate().filter(|(_, seen)| !**seen) {
            let mut given = Vec::new();
            let mut rest = at;
            for factor in factors.iter().rev() {
                let size = self.sizes[*factor] as usize;
                given.push((*factor, (rest % size) as u32));
                rest /= size;
            }
            for attempt in 0..ATTEMPTS {
                if self.effort == 0 {
                    return;
                }
                if let Some(row) = self.attempt(&all, &given, lean + attempt, rng) {
                    lean = (lean + attempt) % ODDS.len();
                    self.groups[group].rows.extend(row);
                    *seen = true;
                    break;
                }
            }
        }
    }

    /// An allowed row, drawn: first an alternative of each free factor, then a row of each group. Of a larger group it is
    /// the first that an attempt finds, and otherwise one of the sample.
    pub fn draw(&mut self, rng: &mut ChaCha8Rng) -> Option<AlternativeRow> {
        let mut row = vec![0; self.sizes.len()];
        for factor in (0..row.len()).filter(|f| self.group_of[*f].is_none()) {
            row[factor] = rng.random_range(0..self.sizes[factor]);
        }
        for at in 0..self.groups.len() {
            let group = &self.groups[at];
            let factors = group.factors.clone();
            let found = if group.exact { None } else { self.attempt(&factors, &[], self.draws, rng) };
            self.draws += 1;
            let group = &self.groups[at];
            let drawn = match found {
                Some(row) => row,
                None if group.len() == 0 => return None,
                None => group.row(rng.random_range(0..group.len() as u32) as usize).to_vec(),
            };
            factors.iter().zip(drawn).for_each(|(f, a)| row[*f] = u32::from(a));
        }
        (!self.never).then_some(row)
    }

    /// The alternatives that the next factor of a row that is begun can have; of a larger group as far as is seen.
    pub fn permitted(&mut self, begun: &[u32]) -> Vec<u32> {
        let factor = begun.len();
        let Some(group) = self.group_of[factor] else { return (0..self.sizes[factor]).collect() };
        let group = &self.groups[group];
        if group.exact {
            let before = group.factors.iter().take_while(|f| **f < factor);
            let mut prefix: Vec<u16> = before.map(|f| begun[*f] as u16).collect();
            let (place, end) = (prefix.len(), group.range(&prefix).end);
            let mut at = group.range(&prefix).start;
            let mut permitted = Vec::new();
            while at < end {
                let next = group.row(at)[place];
                permitted.push(u32::from(next));
                prefix.push(next);
                at = group.range(&prefix).end;
                prefix.pop();
            }
            return permitted;
        }
        let mut row = vec![0; self.sizes.len()];
        row[..factor].copy_from_slice(begun);
        let mut permitted = Vec::new();
        for alternative in 0..self.sizes[factor] {
            row[factor] = alternative;
            if self.stands(factor, &row) {
                permitted.push(alternative);
            }
        }
        permitted
    }
}

/// The groups of factors that scopes tie together, each upwards, in the order of their first factors.
fn tied(scopes: &[Vec<usize>], factors: usize) -> (Vec<Vec<usize>>, Vec<Option<usize>>) {
    // By factor: the first one that it is tied to.
    let mut first: Vec<usize> = (0..factors).collect();
    for scope in scopes {
        let joined: Vec<usize> = scope.iter().map(|f| first[*f]).collect();
        if let Some(least) = joined.iter().min().copied() {
            first.iter_mut().filter(|f| joined.contains(f)).for_each(|f| *f = least);
        }
    }
    let (mut groups, mut group_of) = (Vec::<Vec<usize>>::new(), vec![None; factors]);
    for factor in 0..factors {
        if !scopes.iter().any(|s| s.contains(&factor)) {
            continue;
        }
        let there = group_of[first[factor]].filter(|_| first[factor] < factor);
        let group = there.unwrap_or(groups.len());
        groups.resize(groups.len().max(group + 1), Vec::new());
        groups[group].push(factor);
        group_of[factor] = Some(group);
    }
    (groups, group_of)
}
