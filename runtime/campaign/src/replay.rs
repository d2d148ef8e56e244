//! The file by which a run can be looked at again.

use hrdsl_harness::{HarnessRun, ProgramLogLevel};
use hrdsl_ir::{Program, value::seconds};
use hrdsl_recording::{
    RunOnFile,
    message::{RecordedLogLevel, RecordedLogLine, VerdictMessage},
    scene,
};
use hrdsl_results::TraceJudgement;

/// The file of a run, of which `text` is the recording.
///
/// # Errors
/// That the run is too large for the format.
pub(crate) fn file(
    program: &Program,
    run: &HarnessRun,
    text: &str,
    judgement: &TraceJudgement,
) -> Result<Vec<u8>, String> {
    let level = |level| match level {
        ProgramLogLevel::Debug => RecordedLogLevel::Debug,
        ProgramLogLevel::Info => RecordedLogLevel::Info,
        ProgramLogLevel::Warn => RecordedLogLevel::Warning,
        ProgramLogLevel::Error => RecordedLogLevel::Error,
        ProgramLogLevel::Fatal => RecordedLogLevel::Fatal,
    };
    let log: Vec<RecordedLogLine> = run
        .log
        .first
        .iter()
        .map(|kept| RecordedLogLine {
            time: kept.time,
            level: level(kept.record.level),
            program: if kept.record.node.is_empty() {
                kept.program.clone()
            } else {
                kept.record.node.clone()
            },
            text: kept.record.text.clone(),
        })
        .collect();
    let verdicts: Vec<VerdictMessage> = judgement
        .verdicts
        .iter()
        .map(|verdict| VerdictMessage {
            requirement: verdict.requirement.to_string(),
            verdict: verdict.outcome.name().to_owned(),
            failures: verdict.failures,
            violated: verdict.failure.as_ref().map(|failure| failure.time),
            margin: verdict.worst_margin.as_ref().map(|(margin, _)| *margin),
            unit: verdict.worst_margin.as_ref().map(|(_, unit)| unit.clone()),
        })
        .collect();
    let scene = program.world.as_ref().map(scene::scene).unwrap_or_default();
    let file = hrdsl_recording::write(&RunOnFile {
        trace: &run.trace,
        text,
        scene: &scene,
        picture: &run.picture,
        log: &log,
        verdicts: &verdicts,
    });
    file.map_err(|why| format!("{why} (it lasted {} s)", seconds(run.trace.end)))
}
