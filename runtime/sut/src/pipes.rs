//! The pipes and files by which a program is spoken to and heard.

use std::{
    fs::File,
    io,
    ops::Range,
    os::fd::{AsFd, OwnedFd},
};

use rustix::{
    fs::{MemfdFlags, OFlags, fcntl_getfl, fcntl_setfl, memfd_create},
    io::Errno,
    pipe::{PipeFlags, pipe_with},
};

use crate::output::StreamCapture;

/// An output stream of the program.
#[derive(Debug)]
pub(crate) struct ProcessStream {
    pub fd: Option<OwnedFd>,
    pub capture: StreamCapture,
}

impl ProcessStream {
    pub fn new(fd: Option<OwnedFd>, limit: usize) -> Self {
        let fd = fd.filter(|fd| unblock(fd).is_ok());
        Self { fd, capture: StreamCapture::new(limit) }
    }

    /// Reads once; whether there may be more.
    pub fn read(&mut self, chunk: &mut [u8]) -> bool {
        let Some(fd) = &self.fd else { return false };
        match rustix::io::read(fd, &mut *chunk) {
            Ok(0) => self.fd = None,
            Ok(n) => self.capture.push(&chunk[..n]),
            Err(Errno::INTR) => return true,
            Err(Errno::AGAIN) => return false,
            Err(_) => self.fd = None,
        }
        self.fd.is_some()
    }
}

/// What was read from a pipe, of which lines are taken one at a time.
#[derive(Debug, Default)]
pub(crate) struct LineBuffer {
    bytes: Vec<u8>,
    /// Where the line is that was taken last.
    line: Range<usize>,
    /// Where what comes after it begins.
    rest: usize,
    /// From there to here is no line end.
    scanned: usize,
}

impl LineBuffer {
    pub fn push(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// Takes the next line; whether there was a whole one.
    pub fn advance(&mut self) -> bool {
        if let Some(length) = self.line_end() {
            let end = self.scanned + length;
            self.line = self.rest..end;
            self.rest = end + 1;
            self.scanned = self.rest;
            return true;
        }
        // Here, and not at each line, what was taken makes room: so each byte is moved once at most.
        self.bytes.drain(..self.rest);
        self.line = 0..0;
        self.rest = 0;
        self.scanned = self.bytes.len();
        false
    }

    /// The line that was taken last, without its end.
    pub fn line(&self) -> &[u8] {
        self.bytes.get(self.line.clone()).unwrap_or_default()
    }

    /// What comes after it.
    pub fn rest(&self) -> &[u8] {
        self.bytes.get(self.rest..).unwrap_or_default()
    }

    /// Whether there is another whole line.
    pub fn has_line(&self) -> bool {
        self.line_end().is_some()
    }

    pub fn clear(&mut self) {
        *self = Self { bytes: std::mem::take(&mut self.bytes), ..Self::default() };
        self.bytes.clear();
    }

    fn line_end(&self) -> Option<usize> {
        self.bytes.get(self.scanned..)?.iter().position(|b| *b == b'\n')
    }
}

fn unblock(fd: impl AsFd) -> io::Result<()> {
    let flags = fcntl_getfl(&fd)?;
    fcntl_setfl(&fd, flags | OFlags::NONBLOCK)?;
    Ok(())
}

/// Requests: our end, its end; replies: its end, our end. Ours do not block. None is inherited by whatever else is started:
/// its ends are handed to the cell.
pub(crate) fn pipes_for_child() -> io::Result<(OwnedFd, OwnedFd, OwnedFd, OwnedFd)> {
    let (requests, its_requests) = pipe_with(PipeFlags::CLOEXEC)?;
    let (its_replies, replies) = pipe_with(PipeFlags::CLOEXEC)?;
    unblock(&requests)?;
    unblock(&replies)?;
    Ok((requests, its_requests, its_replies, replies))
}

/// A file in memory, for the coverage: it has no name, and is gone with the last who has it open.
pub(crate) fn coverage_file() -> io::Result<File> {
    Ok(File::from(memfd_create("hrdsl-coverage", MemfdFlags::CLOEXEC)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_come_one_at_a_time_however_they_were_read() {
        let text = b"first\n\nthird line\nrest";
        for size in 1..=text.len() {
            let mut buffer = LineBuffer::default();
            let mut lines = Vec::new();
            for piece in text.chunks(size) {
                buffer.push(piece);
                while buffer.has_line() {
                    assert!(buffer.advance());
                    lines.push(String::from_utf8(buffer.line().to_vec()).unwrap());
                }
                assert!(!buffer.advance());
                assert_eq!(buffer.line(), b"");
            }
            assert_eq!(
                (lines, buffer.rest()),
                (vec!["first".into(), String::new(), "third line".into()], &b"rest"[..])
            );
            buffer.clear();
            buffer.push(b"new\n");
            assert!(buffer.advance());
            assert_eq!((buffer.line(), buffer.rest()), (&b"new"[..], &b""[..]));
        }
    }
}
