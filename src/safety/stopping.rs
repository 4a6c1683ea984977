// This file compiles without the standard library.

/// By how much the speed that a vehicle measures may differ from the one that it has.
///
/// The default is five standard deviations of what wheels measure in the simulator for noise 1: 5 % for their diameter, and
/// `5 · 0.0005 √(v / 10 ms)` m/s for slip in a tick, which is less than 0.6 % of the speed and 0.031 m/s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedError {
    /// A share of the speed.
    pub share: f64,
    /// Metres per second beside that.
    pub offset: f64,
}

impl SpeedError {
    /// A speed that is measured as it is.
    pub const NONE: Self = Self { share: 0.0, offset: 0.0 };

    /// The greatest difference at a speed, in metres per second.
    pub const fn at(&self, speed: f64) -> f64 {
        self.share * speed.abs() + self.offset
    }

    /// The error of a robot with so many times the noise.
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

/// How a vehicle comes to a stop: for a reaction time it goes on as it was, then it follows the command to stand as a drive
/// with a first-order lag does whose deceleration is limited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StoppingModel {
    /// Seconds from the event to the brake, a control period included.
    pub reaction: f64,
    /// The time constant of the lag, in seconds.
    pub lag: f64,
    /// The greatest deceleration, in metres per second squared.
    pub deceleration: f64,
    /// How well the speed is known from which it brakes.
    pub error: SpeedError,
}

impl StoppingModel {
    /// The greatest distance, in metres, that a vehicle still goes that truly has this speed.
    ///
    /// It brakes from the speed that it measures, which may be greater by the error `e`: until its command has fallen below the
    /// true speed, it is told to go faster. What follows is for `v = speed + e`, as a vehicle goes no further that is slower.
    ///
    /// While it reacts, that is speed times reaction. Afterwards it brakes with the smaller one of `v / lag` and the
    /// deceleration `a`, so the distance is the integral of `max(lag, v / a)` over the speed, which is less than that of
    /// `lag + v / a`: `v · lag + v² / 2a`. A command that falls with `a` from `v` gives the same: it goes `v² / 2a` itself, and a lag
    /// adds the speed that is lost in it times its time constant.
    pub const fn distance(&self, speed: f64) -> f64 {
        let speed = speed.abs() + self.error.at(speed);
        speed * (self.reaction + self.lag) + speed * speed / (2.0 * self.deceleration)
    }

    /// The speed, in metres per second, from which the vehicle stops within a distance.
    pub fn speed_within(&self, distance: f64) -> f64 {
        // By bisection, as there is no square root without the standard library.
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
        /// The model itself, stepped until next to nothing of the speed is left.
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

        /// A vehicle whose command falls from the speed that it has measured, which is not the one that it has.
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
