//! `Results`: what a campaign found, as data that reads back.
//!
//! This is the waist between campaigns, which make it, and everything that people look at (reports, JUnit, the console).
//! Nothing in it depends on wall-clock time, on the machine or on the number of workers: the same campaign gives the same
//! bytes. `spec/results.schema.json` is its schema, and `spec/results.md` says what its fields mean.
//!
//! # Map
//! - [`CampaignResults`] is the file `results.json`; [`CampaignResults::to_json`] writes it, [`CampaignResults::from_json`] reads it back.
//! - [`TestResult`] is one test: how its run ended, and the [`TraceJudgement`] on it.
//! - [`GeneratedSuite`] is what its tests were made as, before they were run.
//! - [`ReplayPair`] is a test worth looking at, with one beside it; [`ShownReplays`] are those that a report has on its page.
//! - [`MutationReport`] is the file `mutation.json`: which faults in the code would have been noticed.
//! - [`RequirementResult`], [`BinResult`], [`SuiteInfo`], [`CodeFile`], [`MachineResult`] and [`InterfaceWarning`] add up the
//!   tests.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::wildcard_enum_match_arm))]

mod code;
mod conformance;
mod executed;
mod generated;
mod goal;
mod interface;
mod judgement;
mod log;
mod machine;
mod mutation;
mod names;
mod prediction;
mod replays;
mod schema;
mod shown;
mod suite;
mod tally;
mod test;

use hrdsl_ir::Span;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use code::{CodeFile, CoverageRatios};
pub use conformance::{
    AllowedEvent, ConformanceOutcome, ConformanceVerdict, DepartedEvent, DepartureKind, ModelDeparture,
    ModelPlace,
};
pub use executed::FileCoverage;
pub use generated::{AbstractTests, AgentFindings, GeneratedSuite, LostTuples};
pub use goal::SuiteGoalId;
pub use hrdsl_ir::{coverage::BinName, monitor::RequirementKind, suite::CoverItemKind, test::TestMethod};
pub use hrdsl_trace::RunEnd;
pub use interface::{InterfaceFault, InterfaceRole, InterfaceWarning, UnservedWait};
pub use judgement::{
    CounterexampleStep, FirstFailure, SubformulaReading, SubformulaValue, SubformulaValues, TraceJudgement,
    VerdictOutcome, VerdictResult,
};
pub use log::{LogCounts, LogSummary, LoggedLevel, LoggedText};
pub use machine::{MachineCoverage, MachineResult, MachineStateResult, MachineTransitionResult};
pub use mutation::{
    MUTATION_FORMAT, MUTATION_VERSION, MethodScore, MutantCounts, MutantFate, MutantOracle, MutantReport,
    MutationAbout, MutationReport, NoticedTest, OracleScore, ProposedRequirement, RunDifference,
};
pub use names::{RequirementName, SuiteName, TestName};
pub use prediction::{PredictedRun, PredictionOutcome, PredictionVerdict, UnmetAwait};
pub use replays::{ReplayPair, UnreplayedTest};
pub use shown::{ShownReplays, ShownRun};
pub use suite::{
    AgentCoverage, GoalReport, GoalStatus, KindCoverage, ModelCoverage, SuiteExplanation, SuiteInfo,
    TestExplanation, UncoveredGoal, UnreachedItem,
};
pub use tally::{BinResult, RequirementResult, SmallestMargin, TriggerTotal, VerdictTally};
pub use test::{BodyPenetration, JointGap, LimitExcess, OutputSummary, PhysicsAccuracy, RunMark, TestResult};

/// What kind of file `results.json` is: its `format`.
pub const FORMAT: &str = "hrdsl-results";
/// The version of the format that this crate writes and reads. A field that is added leaves it as it is; one that goes, or
/// means something else, does not.
pub const VERSION: u32 = 2;

/// A whole campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CampaignResults {
    /// `hrdsl-results`
    pub format: String,
    /// The version of the format, 2.
    pub version: u32,
    /// The version of hrdsl that made it.
    pub hrdsl: String,
    pub scenario: String,
    /// The seed of the campaign.
    pub seed: u64,
    /// Whether the campaign was interrupted: then `tests` are those that had ended.
    pub interrupted: bool,
    /// How many tests were to be run.
    pub planned: usize,
    /// The command that runs one test again, up to its name, as it is typed in the folder of the results; empty if there is
    /// none.
    pub rerun: String,
    /// The command that makes a page that replays one test, up to its name, as it is typed in the folder of the results; left out if no test was
    /// recorded for it.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub view: String,
    /// Tests that were to be recorded with a picture and are not.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unreplayed: Vec<UnreplayedTest>,
    pub requirements: Vec<RequirementResult>,
    /// In the order of their first tests.
    pub suites: Vec<SuiteInfo>,
    pub bins: Vec<BinResult>,
    pub code: Vec<CodeFile>,
    /// The state machines of the system under test.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub machines: Vec<MachineResult>,
    /// Names of the middleware at which somebody was alone in every test.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<InterfaceWarning>,
    /// In the order in which they were given.
    pub tests: Vec<TestResult>,
}

