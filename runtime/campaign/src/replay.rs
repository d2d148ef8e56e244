//! The file by which a run can be looked at again.

use hrdsl_harness::{HarnessRun, MessagePart, ProgramLogLevel, TopicHistory};
use hrdsl_ir::{Program, value::seconds};
use hrdsl_recording::{
    RunOnFile,
    message::{
        LineColumns, LinesFile, LinesMessage, RecordedLogLevel, RecordedLogLine, RecordedTopic, TopicPart,
        VerdictMessage,
    },
    scene,
};
use hrdsl_results::TraceJudgement;
use hrdsl_sut::{FinishedProcess, ProgramLines};

/// The file of a run, of which `text` is the recording.
///
/// # Errors
/// That the run is too large for the format.
pub(crate) fn file(
    program: &Program,
    run: &HarnessRun,
    text: &str,
    judgement: &TraceJudgement,
    finished: &[(String, FinishedProcess)],
) -> Result<Vec<u8>, String> {
    let level = |level| match level {
        ProgramLogLevel::Debug => RecordedLogLevel::Debug,
        ProgramLogLevel::Info => RecordedLogLevel::Info,
        ProgramLogLevel::Warn => RecordedLogLevel::Warning,
        ProgramLogLevel::Error => RecordedLogLevel::Error,
        ProgramLogLevel::Fatal => RecordedLogLevel::Fatal,
    };
    let mut log: Vec<RecordedLogLine> = run
        .said
        .log
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
    log.extend((run.said.log_left_out > 0).then(|| RecordedLogLine {
        time: log.last().map_or(0, |last| last.time),
        level: RecordedLogLevel::Info,
        program: "hrdsl".to_owned(),
        text: format!("{} later lines are not in the recording", run.said.log_left_out),
    }));
    let topics: Vec<RecordedTopic> = run.said.topics.iter().map(recorded_topic).collect();
    let lines: Vec<LinesMessage> = finished
        .iter()
        .filter_map(|(name, process)| Some(code_lines(name, process.lines.as_ref()?)))
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
        topics: &topics,
        lines: &lines,
        verdicts: &verdicts,
    });
    file.map_err(|why| format!("{why} (it lasted {} s)", seconds(run.trace.end)))
}

fn recorded_topic(topic: &TopicHistory) -> RecordedTopic {
    RecordedTopic {
        name: topic.name.clone(),
        interface: topic.interface.clone(),
        outward: topic.outward,
        part: match topic.part {
            MessagePart::Message => TopicPart::Message,
            MessagePart::Request => TopicPart::Request,
            MessagePart::Answer => TopicPart::Answer,
            MessagePart::Feedback => TopicPart::Feedback,
        },
        times: topic.times.clone(),
        texts: topic.texts.iter().map(|text| text.as_ref().map(ToString::to_string)).collect(),
    }
}

/// At which lines a program was.
fn code_lines(program: &str, lines: &ProgramLines) -> LinesMessage {
    let columns = |thread: &hrdsl_sut::ThreadLines| LineColumns {
        thread: thread.name.clone(),
        t: thread.t.clone(),
        file: thread.file.clone(),
        line: thread.line.clone(),
    };
    LinesMessage {
        program: program.to_owned(),
        files: lines.files.iter().map(|f| LinesFile { name: f.name.clone(), crc: f.crc }).collect(),
        threads: lines.threads.iter().map(columns).collect(),
        until: lines.until,
        unseen: lines.unseen,
    }
}
