//! Replacements of the C library's functions that sleep or read the time: a program sees only virtual time.
//!
//! They act in programs linked against this library before the C library, as `gccsim` does, from the first
//! RoBIOS call on, or from the start if the runner started the program. Everybody else gets the system's
//! functions. Not replaced, and in real time: `timer_create`, `timerfd_create`, and waiting for files and
//! sockets. Locks and conditions are in `locks` and `conditions`.

use std::ffi::{c_int, c_long, c_uint, c_ulong, c_void};
use std::sync::atomic::{AtomicBool, Ordering};

use libc::{clockid_t, pthread_attr_t, pthread_t, time_t, timespec, timeval};

use super::cancelling::cancellable;
use super::memory::{input, output};
use super::original::{Original, call_original};
use super::real_time::{BILLION, real_time};
use super::runtime::enter;
use super::sleep::{let_others_run, sleep_for};
use super::sleepers::ordinal;
use super::threads::{is_alive, is_ours, is_the_programs, note_joining, note_thread};
use super::turns::own_number;
use crate::robios::EPOCH;

/// Whether the runner started this process.
static STARTED_BY_RUNNER: AtomicBool = AtomicBool::new(false);

/// Records that it did. Before, time queries while the library is loaded go to the system: they may come from
/// an allocator, which must not be re-entered.
pub(super) fn note_runner() {
    STARTED_BY_RUNNER.store(true, Ordering::Relaxed);
}

fn started_by_runner() -> bool {
    STARTED_BY_RUNNER.load(Ordering::Relaxed)
}

pub(super) fn is_virtual() -> bool {
    (is_alive() || started_by_runner()) && is_ours()
}

/// Time since the start of the run by the program's clock (s).
fn now() -> Option<f64> {
    if !is_virtual() {
        return None;
    }
    enter("time", |robios| {
        robios.charge()?;
        Ok(robios.now())
    })
}

/// Sleeps by the program's clock. `None` without one.
fn sleep_virtually(seconds: f64) -> Option<()> {
    if is_virtual() { sleep_for("time", seconds) } else { None }
}

fn seconds(time: timespec) -> Option<f64> {
    let sane = time.tv_sec >= 0 && (0..1_000_000_000).contains(&time.tv_nsec);
    sane.then_some(time.tv_sec as f64 + time.tv_nsec as f64 / BILLION)
}

fn spec(seconds: f64) -> timespec {
    let whole = seconds.floor();
    timespec { tv_sec: whole as time_t, tv_nsec: ((seconds - whole) * BILLION) as c_long }
}

#[unsafe(no_mangle)]
pub(super) extern "C-unwind" fn nanosleep(request: *const timespec, rest: *mut timespec) -> c_int {
    cancellable(|| {
        let time = input(request, 1).and_then(|times| seconds(times[0]));
        if let Some(time) = time
            && sleep_virtually(time).is_some()
        {
            return 0;
        }
        // SAFETY: the kernel checks both pointers, and the error number is set as by the C library.
        unsafe { libc::syscall(libc::SYS_nanosleep, request, rest) as c_int }
    })
}

#[unsafe(no_mangle)]
extern "C-unwind" fn clock_nanosleep(
    clock: clockid_t,
    flags: c_int,
    request: *const timespec,
    rest: *mut timespec,
) -> c_int {
    cancellable(|| {
        let time = input(request, 1).and_then(|times| seconds(times[0]));
        if let Some(time) = time.filter(|_| is_wall_clock(clock)) {
            let wait = if flags & libc::TIMER_ABSTIME == 0 {
                Some(time)
            } else {
                now().map(|now| time - EPOCH - now)
            };
            if wait.and_then(|wait| sleep_virtually(wait.max(0.0))).is_some() {
                return 0;
            }
        }
        // SAFETY: the kernel checks both pointers.
        let result = unsafe { libc::syscall(libc::SYS_clock_nanosleep, clock, flags, request, rest) };
        // This function returns the error number.
        if result == 0 { 0 } else { std::io::Error::last_os_error().raw_os_error().unwrap_or(libc::EINVAL) }
    })
}

#[unsafe(no_mangle)]
extern "C-unwind" fn usleep(microseconds: c_uint) -> c_int {
    cancellable(|| {
        let time = f64::from(microseconds) / 1e6;
        if sleep_virtually(time).is_some() {
            return 0;
        }
        let time = spec(time);
        nanosleep(&raw const time, std::ptr::null_mut())
    })
}

#[unsafe(no_mangle)]
extern "C-unwind" fn sleep(time: c_uint) -> c_uint {
    let (time, mut rest) = (spec(time.into()), spec(0.0));
    let done = nanosleep(&raw const time, &raw mut rest) == 0;
    if done { 0 } else { rest.tv_sec as c_uint }
}

