//! What the runner needs of the system beyond the standard library, in safe functions.

#![allow(unsafe_code)]

use std::io;
use std::os::fd::{AsRawFd, RawFd};
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command};

/// Starts a program in a process group of its own, that ends with this process at the latest. The socket, if there is
/// one, stays open in it under the number that [`socket_number`] tells.
pub fn start(command: &mut Command, socket: Option<&UnixStream>) -> io::Result<Child> {
    let socket = socket.map(socket_number);
    command.process_group(0);
    let prepare = move || {
        #[cfg(target_os = "linux")]
        // SAFETY: sets a number of this process, which has one thread after `fork`.
        unsafe {
            libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGKILL);
        }
        if let Some(socket) = socket {
            // SAFETY: the descriptor is open in the parent, so it is here; without flags it stays open in the program.
            if unsafe { libc::fcntl(socket, libc::F_SETFD, 0) } != 0 {
                return Err(io::Error::last_os_error());
            }
        }
        Ok(())
    };
    // SAFETY: the closure calls functions alone that may be called after `fork`, and allocates nothing.
    unsafe { command.pre_exec(prepare) };
    command.spawn()
}

/// The number of a socket, for the environment of a program.
pub fn socket_number(socket: &UnixStream) -> RawFd {
    socket.as_raw_fd()
}

/// Ends a program that [`start`] has started, and what it has started itself.
pub fn kill_all(child: u32) {
    let Ok(group) = i32::try_from(child) else { return };
    // SAFETY: sends a signal to the group that the program leads; if it is gone, nothing happens.
    unsafe { libc::kill(-group, libc::SIGKILL) };
}
