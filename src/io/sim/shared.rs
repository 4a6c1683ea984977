use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, ThreadId};

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
    agents: Vec<Agent>,
}

/// A robot's program as the clockwork sees it.
#[derive(Debug, Clone, Default)]
struct Agent {
    phase: Phase,
    /// The tick up to which the program lets the world advance.
    tick: u64,
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
        let running = self.agents.iter().filter(|a| a.phase == Phase::Running).map(|a| a.tick).min();
        let target = running.unwrap_or_else(|| self.agents.iter().map(|a| a.tick).max().unwrap_or(0));
        while self.engine.tick < target {
            self.engine.step();
        }
    }

    /// A robot that holds the world back and that only this thread could move on.
    fn blocked_by_own_thread(&self, index: usize) -> Option<usize> {
        let me = thread::current().id();
        let tick = self.engine.tick;
        self.agents.iter().enumerate().position(|(other, agent)| {
            other != index && agent.phase == Phase::Running && agent.tick == tick && agent.thread == Some(me)
        })
    }
}

impl Shared {
    pub(super) fn new(engine: Engine) -> Self {
        let agents = vec![Agent::default(); engine.bodies.len()];
        Self { state: Mutex::new(State { engine, agents }), advanced: Condvar::new() }
    }

    /// The state as it stands.
    pub(super) fn lock(&self) -> MutexGuard<'_, State> {
        // A panic in a program leaves the engine between two calls, which is a consistent state.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes a robot's program one that the world waits for.
    pub(super) fn claim(&self, index: usize) -> Result<()> {
        let mut state = self.lock();
        let robots = state.agents.len();
        let tick = state.engine.tick;
        let agent = state.agents.get_mut(index).ok_or_else(|| no_robot(index, robots))?;
        if agent.phase == Phase::Running {
            return Err(Error::new(
                ErrorKind::InvalidInput,
                format!("robot {index} is already being driven"),
            ));
        }
        *agent = Agent { phase: Phase::Running, tick, thread: None };
        Ok(())
    }

    /// Waits until the world stands at `tick`, and returns it.
    pub(super) fn reach(&self, index: usize, tick: u64) -> Result<MutexGuard<'_, State>> {
        let mut state = self.lock();
        let alone = state.agents.len() == 1;
        if !alone {
            state.agents[index].thread = Some(thread::current().id());
        }
        if state.engine.tick == tick {
            return Ok(state);
        }
        state.agents[index].tick = tick;
        let before = state.engine.tick;
        state.advance();
        if !alone && state.engine.tick != before {
            self.advanced.notify_all();
        }
        while state.engine.tick < tick {
            if let Some(other) = state.blocked_by_own_thread(index) {
                let message = format!(
                    "robots {index} and {other} are driven from one thread and wait for each other; \
                     give each robot a thread of its own, or use a fleet"
                );
                return Err(Error::new(ErrorKind::Other, message));
            }
            state = self.advanced.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        Ok(state)
    }

    /// Notes that a robot's program has ended at `tick`; the world goes on without it.
    pub(super) fn release(&self, index: usize, tick: u64) {
        let mut state = self.lock();
        state.agents[index].phase = Phase::Ended;
        state.agents[index].tick = tick;
        state.advance();
        self.advanced.notify_all();
    }
}
