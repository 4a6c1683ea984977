//! Replacements of the C library's condition variables and barriers: a program's threads wait for them by its
//! clock, and go on one after the other, in the order in which they came.
//!
//! The C library's own take part only where a thread waits that is not the program's, or before there is a
//! robot.

use std::collections::BTreeMap;
use std::ffi::{c_int, c_uint, c_void};
use std::sync::{Mutex, PoisonError};

use libc::{clockid_t, timespec};

use super::cancelling::cancellable;
use super::clock::{end_of_wait, is_virtual};
use super::locks::{MUTEX, lock, unlock};
use super::original::{Original, call_original};
use super::sleep::{takes_turns, wait_for_event};
use super::sleepers::{Event, wake};
use super::threads::{Inside, is_inside, is_ours};

/// Waits for a condition until a time (s). `None` if that is left to the C library.
fn wait(condition: *mut c_void, mutex: *mut c_void, end: f64) -> Option<c_int> {
    let takes_part = is_virtual() && if end.is_finite() { !is_inside() } else { takes_turns() };
    if !takes_part || (MUTEX.is_shared)(mutex) {
        return None;
    }
    let event = Event { place: condition.addr(), kind: "a condition", holder: None };
    let mut is_locked = true;
    let woken = wait_for_event(event, end, |woken| {
        if std::mem::take(&mut is_locked) {
            unlock(mutex);
        }
        woken.then_some(())
    });
    if is_locked {
        return None;
    }
    let result = lock(mutex);
    match woken {
        Some(()) => Some(result),
        None if end.is_finite() => Some(if result == 0 { libc::ETIMEDOUT } else { result }),
        // The robot has gone meanwhile.
        None => None,
    }
}

#[unsafe(no_mangle)]
pub(super) extern "C-unwind" fn pthread_cond_wait(condition: *mut c_void, mutex: *mut c_void) -> c_int {
    static WAIT: Original = Original::of(c"pthread_cond_wait");
    cancellable(|| {
        wait(condition, mutex, f64::INFINITY)
            .unwrap_or_else(|| call_original!(WAIT, condition => *mut c_void, mutex => *mut c_void))
    })
}

#[unsafe(no_mangle)]
pub(super) extern "C-unwind" fn pthread_cond_timedwait(
    condition: *mut c_void,
    mutex: *mut c_void,
    time: *const timespec,
) -> c_int {
    static WAIT: Original = Original::of(c"pthread_cond_timedwait");
    cancellable(|| {
        // Whatever clock the condition has: all of them show the program's time.
        let end = end_of_wait(libc::CLOCK_REALTIME, time);
        end.and_then(|end| wait(condition, mutex, end)).unwrap_or_else(
            || call_original!(WAIT, condition => *mut c_void, mutex => *mut c_void, time => *const timespec),
        )
    })
}

#[unsafe(no_mangle)]
pub(super) extern "C-unwind" fn pthread_cond_clockwait(
    condition: *mut c_void,
    mutex: *mut c_void,
    clock: clockid_t,
    time: *const timespec,
) -> c_int {
    static WAIT: Original = Original::of(c"pthread_cond_clockwait");
    cancellable(|| {
        let end = end_of_wait(clock, time);
        end.and_then(|end| wait(condition, mutex, end)).unwrap_or_else(|| {
            call_original!(
            WAIT, condition => *mut c_void, mutex => *mut c_void, clock => clockid_t,
            time => *const timespec
            )
        })
    })
}

#[unsafe(no_mangle)]
pub(super) extern "C" fn pthread_cond_signal(condition: *mut c_void) -> c_int {
    static SIGNAL: Original = Original::of(c"pthread_cond_signal");
    wake(condition.addr(), 1);
    call_original!(SIGNAL, condition => *mut c_void)
}

#[unsafe(no_mangle)]
pub(super) extern "C" fn pthread_cond_broadcast(condition: *mut c_void) -> c_int {
    static BROADCAST: Original = Original::of(c"pthread_cond_broadcast");
    wake(condition.addr(), usize::MAX);
    call_original!(BROADCAST, condition => *mut c_void)
}

/// A barrier of the program.
#[derive(Debug, Clone, Copy)]
struct Barrier {
    /// Number of threads that it waits for, and of those that wait at it.
    count: c_uint,
    waiting: c_uint,
    /// How often it has let them go.
    rounds: u64,
}

/// The program's barriers by address.
static BARRIERS: Mutex<BTreeMap<usize, Barrier>> = Mutex::new(BTreeMap::new());

/// Accesses them as within a call, so that a signal handler does not wait for this thread.
fn at_barriers<T>(look: impl FnOnce(&mut BTreeMap<usize, Barrier>) -> T) -> T {
    let _inside = Inside::new();
    look(&mut BARRIERS.lock().unwrap_or_else(PoisonError::into_inner))
}

#[unsafe(no_mangle)]
extern "C" fn pthread_barrier_init(
    barrier: *mut c_void,
    attributes: *const libc::pthread_barrierattr_t,
    count: c_uint,
) -> c_int {
    static INIT: Original = Original::of(c"pthread_barrier_init");
    let result = call_original!(
        INIT, barrier => *mut c_void, attributes => *const libc::pthread_barrierattr_t, count => c_uint
    );
    let mut shared = libc::PTHREAD_PROCESS_PRIVATE;
    if !attributes.is_null() {
        // SAFETY: the attributes are the program's, and the variable outlives the call.
        unsafe { libc::pthread_barrierattr_getpshared(attributes, &raw mut shared) };
    }
    if result == 0 && shared == libc::PTHREAD_PROCESS_PRIVATE && is_ours() {
        at_barriers(|barriers| barriers.insert(barrier.addr(), Barrier { count, waiting: 0, rounds: 0 }));
    }
    result
}

#[unsafe(no_mangle)]
extern "C" fn pthread_barrier_destroy(barrier: *mut c_void) -> c_int {
    static DESTROY: Original = Original::of(c"pthread_barrier_destroy");
    at_barriers(|barriers| barriers.remove(&barrier.addr()));
    call_original!(DESTROY, barrier => *mut c_void)
}

/// Arrives at a barrier. Returns its round, and whether this thread is the last one.
fn arrive(place: usize) -> Option<(u64, bool)> {
    at_barriers(|barriers| {
        let barrier = barriers.get_mut(&place)?;
        barrier.waiting += 1;
        let is_last = barrier.waiting >= barrier.count;
        if is_last {
            (barrier.waiting, barrier.rounds) = (0, barrier.rounds + 1);
        }
        Some((barrier.rounds, is_last))
    })
}

#[unsafe(no_mangle)]
extern "C" fn pthread_barrier_wait(barrier: *mut c_void) -> c_int {
    static WAIT: Original = Original::of(c"pthread_barrier_wait");
    let place = barrier.addr();
    let arrived = if is_ours() { arrive(place) } else { None };
    let Some((round, is_last)) = arrived else {
        return call_original!(WAIT, barrier => *mut c_void);
    };
    if is_last {
        wake(place, usize::MAX);
        return libc::PTHREAD_BARRIER_SERIAL_THREAD;
    }
    let event = Event { place, kind: "a barrier", holder: None };
    // A barrier that is gone has let all go. Without a robot the program is over.
    let _ = wait_for_event(event, f64::INFINITY, |_| {
        at_barriers(|barriers| barriers.get(&place).is_none_or(|barrier| barrier.rounds != round))
            .then_some(())
    });
    0
}
