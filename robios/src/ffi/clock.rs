//! Replacements of the C library's functions that sleep or read the time: a program sees only virtual time.
//!
//! They act in programs linked against this library before the C library, as `gccsim` does, from the first
//! RoBIOS call on, or from the start if the runner started the program. Everybody else gets the system's
//! functions. Not replaced, and in real time: `timer_create`, `timerfd_create`, waiting for files and
//! sockets, and timed waits for semaphores and mutexes.

use std::ffi::{c_int, c_long, c_uint, c_ulong, c_void};
use std::sync::atomic::{AtomicBool, Ordering};

use libc::{clockid_t, pthread_attr_t, pthread_t, time_t, timespec, timeval};

use super::memory::{input, output};
use super::real_time::{BILLION, real_seconds, real_time};
use super::runtime::enter;
use super::sleep::{let_others_run, sleep_for};
use super::threads::{is_alive, is_ours, is_the_programs, note_thread};
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
extern "C" fn nanosleep(request: *const timespec, rest: *mut timespec) -> c_int {
    let time = input(request, 1).and_then(|times| seconds(times[0]));
    if let Some(time) = time
        && sleep_virtually(time).is_some()
    {
        return 0;
    }
    // SAFETY: the kernel checks both pointers, and the error number is set as by the C library.
    unsafe { libc::syscall(libc::SYS_nanosleep, request, rest) as c_int }
}

#[unsafe(no_mangle)]
extern "C" fn clock_nanosleep(
    clock: clockid_t,
    flags: c_int,
    request: *const timespec,
    rest: *mut timespec,
) -> c_int {
    let time = input(request, 1).and_then(|times| seconds(times[0]));
    if let Some(time) = time.filter(|_| is_wall_clock(clock)) {
        let wait =
            if flags & libc::TIMER_ABSTIME == 0 { Some(time) } else { now().map(|now| time - EPOCH - now) };
        if wait.and_then(|wait| sleep_virtually(wait.max(0.0))).is_some() {
            return 0;
        }
    }
    // SAFETY: the kernel checks both pointers.
    let result = unsafe { libc::syscall(libc::SYS_clock_nanosleep, clock, flags, request, rest) };
    // This function returns the error number.
    if result == 0 { 0 } else { std::io::Error::last_os_error().raw_os_error().unwrap_or(libc::EINVAL) }
}

#[unsafe(no_mangle)]
extern "C" fn usleep(microseconds: c_uint) -> c_int {
    let time = f64::from(microseconds) / 1e6;
    if sleep_virtually(time).is_some() {
        return 0;
    }
    let time = spec(time);
    nanosleep(&raw const time, std::ptr::null_mut())
}

