use super::course::Course;
use super::{NoiseModel, TICK};
use crate::geometry::{Pose, Twist, math};
use crate::io::Result;
use crate::kinematics::{Differential, Displacement, WheelSpeeds};
use crate::random::Stream;
use crate::world::MotorSpec;

/// Two wheels on their motors: commands in, true motion and encoder counts out.
///
/// A wheel's *roll* is what its shaft turned, times the nominal radius: the encoder's truth. What the robot really
/// moves differs by the wheel's true radius, the true track and slip.
#[derive(Debug, Clone)]
pub(super) struct Drivetrain {
    nominal: Differential,
    limit: f64,
    motor: MotorSpec,
    /// The part of a speed difference that the lag leaves after one tick.
    decay: f64,
    /// Metres of roll in an encoder tick, and its inverse.
    tick_length: f64,
    ticks_per_metre: f64,
    ideal_encoders: bool,
    speeds: [f64; 2],
    roll: [f64; 2],
    /// Encoder counts, and the roll that they stand for.
    counts: [i64; 2],
    measured: [f64; 2],
    odometry: Course,
    errors: DriveErrors,
    stream: Stream,
}

/// One robot's deviations from its description.
#[derive(Debug, Clone)]
struct DriveErrors {
    wheel: [f64; 2],
    actual: Differential,
    slip: f64,
    command: f64,
    /// Factors of length and angle for the running command.
    command_factors: [f64; 2],
}

/// The parts of a differential drive's description.
#[derive(Debug, Clone, Copy)]
pub(super) struct DifferentialSpec {
    pub(super) wheel_diameter: f64,
    pub(super) track: f64,
    pub(super) max_wheel_speed: f64,
    pub(super) ticks_per_turn: f64,
}

impl Drivetrain {
    pub(super) fn new(
        spec: &DifferentialSpec,
        motor: MotorSpec,
        noise: &NoiseModel,
        ideal_encoders: bool,
        mut stream: Stream,
    ) -> Self {
        let scale = noise.wheel_scale * stream.normal();
        let mismatch = 0.5 * noise.wheel_mismatch * stream.normal();
        let track = spec.track * positive(1.0 + noise.track * stream.normal());
        let lag = motor.time_constant;
        let tick_length = std::f64::consts::PI * spec.wheel_diameter / spec.ticks_per_turn;
        Self {
            nominal: Differential { track: spec.track },
            limit: 0.5 * spec.wheel_diameter * spec.max_wheel_speed,
            motor,
            decay: if lag > 0.0 { math::exp(-TICK / lag) } else { 0.0 },
            tick_length,
            ticks_per_metre: 1.0 / tick_length,
            ideal_encoders,
            speeds: [0.0; 2],
            roll: [0.0; 2],
            counts: [0; 2],
            measured: [0.0; 2],
            odometry: Course::new(Pose::default()),
            errors: DriveErrors {
                wheel: [1.0 + scale - mismatch, 1.0 + scale + mismatch].map(positive),
                actual: Differential { track },
                slip: noise.slip,
                command: noise.command,
                command_factors: [1.0; 2],
            },
            stream,
        }
    }

    /// Draws the errors of a new drive command.
    pub(super) fn begin_command(&mut self) {
        if self.errors.command > 0.0 {
            for factor in &mut self.errors.command_factors {
                *factor = 1.0 + self.errors.command * self.stream.normal();
            }
        }
    }

    /// Lets the motors follow their commanded rim speeds for one tick and returns the robot's true motion.
    pub(super) fn step(&mut self, command: [f64; 2]) -> Displacement {
        if command == [0.0; 2] && self.speeds == [0.0; 2] {
            return Displacement::default();
        }
        let rolled = self.follow(command);
        self.measure();
        let [left, right] = [0, 1].map(|wheel| self.ground_travel(wheel, rolled[wheel]));
        let motion = self.errors.actual.displacement(left, right);
        let [length, angle] = self.errors.command_factors;
        Displacement { length: motion.length * length, angle: motion.angle * angle }
    }

