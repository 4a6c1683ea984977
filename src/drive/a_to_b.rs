use std::f64::consts::FRAC_PI_2;

use super::follower::PATIENCE;
use super::path::SPACING;
use super::way::ALIGNED;
use super::{Path, PathFollower, PathFollowerParameters, Waypoint};
use crate::ParameterError;
use crate::geometry::{Point, Pose, Twist, angle_difference};
use crate::io::control::Manoeuvre;
use crate::io::reading::{check_pose, point_in_words};
use crate::io::{Error, Result};
use crate::parameter::{require_positive, require_up_to};

/// Method of driving from A to B (book, sections 3.3 to 3.6).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// Turn on the spot towards the goal, then drive straight.
    Turn,
    /// Drive the single arc to the goal, in reverse if the goal is behind.
    Arc,
    /// Keep turning towards the goal while driving.
    Dog,
    /// Drive a Hermite spline that arrives with the goal's heading.
    Spline,
}

/// Position and optional heading to drive to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Position in the frame of the observed poses.
    pub position: Point,
    /// Heading on arrival (rad); `None` accepts any.
    pub heading: Option<f64>,
}

impl Goal {
    /// A goal with a heading.
    pub fn pose(pose: Pose) -> Self {
        Self { position: pose.position(), heading: Some(pose.heading) }
    }

    /// A goal that accepts any heading.
    pub fn point(position: Point) -> Self {
        Self { position, heading: None }
    }

    /// The goal's pose. A goal without a heading takes the direction from `place` to it.
    pub(super) fn pose_from(&self, place: Point) -> Pose {
        let away = self.position - place;
        let heading = self.heading.unwrap_or_else(|| crate::geometry::math::atan2(away.y, away.x));
        Pose::new(self.position.x, self.position.y, heading)
    }

    pub(super) fn check(&self) -> Result<()> {
        if self.pose_from(Point::origin()).is_finite() {
            return Ok(());
        }
        let place = point_in_words(self.position);
        let found = match self.heading {
            Some(heading) => format!("{place} with a heading of {heading} rad"),
            None => place,
        };
        Err(Error::invalid_input("goal", found, "finite numbers"))
    }
}

/// Parameters of [`AToB`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AToBParameters {
    /// Speed limits and steering along the path.
    pub follower: PathFollowerParameters,
    /// Speed of turns on the spot (rad/s).
    pub turn_speed: f64,
    /// Speed of the final corrections (m/s).
    pub creep_speed: f64,
    /// The book's k: tangent length of a spline as a multiple of the distance.
    pub spline_scale: f64,
    /// Position error below which the robot stops correcting (m).
    pub tolerance: f64,
    /// Heading error below which it stops correcting (rad).
    pub heading_tolerance: f64,
    /// Maximum number of corrections.
    pub corrections: u32,
    /// Control period (s).
    pub period: f64,
}

impl Default for AToBParameters {
    fn default() -> Self {
        Self {
            follower: PathFollowerParameters::default(),
            turn_speed: 1.0,
            creep_speed: 0.1,
            spline_scale: 1.0,
            tolerance: 0.0005,
            heading_tolerance: 0.001,
            corrections: 4,
            period: 0.02,
        }
    }
}

impl AToBParameters {
    fn validate(&self) -> std::result::Result<(), ParameterError> {
        self.follower.validate()?;
        require_positive("turn speed", self.turn_speed)?;
        require_positive("creep speed", self.creep_speed)?;
        require_up_to("spline scale", self.spline_scale, 100.0)?;
        require_positive("tolerance", self.tolerance)?;
        require_positive("heading tolerance", self.heading_tolerance)?;
        require_positive("control period", self.period)
    }
}

/// Observation of [`AToB`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AToBObservation {
    /// Robot's pose in the goal's frame.
    pub pose: Pose,
    /// Whether the last manoeuvre has ended; `true` if there was none.
    pub done: bool,
    /// Whether the drive has stalled.
    pub stalled: bool,
}

/// Outcome of a drive to a goal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum AToBOutcome {
    /// The estimated pose is at the goal.
    Reached,
    /// The robot stands elsewhere by its estimate: corrections have not helped.
    Missed,
    /// The drive has stalled.
    Blocked,
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
    Stopped,
}

/// Drives to a goal by one of the book's methods, with feedback throughout: follows a planned path, then
/// corrects the remaining error by short manoeuvres.
///
/// ```
/// use roverlab::drive::{AToB, AToBOutcome, AToBParameters, Goal, Method};
/// use roverlab::geometry::Pose;
/// use roverlab::io::control::run;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::world::{RobotSpec, Scene, World};
/// # fn main() -> roverlab::io::Result<()> {
/// let scene = Scene::with_robot(World::empty(3.0, 3.0), RobotSpec::s4(), Pose::default());
/// let simulation = Simulation::new(&scene, SimOptions::ideal())?;
/// let goal = Pose::new(1.45, 0.65, 0.0);
/// let mut drive = AToB::new(Method::Spline, Goal::pose(goal), AToBParameters::default())?;
/// let outcome = run(&mut simulation.robot(0)?, &mut drive, 60.0, |_, _, _| {})?;
/// assert_eq!(outcome, AToBOutcome::Reached);
/// let end = simulation.truth().pose(0)?;
/// assert!(end.distance_to(goal.position()) < 0.006 && end.heading.abs() < 0.005);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct AToB {
    method: Method,
    pub(super) goal: Goal,
    /// Points that a spline passes on its way.
    via: Vec<Point>,
    pub(super) parameters: AToBParameters,
    phase: Phase,
    corrections: u32,
    /// Path length at the last progress (m), and the number of steps since then.
    got_to: f64,
    idle: u32,
}

