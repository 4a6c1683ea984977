//! The process that owns the robot, and the threads that call it.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, AtomicI32, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Process that owns the robot; a child after `fork` does not.
static OWNER: AtomicI32 = AtomicI32::new(0);
/// Number of calls so far, except those of sleeping threads.
static CALLS: AtomicU64 = AtomicU64::new(0);
/// Number of threads that make calls, and whether the program has started any.
static THREADS: AtomicUsize = AtomicUsize::new(0);
static STARTED_THREADS: AtomicBool = AtomicBool::new(false);

thread_local! {
    /// Whether this thread is within a call: a signal handler that calls again must not wait for itself.
    static INSIDE: Cell<bool> = const { Cell::new(false) };
    /// Counts this thread while it lives.
    static PRESENT: Present = Present::new();
    /// Whether this thread belongs to the library, or is about to start one that does.
    static OURS: Cell<bool> = const { Cell::new(false) };
}

// An ending thread has lost its flags and needs them no more, so failures of `try_with` are ignored in this
// file.

/// Sets whether this thread acts for the library.
pub(super) fn set_ours(ours: bool) {
    let _ = OURS.try_with(|flag| flag.set(ours));
}

pub(super) fn is_the_programs() -> bool {
    !OURS.try_with(Cell::get).unwrap_or(false)
}

/// Number of calls so far.
pub(super) fn calls() -> u64 {
    CALLS.load(Ordering::Relaxed)
}

/// Counts a call, unless it is the library's own.
pub(super) fn count_call() {
    if is_the_programs() {
        CALLS.fetch_add(1, Ordering::Relaxed);
    }
}

/// Counts this thread from now on, unless it is the library's own.
pub(super) fn be_present() {
    if is_the_programs() {
        let _ = PRESENT.try_with(|_| ());
    }
}

struct Present;

impl Present {
    fn new() -> Self {
        THREADS.fetch_add(1, Ordering::Relaxed);
        Self
    }
}

impl Drop for Present {
    fn drop(&mut self) {
        THREADS.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Whether this thread is within a call.
pub(super) fn is_inside() -> bool {
    INSIDE.try_with(Cell::get).unwrap_or(true)
}

/// Marks this thread as being within a call.
pub(super) struct Inside;

impl Inside {
    pub(super) fn new() -> Option<Self> {
        let free = INSIDE.try_with(|inside| !inside.replace(true)).unwrap_or(false);
        // Created only when free: dropping it marks the thread as having left.
        if free { Some(Self) } else { None }
    }
}

impl Drop for Inside {
    fn drop(&mut self) {
        let _ = INSIDE.try_with(|inside| inside.set(false));
    }
}

/// Whether this process owns the robot, or nobody yet.
pub(super) fn is_ours() -> bool {
    let owner = OWNER.load(Ordering::Acquire);
    owner == 0 || owner == process()
}

/// Makes this process the robot's owner.
pub(super) fn own() {
    OWNER.store(process(), Ordering::Release);
}

fn process() -> i32 {
    std::process::id() as i32
}

/// Whether a robot in virtual time exists already.
#[cfg(target_os = "linux")]
pub(super) fn is_alive() -> bool {
    OWNER.load(Ordering::Acquire) != 0
}

/// Records that the program has started a thread.
pub(super) fn note_thread() {
    if is_the_programs() {
        STARTED_THREADS.store(true, Ordering::Relaxed);
    }
}

/// Records that the program has started a thread, for `eye.py`.
#[unsafe(no_mangle)]
extern "C" fn eyesim_note_thread() {
    note_thread();
}

pub(super) fn alone() -> bool {
    !STARTED_THREADS.load(Ordering::Relaxed) && THREADS.load(Ordering::Relaxed) <= 1
}

/// Numbers of the threads that wait for another one's end.
static JOINING: Mutex<Vec<u32>> = Mutex::new(Vec::new());

/// Accesses the list as within a call.
fn at_joining<T>(look: impl FnOnce(&mut Vec<u32>) -> T) -> T {
    let _inside = Inside::new();
    look(&mut JOINING.lock().unwrap_or_else(PoisonError::into_inner))
}

/// Records that a thread waits for another one's end, or does so no more.
pub(super) fn note_joining(thread: u32, waits: bool) {
    at_joining(|joining| {
        joining.retain(|&other| other != thread);
        if waits {
            joining.push(thread);
        }
    });
}

/// Numbers of the threads that wait for another one's end.
pub(super) fn joining() -> Vec<u32> {
    at_joining(|joining| joining.clone())
}
