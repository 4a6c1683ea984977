use super::a_to_b::dog_twist;
use super::{FollowerParameters, Goal, Method, Path, PathFollower, Steering};
use crate::geometry::{Point, Pose, Twist, angle_difference};
use crate::io::error::require_positive;
use crate::io::{Clock, Drive, Error, ErrorKind, Motors, Result, Servos};
use crate::kinematics::{Ackermann, CarState};

/// Speed and steering of a car as commands of its motor and its servo (book, program 7.1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarDriver {
    /// The car's geometry.
    pub kinematics: Ackermann,
    /// The rim speed of its wheels at full motor speed, in m/s.
    pub full_speed: f64,
}

/// What motor 1 and servo 1 are told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarCommand {
    /// A fraction of the motor's full speed, -1 to 1.
    pub motor: f64,
    /// The steering servo's position, -1 (full left) to 1 (full right).
    pub servo: f64,
}

impl CarDriver {
    /// The commands for a speed and a steering angle, as far as both go.
    pub fn command(&self, state: CarState) -> CarCommand {
        CarCommand {
            motor: (state.speed / self.full_speed).clamp(-1.0, 1.0),
            servo: (-state.steering / self.kinematics.max_steering()).clamp(-1.0, 1.0),
        }
    }

    /// Tells a robot to drive so.
    pub fn drive<R: Motors + Servos + ?Sized>(&self, robot: &mut R, state: CarState) -> Result<()> {
        let command = self.command(state);
        robot.set_servo(1, command.servo)?;
        robot.set_motor(1, command.motor)
    }
}

/// What [`CarToB`] goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarParameters {
    /// Speeds and steering along the path.
    pub follower: FollowerParameters,
    /// The least radius of planned paths in terms of the turning radius: more than 1, to leave room for corrections.
    pub margin: f64,
    /// The book's k of splines; more is taken where the spline would bend too tightly.
    pub spline_scale: f64,
    /// Seconds that the servo takes to turn the wheels from the middle to one side.
    pub steering_time: f64,
    /// Seconds from one control step to the next.
    pub period: f64,
}

impl Default for CarParameters {
    fn default() -> Self {
        Self {
            follower: FollowerParameters {
                speed: 0.2,
                turn_rate: 1.0,
                deceleration: 0.1,
                approach_rate: 1.2,
                lag: 0.45,
                steering: Steering::CrossTrack { reach: 0.2 },
            },
            margin: 1.15,
            spline_scale: 1.0,
            steering_time: 1.1,
            period: 0.02,
        }
    }
}

/// How a car's drive to a goal ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum CarOutcome {
    /// The car takes itself to be there.
    Reached,
    /// Something holds the car.
    Blocked,
    /// The time was over first.
    TimedOut,
}

/// Drives a car to a goal by the methods of chapter 3, within its turning circle (book, section 7.4).
///
/// What a robot that turns on the spot does in a turn, a car does on a circle, and so every plan keeps to the circle:
/// [`Method::Turn`] is a Dubins path; an arc or a spline that would be too tight becomes one. A dog curve drives straight on
/// past a goal beside it until it can turn towards it. A goal's heading is met by all; after a dog curve, by a last path.
#[derive(Debug, Clone, PartialEq)]
pub struct CarToB {
    method: Method,
    goal: Goal,
    driver: CarDriver,
    parameters: CarParameters,
    phase: Phase,
}

#[derive(Debug, Clone, PartialEq)]
enum Phase {
    Begin,
    /// Turning the wheels, standing, for so many seconds more.
    Aiming(Box<PathFollower>, f64),
    Following(Box<PathFollower>),
    Homing,
    Ended,
}

/// Metres from the goal at which the car stops.
const ARRIVED: f64 = 0.001;
/// The largest k of splines that is tried, and its steps.
const LARGEST_SCALE: f64 = 4.0;
const SCALE_STEP: f64 = 0.25;
/// Turning radii before a goal with a heading at which a dog curve hands over.
const DOG_HANDOVER: f64 = 4.0;

impl CarToB {
    /// A drive of a car to a goal in the frame of the poses that will be observed.
    pub fn new(method: Method, goal: Goal, driver: CarDriver, parameters: CarParameters) -> Result<Self> {
        goal.check()?;
        parameters.follower.validate()?;
        require_positive("full speed", driver.full_speed)?;
        require_positive("spline scale", parameters.spline_scale)?;
        require_positive("steering time", parameters.steering_time)?;
        require_positive("control period", parameters.period)?;
        if !(parameters.margin >= 1.0 && parameters.margin.is_finite()) {
            return Err(Error::invalid_input(
                "margin of the turning radius",
                parameters.margin,
                "at least 1",
            ));
        }
        Ok(Self { method, goal, driver, parameters, phase: Phase::Begin })
    }

    fn radius(&self) -> f64 {
        self.parameters.margin * self.driver.kinematics.turning_radius()
    }

    /// The path from a pose; none for a dog curve, which has no plan, and for a car that is there.
    pub fn plan(&self, pose: Pose) -> Result<Option<Path>> {
        if pose.distance_to(self.goal.position) <= ARRIVED || self.method == Method::Dog {
            return Ok(None);
        }
        let fits = |path: &Path| path.max_curvature() * self.radius() <= 1.0 + 1e-9;
        let ahead = pose.bearing_to(self.goal.position).abs() <= std::f64::consts::FRAC_PI_2;
        if self.method == Method::Arc && self.goal.heading.is_none() && ahead {
            let arc = Path::arc(pose, self.goal.position)?;
            if fits(&arc) {
                return Ok(Some(arc));
            }
        }
        if self.method == Method::Spline {
            let goal = self.goal.pose_from(pose.position());
            let mut scale = self.parameters.spline_scale;
            while scale <= LARGEST_SCALE {
                let spline = Path::hermite(pose, goal, scale)?;
                if fits(&spline) {
                    return Ok(Some(spline));
                }
                scale += SCALE_STEP;
            }
        }
        self.round_the_circle(pose).map(Some)
    }

