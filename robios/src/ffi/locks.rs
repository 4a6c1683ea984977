//! Replacements of the C library's mutexes, read-write locks and semaphores, as far as a program's threads wait
//! for them: they wait by the program's clock, and get them in the order in which they came.
//!
//! The locks themselves remain the C library's: a thread that cannot have one is listed with those that sleep
//! ([`sleepers`](super::sleepers)), and whoever releases it wakes the first. Locks shared with other processes
//! are left alone.

use std::ffi::{c_int, c_void};

use libc::{clockid_t, timespec};

use super::cancelling::cancellable;
use super::clock::{end_of_wait, is_virtual};
use super::original::{Original, call_original};
use super::sleep::{takes_turns, wait_for_event};
use super::sleepers::{Event, is_promised, wake};
use super::threads::{alone, is_inside, is_the_programs};
use super::turns::own_number;

/// A kind of lock.
pub(super) struct Kind {
    name: &'static str,
    /// Takes it and returns the result, or `None` if that is not possible at once.
    attempt: fn(*mut c_void) -> Option<c_int>,
    /// Number of the thread that holds it, if that is known.
    holder: fn(*mut c_void) -> Option<u32>,
    pub(super) is_shared: fn(*mut c_void) -> bool,
    /// Whether several threads may have it at once, so that one which has got it leaves some to others.
    has_room: bool,
}

pub(super) const MUTEX: Kind = Kind {
    name: "a mutex",
    attempt: |mutex| {
        static TRY: Original = Original::of(c"pthread_mutex_trylock");
        free(call_original!(TRY, mutex => *mut c_void))
    },
    holder: |mutex| u32::try_from(word(mutex, MUTEX_OWNER)?).ok().filter(|&owner| owner != 0),
    is_shared: |mutex| word(mutex, MUTEX_KIND).is_some_and(|kind| kind & MUTEX_SHARED != 0),
    has_room: false,
};

const READER: Kind = Kind {
    name: "a lock to read",
    attempt: |lock| {
        static TRY: Original = Original::of(c"pthread_rwlock_tryrdlock");
        free(call_original!(TRY, lock => *mut c_void))
    },
    holder: |_| None,
    is_shared: |_| false,
    has_room: true,
};

const WRITER: Kind = Kind {
    name: "a lock to write",
    attempt: |lock| {
        static TRY: Original = Original::of(c"pthread_rwlock_trywrlock");
        free(call_original!(TRY, lock => *mut c_void))
    },
    ..READER
};

const SEMAPHORE: Kind = Kind {
    name: "a semaphore",
    attempt: |semaphore| {
        static TRY: Original = Original::of(c"sem_trywait");
        (call_original!(TRY, semaphore => *mut c_void) == 0).then_some(0)
    },
    holder: |_| None,
    is_shared: |semaphore| word(semaphore, SEMAPHORE_SHARED).is_some_and(|shared| shared != 0),
    has_room: true,
};

/// Places of words within the locks of the GNU C library, on machines of 64 bits.
const MUTEX_OWNER: usize = 2;
const MUTEX_KIND: usize = 4;
const SEMAPHORE_SHARED: usize = 2;
/// Bits of a mutex's kind: shared between processes; the kind proper, and its value for mutexes that refuse a
/// thread which holds them already.
const MUTEX_SHARED: c_int = 128;
const KIND_PROPER: c_int = 3;
const ERROR_CHECKING: c_int = 2;

/// A word of a lock, where its structure is known.
fn word(lock: *mut c_void, place: usize) -> Option<c_int> {
    if !cfg!(all(target_env = "gnu", target_pointer_width = "64")) || lock.is_null() {
        return None;
    }
    // SAFETY: the lock is the program's, and larger than this.
    Some(unsafe { lock.cast::<c_int>().add(place).read_volatile() })
}

fn free(result: c_int) -> Option<c_int> {
    (result != libc::EBUSY).then_some(result)
}

/// Takes a lock, until a time (s) at most. `None` if the C library has to wait for it, or at that time.
fn take(kind: &Kind, lock: *mut c_void, end: f64) -> Option<c_int> {
    let place = lock.addr();
    // One that was woken for it goes before those who come now.
    let attempt = |woken: bool| if !woken && is_promised(place) { None } else { (kind.attempt)(lock) };
    if let Some(done) = attempt(false) {
        return Some(done);
    }
    let holder = (kind.holder)(lock);
    let own = holder == Some(own_number());
    let refuses = own && word(lock, MUTEX_KIND).is_some_and(|kind| kind & KIND_PROPER == ERROR_CHECKING);
    // A program with one thread has other ways to be woken, unless it waits for itself.
    let waits = takes_turns() || is_the_programs() && !is_inside() && (end.is_finite() || alone() && own);
    if !waits || refuses || !is_virtual() || (kind.is_shared)(lock) {
        return None;
    }
    let taken = wait_for_event(Event { place, kind: kind.name, holder }, end, attempt);
    if kind.has_room && taken.is_some() {
        wake(place, usize::MAX);
    }
    taken
}

/// Takes a mutex.
pub(super) fn lock(mutex: *mut c_void) -> c_int {
    static LOCK: Original = Original::of(c"pthread_mutex_lock");
    take(&MUTEX, mutex, f64::INFINITY).unwrap_or_else(|| call_original!(LOCK, mutex => *mut c_void))
}

