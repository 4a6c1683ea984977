//! Threads, mutexes and conditions of C11: the same as POSIX's under other names and with other results, within
//! the C library where no replacement reaches.

use std::ffi::{c_int, c_void};

use libc::timespec;

use super::clock::{is_virtual, nanosleep, wall_time};
use super::conditions::{
    pthread_cond_broadcast, pthread_cond_signal, pthread_cond_timedwait, pthread_cond_wait,
};
use super::locks::{pthread_mutex_lock, pthread_mutex_timedlock, pthread_mutex_unlock};
use super::memory::output;
use super::original::{Original, call_original};
use super::sleep::let_others_run;
use super::sleepers::ordinal;
use super::threads::{is_the_programs, note_thread};

/// Results in `threads.h`.
const BUSY: c_int = 1;
const FAILED: c_int = 2;
const TIMED_OUT: c_int = 4;
const TIME_UTC: c_int = 1;

fn result(code: c_int) -> c_int {
    match code {
        0 => 0,
        libc::EBUSY => BUSY,
        libc::ETIMEDOUT => TIMED_OUT,
        _ => FAILED,
    }
}

type Body = extern "C" fn(*mut c_void) -> c_int;

/// Starts a thread like the C library, and lets it run until it waits.
#[unsafe(no_mangle)]
extern "C" fn thrd_create(thread: *mut c_void, body: Body, argument: *mut c_void) -> c_int {
    static CREATE: Original = Original::of(c"thrd_create");
    ordinal();
    note_thread();
    let done = call_original!(CREATE, thread => *mut c_void, body => Body, argument => *mut c_void);
    if done == 0 && is_the_programs() && is_virtual() {
        let_others_run();
    }
    done
}

#[unsafe(no_mangle)]
extern "C-unwind" fn thrd_sleep(request: *const timespec, rest: *mut timespec) -> c_int {
    nanosleep(request, rest)
}

/// Returns the base for the only supported one.
#[unsafe(no_mangle)]
extern "C" fn timespec_get(time: *mut timespec, base: c_int) -> c_int {
    let known = base == TIME_UTC && output(time, &[wall_time()]);
    if known { base } else { 0 }
}

#[unsafe(no_mangle)]
extern "C" fn mtx_lock(mutex: *mut c_void) -> c_int {
    result(pthread_mutex_lock(mutex))
}

#[unsafe(no_mangle)]
extern "C" fn mtx_timedlock(mutex: *mut c_void, time: *const timespec) -> c_int {
    result(pthread_mutex_timedlock(mutex, time))
}

#[unsafe(no_mangle)]
extern "C" fn mtx_unlock(mutex: *mut c_void) -> c_int {
    result(pthread_mutex_unlock(mutex))
}

#[unsafe(no_mangle)]
extern "C-unwind" fn cnd_wait(condition: *mut c_void, mutex: *mut c_void) -> c_int {
    result(pthread_cond_wait(condition, mutex))
}

#[unsafe(no_mangle)]
extern "C-unwind" fn cnd_timedwait(
    condition: *mut c_void,
    mutex: *mut c_void,
    time: *const timespec,
) -> c_int {
    result(pthread_cond_timedwait(condition, mutex, time))
}

#[unsafe(no_mangle)]
extern "C" fn cnd_signal(condition: *mut c_void) -> c_int {
    result(pthread_cond_signal(condition))
}

#[unsafe(no_mangle)]
extern "C" fn cnd_broadcast(condition: *mut c_void) -> c_int {
    result(pthread_cond_broadcast(condition))
}
