//! One test's coverage: numbers per point, and the bins they fall into.

use hrdsl_ir::{
    EventId, Program, Value,
    coverage::{self as ir, BinName, CoverpointId},
};
use hrdsl_trace::{TraceObserver, TraceStep, TraceStepKind};
use serde::{Deserialize, Serialize};

/// What one test covers.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TestCoverage {
    /// For each point, how often its events happened.
    pub numbers: Vec<i64>,
    /// For each point, the indices of its bins that hold the number, in order.
    pub points: Vec<Vec<u16>>,
    /// For each cross, the indices of its bins that the test falls into, in order.
    pub crosses: Vec<Vec<u16>>,
}

impl TestCoverage {
    /// The names of the cross-product bins hit, in source order.
    #[must_use]
    pub fn cross_names(&self, declared: &ir::Coverage) -> Vec<BinName> {
        let mut names = Vec::new();
        for (cross, hits) in declared.crosses.iter().zip(&self.crosses) {
            let bins = hits.iter().filter_map(|bin| cross.bins.get(usize::from(*bin)));
            names.extend(bins.map(|bin| BinName::new(&cross.name, &bin.name)));
        }
        names
    }
}

/// Counts a trace's events for all coverpoints of a program.
#[derive(Clone, Debug)]
pub struct CoverageCollector {
    declared: ir::Coverage,
    /// For each event of the program, the points that ask for it.
    by_event: Vec<Vec<usize>>,
    numbers: Vec<i64>,
}

impl CoverageCollector {
    #[must_use]
    pub fn new(program: &Program) -> Self {
        let declared = program.coverage.clone();
        let mut by_event: Vec<Vec<usize>> = vec![Vec::new(); program.events.len()];
        for (index, point) in declared.points.iter().enumerate() {
            for pattern in &point.count {
                if let Some(points) = by_event.get_mut(usize::from(pattern.event.0))
                    && points.last() != Some(&index)
                {
                    points.push(index);
                }
            }
        }
        let numbers = vec![0; declared.points.len()];
        Self { declared, by_event, numbers }
    }

    /// An event happened. It counts once for a point, however many of the point's patterns it matches.
    #[expect(clippy::indexing_slicing, reason = "`by_event` and `numbers` are made from these points")]
    pub fn event(&mut self, event: EventId, args: &[Value]) {
        for &point in self.by_event.get(usize::from(event.0)).into_iter().flatten() {
            if self.declared.points[point].count.iter().any(|p| p.matches(event, args)) {
                self.numbers[point] = self.numbers[point].saturating_add(1);
            }
        }
    }

    /// The coverage of what was seen so far.
    #[must_use]
    pub fn finish(self) -> TestCoverage {
        hits_from_numbers(&self.declared, &self.numbers)
    }
}

impl TraceObserver for CoverageCollector {
    fn step(&mut self, _: usize, step: &TraceStep) {
        match &step.what {
            TraceStepKind::Event { event, args } => self.event(*event, args),
            TraceStepKind::Sample { .. } | TraceStepKind::Machine(_) => {}
        }
    }

    fn end(&mut self, _: hrdsl_ir::Nanos) {}
}

/// Sorts a test's numbers into bins. Points without a number count as 0.
#[must_use]
pub fn hits_from_numbers(declared: &ir::Coverage, numbers: &[i64]) -> TestCoverage {
    let number = |point: CoverpointId| numbers.get(usize::from(point.0)).copied().unwrap_or(0);
    let of_point = |(index, point): (usize, &ir::Coverpoint)| {
        let n = numbers.get(index).copied().unwrap_or(0);
        indices(&point.bins, |bin| bin.holds(n))
    };
    let of_cross = |cross: &ir::CoverCross| {
        if cross.ignore.iter().any(|c| c.holds(declared, &number)) {
            return Vec::new();
        }
        indices(&cross.bins, |bin| bin.when.holds(declared, &number))
    };
    TestCoverage {
        numbers: (0..declared.points.len()).map(|i| numbers.get(i).copied().unwrap_or(0)).collect(),
        points: declared.points.iter().enumerate().map(of_point).collect(),
        crosses: declared.crosses.iter().map(of_cross).collect(),
    }
}

fn indices<T>(bins: &[T], hit: impl Fn(&T) -> bool) -> Vec<u16> {
    (0u16..).zip(bins).filter(|(_, bin)| hit(bin)).map(|(index, _)| index).collect()
}
