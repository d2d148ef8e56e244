//! A recording in the form that other tools play: each change a message of Foxglove's.

use hrdsl_ir::Program;
use hrdsl_trace::{Trace, parse::OpenRecording};

use crate::{
    read::RecordingFile,
    write::{RecordingForm, RunOnFile, write_as},
};

/// A file that was read as one in which each change is a message. It reads back to the same.
///
/// # Errors
/// A recording that is not whole, is of another scenario, or has no picture.
pub fn export(program: &Program, file: &RecordingFile) -> Result<Vec<u8>, String> {
    if let Some(fault) = file.faults.first() {
        return Err(format!("only whole recordings are written for other tools, and {fault}"));
    }
    let scene = file.scene.as_ref().ok_or("it has no picture of the world, which other tools would show")?;
    let recording = OpenRecording::open(file.text.as_bytes()).map_err(|e| e.to_string())?;
    let mut trace = Trace::default();
    recording.replay(program, &mut trace).map_err(|e| e.to_string())?;
    let run = RunOnFile {
        trace: &trace,
        text: &file.text,
        scene,
        picture: &file.picture,
        log: &file.log,
        topics: &file.topics,
        lines: &file.lines,
        verdicts: &file.verdicts,
    };
    write_as(&run, RecordingForm::Messages)
}
