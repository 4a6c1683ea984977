use super::Result;
use crate::geometry::{Point, Pose, Pose3};

/// Who knows what is true in a world: a simulator, or the recording of what one said.
pub trait GroundTruth {
    /// Seconds since the start of the world.
    fn time(&mut self) -> Result<f64>;

    /// A robot's pose in the world.
    fn pose(&mut self, robot: usize) -> Result<Pose>;

    /// A robot's pose in space, with elevation, roll and pitch. Who knows a level floor alone has it level there.
    fn pose_in_space(&mut self, robot: usize) -> Result<Pose3> {
        Ok(Pose3::level(self.pose(robot)?, 0.0))
    }

    /// All that is true about a robot.
    fn robot(&mut self, robot: usize) -> Result<RobotTruth>;

    /// An object's pose in the world, by its index in the scene: robots may have pushed it.
    fn object(&mut self, object: usize) -> Result<Pose>;
}

impl<T: GroundTruth + ?Sized> GroundTruth for Box<T> {
    fn time(&mut self) -> Result<f64> {
        (**self).time()
    }

    fn pose(&mut self, robot: usize) -> Result<Pose> {
        (**self).pose(robot)
    }

    fn pose_in_space(&mut self, robot: usize) -> Result<Pose3> {
        (**self).pose_in_space(robot)
    }

    fn robot(&mut self, robot: usize) -> Result<RobotTruth> {
        (**self).robot(robot)
    }

    fn object(&mut self, object: usize) -> Result<Pose> {
        (**self).object(object)
    }
}

/// What is true about one robot.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotTruth {
    /// Its pose in the world.
    pub pose: Pose,
    /// What its odometry says, relative to its start.
    pub odometry: Pose,
    /// How often it has come into contact with a wall, an object or a robot.
    pub contacts: u32,
    /// Where it first touched each time; at most the first 1,000.
    pub contact_places: Vec<Point>,
    /// Metres that its middle has moved.
    pub path_length: f64,
    /// Where it was, if the options ask for a trail.
    pub trail: Vec<TrailPoint>,
}

/// Where a robot was at a time, truly and by its own odometry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrailPoint {
    /// Seconds since the start.
    pub time: f64,
    /// The true pose in the world.
    pub pose: Pose,
    /// What its odometry said, in its own frame.
    pub odometry: Pose,
}
