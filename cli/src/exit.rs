//! Exit codes, defined once; `--help` and `spec/cli.md` list them.

use std::process::ExitCode;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandExit {
    /// All is well; there may be warnings that are not denied.
    Ok = 0,
    /// A scenario has errors, or warnings that are denied, a file is not formatted, one to import cannot be understood,
    /// the agents of a run cannot go on, a network that is searched is at fault, or too few mutants are noticed.
    Errors = 1,
    /// The command line is wrong, or a file cannot be read or written.
    Usage = 2,
    /// A requirement was violated, a query is not satisfied, a test broke off, a case of the conformance suite failed, or tests of mutants measure
    /// nothing.
    Findings = 3,
    /// A requirement or query is inconclusive: the budget was used up first.
    Inconclusive = 4,
    /// A campaign or a search was interrupted; what had ended, or was known, is told.
    Interrupted = 5,
    /// Something is wrong with hrdsl itself (`EX_SOFTWARE` of sysexits.h).
    Internal = 70,
}

/// What `hrdsl --help` says about them.
pub const HELP: &str = "\
Exit codes:
  0  all is well
  1  a scenario has errors, or warnings that `check --deny` makes errors; `fmt --check`: a file would change;
     `import`: a file is no program, or `--strict` and something is left out; `inspect`, `run`: the agents cannot go
     on (a livelock, the cycle bound, a fault of the model); `prove`, `step`: a network is at fault; `mutate`: the score is
     below --min-score
  2  the command line is wrong, or a file cannot be read or written; `step`: what is piped in is no command, or not possible
  3  `sim`, `judge`: a requirement was violated, a test broke off (see --exit-zero), or --check-determinism, --repeat,
     --schedules or --physics-steps found a difference;
     `prove`: a requirement is violated, a query is not satisfied, or with --follow a run is none of the network;
     `conformance`: a case failed; `mutate`: the tests measure nothing of a file, or do not repeat
  4  `prove`: something is inconclusive, since the budget was used up, and nothing else is wrong
  5  `sim`, `mutate`, `prove`: interrupted; the results are those of the tests that had ended, or what was known
  70 hrdsl itself is at fault: an internal error, which is worth a report";

impl From<CommandExit> for ExitCode {
    fn from(exit: CommandExit) -> Self {
        ExitCode::from(exit as u8)
    }
}
