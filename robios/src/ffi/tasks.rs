//! Threads and semaphores of early RoBIOS-7 versions.

use std::ffi::{c_int, c_uint, c_void};

use libc::{pthread_t, sem_t};

use super::cancelling::pthread_cancel;
use super::locks::{sem_post, sem_wait};
use super::runtime::{code, enter};
use super::sleep::sleep_for;

/// Handle of a thread.
#[derive(Clone, Copy)]
#[repr(C)]
struct Task {
    thread: pthread_t,
    identifier: c_int,
}

type Body = extern "C" fn(*mut c_void) -> *mut c_void;

#[unsafe(no_mangle)]
extern "C" fn MTInit() -> c_int {
    code(enter("MTInit", |robios| robios.charge()))
}

/// Sleeps for hundredths of a second.
#[unsafe(no_mangle)]
extern "C" fn MTSleep(time: c_int) -> c_int {
    code(sleep_for("MTSleep", f64::from(time.max(0)) / 100.0))
}

/// Starts a thread with its identifier as argument.
#[unsafe(no_mangle)]
extern "C" fn MTSpawn(function: Option<Body>, identifier: c_int) -> Task {
    super::threads::note_thread();
    let mut thread: pthread_t = 0;
    if let Some(function) = function {
        let argument = std::ptr::without_provenance_mut(identifier as usize);
        // SAFETY: the handle outlives the call, there are no attributes, and the function gets a number that
        // it does not dereference.
        unsafe { libc::pthread_create(&raw mut thread, std::ptr::null(), function, argument) };
    }
    Task { thread, identifier }
}

#[unsafe(no_mangle)]
extern "C" fn MTGetUID(task: Task) -> c_int {
    task.identifier
}

/// Cancels a thread at its next cancellation point.
#[unsafe(no_mangle)]
extern "C" fn MTKill(task: Task) -> c_int {
    if task.thread == 0 {
        return 1;
    }
    c_int::from(pthread_cancel(task.thread) != 0)
}

#[unsafe(no_mangle)]
extern "C" fn SEMAInit(semaphore: *mut sem_t, value: c_int) -> c_int {
    let Ok(value) = c_uint::try_from(value) else { return 1 };
    // SAFETY: the pointer is not null and refers to a semaphore of the program.
    c_int::from(semaphore.is_null() || unsafe { libc::sem_init(semaphore, 0, value) } != 0)
}

#[unsafe(no_mangle)]
extern "C-unwind" fn SEMALock(semaphore: *mut sem_t) -> c_int {
    c_int::from(semaphore.is_null() || sem_wait(semaphore.cast()) != 0)
}

#[unsafe(no_mangle)]
extern "C" fn SEMAUnlock(semaphore: *mut sem_t) -> c_int {
    c_int::from(semaphore.is_null() || sem_post(semaphore.cast()) != 0)
}
