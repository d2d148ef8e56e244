//! How much sooner several threads come to the end: whole processes of searches that take longer than a second, by the wall clock;
//! beside it what as many processes get out of the machine.

use std::{path::Path, process::Stdio, time::Instant};

use super::peer;

/// Each a family and its size.
const SEARCHES: [(&str, i64); 8] = [
    ("fischer", 11),
    ("csma_cd", 12),
    ("critical_region", 5),
    ("train_gate", 6),
    ("fire_alarm", 18),
    ("fischer_async", 11),
    ("corsso", 6),
    ("philosophers", 11),
];

/// Each is done so often, in turn, and the least time counts.
const TIMES: usize = 3;

/// How long a search took, in seconds of the wall clock.
struct SpeedupFigures {
    one_thread: f64,
    all_threads: f64,
    /// As many processes at once as there are threads, each with one thread.
    at_once: f64,
}

/// Prints a row for each search. The last two columns tell what the machine takes from what the search could win: how much more work
/// processes that share nothing do at once than one after the other, and which part of that the threads come to.
///
/// # Errors
/// If a process cannot be started, or fails.
pub fn print(me: &Path, threads: usize) -> Result<(), String> {
    println!(
        "{:<16}{:>5}{:>12}{:>12}{:>10}{:>14}{:>9}",
        "family",
        "size",
        "1 thread, s",
        format!("{threads}, s"),
        "speed-up",
        format!("{threads} processes"),
        "of that"
    );
    for (name, size) in SEARCHES {
        let f = SpeedupFigures::of(me, (name, size), threads)?;
        let (speedup, machine) = (f.one_thread / f.all_threads, threads as f64 * f.one_thread / f.at_once);
        println!(
            "{name:<16}{size:>5}{:>12.3}{:>12.3}{speedup:>8.2} ×{machine:>12.2} ×{:>7.0} %",
            f.one_thread,
            f.all_threads,
            100.0 * speedup / machine
        );
    }
    Ok(())
}

impl SpeedupFigures {
    /// In turn, since what else the machine does comes and goes.
    fn of(me: &Path, search: (&str, i64), threads: usize) -> Result<Self, String> {
        let mut least =
            Self { one_thread: f64::INFINITY, all_threads: f64::INFINITY, at_once: f64::INFINITY };
        for _ in 0..TIMES {
            least.one_thread = least.one_thread.min(seconds(me, search, 1, 1)?);
            least.all_threads = least.all_threads.min(seconds(me, search, threads, 1)?);
            least.at_once = least.at_once.min(seconds(me, search, 1, threads)?);
        }
        Ok(least)
    }
}

/// Until so many processes that begin at once have ended, each with so many threads.
#[allow(clippy::disallowed_methods, reason = "a bench measures by the wall clock")]
fn seconds(me: &Path, (name, size): (&str, i64), threads: usize, processes: usize) -> Result<f64, String> {
    let (size, threads) = (size.to_string(), threads.to_string());
    let mut command = peer::command(me);
    command.args(["--one", name, "--of", &size, "--threads", &threads]);
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    let begun = Instant::now();
    let started: Vec<_> = (0..processes).map(|_| command.spawn()).collect();
    let ended = started.into_iter().map(|process| process.and_then(|p| p.wait_with_output()));
    let ended: Vec<_> = ended.collect::<Result<_, _>>().map_err(|e| e.to_string())?;
    let seconds = begun.elapsed().as_secs_f64();
    match ended.iter().find(|out| !out.status.success()) {
        Some(out) => Err(String::from_utf8_lossy(&out.stderr).trim().to_owned()),
        None => Ok(seconds),
    }
}
