//! HR0703: a bin of a cross that no combination of its points' bins meets. HR0704: two bins with the same combinations.

use std::collections::BTreeMap;

use hrdsl_source::{Diagnostic, DiagnosticCode};

use super::facts::ScenarioFacts;
use crate::{BinCondition, CoverCross, CoverpointId, CrossBin, Scenario};

/// Beyond so many combinations of points' bins nothing is said.
const COMBINATIONS: usize = 1 << 14;
/// And beyond so many evaluations of one cross.
const WORK: usize = 1 << 21;

/// HR0703
pub(crate) fn empty<'a>(scenario: &'a Scenario, _: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    for cross in &scenario.crosses {
        let Some(table) = BinTable::of(scenario, cross) else { continue };
        for (CrossBin { name, origin, .. }, set) in cross.bins.iter().zip(&table.bins) {
            let contradicts = !set.contains(&true);
            if contradicts {
                let message = format!("no test can fall into the bin `{name}`: its condition is never true");
                issues.push(
                    Diagnostic::warning(DiagnosticCode::EMPTY_BIN, *origin, message)
                        .help("a point's number is in one of its bins only: join alternatives by `||`")
                        .fix(format!("delete the bin `{name}`"), *origin, "", false),
                );
            } else if !table.counted(set).any(|c| c) {
                let message = format!("no test can fall into the bin `{name}`: all of it is ignored");
                issues.push(
                    Diagnostic::warning(DiagnosticCode::EMPTY_BIN, *origin, message)
                        .help("delete the bin, or ignore less")
                        .fix(format!("delete the bin `{name}`"), *origin, "", false),
                );
            }
        }
    }
}

/// HR0704
pub(crate) fn equal<'a>(scenario: &'a Scenario, _: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    for cross in &scenario.crosses {
        let Some(table) = BinTable::of(scenario, cross) else { continue };
        let mut first: BTreeMap<Vec<bool>, usize> = BTreeMap::new();
        for (i, set) in table.bins.iter().enumerate() {
            let counted: Vec<bool> = table.counted(set).collect();
            if !counted.contains(&true) {
                continue;
            }
            let same = *first.entry(counted).or_insert(i);
            if same != i {
                let (bin, other) = (&cross.bins[i], &cross.bins[same]);
                let message = format!("the bins `{}` and `{}` hold the same tests", bin.name, other.name);
                issues.push(
                    Diagnostic::warning(DiagnosticCode::EQUAL_BINS, bin.origin, message)
                        .label(other.origin, "the same combinations")
                        .help("change one of the conditions, or delete one of the bins"),
                );
            }
        }
    }
}

/// The truth of each bin's condition in each combination of the points' bins.
struct BinTable {
    bins: Vec<Vec<bool>>,
    ignored: Vec<bool>,
}

impl BinTable {
    /// `None`: there are too many combinations to look at.
    fn of(scenario: &Scenario, cross: &CoverCross) -> Option<Self> {
        let conditions = || cross.bins.iter().map(|b| &b.when).chain(&cross.ignore);
        let mut points: Vec<CoverpointId> = Vec::new();
        conditions().for_each(|c| mentioned(c, &mut points));
        points.sort_unstable();
        points.dedup();
        let sizes: Vec<usize> = points.iter().map(|p| choices(scenario, *p)).collect();
        let all = sizes.iter().try_fold(1usize, |n, size| n.checked_mul(*size))?;
        let work = conditions().map(size).sum::<usize>().checked_mul(all)?;
        if all > COMBINATIONS || work > WORK {
            return None;
        }
        let mut table = Self { bins: vec![Vec::with_capacity(all); cross.bins.len()], ignored: Vec::new() };
        for n in 0..all {
            let chosen = combination(n, &points, &sizes);
            for (set, bin) in table.bins.iter_mut().zip(&cross.bins) {
                set.push(holds(&bin.when, &chosen));
            }
            table.ignored.push(cross.ignore.iter().any(|c| holds(c, &chosen)));
        }
        Some(table)
    }

    /// What is not ignored.
    fn counted<'a>(&'a self, set: &'a [bool]) -> impl Iterator<Item = bool> + 'a {
        set.iter().zip(&self.ignored).map(|(s, i)| *s && !*i)
    }
}

/// How many bins a point has, and one more if a number can fall into none of them.
fn choices(scenario: &Scenario, point: CoverpointId) -> usize {
    let Some(point) = scenario.points.get(usize::from(point.0)) else { return 1 };
    let mut bins: Vec<(i64, Option<i64>)> = point.bins.iter().map(|b| (b.lo, b.hi)).collect();
    bins.sort_unstable();
    let mut next = Some(0);
    for (lo, hi) in bins {
        if next == Some(lo) {
            next = hi.map(|hi| hi.saturating_add(1));
        }
    }
    point.bins.len() + usize::from(next.is_some())
}

/// The n-th combination: for each point the bin, which is beyond the last for a number in none.
fn combination(mut n: usize, points: &[CoverpointId], sizes: &[usize]) -> Vec<(CoverpointId, usize)> {
    let mut chosen = Vec::with_capacity(points.len());
    for (point, size) in points.iter().zip(sizes) {
        chosen.push((*point, n % size));
        n /= size;
    }
    chosen
}

fn mentioned(c: &BinCondition, points: &mut Vec<CoverpointId>) {
    match c {
        BinCondition::In { point, .. } => points.push(*point),
        BinCondition::Not(c) => mentioned(c, points),
        BinCondition::And(cs) | BinCondition::Or(cs) => cs.iter().for_each(|c| mentioned(c, points)),
    }
}

fn size(c: &BinCondition) -> usize {
    match c {
        BinCondition::In { .. } => 1,
        BinCondition::Not(c) => 1 + size(c),
        BinCondition::And(cs) | BinCondition::Or(cs) => 1 + cs.iter().map(size).sum::<usize>(),
    }
}

fn holds(c: &BinCondition, chosen: &[(CoverpointId, usize)]) -> bool {
    match c {
        BinCondition::In { point, bin } => {
            let at = chosen.binary_search_by_key(point, |(p, _)| *p);
            at.is_ok_and(|at| chosen[at].1 == usize::from(*bin))
        }
        BinCondition::Not(c) => !holds(c, chosen),
        BinCondition::And(cs) => cs.iter().all(|c| holds(c, chosen)),
        BinCondition::Or(cs) => cs.iter().any(|c| holds(c, chosen)),
    }
}
