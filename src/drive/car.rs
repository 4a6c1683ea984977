use std::ops::ControlFlow;

use super::a_to_b::{HANDOVER, dog_twist};
use super::{Goal, Method, Path, PathFollower, PathFollowerParameters, Steering};
use crate::ParameterError;
use crate::geometry::{Point, Pose, Twist, angle_difference};
use crate::io::control::{Behaviour, Command, Decision, Senses, halts};
use crate::io::reading::check_pose;
use crate::io::{Motors, Odometry, Result, Servos, StallDetector};
use crate::kinematics::{Ackermann, CarState};
use crate::parameter::{require, require_positive, require_up_to};

/// Converts speed and steering angle of a car to motor and servo commands (book, program 7.1).
///
/// ```
/// use roverlab::drive::CarDriver;
/// use roverlab::kinematics::{Ackermann, CarState};
/// let driver = CarDriver::new(Ackermann::new(0.3, 0.2, 0.5)?, 2.0)?;
/// let command = driver.command(CarState { speed: 1.0, steering: 0.5 });
/// assert_eq!((command.motor, command.servo), (0.5, -1.0), "half of full speed, all the way to the left");
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarDriver {
    kinematics: Ackermann,
    full_speed: f64,
}

/// Commands for motor 1 and servo 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarCommand {
    /// Fraction of the motor's full speed, -1 to 1.
    pub motor: f64,
    /// Steering servo position, -1 (full left) to 1 (full right).
    pub servo: f64,
}

impl CarDriver {
    /// Creates a driver; `full_speed` is the rim speed of the wheels at full motor speed (m/s). Fails unless
    /// it is positive and finite.
    pub fn new(kinematics: Ackermann, full_speed: f64) -> std::result::Result<Self, ParameterError> {
        require_positive("full speed", full_speed)?;
        Ok(Self { kinematics, full_speed })
    }

    /// Geometry of the car.
    pub fn kinematics(&self) -> &Ackermann {
        &self.kinematics
    }

    /// The commands for a speed and a steering angle, clamped to the actuators' ranges.
    pub fn command(&self, state: CarState) -> CarCommand {
        CarCommand {
            motor: (state.speed / self.full_speed).clamp(-1.0, 1.0),
            servo: (-state.steering / self.kinematics.max_steering()).clamp(-1.0, 1.0),
        }
    }
}

/// Parameters of [`CarToB`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarToBParameters {
    /// Speed limits and steering along the path.
    pub follower: PathFollowerParameters,
    /// Minimum radius of planned paths as a multiple of the turning radius; above 1 leaves room for
    /// corrections.
    pub margin: f64,
    /// The book's k of splines; increased where the spline would bend too tightly.
    pub spline_scale: f64,
    /// Position error below which the car stops correcting (m).
    pub tolerance: f64,
    /// Heading error below which it stops correcting (rad).
    pub heading_tolerance: f64,
    /// Maximum number of times the car reverses and tries again.
    pub corrections: u32,
    /// Time the servo takes to turn the wheels from the middle to one side (s).
    pub steering_time: f64,
    /// Control period (s).
    pub period: f64,
}

impl Default for CarToBParameters {
    fn default() -> Self {
        Self {
            follower: PathFollowerParameters {
                speed: 0.2,
                turn_rate: 1.0,
                deceleration: 0.1,
                approach_rate: 1.2,
                lag: 0.45,
                steering: Steering::CrossTrack { reach: 0.2 },
            },
            margin: 1.15,
            spline_scale: 1.0,
            tolerance: 0.005,
            heading_tolerance: 0.005,
            corrections: 4,
            steering_time: 1.1,
            period: 0.02,
        }
    }
}

/// Outcome of a car's drive to a goal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum CarOutcome {
    /// The estimated pose is at the goal.
    Reached,
    /// Every attempt ended four tolerances or more from the goal or its heading.
    Missed,
    /// The drive has stalled.
    Blocked,
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
    Stopped,
}

halts!(CarOutcome {
    Reached: "the goal is reached",
    Missed: "the car stopped beside the goal each time",
    Blocked: "something holds the car",
});

/// Observation of a car's drive to a goal.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CarObservation {
    /// Pose by odometry.
    pub pose: Pose,
    /// Whether the drive has stalled.
    pub stalled: bool,
}

