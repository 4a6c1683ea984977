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

    /// Pose of a robot in space, and its mishap on hills, if any. The default implementation is for a level floor.
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

/// Pose of a robot in space, and its mishap, if any.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TruthInSpace {
    /// Pose with elevation, roll and pitch.
    pub pose: Pose3,
    /// Why the robot no longer drives, or makes no progress.
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

/// Why a robot no longer drives, or makes no progress.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Mishap {
    /// It lies on its side or on its back.
    Tipped,
    /// It fell by more than its own height, or off the world.
    Fell,
    /// Its wheels have turned for two seconds and hardly moved it. This ends when it moves again.
    Stuck,
    /// Its centre of mass is below the water surface.
    Drowned,
    /// Its motion is no longer a finite number, so it stays where it was: no such craft could exist.
    Broken,
}

impl Mishap {
    /// Whether the robot is lost: it will not drive again, in contrast to one that is stuck.
    pub fn is_final(self) -> bool {
        self != Self::Stuck
    }
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
