//! How a program waits.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use roverlab::io::Result;
use roverlab::io::sim::TICK;

use super::real_time::nap;
use super::runtime::{enter, enter_quietly};
use super::threads::{Inside, alone, calls};
#[cfg(target_os = "linux")]
use super::turns::Turn;
use crate::keys::Waiting;
use crate::robios::Robios;

/// Lets the program wait for so many seconds.
pub(super) fn sleep_for(call: &'static str, seconds: f64) -> Option<()> {
    let start = enter(call, |robios| Ok(robios.now()))?;
    sleep_until(start + seconds)
}

/// Real time between two looks of a thread that sleeps at what other threads do.
const GRACE: Duration = Duration::from_micros(50);

/// When the threads that sleep wake up, in seconds since the start.
static ENDS: Mutex<BTreeMap<u64, f64>> = Mutex::new(BTreeMap::new());
static SLEEPERS: AtomicU64 = AtomicU64::new(0);

/// Looks at them as within a call, so that a signal handler that sleeps meanwhile does not wait for this
/// thread.
fn at_ends<T>(look: impl FnOnce(&mut BTreeMap<u64, f64>) -> T) -> T {
    let _inside = Inside::new();
    look(&mut ENDS.lock().unwrap_or_else(PoisonError::into_inner))
}

/// A thread that sleeps.
struct Sleeper {
    number: u64,
    /// Looks at somebody else who should have woken up.
    waits: u32,
}

/// Looks after which whoever should have woken up is forgotten: its thread has been cancelled.
const MOST_WAITS: u32 = 2000;

impl Sleeper {
    fn new(end: f64) -> Self {
        let number = SLEEPERS.fetch_add(1, Ordering::Relaxed);
        at_ends(|ends| ends.insert(number, end));
        Self { number, waits: 0 }
    }

    /// Lets a tick pass, but no more than until somebody wakes up, and nothing before who is due has done so.
    fn pass(&mut self) -> Option<()> {
        let earliest = at_ends(|ends| ends.values().copied().fold(f64::INFINITY, f64::min));
        let passed = enter_quietly(|robios| {
            let rest = earliest - robios.now();
            if rest > 0.0 { robios.pass(rest.min(TICK)).map(|()| true) } else { Ok(false) }
        })?;
        self.waits = if passed { 0 } else { self.waits + 1 };
        if self.waits > MOST_WAITS {
            at_ends(|ends| ends.retain(|&number, _| number == self.number));
        }
        Some(())
    }
}

impl Drop for Sleeper {
    fn drop(&mut self) {
        at_ends(|ends| ends.remove(&self.number));
    }
}

/// Lets the program wait until a time, in seconds since the start. Timers' functions are called in between.
///
/// A program with one thread skips the time. Of several threads, one that sleeps lets the world go on by a
/// tick whenever the others have had the opportunity to do something and have not taken it.
fn sleep_until(end: f64) -> Option<()> {
    let (mut sleeper, mut turn) = (Sleeper::new(end), Turn::default());
    loop {
        let (alone, before) = (alone(), calls());
        let rest = enter_quietly(|robios| {
            let now = robios.now();
            if now < end && alone {
                let next = robios.timers.next().map_or(end, |due| due.min(end));
                robios.pass(next - now)?;
            }
            Ok(end - robios.now())
        })?;
        if rest <= 0.0 {
            return Some(());
        }
        if alone {
            continue;
        }
        nap(GRACE);
        if calls() != before {
            turn = Turn::default();
        } else if turn.is_over() {
            turn = Turn::default();
            sleeper.pass()?;
        }
    }
}

/// Where nobody tells what threads do, they have had their turn after a nap.
#[cfg(not(target_os = "linux"))]
#[derive(Debug, Default)]
struct Turn;

#[cfg(not(target_os = "linux"))]
impl Turn {
    #[allow(clippy::unused_self, reason = "as where it is known")]
    fn is_over(&mut self) -> bool {
        true
    }
}

/// Whether a call may wait in the world, because the program has nothing else to do meanwhile.
pub(super) fn may_block() -> bool {
    alone() && enter_quietly(|robios| Ok(robios.timers.is_empty())).unwrap_or(true)
}

/// Waits until a question has an answer.
pub(super) fn wait_for<T>(
    call: &'static str,
    mut ask: impl FnMut(&mut Robios) -> Result<Waiting<T>>,
) -> Option<T> {
    loop {
        match enter(call, &mut ask)? {
            Waiting::Pressed(value) => return Some(value),
            Waiting::Until(time) => sleep_until(time)?,
            Waiting::Forever => sleep_for(call, 60.0)?,
        }
    }
}
