use super::Result;
use crate::geometry::{Point3, Pose3, Vector3};

/// How a robot is turned in space, in radians, as [`Pose3`] has it: a positive pitch lowers the nose, a positive roll
/// lifts the left side.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Attitude {
    /// About the forward axis.
    pub roll: f64,
    /// About the axis to the left.
    pub pitch: f64,
    /// About the upright axis, counter-clockwise; 0 along the world's x axis.
    pub yaw: f64,
}

impl Attitude {
    /// The attitude of a pose.
    pub fn of(pose: &Pose3) -> Self {
        let [roll, pitch, yaw] = pose.roll_pitch_yaw();
        Self { roll, pitch, yaw }
    }

    /// The robot's frame about its own origin.
    ///
    /// ```
    /// use roverlab::{geometry::Vector3, io::Attitude};
    /// let uphill = Attitude { pitch: -0.2, ..Attitude::default() };
    /// assert!(uphill.frame().rotate(Vector3::x()).z > 0.19, "the nose is up");
    /// ```
    pub fn frame(&self) -> Pose3 {
        Pose3::from_angles(Point3::origin(), self.roll, self.pitch, self.yaw)
    }
}

/// An inertial unit: how the robot is turned, how it turns, and what pulls at it.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait Inertial {
    /// How the robot is turned. Fails on a robot whose unit does not measure it.
    fn attitude(&mut self) -> Result<Attitude>;

    /// The speeds, in radians per second, at which the robot turns about its own axes: forward, to the left, up. Fails
    /// on a robot whose unit does not measure it.
    fn turn_rates(&mut self) -> Result<Vector3>;

    /// What accelerates the robot besides its weight, in metres per second squared along its own axes: forward, to the
    /// left, up. At rest on level ground it is 9.81 up, in free fall nothing. Fails on a robot whose unit does not
    /// measure it.
    fn acceleration(&mut self) -> Result<Vector3>;
}