#[derive(Debug, Clone, PartialEq)]
enum Phase {
    Begin,
    /// Turning on the spot before the line to the goal.
    Turning,
    Following(Box<PathFollower>),
    Homing,
    /// Correcting the remaining error.
    Correcting,
    Ended,
}

/// Metres before the end of a path at which manoeuvres take over, or a car only drives on.
pub(super) const HANDOVER: f64 = 0.02;
/// Time in which a dog curve turns towards its goal (s).
const HOMING_TIME: f64 = 0.5;

impl AToB {
    /// Creates a drive to a goal in the frame of the observed poses.
    ///
    /// # Errors
    ///
    /// If the goal is not finite, or a parameter is out of range.
    pub fn new(method: Method, goal: Goal, parameters: AToBParameters) -> Result<Self> {
        parameters.validate()?;
        goal.check()?;
        Ok(Self {
            method,
            goal,
            via: Vec::new(),
            parameters,
            phase: Phase::Begin,
            corrections: 0,
            got_to: 0.0,
            idle: 0,
        })
    }

    /// Adds waypoints, passed in this order by a chain of splines without a kink. Fails for every other
    /// method.
    pub fn via(self, points: Vec<Point>) -> Result<Self> {
        if self.method != Method::Spline && !points.is_empty() {
            let method = match self.method {
                Method::Turn => "a turn and a straight line",
                Method::Arc => "an arc",
                Method::Dog => "a dog curve",
                Method::Spline => "a spline",
            };
            let found = format!("{method} by way of {} points", points.len());
            return Err(Error::invalid_input("method", found, "a spline, which alone has waypoints"));
        }
        if let Some(point) = points.iter().find(|point| !(point.x.is_finite() && point.y.is_finite())) {
            return Err(Error::invalid_input("waypoint", point_in_words(*point), "finite numbers"));
        }
        Ok(Self { via: points, ..self })
    }

    /// The next command; `None` at the end. Fails if the pose is not finite.
    pub fn step(&mut self, observation: &AToBObservation) -> Result<Option<Manoeuvre>> {
        let pose = observation.pose;
        check_pose(&pose)?;
        match &mut self.phase {
            Phase::Begin => self.begin(pose),
            Phase::Turning if observation.done => {
                let path = Path::straight(pose.position(), self.goal.position)?;
                self.follow(path, false, pose)
            }
            Phase::Following(follower) => {
                let twist = follower.step(pose);
                // Pure pursuit circles round the end of a path that bends within its lookahead.
                let gets_on = follower.travelled() >= self.got_to + SPACING;
                if gets_on {
                    self.got_to = follower.travelled();
                }
                self.idle = if gets_on { 0 } else { self.idle + 1 };
                let idles = f64::from(self.idle) * self.parameters.period > PATIENCE;
                if follower.rest() > HANDOVER && !idles {
                    return Ok(Some(Manoeuvre::Speed(twist)));
                }
                self.phase = Phase::Correcting;
                Ok(self.correct(pose))
            }
            Phase::Homing => Ok(self.home(pose)),
            Phase::Correcting if observation.done => Ok(self.correct(pose)),
            Phase::Turning | Phase::Correcting => Ok(Some(Manoeuvre::Continue)),
            Phase::Ended => Ok(None),
        }
    }

    fn begin(&mut self, pose: Pose) -> Result<Option<Manoeuvre>> {
        if self.is_at_goal(pose) {
            self.phase = Phase::Correcting;
            return Ok(self.correct(pose));
        }
        match self.method {
            Method::Turn => {
                self.phase = Phase::Turning;
                Ok(Some(self.turn(pose.bearing_to(self.goal.position))))
            }
            Method::Dog => {
                self.phase = Phase::Homing;
                Ok(self.home(pose))
            }
            Method::Arc => self.follow(self.arc(pose)?, self.is_behind(pose), pose),
            Method::Spline => self.follow(self.spline(pose)?, false, pose),
        }
    }

    /// Whether only the final correction remains.
    fn is_at_goal(&self, pose: Pose) -> bool {
        self.via.is_empty() && pose.distance_to(self.goal.position) <= HANDOVER
    }

    fn is_behind(&self, pose: Pose) -> bool {
        pose.bearing_to(self.goal.position).abs() > FRAC_PI_2
    }

