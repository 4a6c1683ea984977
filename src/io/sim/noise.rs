use crate::ParameterError;
use crate::parameter::require;

/// How far a simulated robot is from an ideal one, as standard deviations.
///
/// `NoiseModel::real()` is noise factor 1 of every example and campaign; [`scaled`](NoiseModel::scaled) multiplies
/// all of it. Drive errors are drawn once for a robot, slip at every step, range errors at every reading.
///
/// ```
/// use roverlab::io::sim::NoiseModel;
/// assert_eq!(NoiseModel::real().scaled(0.0), NoiseModel::ideal());
/// assert_eq!(NoiseModel::real().scaled(2.0).range, 2.0 * NoiseModel::real().range);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseModel {
    /// Relative error of both wheels' diameters together.
    pub wheel_scale: f64,
    /// Relative difference between the left and the right wheel's diameter.
    pub wheel_mismatch: f64,
    /// Relative error of the track.
    pub track: f64,
    /// Slip of each wheel, in metres after one metre; it grows with the square root of the distance.
    pub slip: f64,
    /// Error of each range reading of PSDs and lidar, in metres.
    pub range: f64,
    /// Relative error of length and angle, drawn anew for every drive command.
    pub command: f64,
    /// Shot noise of the camera: levels (of 255) on white; it falls with the square root of the brightness.
    pub shot: f64,
    /// Relative error of the camera's exposure, which drifts in the course of seconds.
    pub exposure: f64,
    /// Blur of the camera, in pixels of an image 320 pixels wide; in proportion for others.
    pub blur: f64,
    /// Error of the inertial unit's roll, pitch and yaw (rad): standard deviation of the constant bias and of the white
    /// noise, and of the yaw's random walk after one minute.
    pub attitude: f64,
    /// The same for its turn rates (rad/s); the random walk applies to all three.
    pub turn_rate: f64,
    /// The same for its accelerations (m/s²).
    pub acceleration: f64,
}

impl NoiseModel {
    /// No sensor or drive error at all. Encoders still count whole ticks.
    pub const fn ideal() -> Self {
        Self {
            wheel_scale: 0.0,
            wheel_mismatch: 0.0,
            track: 0.0,
            slip: 0.0,
            range: 0.0,
            command: 0.0,
            shot: 0.0,
            exposure: 0.0,
            blur: 0.0,
            attitude: 0.0,
            turn_rate: 0.0,
            acceleration: 0.0,
        }
    }

    /// As on the real robot.
    pub const fn real() -> Self {
        Self {
            wheel_scale: 0.01,
            wheel_mismatch: 0.0003,
            track: 0.003,
            slip: 0.0005,
            range: 0.010,
            command: 0.0,
            shot: 3.0,
            exposure: 0.03,
            blur: 0.5,
            // As data sheets of small units state: Xsens MTi 1 (0.5 degrees), InvenSense MPU-6050 (0.05 degrees per
            // second, and 4 mg in a band of 100 Hz).
            attitude: 0.0087,
            turn_rate: 0.000_87,
            acceleration: 0.04,
        }
    }

    /// The book's simpler picture: every drive command comes out 1 to 2 % wrong, and ranges err by 10 mm.
    pub const fn textbook() -> Self {
        Self { range: 0.010, command: 0.015, ..Self::ideal() }
    }

    /// Everything multiplied by a factor.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            wheel_scale: self.wheel_scale * factor,
            wheel_mismatch: self.wheel_mismatch * factor,
            track: self.track * factor,
            slip: self.slip * factor,
            range: self.range * factor,
            command: self.command * factor,
            shot: self.shot * factor,
            exposure: self.exposure * factor,
            blur: self.blur * factor,
            attitude: self.attitude * factor,
            turn_rate: self.turn_rate * factor,
            acceleration: self.acceleration * factor,
        }
    }

    /// Fails with the name of the error that is out of range.
    pub(super) fn validate(&self) -> std::result::Result<(), ParameterError> {
        for (name, value, limit) in [
            ("wheel scale error", self.wheel_scale, 1.0),
            ("wheel mismatch", self.wheel_mismatch, 1.0),
            ("track error", self.track, 1.0),
            ("slip", self.slip, 1.0),
            ("range error", self.range, 1000.0),
            ("command error", self.command, 1.0),
            ("shot noise", self.shot, 255.0),
            ("exposure error", self.exposure, 1.0),
            ("blur", self.blur, 10.0),
            ("attitude error", self.attitude, 10.0),
            ("turn rate error", self.turn_rate, 1000.0),
            ("acceleration error", self.acceleration, 1000.0),
        ] {
            require(name, value, (0.0..=limit).contains(&value), format!("0 to {limit}"))?;
        }
        Ok(())
    }
}
