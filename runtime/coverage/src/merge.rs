//! The coverage of a set of tests; sums and minima only, so that no order of the tests can be seen in it.

use hrdsl_ir::coverage::{self as ir, BinName};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::collect::TestCoverage;

/// How many tests hit a bin, and the name of the first of them in alphabetic order.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct BinCount {
    pub tests: u32,
    pub first: Option<String>,
}

/// What a set of tests covers together.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MergedCoverage {
    pub tests: u32,
    /// By point and bin.
    pub points: Vec<Vec<BinCount>>,
    /// By cross and bin.
    pub crosses: Vec<Vec<BinCount>>,
}

/// The coverage merged belongs to another scenario, or to another version of this one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("the coverage was collected for other points and bins")]
pub struct CoverageMismatchError;

/// One bin in a table for people.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CoverageRow {
    pub name: BinName,
    /// It is a cross-product bin, not a point's.
    pub cross: bool,
    pub count: BinCount,
}

impl BinCount {
    fn add(&mut self, test: &str) {
        self.join(&BinCount { tests: 1, first: Some(test.to_owned()) });
    }

    fn join(&mut self, other: &BinCount) {
        self.tests = self.tests.saturating_add(other.tests);
        let first = self.first.iter().chain(&other.first).min().cloned();
        self.first = first;
    }
}

impl MergedCoverage {
    /// No tests so far.
    #[must_use]
    pub fn new(declared: &ir::Coverage) -> Self {
        let counts = |bins: usize| vec![BinCount::default(); bins];
        Self {
            tests: 0,
            points: declared.points.iter().map(|p| counts(p.bins.len())).collect(),
            crosses: declared.crosses.iter().map(|c| counts(c.bins.len())).collect(),
        }
    }

    /// Adds one test. Adding a test twice counts it twice.
    ///
    /// # Errors
    /// [`CoverageMismatchError`]; then nothing is added.
    #[expect(clippy::indexing_slicing, reason = "`fits` has compared the bins")]
    pub fn add(&mut self, test: &str, coverage: &TestCoverage) -> Result<(), CoverageMismatchError> {
        fits(&self.points, &coverage.points)?;
        fits(&self.crosses, &coverage.crosses)?;
        let all = self.points.iter_mut().zip(&coverage.points);
        for (counts, hits) in all.chain(self.crosses.iter_mut().zip(&coverage.crosses)) {
            for hit in hits {
                counts[usize::from(*hit)].add(test);
            }
        }
        self.tests = self.tests.saturating_add(1);
        Ok(())
    }

    /// Adds another set of tests that has none in common with this one.
    ///
    /// # Errors
    /// [`CoverageMismatchError`]; then nothing is added.
    pub fn join(&mut self, other: &MergedCoverage) -> Result<(), CoverageMismatchError> {
        let shape = |table: &[Vec<BinCount>]| table.iter().map(Vec::len).collect::<Vec<_>>();
        if shape(&self.points) != shape(&other.points) || shape(&self.crosses) != shape(&other.crosses) {
            return Err(CoverageMismatchError);
        }
        let all = self.points.iter_mut().zip(&other.points);
        for (counts, others) in all.chain(self.crosses.iter_mut().zip(&other.crosses)) {
            for (count, other) in counts.iter_mut().zip(others) {
                count.join(other);
            }
        }
        self.tests = self.tests.saturating_add(other.tests);
        Ok(())
    }

    /// All bins by name, in source order: the points' first.
    #[must_use]
    pub fn rows(&self, declared: &ir::Coverage) -> Vec<CoverageRow> {
        let mut rows = Vec::new();
        for (point, counts) in declared.points.iter().zip(&self.points) {
            for (bin, count) in point.bins.iter().zip(counts) {
                rows.push(CoverageRow {
                    name: BinName::new(&point.name, &bin.name),
                    cross: false,
                    count: count.clone(),
                });
            }
        }
        for (cross, counts) in declared.crosses.iter().zip(&self.crosses) {
            for (bin, count) in cross.bins.iter().zip(counts) {
                rows.push(CoverageRow {
                    name: BinName::new(&cross.name, &bin.name),
                    cross: true,
                    count: count.clone(),
                });
            }
        }
        rows
    }

    /// How many cross-product bins were hit, and how many there are.
    #[must_use]
    pub fn crosses_hit(&self) -> (usize, usize) {
        let all = self.crosses.iter().flatten();
        (all.clone().filter(|count| count.tests > 0).count(), all.count())
    }
}

/// Whether every bin hit is there to be counted.
fn fits(counts: &[Vec<BinCount>], hits: &[Vec<u16>]) -> Result<(), CoverageMismatchError> {
    let in_range =
        |(counts, hits): (&Vec<BinCount>, &Vec<u16>)| hits.iter().all(|h| usize::from(*h) < counts.len());
    if counts.len() == hits.len() && counts.iter().zip(hits).all(in_range) {
        Ok(())
    } else {
        Err(CoverageMismatchError)
    }
}
