//! The real clock, independent of the program's virtual time.

#[cfg(target_os = "linux")]
use std::ffi::c_long;
use std::time::Duration;

#[cfg(target_os = "linux")]
use libc::{time_t, timespec};

#[cfg(target_os = "linux")]
pub(super) const BILLION: f64 = 1e9;

/// Sleeps in real time.
#[cfg(target_os = "linux")]
pub(super) fn nap(time: Duration) {
    let time =
        timespec { tv_sec: time.as_secs() as time_t, tv_nsec: c_long::from(time.subsec_nanos() as i32) };
    // SAFETY: the kernel only reads the time, which outlives the call.
    unsafe { libc::syscall(libc::SYS_nanosleep, &raw const time, std::ptr::null_mut::<timespec>()) };
}

/// Sleeps in real time.
#[cfg(not(target_os = "linux"))]
pub(super) fn nap(time: Duration) {
    std::thread::sleep(time);
}

#[cfg(target_os = "linux")]
pub(super) fn real_time() -> timespec {
    let mut time = timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the kernel writes to a variable that outlives the call.
    unsafe { libc::syscall(libc::SYS_clock_gettime, libc::CLOCK_REALTIME, &raw mut time) };
    time
}

/// Real time since 1970 (s).
#[cfg(target_os = "linux")]
pub(super) fn real_seconds() -> f64 {
    let time = real_time();
    time.tv_sec as f64 + time.tv_nsec as f64 / BILLION
}

#[cfg(not(target_os = "linux"))]
#[allow(clippy::disallowed_methods, reason = "for programs with somebody at the terminal alone")]
pub(super) fn real_seconds() -> f64 {
    std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default().as_secs_f64()
}
