//! Waiting of programs.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use roverlab::io::Result;
use roverlab::io::sim::TICK;

use super::real_time::nap;
use super::runtime::{enter, enter_quietly, enter_to_wait};
use super::threads::{Inside, alone, calls, is_inside, is_the_programs};
#[cfg(target_os = "linux")]
use super::turns::{Turn, all_sleep, is_there, note_call, own_number};
use crate::keys::Waiting;
use crate::memory;
use crate::robios::{NANOSECONDS, Robios};

/// Lets the program wait for a time (s).
pub(super) fn sleep_for(call: &'static str, seconds: f64) -> Option<()> {
    let start = enter_to_wait(call, |robios| Ok(robios.now()))?;
    sleep_until(start + seconds)
}

thread_local! {
    /// Time at which this thread's last wait ended (s).
    static AWAKE_SINCE: Cell<f64> = const { Cell::new(0.0) };
}

/// Whether this thread's calls wait for their turn: not if it is alone, or calls from a timer function or
/// signal handler that interrupts its sleep or a call.
fn takes_turns() -> bool {
    !alone() && is_the_programs() && !is_inside() && {
        let own = own_number();
        at_ends(|ends| ends.values().all(|sleep| sleep.thread != own))
    }
}

/// Waits for the frame that serves a query, so that threads which are due earlier run first. Returns the
/// frame's time since the start (ns), if there is a wait.
pub(super) fn wait_for_frame(call: &'static str) -> Option<u64> {
    if !takes_turns() {
        return None;
    }
    note_call();
    let frame = enter_quietly(|robios| Ok(robios.reserve(call)))??;
    sleep_until(frame as f64 / NANOSECONDS)?;
    Some(frame)
}

/// Lets other threads run that are due earlier, if this one's calls have taken a tick since it last waited.
///
/// Not more often: the call may be within a lock, and others that wait for it would then run beside this
/// thread.
pub(super) fn let_earlier_run() {
    if !takes_turns() {
        return;
    }
    let Some(now) = enter_quietly(|robios| Ok(robios.now())) else { return };
    let since = AWAKE_SINCE.try_with(Cell::get).unwrap_or(now);
    if now - since >= TICK {
        // The program is over if it fails.
        let _ = sleep_until(now);
    }
}

/// Real time between a sleeping thread's checks of the others.
const GRACE: Duration = Duration::from_micros(50);

/// A thread's sleep.
#[derive(Debug)]
struct Sleep {
    /// Wake-up time since the start (s).
    end: f64,
    /// Number of the thread.
    thread: u32,
    /// Set to 1 when it is the next to wake up: until then the thread leaves it to others to let time pass.
    next: Arc<AtomicU32>,
}

/// The sleeping threads' sleeps by number.
static ENDS: Mutex<BTreeMap<u64, Sleep>> = Mutex::new(BTreeMap::new());
static SLEEPERS: AtomicU64 = AtomicU64::new(0);
/// Number of threads that are starting another one and let it run: this is short, so nobody wakes up
/// meanwhile.
static STARTERS: AtomicU64 = AtomicU64::new(0);

/// Accesses the list as within a call, so that a sleeping signal handler does not wait for this thread.
fn at_ends<T>(look: impl FnOnce(&mut BTreeMap<u64, Sleep>) -> T) -> T {
    let _inside = Inside::new();
    look(&mut ENDS.lock().unwrap_or_else(PoisonError::into_inner))
}

/// The next to wake up: threads wake in the order of their times, and of their calls.
fn next_of(ends: &BTreeMap<u64, Sleep>) -> Option<(u64, &Sleep)> {
    let ends = ends.iter().map(|(&number, sleep)| (number, sleep));
    ends.min_by(|(_, one), (_, other)| one.end.total_cmp(&other.end))
}

