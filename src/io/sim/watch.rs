use std::fmt::Debug;

use image::RgbImage;

use super::body::Body;
use super::engine::Engine;
use crate::geometry::{Point, Pose};
use crate::io::{Key, Lcd, LidarScan, Psd, Result};

/// Observes a running world at every tick, for example a window that shows it. It also receives the robots'
/// sensor readings, and may change the world as if by hand; such changes at their ticks are part of the run.
///
/// Watching alone does not change a simulation's run.
///
/// ```
/// use roverlab::geometry::Pose;
/// use roverlab::io::Clock;
/// use roverlab::io::sim::{Onlooking, SimOptions, Simulation, Watcher};
/// use roverlab::world::{RobotSpec, Scene, World};
///
/// /// Moves the robot away after one second.
/// #[derive(Debug)]
/// struct Hand;
///
/// impl Watcher for Hand {
///     fn tick(&mut self, world: &mut Onlooking<'_>) {
///         if world.time() == 1.0 {
///             let _ = world.place_robot(0, Pose::new(1.5, 0.5, 0.0));
///         }
///     }
/// }
///
/// # fn main() -> Result<(), roverlab::io::Error> {
/// let scene = Scene::with_robot(World::walled(2.0, 1.0), RobotSpec::s4(), Pose::new(0.5, 0.5, 0.0));
/// let simulation = Simulation::new(&scene, SimOptions::default())?;
/// simulation.watch(Box::new(Hand));
/// simulation.robot(0)?.wait(2.0)?;
/// assert_eq!(simulation.truth().pose(0)?.x, 1.5);
/// # Ok(())
/// # }
/// ```
///
/// # For implementers
///
/// The simulation waits for `tick`, so keep it short. Its changes depend on the tick alone if runs are
/// to be reproducible.
pub trait Watcher: Debug + Send {
    /// The world at a tick, before anything moves; first at the tick at which watching begins.
    fn tick(&mut self, world: &mut Onlooking<'_>);

    /// A robot's distance reading (m); infinity without a return.
    fn distance(&mut self, _robot: usize, _sensor: Psd, _range: f64) {}

    /// A robot's scan.
    fn scan(&mut self, _robot: usize, _scan: &LidarScan) {}

    /// A robot's image.
    fn image(&mut self, _robot: usize, _image: &RgbImage) {}
}

/// A simulated world, as a [`Watcher`] sees it and may change it. Robots and objects are identified by their
/// indices in the scene.
#[derive(Debug)]
pub struct Onlooking<'e> {
    engine: &'e mut Engine,
}

impl<'e> Onlooking<'e> {
    pub(super) fn new(engine: &'e mut Engine) -> Self {
        Self { engine }
    }

    /// Time since the start (s).
    pub fn time(&self) -> f64 {
        self.engine.time()
    }

    /// Number of robots.
    pub fn robots(&self) -> usize {
        self.engine.bodies.len()
    }

    /// Number of objects.
    pub fn objects(&self) -> usize {
        self.engine.movables.len()
    }

    /// A robot's true pose.
    pub fn pose(&self, robot: usize) -> Option<Pose> {
        self.engine.bodies.get(robot).map(Body::pose)
    }

    /// A robot's odometry pose, in the frame of the odometry.
    pub fn odometry(&self, robot: usize) -> Option<Pose> {
        self.engine.machines.get(robot).map(|machine| machine.drive.get().odometry())
    }

    /// A robot's number of contacts, and the places of the first thousand.
    pub fn contacts(&self, robot: usize) -> Option<(u32, &[Point])> {
        self.engine.bodies.get(robot).map(|body| (body.touch.contacts, body.touch.places.as_slice()))
    }

    /// A robot's display, and the number of its display calls; the display is unchanged while this number is.
    /// `None` before the first call.
    pub fn display(&self, robot: usize) -> Option<(u64, &Lcd)> {
        self.engine.machines.get(robot)?.display()
    }

    /// An object's pose; robots may have pushed it.
    pub fn object(&self, object: usize) -> Option<Pose> {
        let movable = self.engine.movables.get(object)?;
        Some(self.engine.space.solid(movable.solid).pose)
    }

    /// Whether an object has been knocked over.
    pub fn has_fallen(&self, object: usize) -> bool {
        self.engine.movables.get(object).is_some_and(|movable| {
            let solid = self.engine.space.solid(movable.solid);
            solid.top <= solid.bottom
        })
    }

    /// Places a robot at a pose without a change of its odometry. Fails without such a robot or for an
    /// invalid pose.
    pub fn place_robot(&mut self, robot: usize, pose: Pose) -> Result<()> {
        self.engine.body(robot)?;
        super::truth::require_finite_pose(pose)?;
        self.engine.place(robot, pose, 0.0);
        Ok(())
    }

    /// Places an object at a pose. Fails without such an object or for an invalid pose.
    pub fn place_object(&mut self, object: usize, pose: Pose) -> Result<()> {
        self.engine.check_object(object)?;
        super::truth::require_finite_pose(pose)?;
        self.engine.place_object(object, pose);
        Ok(())
    }

    /// Presses a soft key of a robot now. Fails without such a robot.
    pub fn press_key(&mut self, robot: usize, key: Key) -> Result<()> {
        let now = self.time();
        self.engine.press_key(robot, now, key)
    }
}
