use super::autopilot::Autopilot;
use super::course::Course;
use super::drive_errors::DriveErrors;
use super::drive_mechanics::Mechanics;
use super::wheels::{WheelSpec, Wheels};
use super::{NoiseModel, TICK};
use crate::geometry::{Pose, Twist, units};
use crate::io::{Error, ErrorKind, Result};
use crate::kinematics::{Ackermann, CarState, Differential, Displacement};
use crate::random::Stream;
use crate::world::MotorSpec;

/// A car: motor 1 drives the rear axle through a differential gear, servo 1 steers the front wheels.
///
/// Its odometry takes the axle's roll from the motor's encoder and the direction from the steering. Errors are those of
/// the rear wheels, as on a robot with two wheels.
#[derive(Debug, Clone)]
pub(super) struct Car {
    nominal: Ackermann,
    axle: Differential,
    wheels: Wheels<1>,
    autopilot: Autopilot<1>,
    /// The steering angle, and where the servo is to bring it.
    steering: f64,
    wanted: f64,
    odometry: Course,
    errors: DriveErrors<2>,
}

/// Degrees per second at which a servo turns the wheels.
const STEERING_RATE: f64 = 30.0;

impl Car {
    pub(super) fn new(
        nominal: Ackermann,
        track: f64,
        wheels: &WheelSpec,
        motor: MotorSpec,
        noise: &NoiseModel,
        ideal_encoders: bool,
        stream: Stream,
    ) -> Self {
        Self {
            nominal,
            axle: Differential { track },
            wheels: Wheels::new(wheels, motor, ideal_encoders),
            autopilot: Autopilot::new(),
            steering: 0.0,
            wanted: 0.0,
            odometry: Course::new(Pose::default()),
            errors: DriveErrors::of_two_wheels(noise, stream),
        }
    }

    /// Lets motor and servo follow their commands for one tick and returns the robot's true motion.
    pub(super) fn step(&mut self) -> Displacement {
        // A manoeuvre starts when the wheels point where it needs them.
        let aims = self.steering != self.wanted && !self.autopilot.is_done();
        let command = if aims { [0.0] } else { self.autopilot.command(&self.wheels) };
        let steering = self.steer();
        if self.wheels.rest(&command) {
            return Displacement::default();
        }
        let [rolled] = self.wheels.follow(command);
        let [counted] = self.wheels.measure();
        if counted != 0.0 {
            self.odometry.advance(self.nominal.displacement(counted, steering).into());
        }
        let motion = self.nominal.displacement(rolled, steering);
        let rear = self.axle.inverse(Twist::new(motion.length, motion.angle));
        self.errors.motion(self.axle.track * self.errors.size(), [rear.left, rear.right])
    }

    /// Turns the front wheels for one tick. Returns their mean angle in it.
    fn steer(&mut self) -> f64 {
        let most = units::from_deg(STEERING_RATE) * TICK;
        let before = self.steering;
        let missing = self.wanted - before;
        self.steering = if missing.abs() <= most { self.wanted } else { before + most.copysign(missing) };
        0.5 * (before + self.steering)
    }

    fn set_state(&mut self, state: CarState) {
        self.wanted = state.steering;
        self.autopilot.set_speeds([state.speed]);
    }
}

impl Mechanics for Car {
    fn begin_command(&mut self) {
        self.errors.begin_command();
    }

    fn set_twist(&mut self, twist: Twist) {
        let state = self.nominal.inverse_limited(twist, self.wheels.speed_limit());
        // A car that is to stand keeps its wheels as they are.
        let steering = if twist == Twist::STOP { self.wanted } else { state.steering };
        self.set_state(CarState { steering, ..state });
    }

    fn least_seconds(&self, motion: Displacement, speed: f64) -> Result<f64> {
        if motion.length == 0.0 && motion.angle != 0.0 {
            return Err(Error::new(ErrorKind::Unsupported, "a car cannot turn on the spot"));
        }
        if self.nominal.inverse(Twist::new(motion.length, motion.angle)).is_none() {
            let tightest = self.nominal.turning_radius();
            let found = format!("{} m in radius", (motion.length / motion.angle).abs());
            return Err(Error::invalid_input(
                "arc",
                found,
                &format!("at least {tightest} m, the turning circle"),
            ));
        }
        Ok(Autopilot::least_seconds(&self.wheels, [motion.length], motion, speed))
    }

    fn start(&mut self, motion: Displacement, speed: f64) {
        if motion.length != 0.0 {
            self.wanted = self.nominal.steering_for(motion.angle / motion.length);
        }
        self.autopilot.start(&self.wheels, [motion.length], motion, speed);
    }

    fn set_motor(&mut self, motor: usize, fraction: f64) {
        self.autopilot.set_motor(motor, fraction * self.wheels.speed_limit());
    }

    fn servos(&self) -> u8 {
        1
    }

    fn set_servo(&mut self, servo: u8, position: f64) -> Result<()> {
        if servo != 1 {
            return Err(Error::unsupported(format!("servo {servo}")));
        }
        if !(-1.0..=1.0).contains(&position) {
            return Err(Error::invalid_input("servo position", position, "-1 to 1"));
        }
        // Servos count to the right, angles to the left.
        self.wanted = -position * self.nominal.max_steering();
        Ok(())
    }

    fn motors(&self) -> usize {
        1
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
        let [speed] = self.wheels.speeds();
        self.nominal.forward(CarState { speed, steering: self.steering })
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