/// Releases a mutex.
pub(super) fn unlock(mutex: *mut c_void) -> c_int {
    static UNLOCK: Original = Original::of(c"pthread_mutex_unlock");
    released(mutex, 1, call_original!(UNLOCK, mutex => *mut c_void))
}

/// Wakes those who wait for a lock that was released.
fn released(lock: *mut c_void, most: usize, result: c_int) -> c_int {
    if result == 0 {
        wake(lock.addr(), most);
    }
    result
}

#[unsafe(no_mangle)]
pub(super) extern "C" fn pthread_mutex_lock(mutex: *mut c_void) -> c_int {
    lock(mutex)
}

#[unsafe(no_mangle)]
pub(super) extern "C" fn pthread_mutex_unlock(mutex: *mut c_void) -> c_int {
    unlock(mutex)
}

/// Takes a lock until a time on the program's clock, or leaves that to the C library for any other.
fn take_until(
    kind: &Kind,
    lock: *mut c_void,
    clock: clockid_t,
    time: *const timespec,
    otherwise: impl FnOnce() -> c_int,
) -> c_int {
    match end_of_wait(clock, time) {
        Some(end) => take(kind, lock, end).unwrap_or(libc::ETIMEDOUT),
        None => otherwise(),
    }
}

#[unsafe(no_mangle)]
pub(super) extern "C" fn pthread_mutex_timedlock(mutex: *mut c_void, time: *const timespec) -> c_int {
    static LOCK: Original = Original::of(c"pthread_mutex_timedlock");
    take_until(
        &MUTEX,
        mutex,
        libc::CLOCK_REALTIME,
        time,
        || call_original!(LOCK, mutex => *mut c_void, time => *const timespec),
    )
}

#[unsafe(no_mangle)]
pub(super) extern "C" fn pthread_mutex_clocklock(
    mutex: *mut c_void,
    clock: clockid_t,
    time: *const timespec,
) -> c_int {
    static LOCK: Original = Original::of(c"pthread_mutex_clocklock");
    take_until(
        &MUTEX,
        mutex,
        clock,
        time,
        || call_original!(LOCK, mutex => *mut c_void, clock => clockid_t, time => *const timespec),
    )
}

#[unsafe(no_mangle)]
extern "C" fn pthread_rwlock_rdlock(lock: *mut c_void) -> c_int {
    static LOCK: Original = Original::of(c"pthread_rwlock_rdlock");
    take(&READER, lock, f64::INFINITY).unwrap_or_else(|| call_original!(LOCK, lock => *mut c_void))
}

#[unsafe(no_mangle)]
extern "C" fn pthread_rwlock_wrlock(lock: *mut c_void) -> c_int {
    static LOCK: Original = Original::of(c"pthread_rwlock_wrlock");
    take(&WRITER, lock, f64::INFINITY).unwrap_or_else(|| call_original!(LOCK, lock => *mut c_void))
}

#[unsafe(no_mangle)]
extern "C" fn pthread_rwlock_unlock(lock: *mut c_void) -> c_int {
    static UNLOCK: Original = Original::of(c"pthread_rwlock_unlock");
    released(lock, usize::MAX, call_original!(UNLOCK, lock => *mut c_void))
}

#[unsafe(no_mangle)]
pub(super) extern "C-unwind" fn sem_wait(semaphore: *mut c_void) -> c_int {
    static WAIT: Original = Original::of(c"sem_wait");
    cancellable(|| {
        take(&SEMAPHORE, semaphore, f64::INFINITY)
            .unwrap_or_else(|| call_original!(WAIT, semaphore => *mut c_void))
    })
}

/// Functions for semaphores return -1 and leave the reason in `errno`.
fn in_errno(result: c_int) -> c_int {
    if result == libc::ETIMEDOUT {
        // SAFETY: the error number is this thread's own.
        unsafe { *libc::__errno_location() = result };
        return -1;
    }
    result
}

#[unsafe(no_mangle)]
extern "C-unwind" fn sem_timedwait(semaphore: *mut c_void, time: *const timespec) -> c_int {
    static WAIT: Original = Original::of(c"sem_timedwait");
    cancellable(|| {
        in_errno(take_until(
            &SEMAPHORE,
            semaphore,
            libc::CLOCK_REALTIME,
            time,
            || call_original!(WAIT, semaphore => *mut c_void, time => *const timespec),
        ))
    })
}

#[unsafe(no_mangle)]
extern "C-unwind" fn sem_clockwait(semaphore: *mut c_void, clock: clockid_t, time: *const timespec) -> c_int {
    static WAIT: Original = Original::of(c"sem_clockwait");
    cancellable(|| {
        in_errno(take_until(
            &SEMAPHORE,
            semaphore,
            clock,
            time,
            || call_original!(WAIT, semaphore => *mut c_void, clock => clockid_t, time => *const timespec),
        ))
    })
}

#[unsafe(no_mangle)]
pub(super) extern "C" fn sem_post(semaphore: *mut c_void) -> c_int {
    static POST: Original = Original::of(c"sem_post");
    released(semaphore, 1, call_original!(POST, semaphore => *mut c_void))
}
