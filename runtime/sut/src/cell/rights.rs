//! Rights that only root has, and whoever has made namespaces has in them: the supervisor keeps them, and what of them reaches
//! beyond the cell is not handed on to the program.

use rustix::{
    io::Errno,
    thread::{
        CapabilitySet, CapabilitySets, capabilities, clear_ambient_capability_set,
        configure_capability_in_ambient_set, remove_capability_from_bounding_set, set_capabilities,
    },
};

/// Rights over the machine as a whole, over other users' processes, and past the limits. Those over files, users, the
/// program's own processes and its own network are left.
const BEYOND_THE_CELL: [CapabilitySet; 26] = [
    CapabilitySet::AUDIT_CONTROL,
    CapabilitySet::AUDIT_READ,
    CapabilitySet::BPF,
    CapabilitySet::BLOCK_SUSPEND,
    CapabilitySet::CHECKPOINT_RESTORE,
    CapabilitySet::DAC_READ_SEARCH,
    CapabilitySet::IPC_LOCK,
    CapabilitySet::IPC_OWNER,
    CapabilitySet::LEASE,
    CapabilitySet::LINUX_IMMUTABLE,
    CapabilitySet::MAC_ADMIN,
    CapabilitySet::MAC_OVERRIDE,
    CapabilitySet::MKNOD,
    CapabilitySet::PERFMON,
    CapabilitySet::SYS_ADMIN,
    CapabilitySet::SYS_BOOT,
    CapabilitySet::SYSLOG,
    CapabilitySet::SYS_MODULE,
    CapabilitySet::SYS_NICE,
    CapabilitySet::SYS_PACCT,
    CapabilitySet::SYS_PTRACE,
    CapabilitySet::SYS_RAWIO,
    CapabilitySet::SYS_RESOURCE,
    CapabilitySet::SYS_TIME,
    CapabilitySet::SYS_TTY_CONFIG,
    CapabilitySet::WAKE_ALARM,
];

/// A bit for each of them, as capabilities(7) numbers them.
pub(super) fn beyond_the_cell() -> u64 {
    BEYOND_THE_CELL.into_iter().fold(CapabilitySet::empty(), |all, right| all | right).bits()
}

/// Lets this process keep its rights in new namespaces when it starts itself again: otherwise all but root lose them.
pub(super) fn keep() -> Result<(), Errno> {
    let own = capabilities(None)?;
    set_capabilities(None, CapabilitySets { inheritable: own.permitted, ..own })?;
    own.permitted.iter().try_for_each(|right| configure_capability_in_ambient_set(right, true))
}

/// Takes these rights from every program that is started from here on; this process keeps its own.
pub(super) fn give_up() -> Result<(), Errno> {
    clear_ambient_capability_set()?;
    set_capabilities(None, CapabilitySets { inheritable: CapabilitySet::empty(), ..capabilities(None)? })?;
    for right in BEYOND_THE_CELL {
        // Who may not do this has none of them to hand on.
        let _ = remove_capability_from_bounding_set(right);
    }
    Ok(())
}
