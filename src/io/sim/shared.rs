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
    /// The thread that used the robot last; none has since it was taken.
    thread: Option<ThreadId>,
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

    /// A robot that holds the world back and may have been left behind: this thread was the last one to use
    /// it, or none has used it.
    fn held_back_by(&self, index: usize) -> Option<usize> {
        let me = thread::current().id();
        let tick = self.engine.tick;
        self.programs.iter().enumerate().position(|(other, program)| {
            other != index
                && program.phase == Phase::Running
                && program.tick == tick
                && program.thread.is_none_or(|thread| thread == me)
        })
    }
}

/// The real time in which another thread must have begun to use a robot that holds the world back.
const PATIENCE: Duration = Duration::from_secs(10);

fn held_back(index: usize, other: usize) -> Error {
    let message = format!(
        "robot {index} waits for robot {other}, which no other thread has used for {} s of real time; \
         give each robot a thread of its own, or use a fleet",
        PATIENCE.as_secs()
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
        *program = Program { phase: Phase::Running, tick, thread: None };
        Ok(())
    }

    /// Waits until the world stands at `tick`, and returns it.
    pub(super) fn reach(&self, index: usize, tick: u64) -> Result<MutexGuard<'_, State>> {
        let mut state = self.lock();
        let alone = state.programs.len() == 1;
        if !alone {
            state.programs[index].thread = Some(thread::current().id());
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
            let Some(other) = state.held_back_by(index) else {
                state = self.advanced.wait(state).unwrap_or_else(PoisonError::into_inner);
                continue;
            };
            let before = state.engine.tick;
            let (woken, waited) =
                self.advanced.wait_timeout(state, PATIENCE).unwrap_or_else(PoisonError::into_inner);
            state = woken;
            let still = state.engine.tick == before && state.held_back_by(index) == Some(other);
            if waited.timed_out() && still {
                return Err(held_back(index, other));
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
