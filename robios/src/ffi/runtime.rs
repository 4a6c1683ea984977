//! The one robot of a process: its beginning, its lock, its end, and how its program waits.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::env;
use std::ffi::c_int;
use std::os::fd::FromRawFd;
use std::os::unix::net::UnixStream;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicI32, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError, TryLockError};
use std::time::Duration;

use roverlab::io::sim::TICK;
use roverlab::io::{ErrorKind, Result};

use crate::keyboard::Keyboard;
use crate::keys::{KeyDesk, KeyPlan, Typed, Waiting};
use crate::link::{Link, Remote, own_world};
use crate::plan::{Plan, names};
use crate::report::{Report, ReportFile, Stage};
use crate::robios::{Outlets, Robios};

#[cfg(target_os = "linux")]
use super::turns::Turn;

#[derive(Debug)]
enum State {
    /// No function has been called.
    Unborn,
    Alive(Box<Robios>),
    /// The run is over, or never began.
    Over,
}

static STATE: Mutex<State> = Mutex::new(State::Unborn);
/// The process that the robot belongs to; a child after `fork` has none.
static OWNER: AtomicI32 = AtomicI32::new(0);
/// Calls so far, but for those of threads that sleep.
static CALLS: AtomicU64 = AtomicU64::new(0);
/// Threads that call, and whether the program has started any.
static THREADS: AtomicUsize = AtomicUsize::new(0);
static STARTED_THREADS: AtomicBool = AtomicBool::new(false);
/// Whether a timer's function is being called.
static IN_TIMER: AtomicBool = AtomicBool::new(false);

/// The exit status of a program that the library ends.
const ENDED: c_int = 124;

thread_local! {
    /// Whether this thread is within a call: a signal handler that calls again must not wait for itself.
    static INSIDE: Cell<bool> = const { Cell::new(false) };
    /// Counts this thread while it lives.
    static PRESENT: Present = Present::new();
    /// Whether this thread is the library's own, or about to start one: it is none of the program's.
    static OURS: Cell<bool> = const { Cell::new(false) };
}

/// Says whether this thread acts for the library.
pub(super) fn set_ours(ours: bool) {
    let _ = OURS.try_with(|flag| flag.set(ours));
}

fn is_the_programs() -> bool {
    !OURS.try_with(Cell::get).unwrap_or(false)
}

/// Calls so far.
pub(super) fn calls() -> u64 {
    CALLS.load(Ordering::Relaxed)
}

struct Present;

impl Present {
    fn new() -> Self {
        THREADS.fetch_add(1, Ordering::Relaxed);
        Self
    }
}

