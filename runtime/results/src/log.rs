//! What the programs of a test have logged: how much of each level, and the first of what warns.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How much a logged text matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LoggedLevel {
    Debug,
    Info,
    Warn,
    Error,
    Fatal,
}

impl fmt::Display for LoggedLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            LoggedLevel::Debug => "debug",
            LoggedLevel::Info => "info",
            LoggedLevel::Warn => "warn",
            LoggedLevel::Error => "error",
            LoggedLevel::Fatal => "fatal",
        })
    }
}

/// How many texts of each level were logged.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct LogCounts {
    pub debug: u64,
    pub info: u64,
    pub warn: u64,
    pub error: u64,
    pub fatal: u64,
}

/// A text that was logged, and warns or says worse.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LoggedText {
    /// Seconds.
    pub time: f64,
    pub program: String,
    /// Empty: the program does not say.
    pub node: String,
    pub level: LoggedLevel,
    pub text: String,
}

/// What was logged in a test.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LogSummary {
    pub counts: LogCounts,
    /// The first that warn or say worse.
    pub first: Vec<LoggedText>,
}

impl LogSummary {
    /// Whether nothing was logged.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.counts == LogCounts::default()
    }

    /// How many texts warn or say worse.
    #[must_use]
    pub fn warnings(&self) -> u64 {
        self.counts.warn + self.counts.error + self.counts.fatal
    }

    /// `12 info, 2 warn, 1 error`: the levels of which something was logged.
    #[must_use]
    pub fn in_short(&self) -> String {
        let LogCounts { debug, info, warn, error, fatal } = &self.counts;
        let levels = [
            (LoggedLevel::Debug, debug),
            (LoggedLevel::Info, info),
            (LoggedLevel::Warn, warn),
            (LoggedLevel::Error, error),
            (LoggedLevel::Fatal, fatal),
        ];
        let said = levels.iter().filter(|(_, count)| **count > 0);
        said.map(|(level, count)| format!("{count} {level}")).collect::<Vec<_>>().join(", ")
    }
}

impl LoggedText {
    /// `1.20 s  warn  /brain: low battery`
    #[must_use]
    pub fn line(&self) -> String {
        let Self { time, program, node, level, text } = self;
        let who = if node.is_empty() { program } else { node };
        format!("{time:.2} s  {level}  {who}: {text}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_is_told_in_short_and_its_warnings_in_lines() {
        assert!(LogSummary::default().is_empty());
        let text = LoggedText {
            time: 1.2,
            program: "brain".into(),
            node: String::new(),
            level: LoggedLevel::Warn,
            text: "low".into(),
        };
        let counts = LogCounts { info: 12, warn: 1, fatal: 2, ..LogCounts::default() };
        let log = LogSummary { counts, first: vec![text] };
        assert_eq!((log.in_short().as_str(), log.warnings()), ("12 info, 1 warn, 2 fatal", 3));
        assert_eq!(log.first[0].line(), "1.20 s  warn  brain: low");
        assert!(!log.is_empty());
    }
}
