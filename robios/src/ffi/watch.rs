//! Lets time pass for a program that calls nothing: it may be waiting for what its timers' functions do, as in
//! `while (count < 100);`, or have set its robot going for good, as in `VWSetSpeed(100, 0); while (1);`.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::real_time::nap;
use super::threads::{calls, set_ours};

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
/// Looks without a call after which time passes for a program without timers: most that compute are done by then.
const LONG: u32 = 1000;
/// Looks in which the time that then passes doubles: whoever computes for some seconds more loses little.
const SLOW_DOUBLING: u32 = 400;

static WATCHING: AtomicBool = AtomicBool::new(false);

/// Starts the thread that watches, unless it is there.
pub(super) fn start(pass: Pass) {
    if WATCHING.swap(true, Ordering::Relaxed) {
        return;
    }
    set_ours(true);
    let started = std::thread::Builder::new().name("robios".into()).spawn(move || watch(pass));
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
fn watch(pass: Pass) {
    set_ours(true);
    let (mut before, mut idle) = (calls(), 0_u32);
    loop {
        nap(LOOK);
        let now = calls();
        idle = if now == before { idle.saturating_add(1) } else { 0 };
        before = now;
        let Some(waited) = idle.checked_sub(PATIENCE) else { continue };
        let fast = step(waited / DOUBLING);
        let slow = idle.checked_sub(LONG).map_or(0.0, |waited| step(waited / SLOW_DOUBLING));
        match pass(fast, slow) {
            Unasked::Passed => {}
            Unasked::Busy => idle = 0,
            Unasked::Over => return,
        }
    }
}
