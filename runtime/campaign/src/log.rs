//! What programs have logged in a test, as the results have it.

use hrdsl_harness::{KeptRecord, ProgramLogLevel, SystemLog};
use hrdsl_ir::value::seconds;
use hrdsl_results::{LogCounts, LogSummary, LoggedLevel, LoggedText};

/// The counts of all levels, and the first texts that warn or say worse.
pub(crate) fn summary(log: &SystemLog) -> LogSummary {
    let counts = LogCounts {
        debug: log.count(ProgramLogLevel::Debug),
        info: log.count(ProgramLogLevel::Info),
        warn: log.count(ProgramLogLevel::Warn),
        error: log.count(ProgramLogLevel::Error),
        fatal: log.count(ProgramLogLevel::Fatal),
    };
    let logged = |kept: &KeptRecord| LoggedText {
        time: seconds(kept.time),
        program: kept.program.clone(),
        node: kept.record.node.clone(),
        level: level(kept.record.level),
        text: kept.record.text.clone(),
    };
    LogSummary { counts, first: log.first.iter().map(logged).collect() }
}

fn level(level: ProgramLogLevel) -> LoggedLevel {
    match level {
        ProgramLogLevel::Debug => LoggedLevel::Debug,
        ProgramLogLevel::Info => LoggedLevel::Info,
        ProgramLogLevel::Warn => LoggedLevel::Warn,
        ProgramLogLevel::Error => LoggedLevel::Error,
        ProgramLogLevel::Fatal => LoggedLevel::Fatal,
    }
}
