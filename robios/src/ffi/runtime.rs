//! The single robot of a process: start, lock and end.

use std::env;
use std::ffi::c_int;
use std::os::fd::FromRawFd;
use std::os::unix::net::UnixStream;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, TryLockError};
use std::time::Duration;

use roverlab::io::{ErrorKind, Result};

use crate::keyboard::Keyboard;
use crate::keys::{KeyDesk, KeyPlan, Typed};
use crate::link::{Link, own_world};
use crate::memory::Memory;
use crate::plan::{Plan, names};
use crate::remote::Remote;
use crate::report::{Report, ReportFile, Stage};
use crate::robios::{Callback, Outlets, Robios};
use crate::showing::Showing;

use super::computing;
use super::globals::publish_points;
use super::real_time::{nap, real_seconds};
use super::sleep::{let_earlier_run, wait_for_frame};
use super::threads::{Inside, be_present, count_call, is_ours, own};
use super::watch::{self, Unasked};

#[derive(Debug)]
enum State {
    /// No RoBIOS function has been called.
    Unborn,
    Alive(Box<Robios>),
    /// The run is over, or could not start.
    Over,
}

static STATE: Mutex<State> = Mutex::new(State::Unborn);
/// Whether a timer function is running.
static IN_TIMER: AtomicBool = AtomicBool::new(false);

/// Exit status of a program ended by the library.
const ENDED: c_int = 124;

/// Calls the robot. `None` if there is none, or if the call fails. Ends the program at its time limit. The
/// call's name determines its cost and appears in the report.
///
/// Where there are several threads, a query's thread waits for its frame first, and a thread whose calls have
/// taken some time lets others run that are due earlier.
pub(super) fn enter<T>(name: &'static str, call: impl FnOnce(&mut Robios) -> Result<T>) -> Option<T> {
    count_call();
    let frame = wait_for_frame(name);
    let answer = enter_as(name, |robios| {
        robios.use_reserved(frame);
        call(robios)
    });
    let_earlier_run();
    answer
}

/// Like [`enter`], for a call that begins a wait.
pub(super) fn enter_to_wait<T>(name: &'static str, call: impl FnOnce(&mut Robios) -> Result<T>) -> Option<T> {
    count_call();
    enter_as(name, call)
}

/// Like [`enter`], for sleeping threads.
pub(super) fn enter_quietly<T>(call: impl FnOnce(&mut Robios) -> Result<T>) -> Option<T> {
    enter_as("", call)
}

fn enter_as<T>(name: &'static str, call: impl FnOnce(&mut Robios) -> Result<T>) -> Option<T> {
    if !is_ours() {
        if let Some(memory) = memory() {
            memory.note_fork();
        }
        return None;
    }
    let inside = Inside::new()?;
    be_present();
    let mut state = lock();
    if let State::Unborn = *state {
        *state = born();
    }
    serve(state, inside, name, call)
}

/// Calls the robot with the lock held, then the due timer functions without it.
fn serve<T>(
    mut state: MutexGuard<'static, State>,
    inside: Inside,
    name: &'static str,
    call: impl FnOnce(&mut Robios) -> Result<T>,
) -> Option<T> {
    let State::Alive(robios) = &mut *state else { return None };
    // A panic would be a bug of this library. Each step leaves the robot consistent.
    let answer = catch_unwind(AssertUnwindSafe(|| {
        robios.begin(name);
        if let Some(computed) = computing::so_far() {
            robios.charge_computing(computed);
        }
        call(robios)
    }));
    let answer = answer.ok();
    if let Some(Err(error)) = &answer
        && !matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::Disconnected)
    {
        robios.note(&error.to_string());
    }
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
    computing::begin();
    if !ahead.is_zero() {
        nap(ahead);
    }
    answer.and_then(Result::ok)
}

/// Returns the timer's handle, or 0.
#[unsafe(no_mangle)]
extern "C" fn OSAttachTimer(scale: c_int, function: Option<Callback>) -> c_int {
    let timer = function
        .and_then(|function| enter("OSAttachTimer", |robios| robios.os_attach_timer(scale, function)));
    if timer.is_some() {
        watch_program();
    }
    timer.unwrap_or(0)
}

/// The program's time (s), without a call: no timer function runs, as the program may hold a lock.
pub(super) fn peek_time() -> Option<f64> {
    let _inside = Inside::new().filter(|_| is_ours())?;
    match &mut *lock() {
        State::Alive(robios) => Some(robios.now()),
        State::Unborn | State::Over => None,
    }
}

/// From now on, lets time pass while the program makes no calls.
pub(super) fn watch_program() {
    let patience = env::var(names::SHARED).ok().and_then(|seconds| seconds.parse().ok());
    watch::start(pass_unasked, patience);
}

/// Lets time pass without a call: `with_timers` seconds to the next due timer, or `without` seconds, or if
/// they are unknown just until all commands have reached the world.
fn pass_unasked(with_timers: f64, without: Option<f64>) -> Unasked {
    let Some(inside) = Inside::new().filter(|_| is_ours()) else { return Unasked::Over };
    let state = match STATE.try_lock() {
        Ok(state) => state,
        Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
        Err(TryLockError::WouldBlock) => return Unasked::Busy,
    };
    if !matches!(*state, State::Alive(_)) {
        return Unasked::Over;
    }
    serve(state, inside, "", |robios| match robios.timers.next() {
        Some(due) => {
            let rest = due - robios.now();
            robios.pass(rest.min(with_timers))
        }
        None => match without {
            None => robios.deliver_all(),
            Some(0.0) => Ok(()),
            Some(time) => robios.pass(time),
        },
    });
    Unasked::Passed
}

