use super::Result;
use crate::geometry::{Point, Pose};

/// Ground truth of a world: a simulator, or the recording of one.
pub trait GroundTruth {
    /// Time since the start of the world (s).
    fn time(&mut self) -> Result<f64>;

    /// True pose of a robot in the world.
    fn pose(&mut self, robot: usize) -> Result<Pose>;

    /// Ground truth of a robot.
    fn robot(&mut self, robot: usize) -> Result<RobotTruth>;

    /// Pose of an object in the world, by its index in the scene: robots may have pushed it.
    fn object(&mut self, object: usize) -> Result<Pose>;
}

impl<T: GroundTruth + ?Sized> GroundTruth for Box<T> {
    fn time(&mut self) -> Result<f64> {
        (**self).time()
    }

    fn pose(&mut self, robot: usize) -> Result<Pose> {
        (**self).pose(robot)
    }

    fn robot(&mut self, robot: usize) -> Result<RobotTruth> {
        (**self).robot(robot)
    }

    fn object(&mut self, object: usize) -> Result<Pose> {
        (**self).object(object)
    }
}

/// Ground truth of one robot.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotTruth {
    /// Pose in the world.
    pub pose: Pose,
    /// Pose by odometry, relative to the start.
    pub odometry: Pose,
    /// Number of contacts with walls, objects or robots.
    pub contacts: u32,
    /// Position of the start of each contact; the first 1,000 at most.
    pub contact_places: Vec<Point>,
    /// Distance travelled by its centre (m).
    pub path_length: f64,
    /// Trajectory, if the options ask for a trail.
    pub trail: Vec<TrailPoint>,
}

/// A robot's true pose and its odometry at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrailPoint {
    /// Time since the start (s).
    pub time: f64,
    /// True pose in the world.
    pub pose: Pose,
    /// Pose by odometry, in its own frame.
    pub odometry: Pose,
}
