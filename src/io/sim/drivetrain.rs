use super::NoiseModel;
use super::autopilot::Autopilot;
use super::course::Course;
use super::drive_errors::DriveErrors;
use super::drive_mechanics::Mechanics;
use super::wheels::{WheelSpec, Wheels};
use crate::geometry::{Pose, Twist};
use crate::io::Result;
use crate::kinematics::{Differential, Displacement, WheelSpeeds};
use crate::random::Stream;
use crate::world::MotorSpec;

/// Two driven wheels side by side: commands in, true motion and encoder counts out.
///
/// The true motion differs from the wheels' roll by the true wheel radii, the true track and slip.
#[derive(Debug, Clone)]
pub(super) struct Drivetrain {
    nominal: Differential,
    actual: Differential,
    wheels: Wheels<2>,
    autopilot: Autopilot<2>,
    odometry: Course,
    errors: DriveErrors<2>,
}

impl Drivetrain {
    pub(super) fn new(
        nominal: Differential,
        wheels: &WheelSpec,
        motor: MotorSpec,
        noise: &NoiseModel,
        ideal_encoders: bool,
        stream: Stream,
    ) -> Self {
        let errors = DriveErrors::of_two_wheels(noise, stream);
        Self {
            nominal,
            actual: Differential { track: nominal.track * errors.size() },
            wheels: Wheels::new(wheels, motor, ideal_encoders),
            autopilot: Autopilot::new(),
            odometry: Course::new(Pose::default()),
            errors,
        }
    }

    /// Lets the motors follow their commands for one tick; returns the robot's true motion.
    pub(super) fn step(&mut self) -> Displacement {
        let command = self.autopilot.command(&self.wheels);
        if self.wheels.rest(&command) {
            return Displacement::default();
        }
        let rolled = self.wheels.follow(command);
        let [left, right] = self.wheels.measure();
        if left != 0.0 || right != 0.0 {
            self.odometry.advance(self.nominal.displacement(left, right).into());
        }
        self.errors.motion(self.actual.track, rolled)
    }

    /// Roll of each wheel in a motion along one arc.
    fn rolls_for(&self, motion: Displacement) -> [f64; 2] {
        let wheels = self.nominal.inverse(Twist::new(motion.length, motion.angle));
        [wheels.left, wheels.right]
    }
}

impl Mechanics for Drivetrain {
    fn begin_command(&mut self) {
        self.errors.begin_command();
    }

    fn set_twist(&mut self, twist: Twist) {
        let wheels = self.nominal.inverse_limited(twist, self.wheels.speed_limit());
        self.autopilot.set_speeds([wheels.left, wheels.right]);
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
        2
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
        let [left, right] = self.wheels.speeds();
        self.nominal.forward(WheelSpeeds { left, right })
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
    use crate::kinematics::advance;
    use proptest::prelude::*;

    fn s4(ideal_encoders: bool) -> Drivetrain {
        let wheels =
            WheelSpec { diameter: 0.054, max_speed: units::from_deg(3600.0), ticks_per_turn: 1100.0 };
        let (noise, stream) = (NoiseModel::ideal(), Stream::new(1));
        Drivetrain::new(
            Differential { track: 0.09 },
            &wheels,
            MotorSpec::default(),
            &noise,
            ideal_encoders,
            stream,
        )
    }

    /// Runs a manoeuvre to its end; returns the true pose and the duration (s).
    fn run(drive: &mut Drivetrain, motion: Displacement, speed: f64) -> (Pose, f64) {
        drive.start(motion, speed);
        let mut pose = Pose::default();
        let mut ticks = 0;
        while !drive.is_done() {
            pose = advance(pose, drive.step());
            ticks += 1;
            assert!(ticks < 100_000, "never done: {motion:?} at {speed}");
        }
        for _ in 0..300 {
            pose = advance(pose, drive.step());
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
