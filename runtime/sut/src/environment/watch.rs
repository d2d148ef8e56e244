//! A command that takes its time: what it says is told while it works.

use std::{
    io::{BufRead as _, BufReader, Read},
    process::{Command, ExitStatus, Stdio},
    sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel},
    thread,
    time::Duration,
};

use crate::error::SutError;

/// Between signs of life of a command that says nothing.
const TICK: Duration = Duration::from_secs(1);

/// A command that has ended, and its lines that are not empty.
pub(super) struct PipSaid {
    pub status: ExitStatus,
    pub stdout: Vec<String>,
    pub stderr: Vec<String>,
}

#[derive(Clone, Copy)]
enum PipStream {
    Stdout,
    Stderr,
}

/// Runs a command; `on_work` gets its last line on standard output, at each line and at least once a second.
pub(super) fn watch(command: &mut Command, on_work: &dyn Fn(&str)) -> Result<PipSaid, SutError> {
    let fail = || SutError::io(format!("cannot start {}", command.get_program().to_string_lossy()));
    let mut child = {
        let fail = fail();
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().map_err(fail)?
    };
    let fail = || SutError::io("cannot wait for a command");
    let (sender, lines) = channel();
    read_lines(child.stdout.take(), PipStream::Stdout, sender.clone());
    read_lines(child.stderr.take(), PipStream::Stderr, sender);
    let (mut stdout, mut stderr): (Vec<String>, Vec<String>) = (Vec::new(), Vec::new());
    while let Some(line) = next(&lines, &mut child).map_err(fail())? {
        match line {
            Some((PipStream::Stdout, line)) => stdout.push(line),
            Some((PipStream::Stderr, line)) => stderr.push(line),
            None => {}
        }
        on_work(stdout.last().map_or("", |line| line.trim()));
    }
    Ok(PipSaid { status: child.wait().map_err(fail())?, stdout, stderr })
}

type StreamLine = Option<(PipStream, String)>;

/// A line, or none within a tick; `None` at the end. A process that the command has left behind may hold its output
/// open: that is not waited for.
fn next(
    lines: &Receiver<(PipStream, String)>,
    child: &mut std::process::Child,
) -> std::io::Result<Option<StreamLine>> {
    match lines.recv_timeout(TICK) {
        Ok(line) => Ok(Some(Some(line))),
        Err(RecvTimeoutError::Disconnected) => Ok(None),
        Err(RecvTimeoutError::Timeout) => Ok(child.try_wait()?.is_none().then_some(None)),
    }
}

fn read_lines(
    stream: Option<impl Read + Send + 'static>,
    which: PipStream,
    sender: Sender<(PipStream, String)>,
) {
    let Some(stream) = stream else { return };
    thread::spawn(move || {
        for line in BufReader::new(stream).split(b'\n').map_while(Result::ok) {
            let line = String::from_utf8_lossy(&line).trim_end().to_owned();
            if !line.is_empty() && sender.send((which, line)).is_err() {
                return;
            }
        }
    });
}
