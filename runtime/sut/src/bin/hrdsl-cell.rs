//! The supervisor of cells as a program of its own.

use std::process::ExitCode;

fn main() -> ExitCode {
    let args: Vec<_> = std::env::args_os().skip(1).collect();
    hrdsl_sut::cell::supervise(&args)
}