fn lock() -> MutexGuard<'static, State> {
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Creates the robot described by the environment.
fn born() -> State {
    own();
    match catch_unwind(robot) {
        Ok(Ok(robios)) => {
            publish_points(robios.lidar_points());
            watch_program();
            State::Alive(Box::new(robios))
        }
        Ok(Err(message)) => {
            eprintln!("libeyesim: {message}");
            refuse(message);
            State::Over
        }
        Err(_) => State::Over,
    }
}

fn robot() -> std::result::Result<Robios, String> {
    let report = memory().map(|memory| ReportFile::new(Arc::clone(memory)));
    let showing = inherited(names::SCREEN)?.map(Showing::through);
    let outlets = Outlets { report, lcd: env::var_os(names::LCD).map(PathBuf::from), showing };
    let plan = Plan::from_environment()?;
    computing::set_factor(plan.cpu_time);
    Robios::new(link(&plan)?, keys()?, plan.costs.clone(), outlets).map_err(|error| error.to_string())
}

fn keys() -> std::result::Result<KeyDesk, String> {
    let plan = env::var(names::KEYS).ok().filter(|keys| !keys.is_empty());
    let plan = plan.map(|keys| keys.parse::<KeyPlan>().map_err(|error| format!("{}: {error}", names::KEYS)));
    let keyboard = inherited(names::KEYBOARD)?.map(Keyboard::new).transpose();
    let keyboard = keyboard.map_err(|error| format!("{}: {error}", names::KEYBOARD))?;
    let typed = keyboard.map(|keyboard| Box::new(keyboard) as Box<dyn Typed>);
    Ok(KeyDesk::with_typed(plan.transpose()?.unwrap_or_default(), typed))
}

/// Memory shared with the runner, if the runner started this process.
fn memory() -> Option<&'static Arc<Memory>> {
    static MEMORY: OnceLock<Option<Arc<Memory>>> = OnceLock::new();
    let found = MEMORY.get_or_init(|| {
        let number = env::var(names::MEMORY).ok()?.parse().ok()?;
        Memory::inherit(number).ok().map(Arc::new)
    });
    found.as_ref()
}

/// Runs when the library is loaded; files that the program closes later are no longer needed.
#[unsafe(no_mangle)]
extern "C" fn eyesim_begin() {
    if memory().is_some() {
        #[cfg(target_os = "linux")]
        super::clock::note_runner();
    }
}

fn refuse(message: String) {
    if let Some(memory) = memory() {
        let file = ReportFile::new(Arc::clone(memory));
        file.write(&Report { stage: Stage::Refused, ..Report::default() });
        file.write_notes(&[message]);
    }
}

fn link(plan: &Plan) -> std::result::Result<Box<dyn Link>, String> {
    if env::var_os(names::SHARED).is_none() {
        return Ok(Box::new(own_world(plan)?));
    }
    let memory =
        memory().ok_or("the memory of the runner is not there; expected a program that it has started")?;
    Ok(Box::new(Remote::new(Arc::clone(memory))))
}

/// The socket left open by the parent process, with its number in a variable.
fn inherited(name: &str) -> std::result::Result<Option<UnixStream>, String> {
    let Ok(text) = env::var(name) else { return Ok(None) };
    let number: c_int = text.parse().map_err(|_| format!("{name} is {text:?}; expected a number"))?;
    // SAFETY: only tests whether the descriptor is open.
    let open = number > 2 && unsafe { libc::fcntl(number, libc::F_SETFD, libc::FD_CLOEXEC) } == 0;
    if !open {
        return Err(format!("{name} is {number}; expected an open socket"));
    }
    // SAFETY: the descriptor is open and was left to this library by the parent process.
    Ok(Some(unsafe { UnixStream::from_raw_fd(number) }))
}

/// Writes the report and ends the program.
fn end(mut state: MutexGuard<'static, State>, stage: Stage) -> ! {
    if let State::Alive(robios) = &mut *state {
        let _ = catch_unwind(AssertUnwindSafe(|| robios.finish(stage)));
    }
    *state = State::Over;
    // SAFETY: flushes the program's output and exits without its handlers, as the program may be interrupted
    // anywhere.
    unsafe {
        libc::fflush(std::ptr::null_mut());
        libc::_exit(ENDED)
    }
}

/// Ends the robot's run. Registered when the library is loaded, before anything of the program, so it runs
/// after the program's own exit handlers.
#[unsafe(no_mangle)]
extern "C" fn eyesim_end() {
    let Some(_inside) = Inside::new().filter(|_| is_ours()) else { return };
    let mut state = lock();
    if let State::Alive(robios) = &mut *state {
        let _ = catch_unwind(AssertUnwindSafe(|| robios.finish(Stage::Ended)));
    }
    *state = State::Over;
}

/// Lead of the program's time over real time since its first call.
fn lead(now: f64) -> Duration {
    static START: OnceLock<f64> = OnceLock::new();
    let real = real_seconds();
    let lead = now - (real - *START.get_or_init(|| real - now));
    Duration::try_from_secs_f64(lead).unwrap_or_default()
}

/// RoBIOS's return code for success or failure.
pub(super) fn code(done: Option<()>) -> c_int {
    c_int::from(done.is_none())
}
