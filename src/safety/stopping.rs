// This file compiles without the standard library.

/// Maximum error of the measured speed.
///
/// The default is five standard deviations of the simulated wheel encoders at noise 1: 5 % for the wheel
/// diameter, plus `5 · 0.0005 √(v / 10 ms)` m/s for slip within a tick, which is below 0.6 % of the speed
/// plus 0.031 m/s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedError {
    /// Relative error (fraction of the speed).
    pub share: f64,
    /// Absolute error (m/s).
    pub offset: f64,
}

impl SpeedError {
    /// No error.
    pub const NONE: Self = Self { share: 0.0, offset: 0.0 };

    /// Maximum error at a speed (m/s).
    pub const fn at(&self, speed: f64) -> f64 {
        self.share * speed.abs() + self.offset
    }

    /// The error scaled by the noise level.
    #[must_use]
    pub const fn scaled(self, factor: f64) -> Self {
        Self { share: self.share * factor, offset: self.offset * factor }
    }
}

impl Default for SpeedError {
    fn default() -> Self {
        Self { share: 0.056, offset: 0.031 }
    }
}

/// Model of a stop. During the reaction time the speed is unchanged; then the drive follows the command to
/// stand, with a first-order lag and limited deceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StoppingModel {
    /// Time from the event to the start of braking, one control period included (s).
    pub reaction: f64,
    /// Time constant of the first-order lag (s).
    pub lag: f64,
    /// Maximum deceleration (m/s²).
    pub deceleration: f64,
    /// Error of the speed from which braking starts.
    pub error: SpeedError,
}

impl StoppingModel {
    /// Upper bound of the stopping distance from the true speed `speed` (m).
    ///
    /// Braking starts at the measured speed, which may exceed the true one by the error `e`: until the
    /// command falls below the true speed, the vehicle accelerates. The bound therefore uses `v = speed + e`;
    /// a slower vehicle stops earlier.
    ///
    /// During the reaction, the distance is `v · reaction`. Afterwards the deceleration is the smaller of
    /// `v / lag` and `a`, so the distance is the integral of `max(lag, v / a)` over the speed, which is less
    /// than that of `lag + v / a`: `v · lag + v² / 2a`. A command that falls from `v` at rate `a` gives the
    /// same bound: the command covers `v² / 2a`, and the lag adds its time constant times the speed lost.
    pub const fn distance(&self, speed: f64) -> f64 {
        let speed = speed.abs() + self.error.at(speed);
        speed * (self.reaction + self.lag) + speed * speed / (2.0 * self.deceleration)
    }

    /// Speed from which the vehicle stops within a distance (m/s).
    pub fn speed_within(&self, distance: f64) -> f64 {
        // By bisection: there is no square root without the standard library.
        let (mut low, mut high) = (0.0, 1.0);
        while self.distance(high) < distance && high < 1e6 {
            high *= 2.0;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.distance(middle) <= distance {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_default_is_five_standard_deviations_of_the_simulator() {
        let (noise, error) = (crate::io::sim::NoiseModel::real(), SpeedError::default());
        for speed in [0.0, 0.05, 0.3, 1.0, 3.0, 6.0, 12.0, 20.0, 30.0_f64] {
            let deviations = noise.wheel_scale * speed + noise.slip * (speed / crate::io::sim::TICK).sqrt();
            assert!(error.at(speed) >= 5.0 * deviations, "{speed}");
        }
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        /// The model itself, integrated until the speed is negligible.
        #[test]
        fn no_vehicle_of_the_model_goes_further(
            speed in 0.01..20.0f64,
            reaction in 0.0..0.5f64,
            lag in 0.01..0.6f64,
            deceleration in 0.2..9.0f64,
        ) {
            let model = StoppingModel { reaction, lag, deceleration, error: SpeedError::NONE };
            let (mut left, mut way, step) = (speed, speed * reaction, 1e-4);
            while left > 1e-4 {
                way += left * step;
                left -= step * f64::min(deceleration, left / lag);
            }
            prop_assert!(way <= model.distance(speed) + 2.0 * speed * step, "{way} of {}", model.distance(speed));
        }

        /// A vehicle whose command falls from the measured speed, which differs from the true one.
        #[test]
        fn nor_does_one_that_is_wrong_about_its_speed(
            speed in 0.01..20.0f64,
            wrong in -1.0..1.0f64,
            share in 0.0..0.3f64,
            offset in 0.0..0.5f64,
            lag in 0.02..0.6f64,
            deceleration in 0.2..5.0f64,
        ) {
            let error = SpeedError { share, offset };
            let model = StoppingModel { reaction: 0.1, lag, deceleration, error };
            let mut told = f64::max(speed + wrong * error.at(speed), 0.0);
            let (mut left, mut way, step) = (speed, speed * model.reaction, 1e-4);
            while told > 0.0 || left > 1e-4 {
                told = f64::max(told - step * deceleration, 0.0);
                way += left * step;
                left += step * f64::clamp((told - left) / lag, -2.0 * deceleration, 8.0);
            }
            let bound = model.distance(speed) + 2.0 * (speed + error.at(speed)) * step;
            prop_assert!(way <= bound, "{way} of {bound}");
        }

        #[test]
        fn the_speed_for_a_distance_is_the_inverse(distance in 0.0..50.0f64) {
            let model = StoppingModel { reaction: 0.1, lag: 0.2, deceleration: 2.0, error: SpeedError::NONE };
            prop_assert!((model.distance(model.speed_within(distance)) - distance).abs() < 1e-6);
        }
    }
}
