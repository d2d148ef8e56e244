//! A recording as a document: what can be shown of it is, and the rest is named in the document's notes.

mod about;
mod asked;
mod changed;
mod code;
mod derived;
mod formula;
mod measure;
mod offset;
mod run;
mod scene;
mod story;
mod tracks;
mod units;
mod violation;

use hrdsl_ir::{Nanos, Program};
use hrdsl_recording::{
    RecordingFile,
    message::RecordedLogLevel,
    scene::{RecordedScene, scene as scene_of},
};
use hrdsl_trace::{
    RunEnd, Trace,
    parse::{OpenRecording, ReadError},
    record::RecordingHeader,
    vocabulary,
};

use crate::{
    ViewDocument,
    document::{LogLevel, ViewEnd, ViewLogLine},
};

use run::{ReplayedRun, TICK, tick};
pub use scene::mesh_assets;
pub use units::WrittenUnits;

/// The document of a recording; one in text has nothing but its [text](RecordingFile::text). Limits are shown in the `units` in which the scenario
/// writes them.
///
/// # Errors
/// A recording without a header, or of another scenario.
pub fn replay(program: &Program, file: &RecordingFile, units: &WrittenUnits) -> Result<ViewDocument, String> {
    let recording = OpenRecording::open(file.text.as_bytes()).map_err(|e| e.to_string())?;
    let header = recording.header().clone();
    if header.scenario != program.name {
        return Err(format!(
            "this is a recording of the scenario `{}`, not of `{}`",
            header.scenario, program.name
        ));
    }
    let mut notes = file.faults.clone();
    let mut trace = Trace::default();
    let read = recording.replay(program, &mut trace);
    let (ended, error) = match read {
        Ok(summary) => (summary.ending.kind, summary.ending.error),
        Err(error) => {
            trace.end = last_time(&trace, file);
            notes.push(unread(&error, &header, program));
            (RunEnd::Error, Some("the recording could not be read to its end".to_owned()))
        }
    };
    let scene = shown_scene(program, file, &mut notes);
    let (files, code) = code::tracks(file, &mut notes);
    let run = ReplayedRun { program, scene, file, is_whole: ended != RunEnd::Error, trace, ended, units };
    let (requirements, values) = violation::requirements(&run);
    let mut document = ViewDocument { files, code, requirements, ..document(&run, header, error, notes) };
    for track in values {
        if document.signals.iter().all(|known| known.name != track.name) {
            document.signals.push(track);
        }
    }
    Ok(document)
}

fn document(
    run: &ReplayedRun<'_>,
    header: RecordingHeader,
    error: Option<String>,
    notes: Vec<String>,
) -> ViewDocument {
    let test = header.test.map(|name| {
        name.strip_prefix(&format!("{}.", run.program.name)).map_or_else(|| name.clone(), str::to_owned)
    });
    ViewDocument {
        scenario: run.program.name.clone(),
        test,
        seed: header.seed,
        tick: u32::try_from(TICK).unwrap_or(u32::MAX),
        end: tick(run.trace.end),
        ended: match run.ended {
            RunEnd::Quiescent => ViewEnd::Quiescent,
            RunEnd::Limit => ViewEnd::Limit,
            RunEnd::Error => ViewEnd::Error,
        },
        error,
        scene: scene::scene(&run.scene),
        poses: tracks::poses(run),
        joints: tracks::joints(run),
        signals: tracks::signals(run),
        contacts: tracks::contacts(run),
        events: story::events(run),
        machines: story::machines(run),
        topics: story::topics(run),
        log: log(run),
        notes,
        ..ViewDocument::new()
    }
}

/// What a recording without an end knows last.
fn last_time(trace: &Trace, file: &RecordingFile) -> Nanos {
    let steps = trace.steps.iter().map(|step| step.time);
    let poses = file.picture.bodies.iter().flat_map(|track| &track.frames).map(|frame| frame.time);
    steps.chain(poses).max().unwrap_or(0)
}

fn unread(error: &ReadError, header: &RecordingHeader, program: &Program) -> String {
    let has_changed = header.vocabulary.as_ref().is_some_and(|found| *found != vocabulary::digest(program));
    let changed = if has_changed { "; the scenario has changed since: other events or signals" } else { "" };
    format!("The recording is shown as far as it could be read: {error}{changed}.")
}

/// The scene of the recording; without one, that of the scenario as it is now.
fn shown_scene(program: &Program, file: &RecordingFile, notes: &mut Vec<String>) -> RecordedScene {
    let now = program.world.as_ref().map(scene_of).unwrap_or_default();
    let Some(then) = &file.scene else {
        if !now.bodies.is_empty() {
            let why = if file.faults.is_empty() {
                "This recording has no picture of the world: bodies stand where they start. `hrdsl sim --replays \
                 all` records one."
            } else {
                "The picture of the world is in what cannot be read: bodies stand where they start."
            };
            notes.push(why.to_owned());
        }
        return now;
    };
    notes.extend(changed::said(then, &now));
    then.clone()
}

fn log(run: &ReplayedRun<'_>) -> Vec<ViewLogLine> {
    let level = |level| match level {
        RecordedLogLevel::Debug => LogLevel::Debug,
        RecordedLogLevel::Info => LogLevel::Info,
        RecordedLogLevel::Warning => LogLevel::Warning,
        RecordedLogLevel::Error | RecordedLogLevel::Fatal => LogLevel::Error,
    };
    let line = |entry: &hrdsl_recording::message::RecordedLogLine| ViewLogLine {
        t: tick(entry.time),
        level: level(entry.level),
        program: (!entry.program.is_empty()).then(|| entry.program.clone()),
        text: entry.text.clone(),
    };
    run.file.log.iter().map(line).collect()
}
