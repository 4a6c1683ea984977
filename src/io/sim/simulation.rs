use std::sync::Arc;

use super::engine::Engine;
use super::lockstep::Lockstep;
use super::{SimOptions, SimRobot, TICK, Truth, Watcher};
use crate::io::{Key, Result};
use crate::world::Scene;

/// A simulated world whose robots are driven by ordinary blocking programs.
///
/// One robot needs no thread. Several robots need a thread each. Take all of them with
/// [`robot`](Simulation::robot) before the first one drives, because the world waits only for the robots that
/// are taken. A robot that nobody takes stands still; one whose handle is dropped keeps its last command.
///
/// Neither threads nor load affect what a program sees, within one bound of real time: while the world stands
/// still because one robot's program lets no time pass, the calls of the others wait for at most
/// [`SimOptions::patience`], and then fail with an error that names that robot, instead of blocking for ever.
#[derive(Debug, Clone)]
pub struct Simulation {
    shared: Arc<Lockstep<Engine>>,
}

impl Simulation {
    /// A simulation of a scene. Fails for invalid options, an invalid description of a robot, or a drive that
    /// is not simulated.
    pub fn new(scene: &Scene, options: SimOptions) -> Result<Self> {
        let patience = options.patience;
        let engine = Engine::new(scene, options)?;
        let robots = engine.bodies.len();
        Ok(Self { shared: Arc::new(Lockstep::new(engine, TICK, robots, patience)) })
    }

    /// Takes a robot by its index in the scene. Fails if it does not exist or is already taken.
    pub fn robot(&self, index: usize) -> Result<SimRobot> {
        SimRobot::claim(&self.shared, index)
    }

    /// Ground truth of the world, for verdicts, pictures and tests.
    pub fn truth(&self) -> Truth {
        Truth::new(Arc::clone(&self.shared))
    }

    /// Adds a watcher from now on.
    pub fn watch(&self, watcher: Box<dyn Watcher>) {
        self.shared.lock().world.watch(watcher);
    }

    /// Schedules a key press on a robot, in seconds since the start; a past time means at once.
    pub fn press_key(&self, robot: usize, time: f64, key: Key) -> Result<()> {
        self.shared.lock().world.press_key(robot, time, key)
    }
}
