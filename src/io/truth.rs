use super::Result;
use crate::geometry::{Point, Pose, Pose3};

/// Who knows what is true in a world: a simulator, or the recording of what one said.
pub trait GroundTruth {
    /// Seconds since the start of the world.
    fn time(&mut self) -> Result<f64>;

    /// A robot's pose in the world.
    fn pose(&mut self, robot: usize) -> Result<Pose>;

    /// All that is true about a robot.
    fn robot(&mut self, robot: usize) -> Result<RobotTruth>;

    /// An object's pose in the world, by its index in the scene: robots may have pushed it.
    fn object(&mut self, object: usize) -> Result<Pose>;

    /// Where a robot is in space, and what has become of it on hills. Who knows of no hills says that it is level on the
    /// floor.
    fn in_space(&mut self, robot: usize) -> Result<TruthInSpace> {
        self.pose(robot).map(|pose| TruthInSpace { pose: Pose3::level(pose, 0.0), mishap: None })
    }
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

    fn in_space(&mut self, robot: usize) -> Result<TruthInSpace> {
        (**self).in_space(robot)
    }
}

/// Where a robot is in space, and what has become of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TruthInSpace {
    /// Its pose, with elevation, roll and pitch.
    pub pose: Pose3,
    /// Why it drives no more, or in vain.
    pub mishap: Option<Mishap>,
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

/// What becomes of a robot on hills that drives no more, or in vain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Mishap {
    /// It lies on its side or on its back.
    Tipped,
    /// It fell by more than its own height, or off the world.
    Fell,
    /// Its wheels have turned for two seconds and moved it next to nothing. It is over when it moves again.
    Stuck,
    /// The middle of its mass is below the water's surface.
    Drowned,
}

impl std::fmt::Display for Mishap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Tipped => "tipped over",
            Self::Fell => "fell",
            Self::Stuck => "stuck",
            Self::Drowned => "drowned",
        })
    }
}
