//! The sleeping threads of a program, in the order in which they wake up.
//!
//! A thread sleeps until a time, until an event such as the release of a lock, or until whichever comes first.
//! An event turns into a time: that at which another thread has brought it about.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::atomic::{AtomicU32, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use super::real_time::nap;
use super::runtime::peek_time;
use super::threads::{Inside, is_inside, is_ours};
#[cfg(target_os = "linux")]
use super::turns::{is_there, own_number};
use crate::memory;

/// Real time between a sleeping thread's checks of the others.
pub(super) const GRACE: Duration = Duration::from_micros(50);

/// What a thread waits for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Event {
    /// Address of the lock, condition, semaphore or barrier.
    pub(super) place: usize,
    /// What is there, for reports.
    pub(super) kind: &'static str,
    /// Number of the thread that holds it, if that is known.
    pub(super) holder: Option<u32>,
}

/// A thread's sleep.
#[derive(Debug)]
struct Sleep {
    /// Wake-up time since the start (s); infinite until the event.
    end: f64,
    /// Number of the thread, its number within the program, and its handle.
    thread: u32,
    ordinal: u32,
    handle: libc::pthread_t,
    /// Set to 1 when it is the next to wake up: until then the thread leaves it to others to let time pass.
    next: Arc<AtomicU32>,
    /// What it waits for, where, and since when (s); nowhere and never without an event.
    event: Option<Event>,
    place: usize,
    since: f64,
    woken: Woken,
}

/// Whether a thread's event has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Woken {
    No,
    Yes,
    /// Nobody else may take what it waits for: it has waited while time passed.
    First,
}

/// The sleeping threads' sleeps by number.
static ENDS: Mutex<BTreeMap<u64, Sleep>> = Mutex::new(BTreeMap::new());
static SLEEPERS: AtomicU64 = AtomicU64::new(0);
/// Number of sleeps with an event.
static EVENTS: AtomicUsize = AtomicUsize::new(0);
static ORDINALS: AtomicU32 = AtomicU32::new(0);

thread_local! {
    static ORDINAL: Cell<u32> = const { Cell::new(0) };
}

/// Number of this thread within the program, from 1: in the order of their first waits, as each new thread
/// runs until it waits.
pub(super) fn ordinal() -> u32 {
    let ordinal = ORDINAL.try_with(|ordinal| {
        if ordinal.get() == 0 {
            ordinal.set(ORDINALS.fetch_add(1, Ordering::Relaxed) + 1);
        }
        ordinal.get()
    });
    ordinal.unwrap_or_default()
}

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

/// Tells the next thread that it is.
fn tell_next(ends: &BTreeMap<u64, Sleep>) {
    if let Some((_, sleep)) = next_of(ends) {
        sleep.next.store(1, Ordering::Release);
        memory::wake(&sleep.next);
    }
}

/// Removes sleeps, and tells the next thread that it is.
fn forget(remains: impl Fn(u64, &Sleep) -> bool) {
    at_ends(|ends| {
        ends.retain(|&number, sleep| remains(number, sleep));
        tell_next(ends);
    });
}

/// Wake-up time of the next thread (s).
fn earliest_end() -> f64 {
    at_ends(|ends| next_of(ends).map_or(f64::INFINITY, |(_, sleep)| sleep.end))
}

/// Numbers of the sleeping threads.
pub(super) fn asleep() -> Vec<u32> {
    at_ends(|ends| ends.values().map(|sleep| sleep.thread).collect())
}

/// Whether this thread sleeps, and runs a timer function or signal handler meanwhile.
pub(super) fn sleeps() -> bool {
    let own = own_number();
    at_ends(|ends| ends.values().any(|sleep| sleep.thread == own))
}

/// Brings about the event at a place, for the first threads that wait for it: they wake up one after the
/// other.
pub(super) fn wake(place: usize, most: usize) {
    if EVENTS.load(Ordering::Acquire) != 0 {
        wake_sleeps(most, |sleep| sleep.woken == Woken::No && sleep.place == place);
    }
}

/// Ends a thread's sleep.
#[cfg(target_os = "linux")]
pub(super) fn wake_thread(handle: libc::pthread_t) {
    wake_sleeps(usize::MAX, |sleep| sleep.handle == handle);
}

fn wake_sleeps(most: usize, these: impl Fn(&Sleep) -> bool) {
    if !is_ours() || is_inside() || !at_ends(|ends| ends.values().any(&these)) {
        return;
    }
    let Some(now) = peek_time() else { return };
    at_ends(|ends| {
        for sleep in ends.values_mut().filter(|sleep| these(sleep)).take(most) {
            sleep.woken = if sleep.since < now { Woken::First } else { Woken::Yes };
            sleep.end = sleep.end.min(now);
        }
        tell_next(ends);
    });
}

/// Whether what is at a place belongs to another thread that is about to wake up: one that has waited while
/// time passed goes first, or a thread that holds a lock whenever it waits would keep it for good.
pub(super) fn is_promised(place: usize) -> bool {
    let own = own_number();
    EVENTS.load(Ordering::Acquire) != 0
        && !is_inside()
        && at_ends(|ends| {
            let mut promises =
                ends.values().filter(|sleep| sleep.woken == Woken::First && sleep.thread != own);
            promises.any(|sleep| sleep.place == place)
        })
}