    /// Moves wheel speeds towards the command and returns how far each wheel rolled.
    fn follow(&mut self, command: [f64; 2]) -> [f64; 2] {
        let change = [0, 1].map(|w| (command[w] - self.speeds[w]) * (1.0 - self.decay));
        let largest = change[0].abs().max(change[1].abs());
        let allowed = self.motor.max_acceleration * TICK;
        // Both wheels are held back alike, so that a limit does not bend the path.
        let scale = if largest > allowed { allowed / largest } else { 1.0 };
        [0, 1].map(|w| {
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

    /// Advances odometry by what the encoders counted in this tick.
    fn measure(&mut self) {
        let before = self.measured;
        for wheel in [0, 1] {
            let roll = self.roll[wheel];
            self.counts[wheel] = floor(roll * self.ticks_per_metre);
            let counted = self.counts[wheel] as f64 * self.tick_length;
            self.measured[wheel] = if self.ideal_encoders { roll } else { counted };
        }
        let [left, right] = [self.measured[0] - before[0], self.measured[1] - before[1]];
        if left != 0.0 || right != 0.0 {
            self.odometry.advance(self.nominal.displacement(left, right));
        }
    }

    /// What a wheel that rolled so far moves over the ground.
    fn ground_travel(&mut self, wheel: usize, rolled: f64) -> f64 {
        let travel = rolled * self.errors.wheel[wheel];
        if self.errors.slip == 0.0 || rolled == 0.0 {
            return travel;
        }
        travel + self.errors.slip * travel.abs().sqrt() * self.stream.normal()
    }

    /// The rim speeds for a twist, within what the wheels can do.
    pub(super) fn wheels_for(&self, twist: Twist) -> WheelSpeeds {
        self.nominal.inverse_limited(twist, self.limit)
    }

    /// How far each wheel rolls in a motion along one arc.
    pub(super) fn rolls_for(&self, motion: Displacement) -> [f64; 2] {
        let wheels = self.nominal.inverse(Twist::new(motion.length, motion.angle));
        [wheels.left, wheels.right]
    }

    /// What the encoders say that each wheel has rolled.
    pub(super) fn measured(&self) -> [f64; 2] {
        self.measured
    }

    pub(super) fn speeds(&self) -> [f64; 2] {
        self.speeds
    }

    pub(super) fn speed_limit(&self) -> f64 {
        self.limit
    }

    /// The part of a speed difference that one tick leaves.
    pub(super) fn decay(&self) -> f64 {
        self.decay
    }

    /// The smallest roll that matters to a controller: half an encoder tick.
    pub(super) fn resolution(&self) -> f64 {
        if self.ideal_encoders { 5e-5 } else { 0.5 * self.tick_length }
    }

    /// An encoder's count since the start.
    pub(super) fn count(&self, wheel: usize) -> i64 {
        self.counts[wheel]
    }

    /// The largest change of a wheel's rim speed, in m/s².
    pub(super) fn max_acceleration(&self) -> f64 {
        self.motor.max_acceleration
    }

    /// The shortest time that a motion along one arc takes at a speed, which the wheels may not reach.
    pub(super) fn least_seconds(&self, motion: Displacement, speed: f64) -> f64 {
        let farther = self.rolls_for(motion).into_iter().map(f64::abs).fold(0.0, f64::max);
        let whole = if motion.length == 0.0 { motion.angle } else { motion.length };
        (whole / speed).abs().max(farther / self.limit)
    }

    pub(super) fn twist(&self) -> Twist {
        self.nominal.forward(WheelSpeeds { left: self.speeds[0], right: self.speeds[1] })
    }

    pub(super) fn odometry(&self) -> Pose {
        self.odometry.pose()
    }

    pub(super) fn set_odometry(&mut self, pose: Pose) -> Result<()> {
        if !pose.is_finite() {
            return Err(crate::io::Error::invalid_input("pose", format!("{pose:?}"), "finite numbers"));
        }
        self.odometry = Course::new(pose);
        Ok(())
    }
}

/// A factor that the strongest noise could make negative; a wheel or an axle stays one.
fn positive(factor: f64) -> f64 {
    factor.max(0.1)
}

/// The largest whole number up to `x`, without a call to the platform's library.
fn floor(x: f64) -> i64 {
    let whole = x as i64;
    whole - i64::from(x < whole as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn drivetrain(noise: &NoiseModel, seed: u64) -> Drivetrain {
        let spec = DifferentialSpec {
            wheel_diameter: 0.05,
            track: 0.1,
            max_wheel_speed: 60.0,
            ticks_per_turn: 500.0,
        };
        Drivetrain::new(&spec, MotorSpec::default(), noise, false, Stream::new(seed))
    }

    proptest! {
        #[test]
        fn floors_are_floors(x in -1e9..1e9f64) {
            prop_assert_eq!(floor(x) as f64, x.floor());
            prop_assert_eq!(floor(x.round()) as f64, x.round());
        }

        #[test]
        fn counts_are_whole_ticks_below_the_roll(speeds in prop::collection::vec(-1.0..1.0f64, 1..200)) {
            let mut drive = drivetrain(&NoiseModel::ideal(), 1);
            for speed in speeds {
                drive.step([speed, -speed]);
                for wheel in [0, 1] {
                    let ahead = drive.roll[wheel] - drive.measured()[wheel];
                    prop_assert!(ahead > -1e-12 && ahead < drive.tick_length + 1e-12, "{ahead}");
                }
            }
        }
    }

    #[test]
    fn standing_wheels_draw_no_random_numbers() {
        let mut drive = drivetrain(&NoiseModel::real(), 1);
        let mut before = drive.stream.clone();
        assert_eq!(drive.step([0.0; 2]), Displacement::default());
        assert_eq!(drive.stream.bits(), before.bits());
    }

    #[test]
    fn the_strongest_noise_leaves_wheels_and_a_track() {
        let strongest =
            NoiseModel { wheel_scale: 1.0, wheel_mismatch: 1.0, track: 1.0, ..NoiseModel::ideal() };
        for seed in 0..200 {
            let errors = drivetrain(&strongest, seed).errors;
            assert!(errors.wheel.iter().all(|&factor| factor >= 0.1) && errors.actual.track >= 0.01);
        }
    }
}
