//! Entering namespaces of one's own: of processes, mounts, inter-process communication and network.

use std::{fs, io};

use nix::sched::{CloneFlags, unshare};
use rustix::{
    io::Errno,
    net::{AddressFamily, SocketFlags, SocketType, socket_with},
    process::{getgid, getuid},
};

use super::rights;

/// Those of a cell, but for that of users.
pub(super) fn flags(network: bool) -> CloneFlags {
    let flags = CloneFlags::CLONE_NEWNS | CloneFlags::CLONE_NEWPID | CloneFlags::CLONE_NEWIPC;
    if network { flags } else { flags | CloneFlags::CLONE_NEWNET }
}

/// Enters new namespaces; the processes started from here on are in them, the first of them as their first process.
///
/// # Errors
/// What the kernel refused.
pub(super) fn enter(network: bool) -> Result<(), (&'static str, io::Error)> {
    let flags = flags(network);
    let (user, group) = (getuid(), getgid());
    // Who may do so without a namespace of users keeps all users' names for the files that it sees.
    if user.is_root() && unshare(flags).is_ok() {
        return Ok(());
    }
    unshare(flags | CloneFlags::CLONE_NEWUSER).map_err(|e| ("new namespaces", e.into()))?;
    let map = |id: u32| format!("{id} {id} 1");
    let write = |file: &str, text: &str| fs::write(format!("/proc/self/{file}"), text);
    write("setgroups", "deny").map_err(|e| ("a namespace of users without groups", e))?;
    write("uid_map", &map(user.as_raw())).map_err(|e| ("a map of users", e))?;
    write("gid_map", &map(group.as_raw())).map_err(|e| ("a map of groups", e))?;
    rights::keep().map_err(|e| ("its rights in new namespaces", e.into()))
}

/// Switches on the loopback interface of a new network namespace, in which it is down at first: servers and clients of one
/// program find each other, and those of two tests do not.
///
/// # Errors
/// What the kernel refused.
pub(super) fn bring_up_loopback() -> io::Result<()> {
    // rtnetlink(7): set the flag IFF_UP of the first interface, and acknowledge.
    const RTM_NEWLINK: u16 = 16;
    const NLM_F_REQUEST_ACK: u16 = 1 | 4;
    const LOOPBACK: i32 = 1;
    const IFF_UP: u32 = 1;
    let mut message = Vec::with_capacity(32);
    message.extend(32_u32.to_ne_bytes());
    message.extend(RTM_NEWLINK.to_ne_bytes());
    message.extend(NLM_F_REQUEST_ACK.to_ne_bytes());
    message.extend([0; 8]); // sequence, port
    message.extend([0; 4]); // family, padding, type
    message.extend(LOOPBACK.to_ne_bytes());
    message.extend(IFF_UP.to_ne_bytes());
    message.extend(IFF_UP.to_ne_bytes());
    // The protocol of number 0 is that of routes.
    let socket = socket_with(AddressFamily::NETLINK, SocketType::RAW, SocketFlags::CLOEXEC, None)?;
    rustix::io::write(&socket, &message)?;
    let mut answer = [0; 256];
    let length = rustix::io::read(&socket, &mut answer)?;
    // After the header comes the error, negative; zero acknowledges.
    let error =
        answer.get(16..20).filter(|_| length >= 20).map(|b| i32::from_ne_bytes([b[0], b[1], b[2], b[3]]));
    match error {
        Some(0) => Ok(()),
        Some(error) => Err(Errno::from_raw_os_error(-error).into()),
        None => Err(io::ErrorKind::UnexpectedEof.into()),
    }
}
