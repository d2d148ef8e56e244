//! At which lines of its code the system was.

use hrdsl_recording::{
    RecordingFile,
    message::{LineColumns, LinesMessage},
};

use super::run::tick;
use crate::{
    columns::{differences, sums},
    document::{CodeTrack, ViewSourceFile},
};

/// The files of all programs, and where in them each thread was.
pub(super) fn tracks(file: &RecordingFile, notes: &mut Vec<String>) -> (Vec<ViewSourceFile>, Vec<CodeTrack>) {
    let (mut files, mut tracks) = (Vec::new(), Vec::new());
    for program in &file.lines {
        let places: Vec<usize> = program
            .files
            .iter()
            .map(|found| {
                let same = |known: &ViewSourceFile| known.name == found.name && known.crc == found.crc;
                files.iter().position(same).unwrap_or_else(|| {
                    files.push(ViewSourceFile { name: found.name.clone(), text: None, crc: found.crc });
                    files.len() - 1
                })
            })
            .collect();
        for thread in &program.threads {
            match track(program, thread, &places) {
                Some(track) => tracks.push(track),
                None => notes.push(format!(
                    "The lines at which {} was in {} cannot be read, and are left out.",
                    program.program, thread.thread
                )),
            }
        }
        if program.unseen > 0 {
            notes.push(format!(
                "Of {} more threads of {} nobody knows at which lines they were.",
                program.unseen, program.program
            ));
        }
    }
    (files, tracks)
}

/// `None` of columns that are not of one length, or that speak of a file that is not there.
fn track(program: &LinesMessage, thread: &LineColumns, places: &[usize]) -> Option<CodeTrack> {
    let is_of_one_length = thread.t.len() == thread.file.len() && thread.t.len() == thread.line.len();
    let place = |file: i64| Some(*places.get(usize::try_from(file).ok()?)? as i64);
    let file: Option<Vec<i64>> = sums(&thread.file).into_iter().map(place).collect();
    is_of_one_length.then_some(CodeTrack {
        program: program.program.clone(),
        thread: thread.thread.clone(),
        until: program.until.map(tick),
        t: differences(sums(&thread.t).into_iter().map(|time| tick(time).cast_signed())),
        file: differences(file?),
        line: thread.line.clone(),
    })
}
