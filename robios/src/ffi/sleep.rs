//! Waiting of programs.

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
use super::turns::{Turn, all_sleep, is_there, own_number};
use crate::keys::Waiting;
use crate::robios::Robios;

/// Lets the program wait for a time (s).
pub(super) fn sleep_for(call: &'static str, seconds: f64) -> Option<()> {
    let start = enter(call, |robios| Ok(robios.now()))?;
    sleep_until(start + seconds)
}

/// Real time between a sleeping thread's checks of the others.
const GRACE: Duration = Duration::from_micros(50);

/// Wake-up times of the sleeping threads since the start (s), and their numbers.
static ENDS: Mutex<BTreeMap<u64, (f64, u32)>> = Mutex::new(BTreeMap::new());
static SLEEPERS: AtomicU64 = AtomicU64::new(0);
/// Number of threads that are starting another one and let it run: this is short, so nobody wakes up
/// meanwhile.
static STARTERS: AtomicU64 = AtomicU64::new(0);

/// Accesses the list as within a call, so that a sleeping signal handler does not wait for this thread.
fn at_ends<T>(look: impl FnOnce(&mut BTreeMap<u64, (f64, u32)>) -> T) -> T {
    let _inside = Inside::new();
    look(&mut ENDS.lock().unwrap_or_else(PoisonError::into_inner))
}

fn nobody_starts() -> bool {
    STARTERS.load(Ordering::Relaxed) == 0
}

/// Numbers of the sleeping threads.
fn asleep() -> Vec<u32> {
    at_ends(|ends| ends.values().map(|&(_, thread)| thread).collect())
}

/// Whether all of the program's threads are asleep at a time, and each until later.
fn all_are_asleep(now: f64) -> bool {
    let (threads, earliest) = at_ends(|ends| {
        let earliest = ends.values().map(|&(end, _)| end).fold(f64::INFINITY, f64::min);
        (ends.values().map(|&(_, thread)| thread).collect::<Vec<_>>(), earliest)
    });
    earliest > now && all_sleep(&threads)
}

/// A sleeping thread.
struct Sleeper {
    number: u64,
    /// Number of checks for another thread that should have woken up.
    waits: u32,
}

/// Checks after which a thread that should have woken up and has ended is forgotten: it was cancelled.
const SOME_WAITS: u32 = 200;
/// Checks after which any thread that should have woken up is forgotten: it left its sleep in another way.
const MOST_WAITS: u32 = 20_000;

impl Sleeper {
    fn new(end: f64) -> Self {
        let number = SLEEPERS.fetch_add(1, Ordering::Relaxed);
        at_ends(|ends| ends.insert(number, (end, own_number())));
        Self { number, waits: 0 }
    }

    /// Lets time pass until the next thread wakes up, and nothing before due threads have done so: a tick at most,
    /// unless all threads were asleep at the present time, so that none can act before.
    fn pass(&mut self, all_asleep_at: Option<f64>) -> Option<()> {
        let earliest = at_ends(|ends| ends.values().map(|&(end, _)| end).fold(f64::INFINITY, f64::min));
        let passed = enter_quietly(|robios| {
            let now = robios.now();
            let most = match robios.timers.next() {
                _ if all_asleep_at != Some(now) => TICK,
                Some(due) => (due - now).max(TICK),
                None => f64::INFINITY,
            };
            let rest = earliest - now;
            if rest > 0.0 { robios.pass(rest.min(most)).map(|()| true) } else { Ok(false) }
        })?;
        self.waits = if passed { 0 } else { self.waits + 1 };
        self.forget_others();
        Some(())
    }

    /// Forgets threads that should have woken up and never will.
    fn forget_others(&self) {
        if self.waits.is_multiple_of(SOME_WAITS) {
            let lost = self.waits >= MOST_WAITS;
            let remembers = |number, thread| number == self.number || (!lost && is_there(thread));
            at_ends(|ends| ends.retain(|&number, &mut (_, thread)| remembers(number, thread)));
        }
    }

    /// Whether it is this thread's turn to wake up among all that are due. Sleeping threads wake in the order
    /// of their times, each when the previous one waits again, so that the order of calls does not depend on
    /// the system.
    fn may_wake(&mut self, turn: &mut Turn, end: f64) -> bool {
        let first = at_ends(|ends| {
            let earlier = |(&number, &(other, _)): (&u64, &(f64, u32))| (other, number) < (end, self.number);
            !ends.iter().any(earlier)
        });
        self.waits += 1;
        self.forget_others();
        first && nobody_starts() && turn.is_long_over(&asleep())
    }
}

impl Drop for Sleeper {
    fn drop(&mut self) {
        at_ends(|ends| ends.remove(&self.number));
    }
}

/// Lets the program wait until a time since the start (s). Timer functions are called in between.
///
/// A program with one thread skips the time, and so does one whose threads all sleep. Otherwise a sleeping one advances
/// the world by a tick whenever the others have had and not used the opportunity to act.
fn sleep_until(end: f64) -> Option<()> {
    let (mut sleeper, mut turn) = (Sleeper::new(end), Turn::default());
    let mut waking: Option<Turn> = None;
    loop {
        let (alone, before) = (alone(), calls());
        let now = enter_quietly(|robios| {
            let now = robios.now();
            if now < end && alone {
                let next = robios.timers.next().map_or(end, |due| due.min(end));
                robios.pass(next - now)?;
            }
            Ok(robios.now())
        })?;
        let rest = end - now;
        if alone && rest > 0.0 {
            continue;
        }
        if rest <= 0.0 {
            if alone || sleeper.may_wake(waking.get_or_insert_default(), end) {
                return Some(());
            }
            nap(GRACE);
            continue;
        }
        nap(GRACE);
        if calls() != before || !nobody_starts() {
            turn = Turn::default();
        } else if all_are_asleep(now) {
            sleeper.pass(Some(now))?;
        } else if turn.is_over(&asleep()) {
            turn = Turn::default();
            sleeper.pass(None)?;
        }
    }
}

/// Lets the program's other threads run until they wait: a thread just started is the first to run.
#[cfg(target_os = "linux")]
pub(super) fn let_others_run() {
    let mut turn = Turn::default();
    STARTERS.fetch_add(1, Ordering::Relaxed);
    while !turn.is_long_over(&asleep()) {
        nap(GRACE);
    }
    STARTERS.fetch_sub(1, Ordering::Relaxed);
}

/// Where thread states are unknown, the others have had their turn after a nap.
#[cfg(not(target_os = "linux"))]
#[derive(Debug, Default)]
struct Turn;

#[cfg(not(target_os = "linux"))]
fn own_number() -> u32 {
    0
}

#[cfg(not(target_os = "linux"))]
fn all_sleep(_: &[u32]) -> bool {
    false
}

#[cfg(not(target_os = "linux"))]
fn is_there(_: u32) -> bool {
    true
}

#[cfg(not(target_os = "linux"))]
impl Turn {
    #[allow(clippy::unused_self, reason = "as where it is known")]
    fn is_over(&mut self, _asleep: &[u32]) -> bool {
        true
    }

    #[allow(clippy::unused_self, reason = "as where it is known")]
    fn is_long_over(&mut self, _asleep: &[u32]) -> bool {
        true
    }
}

/// Whether a call may block in the world, because the program has nothing else to do.
pub(super) fn may_block() -> bool {
    alone() && enter_quietly(|robios| Ok(robios.timers.is_empty())).unwrap_or(true)
}

/// Waits until a query has an answer.
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
