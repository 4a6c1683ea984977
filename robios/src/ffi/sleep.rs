//! Waiting of programs.

use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};

use roverlab::io::Result;
use roverlab::io::sim::TICK;

use super::runtime::{enter, enter_quietly, enter_to_wait};
use super::sleepers::{Event, Sleeper, asleep, glance, sleeps, standstill};
use super::threads::{alone, calls, is_inside, is_the_programs, joining};
#[cfg(target_os = "linux")]
use super::turns::{Turn, all_sleep, has_child, note_call};
use crate::keys::Waiting;
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
pub(super) fn takes_turns() -> bool {
    !alone() && is_the_programs() && !is_inside() && !sleeps()
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

/// Number of threads that are starting another one and let it run: this is short, so nobody wakes up
/// meanwhile.
static STARTERS: AtomicU64 = AtomicU64::new(0);

fn nobody_starts() -> bool {
    STARTERS.load(Ordering::Relaxed) == 0
}

/// Lets time pass until a thread, the next, wakes up at `end`: a tick at most, unless all threads were asleep
/// at the present time, so that none can act before.
fn pass_until(end: f64, all_asleep_at: Option<f64>) -> Option<()> {
    enter_quietly(|robios| {
        let now = robios.now();
        let most = match robios.timers.next() {
            _ if all_asleep_at != Some(now) => TICK,
            Some(due) => (due - now).max(TICK),
            None => f64::INFINITY,
        };
        let rest = rest_until(end, now);
        if rest > 0.0 { robios.pass(rest.min(most)) } else { Ok(()) }
    })
}

/// Time that passes at once while nothing is due (s).
const FOREVER: f64 = 60.0;

fn rest_until(end: f64, now: f64) -> f64 {
    if end.is_finite() { end - now } else { FOREVER }
}

/// Lets the program wait until a time since the start (s). Timer functions are called in between.
fn sleep_until(end: f64) -> Option<()> {
    sleep(&mut Sleeper::until(end))
}

/// Lets the program wait until the end of a sleep. Timer functions are called in between.
///
/// A program with one thread skips the time, and so does one whose threads all sleep. Otherwise the next to
/// wake up advances the world by a tick whenever the others have had and not used the opportunity to act. It
/// wakes up when the previous one waits again, so that the order of calls does not depend on the system.
fn sleep(sleeper: &mut Sleeper) -> Option<()> {
    let mut turn = Turn::default();
    let mut waking: Option<Turn> = None;
    let mut standing = Standstill::default();
    loop {
        let (alone, before, end) = (alone(), calls(), sleeper.end());
        if alone && end.is_infinite() {
            note_standstill("");
        }
        let now = enter_quietly(|robios| {
            let now = robios.now();
            if now < end && alone {
                let next = robios.timers.next().map_or(end, |due| due.min(end));
                robios.pass(rest_until(next, now))?;
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
            (turn, waking, standing) = (Turn::default(), None, Standstill::default());
            continue;
        }
        if is_due
            && nobody_starts()
            && (all_sleep(&asleep()) || waking.get_or_insert_default().is_long_over(&asleep()))
        {
            let _ = AWAKE_SINCE.try_with(|since| since.set(now));
            return Some(());
        }
        if is_due {
            glance();
        } else if end.is_infinite() {
            // Only another thread, a timer or a signal can end this.
            sleeper.listen();
            if standing.holds() && sleeper.is_next() {
                pass_until(end, Some(now))?;
            } else if standing.may_hold() {
                glance();
            } else {
                sleeper.wait_to_be_told();
            }
        } else {
            glance();
            if calls() != before || !nobody_starts() {
                turn = Turn::default();
            } else if all_sleep(&asleep()) && sleeper.is_next() {
                pass_until(end, Some(now))?;
            } else if turn.is_over(&asleep()) {
                turn = Turn::default();
                if sleeper.is_next() {
                    pass_until(end, None)?;
                }
            }
        }
    }
}

/// Lets this thread wait for an event, until a time (s) at most. It is over when `attempt` succeeds, which is
/// made before, and whenever another thread has brought the event about; the attempt is told whether that has
/// happened. `None` at the end of the time, or without a robot.
pub(super) fn wait_for_event<T>(
    event: Event,
    end: f64,
    mut attempt: impl FnMut(bool) -> Option<T>,
) -> Option<T> {
    let now = enter_quietly(|robios| Ok(robios.now()))?;
    let mut sleeper = Sleeper::for_event(event, now, end);
    loop {
        // Another thread may have brought it about before this one was listed.
        if let Some(done) = attempt(sleeper.is_woken()) {
            return Some(done);
        }
        sleep(&mut sleeper)?;
        let woken = sleeper.is_woken();
        let done = attempt(woken);
        if done.is_some() || !woken {
            return done;
        }
        sleeper.begin();
    }
}

/// Reports who waits for what, unless a timer function may end that.
fn note_standstill(others: &str) {
    let Some(waits) = standstill() else { return };
    // Without a robot there is no report.
    let _ = enter_quietly(|robios| {
        if robios.timers.is_empty() {
            robios.note(&format!("the program's threads wait for each other: {waits}{others}"));
        }
        Ok(())
    });
}

/// Notices that all threads wait for each other, and so for ever: then time passes, as for a program that
/// waits for anything else, and the report says who waits for what.
#[derive(Debug, Default)]
struct Standstill {
    turn: Turn,
    /// Whether the last look has found one.
    found: bool,
}

impl Standstill {
    fn holds(&mut self) -> bool {
        let waiting = [asleep(), joining()].concat();
        let before = std::mem::replace(&mut self.found, nobody_starts() && all_sleep(&waiting));
        // Those that wait for a thread's end may have been woken by it.
        let still = self.found && (joining().is_empty() || self.turn.is_over(&asleep()));
        if !self.found {
            self.turn = Turn::default();
        }
        // Another process may end it, in real time.
        self.found &= !has_child();
        if !(self.found && before && still) {
            return false;
        }
        note_standstill(if joining().is_empty() { "" } else { ", and another for the end of a thread" });
        true
    }

    /// Whether another look should follow at once.
    fn may_hold(&self) -> bool {
        self.found
    }
}

/// Lets the program's other threads run until they wait: a thread just started is the first to run.
#[cfg(target_os = "linux")]
pub(super) fn let_others_run() {
    let mut turn = Turn::default();
    STARTERS.fetch_add(1, Ordering::Relaxed);
    while !turn.is_long_over(&asleep()) {
        glance();
    }
    STARTERS.fetch_sub(1, Ordering::Relaxed);
}

/// Where thread states are unknown, the others have had their turn after a nap.
#[cfg(not(target_os = "linux"))]
#[derive(Debug, Default)]
struct Turn;

#[cfg(not(target_os = "linux"))]
fn note_call() {}

#[cfg(not(target_os = "linux"))]
fn all_sleep(_: &[u32]) -> bool {
    false
}

#[cfg(not(target_os = "linux"))]
fn has_child() -> bool {
    false
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
            Waiting::Forever => sleep_for(call, FOREVER)?,
        }
    }
}
