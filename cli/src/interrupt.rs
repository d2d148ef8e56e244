//! Interrupts of long commands: the first asks for an end, the second ends at once.

use std::sync::{Arc, atomic::AtomicBool};

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use crate::{exit::CommandExit, fault::CommandFault};

/// Set by an interrupt or a request to terminate; at the second, the program ends at once. While somebody debugs, interrupts are for the
/// debugger.
///
/// # Errors
/// If the system lets nobody listen.
pub fn flag(debug: bool) -> Result<Arc<AtomicBool>, CommandFault> {
    let flag = Arc::new(AtomicBool::new(false));
    if debug {
        let unheard = Arc::new(AtomicBool::new(false));
        signal_hook::flag::register(SIGINT, unheard)
            .map_err(|e| format!("cannot listen for interrupts: {e}"))?;
    }
    for signal in [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|s| !debug || *s != SIGINT) {
        let registered = signal_hook::flag::register_conditional_shutdown(
            signal,
            CommandExit::Interrupted as i32,
            flag.clone(),
        )
        .and_then(|_| signal_hook::flag::register(signal, flag.clone()));
        registered.map_err(|e| format!("cannot listen for interrupts: {e}"))?;
    }
    Ok(flag)
}
