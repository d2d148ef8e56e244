//! What a program may use, and what would make its runs differ: set on the supervisor, inherited by the program.

use nix::sys::personality::{self, Persona};
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};

/// The size of a stack; where a program's mappings begin depends on it.
const STACK: u64 = 8 << 20;
/// How many files a process may have open.
const FILES: u64 = 1024;

/// Limits the private memory of each process, and makes the rest the same wherever the campaign was started.
///
/// `RLIMIT_DATA` counts what is mapped privately to be written, from the first byte: the same program fails at the same
/// allocation in every run, which no measure of resident memory would give.
pub(super) fn limit_resources(memory: u64) {
    let lower = |resource, limit: u64| {
        let hard = getrlimit(resource).maximum.map_or(limit, |hard| hard.min(limit));
        // A limit can always be lowered; where it cannot, the program runs without it.
        let _ = setrlimit(resource, Rlimit { current: Some(hard), maximum: Some(hard) });
    };
    lower(Resource::Data, memory);
    lower(Resource::Stack, STACK);
    lower(Resource::Core, 0);
    let hard = getrlimit(Resource::Nofile).maximum;
    let files = Rlimit { current: Some(hard.map_or(FILES, |hard| hard.min(FILES))), maximum: hard };
    let _ = setrlimit(Resource::Nofile, files);
}

/// Switches off the randomisation of addresses for the programs started from here on; whether that was allowed.
pub(super) fn fix_addresses() -> bool {
    personality::get().and_then(|now| personality::set(now | Persona::ADDR_NO_RANDOMIZE)).is_ok()
}
