//! Pinning to a core: a parent and its child in lock-step never run at once, and sharing a core's caches and run queue
//! makes a round trip about four times faster than waking another core.

use std::io;

/// Lets the calling thread, and the processes that it starts from now on, run on one core only.
///
/// `k` counts the cores that were allowed at the first call, and wraps around. Does nothing where the system has no such
/// call.
///
/// # Errors
/// If the system refuses.
pub fn pin_to_core(k: usize) -> io::Result<()> {
    pin(k)
}

#[cfg(any(target_os = "linux", target_os = "android"))]
fn pin(k: usize) -> io::Result<()> {
    use std::sync::OnceLock;

    use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};

    // The first call sees what the process was given; later ones may come from a thread that is pinned already.
    static ALLOWED: OnceLock<Vec<usize>> = OnceLock::new();
    if ALLOWED.get().is_none() {
        let set = sched_getaffinity(None)?;
        let _ = ALLOWED.set((0..CpuSet::MAX_CPU).filter(|&cpu| set.is_set(cpu)).collect());
    }
    let Some(allowed) = ALLOWED.get().filter(|a| !a.is_empty()) else { return Ok(()) };
    let mut set = CpuSet::new();
    set.set(allowed[k % allowed.len()]);
    sched_setaffinity(None, &set)?;
    Ok(())
}

#[cfg(not(any(target_os = "linux", target_os = "android")))]
fn pin(_: usize) -> io::Result<()> {
    Ok(())
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use rustix::thread::{sched_getaffinity, sched_getcpu};

    #[test]
    fn a_pinned_thread_has_one_core() {
        std::thread::spawn(|| {
            for k in [0, 1, 7] {
                super::pin_to_core(k).unwrap();
                let set = sched_getaffinity(None).unwrap();
                assert_eq!(set.count(), 1);
                assert!(set.is_set(sched_getcpu()));
            }
        })
        .join()
        .unwrap();
    }
}
