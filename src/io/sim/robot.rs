use std::sync::Arc;

use super::engine::Engine;
use super::shared::Shared;
use super::{LONGEST, TICK};
use crate::io::{Error, ErrorKind, Result};

/// A simulated robot for a blocking program: every capability of a full robot, in virtual time.
///
/// A call returns the state of the robot's present tick and takes a little of the robot's own time
/// ([`SimOptions::call_duration`](super::SimOptions::call_duration)).
#[derive(Debug)]
pub struct SimRobot {
    shared: Arc<Shared>,
    index: usize,
    /// The robot's own clock, in nanoseconds.
    clock: u64,
    call_duration: u64,
    time_limit: u64,
}

const NANOSECONDS: f64 = 1e9;
const TICK_NANOSECONDS: u64 = (TICK * NANOSECONDS) as u64;

impl SimRobot {
    pub(super) fn claim(shared: &Arc<Shared>, index: usize) -> Result<Self> {
        shared.claim(index)?;
        let state = shared.lock();
        let options = &state.engine.options;
        Ok(Self {
            index,
            clock: state.engine.tick * TICK_NANOSECONDS,
            call_duration: (options.call_duration * NANOSECONDS).round() as u64,
            time_limit: options.time_limit.map_or(u64::MAX, |limit| (limit * NANOSECONDS).round() as u64),
            shared: Arc::clone(shared),
        })
    }

    /// Asks the engine for something at this robot's time, and charges the call.
    pub(super) fn call<T>(&mut self, ask: impl FnOnce(&mut Engine, usize) -> Result<T>) -> Result<T> {
        if self.clock >= self.time_limit {
            // The world still advances to the limit, so that what is true then can be looked at.
            drop(self.shared.reach(self.index, self.time_limit / TICK_NANOSECONDS)?);
            return Err(time_is_over());
        }
        let mut state = self.shared.reach(self.index, self.clock / TICK_NANOSECONDS)?;
        let answer = ask(&mut state.engine, self.index);
        drop(state);
        self.clock = self.clock.saturating_add(self.call_duration);
        answer
    }

    /// The robot's own clock, in seconds.
    pub(super) fn own_time(&self) -> f64 {
        self.clock as f64 / NANOSECONDS
    }

    pub(super) fn time(&mut self) -> Result<f64> {
        let now = self.own_time();
        self.call(|_, _| Ok(now))
    }

    pub(super) fn pause(&mut self, seconds: f64) -> Result<()> {
        check_duration("waiting time", seconds)?;
        self.clock = self.clock.saturating_add((seconds.max(0.0) * NANOSECONDS).round() as u64);
        self.call(|_, _| Ok(()))
    }

    /// Asks at every tick until there is an answer.
    pub(super) fn poll<T>(
        &mut self,
        mut ask: impl FnMut(&mut Engine, usize) -> Result<Option<T>>,
    ) -> Result<T> {
        loop {
            if let Some(answer) = self.call(&mut ask)? {
                return Ok(answer);
            }
            self.clock = (self.clock / TICK_NANOSECONDS + 1) * TICK_NANOSECONDS;
        }
    }
}

impl Drop for SimRobot {
    fn drop(&mut self) {
        self.shared.release(self.index, self.clock.min(self.time_limit) / TICK_NANOSECONDS);
    }
}

pub(super) fn time_is_over() -> Error {
    Error::new(ErrorKind::TimedOut, "the time limit of the simulation is over")
}

/// Fails unless a program may let so many seconds pass at once.
pub(super) fn check_duration(name: &str, seconds: f64) -> Result<()> {
    if seconds.is_finite() && seconds <= LONGEST {
        return Ok(());
    }
    Err(Error::invalid_input(name, seconds, &format!("a finite number of at most {LONGEST} s")))
}
