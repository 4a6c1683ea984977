use crate::ParameterError;
use crate::parameter::require;
use crate::random::Stream;

/// Errors of a simulated robot as standard deviations.
///
/// `NoiseModel::real()` is noise factor 1 of all examples and campaigns; [`scaled`](NoiseModel::scaled)
/// multiplies all values. Drive errors are drawn once per robot, slip at every step, and range errors at
/// every reading.
///
/// ```
/// use roverlab::io::sim::NoiseModel;
/// assert_eq!(NoiseModel::real().scaled(0.0), NoiseModel::ideal());
/// assert_eq!(NoiseModel::real().scaled(2.0).range, 2.0 * NoiseModel::real().range);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseModel {
    /// Relative error common to both wheels' diameters.
    pub wheel_scale: f64,
    /// Relative difference between the left and right wheels' diameters.
    pub wheel_mismatch: f64,
    /// Relative error of the track.
    pub track: f64,
    /// Slip of each wheel: standard deviation after one metre (m); it grows with the square root of the
    /// distance.
    pub slip: f64,
    /// Error of each range reading of PSDs and lidar (m).
    pub range: f64,
    /// Relative error of length and angle, drawn for every drive command.
    pub command: f64,
    /// Shot noise of the camera in levels (of 255) on white; proportional to the square root of the
    /// brightness.
    pub shot: f64,
    /// Relative error of the camera's exposure, which drifts within seconds.
    pub exposure: f64,
    /// Blur of the camera, in pixels of an image 320 pixels wide; proportional for other widths.
    pub blur: f64,
    /// Standard deviation of the depth sensor (m), both of its constant error and of each reading.
    pub depth: f64,
    /// Error of a Doppler log: relative, drawn once, and as many m/s in the mean of a second.
    pub doppler: f64,
    /// Error of the inertial unit's roll, pitch and yaw (rad): a constant one and one for each reading. The
    /// yaw also drifts, by the same amount per minute, unless the robot has a compass.
    pub attitude: f64,
    /// The same for its turn rates (rad/s); the random walk applies to all three.
    pub turn_rate: f64,
    /// The same for its accelerations (m/s²).
    pub acceleration: f64,
}

impl NoiseModel {
    /// No sensor or drive errors. Encoders still count whole ticks.
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
            depth: 0.0,
            doppler: 0.0,
            attitude: 0.0,
            turn_rate: 0.0,
            acceleration: 0.0,
        }
    }

    /// Errors of the real robot.
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
            // The resolution of the Bar30 of 300 m, zeroed at the surface.
            depth: 0.002,
            // A small log's data sheet (Nortek DVL1000): 0.3 %, and 1 mm/s in the long term.
            doppler: 0.003,
            // From data sheets of small units: Xsens MTi 1 (0.5 degrees), InvenSense MPU-6050 (0.05 degrees
            // per second, and 4 mg in a band of 100 Hz).
            attitude: 0.0087,
            turn_rate: 0.000_87,
            acceleration: 0.04,
        }
    }

    /// The book's simpler model: drive commands are wrong by 1 to 2 %, ranges by 10 mm.
    pub const fn textbook() -> Self {
        Self { range: 0.010, command: 0.015, ..Self::ideal() }
    }

    /// All values times a factor.
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
            depth: self.depth * factor,
            doppler: self.doppler * factor,
            attitude: self.attitude * factor,
            turn_rate: self.turn_rate * factor,
            acceleration: self.acceleration * factor,
        }
    }

    /// Fails with the name of an error out of range.
    pub(super) fn validate(&self) -> std::result::Result<(), ParameterError> {
        let real = Self::real();
        for (name, value, real, limit) in [
            ("wheel scale error", self.wheel_scale, real.wheel_scale, 1.0),
            ("wheel mismatch", self.wheel_mismatch, real.wheel_mismatch, 1.0),
            ("track error", self.track, real.track, 1.0),
            ("slip", self.slip, real.slip, 1.0),
            ("range error", self.range, real.range, 1000.0),
            ("command error", self.command, real.command, 1.0),
            ("shot noise", self.shot, real.shot, 255.0),
            ("exposure error", self.exposure, real.exposure, 1.0),
            ("blur", self.blur, real.blur, 10.0),
            ("depth error", self.depth, real.depth, 1000.0),
            ("Doppler log's error", self.doppler, real.doppler, 1.0),
            ("attitude error", self.attitude, real.attitude, 10.0),
            ("turn rate error", self.turn_rate, real.turn_rate, 1000.0),
            ("acceleration error", self.acceleration, real.acceleration, 1000.0),
        ] {
            // Most models are the real robot's times a level, which is what a caller knows.
            let levels = format!(", as of a noise level of 0 to {:.0}", limit / real);
            let levels = if real > 0.0 { &levels } else { "" };
            require(name, value, (0.0..=limit).contains(&value), format!("0 to {limit}{levels}"))?;
        }
        Ok(())
    }
}

/// A reading with noise; a missing return stays one.
#[inline]
pub(super) fn noisy(range: f64, sigma: f64, max_range: f64, stream: &mut Stream) -> f64 {
    if sigma == 0.0 || range.is_infinite() {
        return range;
    }
    with_noise(range, sigma * stream.normal(), max_range)
}

/// The same for all readings of a scan.
pub(super) fn make_noisy(ranges: &mut [f64], sigma: f64, max_range: f64, stream: &mut Stream) {
    if sigma == 0.0 {
        return;
    }
    let add = |(range, sample): (&mut f64, &mut f64)| {
        *range = with_noise(*range, sigma * *sample, max_range);
    };
    let mut samples = [0.0; 64];
    for part in ranges.chunks_mut(samples.len()) {
        let count = part.iter().filter(|range| range.is_finite()).count();
        let samples = &mut samples[..count];
        stream.fill_normal(samples);
        if count == part.len() {
            // Without a choice, the compiler takes several at once.
            part.iter_mut().zip(samples).for_each(add);
        } else {
            part.iter_mut().filter(|range| range.is_finite()).zip(samples).for_each(add);
        }
    }
}

#[inline]
fn with_noise(range: f64, error: f64, max_range: f64) -> f64 {
    let reading = (range + error).max(0.0);
    if reading > max_range { f64::INFINITY } else { reading }
}
