//! Scenes, and short ways to say what several tests say.

use roverlab::geometry::{Pose, units};
use roverlab::io::sim::{SimOptions, SimRobot, Simulation, Truth};
use roverlab::world::{RobotSpec, Scene, World};

use crate::scenes::with_robots;

/// An S4's encoder tick on the floor, in metres.
pub(crate) const ENCODER_TICK: f64 = std::f64::consts::PI * 0.054 / 1100.0;

/// One robot in a simulation, and what is true about it.
pub(crate) fn start(scene: &Scene, options: SimOptions) -> (SimRobot, Truth) {
    let simulation = Simulation::new(scene, options).unwrap();
    (simulation.robot(0).unwrap(), simulation.truth())
}

/// An S4 on an empty floor.
pub(crate) fn open_floor(pose: Pose) -> Scene {
    Scene::with_robot(World::empty(10.0, 10.0), RobotSpec::s4(), pose)
}

/// Several S4s in a world.
pub(crate) fn robots(world: World, poses: &[Pose]) -> Scene {
    with_robots(world, &RobotSpec::s4(), poses)
}

/// The difference of two directions in degrees, never negative.
pub(crate) fn degrees_between(a: f64, b: f64) -> f64 {
    units::to_deg(roverlab::geometry::angle_difference(a, b).abs())
}
