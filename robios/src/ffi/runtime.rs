//! The one robot of a process: its beginning, its lock and its end.

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
use crate::link::{Link, Remote, own_world};
use crate::memory::Memory;
use crate::plan::{Plan, names};
use crate::report::{Report, ReportFile, Stage};
use crate::robios::{Outlets, Robios};

use super::computing;
use super::globals::publish_points;
use super::real_time::{nap, real_seconds};
use super::threads::{Inside, be_present, count_call, is_ours, own};
use super::watch::{self, Unasked};

#[derive(Debug)]
enum State {
    /// No function has been called.
    Unborn,
    Alive(Box<Robios>),
    /// The run is over, or never began.
    Over,
}

static STATE: Mutex<State> = Mutex::new(State::Unborn);
/// Whether a timer's function is being called.
static IN_TIMER: AtomicBool = AtomicBool::new(false);

/// The exit status of a program that the library ends.
const ENDED: c_int = 124;

/// Calls the robot. `None` if there is none, or if it cannot do what is asked. Ends the program when its time is over.
/// The call's name says what it takes, and stands in the report.
pub(super) fn enter<T>(name: &'static str, call: impl FnOnce(&mut Robios) -> Result<T>) -> Option<T> {
    count_call();
    enter_as(name, call)
}

/// As [`enter`], for threads that sleep.
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

/// Calls the robot behind the lock, and what is due of the timers' functions without it.
fn serve<T>(
    mut state: MutexGuard<'static, State>,
    inside: Inside,
    name: &'static str,
    call: impl FnOnce(&mut Robios) -> Result<T>,
) -> Option<T> {
    let State::Alive(robios) = &mut *state else { return None };
    // A panic would be a mistake of this library. The robot is as consistent after it as before each step.
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

/// Lets time pass, from now on, while the program calls nothing.
pub(super) fn watch_program() {
    watch::start(pass_unasked, env::var_os(names::SHARED).is_some());
}

/// Lets time pass that nobody has asked for: so many seconds to where the next timer is due, or without timers.
fn pass_unasked(with_timers: f64, without: f64) -> Unasked {
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
    own();
    match catch_unwind(robot) {
        Ok(Ok(robios)) => {
            publish_points(robios.lidar_points());
            watch_program();
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
    let report = memory().map(|memory| ReportFile::new(Arc::clone(memory)));
    let outlets = Outlets { report, lcd: env::var_os(names::LCD).map(PathBuf::from) };
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

/// What is shared with the runner that has started this process, if one has.
fn memory() -> Option<&'static Arc<Memory>> {
    static MEMORY: OnceLock<Option<Arc<Memory>>> = OnceLock::new();
    let found = MEMORY.get_or_init(|| {
        let number = env::var(names::MEMORY).ok()?.parse().ok()?;
        Memory::inherit(number).ok().map(Arc::new)
    });
    found.as_ref()
}

/// Runs when the library is loaded: from then on, nothing that the program closes is needed.
#[unsafe(no_mangle)]
extern "C" fn eyesim_begin() {
    if memory().is_some() {
        #[cfg(target_os = "linux")]
        super::clock::note_runner();
    }
}

fn refuse() {
    if let Some(memory) = memory() {
        ReportFile::new(Arc::clone(memory)).write(&Report { stage: Stage::Refused, ..Report::default() });
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

/// How far a program is ahead of the real time since its first call.
fn lead(now: f64) -> Duration {
    static START: OnceLock<f64> = OnceLock::new();
    let real = real_seconds();
    let lead = now - (real - *START.get_or_init(|| real - now));
    Duration::try_from_secs_f64(lead).unwrap_or_default()
}

/// RoBIOS's code for what has been done or not.
pub(super) fn code(done: Option<()>) -> c_int {
    c_int::from(done.is_none())
}
