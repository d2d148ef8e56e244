//! What hrdsl's own messages consist of, for their schemas, and for those that are read back. Times are in seconds.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// What the recording is of: the first line of its text form.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HeaderMessage {
    /// `trace`
    pub hrdsl: String,
    /// The version of the text form.
    pub version: u64,
    pub scenario: String,
    /// A digest of the scenario's events and signals.
    pub vocabulary: Option<String>,
    pub test: Option<String>,
    pub seed: Option<u64>,
}

/// An event or a stimulus that happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EventMessage {
    pub t: f64,
    pub event: String,
    /// By their names.
    #[serde(default)]
    pub args: BTreeMap<String, Value>,
}

/// A signal has this value from now on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SignalMessage {
    pub t: f64,
    pub signal: String,
    /// A bool, a number in the SI unit of the signal, the name of an enumeration's value, or `nan`, `inf`, `-inf`.
    pub value: Value,
}

/// A state machine of the system was declared (`states`, `transitions`, `outcomes`), was begun (`to`), or has moved (`from`, `outcome`, `to`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MachineMessage {
    pub t: f64,
    pub machine: String,
    #[serde(default)]
    pub states: Option<Vec<String>>,
    /// From, outcome, to.
    #[serde(default)]
    pub transitions: Option<Vec<[String; 3]>>,
    #[serde(default)]
    pub outcomes: Option<Vec<String>>,
    #[serde(default)]
    pub from: Option<String>,
    #[serde(default)]
    pub outcome: Option<String>,
    #[serde(default)]
    pub to: Option<String>,
}

/// The end of the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EndMessage {
    pub end: f64,
    /// `quiescent`, `limit` or `error`
    pub ended: String,
    /// Why it broke off.
    #[serde(default)]
    pub error: Option<String>,
}

/// What the run came to by a requirement when it was made. `hrdsl judge` reads none of these, and judges the steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VerdictMessage {
    pub requirement: String,
    /// `pass`, `fail`, `vacuous`, `inconclusive` or `error`
    pub verdict: String,
    /// How often it was violated.
    pub failures: u32,
    /// When it was first violated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub violated: Option<f64>,
    /// The least margin, in `unit`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub margin: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
}

/// Bodies that press on each other from now on, each pair until it is told again.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ContactsMessage {
    pub contacts: Vec<ContactEntry>,
}

/// Two bodies that press on each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ContactEntry {
    /// The names of both.
    pub bodies: [String; 2],
    /// In the world, m.
    pub point: [f64; 3],
    /// On the first of the two, N; three zeros end the contact.
    pub force: [f64; 3],
}

/// The messages that programs of the system, and the scenario, sent through names of the middleware.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TopicsMessage {
    pub topics: Vec<TopicColumns>,
}

/// What messages are to a name: of a topic, or which step of the calls of a service or an action.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum TopicPart {
    #[default]
    Message,
    /// Requests of a service, or goals.
    Request,
    /// Answers of a service, or results of goals; or why there are none.
    Answer,
    /// How far goals are.
    Feedback,
}

/// The messages of a topic, or of a part of a service or an action, in one direction.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TopicColumns {
    /// `/scan`
    pub name: String,
    /// `sensor_msgs/LaserScan`
    pub interface: String,
    /// Whether a program of the system sent them; otherwise the scenario did.
    pub outward: bool,
    #[serde(default)]
    pub part: TopicPart,
    /// Nanoseconds: the first, and then what each differs from the one before.
    pub t: Vec<i64>,
    /// What the first of them said; `null` where it was too long.
    pub text: Vec<Option<String>>,
}

/// At which lines of its own code a program of the system was, for those of its files whose coverage is measured: where it asked for something, told
/// something, or began to wait.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct LinesMessage {
    pub program: String,
    pub files: Vec<LinesFile>,
    pub threads: Vec<LineColumns>,
    /// Since when nobody looked any more, in nanoseconds, if there were too many lines.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<i64>,
    /// How many threads are missing, as there were too many.
    #[serde(default)]
    pub unseen: u64,
}

/// A file of code.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct LinesFile {
    pub name: String,
    /// The CRC-32 of its bytes, by which one sees whether it has changed since.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crc: Option<u32>,
}

/// At which lines a thread was, each until the next: the first value of each column, and then what each differs from the one before.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct LineColumns {
    /// The name of the thread: `MainThread`
    pub thread: String,
    /// Nanoseconds.
    pub t: Vec<i64>,
    /// Places among the files.
    pub file: Vec<i64>,
    /// From 1; 0 while it is in none of the files.
    pub line: Vec<i64>,
}

/// The messages of a name in one direction.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordedTopic {
    pub name: String,
    pub interface: String,
    pub outward: bool,
    pub part: TopicPart,
    pub times: Vec<hrdsl_ir::Nanos>,
    pub texts: Vec<Option<String>>,
}

/// What a program logged.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedLogLine {
    pub time: hrdsl_ir::Nanos,
    pub level: RecordedLogLevel,
    pub program: String,
    pub text: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordedLogLevel {
    Debug,
    Info,
    Warning,
    Error,
    Fatal,
}

impl RecordedLogLevel {
    pub const ALL: [RecordedLogLevel; 5] = [
        RecordedLogLevel::Debug,
        RecordedLogLevel::Info,
        RecordedLogLevel::Warning,
        RecordedLogLevel::Error,
        RecordedLogLevel::Fatal,
    ];

    /// Its number in `foxglove.Log`.
    #[must_use]
    pub fn number(self) -> u8 {
        match self {
            RecordedLogLevel::Debug => 1,
            RecordedLogLevel::Info => 2,
            RecordedLogLevel::Warning => 3,
            RecordedLogLevel::Error => 4,
            RecordedLogLevel::Fatal => 5,
        }
    }
}
