use super::TICK;
use crate::geometry::math;
use crate::world::MotorSpec;

/// Wheels with their motors: rim speed commands in, roll and encoder counts out.
///
/// A wheel's *roll* is the rotation of its shaft times the nominal radius, which is what its encoder
/// measures.
#[derive(Debug, Clone)]
pub(super) struct Wheels<const N: usize> {
    limit: f64,
    motor: MotorSpec,
    /// Fraction of a speed difference that remains after one tick.
    decay: f64,
    /// Roll per encoder tick (m), and its inverse.
    tick_length: f64,
    ticks_per_metre: f64,
    ideal_encoders: bool,
    speeds: [f64; N],
    roll: [f64; N],
    /// Encoder counts, and the corresponding roll.
    counts: [i64; N],
    measured: [f64; N],
}

/// Description of a drive's wheels, which are identical.
#[derive(Debug, Clone, Copy)]
pub(super) struct WheelSpec {
    pub(super) diameter: f64,
    pub(super) max_speed: f64,
    pub(super) ticks_per_turn: f64,
}

impl WheelSpec {
    /// Of a robot without wheels.
    pub(super) const NONE: Self = Self { diameter: 0.0, max_speed: 0.0, ticks_per_turn: 1.0 };

    /// The fastest rim speed.
    pub(super) fn limit(&self) -> f64 {
        0.5 * self.diameter * self.max_speed
    }
}

impl<const N: usize> Wheels<N> {
    pub(super) fn new(spec: &WheelSpec, motor: MotorSpec, ideal_encoders: bool) -> Self {
        let lag = motor.time_constant;
        let tick_length = std::f64::consts::PI * spec.diameter / spec.ticks_per_turn;
        Self {
            limit: spec.limit(),
            motor,
            decay: if lag > 0.0 { math::exp(-TICK / lag) } else { 0.0 },
            tick_length,
            ticks_per_metre: 1.0 / tick_length,
            ideal_encoders,
            speeds: [0.0; N],
            roll: [0.0; N],
            counts: [0; N],
            measured: [0.0; N],
        }
    }

    /// Whether the wheels are at rest and are to stay so.
    pub(super) fn rest(&self, command: &[f64; N]) -> bool {
        *command == [0.0; N] && self.speeds == [0.0; N]
    }

    /// Lets the motors follow their rim speed commands for one tick; returns the roll of each wheel.
    pub(super) fn follow(&mut self, command: [f64; N]) -> [f64; N] {
        let change: [f64; N] = std::array::from_fn(|w| (command[w] - self.speeds[w]) * (1.0 - self.decay));
        let largest = change.iter().fold(0.0, |most: f64, change| most.max(change.abs()));
        let allowed = self.motor.max_acceleration * TICK;
        // All wheels are limited by the same factor, so that the limit does not bend the path.
        let scale = if largest > allowed { allowed / largest } else { 1.0 };
        std::array::from_fn(|w| {
            let before = self.speeds[w];
            let mut after = before + scale * change[w];
            if command[w] == 0.0 && after.abs() < 1e-6 {
                after = 0.0;
            }
            self.speeds[w] = after;
            let rolled = 0.5 * (before + after) * TICK;
            self.roll[w] += rolled;
            rolled
        })
    }

    /// Takes over the rim speeds and the roll of a tick.
    pub(super) fn turn(&mut self, speeds: [f64; N], rolled: [f64; N]) {
        self.speeds = speeds;
        for (roll, rolled) in self.roll.iter_mut().zip(rolled) {
            *roll += rolled;
        }
    }

    /// Measured roll of each wheel in this tick (m).
    pub(super) fn measure(&mut self) -> [f64; N] {
        std::array::from_fn(|wheel| {
            let (before, roll) = (self.measured[wheel], self.roll[wheel]);
            self.counts[wheel] = floor(roll * self.ticks_per_metre);
            let counted = self.counts[wheel] as f64 * self.tick_length;
            self.measured[wheel] = if self.ideal_encoders { roll } else { counted };
            self.measured[wheel] - before
        })
    }

    /// Measured roll of each wheel since the start.
    pub(super) fn measured(&self) -> [f64; N] {
        self.measured
    }

    pub(super) fn speeds(&self) -> [f64; N] {
        self.speeds
    }

    pub(super) fn speed_limit(&self) -> f64 {
        self.limit
    }

    /// Fraction of a speed difference that remains after one tick.
    pub(super) fn decay(&self) -> f64 {
        self.decay
    }

    /// Smallest roll relevant to a controller: half an encoder tick.
    pub(super) fn resolution(&self) -> f64 {
        if self.ideal_encoders { 5e-5 } else { 0.5 * self.tick_length }
    }

    /// Encoder count since the start.
    pub(super) fn count(&self, wheel: usize) -> i64 {
        self.counts[wheel]
    }

    /// Largest change of a wheel's rim speed (m/s²).
    pub(super) fn max_acceleration(&self) -> f64 {
        self.motor.max_acceleration
    }
}

/// Largest integer up to `x`, without a call to the platform's library.
fn floor(x: f64) -> i64 {
    let whole = x as i64;
    whole - i64::from(x < whole as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn floors_are_floors(x in -1e9..1e9f64) {
            prop_assert_eq!(floor(x) as f64, x.floor());
            prop_assert_eq!(floor(x.round()) as f64, x.round());
        }

        #[test]
        fn counts_are_whole_ticks_below_the_roll(speeds in prop::collection::vec(-1.0..1.0f64, 1..200)) {
            let spec = WheelSpec { diameter: 0.05, max_speed: 60.0, ticks_per_turn: 500.0 };
            let mut wheels = Wheels::<2>::new(&spec, MotorSpec::default(), false);
            for speed in speeds {
                wheels.follow([speed, -speed]);
                wheels.measure();
                for wheel in [0, 1] {
                    let ahead = wheels.roll[wheel] - wheels.measured()[wheel];
                    prop_assert!(ahead > -1e-12 && ahead < wheels.tick_length + 1e-12, "{ahead}");
                }
            }
        }
    }

    #[test]
    fn wheels_lag_behind_their_command() {
        let spec = WheelSpec { diameter: 0.05, max_speed: 60.0, ticks_per_turn: 500.0 };
        let mut wheels = Wheels::new(&spec, MotorSpec::default(), true);
        for _ in 0..20 {
            wheels.follow([0.1, 0.1]);
        }
        // After one time constant of 0.2 s: 63 %.
        assert!((wheels.speeds()[0] - 0.0632).abs() < 0.0005, "{:?}", wheels.speeds());
    }
}
