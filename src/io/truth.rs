use super::Result;
use crate::geometry::{Point, Pose, Pose3};

/// Ground truth of a world: a simulator, or the recording of one.
///
/// # For implementers
///
/// Return the true state of the same moment from all methods. Fail for a robot or an object that does
/// not exist.
pub trait GroundTruth {
    /// Time since the start of the world (s).
    fn time(&mut self) -> Result<f64>;

    /// True pose of a robot in the world.
    fn pose(&mut self, robot: usize) -> Result<Pose>;

    /// Ground truth of a robot.
    fn robot(&mut self, robot: usize) -> Result<RobotTruth>;

    /// Pose of an object in the world, by its index in the scene: robots may have pushed it.
    fn object(&mut self, object: usize) -> Result<Pose>;

    /// Where a robot is in space, and what has become of it on hills. Who knows of no hills says that it is
    /// level on the floor.
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
    /// Its motion is no number any more, so that it stays where it was: its description is of no craft that
    /// could be.
    Broken,
}

impl std::fmt::Display for Mishap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Tipped => "tipped over",
            Self::Fell => "fell",
            Self::Stuck => "stuck",
            Self::Drowned => "drowned",
            Self::Broken => "broken",
        })
    }
}
