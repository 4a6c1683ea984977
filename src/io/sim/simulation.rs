use std::sync::Arc;

use super::engine::Engine;
use super::lockstep::Lockstep;
use super::{SimOptions, SimRobot, TICK, Truth, Watcher};
use crate::io::{Key, Result};
use crate::world::Scene;

/// A simulated world whose robots are driven by ordinary blocking programs.
///
/// One robot needs no thread. Of several, each gets a thread of its own; take all of them with
/// [`robot`](Simulation::robot) before the first one drives, because the world waits for those that are taken, from
/// the start. A robot that nobody takes stands still; one whose handle is dropped keeps its last command. A thread
/// that waits ten seconds of real time for a robot that no other thread uses gets an error instead of waiting
/// for ever, as with two robots in one thread. A program that computes longer than that before it drives
/// calls [`now`](crate::io::Clock::now) first.
#[derive(Debug, Clone)]
pub struct Simulation {
    shared: Arc<Lockstep<Engine>>,
}

impl Simulation {
    /// A simulation of a scene. Fails when an option or a robot's description makes no sense, or a robot has a
    /// drive that is not simulated.
    pub fn new(scene: &Scene, options: SimOptions) -> Result<Self> {
        let engine = Engine::new(scene, options)?;
        let robots = engine.bodies.len();
        Ok(Self { shared: Arc::new(Lockstep::new(engine, TICK, robots)) })
    }

    /// Takes a robot, by its index in the scene. Fails when there is none, or somebody has it.
    pub fn robot(&self, index: usize) -> Result<SimRobot> {
        SimRobot::claim(&self.shared, index)
    }

    /// What is true in the world, for verdicts, pictures and tests.
    pub fn truth(&self) -> Truth {
        Truth::new(Arc::clone(&self.shared))
    }

    /// Lets somebody look on, from now on.
    pub fn watch(&self, watcher: Box<dyn Watcher>) {
        self.shared.lock().world.watch(watcher);
    }

    /// Schedules a key press on a robot, in seconds since the start. One whose time has passed is due at once.
    pub fn press_key(&self, robot: usize, time: f64, key: Key) -> Result<()> {
        self.shared.lock().world.press_key(robot, time, key)
    }
}
