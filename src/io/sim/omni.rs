use super::NoiseModel;
use super::autopilot::Autopilot;
use super::course::Course;
use super::drive_errors::DriveErrors;
use super::drive_mechanics::Mechanics;
use super::wheels::{WheelSpec, Wheels};
use crate::geometry::{Pose, Twist};
use crate::io::Result;
use crate::kinematics::{Displacement, Omni, PlanarMotion, PlanarTwist};
use crate::random::Stream;
use crate::world::MotorSpec;

/// Four Mecanum wheels. The v-omega interface drives them like two wheels; sideways motion needs motor
/// commands.
#[derive(Debug, Clone)]
pub(super) struct OmniDrive {
    nominal: Omni<4>,
    wheels: Wheels<4>,
    autopilot: Autopilot<4>,
    odometry: Course,
    errors: DriveErrors<4>,
}

impl OmniDrive {
    pub(super) fn new(
        nominal: Omni<4>,
        wheels: &WheelSpec,
        motor: MotorSpec,
        noise: &NoiseModel,
        ideal_encoders: bool,
        stream: Stream,
    ) -> Self {
        Self {
            nominal,
            wheels: Wheels::new(wheels, motor, ideal_encoders),
            autopilot: Autopilot::new(),
            odometry: Course::new(Pose::default()),
            errors: DriveErrors::of_four_wheels(noise, stream),
        }
    }

    /// Lets the motors follow their commands for one tick; returns the robot's true motion.
    pub(super) fn step(&mut self) -> PlanarMotion {
        let command = self.autopilot.command(&self.wheels);
        if self.wheels.rest(&command) {
            return PlanarMotion::default();
        }
        let rolled = self.wheels.follow(command);
        let counted = self.wheels.measure();
        if counted != [0.0; 4] {
            self.odometry.advance(self.nominal.displacement(counted));
        }
        let motion = self.nominal.displacement(self.errors.ground_travel(rolled));
        let [length, angle] = self.errors.command_factors();
        PlanarMotion {
            forward: motion.forward * length,
            left: motion.left * length,
            // A larger wheel distance than described reduces the turn.
            angle: motion.angle * angle / self.errors.size(),
        }
    }

    fn rolls_for(&self, motion: Displacement) -> [f64; 4] {
        self.nominal.inverse(PlanarTwist::new(motion.length, 0.0, motion.angle))
    }
}

impl Mechanics for OmniDrive {
    fn begin_command(&mut self) {
        self.errors.begin_command();
    }

    fn set_twist(&mut self, twist: Twist) {
        self.autopilot.set_speeds(self.nominal.inverse_limited(twist.into(), self.wheels.speed_limit()));
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
        4
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
        let twist = self.nominal.forward(self.wheels.speeds());
        Twist::new(twist.forward, twist.angular)
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
