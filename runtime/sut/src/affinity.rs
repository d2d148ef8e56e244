//! Pinning to a core: a parent and its child in lock-step never run at once, and sharing a core's caches and run queue
//! makes a round trip about four times faster than waking another core.

use std::os::unix::net::UnixDatagram;

/// A core that this thread and the processes that it starts run on; let go when dropped.
#[derive(Debug)]
pub struct PinnedCore {
    _claim: Option<UnixDatagram>,
}

/// Lets the calling thread, and the processes that it starts from now on, run on one core only: one that no other thread
/// has claimed, in this process or another, as long as there is one. So two campaigns at once do not share a core while
/// another is idle.
///
/// A claim is a socket with a name in the kernel's own space of names: it ends with whoever has it, and leaves nothing
/// behind. `None` where the system
/// has no such calls, or refuses.
#[must_use]
pub fn pin_to_free_core() -> Option<PinnedCore> {
    pin()
}

#[cfg(any(target_os = "linux", target_os = "android"))]
fn pin() -> Option<PinnedCore> {
    use std::sync::OnceLock;

    use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};

    // The first call sees what the process was given; later ones may come from a thread that is pinned already.
    static ALLOWED: OnceLock<Vec<usize>> = OnceLock::new();
    if ALLOWED.get().is_none() {
        let set = sched_getaffinity(None).ok()?;
        let _ = ALLOWED.set((0..CpuSet::MAX_CPU).filter(|&cpu| set.is_set(cpu)).collect());
    }
    let allowed = ALLOWED.get()?;
    // More workers than cores: they share, beginning with the first.
    let claimed = (0..)
        .take(MOST_SHARES)
        .find_map(|share| allowed.iter().find_map(|core| Some((*core, claim(*core, share)?))));
    let (core, claim) = match claimed {
        Some((core, claim)) => (core, Some(claim)),
        None => (*allowed.first()?, None),
    };
    let mut set = CpuSet::new();
    set.set(core);
    sched_setaffinity(None, &set).ok()?;
    Some(PinnedCore { _claim: claim })
}

#[cfg(not(any(target_os = "linux", target_os = "android")))]
fn pin() -> Option<PinnedCore> {
    None
}

/// How many workers claim a core before the rest of them no longer care.
#[cfg(any(target_os = "linux", target_os = "android"))]
const MOST_SHARES: usize = 64;

/// Takes the name of a share of a core, if nobody has.
#[cfg(any(target_os = "linux", target_os = "android"))]
fn claim(core: usize, share: usize) -> Option<UnixDatagram> {
    use std::os::{linux::net::SocketAddrExt, unix::net::SocketAddr};

    let name = SocketAddr::from_abstract_name(format!("hrdsl-core-{core}-{share}")).ok()?;
    UnixDatagram::bind_addr(&name).ok()
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use rustix::thread::{sched_getaffinity, sched_getcpu};

    #[test]
    fn threads_get_a_core_each_and_claims_end() {
        let cores = std::thread::available_parallelism().unwrap().get();
        let pinned = || {
            let claim = super::pin_to_free_core().unwrap();
            let set = sched_getaffinity(None).unwrap();
            assert_eq!(set.count(), 1);
            assert!(set.is_set(sched_getcpu()));
            claim
        };
        for _ in 0..3 {
            let threads: Vec<_> = (0..cores + 1).map(|_| std::thread::spawn(pinned)).collect();
            let claims: Vec<_> = threads.into_iter().map(|t| t.join().unwrap()).collect();
            assert!(claims.iter().all(|c| c._claim.is_some()), "{claims:?}");
        }
    }
}
