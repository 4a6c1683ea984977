use crate::geometry::{Pose, Twist};
use crate::io::{Error, Result};
use crate::kinematics::Displacement;

/// What every kind of drive does for its robot: commands in, odometry and encoder counts out.
pub(super) trait Mechanics {
    /// Draws the errors of a new drive command.
    fn begin_command(&mut self);

    /// Drives at a speed, as near to it as the drive can, until the next command.
    fn set_twist(&mut self, twist: Twist);

    /// The shortest time that a motion along one arc takes at a speed, which the wheels may not reach. Fails
    /// if the robot cannot drive the arc.
    fn least_seconds(&self, motion: Displacement, speed: f64) -> Result<f64>;

    /// Starts a motion along one arc. `speed` is along the arc in m/s, or in rad/s for a turn on the spot.
    fn start(&mut self, motion: Displacement, speed: f64);

    /// Drives one motor with a fraction of its full speed and leaves the others as they are.
    fn set_motor(&mut self, motor: usize, fraction: f64);

    /// How many servos the drive has.
    fn servos(&self) -> u8 {
        0
    }

    /// Moves a servo of the drive, numbered from 1.
    fn set_servo(&mut self, servo: u8, _position: f64) -> Result<()> {
        Err(Error::unsupported(format!("servo {servo}")))
    }

    /// How many motors with encoders there are.
    fn motors(&self) -> usize;

    /// How many of them count their turns.
    fn encoders(&self) -> usize {
        self.motors()
    }

    /// Whether no manoeuvre is running.
    fn is_done(&self) -> bool;

    /// Whether the wheels are asked to turn.
    fn is_driving(&self) -> bool;

    /// Metres, or radians of a turn, that are left of the manoeuvre.
    fn remaining(&self) -> f64;

    /// The speed that odometry measures.
    fn twist(&self) -> Twist;

    fn odometry(&self) -> Pose;

    fn set_odometry(&mut self, pose: Pose);

    /// An encoder's count since the start.
    fn count(&self, motor: usize) -> i64;
}
