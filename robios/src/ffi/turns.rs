//! Determines whether a program's other threads have had the opportunity to act, before a sleeping one lets
//! time pass.
//!
//! Real time is no measure: on a busy machine a thread may wait long for a processor.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::Read;
use std::sync::{Mutex, PoisonError};

use super::threads::Inside;

/// Activity of the other threads since the first look.
#[derive(Debug, Default)]
pub(super) struct Turn {
    /// Processor time of every thread at its first and its last look (ns).
    spent: BTreeMap<u32, (u64, u64)>,
    /// The threads at the last look, if all had had their turn.
    quiet: Option<Vec<u32>>,
    looks: u32,
}

/// Processor time granted to a thread for making a call (ns): one that makes none is busy with something
/// else.
const SHARE: u64 = 1_000_000;
/// Processor time granted to a thread to reach its next wait, before another one wakes up (ns). One that does
/// not use it waits for the others' results, as in `while (distance > 300);`, and then has the shorter share.
const LONG_SHARE: u64 = 5_000_000;
/// Number of looks after which time passes in any case: on a busy machine, a runnable thread may wait long.
const MOST_LOOKS: u32 = 20_000;

impl Turn {
    /// Whether every other thread waits, or has had its share of processor time. Threads in `asleep` sleep by
    /// the program's clock and are known to wait.
    pub(super) fn is_over(&mut self, asleep: &[u32]) -> bool {
        self.is_over_after(SHARE, asleep)
    }

    /// Like [`is_over`](Turn::is_over), with a share that covers most of a thread's work between waits.
    pub(super) fn is_long_over(&mut self, asleep: &[u32]) -> bool {
        self.is_over_after(LONG_SHARE, asleep)
    }

    fn is_over_after(&mut self, share: u64, asleep: &[u32]) -> bool {
        self.looks += 1;
        let awake: Vec<u32> = others().into_iter().filter(|thread| !asleep.contains(thread)).collect();
        let mut over = true;
        for &thread in &awake {
            over &= self.is_over_for(thread, share);
        }
        // Threads are examined one after the other: one may have woken another and ended meanwhile.
        let quiet = over.then_some(awake);
        let still = over && self.quiet == quiet;
        self.quiet = quiet;
        still || self.looks > MOST_LOOKS
    }

    /// A thread found waiting twice without activity in between waits for more than a lock.
    fn is_over_for(&mut self, thread: u32, share: u64) -> bool {
        // A system that hides the threads' processor time does not reliably show whether they are runnable
        // either.
        let Some(now) = spent(thread) else { return true };
        let known = self.spent.get(&thread).copied();
        let (first, last) = known.unwrap_or((now, now));
        self.spent.insert(thread, (first, now));
        match state(thread) {
            Some('S') => {
                let waits = known.is_some() && now == last;
                if waits {
                    at_spinners(|spinners| spinners.remove(&thread));
                }
                waits
            }
            Some('R' | 'D') => at_spinners(|spinners| {
                let used = now.saturating_sub(first);
                if used >= LONG_SHARE {
                    spinners.insert(thread);
                }
                used >= share || used >= SHARE && spinners.contains(&thread)
            }),
            _ => true,
        }
    }
}

/// Threads that have used a long share without a call or a wait.
static SPINNERS: Mutex<BTreeSet<u32>> = Mutex::new(BTreeSet::new());

/// Accesses them as within a call, so that a signal handler does not wait for this thread.
fn at_spinners<T>(look: impl FnOnce(&mut BTreeSet<u32>) -> T) -> T {
    let _inside = Inside::new();
    look(&mut SPINNERS.lock().unwrap_or_else(PoisonError::into_inner))
}

/// Records that this thread makes a call.
pub(super) fn note_call() {
    at_spinners(|spinners| spinners.remove(&own_number()));
}

/// Numbers of the library's own threads.
static OURS: Mutex<Vec<u32>> = Mutex::new(Vec::new());

/// Records that this thread is the library's.
pub(super) fn note_ours() {
    OURS.lock().unwrap_or_else(PoisonError::into_inner).push(own_number());
}

