use std::f64::consts::FRAC_PI_2;

use crate::ParameterError;
use crate::geometry::{Pose, WallSide, normalize_angle};
use crate::io::{Error, Result};
use crate::parameter::{require, require_finite, require_positive};
use crate::world::RobotSpec;

/// Where the distance sensors sit on the robot and where they point.
///
/// ```
/// use roverlab::drive::WallSensors;
/// use roverlab::world::RobotSpec;
/// let sensors = WallSensors::of(&RobotSpec::s4())?;
/// assert!((sensors.left.heading - std::f64::consts::FRAC_PI_2).abs() < 0.1);
/// assert!(WallSensors::of(&RobotSpec::race_car()).is_err(), "a car without distance sensors");
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallSensors {
    /// The one ahead.
    pub front: Pose,
    /// The one to the left.
    pub left: Pose,
    /// The one to the right.
    pub right: Pose,
}

impl Default for WallSensors {
    /// Those of an S4.
    fn default() -> Self {
        Self {
            front: Pose::new(0.060, 0.0, 0.0),
            left: Pose::new(0.055, 0.045, FRAC_PI_2),
            right: Pose::new(0.055, -0.045, -FRAC_PI_2),
        }
    }
}

impl WallSensors {
    /// The sensors 1 to 3 of a robot. Fails if it lacks one, or one points elsewhere than ahead, to the left and to the
    /// right.
    pub fn of(spec: &RobotSpec) -> Result<Self> {
        let find = |id: u8, name: &str| -> Result<Pose> {
            let psd = spec.psds.iter().find(|psd| psd.id == id);
            let psd = psd.ok_or_else(|| Error::unsupported(format!("{name} PSD")))?;
            Ok(Pose::new(psd.mount.x, psd.mount.y, psd.mount.yaw))
        };
        let sensors = Self { front: find(1, "front")?, left: find(2, "left")?, right: find(3, "right")? };
        sensors.validate()?;
        Ok(sensors)
    }

    /// Fails unless the sensors sit somewhere, and point ahead, to the left and to the right, each within 0.1 rad.
    pub fn validate(&self) -> std::result::Result<(), ParameterError> {
        for (name, pose, yaw) in [
            ("front PSD", self.front, 0.0),
            ("left PSD", self.left, FRAC_PI_2),
            ("right PSD", self.right, -FRAC_PI_2),
        ] {
            require_finite("x", pose.x)
                .and_then(|()| require_finite("y", pose.y))
                .map_err(|error| error.of(name))?;
            let good = normalize_angle(pose.heading - yaw).abs() < 0.1;
            require("direction", pose.heading, good, format!("about {yaw:.2} rad"))
                .map_err(|error| error.of(name))?;
        }
        Ok(())
    }

    /// The sensors of the mirrored robot.
    pub(super) fn mirrored(&self) -> Self {
        Self { front: mirror(self.front), left: mirror(self.right), right: mirror(self.left) }
    }
}

/// A pose as a mirror along the x axis shows it.
pub(super) fn mirror(pose: Pose) -> Pose {
    Pose::new(pose.x, -pose.y, -pose.heading)
}

/// What [`WallFollower`](super::WallFollower) goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallFollowerParameters {
    /// On which side the wall is to be; `None`: on that to which the robot has to turn less.
    pub side: Option<WallSide>,
    /// Metres between the wall and the robot's middle.
    pub distance: f64,
    /// Metres per second along the wall.
    pub speed: f64,
    /// Radians per second on the spot.
    pub turn_rate: f64,
    /// The standard deviation of a range reading, in metres.
    pub range_error: f64,
    /// Metres along the wall in which an error of distance dies away.
    pub reach: f64,
    /// The seconds by which the robot turns later than it is told.
    pub lag: f64,
    /// The distance from the robot's middle to its outline, in metres.
    pub radius: f64,
    /// Where the sensors sit.
    pub sensors: WallSensors,
    /// Seconds from one step to the next.
    pub period: f64,
}

impl Default for WallFollowerParameters {
    /// 0.2 m/s at 0.2 m from the wall, for an S4 with the noise of the real one.
    fn default() -> Self {
        Self {
            side: None,
            distance: 0.2,
            speed: 0.2,
            turn_rate: 1.5,
            range_error: 0.01,
            reach: 0.065,
            lag: 0.2,
            radius: 0.06,
            sensors: WallSensors::default(),
            period: 0.01,
        }
    }
}

impl WallFollowerParameters {
    /// Fails with the name of the parameter that is out of range.
    pub fn validate(&self) -> std::result::Result<(), ParameterError> {
        require_positive("speed", self.speed)?;
        require_positive("turn rate", self.turn_rate)?;
        require_positive("reach", self.reach)?;
        require_positive("lag", self.lag)?;
        require_positive("radius", self.radius)?;
        require_positive("control period", self.period)?;
        let least = 1.5 * self.radius;
        let expected = format!("{least} m, one and a half of the robot's radius, to 5 m");
        require("distance", self.distance, (least..=5.0).contains(&self.distance), expected)?;
        let good = (0.0..0.5 * self.distance).contains(&self.range_error);
        require("range error", self.range_error, good, "0 to half the distance")?;
        self.sensors.validate()
    }
}

/// What a wall follower sees at a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WallObservation {
    /// Where odometry takes the robot to be.
    pub pose: Pose,
    /// Metres from the front sensor to what is ahead; infinite if there is nothing.
    pub front: f64,
    /// The same to the left.
    pub left: f64,
    /// The same to the right.
    pub right: f64,
}

impl WallObservation {
    pub(super) fn check(&self) -> Result<()> {
        let ranges = [("front", self.front), ("left", self.left), ("right", self.right)];
        for (name, range) in ranges {
            if range.is_nan() {
                let name = format!("{name} range");
                return Err(Error::invalid_input(&name, range, "metres, or infinity without a return"));
            }
        }
        if self.pose.is_finite() {
            return Ok(());
        }
        Err(Error::invalid_input("observed pose", format!("{:?}", self.pose), "finite numbers"))
    }

    /// What the mirrored robot sees.
    pub(super) fn mirrored(&self) -> Self {
        Self { pose: mirror(self.pose), front: self.front, left: self.right, right: self.left }
    }
}
