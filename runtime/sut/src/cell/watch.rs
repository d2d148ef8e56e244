//! What a supervisor waits for: the program's end, and what the harness asks meanwhile.

use std::os::fd::{AsFd, BorrowedFd};

use nix::{
    sys::{
        signal::Signal,
        signalfd::SignalFd,
        wait::{Id, WaitPidFlag, WaitStatus, waitid},
    },
    unistd::Pid,
};
use rustix::{
    event::{PollFd, PollFlags, poll},
    io::Errno,
};

use super::{
    control::ControlSocket,
    descendants,
    message::{CellReport, CellRequest},
};
use crate::exit::ProgramExit;

/// Waits for the program's end and for what the harness asks.
pub(super) struct ProgramWatch<'c> {
    pub control: &'c mut ControlSocket,
    ended: SignalFd,
    /// Whether there was ever another process.
    pub others: bool,
    /// How the program ended.
    pub main: Option<ProgramExit>,
}

impl<'c> ProgramWatch<'c> {
    /// `ended` tells of the signals of children that have ended.
    pub fn new(control: &'c mut ControlSocket, ended: SignalFd) -> Self {
        Self { control, ended, others: false, main: None }
    }

    /// Returns when the program has ended or is to end; whether the harness is still there.
    pub fn wait(&mut self, child: Pid) -> bool {
        loop {
            self.reap(child);
            if self.main.is_some() {
                return true;
            }
            let control: BorrowedFd<'_> = self.control.socket.as_fd();
            let mut fds = [PollFd::new(&control, PollFlags::IN), PollFd::new(&self.ended, PollFlags::IN)];
            match poll(&mut fds, None) {
                Ok(_) | Err(Errno::INTR) => {}
                Err(_) => return false,
            }
            let (asked, ended) = (!fds[0].revents().is_empty(), !fds[1].revents().is_empty());
            if ended {
                while let Ok(Some(_)) = self.ended.read_signal() {}
            }
            if asked && !self.control.read() {
                return false;
            }
            while let Some(line) = self.control.take_line() {
                match serde_json::from_slice(&line) {
                    Ok(CellRequest::Usage) => self.control.report(&CellReport::Usage(descendants::usage())),
                    Ok(CellRequest::Terminate) => descendants::signal_all(Signal::SIGTERM),
                    Ok(CellRequest::Kill) => return true,
                    Err(_) => return false,
                }
            }
        }
    }

    /// Waits for the harness's end, and for whoever ends meanwhile.
    pub fn wait_for_harness(&mut self) {
        loop {
            while let Ok(Some(_)) = self.ended.read_signal() {}
            while waitid(Id::All, WaitPidFlag::WEXITED | WaitPidFlag::WNOHANG)
                .is_ok_and(|status| status != WaitStatus::StillAlive)
            {}
            let control: BorrowedFd<'_> = self.control.socket.as_fd();
            let mut fds = [PollFd::new(&control, PollFlags::IN), PollFd::new(&self.ended, PollFlags::IN)];
            if !matches!(poll(&mut fds, None), Ok(_) | Err(Errno::INTR)) {
                return;
            }
            // It asks for nothing any more but the end.
            if !fds[0].revents().is_empty() {
                return;
            }
        }
    }

    /// Waits for whoever has ended: the program, or what it left behind.
    fn reap(&mut self, child: Pid) {
        let look = WaitPidFlag::WEXITED | WaitPidFlag::WNOHANG | WaitPidFlag::WNOWAIT;
        while let Ok(status) = waitid(Id::All, look) {
            let (pid, exit) = if let WaitStatus::Exited(pid, code) = status {
                (pid, ProgramExit::Code(code))
            } else if let WaitStatus::Signaled(pid, signal, _) = status {
                (pid, ProgramExit::Signal(signal as i32))
            } else {
                return;
            };
            if pid == child {
                // While it is not yet waited for, the kernel still tells.
                self.others |= descendants::had_children(pid.as_raw());
                self.main = Some(exit);
            } else {
                self.others = true;
            }
            let _ = waitid(Id::Pid(pid), WaitPidFlag::WEXITED | WaitPidFlag::WNOHANG);
            if self.main.is_some() {
                return;
            }
        }
    }
}
