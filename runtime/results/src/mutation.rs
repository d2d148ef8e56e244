//! What `hrdsl mutate` found, as data that reads back: the file `mutation.json`.

use std::{collections::BTreeMap, fmt};

use serde::{Deserialize, Serialize, Serializer};

use crate::{
    ResultsError, ResultsPreamble, TestMethod,
    names::{RequirementName, TestName},
};

/// What kind of file `mutation.json` is: its `format`.
pub const MUTATION_FORMAT: &str = "hrdsl-mutation";
/// The version of the format. A field that is added leaves it as it is.
pub const MUTATION_VERSION: u32 = 1;

/// What was asked for.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MutationAbout {
    pub scenario: String,
    /// The system under test.
    pub system: String,
    /// How many tests ran on the original.
    pub tests: usize,
    /// Those of them that broke off or violated a requirement already.
    pub failing: usize,
    /// The seed of the campaign.
    pub seed: u64,
    /// Whether each mutant ran against all tests that reach it.
    pub matrix: bool,
    /// Whether mutants are of the models that play the system, not of its code.
    pub models: bool,
    /// The operators that were asked for; empty: all.
    pub operators: Vec<String>,
}

/// How many mutants came to what.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MutantCounts {
    pub killed: usize,
    pub survived: usize,
    pub not_distinguished: usize,
    #[serde(default)]
    pub permissive: usize,
    pub not_reached: usize,
    pub equivalent: usize,
    pub duplicate: usize,
    pub invalid: usize,
    pub not_run: usize,
}

/// How many mutants an oracle noticed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OracleScore {
    pub oracle: MutantOracle,
    pub killed: usize,
    /// By which method's tests; a mutant counts once for each.
    pub methods: BTreeMap<TestMethod, usize>,
    /// Mutants that no other oracle noticed in the tests that ran.
    pub alone: usize,
}

/// How many mutants the tests of a method noticed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MethodScore {
    pub method: TestMethod,
    pub killed: usize,
    /// Hours that its tests simulated on mutants.
    pub simulated_hours: f64,
    /// `None` if nothing was simulated.
    pub killed_per_hour: Option<f64>,
}

/// A mutant, and what became of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MutantReport {
    pub file: String,
    pub line: u32,
    pub number: u32,
    pub operator: String,
    pub what: String,
    pub fate: MutantFate,
    /// How many tests reach it.
    pub reached: usize,
    /// How many of them ran.
    pub ran: usize,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub noticed: Vec<NoticedTest>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub difference: Option<RunDifference>,
    /// The first that notice, in order of the times at which they do; what is about the same as another comes after those.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub proposals: Vec<ProposedRequirement>,
}

/// What `hrdsl mutate` found; the same for any number of workers.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MutationReport {
    pub format: String,
    pub version: u32,
    pub hrdsl: String,
    #[serde(flatten)]
    pub about: MutationAbout,
    pub interrupted: bool,
    /// Mutants that are worth a run.
    pub worth: usize,
    /// How many of them were drawn, if not all were.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drawn: Option<usize>,
    pub counts: MutantCounts,
    /// Killed, of those killed, survived or not reached; `None` if there are none.
    pub score: Option<f64>,
    pub oracles: Vec<OracleScore>,
    pub methods: Vec<MethodScore>,
    /// A mutant of each file that raises at once.
    pub sentinels: Vec<MutantReport>,
    pub mutants: Vec<MutantReport>,
}

/// What became of a mutant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MutantFate {
    /// A test noticed it.
    Killed,
    /// Some run went another way, and no oracle minded. Of a model: it allows less than before somewhere in a run, which the run does not show.
    Survived,
    /// All runs went as the original's. It may do the same as the original always, or only in these tests. Of a model: it allows the same in all
    /// runs.
    NotDistinguished,
    /// Of a model: it allows more than before somewhere in a run, and less nowhere. No run that the model allows can contradict it there.
    Permissive,
    /// No test executes what it changes. Of a model: no run can be where it is changed.
    NotReached,
    /// Its bytecode is the original's.
    Equivalent,
    /// Its bytecode is that of an earlier mutant.
    Duplicate,
    /// It does not compile.
    Invalid,
    /// The campaign was interrupted before it was known.
    NotRun,
}

