use nalgebra::{Matrix3, RowVector3, Vector3};

use crate::geometry::angle_difference;

/// What a compass reads too much, by the heading at the start, which is known, and the turn rates since: a
/// Kalman filter (Thrun et al., *Probabilistic Robotics*, 2005, section 3.2). As the sum of the turn rates
/// becomes less sure, the answer settles.
#[derive(Debug, Clone)]
pub(super) struct Alignment {
    /// By the start and turn rates (rad).
    heading: f64,
    /// What the compass reads too much (rad), that heading (rad), and each turn rate (rad/s).
    state: Vector3<f64>,
    covariance: Matrix3<f64>,
}

/// Standard deviation of the compass's constant error, and of a reading (rad): half a degree.
const COMPASS: f64 = 0.0087;
/// Standard deviation of the turn rate's constant error (rad/s): 0.05 degrees per second.
const BIAS: f64 = 0.000_87;
/// Walk of the turn rate's error (rad/s per √s): as much as `BIAS` in a minute.
const WALK: f64 = 0.000_11;
/// Standard deviation of an angle that was integrated from turn rates (rad/√s).
const TURN: f64 = 0.000_28;

impl Alignment {
    /// Begins at a heading (rad).
    pub(super) fn at(heading: f64) -> Self {
        let variances = Vector3::new(COMPASS * COMPASS, 0.0, BIAS * BIAS);
        Self { heading, state: Vector3::zeros(), covariance: Matrix3::from_diagonal(&variances) }
    }

    /// Takes notice of a turn (rad) in some seconds, and of the reading (rad) of the compass after it.
    pub(super) fn learn(&mut self, turned: f64, seconds: f64, compass: f64) {
        self.heading += turned;
        let mut on = Matrix3::identity();
        on[(1, 2)] = seconds;
        let noise = Matrix3::from_diagonal(&Vector3::new(0.0, TURN * TURN, WALK * WALK)) * seconds;
        self.state = on * self.state;
        self.covariance = on * self.covariance * on.transpose() + noise;
        // The two headings differ by what one reads too much and the other has come to.
        let seen = RowVector3::new(1.0, -1.0, 0.0);
        let off = angle_difference(compass, self.heading) - (seen * self.state)[0];
        let spread = (seen * self.covariance * seen.transpose())[0] + COMPASS * COMPASS;
        let gain = self.covariance * seen.transpose() / spread;
        self.state += gain * off;
        self.covariance = (Matrix3::identity() - gain * seen) * self.covariance;
    }

    /// What the compass reads too much (rad).
    pub(super) fn off(&self) -> f64 {
        self.state.x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn a_compass_is_aligned_by_the_start() {
        let mut squares = 0.0;
        for seed in 0..100 {
            let mut stream = Stream::new(seed);
            let (off, bias) = (COMPASS * stream.normal(), BIAS * stream.normal());
            let mut alignment = Alignment::at(0.3);
            for step in 1..=300 {
                let turned = 0.01 + 0.1 * (bias + BIAS * stream.normal());
                alignment.learn(turned, 0.1, 0.3 + 0.01 * f64::from(step) + off + COMPASS * stream.normal());
            }
            squares += (alignment.off() - off) * (alignment.off() - off) / 100.0;
        }
        // The mean of 300 readings, if the turn rates had no errors, is within 0.0005.
        assert!(squares.sqrt() < 0.002, "{}", squares.sqrt());
    }
}
