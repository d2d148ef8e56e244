//! The pipes and files by which a program is spoken to and heard.

use std::{
    fs::File,
    io,
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
