//! What one run executed of the code under test.

use serde::{Deserialize, Serialize};

/// What one run executed of one source file. Lines count from 1; all lists are sorted.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileCoverage {
    /// As the system under test names it.
    #[serde(default)]
    pub file: String,
    /// The first lines of all executable statements.
    pub statements: Vec<u32>,
    /// Those of them that were executed.
    pub executed: Vec<u32>,
    /// The ways out of every line that has more than one: (line, next line). A next line below zero is the end of the
    /// function, class or module that starts at that line.
    pub branches: Vec<(u32, i32)>,
    /// Those of them that were taken.
    pub executed_branches: Vec<(u32, i32)>,
}

impl FileCoverage {
    /// What several programs executed, file by file, in the order in which files are first met.
    #[must_use]
    pub fn united(all: impl IntoIterator<Item = FileCoverage>) -> Vec<FileCoverage> {
        let mut files: Vec<FileCoverage> = Vec::new();
        for one in all {
            match files.iter_mut().find(|f| f.file == one.file) {
                Some(known) => known.add(one),
                None => files.push(one),
            }
        }
        files
    }

    fn add(&mut self, other: FileCoverage) {
        fn unite<T: Ord>(into: &mut Vec<T>, more: Vec<T>) {
            into.extend(more);
            into.sort_unstable();
            into.dedup();
        }
        unite(&mut self.statements, other.statements);
        unite(&mut self.executed, other.executed);
        unite(&mut self.branches, other.branches);
        unite(&mut self.executed_branches, other.executed_branches);
    }
}