#[unsafe(no_mangle)]
extern "C" fn sleep(time: c_uint) -> c_uint {
    if sleep_virtually(time.into()).is_some() {
        return 0;
    }
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

fn wall_time() -> timespec {
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

/// The C library's function with this name.
pub(super) fn original(name: &std::ffi::CStr) -> *mut c_void {
    // SAFETY: the name ends with a zero byte.
    unsafe { libc::dlsym(libc::RTLD_NEXT, name.as_ptr()) }
}

type Start = extern "C" fn(*mut c_void) -> *mut c_void;
type Create = unsafe extern "C" fn(*mut pthread_t, *const pthread_attr_t, Start, *mut c_void) -> c_int;

/// Starts a thread like the C library, and records that there are several.
#[unsafe(no_mangle)]
extern "C" fn pthread_create(
    thread: *mut pthread_t,
    attributes: *const pthread_attr_t,
    start: Start,
    argument: *mut c_void,
) -> c_int {
    note_thread();
    let found = original(c"pthread_create");
    if found.is_null() {
        return libc::ENOSYS;
    }
    // SAFETY: the C library's function has this type; the arguments are the program's.
    let result = unsafe {
        let create = std::mem::transmute::<*mut c_void, Create>(found);
        create(thread, attributes, start, argument)
    };
    if result == 0 && is_the_programs() && is_virtual() {
        let_others_run();
    }
    result
}

type ConditionWait = unsafe extern "C" fn(*mut c_void, *mut c_void, clockid_t, *const timespec) -> c_int;

type TimedWait = unsafe extern "C" fn(*mut c_void, *mut c_void, *const timespec) -> c_int;

/// Real time of a condition wait between two checks of the program's clock (s).
const GLANCE: f64 = 50e-6;

/// Waits for a condition until a time on the program's clock, by short real waits with virtual time passing
/// in between.
fn wait_virtually(condition: *mut c_void, mutex: *mut c_void, end: f64) -> Option<c_int> {
    let found = original(c"pthread_cond_clockwait");
    if found.is_null() {
        return None;
    }
    // SAFETY: the C library's function has this type.
    let wait = unsafe { std::mem::transmute::<*mut c_void, ConditionWait>(found) };
    loop {
        let until = spec(real_seconds() + GLANCE);
        // SAFETY: condition and mutex are the program's, and the time outlives the call.
        let result = unsafe { wait(condition, mutex, libc::CLOCK_REALTIME, &raw const until) };
        if result != libc::ETIMEDOUT {
            return Some(result);
        }
        let now = now()?;
        if now >= end {
            return Some(libc::ETIMEDOUT);
        }
        sleep_virtually((end - now).min(roverlab::io::sim::TICK))?;
    }
}

/// Program time of an absolute time; `None` if the program has no clock of its own.
fn end_of_wait(clock: clockid_t, time: *const timespec) -> Option<f64> {
    let time = input(time, 1).and_then(|times| seconds(times[0]))?;
    now().filter(|_| is_wall_clock(clock)).map(|_| time - EPOCH)
}

#[unsafe(no_mangle)]
extern "C" fn pthread_cond_clockwait(
    condition: *mut c_void,
    mutex: *mut c_void,
    clock: clockid_t,
    time: *const timespec,
) -> c_int {
    if let Some(end) = end_of_wait(clock, time) {
        return wait_virtually(condition, mutex, end).unwrap_or(libc::ETIMEDOUT);
    }
    let found = original(c"pthread_cond_clockwait");
    if found.is_null() {
        return libc::ENOSYS;
    }
    // SAFETY: the C library's function has this type; the arguments are the program's.
    unsafe { std::mem::transmute::<*mut c_void, ConditionWait>(found)(condition, mutex, clock, time) }
}

#[unsafe(no_mangle)]
extern "C" fn pthread_cond_timedwait(
    condition: *mut c_void,
    mutex: *mut c_void,
    time: *const timespec,
) -> c_int {
    if let Some(end) = end_of_wait(libc::CLOCK_REALTIME, time) {
        return wait_virtually(condition, mutex, end).unwrap_or(libc::ETIMEDOUT);
    }
    let found = original(c"pthread_cond_timedwait");
    if found.is_null() {
        return libc::ENOSYS;
    }
    // SAFETY: the C library's function has this type; the arguments are the program's.
    unsafe { std::mem::transmute::<*mut c_void, TimedWait>(found)(condition, mutex, time) }
}

type Poll = unsafe extern "C" fn(*mut c_void, c_ulong, c_int) -> c_int;

/// Programs also sleep by polling no files.
#[unsafe(no_mangle)]
extern "C" fn poll(files: *mut c_void, count: c_ulong, milliseconds: c_int) -> c_int {
    if count == 0
        && let Ok(time) = u32::try_from(milliseconds)
        && sleep_virtually(f64::from(time) / 1000.0).is_some()
    {
        return 0;
    }
    let found = original(c"poll");
    if found.is_null() {
        return -1;
    }
    // SAFETY: the C library's function has this type; the arguments are the program's.
    unsafe { std::mem::transmute::<*mut c_void, Poll>(found)(files, count, milliseconds) }
}

/// Sleep function of C11.
#[unsafe(no_mangle)]
extern "C" fn thrd_sleep(request: *const timespec, rest: *mut timespec) -> c_int {
    nanosleep(request, rest)
}

/// Time function of C11. Returns the base for the only supported one.
#[unsafe(no_mangle)]
extern "C" fn timespec_get(time: *mut timespec, base: c_int) -> c_int {
    let known = base == TIME_UTC && output(time, &[wall_time()]);
    if known { base } else { 0 }
}

const TIME_UTC: c_int = 1;

type Select = unsafe extern "C" fn(c_int, *mut c_void, *mut c_void, *mut c_void, *mut timeval) -> c_int;

/// Programs sleep by selecting from no files.
#[unsafe(no_mangle)]
extern "C" fn select(
    files: c_int,
    readable: *mut c_void,
    writable: *mut c_void,
    special: *mut c_void,
    timeout: *mut timeval,
) -> c_int {
    let nothing = readable.is_null() && writable.is_null() && special.is_null();
    let time = input(timeout.cast_const(), 1).map(|t| t[0].tv_sec as f64 + t[0].tv_usec as f64 / 1e6);
    if let Some(time) = time.filter(|&time| nothing && time >= 0.0)
        && sleep_virtually(time).is_some()
    {
        return 0;
    }
    let found = original(c"select");
    if found.is_null() {
        return -1;
    }
    // SAFETY: the C library's function has this type; the arguments are the program's.
    unsafe {
        let select = std::mem::transmute::<*mut c_void, Select>(found);
        select(files, readable, writable, special, timeout)
    }
}
