//! What a program computes between its calls, where that is charged.

use std::cell::Cell;
use std::sync::OnceLock;

/// Simulated seconds for a second on a processor.
static FACTOR: OnceLock<f64> = OnceLock::new();

thread_local! {
    /// When this thread's last call ended, in seconds on a processor.
    static BEGIN: Cell<Option<f64>> = const { Cell::new(None) };
}

/// Says how many simulated seconds a second on a processor is.
pub(super) fn set_factor(factor: f64) {
    // It is set once, when the robot is born.
    let _ = FACTOR.set(factor);
}

fn factor() -> Option<f64> {
    FACTOR.get().copied().filter(|&factor| factor > 0.0)
}

/// Simulated seconds that this thread has computed since its last call.
pub(super) fn so_far() -> Option<f64> {
    let factor = factor()?;
    let begin = BEGIN.try_with(Cell::take).ok()??;
    Some(factor * (on_processor() - begin).max(0.0))
}

/// Notes that a call ends.
pub(super) fn begin() {
    if factor().is_some() {
        // A thread that is ending computes no more.
        let _ = BEGIN.try_with(|begin| begin.set(Some(on_processor())));
    }
}

/// Seconds that this thread has been on a processor.
#[cfg(target_os = "linux")]
fn on_processor() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the kernel writes to a time that lives until it returns.
    unsafe { libc::syscall(libc::SYS_clock_gettime, libc::CLOCK_THREAD_CPUTIME_ID, &raw mut time) };
    time.tv_sec as f64 + time.tv_nsec as f64 / 1e9
}

/// Seconds that this thread has been on a processor.
#[cfg(not(target_os = "linux"))]
fn on_processor() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the system writes to a time that lives until it returns.
    unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &raw mut time) };
    time.tv_sec as f64 + time.tv_nsec as f64 / 1e9
}
