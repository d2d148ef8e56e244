//! Pieces that several parts of the page have: shares of the code, and links to tests.

use hrdsl_results::CoverageRatios;
use serde::Serialize;

#[derive(Serialize)]
pub struct ShownRatio {
    pub percent: String,
    pub part: u32,
    pub whole: u32,
}

pub fn lines_of(ratios: CoverageRatios) -> ShownRatio {
    ShownRatio {
        percent: format!("{:.1}", ratios.line_percent()),
        part: ratios.lines,
        whole: ratios.lines_total,
    }
}

pub fn branches_of(ratios: CoverageRatios) -> ShownRatio {
    ShownRatio {
        percent: format!("{:.1}", ratios.branch_percent()),
        part: ratios.branches,
        whole: ratios.branches_total,
    }
}

/// A test by name, with its place in the list.
#[derive(Serialize)]
pub struct TestLink {
    pub name: String,
    pub place: Option<usize>,
}