/// Drives a car to a goal by the methods of chapter 3, within its turning circle (book, section 7.4).
///
/// A car cannot turn on the spot, so every plan respects its turning circle: [`Method::Turn`] is a Dubins
/// path, and an arc or a spline that is too tight becomes one. A dog curve drives straight past a goal beside
/// the car until it can turn towards it. All methods meet the goal's heading; a dog curve ends with a planned
/// path to do so.
///
/// The wheels steer too slowly for a path that ends in a tight bend. If the car misses the goal there, it
/// reverses straight and tries again.
///
/// ```
/// use roverlab::drive::{CarDriver, CarToB, CarToBParameters, Goal, Method};
/// use roverlab::geometry::Pose;
/// use roverlab::kinematics::Ackermann;
/// let driver = CarDriver::new(Ackermann::new(0.3, 0.2, 0.5)?, 2.0)?;
/// let beside = Goal::pose(Pose::new(0.0, 0.5, 0.0));
/// let drive = CarToB::new(Method::Turn, beside, driver, CarToBParameters::default())?;
/// let path = drive.plan(Pose::default())?.expect("it is not there yet");
/// assert!(path.length() > 3.0, "half a metre to the left, but a car has to go round");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CarToB {
    method: Method,
    goal: Goal,
    driver: CarDriver,
    parameters: CarToBParameters,
    phase: Phase,
    corrections: u32,
    /// The remaining pieces of the path, the next one last.
    next: Vec<Path>,
}

#[derive(Debug, Clone, PartialEq)]
enum Phase {
    Begin,
    /// Standing while the wheels turn, for this many seconds more.
    Aiming(Box<PathFollower>, f64),
    Following(Box<PathFollower>),
    Homing,
    /// Reversing straight from this point, to try again.
    Backing(Point),
    Ended,
}

/// Distance beyond which a goal is missed (tolerances).
const MISSED: f64 = 4.0;
/// Distance that a car backs up before another attempt, and before a goal with a heading at which a dog curve
/// hands over (turning radii).
const ROOM: f64 = 2.0;
/// Distance from the goal at which the car stops (m).
const ARRIVED: f64 = 0.001;
/// Change of heading between two path points that no car can follow (rad).
const SHARP_TURN: f64 = 0.1;
/// Jump of the curvature, relative to the maximum, at which the car stops to turn its wheels.
const LARGE_JUMP: f64 = 1.2;
/// Maximum k of splines where the book's k of 1 bends too tightly; each attempt doubles it.
const LARGEST_SCALE: f64 = 4.0;

impl CarToB {
    /// Creates a car's drive to a goal in the frame of the observed poses.
    ///
    /// # Errors
    ///
    /// If the goal is not finite, or a parameter is out of range.
    pub fn new(method: Method, goal: Goal, driver: CarDriver, parameters: CarToBParameters) -> Result<Self> {
        goal.check()?;
        parameters.follower.validate()?;
        require_up_to("spline scale", parameters.spline_scale, 100.0)?;
        require_positive("tolerance", parameters.tolerance)?;
        require_positive("heading tolerance", parameters.heading_tolerance)?;
        require_positive("steering time", parameters.steering_time)?;
        require_positive("control period", parameters.period)?;
        let good = parameters.margin >= 1.0 && parameters.margin.is_finite();
        require("margin of the turning radius", parameters.margin, good, "at least 1")?;
        Ok(Self { method, goal, driver, parameters, phase: Phase::Begin, corrections: 0, next: Vec::new() })
    }

    fn radius(&self) -> f64 {
        self.parameters.margin * self.driver.kinematics.turning_radius()
    }