impl Drop for Present {
    fn drop(&mut self) {
        THREADS.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Marks this thread as being within a call.
struct Inside;

impl Inside {
    fn new() -> Option<Self> {
        let free = INSIDE.try_with(|inside| !inside.replace(true)).unwrap_or(false);
        // Made only where it is needed: to drop it is to say that the thread has left.
        if free { Some(Self) } else { None }
    }
}

impl Drop for Inside {
    fn drop(&mut self) {
        let _ = INSIDE.try_with(|inside| inside.set(false));
    }
}

/// Whether the robot belongs to this process, or to nobody yet.
pub(super) fn is_ours() -> bool {
    let owner = OWNER.load(Ordering::Acquire);
    owner == 0 || owner == process()
}

fn process() -> i32 {
    std::process::id() as i32
}

/// Whether there is a robot in virtual time already.
#[cfg(target_os = "linux")]
pub(super) fn is_alive() -> bool {
    OWNER.load(Ordering::Acquire) != 0
}

/// Notes that the program has started a thread.
pub(super) fn note_thread() {
    if is_the_programs() {
        STARTED_THREADS.store(true, Ordering::Relaxed);
    }
}

fn alone() -> bool {
    !STARTED_THREADS.load(Ordering::Relaxed) && THREADS.load(Ordering::Relaxed) <= 1
}

/// Calls the robot. `None` if there is none, or if it cannot do what is asked. Ends the program when its time is over.
pub(super) fn enter<T>(call: impl FnOnce(&mut Robios) -> Result<T>) -> Option<T> {
    if is_the_programs() {
        CALLS.fetch_add(1, Ordering::Relaxed);
    }
    enter_quietly(call)
}

/// As [`enter`], for threads that sleep.
fn enter_quietly<T>(call: impl FnOnce(&mut Robios) -> Result<T>) -> Option<T> {
    if !is_ours() {
        return None;
    }
    let inside = Inside::new()?;
    if is_the_programs() {
        let _ = PRESENT.try_with(|_| ());
    }
    let mut state = lock();
    if let State::Unborn = *state {
        *state = born();
    }
    serve(state, inside, call)
}

/// Calls the robot behind the lock, and what is due of the timers' functions without it.
fn serve<T>(
    mut state: MutexGuard<'static, State>,
    inside: Inside,
    call: impl FnOnce(&mut Robios) -> Result<T>,
) -> Option<T> {
    let State::Alive(robios) = &mut *state else { return None };
    // A panic would be a mistake of this library. The robot is as consistent after it as before each step.
    let answer = catch_unwind(AssertUnwindSafe(|| call(robios))).ok();
    robios.publish();
    let now = robios.now();
    let ahead = if robios.keys.is_live() { lead(now) } else { Duration::ZERO };
    if let Some(Err(error)) = &answer {
        match error.kind() {
            ErrorKind::TimedOut => end(state, Stage::TimedOut),
            ErrorKind::Disconnected => end(state, Stage::Disconnected),
            _ => {}
        }
    } else if !robios.timers.is_empty() && !IN_TIMER.swap(true, Ordering::Acquire) {
        let due = robios.timers.due(now);
        drop(state);
        drop(inside);
        for function in due {
            function();
        }
        IN_TIMER.store(false, Ordering::Release);
    } else {
        drop(state);
        drop(inside);
    }
    if !ahead.is_zero() {
        nap(ahead);
    }
    answer.and_then(Result::ok)
}

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

/// Lets time pass that nobody has asked for: so many seconds to where the next timer is due, or without timers.
pub(super) fn pass_unasked(with_timers: f64, without: f64) -> Unasked {
    let Some(inside) = Inside::new().filter(|_| is_ours()) else { return Unasked::Over };
    let state = match STATE.try_lock() {
        Ok(state) => state,
        Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
        Err(TryLockError::WouldBlock) => return Unasked::Busy,
    };
    if !matches!(*state, State::Alive(_)) {
        return Unasked::Over;
    }
    serve(state, inside, |robios| match robios.timers.next() {
        Some(due) => {
            let rest = due - robios.now();
            robios.pass(rest.min(with_timers))
        }
        None if without > 0.0 => robios.pass(without),
        None => Ok(()),
    });
    Unasked::Passed
}

fn lock() -> MutexGuard<'static, State> {
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The robot that the environment describes.
fn born() -> State {
    OWNER.store(process(), Ordering::Release);
    match catch_unwind(robot) {
        Ok(Ok(robios)) => {
            super::sensing::publish_points(robios.lidar_points());
            if env::var_os(names::SOCKET).is_none() {
                // A world that is shared goes on by itself.
                super::watch::start();
            }
            State::Alive(Box::new(robios))
        }
        Ok(Err(message)) => {
            eprintln!("libeyesim: {message}");
            refuse();
            State::Over
        }
        Err(_) => State::Over,
    }
}

fn robot() -> std::result::Result<Robios, String> {
    let outlets = Outlets { report: report_file(), lcd: env::var_os(names::LCD).map(PathBuf::from) };
    Robios::new(link()?, keys()?, outlets).map_err(|error| error.to_string())
}

fn keys() -> std::result::Result<KeyDesk, String> {
    let plan = env::var(names::KEYS).ok().filter(|keys| !keys.is_empty());
    let plan = plan.map(|keys| keys.parse::<KeyPlan>().map_err(|error| format!("{}: {error}", names::KEYS)));
    let keyboard = inherited(names::KEYBOARD)?.map(Keyboard::new).transpose();
    let keyboard = keyboard.map_err(|error| format!("{}: {error}", names::KEYBOARD))?;
    let typed = keyboard.map(|keyboard| Box::new(keyboard) as Box<dyn Typed>);
    Ok(KeyDesk::with_typed(plan.transpose()?.unwrap_or_default(), typed))
}

fn report_file() -> Option<ReportFile> {
    ReportFile::open(&PathBuf::from(env::var_os(names::REPORT)?)).ok()
}

fn refuse() {
    if let Some(file) = report_file() {
        let _ = file.write(&Report { stage: Stage::Refused, ..Report::default() });
    }
}

fn link() -> std::result::Result<Box<dyn Link>, String> {
    match inherited(names::SOCKET)? {
        Some(stream) => Ok(Box::new(Remote::new(stream))),
        None => Ok(Box::new(own_world(&Plan::from_environment()?)?)),
    }
}

/// The socket that whoever started this process has left open, under the number in a variable.
fn inherited(name: &str) -> std::result::Result<Option<UnixStream>, String> {
    let Ok(text) = env::var(name) else { return Ok(None) };
    let number: c_int = text.parse().map_err(|_| format!("{name} is {text:?}; expected a number"))?;
    // SAFETY: only asks whether the number stands for something that is open.
    let open = number > 2 && unsafe { libc::fcntl(number, libc::F_SETFD, libc::FD_CLOEXEC) } == 0;
    if !open {
        return Err(format!("{name} is {number}; expected an open socket"));
    }
    // SAFETY: the descriptor is open, and whoever started the process has left it to this library.
    Ok(Some(unsafe { UnixStream::from_raw_fd(number) }))
}

/// Writes down how the run ended, and ends the program.
fn end(mut state: MutexGuard<'static, State>, stage: Stage) -> ! {
    if let State::Alive(robios) = &mut *state {
        let _ = catch_unwind(AssertUnwindSafe(|| robios.finish(stage)));
    }
    *state = State::Over;
    // SAFETY: writes out what the program has printed, and leaves without the handlers of a program that may be in
    // the middle of anything.
    unsafe {
        libc::fflush(std::ptr::null_mut());
        libc::_exit(ENDED)
    }
}

/// Ends the robot's program. Runs after what the program itself does at its end, since it is registered when the library
/// is loaded, before anything of the program.
#[unsafe(no_mangle)]
extern "C" fn eyesim_end() {
    let Some(_inside) = Inside::new().filter(|_| is_ours()) else { return };
    let mut state = lock();
    if let State::Alive(robios) = &mut *state {
        let _ = catch_unwind(AssertUnwindSafe(|| robios.finish(Stage::Ended)));
    }
    *state = State::Over;
}

/// RoBIOS's code for what has been done or not.
pub(super) fn code(done: Option<()>) -> c_int {
    c_int::from(done.is_none())
}

/// Lets the program wait for so many seconds.
pub(super) fn sleep_for(seconds: f64) -> Option<()> {
    let start = enter(|robios| Ok(robios.now()))?;
    sleep_until(start + seconds)
}

/// Real time between two looks of a thread that sleeps at what other threads do.
const GRACE: Duration = Duration::from_micros(50);

/// When the threads that sleep wake up, in seconds since the start.
static ENDS: Mutex<BTreeMap<u64, f64>> = Mutex::new(BTreeMap::new());
static SLEEPERS: AtomicU64 = AtomicU64::new(0);

/// Looks at them as within a call, so that a signal handler that sleeps meanwhile does not wait for this thread.
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
/// A program with one thread skips the time. Of several threads, one that sleeps lets the world go on by a tick
/// whenever the others have had the opportunity to do something and have not taken it.
fn sleep_until(end: f64) -> Option<()> {
    let (mut sleeper, mut turn) = (Sleeper::new(end), Turn::default());
    loop {
        let (alone, calls) = (alone(), CALLS.load(Ordering::Relaxed));
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
        if CALLS.load(Ordering::Relaxed) != calls {
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

/// How far a program is ahead of the real time since its first call.
fn lead(now: f64) -> Duration {
    static START: OnceLock<f64> = OnceLock::new();
    let real = real_seconds();
    let lead = now - (real - *START.get_or_init(|| real - now));
    Duration::try_from_secs_f64(lead).unwrap_or_default()
}

#[cfg(target_os = "linux")]
fn real_seconds() -> f64 {
    super::clock::real_seconds()
}

#[cfg(not(target_os = "linux"))]
#[allow(clippy::disallowed_methods, reason = "for programs with somebody at the terminal alone")]
fn real_seconds() -> f64 {
    std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default().as_secs_f64()
}

/// Sleeps for a real time.
#[cfg(target_os = "linux")]
pub(super) fn nap(time: Duration) {
    super::clock::real_nap(time);
}

/// Sleeps for a real time.
#[cfg(not(target_os = "linux"))]
pub(super) fn nap(time: Duration) {
    std::thread::sleep(time);
}

/// Whether a call may wait in the world, because the program has nothing else to do meanwhile.
pub(super) fn may_block() -> bool {
    alone() && enter_quietly(|robios| Ok(robios.timers.is_empty())).unwrap_or(true)
}

/// Waits until a question has an answer.
pub(super) fn wait_for<T>(mut ask: impl FnMut(&mut Robios) -> Result<Waiting<T>>) -> Option<T> {
    loop {
        match enter(&mut ask)? {
            Waiting::Pressed(value) => return Some(value),
            Waiting::Until(time) => sleep_until(time)?,
            Waiting::Forever => sleep_for(60.0)?,
        }
    }
}