/// What the sleeping threads wait for, if none of them wakes up by itself.
pub(super) fn standstill() -> Option<String> {
    at_ends(|ends| {
        let all_wait = ends.values().all(|sleep| sleep.end.is_infinite() && sleep.event.is_some());
        let waits: Vec<String> = ends.values().map(|sleep| sleep.describe(ends)).collect();
        (all_wait && !waits.is_empty()).then(|| waits.join(", "))
    })
}

impl Sleep {
    fn describe(&self, all: &BTreeMap<u64, Sleep>) -> String {
        let (Some(event), since) = (self.event, self.since) else { return String::new() };
        let holder = event.holder.and_then(|holder| {
            if holder == self.thread {
                return Some("itself".to_owned());
            }
            all.values().find(|sleep| sleep.thread == holder).map(|sleep| format!("thread {}", sleep.ordinal))
        });
        let holder = holder.map_or_else(String::new, |holder| format!(" of {holder}"));
        format!("thread {} for {}{holder} since {since:.2} s", self.ordinal, event.kind)
    }
}

/// A sleeping thread.
pub(super) struct Sleeper {
    number: u64,
    /// Wake-up time without the event (s).
    end: f64,
    event: Option<(Event, f64)>,
    next: Arc<AtomicU32>,
    /// Number of checks for another thread that should have woken up.
    waits: u32,
}

impl fmt::Debug for Sleeper {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Sleeper")
            .field("number", &self.number)
            .field("end", &self.end)
            .finish_non_exhaustive()
    }
}

/// Checks after which a thread that should have woken up and has ended is forgotten: it was cancelled.
const SOME_WAITS: u32 = 200;
/// Checks after which any thread that should have woken up is forgotten: it left its sleep in another way.
const MOST_WAITS: u32 = 20_000;

impl Sleeper {
    /// Lists this thread as sleeping until a time (s).
    pub(super) fn until(end: f64) -> Self {
        Self::new(end, None)
    }

    /// Lists it as waiting for an event since `now`, until a time (s) at most.
    pub(super) fn for_event(event: Event, now: f64, end: f64) -> Self {
        EVENTS.fetch_add(1, Ordering::AcqRel);
        Self::new(end, Some((event, now)))
    }

    fn new(end: f64, event: Option<(Event, f64)>) -> Self {
        let number = SLEEPERS.fetch_add(1, Ordering::Relaxed);
        let sleeper = Self { number, end, event, next: Arc::new(AtomicU32::new(0)), waits: 0 };
        sleeper.begin();
        sleeper
    }

    /// Lists the sleep, as not yet woken.
    pub(super) fn begin(&self) {
        self.list(self.end, Woken::No);
    }

    fn list(&self, end: f64, woken: Woken) {
        let (next, event) = (Arc::clone(&self.next), self.event);
        // SAFETY: only queries this thread's handle.
        let handle = unsafe { libc::pthread_self() };
        let (thread, ordinal) = (own_number(), ordinal());
        let (place, since) = event.map_or((0, f64::INFINITY), |(event, since)| (event.place, since));
        let event = event.map(|(event, _)| event);
        let sleep = Sleep { end, thread, ordinal, handle, next, event, place, since, woken };
        at_ends(|ends| ends.insert(self.number, sleep));
    }

    /// Wake-up time as it is now (s). A sleep that others have given up is listed again: what it waits for may
    /// have come meanwhile.
    pub(super) fn end(&self) -> f64 {
        if let Some(end) = at_ends(|ends| ends.get(&self.number).map(|sleep| sleep.end)) {
            return end;
        }
        if self.event.is_some() {
            self.list(f64::NEG_INFINITY, Woken::Yes);
            return f64::NEG_INFINITY;
        }
        self.begin();
        self.end
    }

    /// Whether the event has come.
    pub(super) fn is_woken(&self) -> bool {
        at_ends(|ends| ends.get(&self.number).is_some_and(|sleep| sleep.woken != Woken::No))
    }

    /// Whether this thread is the next to wake up, and so the one that looks after the others.
    pub(super) fn is_next(&self) -> bool {
        at_ends(|ends| next_of(ends).is_none_or(|(number, _)| number == self.number))
    }

    /// Waits until this thread is the next to wake up, but not for long: the next one may never wake up.
    pub(super) fn wait_to_be_next(&mut self, now: f64) {
        self.wait_to_be_told();
        if self.next.swap(0, Ordering::Acquire) != 0 || earliest_end() > now {
            self.waits = 0;
            return;
        }
        self.waits += SOME_WAITS;
        let lost = self.waits >= MOST_WAITS;
        let own = self.number;
        forget(|number, sleep| number == own || is_there(sleep.thread) && !(lost && sleep.end <= now));
    }

    /// Waits until another thread has changed the order, but not for long.
    pub(super) fn wait_to_be_told(&self) {
        memory::wait(&self.next, 0, SOME_WAITS * GRACE);
    }

    /// Forgets that it was told.
    pub(super) fn listen(&self) {
        self.next.store(0, Ordering::Release);
    }
}

impl Drop for Sleeper {
    fn drop(&mut self) {
        forget(|number, _| number != self.number);
        if self.event.is_some() {
            EVENTS.fetch_sub(1, Ordering::AcqRel);
        }
    }
}

/// A short sleep in real time.
pub(super) fn glance() {
    nap(GRACE);
}

/// Where threads have no numbers that tell whether they are there.
#[cfg(not(target_os = "linux"))]
fn own_number() -> u32 {
    ordinal()
}

#[cfg(not(target_os = "linux"))]
fn is_there(_: u32) -> bool {
    true
}
