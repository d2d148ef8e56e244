//! Which code of the system under test was executed.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Executed and all, of lines and of branches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct CoverageRatios {
    pub lines: u32,
    pub lines_total: u32,
    pub branches: u32,
    pub branches_total: u32,
}

impl CoverageRatios {
    /// Lines executed, in percent; 100 of nothing.
    #[must_use]
    pub fn line_percent(self) -> f64 {
        percent(self.lines, self.lines_total)
    }

    #[must_use]
    pub fn branch_percent(self) -> f64 {
        percent(self.branches, self.branches_total)
    }
}

fn percent(part: u32, whole: u32) -> f64 {
    if whole == 0 { 100.0 } else { (f64::from(part) * 1000.0 / f64::from(whole)).round() / 10.0 }
}

/// A source file of the system under test, over the whole campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CodeFile {
    pub file: String,
    pub ratios: CoverageRatios,
    /// For each executable line the number of tests that executed it.
    pub lines: Vec<(u32, u32)>,
    /// For each of these lines the number of tests of each suite that executed it, in the order of the suites.
    pub suites: Vec<Vec<u32>>,
    /// Branches that no test took, as (line, next line); a next line below 0 is the end of the function that begins there.
    pub missed_branches: Vec<(u32, i32)>,
    /// The text; empty if it could not be read.
    pub source: String,
}
