use std::f64::consts::PI;
use std::ops::ControlFlow;

use super::way::TURN_GAIN;
use super::{Path, PathFollower, PathFollowerParameters};
use crate::ParameterError;
use crate::geometry::{Point, Pose, Twist, angle_difference};
use crate::io::control::{Behaviour, Decision, LidarObservation, Senses, halts};
use crate::io::reading::check_pose;
use crate::io::{Lidar, Odometry, Result};
use crate::parameter::{require_not_negative, require_positive};
use crate::scan::ScanMatcher;

/// Task of [`FirstSteps`] (book, section 2.13).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FirstTask {
    /// Straight ahead to a wall, about turn, and back to the start.
    Wall,
    /// One circle to the left, back to the start.
    Circle,
}

/// Parameters of [`FirstSteps`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstStepsParameters {
    /// Distance between the robot's front and the wall at which it turns (m).
    pub gap: f64,
    /// Diameter of the circle (m).
    pub diameter: f64,
    /// Radius of the circle around the robot's centre that encloses it (m).
    pub radius: f64,
    /// Maximum speed (m/s).
    pub speed: f64,
    /// Maximum turn rate (rad/s).
    pub turn_rate: f64,
    /// Control period (s).
    pub period: f64,
}

impl Default for FirstStepsParameters {
    /// The book's 300 mm and 1 m, for an S4.
    fn default() -> Self {
        Self { gap: 0.3, diameter: 1.0, radius: 0.06, speed: 0.25, turn_rate: 1.5, period: 0.1 }
    }
}

impl FirstStepsParameters {
    /// Checks every parameter; the error names the one out of range.
    pub fn validate(&self) -> std::result::Result<(), ParameterError> {
        require_not_negative("gap", self.gap)?;
        require_positive("diameter", self.diameter)?;
        require_positive("radius", self.radius)?;
        require_positive("speed", self.speed)?;
        require_positive("turn rate", self.turn_rate)?;
        require_positive("control period", self.period)
    }
}

/// The first drives of a new robot: to a wall and back, or once round a circle (book, section 2.13).
///
/// Wheels alone do not bring a robot back: an error of 1 % in their diameter is 2 degrees in a half turn.
/// Therefore the robot keeps its first scan and corrects its odometry by scan matching, so that it compares
/// distance and angle to the walls with those at the start.
///
/// ```
/// use roverlab::drive::{FirstSteps, FirstStepsOutcome, FirstStepsParameters, FirstTask};
/// use roverlab::geometry::Pose;
/// use roverlab::io::control::run;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::world::{RobotSpec, Scene, World};
///
/// # fn main() -> roverlab::io::Result<()> {
/// let start = Pose::new(0.6, 0.8, 0.1);
/// let scene = Scene::with_robot(World::walled(3.0, 2.0), RobotSpec::s4(), start);
/// let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
/// let mut steps = FirstSteps::new(FirstTask::Wall, FirstStepsParameters::default())?;
/// let outcome = run(&mut simulation.robot(0)?, &mut steps, 60.0, |_, _, _| {})?;
/// assert_eq!(outcome, FirstStepsOutcome::Returned);
/// assert!(simulation.truth().pose(0)?.distance_to(start.position()) < 0.02);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct FirstSteps {
    task: FirstTask,
    parameters: FirstStepsParameters,
    matcher: ScanMatcher,
    wall: WallMean,
    /// What is left to drive, the next one last; none before the first scan.
    legs: Option<Vec<Leg>>,
}

/// A part of the drive, in the frame of the start.
#[derive(Debug, Clone)]
enum Leg {
    /// Along a line that ends beyond the wall, until the wall is near.
    ToWall(PathFollower),
    /// Along a path to its end.
    Along(PathFollower),
    /// On the spot to a heading (rad).
    Turn(f64),
}

/// Outcome of [`FirstSteps`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum FirstStepsOutcome {
    /// The robot takes itself to be at its start.
    Returned,
    /// No wall is in sight ahead, or something stands on the circle.
    NoRoom,
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
    Stopped,
}

halts!(FirstStepsOutcome { Returned: "the robot is back", NoRoom: "there is no wall, or no room" });

/// Remaining distance at which a leg ends (m).
const ARRIVAL: f64 = 0.003;
/// Heading error at which a turn ends (rad).
const ALIGNED: f64 = 0.008;