/// A test that noticed a mutant.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct NoticedTest {
    pub test: TestName,
    /// In order; at least one.
    pub oracles: Vec<MutantOracle>,
    /// What broke the test off, if that noticed: its first line and its last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// That of the test.
    pub method: TestMethod,
}

/// A requirement that holds in all runs of the original, and fails in a mutant's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProposedRequirement {
    /// As it is written after `require NAME KIND`.
    pub pattern: String,
    /// When it first fails in the mutant's run, in seconds.
    pub time: f64,
    /// The test of that run.
    #[serde(default)]
    pub test: TestName,
}

/// The first step in which two runs of a test differ.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunDifference {
    pub test: TestName,
    /// Of the earlier of the two steps, in seconds.
    pub time: f64,
    /// What the original does there, for people; its end if it does no more.
    pub original: String,
    /// What the mutant does.
    pub mutant: String,
}

/// What tells a run of a mutant from the original's run of the same test, for the worse.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(try_from = "String")]
pub enum MutantOracle {
    /// A requirement is violated.
    Requirement(RequirementName),
    /// The run leaves what its test's model predicted.
    Prediction,
    /// The code does what its model does not allow.
    Conformance,
    /// The test breaks off: the code crashed, or went over a limit.
    Error,
}

impl fmt::Display for MutantOracle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MutantOracle::Requirement(name) => write!(f, "requirement {}", name.as_str()),
            MutantOracle::Prediction => f.write_str("prediction"),
            MutantOracle::Conformance => f.write_str("conformance"),
            MutantOracle::Error => f.write_str("error"),
        }
    }
}

/// As people read it.
impl Serialize for MutantOracle {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(self)
    }
}

/// As people read it.
impl TryFrom<String> for MutantOracle {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        match text.as_str() {
            "prediction" => Ok(MutantOracle::Prediction),
            "conformance" => Ok(MutantOracle::Conformance),
            "error" => Ok(MutantOracle::Error),
            _ => {
                let name =
                    text.strip_prefix("requirement ").ok_or_else(|| format!("no oracle is `{text}`"))?;
                Ok(MutantOracle::Requirement(name.into()))
            }
        }
    }
}

impl MutationReport {
    /// The report as `mutation.json` has it.
    ///
    /// # Errors
    /// A number that JSON cannot hold.
    pub fn to_json(&self) -> Result<String, ResultsError> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    /// The files whose sentinel no test noticed: of them the tests measure nothing.
    pub fn unmeasured(&self) -> impl Iterator<Item = &str> {
        let is_alive = |sentinel: &&MutantReport| match sentinel.fate {
            MutantFate::Killed | MutantFate::NotRun => false,
            MutantFate::Survived
            | MutantFate::NotDistinguished
            | MutantFate::Permissive
            | MutantFate::NotReached
            | MutantFate::Equivalent
            | MutantFate::Duplicate
            | MutantFate::Invalid => true,
        };
        self.sentinels.iter().filter(is_alive).map(|sentinel| sentinel.file.as_str())
    }

    /// Reads what [`to_json`](Self::to_json) has written.
    ///
    /// # Errors
    /// A text that is something else, or of another version of the format.
    pub fn from_json(text: &str) -> Result<Self, ResultsError> {
        let read = serde_json::from_str::<Self>(text);
        // What another version lacks or has too much of is not what is wrong with it.
        let preamble: ResultsPreamble = serde_json::from_str(text).map_err(ResultsError::Mutation)?;
        if preamble.format != MUTATION_FORMAT || preamble.version != MUTATION_VERSION {
            return Err(ResultsError::MutationFormat(preamble.format, preamble.version));
        }
        read.map_err(ResultsError::Mutation)
    }
}
