use super::{Error, Result};
use crate::geometry::{Pose, Twist, math};

/// Velocity control, common to all drives.
///
/// # For implementers
///
/// Return at once; the last command holds until the next one. Scale both parts of a velocity beyond the
/// limits by one factor. Fail for numbers that are not finite. Override `stop` where a halt needs more
/// than zero speed.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait Drive {
    /// Drives at a velocity until the next command. Velocities beyond the wheels' limits are scaled down; the
    /// curvature stays.
    fn set_speed(&mut self, twist: Twist) -> Result<()>;

    /// Stops the robot, whatever was running.
    fn stop(&mut self) -> Result<()> {
        self.set_speed(Twist::STOP)
    }
}

/// Pose and velocity as measured by the wheels.
///
/// # For implementers
///
/// Integrate all motion from the wheels' encoders, also that of manoeuvres and single motors.
/// `set_pose` must not move the robot. Return no pose from elsewhere: algorithms model the drift of
/// odometry.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait Odometry {
    /// Measured velocity.
    fn speed(&mut self) -> Result<Twist>;

    /// Pose relative to the start or to the last [`set_pose`](Odometry::set_pose).
    fn pose(&mut self) -> Result<Pose>;

    /// Sets the current pose of odometry; the robot does not move.
    fn set_pose(&mut self, pose: Pose) -> Result<()>;
}

/// Short manoeuvres executed by the drive itself, like RoBIOS's v-omega interface.
///
/// A manoeuvre (`straight`, `turn`, `curve`, `drive_to`) returns at once and replaces a running one;
/// [`wait_done`](Manoeuvres::wait_done) blocks until it ends.
/// [`Manoeuvring`](crate::io::wrappers::Manoeuvring) implements them for a robot with velocity control and
/// odometry.
///
/// # For implementers
///
/// A new manoeuvre or velocity replaces the running one. `remaining` decreases to 0 and stays there;
/// `is_done` then holds. A stalled manoeuvre must not block `wait_done` for ever.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait Manoeuvres {
    /// Drives `distance` metres straight ahead, backwards if negative, at `speed` m/s (its sign is ignored).
    fn straight(&mut self, distance: f64, speed: f64) -> Result<()>;

    /// Turns on the spot by `angle` radians, clockwise if negative, at `speed` rad/s (its sign is ignored).
    fn turn(&mut self, angle: f64, speed: f64) -> Result<()>;

    /// Drives an arc `length` metres long while the heading changes by `angle` radians, at `speed` m/s along
    /// the arc (its sign is ignored).
    fn curve(&mut self, length: f64, angle: f64, speed: f64) -> Result<()>;

    /// Drives the single arc to a point `forward` metres ahead and `left` metres to the left, at `speed` m/s
    /// along the arc. A point behind takes an arc of more than a half turn, like RoBIOS's `VWDrive`.
    fn drive_to(&mut self, forward: f64, left: f64, speed: f64) -> Result<()> {
        let (length, angle) = arc_to(forward, left)?;
        self.curve(length, angle, speed)
    }

    /// Remaining distance (m), or angle for a turn on the spot (rad), of the running manoeuvre; 0 when none
    /// is running.
    fn remaining(&mut self) -> Result<f64>;

    /// Whether no manoeuvre is running.
    fn is_done(&mut self) -> Result<bool>;

    /// Blocks until the running manoeuvre has ended or stalled.
    fn wait_done(&mut self) -> Result<()>;
}

/// Detects that a robot is held.
///
/// # For implementers
///
/// Report a stall only while the wheels are commanded to move. Behaviours end as blocked when it
/// persists.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait StallDetector {
    /// Whether the wheels are commanded to turn and something holds the robot.
    fn is_stalled(&mut self) -> Result<bool>;
}

/// Length and heading change of the arc from the origin, heading along x, to a point.
fn arc_to(forward: f64, left: f64) -> Result<(f64, f64)> {
    crate::parameter::require_finite("forward distance", forward)?;
    crate::parameter::require_finite("distance to the left", left)?;
    let chord = math::hypot(forward, left);
    if chord == 0.0 {
        return Ok((0.0, 0.0));
    }
    if left == 0.0 && forward < 0.0 {
        return Err(Error::invalid_input("target", "straight behind", "a point that one arc can reach"));
    }
    let half = math::atan2(left, forward);
    // A short arc's length is its chord times half / sin(half), which tends to 1.
    let length = if half.abs() < 1e-9 { chord } else { chord * half / math::sin(half) };
    Ok((length, 2.0 * half))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, direction};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn an_arc_ends_where_it_should(x in -1.0..1.0f64, y in -1.0..1.0f64) {
            prop_assume!(x.hypot_plain(y) > 1e-3 && (x > 0.0 || y.abs() > 1e-3));
            let (length, angle) = arc_to(x, y).unwrap();
            let steps = 20_000;
            let mut end = Point::origin();
            for i in 0..steps {
                let heading = angle * (f64::from(i) + 0.5) / f64::from(steps);
                end += direction(heading) * (length / f64::from(steps));
            }
            prop_assert!((end - Point::new(x, y)).norm() < 1e-5 * length.max(1.0));
        }
    }

    trait Plain {
        fn hypot_plain(self, other: f64) -> f64;
    }
    impl Plain for f64 {
        fn hypot_plain(self, other: f64) -> f64 {
            math::hypot(self, other)
        }
    }

    #[test]
    fn a_point_straight_behind_has_no_arc() {
        assert!(arc_to(-1.0, 0.0).is_err());
        assert_eq!(arc_to(0.0, 0.0).unwrap(), (0.0, 0.0));
        assert!(arc_to(f64::NAN, 0.0).is_err());
    }
}