    fn round_the_circle(&self, pose: Pose) -> Result<Path> {
        match self.goal.heading {
            Some(heading) => {
                let Point { coords, .. } = self.goal.position;
                Path::dubins(pose, Pose::new(coords.x, coords.y, heading), self.radius())
            }
            None => Path::dubins_to_point(pose, self.goal.position, self.radius()),
        }
    }

    /// Speed and steering for the car at a pose; `None` at the end.
    pub fn step(&mut self, pose: Pose) -> Result<Option<CarState>> {
        if !pose.is_finite() {
            return Err(Error::invalid_input("observed pose", format!("{pose:?}"), "finite numbers"));
        }
        if self.phase == Phase::Begin {
            self.phase = match self.plan(pose)? {
                Some(path) => self.aim(path)?,
                None if self.method == Method::Dog => Phase::Homing,
                None => Phase::Ended,
            };
        }
        if self.phase == Phase::Homing {
            if let Some(state) = self.home(pose) {
                return Ok(Some(state));
            }
            let there = pose.distance_to(self.goal.position) <= 0.02;
            self.phase = if there && self.goal.heading.is_none() {
                Phase::Ended
            } else {
                self.aim(self.round_the_circle(pose)?)?
            };
        }
        Ok(self.follow(pose))
    }

    /// The wheels are turned before the car drives off.
    fn aim(&self, path: Path) -> Result<Phase> {
        let follower = PathFollower::new(path, self.parameters.follower)?;
        Ok(Phase::Aiming(Box::new(follower), self.parameters.steering_time))
    }

    fn follow(&mut self, pose: Pose) -> Option<CarState> {
        match &mut self.phase {
            Phase::Aiming(follower, seconds) => {
                *seconds -= self.parameters.period;
                let curvature = follower.path().at(0.0).curvature;
                let steering = self.driver.kinematics.steering_for(curvature);
                if *seconds <= 0.0 {
                    self.phase = Phase::Following(follower.clone());
                }
                Some(CarState { speed: 0.0, steering })
            }
            Phase::Following(follower) => {
                let twist = follower.step(pose);
                if follower.rest() <= ARRIVED {
                    self.phase = Phase::Ended;
                    return None;
                }
                Some(self.driver.kinematics.inverse_limited(twist, self.driver.full_speed))
            }
            _ => None,
        }
    }

    /// A step of the dog curve; `None` when it has done its part.
    fn home(&self, pose: Pose) -> Option<CarState> {
        let (goal, radius) = (pose.to_local(self.goal.position), self.radius());
        let distance = goal.coords.norm();
        let turns = self.goal.heading.is_some();
        if distance <= if turns { DOG_HANDOVER * radius } else { 0.02 } {
            return None;
        }
        let bearing = pose.bearing_to(self.goal.position);
        // Within a turning circle, the goal could only be circled: first the car drives away from it.
        let beside = Point::new(0.0, radius.copysign(goal.y));
        let within = (goal - beside).norm() < radius - 1e-3;
        if within {
            return Some(CarState { speed: self.parameters.follower.speed, steering: 0.0 });
        }
        let told = dog_twist(&self.parameters.follower, bearing, distance);
        let rate = self.parameters.follower.approach_rate;
        let speed = self.parameters.follower.speed.min((rate * distance).max(0.02));
        let twist = Twist::new(speed, told.angular);
        Some(self.driver.kinematics.inverse_limited(twist, self.driver.full_speed))
    }

    /// Drives a car to the goal by its odometry, within `time_limit` seconds, by motor 1 and servo 1. `observe` is called
    /// after every step.
    pub fn run<R: Clock + Drive + Motors + Servos + ?Sized>(
        &mut self,
        robot: &mut R,
        time_limit: f64,
        mut observe: impl FnMut(&Self, Pose),
    ) -> Result<CarOutcome> {
        let begin = robot.now()?;
        let mut next = begin;
        let mut last = f64::NEG_INFINITY;
        loop {
            let now = robot.now()?;
            if now <= last {
                return Err(Error::new(ErrorKind::Other, "the robot's clock stands still"));
            }
            last = now;
            let pose = robot.pose()?;
            let state = self.step(pose)?;
            observe(self, pose);
            let outcome = if now - begin >= time_limit {
                Some(CarOutcome::TimedOut)
            } else if robot.is_stalled()? {
                Some(CarOutcome::Blocked)
            } else {
                state.is_none().then_some(CarOutcome::Reached)
            };
            if let Some(outcome) = outcome {
                robot.set_motor(1, 0.0)?;
                return Ok(outcome);
            }
            self.driver.drive(robot, state.unwrap_or_default())?;
            next += self.parameters.period;
            let pause = next - robot.now()?;
            robot.wait(pause)?;
        }
    }

    /// Radians by which a pose misses the goal's heading; `None` if any will do.
    pub fn heading_error(&self, pose: Pose) -> Option<f64> {
        self.goal.heading.map(|heading| angle_difference(pose.heading, heading))
    }
}
