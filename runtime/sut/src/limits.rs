//! What a program under test may use, and what it means that it used more.

use std::{
    fmt,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

/// The limits of one test. All times but `wall` are the program's own: load on the machine does not use them up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProgramLimits {
    /// Of processor time, or else of sleep, between two requests.
    pub budget: Duration,
    /// Of processor time in the whole test.
    pub cpu: Duration,
    /// Of wall time in the whole test; only guards against what the others do not see.
    pub wall: Duration,
    /// Of private memory, in bytes, for each process.
    pub memory: u64,
    /// Of output, in bytes.
    pub output: u64,
}

impl Default for ProgramLimits {
    fn default() -> Self {
        Self {
            budget: Duration::from_secs(10),
            cpu: Duration::from_secs(300),
            wall: Duration::from_secs(3600),
            memory: 4 << 30,
            output: 256 << 20,
        }
    }
}

/// Which limit a program went over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitOverrun {
    Budget(Duration),
    /// It slept where simulated time does not reach, for so much wall time.
    Asleep(Duration),
    Cpu(Duration),
    Wall(Duration),
    Output(u64),
}

impl LimitOverrun {
    /// Whether another run, on a machine that does nothing else, might come to another end.
    #[must_use]
    pub fn is_of_wall_time(self) -> bool {
        match self {
            LimitOverrun::Asleep(_) | LimitOverrun::Wall(_) => true,
            LimitOverrun::Budget(_) | LimitOverrun::Cpu(_) | LimitOverrun::Output(_) => false,
        }
    }

    /// The sentence about a program that did not do `what`.
    pub(crate) fn describe(self, what: &str, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = |t: Duration| format!("{} s", t.as_secs_f64());
        match self {
            LimitOverrun::Budget(t) => {
                write!(
                    f,
                    "the program did not {what} within {} of processor time (`budget` in `system`)",
                    seconds(t)
                )
            }
            LimitOverrun::Asleep(t) => write!(
                f,
                "the program did not {what}: it slept for {} of wall time, where simulated time does not pass (a lock, a \
                 socket, a timeout inside C code; `budget` in `system`)",
                seconds(t)
            ),
            LimitOverrun::Cpu(t) => {
                write!(
                    f,
                    "the program used more than {} of processor time in this test (`cpu` in `system`)",
                    seconds(t)
                )
            }
            LimitOverrun::Wall(t) => {
                write!(f, "the test took more than {} of wall time (`wall` in `system`)", seconds(t))
            }
            LimitOverrun::Output(bytes) => {
                write!(f, "the program wrote more than {bytes} bytes of output (`output` in `system`)")
            }
        }
    }
}

/// Set once, from anywhere: everything that runs is to end.
#[derive(Clone, Debug, Default)]
pub struct StopFlag(Arc<AtomicBool>);

impl StopFlag {
    /// One that is set by who has the other end.
    #[must_use]
    pub fn from_shared(flag: Arc<AtomicBool>) -> Self {
        Self(flag)
    }

    #[must_use]
    pub fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
