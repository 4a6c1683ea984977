//! Cancelling of threads: one that sleeps by the program's clock wakes up for it, and ends as from the C
//! library's own function.
//!
//! The C library unwinds the thread's stack from `pthread_testcancel`. So it is called last in functions that
//! may unwind (`C-unwind`), when no value of theirs is left to drop.

use std::ffi::c_int;

use libc::pthread_t;

use super::original::{Original, call_original};
use super::sleepers::wake_thread;

unsafe extern "C-unwind" {
    fn pthread_testcancel();
}

/// Waits, and ends this thread where another one has cancelled it before or meanwhile.
pub(super) fn cancellable(wait: impl Fn() -> c_int) -> c_int {
    // SAFETY: no value has to be dropped here, nor by the callers.
    unsafe { pthread_testcancel() };
    let result = wait();
    // SAFETY: as above.
    unsafe { pthread_testcancel() };
    result
}

#[unsafe(no_mangle)]
pub(super) extern "C" fn pthread_cancel(thread: pthread_t) -> c_int {
    static CANCEL: Original = Original::of(c"pthread_cancel");
    let result = call_original!(CANCEL, thread => pthread_t);
    if result == 0 {
        wake_thread(thread);
    }
    result
}
