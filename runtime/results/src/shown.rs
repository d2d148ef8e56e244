//! The replays that a report has on its page: the file `replays/shown.json`, which is written once, so that a report that is made again needs
//! neither the scenario nor its meshes.

use serde::{Deserialize, Serialize};

use crate::{ReplayPair, ResultsError, TestName, UnreplayedTest};

/// What kind of file it is: its `format`.
const SHOWN: &str = "hrdsl-replays";
/// The version of the format.
const SHOWN_VERSION: u32 = 1;

/// Replays for a page: each run packed by itself, and what they share.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShownReplays {
    /// `hrdsl-replays`
    pub format: String,
    /// The version of the format, 1.
    pub version: u32,
    /// What is shown: the failing test with the one beside it.
    pub pairs: Vec<ReplayPair>,
    /// The runs of these pairs, each once.
    pub runs: Vec<ShownRun>,
    /// Meshes, as raw deflate in base64; empty if no run has any.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub assets: String,
    /// Pairs that are not on the page, or only their failing test, with the reason.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<UnreplayedTest>,
}

/// A run that a page can replay.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShownRun {
    pub test: TestName,
    /// Its document, as raw deflate in base64.
    pub data: String,
}

impl Default for ShownReplays {
    fn default() -> Self {
        Self {
            format: SHOWN.to_owned(),
            version: SHOWN_VERSION,
            pairs: Vec::new(),
            runs: Vec::new(),
            assets: String::new(),
            left_out: Vec::new(),
        }
    }
}

impl ShownReplays {
    /// The replays as `shown.json` has them.
    ///
    /// # Errors
    /// None that is known: it is plain data.
    pub fn to_json(&self) -> Result<String, ResultsError> {
        Ok(serde_json::to_string(self)? + "\n")
    }

    /// Reads what [`to_json`](Self::to_json) has written.
    ///
    /// # Errors
    /// A text that is something else, or of another version of the format.
    pub fn from_json(text: &str) -> Result<Self, ResultsError> {
        let shown: Self = serde_json::from_str(text).map_err(ResultsError::Replays)?;
        if shown.format != SHOWN || shown.version != SHOWN_VERSION {
            return Err(ResultsError::ReplaysFormat(shown.format, shown.version));
        }
        Ok(shown)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_reads_back_and_something_else_is_refused() {
        let run = ShownRun { test: "s.a.t001".into(), data: "AAAA".into() };
        let shown = ShownReplays { runs: vec![run], ..ShownReplays::default() };
        let text = shown.to_json().unwrap();
        assert_eq!(ShownReplays::from_json(&text).unwrap(), shown);
        let refusal = |text: &str| ShownReplays::from_json(text).unwrap_err().to_string();
        assert!(refusal(&text[..text.len() / 2]).starts_with("these are not the replays of a report: "));
        assert_eq!(
            refusal(&text.replace("\"version\":1", "\"version\":7")),
            "these replays are `hrdsl-replays` of version 7; this hrdsl reads `hrdsl-replays` of version 1"
        );
    }
}
