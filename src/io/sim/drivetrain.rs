use super::NoiseModel;
use super::autopilot::Autopilot;
use super::course::Course;
use super::drive_errors::DriveErrors;
use super::drive_mechanics::{AHEAD, Drift, Mechanics};
use super::wheels::{WheelSpec, Wheels};
use crate::geometry::{Pose, Twist};
use crate::io::Result;
use crate::kinematics::{Differential, Displacement, Omni, PlanarMotion, PlanarTwist, WheelSpeeds};
use crate::random::Stream;
use crate::world::MotorSpec;

/// Speeds of a robot from those of its `N` wheels, and back. Rolls and displacements relate likewise.
pub(super) trait WheelModel<const N: usize> {
    fn wheels(&self, twist: Twist) -> [f64; N];

    /// The wheel speeds of the nearest twist that needs none above `limit`.
    fn wheels_limited(&self, twist: Twist, limit: f64) -> [f64; N];

    fn twist(&self, wheels: [f64; N]) -> Twist;
}

impl WheelModel<2> for Differential {
    fn wheels(&self, twist: Twist) -> [f64; 2] {
        let WheelSpeeds { left, right } = self.inverse(twist);
        [left, right]
    }

    fn wheels_limited(&self, twist: Twist, limit: f64) -> [f64; 2] {
        let WheelSpeeds { left, right } = self.inverse_limited(twist, limit);
        [left, right]
    }

    fn twist(&self, [left, right]: [f64; 2]) -> Twist {
        self.forward(WheelSpeeds { left, right })
    }
}

impl WheelModel<4> for Omni<4> {
    fn wheels(&self, twist: Twist) -> [f64; 4] {
        self.inverse(twist.into())
    }

    fn wheels_limited(&self, twist: Twist, limit: f64) -> [f64; 4] {
        self.inverse_limited(twist.into(), limit)
    }

    fn twist(&self, wheels: [f64; 4]) -> Twist {
        let PlanarTwist { forward, angular, .. } = self.forward(wheels);
        Twist::new(forward, angular)
    }
}

/// Driven wheels that do not steer: commands in, true motion and encoder counts out.
///
/// The true motion differs from the wheels' roll by the true wheel radii, the true track and slip.
#[derive(Debug, Clone)]
pub(super) struct Drivetrain<M, const N: usize> {
    nominal: M,
    wheels: Wheels<N>,
    autopilot: Autopilot<N>,
    odometry: Course,
    errors: DriveErrors<N>,
}

/// Two wheels side by side.
pub(super) type TwoWheels = Drivetrain<Differential, 2>;

/// Four Mecanum wheels. The v-omega interface drives them like two wheels; sideways motion needs motor
/// commands.
pub(super) type MecanumWheels = Drivetrain<Omni<4>, 4>;

impl<M: WheelModel<N>, const N: usize> Drivetrain<M, N> {
    fn of(
        nominal: M,
        wheels: &WheelSpec,
        motor: MotorSpec,
        ideal_encoders: bool,
        errors: DriveErrors<N>,
    ) -> Self {
        Self {
            nominal,
            wheels: Wheels::new(wheels, motor, ideal_encoders),
            autopilot: Autopilot::new(),
            odometry: Course::new(Pose::default()),
            errors,
        }
    }

    /// Roll of each wheel in a motion along one arc.
    fn rolls_for(&self, motion: Displacement) -> [f64; N] {
        self.nominal.wheels(Twist::new(motion.length, motion.angle))
    }
}

impl TwoWheels {
    pub(super) fn new(
        nominal: Differential,
        wheels: &WheelSpec,
        motor: MotorSpec,
        noise: &NoiseModel,
        ideal_encoders: bool,
        stream: Stream,
    ) -> Self {
        Self::of(nominal, wheels, motor, ideal_encoders, DriveErrors::of_two_wheels(noise, stream))
    }

    /// Lets the motors follow their commands for some ticks.
    pub(super) fn run(&mut self, drifts: &mut [Drift]) {
        let mut rolls = [[0.0; 2]; AHEAD];
        let rolls = &mut rolls[..drifts.len()];
        for (rolled, drift) in rolls.iter_mut().zip(&mut *drifts) {
            let command = self.autopilot.command(&self.wheels);
            drift.is_driving = self.autopilot.is_driving();
            if self.wheels.rest(&command) {
                continue;
            }
            *rolled = self.wheels.follow(command);
            let [left, right] = self.wheels.measure();
            if left != 0.0 || right != 0.0 {
                self.odometry.advance(self.nominal.displacement(left, right).into());
            }
        }
        self.errors.slip(rolls);
        for (drift, &travel) in drifts.iter_mut().zip(&*rolls) {
            drift.motion = self.errors.motion(self.nominal.track, travel).into();
        }
    }
}

impl MecanumWheels {
    pub(super) fn new(
        nominal: Omni<4>,
        wheels: &WheelSpec,
        motor: MotorSpec,
        noise: &NoiseModel,
        ideal_encoders: bool,
        stream: Stream,
    ) -> Self {
        Self::of(nominal, wheels, motor, ideal_encoders, DriveErrors::of_four_wheels(noise, stream))
    }