    /// The arc to the goal, in reverse to a goal behind.
    fn arc(&self, pose: Pose) -> Result<Path> {
        let heading = if self.is_behind(pose) { pose.heading + std::f64::consts::PI } else { pose.heading };
        Path::arc(Pose { heading, ..pose }, self.goal.position)
    }

    /// The spline to the goal, or the chain of splines through the waypoints.
    fn spline(&self, pose: Pose) -> Result<Path> {
        if self.via.is_empty() {
            let goal = self.goal.pose_from(pose.position());
            return Path::hermite(pose, goal, self.parameters.spline_scale);
        }
        let start = Waypoint { position: pose.position(), heading: Some(pose.heading) };
        let goal = Waypoint { position: self.goal.position, heading: self.goal.heading };
        let between = self.via.iter().map(|&position| Waypoint { position, heading: None });
        let waypoints: Vec<Waypoint> = std::iter::once(start).chain(between).chain([goal]).collect();
        Path::through(&waypoints)
    }

    fn follow(&mut self, path: Path, reverse: bool, pose: Pose) -> Result<Option<Manoeuvre>> {
        let mut follower = PathFollower::new(path, self.parameters.follower)?;
        if reverse {
            follower = follower.reversed();
        }
        let twist = follower.step(pose);
        self.phase = Phase::Following(Box::new(follower));
        Ok(Some(Manoeuvre::Speed(twist)))
    }

    /// One step of the dog curve: turns towards the goal, slowly enough not to circle it.
    fn home(&mut self, pose: Pose) -> Option<Manoeuvre> {
        let distance = pose.distance_to(self.goal.position);
        if distance <= HANDOVER {
            self.phase = Phase::Correcting;
            return self.correct(pose);
        }
        let bearing = pose.bearing_to(self.goal.position);
        Some(Manoeuvre::Speed(dog_twist(&self.parameters.follower, bearing, distance)))
    }

    /// Short manoeuvres that correct the standing robot's pose.
    fn correct(&mut self, pose: Pose) -> Option<Manoeuvre> {
        let goal = pose.to_local(self.goal.position);
        let distance = goal.coords.norm();
        let may = self.corrections < self.parameters.corrections;
        if may && distance > self.parameters.tolerance {
            self.corrections += 1;
            return Some(self.approach(pose, goal));
        }
        let missing = self.goal.heading.map_or(0.0, |heading| angle_difference(heading, pose.heading));
        if self.corrections < 2 * self.parameters.corrections
            && missing.abs() > self.parameters.heading_tolerance
        {
            // From here on only the heading is corrected: a turn moves the robot by a tick at most.
            self.corrections = self.corrections.max(self.parameters.corrections) + 1;
            return Some(self.turn(missing));
        }
        self.phase = Phase::Ended;
        None
    }

    fn approach(&self, pose: Pose, goal: Point) -> Manoeuvre {
        // Driving backwards is as good as driving forwards.
        let behind = goal.x < 0.0;
        let bearing = if behind {
            angle_difference(pose.bearing_to(self.goal.position), std::f64::consts::PI)
        } else {
            pose.bearing_to(self.goal.position)
        };
        if goal.y.abs() > self.parameters.tolerance && bearing.abs() > ALIGNED {
            return self.turn(bearing);
        }
        Manoeuvre::Straight(goal.x, self.parameters.creep_speed)
    }

    fn turn(&self, angle: f64) -> Manoeuvre {
        Manoeuvre::Turn(angle, self.parameters.turn_speed)
    }

    /// The path being followed, if any.
    pub fn path(&self) -> Option<&Path> {
        if let Phase::Following(follower) = &self.phase { Some(follower.path()) } else { None }
    }

    /// The path from a pose; `None` at the goal and for a dog curve, which has no plan.
    ///
    /// # Errors
    ///
    /// If the pose is not finite, or no path of the method leads to the goal.
    pub fn plan(&self, pose: Pose) -> Result<Option<Path>> {
        if self.is_at_goal(pose) {
            return Ok(None);
        }
        match self.method {
            Method::Dog => Ok(None),
            Method::Turn => Path::straight(pose.position(), self.goal.position).map(Some),
            Method::Arc => self.arc(pose).map(Some),
            Method::Spline => self.spline(pose).map(Some),
        }
    }
}

/// Velocity of a dog curve for the goal's bearing (rad) and distance (m).
pub(super) fn dog_twist(parameters: &PathFollowerParameters, bearing: f64, distance: f64) -> Twist {
    let angular = (bearing / HOMING_TIME).clamp(-parameters.turn_rate, parameters.turn_rate);
    // The circle driven stays within the one that passes through the goal.
    let through_goal = 0.5 * distance / crate::geometry::math::sin(bearing.abs().min(FRAC_PI_2)).max(1e-9);
    let linear = parameters
        .speed
        .min(0.5 * angular.abs() * through_goal + parameters.speed * (1.0 - (bearing.abs() / 0.3).min(1.0)))
        .min((2.0 * parameters.deceleration * distance).sqrt());
    Twist::new(linear, angular)
}

#[cfg(test)]
mod tests;
