use std::sync::Arc;

use super::engine::Engine;
use super::lockstep::{Lockstep, Program};
use crate::io::Result;

/// A simulated robot for a blocking program: every capability of a full robot, in virtual time.
///
/// A call returns the state at the robot's present tick and takes a little of the robot's own time
/// ([`SimOptions::call_duration`](super::SimOptions::call_duration)).
#[derive(Debug)]
pub struct SimRobot {
    program: Program<Engine>,
}

impl SimRobot {
    pub(super) fn claim(shared: &Arc<Lockstep<Engine>>, index: usize) -> Result<Self> {
        let (call, limit) = {
            let options = &shared.lock().world.options;
            (options.call_duration, options.time_limit)
        };
        Ok(Self { program: Program::claim(shared, index, call, limit)? })
    }

    /// Makes a request at this robot's time and charges its duration.
    pub(super) fn call<T>(&mut self, ask: impl FnOnce(&mut Engine, usize) -> Result<T>) -> Result<T> {
        self.program.call(ask)
    }

    /// The robot's own clock (s).
    pub(super) fn own_time(&self) -> f64 {
        self.program.time()
    }

    pub(super) fn time(&mut self) -> Result<f64> {
        let now = self.own_time();
        self.call(|_, _| Ok(now))
    }

    pub(super) fn pause(&mut self, seconds: f64) -> Result<()> {
        self.program.pass(seconds)?;
        self.call(|_, _| Ok(()))
    }

    /// Repeats a request at every tick until it has an answer.
    pub(super) fn poll<T>(&mut self, ask: impl FnMut(&mut Engine, usize) -> Result<Option<T>>) -> Result<T> {
        self.program.poll(ask)
    }
}
