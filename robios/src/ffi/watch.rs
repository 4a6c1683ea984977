//! Lets time pass for a program that makes no calls. It may wait for its timer functions, as in `while (count
//! < 100);`, or for a forked process, or have started its robot for good, as in `VWSetSpeed(100, 0); while
//! (1);`. Also ends a program whose threads have all ended.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::real_time::{nap, real_seconds};
use super::threads::{calls, set_ours};
#[cfg(target_os = "linux")]
use super::turns::{Stillness, have_all_ended, note_ours};

/// Result of letting time pass without a call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unasked {
    /// Time passed, or there was no need.
    Passed,
    /// Another thread is in a call.
    Busy,
    /// The robot is gone.
    Over,
}

/// Lets time pass without a call: seconds to the next due timer, or seconds without timers; `None` if only
/// the commands given so far are to reach the world.
type Pass = fn(f64, Option<f64>) -> Unasked;

/// Real time between two looks.
const LOOK: Duration = Duration::from_millis(5);
/// Number of looks without a call after which a program with timers seems to wait.
const PATIENCE: u32 = 4;
/// Number of looks after which the time per look doubles.
const DOUBLING: u32 = 20;
/// Maximum time per look (s).
const MOST: f64 = 0.2;
/// Number of looks for which a program must wait for another process before time passes; a shorter wait may
/// be due to the machine.
const WAITING: u32 = 40;
/// Number of looks without a call after which time passes for a program without timers: most computations are
/// done by then.
const LONG: u32 = 1000;
/// Number of looks after which that time doubles: long computations lose little.
const SLOW_DOUBLING: u32 = 400;

static WATCHING: AtomicBool = AtomicBool::new(false);

/// Starts the watching thread, unless it is running.
///
/// In a shared world, the host decides when time passes for a computing program: after `patience` real
/// seconds. The program's commands must have arrived before.
pub(super) fn start(pass: Pass, patience: Option<f64>) {
    if WATCHING.swap(true, Ordering::Relaxed) {
        return;
    }
    set_ours(true);
    let started = std::thread::Builder::new().name("robios".into()).spawn(move || watch(pass, patience));
    set_ours(false);
    // Without the thread, time passes only with calls.
    drop(started);
}

/// Time per look after a number of doublings (s).
fn step(doublings: u32) -> f64 {
    (LOOK.as_secs_f64() * f64::from(1_u32 << doublings.min(30))).min(MOST)
}

/// With timers, time passes like real time at first, then ever faster: a program that computes for a while
/// loses little, and one that waits need not wait long. Without timers it starts later and accelerates more
/// slowly. While the program waits for another process, time passes like real time.
fn watch(pass: Pass, patience: Option<f64>) {
    set_ours(true);
    note_ours();
    let (mut before, mut idle) = (calls(), 0_u32);
    let (mut stillness, mut last) = (Stillness::default(), real_seconds());
    // Number of looks, and time, for which the program has been waiting.
    let (mut still, mut stood) = (0_u32, 0.0);
    let mut silence = 0.0;
    loop {
        nap(LOOK);
        let (now, time) = (calls(), real_seconds());
        idle = if now == before { idle.saturating_add(1) } else { 0 };
        let elapsed = std::mem::replace(&mut last, time);
        let elapsed = (time - elapsed).clamp(0.0, MOST);
        silence = if now == before { silence + elapsed } else { 0.0 };
        before = now;
        let Some(waited) = idle.checked_sub(PATIENCE) else { continue };
        if have_all_ended() {
            // Exits as the last thread would without this one.
            // SAFETY: this thread is not within a call.
            unsafe { libc::exit(0) };
        }
        let fast = step(waited / DOUBLING);
        let slow = idle.checked_sub(LONG).map_or(0.0, |waited| step(waited / SLOW_DOUBLING));
        (still, stood) = if stillness.holds() { (still + 1, stood + elapsed) } else { (0, 0.0) };
        let slow = match (still, patience) {
            (WAITING.., _) => Some(std::mem::take(&mut stood)),
            (_, Some(patience)) => (silence < patience / 2.0).then_some(0.0),
            (_, None) => Some(slow),
        };
        match pass(fast, slow) {
            Unasked::Passed => {}
            Unasked::Busy => idle = 0,
            Unasked::Over => return,
        }
    }
}

/// Where thread states are unknown, a program never seems to wait or to have ended.
#[cfg(not(target_os = "linux"))]
#[derive(Debug, Default)]
struct Stillness;

#[cfg(not(target_os = "linux"))]
impl Stillness {
    #[allow(clippy::unused_self, reason = "as where it is known")]
    fn holds(&mut self) -> bool {
        false
    }
}

#[cfg(not(target_os = "linux"))]
fn note_ours() {}

#[cfg(not(target_os = "linux"))]
fn have_all_ended() -> bool {
    false
}
