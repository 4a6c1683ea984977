use std::f64::consts::FRAC_PI_2;

use crate::ParameterError;
use crate::geometry::{Pose, WallSide, normalize_angle};
use crate::io::reading::{check_distances, check_pose};
use crate::io::{Error, Result};
use crate::parameter::{require, require_finite, require_positive};
use crate::world::RobotSpec;

/// Mounting poses of the distance sensors.
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
    /// Front sensor.
    pub front: Pose,
    /// Left sensor.
    pub left: Pose,
    /// Right sensor.
    pub right: Pose,
}

impl Default for WallSensors {
    /// Sensors of an S4.
    fn default() -> Self {
        Self {
            front: Pose::new(0.060, 0.0, 0.0),
            left: Pose::new(0.055, 0.045, FRAC_PI_2),
            right: Pose::new(0.055, -0.045, -FRAC_PI_2),
        }
    }
}

impl WallSensors {
    /// Sensors 1 to 3 of a robot. Fails if one is missing, or does not point ahead, to the left or to the
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

    /// Fails unless all poses are finite and point ahead, left and right to within 0.1 rad.
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

    /// Sensors of the mirrored robot.
    pub(super) fn mirrored(&self) -> Self {
        Self { front: mirror(self.front), left: mirror(self.right), right: mirror(self.left) }
    }
}

/// A pose mirrored at the x axis.
pub(super) fn mirror(pose: Pose) -> Pose {
    Pose::new(pose.x, -pose.y, -pose.heading)
}

/// Parameters of [`WallFollower`](super::WallFollower).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallFollowerParameters {
    /// Side of the wall; `None` chooses the side that takes less turning.
    pub side: Option<WallSide>,
    /// Distance from the wall to the robot's centre (m).
    pub distance: f64,
    /// Speed along the wall (m/s).
    pub speed: f64,
    /// Turn rate on the spot (rad/s).
    pub turn_rate: f64,
    /// Standard deviation of a range reading (m).
    pub range_error: f64,
    /// Decay length of a distance error (m).
    pub reach: f64,
    /// Delay of the robot's turn after a command (s).
    pub lag: f64,
    /// Distance from the robot's centre to its outline (m).
    pub radius: f64,
    /// Mounting poses of the sensors.
    pub sensors: WallSensors,
    /// Control period (s).
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
    /// Checks every parameter; the error names the one out of range.
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

/// Observation of a wall follower.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WallObservation {
    /// Pose by odometry.
    pub pose: Pose,
    /// Range of the front sensor (m); infinite without a return.
    pub front: f64,
    /// Range of the left sensor (m).
    pub left: f64,
    /// Range of the right sensor (m).
    pub right: f64,
}

impl WallObservation {
    pub(super) fn check(&self) -> Result<()> {
        for (name, range) in
            [("front range", self.front), ("left range", self.left), ("right range", self.right)]
        {
            check_distances(name, &[range])?;
        }
        check_pose(&self.pose)
    }

    /// Observation of the mirrored robot.
    pub(super) fn mirrored(&self) -> Self {
        Self { pose: mirror(self.pose), front: self.front, left: self.right, right: self.left }
    }
}
