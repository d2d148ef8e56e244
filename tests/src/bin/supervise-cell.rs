//! The supervisor of cells, for tests that run a campaign in their own process.

use std::process::ExitCode;

fn main() -> ExitCode {
    let args: Vec<_> = std::env::args_os().skip(1).collect();
    hrdsl_runtime::campaign::supervise(&args)
}
