//! Replacement of the C library's alarm clock: it follows the program's clock. Its signal is sent when that
//! time passes, in a call or in the watch over a program that makes none.

use std::ffi::{c_int, c_uint, c_void};

use libc::{itimerval, timeval};

use super::clock::is_virtual;
use super::memory::{input, output};
use super::original::original;
use super::runtime::enter;

extern "C" fn ring() {
    // SAFETY: sends this process its alarm signal.
    unsafe { libc::kill(libc::getpid(), libc::SIGALRM) };
}

/// Sets the virtual alarm clock, if there is one, to seconds and a period. Returns its previous setting.
fn set(times: (f64, f64)) -> Option<(f64, f64)> {
    let earlier = if is_virtual() { enter("time", |robios| Ok(robios.set_alarm(times, ring))) } else { None };
    if earlier.is_some() {
        super::runtime::watch_program();
    }
    earlier
}

#[unsafe(no_mangle)]
extern "C" fn alarm(time: c_uint) -> c_uint {
    if let Some((rest, _)) = set((f64::from(time), 0.0)) {
        return if rest > 0.0 { rest.max(1.0).round() as c_uint } else { 0 };
    }
    let found = original(c"alarm");
    if found.is_null() {
        return 0;
    }
    // SAFETY: the C library's function of this name has this type.
    unsafe { std::mem::transmute::<*mut c_void, extern "C" fn(c_uint) -> c_uint>(found)(time) }
}

/// Seconds of a time with less than a million microseconds.
fn seconds(time: timeval) -> Option<f64> {
    let sane = time.tv_sec >= 0 && (0..1_000_000).contains(&time.tv_usec);
    sane.then_some(time.tv_sec as f64 + time.tv_usec as f64 / 1e6)
}

fn fields(seconds: f64) -> timeval {
    let microseconds = (1e6 * seconds).round() as i64;
    timeval { tv_sec: microseconds / 1_000_000, tv_usec: microseconds % 1_000_000 }
}

/// The alarm clock's setting in C's format.
fn setting((rest, period): (f64, f64)) -> itimerval {
    itimerval { it_interval: fields(period), it_value: fields(rest) }
}

/// The setting requested by a program; `None` if invalid.
fn times(setting: itimerval) -> Option<(f64, f64)> {
    Some((seconds(setting.it_value)?, seconds(setting.it_interval)?))
}

type Set = unsafe extern "C" fn(c_int, *const itimerval, *mut itimerval) -> c_int;

#[unsafe(no_mangle)]
extern "C" fn setitimer(which: c_int, new: *const itimerval, old: *mut itimerval) -> c_int {
    if which == libc::ITIMER_REAL
        && let Some(wanted) = input(new, 1).and_then(|new| times(new[0]))
        && let Some(earlier) = set(wanted)
    {
        output(old, &[setting(earlier)]);
        return 0;
    }
    let found = original(c"setitimer");
    if found.is_null() {
        return -1;
    }
    // SAFETY: the C library's function has this type; the arguments are the program's.
    unsafe { std::mem::transmute::<*mut c_void, Set>(found)(which, new, old) }
}

type Get = unsafe extern "C" fn(c_int, *mut itimerval) -> c_int;

#[unsafe(no_mangle)]
extern "C" fn getitimer(which: c_int, now: *mut itimerval) -> c_int {
    if which == libc::ITIMER_REAL
        && is_virtual()
        && let Some(times) = enter("time", |robios| Ok(robios.alarm()))
        && output(now, &[setting(times)])
    {
        return 0;
    }
    let found = original(c"getitimer");
    if found.is_null() {
        return -1;
    }
    // SAFETY: the C library's function has this type; the arguments are the program's.
    unsafe { std::mem::transmute::<*mut c_void, Get>(found)(which, now) }
}

/// Like `alarm`, in microseconds.
#[unsafe(no_mangle)]
extern "C" fn ualarm(time: c_uint, period: c_uint) -> c_uint {
    let micro = |time: c_uint| fields(f64::from(time) / 1e6);
    let new = itimerval { it_interval: micro(period), it_value: micro(time) };
    let mut old = setting((0.0, 0.0));
    setitimer(libc::ITIMER_REAL, &raw const new, &raw mut old);
    (old.it_value.tv_sec * 1_000_000 + old.it_value.tv_usec) as c_uint
}
