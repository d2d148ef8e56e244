//! The clocks of processor time: of a thread, of this process, and of the processes that it has started.

use std::time::Duration;

use nix::{
    sys::{
        resource::{Usage, UsageWho, getrusage},
        time::TimeVal,
    },
    time::{ClockId, clock_gettime},
};

/// Clocks of processor time. One that the system does not have stands still.
#[derive(Clone, Copy, Debug)]
pub struct ProcessorClocks {
    /// Of the calling thread.
    pub thread: fn() -> Duration,
    /// Of all threads of this process.
    pub process: fn() -> Duration,
    /// Of all processes below this one that have ended.
    pub children: fn() -> Duration,
}

impl ProcessorClocks {
    /// Those of the system.
    pub const SYSTEM: Self = Self { thread, process, children };

    /// What a look at the thread's clock takes.
    #[must_use]
    pub fn reading(&self) -> Duration {
        const LOOKS: u32 = 10_000;
        let begun = (self.thread)();
        for _ in 1..LOOKS {
            std::hint::black_box((self.thread)());
        }
        (self.thread)().saturating_sub(begun) / LOOKS
    }
}

fn thread() -> Duration {
    clock(ClockId::CLOCK_THREAD_CPUTIME_ID)
}

fn process() -> Duration {
    clock(ClockId::CLOCK_PROCESS_CPUTIME_ID)
}

fn children() -> Duration {
    getrusage(UsageWho::RUSAGE_CHILDREN).map(|used| total(&used)).unwrap_or_default()
}

fn clock(id: ClockId) -> Duration {
    clock_gettime(id).map(Duration::from).unwrap_or_default()
}

/// In user and in system mode.
fn total(used: &Usage) -> Duration {
    let time = |t: TimeVal| {
        let (seconds, micros) = (t.tv_sec(), t.tv_usec());
        Duration::from_micros((seconds * 1_000_000 + micros).try_into().unwrap_or_default())
    };
    time(used.user_time()) + time(used.system_time())
}

#[cfg(test)]
mod tests {
    use super::ProcessorClocks;

    #[test]
    fn clocks_go_on_while_something_works() {
        let clocks = ProcessorClocks::SYSTEM;
        let (thread, process) = ((clocks.thread)(), (clocks.process)());
        let mut sum = 0_u64;
        while (clocks.thread)() == thread || (clocks.process)() == process {
            sum = std::hint::black_box(sum.wrapping_add(1));
        }
        assert!((clocks.process)() > process);
    }

    #[test]
    fn a_child_that_has_ended_is_counted() {
        let before = (ProcessorClocks::SYSTEM.children)();
        let run = || std::process::Command::new("true").status();
        while (ProcessorClocks::SYSTEM.children)() == before {
            assert!(run().is_ok());
        }
        assert!((ProcessorClocks::SYSTEM.children)() > before);
    }
}