    /// The path from a pose; `None` at the goal and for a dog curve, which has no plan.
    ///
    /// # Errors
    ///
    /// If a pose is not finite, or the goal is more than 10 km away.
    pub fn plan(&self, pose: Pose) -> Result<Option<Path>> {
        if pose.distance_to(self.goal.position) <= ARRIVED || self.method == Method::Dog {
            return Ok(None);
        }
        let fits = |path: &Path| {
            path.max_curvature() * self.radius() <= 1.0 + 1e-9 && path.sharpest_turn() < SHARP_TURN
        };
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
                scale *= 2.0;
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

    /// Speed and steering for the car at a pose; `None` at the end. Fails if the pose is not finite.
    pub fn step(&mut self, pose: Pose) -> Result<Option<CarState>> {
        check_pose(&pose)?;
        if let Some(state) = self.back(pose) {
            return Ok(Some(state));
        }
        let state = self.come(pose)?;
        if state.is_some() || !self.is_off(pose, 1.0) || self.corrections == self.parameters.corrections {
            return Ok(state);
        }
        self.corrections += 1;
        self.phase = Phase::Backing(pose.position());
        Ok(self.back(pose))
    }

    /// Whether a pose misses the goal or its heading by more than this multiple of the tolerances.
    fn is_off(&self, pose: Pose, tolerances: f64) -> bool {
        let heading_tolerance = tolerances * self.parameters.heading_tolerance;
        pose.distance_to(self.goal.position) > tolerances * self.parameters.tolerance
            || self.heading_error(pose).is_some_and(|error| error.abs() > heading_tolerance)
    }

    /// One step in reverse; `None` once there is room for another attempt.
    fn back(&mut self, pose: Pose) -> Option<CarState> {
        let Phase::Backing(from) = self.phase else { return None };
        if pose.distance_to(from) < ROOM * self.radius() {
            return Some(CarState { speed: -self.parameters.follower.speed, steering: 0.0 });
        }
        self.phase = Phase::Begin;
        None
    }

    /// Speed and steering towards the goal; `None` on arrival.
    fn come(&mut self, pose: Pose) -> Result<Option<CarState>> {
        if self.phase == Phase::Begin {
            self.phase = match self.plan(pose)? {
                Some(path) => self.aim(&path)?,
                None if self.method == Method::Dog => Phase::Homing,
                None => Phase::Ended,
            };
        }
        if self.phase == Phase::Homing {
            if let Some(state) = self.home(pose) {
                return Ok(Some(state));
            }
            self.phase = if self.goal.heading.is_some() {
                let path = self.round_the_circle(pose)?;
                self.aim(&path)?
            } else {
                Phase::Ended
            };
        }
        self.follow(pose)
    }

    /// Turns the wheels to the path's first curvature before the car drives off.
    fn aim(&mut self, path: &Path) -> Result<Phase> {
        self.next = path.split_at_jumps(LARGE_JUMP * self.driver.kinematics.max_curvature());
        self.next.reverse();
        self.aim_at_next()
    }

    fn aim_at_next(&mut self) -> Result<Phase> {
        let Some(path) = self.next.pop() else { return Ok(Phase::Ended) };
        let follower = PathFollower::new(path, self.parameters.follower)?;
        // Turning from one side to the other takes twice as long as from the middle.
        let seconds = self.parameters.steering_time * if self.phase == Phase::Begin { 1.0 } else { 2.0 };
        Ok(Phase::Aiming(Box::new(follower), seconds))
    }

    fn follow(&mut self, pose: Pose) -> Result<Option<CarState>> {
        if let Phase::Following(follower) = &mut self.phase {
            let twist = follower.step(pose);
            if follower.rest() > ARRIVED {
                return Ok(Some(self.driver.kinematics.inverse_limited(twist, self.driver.full_speed)));
            }
            self.phase = self.aim_at_next()?;
        }
        Ok(self.aimed())
    }

    /// Stands with the wheels set for the next piece of the path; `None` without one.
    fn aimed(&mut self) -> Option<CarState> {
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
            _ => None,
        }
    }

    /// One step of the dog curve; `None` when it hands over.
    fn home(&self, pose: Pose) -> Option<CarState> {
        let (goal, radius) = (pose.to_local(self.goal.position), self.radius());
        let distance = goal.coords.norm();
        let turns = self.goal.heading.is_some();
        if turns && distance <= ROOM * radius {
            return None;
        }
        let rate = self.parameters.follower.approach_rate;
        if distance <= HANDOVER {
            let drives = goal.x > ARRIVED;
            return drives.then(|| CarState { speed: rate * goal.x, steering: 0.0 });
        }
        let bearing = pose.bearing_to(self.goal.position);
        // A goal inside a turning circle could only be circled: drive away from it first.
        let beside = Point::new(0.0, radius.copysign(goal.y));
        let within = (goal - beside).norm() < radius - 1e-3;
        if within {
            return Some(CarState { speed: self.parameters.follower.speed, steering: 0.0 });
        }
        let told = dog_twist(&self.parameters.follower, bearing, distance);
        let speed = self.parameters.follower.speed.min(rate * distance);
        let twist = Twist::new(speed, told.angular);
        Some(self.driver.kinematics.inverse_limited(twist, self.driver.full_speed))
    }