/// Why a text is not the results of a campaign.
#[derive(Debug, Error)]
pub enum ResultsError {
    #[error("these are not the results of a campaign: {0}")]
    Json(#[from] serde_json::Error),
    #[error("this is no file of results: its `format` is not \"{FORMAT}\"")]
    Format,
    #[error("these results have version {0} of the format; this hrdsl reads version {VERSION}")]
    Version(u32),
    #[error("this is not what `hrdsl mutate` found: {0}")]
    Mutation(serde_json::Error),
    #[error(
        "this is `{0}` of version {1}; this hrdsl reads `{MUTATION_FORMAT}` of version {MUTATION_VERSION}"
    )]
    MutationFormat(String, u32),
    #[error("these are not the replays of a report: {0}")]
    Replays(serde_json::Error),
    #[error("these replays are `{0}` of version {1}; this hrdsl reads `hrdsl-replays` of version 1")]
    ReplaysFormat(String, u32),
}

/// What every version of the format begins with.
#[derive(Deserialize)]
struct ResultsPreamble {
    #[serde(default)]
    format: String,
    #[serde(default)]
    version: u32,
}

impl CampaignResults {
    /// The results as `results.json` has them.
    ///
    /// # Errors
    /// A number that JSON cannot hold.
    pub fn to_json(&self) -> Result<String, ResultsError> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    /// Reads what [`to_json`](Self::to_json) has written.
    ///
    /// # Errors
    /// A text that is something else, or of another version of the format.
    pub fn from_json(text: &str) -> Result<Self, ResultsError> {
        let read = serde_json::from_str::<Self>(text);
        // What another version lacks or has too much of is not what is wrong with it.
        let ResultsPreamble { format, version } = match &read {
            Ok(results) => ResultsPreamble { format: results.format.clone(), version: results.version },
            Err(_) => serde_json::from_str(text)?,
        };
        if format != FORMAT {
            return Err(ResultsError::Format);
        }
        if version != VERSION {
            return Err(ResultsError::Version(version));
        }
        Ok(read?)
    }

    /// The schema of `results.json`, as JSON Schema (2020-12).
    ///
    /// # Errors
    /// None that is known: what is written is this crate's own.
    pub fn schema() -> Result<String, ResultsError> {
        Ok(serde_json::to_string_pretty(&schemars::schema_for!(CampaignResults))? + "\n")
    }

    /// Whether no test violated a requirement, and none broke off.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.tests.iter().all(|t| t.error.is_none() && !t.has_failed())
    }

    /// Asks for the line of each place of a model that it names.
    pub fn locate(&mut self, line: &dyn Fn(Span) -> Option<usize>) {
        for verdict in self.tests.iter_mut().flat_map(|t| &mut t.judgement.conformance) {
            verdict.locate(line);
        }
    }

    /// The command that runs a test again, as it is typed in the folder of the results; `None` if there is none.
    #[must_use]
    pub fn rerun_of(&self, test: &TestResult) -> Option<String> {
        (!self.rerun.is_empty()).then(|| format!("{} {}", self.rerun, self.quoted_name(test)))
    }

    /// The name of a test without that of the scenario, as a word for a shell.
    fn quoted_name(&self, test: &TestResult) -> String {
        let name = test.name.within(&self.scenario);
        let plain = name.chars().all(|c| c.is_alphanumeric() || matches!(c, '.' | '_' | '-'));
        if plain { name.to_owned() } else { format!("'{}'", name.replace('\'', "'\\''")) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some() -> CampaignResults {
        CampaignResults {
            format: FORMAT.into(),
            version: VERSION,
            hrdsl: "0.1.0".into(),
            scenario: "s".into(),
            seed: 3,
            interrupted: false,
            planned: 1,
            rerun: "hrdsl sim s.hri --test".into(),
            view: String::new(),
            unreplayed: Vec::new(),
            requirements: Vec::new(),
            suites: Vec::new(),
            bins: Vec::new(),
            code: Vec::new(),
            machines: Vec::new(),
            warnings: Vec::new(),
            tests: Vec::new(),
        }
    }

    #[test]
    fn what_is_written_reads_back() {
        let text = some().to_json().unwrap();
        assert_eq!(CampaignResults::from_json(&text).unwrap(), some());
    }

    #[test]
    fn something_else_is_refused_with_a_reason() {
        let refusal = |text: &str| CampaignResults::from_json(text).unwrap_err().to_string();
        assert!(refusal("nothing").starts_with("these are not the results of a campaign: "));
        assert!(refusal("{}").contains("`format`"));
        assert!(refusal(r#"{"format":"hrdsl-run","version":1}"#).contains("`format`"));
        let later = refusal(r#"{"format":"hrdsl-results","version":7,"tests":0}"#);
        assert_eq!(later, "these results have version 7 of the format; this hrdsl reads version 2");
    }

    #[test]
    fn names_of_tests_are_quoted_for_a_shell() {
        let mut test = TestResult { name: "s.a.t001".into(), ..TestResult::default() };
        assert_eq!(some().rerun_of(&test).unwrap(), "hrdsl sim s.hri --test a.t001");
        test.name = "s.it's".into();
        assert_eq!(some().rerun_of(&test).unwrap(), "hrdsl sim s.hri --test 'it'\\''s'");
    }
}