/// Removes sleeps, and tells the next thread that it is.
fn forget(remains: impl Fn(u64, &Sleep) -> bool) {
    at_ends(|ends| {
        ends.retain(|&number, sleep| remains(number, sleep));
        if let Some((_, sleep)) = next_of(ends) {
            sleep.next.store(1, Ordering::Release);
            memory::wake(&sleep.next);
        }
    });
}

/// Wake-up time of the next thread (s).
fn earliest_end() -> f64 {
    at_ends(|ends| next_of(ends).map_or(f64::INFINITY, |(_, sleep)| sleep.end))
}

fn nobody_starts() -> bool {
    STARTERS.load(Ordering::Relaxed) == 0
}

/// Numbers of the sleeping threads.
fn asleep() -> Vec<u32> {
    at_ends(|ends| ends.values().map(|sleep| sleep.thread).collect())
}

/// A sleeping thread.
struct Sleeper {
    number: u64,
    end: f64,
    next: Arc<AtomicU32>,
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
        let next = Arc::new(AtomicU32::new(0));
        let sleep = Sleep { end, thread: own_number(), next: Arc::clone(&next) };
        at_ends(|ends| ends.insert(number, sleep));
        Self { number, end, next, waits: 0 }
    }

    /// Whether this thread is the next to wake up, and so the one that looks after the others.
    fn is_next(&self) -> bool {
        at_ends(|ends| next_of(ends).is_none_or(|(number, _)| number == self.number))
    }

    /// Waits until this thread is the next to wake up, but not for long: the next one may never wake up.
    fn wait_to_be_next(&mut self, now: f64) {
        memory::wait(&self.next, 0, SOME_WAITS * GRACE);
        if self.next.swap(0, Ordering::Acquire) != 0 || earliest_end() > now {
            self.waits = 0;
            return;
        }
        self.waits += SOME_WAITS;
        let lost = self.waits >= MOST_WAITS;
        let own = self.number;
        forget(|number, sleep| number == own || is_there(sleep.thread) && !(lost && sleep.end <= now));
    }

    /// Lets time pass until this thread, the next, wakes up: a tick at most, unless all threads were asleep
    /// at the present time, so that none can act before.
    fn pass(&self, all_asleep_at: Option<f64>) -> Option<()> {
        enter_quietly(|robios| {
            let now = robios.now();
            let most = match robios.timers.next() {
                _ if all_asleep_at != Some(now) => TICK,
                Some(due) => (due - now).max(TICK),
                None => f64::INFINITY,
            };
            let rest = self.end - now;
            if rest > 0.0 { robios.pass(rest.min(most)) } else { Ok(()) }
        })
    }
}

impl Drop for Sleeper {
    fn drop(&mut self) {
        forget(|number, _| number != self.number);
    }
}

/// Lets the program wait until a time since the start (s). Timer functions are called in between.
///
/// A program with one thread skips the time, and so does one whose threads all sleep. Otherwise the next to
/// wake up advances the world by a tick whenever the others have had and not used the opportunity to act. It
/// wakes up when the previous one waits again, so that the order of calls does not depend on the system.
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
        let is_due = end <= now;
        if alone && is_due {
            return Some(());
        }
        if alone {
            continue;
        }
        if !sleeper.is_next() {
            sleeper.wait_to_be_next(now);
            // What it knew of the others is past.
            (turn, waking) = (Turn::default(), None);
            continue;
        }
        if is_due && nobody_starts() && waking.get_or_insert_default().is_long_over(&asleep()) {
            let _ = AWAKE_SINCE.try_with(|since| since.set(now));
            return Some(());
        }
        nap(GRACE);
        if is_due {
            continue;
        }
        if calls() != before || !nobody_starts() {
            turn = Turn::default();
        } else if all_sleep(&asleep()) && sleeper.is_next() {
            sleeper.pass(Some(now))?;
        } else if turn.is_over(&asleep()) {
            turn = Turn::default();
            if sleeper.is_next() {
                sleeper.pass(None)?;
            }
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
fn note_call() {}

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