impl FirstSteps {
    /// Creates a drive from where the robot stands. Fails for parameters out of range.
    pub fn new(task: FirstTask, parameters: FirstStepsParameters) -> Result<Self> {
        parameters.validate()?;
        let (matcher, wall) = (ScanMatcher::new(), WallMean::default());
        Ok(Self { task, parameters, matcher, wall, legs: None })
    }

    /// Pose in the frame of the start, by odometry and scans, for a pose by odometry.
    pub fn pose(&self, odometry: Pose) -> Pose {
        self.matcher.corrected(odometry)
    }

    /// The legs of the task; `None` without room for it.
    fn plan(&self, points: &[Point]) -> Result<Option<Vec<Leg>>> {
        let FirstStepsParameters { diameter, radius, gap, .. } = self.parameters;
        match self.task {
            FirstTask::Wall => {
                let has_way = |range: f64| range - radius - gap > ARRIVAL;
                let Some((range, _)) = ahead(points, radius).filter(|(range, _)| has_way(*range)) else {
                    return Ok(None);
                };
                let line = Path::straight(Point::origin(), Point::new(range, 0.0))?;
                Ok(Some(vec![Leg::ToWall(self.follower(line)?)]))
            }
            FirstTask::Circle => {
                let centre = Point::new(0.0, 0.5 * diameter);
                let is_on_way = |point: &Point| ((point - centre).norm() - 0.5 * diameter).abs() < radius;
                if points.iter().any(is_on_way) {
                    return Ok(None);
                }
                let circle = Path::of_arcs(Pose::default(), &[(PI * diameter, 2.0 / diameter)])?;
                Ok(Some(vec![Leg::Turn(0.0), Leg::Along(self.follower(circle)?)]))
            }
        }
    }

    fn follower(&self, path: Path) -> Result<PathFollower> {
        let FirstStepsParameters { speed, turn_rate, .. } = self.parameters;
        PathFollower::new(path, PathFollowerParameters { speed, turn_rate, ..Default::default() })
    }

    /// The way back from before the wall.
    fn homeward(&self, pose: Pose) -> Result<Vec<Leg>> {
        let line = Path::straight(pose.position(), Point::origin())?;
        let heading = line.start().heading;
        Ok(vec![Leg::Turn(PI), Leg::Along(self.follower(line)?), Leg::Turn(heading)])
    }

    /// Velocity on a leg; `None` at its end.
    fn along(&self, leg: &mut Leg, pose: Pose) -> Option<Twist> {
        match leg {
            Leg::ToWall(follower) => {
                let rest = self.wall.mean() - self.parameters.radius - self.parameters.gap - pose.x;
                let twist = follower.step(pose);
                let most = PathFollowerParameters::default().approach_rate * rest;
                let scale = if twist.linear > most { most / twist.linear } else { 1.0 };
                (rest > ARRIVAL).then(|| Twist::new(scale * twist.linear, scale * twist.angular))
            }
            Leg::Along(follower) => {
                let twist = follower.step(pose);
                (follower.rest() > ARRIVAL).then_some(twist)
            }
            Leg::Turn(heading) => {
                let rest = angle_difference(*heading, pose.heading);
                let most = self.parameters.turn_rate;
                (rest.abs() > ALIGNED).then(|| Twist::new(0.0, (TURN_GAIN * rest).clamp(-most, most)))
            }
        }
    }

    /// Corrects odometry by a scan, and measures the wall.
    fn locate(&mut self, odometry: Pose, points: &[Point]) -> Pose {
        let pose = self.matcher.update(odometry, points);
        self.matcher.learn(points);
        // After the turn what is ahead is something else.
        let is_outward = matches!(self.legs.as_deref(), None | Some([Leg::ToWall(_)]));
        if let Some((range, beams)) = ahead(points, self.parameters.radius).filter(|_| is_outward) {
            self.wall.add(pose.x + range, beams);
        }
        pose
    }
}

impl Behaviour for FirstSteps {
    type Observation = LidarObservation;
    type Command = Twist;
    type Outcome = FirstStepsOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, _time: f64, seen: &LidarObservation) -> Decision<Self> {
        check_pose(&seen.odometry)?;
        let points: Vec<Point> = seen.scan.points().collect();
        let pose = self.locate(seen.odometry, &points);
        let mut legs = match self.legs.take() {
            Some(legs) => legs,
            None => match self.plan(&points)? {
                Some(legs) => legs,
                None => return Ok(ControlFlow::Break(FirstStepsOutcome::NoRoom)),
            },
        };
        while let Some(mut leg) = legs.pop() {
            if let Some(twist) = self.along(&mut leg, pose) {
                legs.push(leg);
                self.legs = Some(legs);
                return Ok(ControlFlow::Continue(twist));
            }
            if let Leg::ToWall(_) = leg {
                legs = self.homeward(pose)?;
            }
        }
        self.legs = Some(legs);
        Ok(ControlFlow::Break(FirstStepsOutcome::Returned))
    }
}

