use super::autopilot::Autopilot;
use super::bicycle::Bicycle;
use super::course::Course;
use super::drive_errors::DriveErrors;
use super::drive_mechanics::Mechanics;
use super::wheels::{WheelSpec, Wheels};
use super::{NoiseModel, SERVO_RATE, TICK};
use crate::geometry::{Pose, Twist, units};
use crate::io::{Error, ErrorKind, Result};
use crate::kinematics::{Ackermann, CarState, Differential, Displacement, PlanarMotion, PlanarTwist};
use crate::random::Stream;
use crate::world::MotorSpec;

/// A car: motor 1 drives the rear axle through a differential gear, servo 1 steers the front wheels.
///
/// Odometry takes the axle's roll from the motor's encoder and the direction from the steering. Errors are
/// those of the rear wheels, as on a two-wheeled robot. A fast car with [dynamics](Bicycle) moves by mass and
/// tyre forces, and a gyroscope measures its rotation.
#[derive(Debug, Clone)]
pub(super) struct Car {
    nominal: Ackermann,
    axle: Differential,
    wheels: Wheels<1>,
    autopilot: Autopilot<1>,
    /// The steering angle and its target.
    steering: f64,
    wanted: f64,
    odometry: Course,
    errors: DriveErrors<2>,
    bicycle: Option<Bicycle>,
    /// Odometry measurement of a fast car.
    measured: Twist,
}

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
            bicycle: None,
            measured: Twist::STOP,
        }
    }

    /// The same car with mass and tyres, if there are any.
    pub(super) fn with_dynamics(self, bicycle: Option<Bicycle>) -> Self {
        Self { bicycle, ..self }
    }

    /// Lets motor and servo follow their commands for one tick; returns the robot's true motion without
    /// obstacles.
    pub(super) fn step(&mut self) -> PlanarMotion {
        // A manoeuvre starts once the wheels have its steering angle.
        let aims = self.steering != self.wanted && !self.autopilot.is_done();
        let command = if aims { [0.0] } else { self.autopilot.command(&self.wheels) };
        let before = self.steering;
        let steering = self.steer();
        if let Some(bicycle) = &mut self.bicycle {
            let [speed, angle] = self.errors.command_factors();
            let motion = bicycle.step(command[0] * speed, [before * angle, self.steering * angle]);
            if motion == PlanarMotion::default() {
                self.settle(motion);
            }
            return motion;
        }
        self.roll(command, steering).into()
    }

    /// Lets wheels that never slip follow a command.
    fn roll(&mut self, command: [f64; 1], steering: f64) -> Displacement {
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
        let mut travel = [rear.left, rear.right];
        self.errors.slip(std::slice::from_mut(&mut travel));
        self.errors.motion(self.axle.track, travel)
    }

    /// Records the car's true motion in this tick.
    pub(super) fn settle(&mut self, moved: PlanarMotion) {
        let Some(bicycle) = &mut self.bicycle else { return };
        self.measured = bicycle.settle(moved);
        let motion = PlanarTwist::from(self.measured).during(TICK);
        self.wheels.turn([bicycle.speed()], [motion.forward]);
        self.wheels.measure();
        self.odometry.advance(motion);
    }

    /// Turns the front wheels for one tick; returns their mean angle.
    fn steer(&mut self) -> f64 {
        let rate = self.bicycle.as_ref().map_or(units::from_deg(SERVO_RATE), Bicycle::steering_rate);
        let most = rate * TICK;
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
        // A stop command keeps the steering angle.
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
        // Servo positions count to the right, angles to the left.
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
        if self.bicycle.is_some() {
            return self.measured;
        }
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