/// Whether every other thread of the program is among those that sleep by its clock, or has ended: then none
/// can act before one of them wakes up.
pub(super) fn all_sleep(asleep: &[u32]) -> bool {
    let ours = OURS.lock().unwrap_or_else(PoisonError::into_inner).clone();
    let sleeps = |thread: &u32| asleep.contains(thread) || ours.contains(thread);
    others().iter().all(|thread| sleeps(thread) || state(*thread) == Some('Z'))
}

/// Whether all threads of a program with a child process have been waiting since an earlier look: most likely
/// for that child, which runs in real time.
#[derive(Debug, Default)]
pub(super) struct Stillness(BTreeMap<u32, u64>);

impl Stillness {
    /// Examines the threads. Must be called by a thread of the library.
    pub(super) fn holds(&mut self) -> bool {
        let waiting =
            |thread: u32| spent(thread).filter(|_| state(thread) == Some('S')).map(|time| (thread, time));
        let threads = others().into_iter().filter(|&thread| state(thread) != Some('Z'));
        let now: Option<BTreeMap<u32, u64>> = threads.map(waiting).collect();
        let before = std::mem::replace(&mut self.0, now.clone().unwrap_or_default());
        now.is_some_and(|now| !now.is_empty() && now == before) && has_child()
    }
}

/// Whether the program has a child process.
pub(super) fn has_child() -> bool {
    // SAFETY: an all-zero record of this type is valid.
    let mut child: libc::siginfo_t = unsafe { std::mem::zeroed() };
    let look = libc::WEXITED | libc::WNOHANG | libc::WNOWAIT;
    // SAFETY: the kernel writes to a record that outlives the call, and leaves the children as they are.
    unsafe { libc::waitid(libc::P_ALL, 0, &raw mut child, look) == 0 }
}

/// Whether the program's initial thread and all threads it started have ended. Must be called by a thread of
/// the library.
pub(super) fn have_all_ended() -> bool {
    let first = std::process::id();
    state(first) == Some('Z') && others().into_iter().all(|thread| thread == first)
}

/// Whether a thread with this number still exists.
pub(super) fn is_there(thread: u32) -> bool {
    state(thread).is_some()
}

/// Number of the calling thread.
pub(super) fn own_number() -> u32 {
    // SAFETY: only queries a number.
    unsafe { libc::gettid() as u32 }
}

/// The threads of this process except the calling one.
fn others() -> Vec<u32> {
    let own = own_number();
    let Ok(entries) = fs::read_dir("/proc/self/task") else { return Vec::new() };
    let numbers = entries.filter_map(|entry| entry.ok()?.file_name().to_str()?.parse().ok());
    numbers.filter(|&thread| thread != own).collect()
}

/// The beginning of a thread's file in `/proc`, in one read, as there are many of them.
fn file(thread: u32, name: &str) -> Option<String> {
    let mut text = [0; 256];
    let length = File::open(format!("/proc/self/task/{thread}/{name}")).ok()?.read(&mut text).ok()?;
    Some(String::from_utf8_lossy(&text[..length]).into_owned())
}

/// A thread's state: `R` running or runnable, `S` waiting, `Z` ended.
fn state(thread: u32) -> Option<char> {
    file(thread, "stat").and_then(|text| text.rsplit(')').next()?.trim_start().chars().next())
}

/// Processor time of a thread of this process (ns), by the clock that Linux keeps of it: to the present,
/// while the files in `/proc` lag by milliseconds.
fn spent(thread: u32) -> Option<u64> {
    let clock = ((!thread << 3) | THREADS_PROCESSOR_TIME) as libc::clockid_t;
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the kernel writes to a variable that outlives the call.
    let known = unsafe { libc::syscall(libc::SYS_clock_gettime, clock, &raw mut time) } == 0;
    known.then_some(time.tv_sec as u64 * 1_000_000_000 + time.tv_nsec as u64)
}

/// Kind of such a clock, in the lowest bits of its number.
const THREADS_PROCESSOR_TIME: u32 = 6;