impl<R: Odometry + Lidar + ?Sized> Senses<R> for FirstSteps {
    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut LidarObservation) -> Result<()> {
        seen.read(robot)
    }
}

/// Mean distance of the wall from the start, weighted by the number of beams: the wall is measured best from
/// nearby.
#[derive(Debug, Clone, Copy, Default)]
struct WallMean {
    sum: f64,
    beams: f64,
}

impl WallMean {
    fn add(&mut self, distance: f64, beams: usize) {
        self.sum += distance * beams as f64;
        self.beams += beams as f64;
    }

    fn mean(&self) -> f64 {
        self.sum / self.beams
    }
}

/// Median distance of the points before a robot of a radius, and their number. A median, because noise makes
/// the nearest of many points too near.
fn ahead(points: &[Point], radius: f64) -> Option<(f64, usize)> {
    let is_ahead = |point: &&Point| point.x > 0.0 && point.y.abs() < radius;
    let mut ranges: Vec<f64> = points.iter().filter(is_ahead).map(|point| point.x).collect();
    ranges.sort_by(f64::total_cmp);
    let count = ranges.len();
    (count > 0).then(|| (0.5 * (ranges[(count - 1) / 2] + ranges[count / 2]), count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::control::run;
    use crate::io::sim::{SimOptions, Simulation};
    use crate::world::{RobotSpec, Scene, World};

    fn driven(task: FirstTask, world: World, start: Pose, seed: u64) -> (FirstStepsOutcome, Pose) {
        let scene = Scene::with_robot(world, RobotSpec::s4(), start);
        let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, seed)).unwrap();
        let mut steps = FirstSteps::new(task, FirstStepsParameters::default()).unwrap();
        let outcome = run(&mut simulation.robot(0).unwrap(), &mut steps, 60.0, |_, _, _| {}).unwrap();
        assert_eq!(simulation.truth().robot(0).unwrap().contacts, 0);
        (outcome, start.inverse().compose(&simulation.truth().pose(0).unwrap()))
    }

    #[test]
    fn it_returns_although_its_wheels_are_wrong() {
        for (task, heading) in [(FirstTask::Wall, PI), (FirstTask::Circle, 0.0)] {
            for seed in 1..=10 {
                let (outcome, end) = driven(task, World::walled(3.0, 2.4), Pose::new(0.9, 0.7, 0.15), seed);
                assert_eq!(outcome, FirstStepsOutcome::Returned, "{task:?} {seed}");
                let turned = angle_difference(end.heading, heading).abs();
                println!("{task:?} {seed}: {end:?}");
                assert!(end.position().coords.norm() < 0.02 && turned < 0.035, "{task:?} {seed}: {end:?}");
            }
        }
    }

    #[test]
    fn without_a_wall_or_room_it_stays() {
        let start = Pose::new(0.3, 0.3, 0.0);
        let (outcome, end) = driven(FirstTask::Circle, World::walled(1.0, 1.0), start, 1);
        assert!(
            outcome == FirstStepsOutcome::NoRoom && end.position().coords.norm() < 1e-9,
            "{outcome} {end:?}"
        );
        let (outcome, _) = driven(FirstTask::Wall, World::empty(1.0, 1.0), start, 1);
        assert_eq!(outcome, FirstStepsOutcome::NoRoom);
    }

    #[test]
    fn before_the_wall_it_stands_at_its_gap() {
        let start = Pose::new(0.7, 1.0, 0.0);
        let scene = Scene::with_robot(World::walled(3.0, 2.0), RobotSpec::s4(), start);
        let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 4)).unwrap();
        let mut steps = FirstSteps::new(FirstTask::Wall, FirstStepsParameters::default()).unwrap();
        let (truth, mut farthest) = (simulation.truth(), 0.0_f64);
        run(&mut simulation.robot(0).unwrap(), &mut steps, 60.0, |_, _, _| {
            farthest = farthest.max(truth.pose(0).unwrap().x);
        })
        .unwrap();
        assert!((3.0 - farthest - 0.06 - 0.3).abs() < 0.012, "{farthest}");
    }
}
