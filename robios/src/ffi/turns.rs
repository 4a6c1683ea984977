//! Whether a program's other threads have had the opportunity to do something, before one that sleeps lets time pass.
//!
//! A real time would not do: on a busy machine a thread may have to wait long for a processor.

use std::collections::BTreeMap;
use std::fs;

/// What the other threads have done since one of them looked for the first time.
#[derive(Debug, Default)]
pub(super) struct Turn {
    /// Nanoseconds on a processor of every thread that could run, when it was first seen.
    spent: BTreeMap<u32, u64>,
    looks: u32,
}

/// Nanoseconds on a processor that a thread gets to make a call: one that makes none is busy with something else.
const SHARE: u64 = 200_000;
/// Looks after which time passes whatever the threads do.
const MOST_LOOKS: u32 = 2000;

impl Turn {
    /// Whether every other thread waits for something, or has had its share of a processor.
    pub(super) fn is_over(&mut self) -> bool {
        self.looks += 1;
        self.looks > MOST_LOOKS || others().into_iter().all(|thread| self.has_had_its_share(thread))
    }

    fn has_had_its_share(&mut self, thread: u32) -> bool {
        // A system that does not tell what threads have spent does not tell truly whether they could run.
        let Some(now) = spent(thread).filter(|_| can_run(thread)) else { return true };
        now.saturating_sub(*self.spent.entry(thread).or_insert(now)) >= SHARE
    }
}

/// Whether the program's threads have all been waiting since an earlier look while it has a child process: for that, most
/// likely, whose time is the real one.
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

/// Whether the thread in which the program began has ended, and all others that it has started. To be called by a
/// thread that is not the program's.
pub(super) fn have_all_ended() -> bool {
    let first = std::process::id();
    state(first) == Some('Z') && others().into_iter().all(|thread| thread == first)
}

/// The threads of this process but for the one that asks.
fn others() -> Vec<u32> {
    // SAFETY: asks for a number.
    let own = unsafe { libc::gettid() } as u32;
    let Ok(entries) = fs::read_dir("/proc/self/task") else { return Vec::new() };
    let numbers = entries.filter_map(|entry| entry.ok()?.file_name().to_str()?.parse().ok());
    numbers.filter(|&thread| thread != own).collect()
}

fn file(thread: u32, name: &str) -> Option<String> {
    fs::read_to_string(format!("/proc/self/task/{thread}/{name}")).ok()
}

/// Whether a thread is on a processor, or waits for one.
fn can_run(thread: u32) -> bool {
    state(thread) == Some('R')
}

/// A thread's state: `R` runs or could run, `S` waits, `Z` has ended.
fn state(thread: u32) -> Option<char> {
    file(thread, "stat").and_then(|text| text.rsplit(')').next()?.trim_start().chars().next())
}

/// Nanoseconds that a thread has been on a processor.
fn spent(thread: u32) -> Option<u64> {
    file(thread, "schedstat")?.split_whitespace().next()?.parse().ok()
}