    /// Lets the motors follow their commands for one tick; returns the robot's true motion.
    pub(super) fn step(&mut self) -> PlanarMotion {
        let command = self.autopilot.command(&self.wheels);
        if self.wheels.rest(&command) {
            return PlanarMotion::default();
        }
        let mut rolled = self.wheels.follow(command);
        let counted = self.wheels.measure();
        if counted != [0.0; 4] {
            self.odometry.advance(self.nominal.displacement(counted));
        }
        self.errors.slip(std::slice::from_mut(&mut rolled));
        let motion = self.nominal.displacement(rolled);
        let [length, angle] = self.errors.command_factors();
        PlanarMotion {
            forward: motion.forward * length,
            left: motion.left * length,
            // A larger wheel distance than described reduces the turn.
            angle: motion.angle * angle / self.errors.size(),
        }
    }
}

impl<M: WheelModel<N>, const N: usize> Mechanics for Drivetrain<M, N> {
    fn begin_command(&mut self) {
        self.errors.begin_command();
    }

    fn set_twist(&mut self, twist: Twist) {
        self.autopilot.set_speeds(self.nominal.wheels_limited(twist, self.wheels.speed_limit()));
    }

    fn least_seconds(&self, motion: Displacement, speed: f64) -> Result<f64> {
        Ok(Autopilot::least_seconds(&self.wheels, self.rolls_for(motion), motion, speed))
    }

    fn start(&mut self, motion: Displacement, speed: f64) {
        self.autopilot.start(&self.wheels, self.rolls_for(motion), motion, speed);
    }

    fn set_motor(&mut self, motor: usize, fraction: f64) {
        self.autopilot.set_motor(motor, fraction * self.wheels.speed_limit());
    }

    fn motors(&self) -> usize {
        N
    }

    fn is_done(&self) -> bool {
        self.autopilot.is_done()
    }

    fn is_driving(&self) -> bool {
        self.autopilot.is_driving()
    }

    fn remaining(&self) -> f64 {
        self.autopilot.remaining(&self.wheels)
    }

    fn twist(&self) -> Twist {
        self.nominal.twist(self.wheels.speeds())
    }

    fn odometry(&self) -> Pose {
        self.odometry.pose()
    }

    fn set_odometry(&mut self, pose: Pose) {
        self.odometry = Course::new(pose);
    }

    fn count(&self, motor: usize) -> i64 {
        self.wheels.count(motor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::units;
    use crate::io::sim::TICK;
    use crate::kinematics::{advance, advance_planar};
    use proptest::prelude::*;

    fn s4(ideal_encoders: bool) -> TwoWheels {
        let wheels =
            WheelSpec { diameter: 0.054, max_speed: units::from_deg(3600.0), ticks_per_turn: 1100.0 };
        let (noise, stream) = (NoiseModel::ideal(), Stream::new(1));
        TwoWheels::new(
            Differential { track: 0.09 },
            &wheels,
            MotorSpec::default(),
            &noise,
            ideal_encoders,
            stream,
        )
    }

    /// Runs a manoeuvre to its end; returns the true pose and the duration (s).
    fn run(drive: &mut TwoWheels, motion: Displacement, speed: f64) -> (Pose, f64) {
        drive.start(motion, speed);
        let mut pose = Pose::default();
        let mut ticks = 0;
        let mut step = |drive: &mut TwoWheels| {
            let mut drift = [Drift::default()];
            drive.run(&mut drift);
            pose = advance_planar(pose, drift[0].motion);
        };
        while !drive.is_done() {
            step(drive);
            ticks += 1;
            assert!(ticks < 100_000, "never done: {motion:?} at {speed}");
        }
        for _ in 0..300 {
            step(drive);
        }
        (pose, f64::from(ticks) * TICK)
    }

    proptest! {
        #![proptest_config(crate::testing::cases(64))]
        #[test]
        fn manoeuvres_end_where_they_should(
            length in -1.0..1.0f64, angle in -6.0..6.0f64, speed in 0.05..0.5f64, ideal: bool,
        ) {
            let motion = Displacement { length, angle };
            let (pose, _) = run(&mut s4(ideal), motion, speed);
            let goal = advance(Pose::default(), motion);
            // An encoder tick is 0.15 mm; one tick of both wheels is 0.2 degrees.
            let (position, heading) = if ideal { (1e-3, 0.1) } else { (4e-3, 0.3) };
            let turned = crate::geometry::angle_difference(pose.heading, goal.heading).abs();
            prop_assert!((pose.position() - goal.position()).norm() < position, "{pose:?} {goal:?}");
            prop_assert!(units::to_deg(turned) < heading, "{pose:?} {goal:?}");
        }
    }

    #[test]
    fn a_manoeuvre_takes_about_as_long_as_it_must() {
        let (_, seconds) = run(&mut s4(false), Displacement { length: 1.0, angle: 0.0 }, 0.2);
        assert!((5.0..5.8).contains(&seconds), "{seconds}");
    }
}
