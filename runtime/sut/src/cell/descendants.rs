//! The processes below the supervisor: what they use, whether they sleep, and their end.
//!
//! The supervisor adopts whatever loses its parent (it is the first process of its namespace, or the subreaper), so that
//! everything the program ever started is below it.

use std::{
    fs,
    time::{Duration, Instant},
};

use nix::{
    sys::signal::{Signal, kill},
    unistd::Pid,
};
use rustix::process::{WaitId, WaitIdOptions, waitid};

use super::message::CellUsage;

/// The kernel's unit of processor time in `/proc`, the same on every Linux.
const TICKS_PER_SECOND: u64 = 100;

/// How long the end of all processes may take before it is looked at again.
const PAUSE: Duration = Duration::from_millis(1);

/// How long a process may resist SIGKILL: one that waits in the kernel for a device may do so for ever.
const PATIENCE: Duration = Duration::from_secs(20);

/// Of `/proc/PID/stat`, what is needed here.
struct ProcessStat {
    /// `R` running, `D` waiting for a disk, `S` asleep, `T` stopped, `Z` dead …
    state: u8,
    /// Page faults of the children that it has waited for: above zero if there were any.
    children_faults: u64,
    /// Its own processor time.
    own: u64,
    /// That of the children that it has waited for.
    children: u64,
}

fn stat(path: &str) -> Option<ProcessStat> {
    let text = fs::read_to_string(path).ok()?;
    // The name, in parentheses, may hold anything.
    let rest = text.get(text.rfind(')')? + 2..)?;
    let fields: Vec<&str> = rest.split_ascii_whitespace().collect();
    // Numbered as in proc(5), where the state is the third.
    let number = |field: usize| fields.get(field - 3)?.parse::<u64>().ok();
    Some(ProcessStat {
        state: *fields.first()?.as_bytes().first()?,
        children_faults: number(11)?,
        own: number(14)? + number(15)?,
        children: number(16)? + number(17)?,
    })
}

/// All processes below this one, parents first.
pub(super) fn descendants() -> Vec<i32> {
    let mut found = Vec::new();
    let mut open = vec!["self".to_owned()];
    while let Some(parent) = open.pop() {
        let Ok(threads) = fs::read_dir(format!("/proc/{parent}/task")) else { continue };
        for thread in threads.filter_map(Result::ok) {
            let children = fs::read_to_string(thread.path().join("children")).unwrap_or_default();
            for child in children.split_ascii_whitespace() {
                if let Ok(pid) = child.parse() {
                    found.push(pid);
                    open.push(child.to_owned());
                }
            }
        }
    }
    found
}

/// Whether there is any process below this one, be it one that has ended and was not yet waited for.
pub(super) fn are_there() -> bool {
    waitid(WaitId::All, WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT).is_ok()
}

/// What the processes of the cell have used: those that this process has waited for are in its own children's time.
pub(super) fn usage() -> CellUsage {
    let mut ticks = stat("/proc/self/stat").map_or(0, |s| s.children);
    let mut asleep = true;
    for pid in descendants() {
        ticks += stat(&format!("/proc/{pid}/stat")).map_or(0, |s| s.own + s.children);
        asleep &= sleeps(pid);
    }
    CellUsage { cpu: Duration::from_millis(ticks * 1000 / TICKS_PER_SECOND), asleep }
}

fn sleeps(pid: i32) -> bool {
    let Ok(threads) = fs::read_dir(format!("/proc/{pid}/task")) else { return true };
    threads.filter_map(Result::ok).all(|thread| {
        let stat = stat(&thread.path().join("stat").to_string_lossy());
        stat.is_none_or(|s| !matches!(s.state, b'R' | b'D'))
    })
}

/// Whether a process that has ended, and was not yet waited for, ever waited for a child of its own.
pub(super) fn had_children(pid: i32) -> bool {
    stat(&format!("/proc/{pid}/stat")).is_some_and(|s| s.children_faults > 0)
}

/// Sends a signal to every process below this one.
pub(super) fn signal_all(signal: Signal) {
    for pid in descendants() {
        let _ = kill(Pid::from_raw(pid), signal);
    }
}

/// Kills every process below this one and waits for them; whether there were any. `alone`: this is the first process of
/// its namespace, whose members can be killed at one blow.
pub(super) fn end_all(alone: bool) -> bool {
    let until = Instant::now() + PATIENCE;
    let mut any = false;
    loop {
        if alone {
            let _ = kill(Pid::from_raw(-1), Signal::SIGKILL);
        } else {
            // Stopped first, so that none of them makes new ones while the others are looked for.
            signal_all(Signal::SIGSTOP);
            signal_all(Signal::SIGKILL);
        }
        loop {
            match waitid(WaitId::All, WaitIdOptions::EXITED | WaitIdOptions::NOHANG) {
                Ok(Some(_)) => any = true,
                Ok(None) => break,
                Err(_) => return any,
            }
        }
        if Instant::now() > until {
            return any;
        }
        std::thread::sleep(PAUSE);
    }
}
