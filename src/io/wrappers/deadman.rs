use image::RgbImage;

use crate::geometry::{Pose, Twist, Vector3};
use crate::io::{
    Attitude, Camera, Clock, DepthSensor, Display, DisplayImage, DisplayOption, DistanceSensors, Drive,
    Encoders, Fill, Font, Inertial, Key, Keys, Lidar, LidarScan, LidarSettings, Manoeuvres, Motors, Odometry,
    Pixel, Psd, Radio, RadioMessage, Resolution, Result, Servos, StallDetector, Viewport,
};
use crate::world::Colour;

/// A robot that stops if it receives no call for some time: a watchdog on the robot's side of the link,
/// against hanging programs and lost radio.
///
/// Every call except those of the clock counts. The robot keeps its curvature until it stands, and continues
/// with the next command.
///
/// ```
/// use roverlab::geometry::Twist;
/// use roverlab::io::wrappers::Deadman;
/// use roverlab::io::{Clock, Drive, MockRobot, Odometry};
///
/// # fn main() -> roverlab::io::Result<()> {
/// let mut robot = Deadman::new(MockRobot::new().with_ideal_drive(), 0.3)?;
/// robot.set_speed(Twist::new(0.5, 0.0))?;
/// robot.wait(10.0)?;
/// assert!((robot.pose()?.x - 0.15).abs() < 1e-3);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Deadman<R> {
    inner: R,
    limit: f64,
    /// Time since the last call (s).
    quiet: f64,
}

/// Speed of a standing robot that keeps its wheels turned (m/s).
const CREEP: f64 = 1e-6;

impl<R> Deadman<R> {
    /// Stops a robot after `seconds` without a call.
    ///
    /// Fails unless the number is positive.
    pub fn new(inner: R, seconds: f64) -> Result<Self> {
        crate::parameter::require_positive("seconds", seconds)?;
        Ok(Self { inner, limit: seconds, quiet: 0.0 })
    }

    /// The wrapped robot.
    pub fn inner(&self) -> &R {
        &self.inner
    }

    /// The wrapped robot, without the watchdog.
    pub fn into_inner(self) -> R {
        self.inner
    }

    #[expect(clippy::unnecessary_wraps, reason = "a hook of `hooked`, which others of them fail")]
    fn heard(&mut self) -> Result<()> {
        self.quiet = 0.0;
        Ok(())
    }
}

impl<R: Drive + Odometry> Deadman<R> {
    fn halt(&mut self) -> Result<()> {
        let Twist { linear, angular } = self.inner.speed()?;
        let bends = linear.abs() > 0.05;
        let creep = CREEP.copysign(linear);
        self.inner.set_speed(if bends { Twist::new(creep, creep * angular / linear) } else { Twist::STOP })
    }
}

impl<R: Clock + Drive + Odometry> Clock for Deadman<R> {
    fn now(&mut self) -> Result<f64> {
        self.inner.now()
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        let left = self.limit - self.quiet;
        if !(left >= 0.0 && seconds > left) {
            self.quiet += seconds.max(0.0);
            return self.inner.wait(seconds);
        }
        self.inner.wait(left)?;
        self.halt()?;
        self.quiet += seconds.max(0.0);
        self.inner.wait(seconds - left)
    }

    fn peek_time(&mut self) -> Result<f64> {
        self.inner.peek_time()
    }
}

hooked!(
    Deadman,
    heard,
    [],
    Drive,
    Odometry,
    Manoeuvres,
    StallDetector,
    DistanceSensors,
    Lidar,
    Camera,
    Display,
    Keys,
    Radio,
    Motors,
    Servos,
    Encoders,
    Inertial,
    DepthSensor
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::MockRobot;
    use crate::io::wrappers::{Fault, Faulty};

    #[test]
    fn it_drives_on_as_long_as_somebody_talks() {
        let mut robot = Deadman::new(MockRobot::new().with_ideal_drive(), 0.3).unwrap();
        robot.set_speed(Twist::new(0.5, 0.2)).unwrap();
        for _ in 0..20 {
            robot.wait(0.1).unwrap();
            robot.speed().unwrap();
        }
        assert!(robot.speed().unwrap().linear > 0.4);
    }

    #[test]
    fn without_a_link_it_stands() {
        let robot = Deadman::new(MockRobot::new().with_ideal_drive(), 0.3).unwrap();
        let mut robot = Faulty::new(robot, vec!["link@1".parse::<Fault>().unwrap()]);
        robot.set_speed(Twist::new(0.5, 0.2)).unwrap();
        for _ in 0..50 {
            let _ = robot.wait(0.1);
            let _ = robot.speed();
        }
        let mut robot = robot.into_inner().into_inner();
        assert!(robot.pose().unwrap().position().coords.norm() < 0.5 * 1.41);
        assert!(robot.speed().unwrap().linear < 1e-3);
    }

    #[test]
    fn numbers_that_are_no_time() {
        for seconds in [0.0, -1.0, f64::NAN] {
            assert!(Deadman::new(MockRobot::new(), seconds).is_err());
        }
    }
}
