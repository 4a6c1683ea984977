use super::Result;
use crate::geometry::{Point3, Pose3, Vector3};

/// Attitude of a robot (rad), with the conventions of [`Pose3`]: a positive pitch lowers the nose, a positive
/// roll lifts the left side.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Attitude {
    /// About the forward axis.
    pub roll: f64,
    /// About the axis to the left.
    pub pitch: f64,
    /// About the upright axis, counter-clockwise from the world's x axis.
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

/// An inertial measurement unit.
///
/// # For implementers
///
/// Fail for quantities that the unit does not measure, instead of returning zeros. Return readings with
/// their bias: algorithms model it.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait Inertial {
    /// Attitude in the world. Fails on a robot whose unit does not measure it.
    fn attitude(&mut self) -> Result<Attitude>;

    /// Turn rates about the robot's forward, left and upright axes (rad/s). Fails on a robot whose unit does
    /// not measure them.
    fn turn_rates(&mut self) -> Result<Vector3>;

    /// Specific force along the robot's forward, left and upright axes (m/s²): (0, 0, 9.81) at rest on level
    /// ground, 0 in free fall. Fails on a robot whose unit does not measure it.
    fn acceleration(&mut self) -> Result<Vector3>;
}
