//! The one robot of a process: its beginning, its lock, its end, and how its program waits.

use std::cell::Cell;
use std::env;
use std::ffi::c_int;
use std::os::fd::FromRawFd;
use std::os::unix::net::UnixStream;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicI32, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use roverlab::io::sim::TICK;
use roverlab::io::{ErrorKind, Result};

use crate::keys::{KeyPlan, Waiting};
use crate::link::{Link, Remote, own_world};
use crate::plan::{Plan, names};
use crate::report::{Report, ReportFile, Stage};
use crate::robios::{Outlets, Robios};

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
        free.then_some(Self)
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
    STARTED_THREADS.store(true, Ordering::Relaxed);
}

fn alone() -> bool {
    !STARTED_THREADS.load(Ordering::Relaxed) && THREADS.load(Ordering::Relaxed) <= 1
}

/// Calls the robot. `None` if there is none, or if it cannot do what is asked. Ends the program when its time is over.
pub(super) fn enter<T>(call: impl FnOnce(&mut Robios) -> Result<T>) -> Option<T> {
    CALLS.fetch_add(1, Ordering::Relaxed);
    enter_quietly(call)
}

/// As [`enter`], for threads that sleep.
fn enter_quietly<T>(call: impl FnOnce(&mut Robios) -> Result<T>) -> Option<T> {
    if !is_ours() {
        return None;
    }
    let inside = Inside::new()?;
    let _ = PRESENT.try_with(|_| ());
    let mut state = lock();
    if let State::Unborn = *state {
        *state = born();
    }
    let State::Alive(robios) = &mut *state else { return None };
    // A panic would be a mistake of this library. The robot is as consistent after it as before each step.
    let answer = catch_unwind(AssertUnwindSafe(|| call(robios))).ok();
    robios.publish();
    if let Some(Err(error)) = &answer {
        match error.kind() {
            ErrorKind::TimedOut => end(state, Stage::TimedOut),
            ErrorKind::Disconnected => end(state, Stage::Disconnected),
            _ => {}
        }
    } else if !robios.timers.is_empty() && !IN_TIMER.load(Ordering::Relaxed) {
        let now = robios.now();
        let due = robios.timers.due(now);
        drop(state);
        drop(inside);
        IN_TIMER.store(true, Ordering::Relaxed);
        for function in due {
            function();
        }
        IN_TIMER.store(false, Ordering::Relaxed);
    }
    answer.and_then(Result::ok)
}

fn lock() -> MutexGuard<'static, State> {
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The robot that the environment describes.
fn born() -> State {
    OWNER.store(process(), Ordering::Release);
    match catch_unwind(robot) {
        Ok(Ok(robios)) => {
            // SAFETY: the function lives as long as the library, which is never unloaded before the handlers run.
            unsafe { libc::atexit(at_exit) };
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
    let keys = env::var(names::KEYS).ok().filter(|keys| !keys.is_empty());
    let keys = keys.map(|keys| keys.parse::<KeyPlan>().map_err(|error| format!("{}: {error}", names::KEYS)));
    let outlets = Outlets { report: report_file(), lcd: env::var_os(names::LCD).map(PathBuf::from) };
    Robios::new(link()?, keys.transpose()?.unwrap_or_default(), outlets).map_err(|error| error.to_string())
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
    let Ok(socket) = env::var(names::SOCKET) else {
        return Ok(Box::new(own_world(&Plan::from_environment()?)?));
    };
    let number: c_int =
        socket.parse().map_err(|_| format!("{} is {socket:?}; expected a number", names::SOCKET))?;
    // SAFETY: only asks whether the number stands for something that is open.
    let open = number > 2 && unsafe { libc::fcntl(number, libc::F_SETFD, libc::FD_CLOEXEC) } == 0;
    if !open {
        return Err(format!("{} is {number}; expected an open socket", names::SOCKET));
    }
    // SAFETY: the descriptor is open, and whoever started the process has left it to this library.
    Ok(Box::new(Remote::new(unsafe { UnixStream::from_raw_fd(number) })))
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

extern "C" fn at_exit() {
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

/// Real microseconds that other threads get to do something before a thread that sleeps lets time pass.
const GRACE: i64 = 50;

/// Lets the program wait until a time, in seconds since the start. Timers' functions are called in between.
///
/// A program with one thread skips the time. Of several threads, one that sleeps lets the world go on by a tick
/// whenever the others have had the opportunity to do something and have not taken it.
fn sleep_until(end: f64) -> Option<()> {
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
        nap();
        if CALLS.load(Ordering::Relaxed) == calls {
            enter_quietly(|robios| {
                let rest = end - robios.now();
                if rest > 0.0 { robios.pass(rest.min(TICK)) } else { Ok(()) }
            })?;
        }
    }
}

#[cfg(target_os = "linux")]
fn nap() {
    super::clock::real_nap(GRACE * 1000);
}

#[cfg(not(target_os = "linux"))]
fn nap() {
    std::thread::sleep(std::time::Duration::from_micros(GRACE as u64));
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
