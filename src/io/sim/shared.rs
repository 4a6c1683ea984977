use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, ThreadId};
use std::time::Duration;

use super::engine::{Engine, no_robot};
use crate::io::{Error, ErrorKind, Result};

/// An engine that several robots' programs share in lockstep.
///
/// The world stands at tick `n` until every program that still runs has asked for something at tick `n + 1` or
/// later; then whoever asked last advances it. What a robot reads at a tick therefore depends on ticks alone, never
/// on how threads are scheduled.
#[derive(Debug)]
pub(super) struct Shared {
    state: Mutex<State>,
    advanced: Condvar,
}

#[derive(Debug)]
pub(super) struct State {
    pub(super) engine: Engine,
    programs: Vec<Program>,
}

/// A robot's program as the clockwork sees it.
#[derive(Debug, Clone, Default)]
struct Program {
    phase: Phase,
    /// The tick up to which the program lets the world advance.
    tick: u64,
    /// The thread that used the robot last, or took it.
    thread: Option<ThreadId>,
    /// Whether the robot has been used since it was taken.
    used: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Phase {
    /// Nobody drives the robot; the world does not wait for it.
    #[default]
    Unclaimed,
    Running,
    Ended,
}

impl State {
    /// Advances the world as far as every running program allows.
    fn advance(&mut self) {
        let running = self.programs.iter().filter(|p| p.phase == Phase::Running).map(|p| p.tick).min();
        let target = running.unwrap_or_else(|| self.programs.iter().map(|p| p.tick).max().unwrap_or(0));
        while self.engine.tick < target {
            self.engine.step();
        }
    }

    /// A robot that holds the world back, and that this thread was the last one to use or to take.
    fn blocked_by_own_thread(&self, index: usize) -> Option<usize> {
        let me = thread::current().id();
        let tick = self.engine.tick;
        self.programs.iter().enumerate().position(|(other, program)| {
            other != index
                && program.phase == Phase::Running
                && program.tick == tick
                && program.thread == Some(me)
        })
    }
}

/// How long a robot that was taken is waited for, in real time, by the thread that took it: a robot that no other thread
/// uses until then has been left behind in this one.
const FIRST_CALL: Duration = Duration::from_secs(5);

fn driven_from_one_thread(index: usize, other: usize) -> Error {
    let message = format!(
        "robots {index} and {other} are driven from one thread and wait for each other; \
         give each robot a thread of its own, or use a fleet"
    );
    Error::new(ErrorKind::Other, message)
}

impl Shared {
    pub(super) fn new(engine: Engine) -> Self {
        let programs = vec![Program::default(); engine.bodies.len()];
        Self { state: Mutex::new(State { engine, programs }), advanced: Condvar::new() }
    }

    /// The state as it stands.
    pub(super) fn lock(&self) -> MutexGuard<'_, State> {
        // A panic in a program leaves the engine between two calls, which is a consistent state.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes a robot's program one that the world waits for.
    pub(super) fn claim(&self, index: usize) -> Result<()> {
        let mut state = self.lock();
        let robots = state.programs.len();
        let tick = state.engine.tick;
        let program = state.programs.get_mut(index).ok_or_else(|| no_robot(index, robots))?;
        if program.phase == Phase::Running {
            return Err(Error::new(
                ErrorKind::InvalidInput,
                format!("robot {index} is already being driven"),
            ));
        }
        *program = Program { phase: Phase::Running, tick, thread: Some(thread::current().id()), used: false };
        Ok(())
    }

    /// Waits until the world stands at `tick`, and returns it.
    pub(super) fn reach(&self, index: usize, tick: u64) -> Result<MutexGuard<'_, State>> {
        let mut state = self.lock();
        let alone = state.programs.len() == 1;
        if !alone {
            state.programs[index].thread = Some(thread::current().id());
            state.programs[index].used = true;
        }
        if state.engine.tick == tick {
            return Ok(state);
        }
        state.programs[index].tick = tick;
        let before = state.engine.tick;
        state.advance();
        if !alone && state.engine.tick != before {
            self.advanced.notify_all();
        }
        while state.engine.tick < tick {
            let Some(other) = state.blocked_by_own_thread(index) else {
                state = self.advanced.wait(state).unwrap_or_else(PoisonError::into_inner);
                continue;
            };
            if state.programs[other].used {
                return Err(driven_from_one_thread(index, other));
            }
            // Another thread may have been given the robot, and be about to use it.
            let before = state.engine.tick;
            let (woken, waited) =
                self.advanced.wait_timeout(state, FIRST_CALL).unwrap_or_else(PoisonError::into_inner);
            state = woken;
            if waited.timed_out() && state.engine.tick == before && !state.programs[other].used {
                return Err(driven_from_one_thread(index, other));
            }
        }
        Ok(state)
    }

    /// Notes that a robot's program has ended at `tick`; the world goes on without it.
    pub(super) fn release(&self, index: usize, tick: u64) {
        let mut state = self.lock();
        state.programs[index].phase = Phase::Ended;
        state.programs[index].tick = tick;
        state.advance();
        self.advanced.notify_all();
    }
}
