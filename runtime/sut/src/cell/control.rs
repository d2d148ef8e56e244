//! The supervisor's end of the connection to the harness: orders and requests in, reports out.

use std::{
    io::{self, Write},
    mem::MaybeUninit,
    os::fd::OwnedFd,
};

use rustix::{
    io::Errno,
    net::{RecvAncillaryBuffer, RecvAncillaryMessage, RecvFlags, recvmsg},
};

use super::message::{CellOrder, CellReport};

/// The supervisor's end of the connection.
pub(super) struct ControlSocket {
    pub socket: OwnedFd,
    inbox: Vec<u8>,
}

impl ControlSocket {
    pub fn new(socket: OwnedFd) -> Self {
        Self { socket, inbox: Vec::new() }
    }

    /// The harness may be gone; then the next look at the socket says so.
    pub fn report(&mut self, report: &CellReport) {
        if let Ok(mut line) = serde_json::to_vec(report) {
            line.push(b'\n');
            let _ = std::fs::File::from(match self.socket.try_clone() {
                Ok(socket) => socket,
                Err(_) => return,
            })
            .write_all(&line);
        }
    }

    /// The order, and the program's descriptors; `None` if the harness is gone.
    pub fn order(&mut self) -> io::Result<Option<(CellOrder, Vec<OwnedFd>)>> {
        let mut descriptors = Vec::new();
        loop {
            if let Some(line) = self.take_line() {
                return Ok(Some((serde_json::from_slice(&line)?, descriptors)));
            }
            let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(8))];
            let mut ancillary = RecvAncillaryBuffer::new(&mut space);
            let mut chunk = [0; 4096];
            let mut parts = [io::IoSliceMut::new(&mut chunk)];
            // Inherited by the program, since they are not closed at its start.
            let got = recvmsg(&self.socket, &mut parts, &mut ancillary, RecvFlags::empty())?;
            for message in ancillary.drain() {
                if let RecvAncillaryMessage::ScmRights(rights) = message {
                    descriptors.extend(rights);
                }
            }
            if got.bytes == 0 {
                return Ok(None);
            }
            self.inbox.extend_from_slice(&chunk[..got.bytes]);
        }
    }

    pub fn take_line(&mut self) -> Option<Vec<u8>> {
        let end = self.inbox.iter().position(|b| *b == b'\n')?;
        let mut line: Vec<u8> = self.inbox.drain(..=end).collect();
        line.pop();
        Some(line)
    }

    /// Reads what there is; whether the harness is still there.
    pub fn read(&mut self) -> bool {
        let mut chunk = [0; 256];
        match rustix::io::read(&self.socket, &mut chunk) {
            Ok(0) => false,
            Ok(n) => {
                self.inbox.extend_from_slice(&chunk[..n]);
                true
            }
            Err(Errno::INTR | Errno::AGAIN) => true,
            Err(_) => false,
        }
    }
}