/// Clocks that advance while a program sleeps.
fn is_wall_clock(clock: clockid_t) -> bool {
    matches!(
        clock,
        libc::CLOCK_REALTIME
            | libc::CLOCK_REALTIME_COARSE
            | libc::CLOCK_MONOTONIC
            | libc::CLOCK_MONOTONIC_COARSE
            | libc::CLOCK_MONOTONIC_RAW
            | libc::CLOCK_BOOTTIME
    )
}

#[unsafe(no_mangle)]
extern "C" fn clock_gettime(clock: clockid_t, time: *mut timespec) -> c_int {
    if is_wall_clock(clock)
        && let Some(now) = now()
        && output(time, &[spec(EPOCH + now)])
    {
        return 0;
    }
    // SAFETY: the kernel checks the pointer.
    unsafe { libc::syscall(libc::SYS_clock_gettime, clock, time) as c_int }
}

pub(super) fn wall_time() -> timespec {
    now().map_or_else(real_time, |now| spec(EPOCH + now))
}

#[unsafe(no_mangle)]
extern "C" fn time(result: *mut time_t) -> time_t {
    let time = wall_time().tv_sec;
    output(result, &[time]);
    time
}

#[unsafe(no_mangle)]
extern "C" fn gettimeofday(result: *mut timeval, _zone: *mut c_void) -> c_int {
    let time = wall_time();
    output(result, &[timeval { tv_sec: time.tv_sec, tv_usec: time.tv_nsec / 1000 }]);
    0
}

/// Processor time equals the program's time.
#[unsafe(no_mangle)]
extern "C" fn clock() -> libc::clock_t {
    if let Some(now) = now() {
        return (1e6 * now) as libc::clock_t;
    }
    let mut time = spec(0.0);
    // SAFETY: the kernel writes to a variable that outlives the call.
    unsafe { libc::syscall(libc::SYS_clock_gettime, libc::CLOCK_PROCESS_CPUTIME_ID, &raw mut time) };
    time.tv_sec * 1_000_000 + time.tv_nsec / 1000
}

type Start = extern "C" fn(*mut c_void) -> *mut c_void;
/// Starts a thread like the C library, and records that there are several.
#[unsafe(no_mangle)]
extern "C" fn pthread_create(
    thread: *mut pthread_t,
    attributes: *const pthread_attr_t,
    start: Start,
    argument: *mut c_void,
) -> c_int {
    static CREATE: Original = Original::of(c"pthread_create");
    ordinal();
    note_thread();
    let result = call_original!(
        CREATE, thread => *mut pthread_t, attributes => *const pthread_attr_t, start => Start,
        argument => *mut c_void
    );
    if result == 0 && is_the_programs() && is_virtual() {
        let_others_run();
    }
    result
}

/// Waits for a thread's end like the C library, and records that this thread does.
#[unsafe(no_mangle)]
extern "C-unwind" fn pthread_join(thread: pthread_t, result: *mut *mut c_void) -> c_int {
    static JOIN: Original = Original::of(c"pthread_join");
    note_joining(own_number(), true);
    let done = call_original!(JOIN, thread => pthread_t, result => *mut *mut c_void);
    note_joining(own_number(), false);
    done
}

/// Program time of an absolute time; `None` if the program has no clock of its own.
pub(super) fn end_of_wait(clock: clockid_t, time: *const timespec) -> Option<f64> {
    let time = input(time, 1).and_then(|times| seconds(times[0]))?;
    now().filter(|_| is_wall_clock(clock)).map(|_| time - EPOCH)
}

/// Programs also sleep by polling no files.
#[unsafe(no_mangle)]
extern "C-unwind" fn poll(files: *mut c_void, count: c_ulong, milliseconds: c_int) -> c_int {
    static POLL: Original = Original::of(c"poll");
    cancellable(|| {
        if count == 0
            && let Ok(time) = u32::try_from(milliseconds)
            && sleep_virtually(f64::from(time) / 1000.0).is_some()
        {
            return 0;
        }
        call_original!(POLL, files => *mut c_void, count => c_ulong, milliseconds => c_int)
    })
}

/// Programs sleep by selecting from no files.
#[unsafe(no_mangle)]
extern "C-unwind" fn select(
    files: c_int,
    readable: *mut c_void,
    writable: *mut c_void,
    special: *mut c_void,
    timeout: *mut timeval,
) -> c_int {
    static SELECT: Original = Original::of(c"select");
    cancellable(|| {
        let nothing = readable.is_null() && writable.is_null() && special.is_null();
        let time = input(timeout.cast_const(), 1).map(|t| t[0].tv_sec as f64 + t[0].tv_usec as f64 / 1e6);
        if let Some(time) = time.filter(|&time| nothing && time >= 0.0)
            && sleep_virtually(time).is_some()
        {
            return 0;
        }
        call_original!(
            SELECT, files => c_int, readable => *mut c_void, writable => *mut c_void, special => *mut c_void,
            timeout => *mut timeval
        )
    })
}
