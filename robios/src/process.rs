//! What the runner needs of the system beyond the standard library, in safe functions.

#![allow(unsafe_code)]

use std::io;
use std::os::fd::{AsRawFd, RawFd};
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command};

/// Starts a program in a process group of its own, that ends with this process at the latest. The sockets stay open in
/// it under the numbers that [`socket_number`] tells.
pub fn start(command: &mut Command, sockets: &[&UnixStream]) -> io::Result<Child> {
    let sockets: Vec<RawFd> = sockets.iter().map(|socket| socket_number(socket)).collect();
    command.process_group(0);
    let prepare = move || {
        #[cfg(target_os = "linux")]
        // SAFETY: sets a number of this process, which has one thread after `fork`.
        unsafe {
            libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGKILL);
        }
        for &socket in &sockets {
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

/// Whether there is something to read from a socket, or its other end is closed, after so many milliseconds at most.
pub fn is_readable(socket: &UnixStream, milliseconds: i32) -> bool {
    let mut state = libc::pollfd { fd: socket_number(socket), events: libc::POLLIN, revents: 0 };
    // SAFETY: the kernel reads and writes one record, which lives until it returns.
    unsafe { libc::poll(&raw mut state, 1, milliseconds) > 0 }
}

/// Ends a program that [`start`] has started, and what it has started itself.
pub fn kill_all(child: u32) {
    let Ok(group) = i32::try_from(child) else { return };
    // SAFETY: sends a signal to the group that the program leads; if it is gone, nothing happens.
    unsafe { libc::kill(-group, libc::SIGKILL) };
}
