//! How much sooner several threads come to the end: whole processes of searches that take longer than a second, by the wall clock.

use std::{path::Path, time::Instant};

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

/// Each is done so often, and the least time counts.
const TIMES: usize = 3;

/// Prints a row for each search.
///
/// # Errors
/// If a process cannot be started, or fails.
pub fn print(me: &Path, threads: usize) -> Result<(), String> {
    println!("{:<16}{:>5}{:>12}{:>12}", "family", "size", "1 thread, s", format!("{threads}, s"));
    for (name, size) in SEARCHES {
        let one = least(me, name, size, 1)?;
        let many = least(me, name, size, threads)?;
        println!("{name:<16}{size:>5}{one:>12.3}{many:>12.3}{:>8.2} ×", one / many);
    }
    Ok(())
}

#[allow(clippy::disallowed_methods, reason = "a bench measures by the wall clock")]
fn least(me: &Path, name: &str, size: i64, threads: usize) -> Result<f64, String> {
    let mut least = f64::INFINITY;
    for _ in 0..TIMES {
        let (size, threads) = (size.to_string(), threads.to_string());
        let mut command = peer::command(me);
        command.args(["--one", name, "--of", &size, "--threads", &threads]);
        let begun = Instant::now();
        let out = command.output().map_err(|e| e.to_string())?;
        least = least.min(begun.elapsed().as_secs_f64());
        if !out.status.success() {
            return Err(String::from_utf8_lossy(&out.stderr).trim().to_owned());
        }
    }
    Ok(least)
}
