use std::ops::ControlFlow;

use super::alignment::Alignment;
use super::helm::{Helm, Push};
use super::legs::{Legs, Steered, steer};
use super::reckoning::Reckoning;
use super::slow_motion::SlowMotion;
use super::{DepthHoldParameters, DiveObservation, Thrust};
use crate::geometry::{Point, Pose, Vector, Vector3};
use crate::io::control::{Behaviour, Decision, Senses, halts};
use crate::io::reading::check_pose;
use crate::io::{Attitude, Error, Inertial, Odometry, Result};
use crate::kinematics::marine::CraftSpec;
use crate::parameter::{require_not_negative, require_positive};

/// Parameters of [`Boat`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoatParameters {
    /// Speed over ground on a leg (m/s).
    pub speed: f64,
    /// Distance ahead on the leg of the point the boat steers for (m).
    pub lookahead: f64,
    /// Distance from a waypoint at which it counts as reached (m).
    pub reached: f64,
    /// Time on station at the last waypoint (s).
    pub station: f64,
    /// Control period (s).
    pub period: f64,
}

impl Default for BoatParameters {
    /// 0.5 m/s, and a minute on station.
    fn default() -> Self {
        Self { speed: 0.5, lookahead: 1.5, reached: 0.2, station: 60.0, period: 0.1 }
    }
}

/// Observation of a [`Boat`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BoatObservation {
    /// Attitude of the boat.
    pub attitude: Attitude,
    /// Turn rates about its own axes (rad/s).
    pub rates: Vector3,
    /// Pose by the log.
    pub odometry: Pose,
}

/// Outcome of a [`Boat`]'s course.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum BoatOutcome {
    /// All waypoints are reached, and the time on station is over.
    Arrived,
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
    Stopped,
}

halts!(BoatOutcome { Arrived: "the time on station is over" });

/// Steers a boat with two thrusters along waypoints, and keeps station at the last one.
///
/// The position comes from the log and the compass, which is aligned by the heading at the start. An observer
/// filters the motion in waves out of the control.
///
/// On a leg it uses line-of-sight guidance with integral action (Fossen 2021, section 12.3), and it slows
/// down before a waypoint. The boat has no keel, so only its thrust corrects sideways drift: it points beyond
/// the desired velocity by a fraction of the velocity error. On station it returns to its position, and
/// estimates the drift to counteract it.
///
/// ```
/// use roverlab::drive::marine::{Boat, BoatOutcome, BoatParameters};
/// use roverlab::geometry::{Point, Pose, Vector};
/// use roverlab::io::control::run;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::kinematics::marine::CraftSpec;
/// use roverlab::world::{RobotSpec, Scene, Water, World};
///
/// let water = Water { current: vec![(0.0, Vector::new(0.0, 0.1))], ..Water::default() };
/// let lake = World { water_level: Some(3.0), water, ..World::empty(20.0, 20.0) };
/// let raft = RobotSpec { dvl: Some(10.0), ..RobotSpec::solar_raft() };
/// let scene = Scene::with_robot(lake, raft, Pose::new(3.0, 5.0, 0.0));
/// let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
/// let course = [Point::new(12.0, 5.0), Point::new(12.0, 12.0)];
/// let start = Pose::new(3.0, 5.0, 0.0);
/// let mut boat = Boat::new(&CraftSpec::solar_raft(), start, &course, BoatParameters::default())?;
/// assert_eq!(run(&mut simulation.robot(0)?, &mut boat, 200.0, |_, _, _| {})?, BoatOutcome::Arrived);
/// assert!((simulation.truth().pose(0)?.position() - course[1]).norm() < 0.5);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Boat {
    parameters: BoatParameters,
    helm: Helm,
    alignment: Alignment,
    reckoning: Reckoning,
    motion: SlowMotion,
    legs: Legs,
    /// The velocity (m/s) against what drives the boat off its station, and when it came there.
    drift: Vector,
    since: f64,
}

/// Speed back to the station per distance from it (1/s).
const RETURN: f64 = 0.25;
/// Largest speed back to the station (m/s).
const MOST_RETURN: f64 = 0.3;
/// Change of the learned drift per distance from the station and time (1/s²).
const LEARNT: f64 = 0.03;
/// Largest drift that is learned (m/s).
const MOST_DRIFT: f64 = 0.4;

