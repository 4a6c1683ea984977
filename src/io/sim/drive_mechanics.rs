use crate::geometry::{Pose, Twist};
use crate::io::{Error, Result};
use crate::kinematics::{Displacement, PlanarMotion};

/// Ticks for which a drive runs ahead of its robot at most.
pub(super) const AHEAD: usize = 16;

/// What a drive does to its robot in a tick.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Drift {
    /// The robot's true motion, if nothing is in its way.
    pub(super) motion: PlanarMotion,
    /// Whether the wheels are commanded to turn.
    pub(super) is_driving: bool,
    /// Upper bound of the motion of any point of the robot's outline (m).
    pub(super) reach: f64,
}

/// Interface of every drive: commands in, odometry and encoder counts out.
pub(super) trait Mechanics {
    /// Draws the errors of a new drive command.
    fn begin_command(&mut self);

    /// Drives at a speed, or the nearest possible one, until the next command.
    fn set_twist(&mut self, twist: Twist);

    /// Shortest duration of a motion along one arc at a speed, which the wheels may not reach. Fails if the
    /// robot cannot drive the arc.
    fn least_seconds(&self, motion: Displacement, speed: f64) -> Result<f64>;

    /// Starts a motion along one arc. `speed` is along the arc in m/s, or in rad/s for a turn on the spot.
    fn start(&mut self, motion: Displacement, speed: f64);

    /// Drives one motor with a fraction of its full speed and leaves the others unchanged.
    fn set_motor(&mut self, motor: usize, fraction: f64);

    /// Number of servos of the drive.
    fn servos(&self) -> u8 {
        0
    }

    /// Moves a servo of the drive, numbered from 1.
    fn set_servo(&mut self, servo: u8, _position: f64) -> Result<()> {
        Err(Error::unsupported(format!("servo {servo}")))
    }

    /// Number of motors with encoders.
    fn motors(&self) -> usize;

    /// How many of them count their turns.
    fn encoders(&self) -> usize {
        self.motors()
    }

    /// Whether no manoeuvre is running.
    fn is_done(&self) -> bool;

    /// Whether the wheels are commanded to turn.
    fn is_driving(&self) -> bool;

    /// Remainder of the manoeuvre (m, or rad for a turn).
    fn remaining(&self) -> f64;

    /// Speed measured by odometry.
    fn twist(&self) -> Twist;

    fn odometry(&self) -> Pose;

    fn set_odometry(&mut self, pose: Pose);

    /// Encoder count since the start.
    fn count(&self, motor: usize) -> i64;
}
