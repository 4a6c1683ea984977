//! Charges a program's computing time between its calls.

use std::cell::Cell;
use std::sync::OnceLock;

/// Simulated seconds per second of processor time.
static FACTOR: OnceLock<f64> = OnceLock::new();

thread_local! {
    /// End of this thread's last call, in processor time (s).
    static BEGIN: Cell<Option<f64>> = const { Cell::new(None) };
}

/// Sets the number of simulated seconds per second of processor time.
pub(super) fn set_factor(factor: f64) {
    // Set only once, when the robot is created.
    let _ = FACTOR.set(factor);
}

fn factor() -> Option<f64> {
    FACTOR.get().copied().filter(|&factor| factor > 0.0)
}

/// Simulated time that this thread has computed since its last call (s).
pub(super) fn so_far() -> Option<f64> {
    let factor = factor()?;
    let begin = BEGIN.try_with(Cell::take).ok()??;
    Some(factor * (on_processor() - begin).max(0.0))
}

/// Records the end of a call.
pub(super) fn begin() {
    if factor().is_some() {
        // A thread that is ending computes no more.
        let _ = BEGIN.try_with(|begin| begin.set(Some(on_processor())));
    }
}

/// Processor time of this thread (s).
#[cfg(target_os = "linux")]
fn on_processor() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the kernel writes to a variable that outlives the call.
    unsafe { libc::syscall(libc::SYS_clock_gettime, libc::CLOCK_THREAD_CPUTIME_ID, &raw mut time) };
    time.tv_sec as f64 + time.tv_nsec as f64 / 1e9
}

/// Processor time of this thread (s).
#[cfg(not(target_os = "linux"))]
fn on_processor() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the system writes to a variable that outlives the call.
    unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &raw mut time) };
    time.tv_sec as f64 + time.tv_nsec as f64 / 1e9
}