impl Boat {
    /// Creates a course from a start through waypoints in world coordinates. Odometry begins at the start.
    ///
    /// Fails without waypoints and for parameters out of range.
    pub fn new(
        craft: &CraftSpec,
        start: Pose,
        waypoints: &[Point],
        parameters: BoatParameters,
    ) -> Result<Self> {
        require_positive("speed", parameters.speed)?;
        require_positive("lookahead", parameters.lookahead)?;
        require_positive("reached", parameters.reached)?;
        require_not_negative("station", parameters.station)?;
        require_positive("period", parameters.period)?;
        let all = || std::iter::once(start.position()).chain(waypoints.iter().copied());
        if let Some(wrong) = all().find(|point| !(point.x.is_finite() && point.y.is_finite())) {
            return Err(Error::invalid_input("waypoint", wrong, "finite numbers"));
        }
        if waypoints.is_empty() {
            return Err(Error::invalid_input("waypoints", 0, "at least 1"));
        }
        Ok(Self {
            helm: Helm::new(craft, 0.8, parameters.period, DepthHoldParameters::default())?,
            alignment: Alignment::at(start.heading),
            reckoning: Reckoning::at(start),
            motion: SlowMotion::default(),
            legs: Legs::new(all().collect(), parameters.speed, parameters.lookahead, parameters.reached),
            drift: Vector::zeros(),
            since: 0.0,
            parameters,
        })
    }

    /// Index of the next waypoint; the number of waypoints when the boat is on station.
    pub fn leg(&self) -> usize {
        self.legs.leg()
    }

    fn notice(&mut self, time: f64, seen: &BoatObservation) -> Result<()> {
        let BoatObservation { attitude, rates, odometry } = *seen;
        self.helm.observe(time, &DiveObservation { depth: 0.0, attitude, rates })?;
        let (helm, seconds) = (&self.helm, self.helm.seconds());
        self.alignment.learn(helm.turned(), seconds, attitude.yaw);
        self.reckoning.advance(odometry, helm.heading() - self.alignment.off(), seconds);
        let (pose, log) = (self.reckoning.pose(), self.reckoning.velocity());
        self.motion.advance(helm.craft(), &pose, helm.turn_rate(), helm.pushed(), log, seconds);
        if self.legs.pass(self.reckoning.pose().position()) {
            self.since = time;
        }
        Ok(())
    }

    /// The velocity over ground that keeps the boat at the last waypoint.
    fn stay(&mut self) -> Vector {
        let off = self.legs.end() - self.reckoning.pose().position();
        self.drift += off * (LEARNT * self.helm.seconds());
        self.drift = shortened(self.drift, MOST_DRIFT);
        shortened(off * RETURN, MOST_RETURN) + self.drift
    }

    fn push(&mut self) -> Push {
        let pose = self.reckoning.pose();
        let (wanted, stays) = if self.legs.is_over() {
            (self.stay(), true)
        } else {
            (self.legs.guide(pose.position(), self.helm.seconds()), false)
        };
        let Steered { turn, speed } = steer(&pose, self.motion.velocity(), wanted);
        // On station it may go astern.
        let speed = if stays { wanted.dot(&pose.forward()) } else { speed };
        let mut push = self.helm.push(self.motion.along(&pose).x, speed, turn);
        push.ahead -= self.helm.craft().inertia()[0] * self.motion.unknown(&pose).x;
        push
    }
}

/// A vector no longer than so many metres.
fn shortened(vector: Vector, most: f64) -> Vector {
    vector * (most / vector.norm().max(most))
}

impl Behaviour for Boat {
    type Observation = BoatObservation;
    type Command = Thrust;
    type Outcome = BoatOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, time: f64, seen: &BoatObservation) -> Decision<Self> {
        let BoatObservation { attitude, rates, odometry } = *seen;
        DiveObservation { depth: 0.0, attitude, rates }.check()?;
        check_pose(&odometry)?;
        self.notice(time, seen)?;
        if self.legs.is_over() && time - self.since >= self.parameters.station {
            return Ok(ControlFlow::Break(BoatOutcome::Arrived));
        }
        let push = self.push();
        Ok(ControlFlow::Continue(self.helm.afloat(push)?))
    }
}

impl<R: Inertial + Odometry + ?Sized> Senses<R> for Boat {
    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut BoatObservation) -> Result<()> {
        seen.attitude = robot.attitude()?;
        seen.rates = robot.turn_rates()?;
        seen.odometry = robot.pose()?;
        Ok(())
    }
}
