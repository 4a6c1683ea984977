//! Whether a program's other threads have had the opportunity to do something, before one that sleeps lets time pass.
//!
//! A real time would not do: on a busy machine a thread may have to wait long for a processor.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::Read;

/// What the other threads have done since one of them looked for the first time.
#[derive(Debug, Default)]
pub(super) struct Turn {
    /// Nanoseconds on a processor of every thread, when it was first seen, and at the last look.
    spent: BTreeMap<u32, (u64, u64)>,
    /// The threads at the last look, if it was over for all of them.
    quiet: Option<Vec<u32>>,
    looks: u32,
}

/// Nanoseconds on a processor that a thread gets to make a call: one that makes none is busy with something else.
const SHARE: u64 = 1_000_000;
/// Nanoseconds that a thread gets to go on until it waits, before another one wakes up.
const LONG_SHARE: u64 = 5_000_000;
/// Looks after which time passes whatever the threads do: on a busy machine, one that could run may wait
/// long.
const MOST_LOOKS: u32 = 20_000;

impl Turn {
    /// Whether every other thread waits for something, or has had its share of a processor. Those that sleep
    /// by the program's clock are known to wait.
    pub(super) fn is_over(&mut self, asleep: &[u32]) -> bool {
        self.is_over_after(SHARE, asleep)
    }

    /// As [`is_over`](Turn::is_over), with a share in which a thread that does not wait does most of what it
    /// does at a time.
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
        // Threads are looked at one after the other: one may have woken another up and ended meanwhile.
        let quiet = over.then_some(awake);
        let still = over && self.quiet == quiet;
        self.quiet = quiet;
        still || self.looks > MOST_LOOKS
    }

    /// A thread that was found waiting twice, and has done nothing in between, waits for more than its turn
    /// at a lock.
    fn is_over_for(&mut self, thread: u32, share: u64) -> bool {
        // A system that does not tell what threads have spent does not tell truly whether they could run.
        let Some(now) = spent(thread) else { return true };
        let known = self.spent.get(&thread).copied();
        let (first, last) = known.unwrap_or((now, now));
        self.spent.insert(thread, (first, now));
        match state(thread) {
            Some('S') => known.is_some() && now == last,
            Some('R' | 'D') => now.saturating_sub(first) >= share,
            _ => true,
        }
    }
}

/// Whether the program's threads have all been waiting since an earlier look while it has a child process:
/// for that, most likely, whose time is the real one.
#[derive(Debug, Default)]
pub(super) struct Stillness(BTreeMap<u32, u64>);

impl Stillness {
    /// Looks. To be called by a thread that is not the program's.
    pub(super) fn holds(&mut self) -> bool {
        let waiting =
            |thread: u32| spent(thread).filter(|_| state(thread) == Some('S')).map(|time| (thread, time));
        let threads = others().into_iter().filter(|&thread| state(thread) != Some('Z'));
        let now: Option<BTreeMap<u32, u64>> = threads.map(waiting).collect();
        let before = std::mem::replace(&mut self.0, now.clone().unwrap_or_default());
        now.is_some_and(|now| !now.is_empty() && now == before) && has_child()
    }
}

fn has_child() -> bool {
    // SAFETY: an all-zero record of this type is valid.
    let mut child: libc::siginfo_t = unsafe { std::mem::zeroed() };
    let look = libc::WEXITED | libc::WNOHANG | libc::WNOWAIT;
    // SAFETY: the kernel writes to a record that lives until it returns, and leaves the children as they are.
    unsafe { libc::waitid(libc::P_ALL, 0, &raw mut child, look) == 0 }
}

/// Whether the thread in which the program began has ended, and all others that it has started. To be called
/// by a thread that is not the program's.
pub(super) fn have_all_ended() -> bool {
    let first = std::process::id();
    state(first) == Some('Z') && others().into_iter().all(|thread| thread == first)
}

/// Whether there still is a thread of a number.
pub(super) fn is_there(thread: u32) -> bool {
    state(thread).is_some()
}

/// The number of the thread that asks.
pub(super) fn own_number() -> u32 {
    // SAFETY: asks for a number.
    unsafe { libc::gettid() as u32 }
}

/// The threads of this process but for the one that asks.
fn others() -> Vec<u32> {
    let own = own_number();
    let Ok(entries) = fs::read_dir("/proc/self/task") else { return Vec::new() };
    let numbers = entries.filter_map(|entry| entry.ok()?.file_name().to_str()?.parse().ok());
    numbers.filter(|&thread| thread != own).collect()
}

/// The beginning of what the system tells of a thread, in one look, as there are many of them.
fn file(thread: u32, name: &str) -> Option<String> {
    let mut text = [0; 256];
    let length = File::open(format!("/proc/self/task/{thread}/{name}")).ok()?.read(&mut text).ok()?;
    Some(String::from_utf8_lossy(&text[..length]).into_owned())
}

/// A thread's state: `R` runs or could run, `S` waits, `Z` has ended.
fn state(thread: u32) -> Option<char> {
    file(thread, "stat").and_then(|text| text.rsplit(')').next()?.trim_start().chars().next())
}

/// Nanoseconds that a thread has been on a processor.
fn spent(thread: u32) -> Option<u64> {
    file(thread, "schedstat")?.split_whitespace().next()?.parse().ok()
}
