//! What the programs of a run wrote and executed, in short.

use hrdsl_results::{CoverageRatios, FileCoverage, OutputSummary};
use hrdsl_sut::FinishedProcess;

use crate::LAST_LINES;

/// Of several programs, the last lines of each stand under its name.
pub(crate) fn summary(finished: &[(String, FinishedProcess)]) -> OutputSummary {
    let mut ends = Vec::new();
    for (name, f) in finished {
        let end = f.output.stderr.last_lines(LAST_LINES);
        if finished.len() == 1 {
            ends.push(end);
        } else if !end.is_empty() {
            ends.push(format!("── {name} ──\n{end}"));
        }
    }
    OutputSummary {
        stdout_bytes: finished.iter().map(|(_, f)| f.output.stdout.bytes).sum(),
        stderr_bytes: finished.iter().map(|(_, f)| f.output.stderr.bytes).sum(),
        stderr_end: ends.join("\n"),
    }
}

/// Lines and branches of one run over all files.
pub(crate) fn ratios(files: &[FileCoverage]) -> CoverageRatios {
    let count = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    let mut sum = CoverageRatios::default();
    for file in files {
        sum.lines += count(file.executed.len());
        sum.lines_total += count(file.statements.len());
        sum.branches += count(file.executed_branches.len());
        sum.branches_total += count(file.branches.len());
    }
    sum
}
