//! System functions for the runner beyond the standard library, in safe form.

#![allow(unsafe_code)]

use std::io;
use std::os::fd::{AsRawFd, BorrowedFd, RawFd};
use std::os::unix::process::CommandExt;
use std::process::{Child, Command};
use std::sync::Arc;

use crate::memory::Memory;

/// Starts a program in its own process group, which ends with this process at the latest (Linux). The files
/// stay open in it under their descriptors.
///
/// Its parent is a small process that records the program's exit status in the memory, if any, and exits
/// alike; so a program that kills its parent harms nobody else.
pub fn start(
    command: &mut Command,
    files: &[BorrowedFd<'_>],
    memory: Option<&Arc<Memory>>,
) -> io::Result<Child> {
    let files: Vec<RawFd> = files.iter().map(AsRawFd::as_raw_fd).collect();
    let memory = memory.cloned();
    command.process_group(0);
    let prepare = move || {
        end_with_parent();
        for &file in &files {
            // SAFETY: the descriptor is open in the parent and therefore here; without flags it stays open in
            // the program.
            if unsafe { libc::fcntl(file, libc::F_SETFD, 0) } != 0 {
                return Err(io::Error::last_os_error());
            }
        }
        // SAFETY: this process has one thread, and the following functions are allowed after `fork`.
        match unsafe { libc::fork() } {
            -1 => Err(io::Error::last_os_error()),
            0 => {
                end_with_parent();
                Ok(())
            }
            program => stand_by(program, memory.as_deref()),
        }
    };
    // SAFETY: the closure only calls functions allowed after `fork`, and allocates nothing.
    unsafe { command.pre_exec(prepare) };
    command.spawn()
}

fn end_with_parent() {
    #[cfg(target_os = "linux")]
    // SAFETY: sets an attribute of this process, which has one thread after `fork`.
    unsafe {
        libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGKILL);
    }
}

/// Lets the process group of this process end with its parent.
fn end_group_with_parent() {
    #[cfg(target_os = "linux")]
    // SAFETY: sets a handler, which only calls a function that is allowed there, and an attribute of this
    // process, which has one thread after `fork`.
    unsafe {
        libc::signal(libc::SIGTERM, end_group as extern "C" fn(libc::c_int) as libc::sighandler_t);
        libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGTERM);
    }
}

/// Kills the process group of this process.
#[cfg(target_os = "linux")]
extern "C" fn end_group(_signal: libc::c_int) {
    // SAFETY: signals the own process group.
    unsafe { libc::kill(0, libc::SIGKILL) };
}

/// Waits for the program, records its exit status, and exits alike.
fn stand_by(program: libc::pid_t, memory: Option<&Memory>) -> ! {
    end_group_with_parent();
    let mut status = 0;
    // SAFETY: closes descriptors that are no longer needed and used by nobody else; waits for its only child,
    // whose status is written to a variable that outlives the call; and exits.
    unsafe {
        let mut most = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
        let limit =
            if libc::getrlimit(libc::RLIMIT_NOFILE, &raw mut most) == 0 { most.rlim_cur } else { 256 };
        for file in 0..limit.min(65_536) as RawFd {
            libc::close(file);
        }
        while libc::waitpid(program, &raw mut status, 0) < 0 {
            if io::Error::last_os_error().kind() != io::ErrorKind::Interrupted {
                break;
            }
        }
        if let Some(memory) = memory {
            memory.note_status(status);
        }
        if libc::WIFSIGNALED(status) {
            // The program has already dumped its core, if at all.
            let none = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
            libc::setrlimit(libc::RLIMIT_CORE, &raw const none);
            libc::signal(libc::WTERMSIG(status), libc::SIG_DFL);
            libc::kill(libc::getpid(), libc::WTERMSIG(status));
        }
        libc::_exit(libc::WEXITSTATUS(status))
    }
}

/// Kills a program started by [`start`], and all processes in its group.
pub fn kill_all(child: u32) {
    let Ok(group) = i32::try_from(child) else { return };
    // SAFETY: signals the program's process group; if it is gone, nothing happens.
    unsafe { libc::kill(-group, libc::SIGKILL) };
}
