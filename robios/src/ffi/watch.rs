//! Lets time pass for a program that calls nothing: it may be waiting for what its timers' functions do, as in
//! `while (count < 100);`, or for a process that it has forked, or have set its robot going for good, as in
//! `VWSetSpeed(100, 0); while (1);`. And ends a program whose threads have all gone.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::real_time::{nap, real_seconds};
use super::threads::{calls, set_ours};
#[cfg(target_os = "linux")]
use super::turns::{Stillness, have_all_ended};

/// What became of time that was to pass without a call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unasked {
    /// It passed, or there was no reason that it should.
    Passed,
    /// Somebody is calling.
    Busy,
    /// There is no robot any more.
    Over,
}

/// Lets time pass that nobody has asked for: so many seconds to where the next timer is due, or without
/// timers.
type Pass = fn(f64, f64) -> Unasked;

/// Real time between two looks.
const LOOK: Duration = Duration::from_millis(5);
/// Looks without a call after which a program with timers seems to wait.
const PATIENCE: u32 = 4;
/// Looks in which the time that passes at each doubles.
const DOUBLING: u32 = 20;
/// Most seconds that pass at a look.
const MOST: f64 = 0.2;
/// Looks in which a program has to wait for another process before time passes: what keeps it waiting that
/// long is not the machine.
const WAITING: u32 = 40;
/// Looks without a call after which time passes for a program without timers: most that compute are done by then.
const LONG: u32 = 1000;
/// Looks in which the time that then passes doubles: whoever computes for some seconds more loses little.
const SLOW_DOUBLING: u32 = 400;

static WATCHING: AtomicBool = AtomicBool::new(false);

/// Starts the thread that watches, unless it is there.
///
/// Where the world is shared, its host decides when time passes for a program that computes.
pub(super) fn start(pass: Pass, is_shared: bool) {
    if WATCHING.swap(true, Ordering::Relaxed) {
        return;
    }
    set_ours(true);
    let started = std::thread::Builder::new().name("robios".into()).spawn(move || watch(pass, is_shared));
    set_ours(false);
    // Without the thread, time passes as the program calls.
    drop(started);
}

/// Seconds that pass at a look, after so many doublings.
fn step(doublings: u32) -> f64 {
    (LOOK.as_secs_f64() * f64::from(1_u32 << doublings.min(30))).min(MOST)
}

/// With timers, time passes as the real one at first, and then faster and faster: a program that computes for a while
/// loses little, and one that waits need not wait for long. Without timers it begins later, and grows faster more slowly.
/// While the program waits for another process, time passes as the real one.
fn watch(pass: Pass, is_shared: bool) {
    set_ours(true);
    let (mut before, mut idle) = (calls(), 0_u32);
    let (mut stillness, mut last) = (Stillness::default(), real_seconds());
    // Looks and seconds for which the program has been waiting.
    let (mut still, mut stood) = (0_u32, 0.0);
    loop {
        nap(LOOK);
        let (now, time) = (calls(), real_seconds());
        idle = if now == before { idle.saturating_add(1) } else { 0 };
        let elapsed = std::mem::replace(&mut last, time);
        let elapsed = (time - elapsed).clamp(0.0, MOST);
        before = now;
        let Some(waited) = idle.checked_sub(PATIENCE) else { continue };
        if have_all_ended() {
            // As the last thread would, were this one not here.
            // SAFETY: no call of this thread's is running.
            unsafe { libc::exit(0) };
        }
        let fast = step(waited / DOUBLING);
        let slow = idle.checked_sub(LONG).map_or(0.0, |waited| step(waited / SLOW_DOUBLING));
        (still, stood) = if stillness.holds() { (still + 1, stood + elapsed) } else { (0, 0.0) };
        let slow = match still {
            WAITING.. => std::mem::take(&mut stood),
            _ if is_shared => 0.0,
            _ => slow,
        };
        match pass(fast, slow) {
            Unasked::Passed => {}
            Unasked::Busy => idle = 0,
            Unasked::Over => return,
        }
    }
}

/// Where nobody tells what threads do, a program never seems to wait or to have ended.
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
fn have_all_ended() -> bool {
    false
}
