// This file compiles without the standard library.

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
}

impl StoppingModel {
    /// The greatest distance, in metres, that a vehicle of this speed still goes.
    ///
    /// While it reacts, that is speed times reaction. Afterwards it brakes with the smaller one of `v / lag` and the
    /// deceleration `a`, so the distance is the integral of `max(lag, v / a)` over the speed, which is less than that of
    /// `lag + v / a`: `speed · lag + speed² / 2a`.
    pub const fn distance(&self, speed: f64) -> f64 {
        let speed = speed.abs();
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

    proptest! {
        /// The model itself, stepped until next to nothing of the speed is left.
        #[test]
        fn no_vehicle_of_the_model_goes_further(
            speed in 0.01..20.0f64,
            reaction in 0.0..0.5f64,
            lag in 0.01..0.6f64,
            deceleration in 0.2..9.0f64,
        ) {
            let model = StoppingModel { reaction, lag, deceleration };
            let (mut left, mut way, step) = (speed, speed * reaction, 1e-4);
            while left > 1e-4 {
                way += left * step;
                left -= step * f64::min(deceleration, left / lag);
            }
            prop_assert!(way <= model.distance(speed) + 2.0 * speed * step, "{way} of {}", model.distance(speed));
        }

        #[test]
        fn the_speed_for_a_distance_is_the_inverse(distance in 0.0..50.0f64) {
            let model = StoppingModel { reaction: 0.1, lag: 0.2, deceleration: 2.0 };
            prop_assert!((model.distance(model.speed_within(distance)) - distance).abs() < 1e-6);
        }
    }
}
