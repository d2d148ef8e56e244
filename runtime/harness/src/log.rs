//! What the programs of a system log: how much of each level, and the first of what warns, in bounded memory.

use hrdsl_ir::Nanos;

/// So many records that warn are kept of a run.
const MOST: usize = 20;
/// So many characters of a text, and of the name of a node, are kept.
const LONGEST: usize = 500;

/// How much a record matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ProgramLogLevel {
    Debug,
    Info,
    Warn,
    Error,
    Fatal,
}

impl ProgramLogLevel {
    /// All of them, the least first.
    pub const ALL: [ProgramLogLevel; 5] = [
        ProgramLogLevel::Debug,
        ProgramLogLevel::Info,
        ProgramLogLevel::Warn,
        ProgramLogLevel::Error,
        ProgramLogLevel::Fatal,
    ];
}

/// What a program logs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogRecord {
    pub level: ProgramLogLevel,
    /// Empty: it does not say.
    pub node: String,
    pub text: String,
}

/// A record that is kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeptRecord {
    pub time: Nanos,
    pub program: String,
    pub record: LogRecord,
}

/// What was logged in a run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SystemLog {
    /// By [`ProgramLogLevel::ALL`].
    counts: [u64; 5],
    /// The first that warn or say worse, in the order in which they came.
    pub first: Vec<KeptRecord>,
}

impl SystemLog {
    /// How many records had this level.
    #[must_use]
    pub fn count(&self, level: ProgramLogLevel) -> u64 {
        ProgramLogLevel::ALL
            .iter()
            .zip(self.counts)
            .filter(|(of, _)| **of == level)
            .map(|(_, count)| count)
            .sum()
    }

    /// A program has logged something.
    pub(crate) fn add(&mut self, time: Nanos, program: &str, record: LogRecord) {
        for (of, count) in ProgramLogLevel::ALL.iter().zip(&mut self.counts) {
            *count += u64::from(*of == record.level);
        }
        if record.level >= ProgramLogLevel::Warn && self.first.len() < MOST {
            let record =
                LogRecord { level: record.level, node: shortened(record.node), text: shortened(record.text) };
            self.first.push(KeptRecord { time, program: program.to_owned(), record });
        }
    }
}

pub(crate) fn shortened(text: String) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", text.get(..end).unwrap_or_default()),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(level: ProgramLogLevel, text: &str) -> LogRecord {
        LogRecord { level, node: "/brain".to_owned(), text: text.to_owned() }
    }

    #[test]
    fn levels_are_counted_and_the_first_warnings_kept() {
        let mut log = SystemLog::default();
        log.add(1, "brain", record(ProgramLogLevel::Info, "ready"));
        log.add(2, "brain", record(ProgramLogLevel::Warn, "low"));
        log.add(3, "arm", record(ProgramLogLevel::Fatal, "out"));
        let counts = ProgramLogLevel::ALL.map(|level| log.count(level));
        assert_eq!(counts, [0, 1, 1, 0, 1]);
        let kept: Vec<(i64, &str, &str)> =
            log.first.iter().map(|k| (k.time, k.program.as_str(), k.record.text.as_str())).collect();
        assert_eq!(kept, [(2, "brain", "low"), (3, "arm", "out")]);
    }

    #[test]
    fn whatever_is_logged_takes_no_more_than_so_much() {
        let mut log = SystemLog::default();
        for _ in 0..10_000 {
            log.add(0, "brain", record(ProgramLogLevel::Error, &"ä".repeat(1_000)));
        }
        assert_eq!((log.count(ProgramLogLevel::Error), log.first.len()), (10_000, MOST));
        assert_eq!(log.first[0].record.text.chars().count(), LONGEST + 1);
    }
}
