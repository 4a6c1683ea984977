//! The sensors of a robot's description.

use crate::ParameterError;
use crate::geometry::{Point3, Pose3};
use crate::parameter::{require, require_finite, require_not_negative, require_positive};

/// Pose of a sensor on a robot.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Mount {
    /// Distance ahead of the middle of the driven axle (m).
    pub x: f64,
    /// Distance to its left (m).
    pub y: f64,
    /// Height above the floor (m).
    pub z: f64,
    /// Roll (rad): positive lifts its left side. No effect on a single ray.
    pub roll: f64,
    /// Pitch (rad): positive points it downwards.
    pub pitch: f64,
    /// Yaw, counter-clockwise from straight ahead (rad).
    pub yaw: f64,
}

impl Mount {
    /// Pose of the sensor in the robot's frame. Roll, pitch and yaw rotate it about fixed axes, in this order.
    pub fn frame(&self) -> Pose3 {
        Pose3::from_angles(Point3::new(self.x, self.y, self.z), self.roll, self.pitch, self.yaw)
    }

    /// Whether the sensor is parallel to the robot's floor.
    pub fn is_level(&self) -> bool {
        self.roll == 0.0 && self.pitch == 0.0
    }

    pub(super) fn validate(&self) -> Result<(), ParameterError> {
        for (name, value) in [
            ("mount x", self.x),
            ("mount y", self.y),
            ("mount z", self.z),
            ("mount roll", self.roll),
            ("mount pitch", self.pitch),
            ("mount yaw", self.yaw),
        ] {
            require_finite(name, value)?;
        }
        Ok(())
    }
}

/// A position-sensitive device: a distance sensor with a single ray.
#[derive(Debug, Clone, PartialEq)]
pub struct PsdSpec {
    /// Number for programs.
    pub id: u8,
    /// Its name in the robot's description.
    pub name: String,
    /// Its position and direction.
    pub mount: Mount,
    /// Longest distance that it reports (m).
    pub max_range: f64,
}

impl PsdSpec {
    /// RoBIOS reports no distances beyond 9.999 m.
    pub const DEFAULT_MAX_RANGE: f64 = 9.999;
}

/// A laser scanner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LidarSpec {
    /// Its position and the orientation of its plane. The scan is centred on its yaw.
    pub mount: Mount,
    /// Field of view (rad), at most a full turn.
    pub field_of_view: f64,
    /// Elevation of every beam above the scanner's plane (rad): the beams form a cone.
    pub tilt: f64,
    /// Number of beams per scan.
    pub points: usize,
    /// Longest distance that it reports (m).
    pub max_range: f64,
}

impl Default for LidarSpec {
    /// 360 level beams all round, 40 mm above the floor, so that they hit other robots and a golf ball; with
    /// the range of RoBIOS.
    fn default() -> Self {
        Self {
            mount: Mount { z: 0.04, ..Mount::default() },
            field_of_view: std::f64::consts::TAU,
            tilt: 0.0,
            points: 360,
            max_range: PsdSpec::DEFAULT_MAX_RANGE,
        }
    }
}

impl LidarSpec {
    pub(super) fn validate(&self) -> Result<(), ParameterError> {
        let (fov, points) = (self.field_of_view, self.points as f64);
        let full_turn = std::f64::consts::TAU * (1.0 + 1e-9);
        require(
            "lidar field of view",
            fov,
            fov > 0.0 && fov <= full_turn,
            "more than 0 and at most a full turn",
        )?;
        require("lidar points", points, (1.0..=100_000.0).contains(&points), "1 to 100000")?;
        require_positive("lidar maximal range", self.max_range)?;
        require_finite("lidar tilt", self.tilt)?;
        self.mount.validate()
    }
}

/// A camera on a pan-tilt head.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraSpec {
    /// Its position; the yaw is the pan at rest. Its roll and pitch are 0.
    pub mount: Mount,
    /// Elevation angle at rest (rad).
    pub tilt: f64,
    /// Largest pan to either side (rad).
    pub max_pan: f64,
    /// Largest tilt up or down (rad).
    pub max_tilt: f64,
    /// Horizontal field of view (rad).
    pub field_of_view: f64,
    /// Whether the lens is an equidistant fisheye: the distance of an image point from the centre is
    /// proportional to its angle from the line of sight. Other cameras are pinholes.
    pub fisheye: bool,
}

impl CameraSpec {
    /// Default horizontal field of view of a camera (rad): 60 degrees.
    pub const DEFAULT_FIELD_OF_VIEW: f64 = std::f64::consts::FRAC_PI_3;

    pub(super) fn validate(&self) -> Result<(), ParameterError> {
        self.mount.validate()?;
        let turned = if self.mount.roll == 0.0 { self.mount.pitch } else { self.mount.roll };
        require(
            "camera mount's roll and pitch",
            turned,
            turned == 0.0,
            "0: the camera's tilt says how it looks",
        )?;
        require_finite("camera tilt", self.tilt)?;
        require_not_negative("camera max pan", self.max_pan)?;
        require_not_negative("camera max tilt", self.max_tilt)?;
        let (view, full_turn) = (self.field_of_view, std::f64::consts::TAU * (1.0 + 1e-9));
        let good = view > 0.0 && view <= full_turn;
        require("camera field of view", view, good, "more than 0 and at most a full turn")
    }
}

/// A pressure sensor that measures depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthSensorSpec {
    /// The channel by which RoBIOS programs read it with `ANALOGRead`, in mm.
    pub channel: u8,
    /// Height above the robot's origin (m).
    pub z: f64,
}

/// Measurements of a robot's inertial unit, and the channels on which RoBIOS programs read them with
/// `ANALOGRead`. The default has no measurements: a robot without a unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct InertialSpec {
    /// Channels of roll, pitch and yaw (tenths of degrees).
    pub attitude: Option<[u8; 3]>,
    /// Channels of the turn rates about the forward, left and upright axes (tenths of degrees per second).
    pub turn_rates: Option<[u8; 3]>,
    /// Channels of the accelerations along these axes (mm/s²).
    pub acceleration: Option<[u8; 3]>,
}

impl InertialSpec {
    /// All quantities, on channels above RoBIOS's own 0 to 8.
    pub const ALL: Self = Self {
        attitude: Some([9, 10, 11]),
        turn_rates: Some([12, 13, 14]),
        acceleration: Some([15, 16, 17]),
    };

    /// Fails unless channel numbers are positive and distinct.
    pub fn validate(&self) -> Result<(), ParameterError> {
        let groups = [self.attitude, self.turn_rates, self.acceleration];
        let channels: Vec<u8> = groups.into_iter().flatten().flatten().collect();
        for (index, &channel) in channels.iter().enumerate() {
            let new = channel > 0 && !channels[..index].contains(&channel);
            require("channel of the inertial unit", channel.into(), new, "1 to 255, each once")?;
        }
        Ok(())
    }
}