    /// Heading error at a pose (rad); `None` if the goal accepts any heading.
    pub fn heading_error(&self, pose: Pose) -> Option<f64> {
        self.goal.heading.map(|heading| angle_difference(pose.heading, heading))
    }
}

impl Behaviour for CarToB {
    type Observation = CarObservation;
    type Command = CarCommand;
    type Outcome = CarOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, _time: f64, seen: &CarObservation) -> Decision<Self> {
        Ok(match CarToB::step(self, seen.pose)? {
            _ if seen.stalled => ControlFlow::Break(CarOutcome::Blocked),
            Some(state) => ControlFlow::Continue(self.driver.command(state)),
            None if self.is_off(seen.pose, MISSED) => ControlFlow::Break(CarOutcome::Missed),
            None => ControlFlow::Break(CarOutcome::Reached),
        })
    }
}

impl<R: Odometry + StallDetector + ?Sized> Senses<R> for CarToB {
    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut CarObservation) -> Result<()> {
        *seen = CarObservation { pose: robot.pose()?, stalled: robot.is_stalled()? };
        Ok(())
    }
}

impl<R: Motors + Servos + ?Sized> Command<R> for CarCommand {
    fn apply(&self, robot: &mut R) -> Result<()> {
        robot.set_servo(1, self.servo)?;
        robot.set_motor(1, self.motor)
    }

    fn stop(robot: &mut R) -> Result<()> {
        robot.set_motor(1, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::{Displacement, advance};
    use crate::random::Stream;

    fn driver() -> CarDriver {
        CarDriver::new(Ackermann::new(0.26, 0.16, 0.5).unwrap(), 0.5).unwrap()
    }

    /// A car that executes every command exactly. Returns its final pose.
    fn drive(method: Method, goal: Goal, start: Pose) -> Pose {
        let mut behaviour = CarToB::new(method, goal, driver(), CarToBParameters::default()).unwrap();
        let mut pose = start;
        for _ in 0..20_000 {
            let Some(state) = behaviour.step(pose).unwrap() else { return pose };
            assert!(state.steering.abs() <= 0.5 && state.speed.abs() <= 0.5);
            let twist = driver().kinematics.forward(state);
            pose = advance(pose, Displacement { length: 0.02 * twist.linear, angle: 0.02 * twist.angular });
        }
        panic!("{method:?} to {goal:?} has no end; now at {pose:?}");
    }

    /// The few paths that end in a tight curve miss the heading by up to 6 degrees, as the wheels lag.
    #[test]
    fn every_method_arrives() {
        let mut stream = Stream::new(1);
        let mut late = 0;
        for _ in 0..60 {
            let position = Point::new(stream.between(-2.0, 2.0), stream.between(-2.0, 2.0));
            let start = Pose::new(0.1, 0.2, stream.between(-3.0, 3.0));
            let at = stream.between(-3.0, 3.0);
            let heading = stream.chance(0.5).then_some(at);
            for method in [Method::Turn, Method::Arc, Method::Dog, Method::Spline] {
                let end = drive(method, Goal { position, heading }, start);
                assert!(end.distance_to(position) < 0.03, "{method:?} to {position}: {end:?}");
                let error = heading.map_or(0.0, |heading| angle_difference(end.heading, heading).abs());
                assert!(error < 0.1, "{method:?} to {position}: {end:?}");
                late += u32::from(error > 0.05);
            }
        }
        assert!(late <= 2, "{late} of 240");
    }

    #[test]
    fn commands_are_those_of_motor_and_servo() {
        let command = driver().command(CarState { speed: 0.25, steering: 0.5 });
        assert_eq!(command, CarCommand { motor: 0.5, servo: -1.0 });
        let command = driver().command(CarState { speed: -2.0, steering: -0.25 });
        assert_eq!(command, CarCommand { motor: -1.0, servo: 0.5 });
    }

    #[test]
    fn wrong_numbers_are_refused() {
        let goal = Goal::point(Point::new(1.0, 0.0));
        let parameters = CarToBParameters { margin: 0.5, ..CarToBParameters::default() };
        assert!(CarToB::new(Method::Arc, goal, driver(), parameters).is_err());
        let mut car = CarToB::new(Method::Arc, goal, driver(), CarToBParameters::default()).unwrap();
        assert!(car.step(Pose::new(f64::INFINITY, 0.0, 0.0)).is_err());
    }
}
