mod first_way;

use std::ops::ControlFlow;

use super::chart::{Chart, LEVELS, refused};
use super::destination::Destination;
use super::locator::Locator;
use super::parameters::NavigatorParameters;
use super::report::{NavigatorEvent, NavigatorOutcome, NavigatorPhase};
use super::route::Route;
use super::steering::Steering;
use crate::geometry::{Point, Pose, Twist, angle_difference};
use crate::io::control::{Behaviour, Decision, Halt, LidarObservation, Senses};
use crate::io::reading::{check_pose, check_scan, point_in_words, pose_in_words};
use crate::io::{Error, Lidar, Odometry, Result};
use crate::kinematics::OUTLIER;
use crate::nav::surroundings::Surroundings;
use crate::scan::ScanFilter;
use crate::world::{GridCell, World};

/// Drives to a goal in a known world that may have changed (book, section 10.3 and after).
///
/// The robot plans on a grid of the known world, inflated by its outline plus a clearance, and follows the
/// plan with feedback: at every step it heads for the farthest path point reachable in a straight line, past
/// the obstacles that the lidar sees. Seen obstacles that the world lacks are added to the grid, and D\* Lite
/// repairs the plan. If no path has the desired clearance, it plans with less, down to the minimum, and
/// with more again as soon as possible.
///
/// Scan matching corrects odometry: measured scans are matched with those expected in the known world.
/// # Model
///
/// The plan is made for the circle around the outline, so that the robot can turn everywhere. The robot fits
/// at every place in a free cell, and along every straight way through free cells. At every step the outline
/// itself is swept along the commanded arc, slowed down so that it stops before any visible point.
///
/// # Outcomes
///
/// [`NoRoom`](NavigatorOutcome::NoRoom) is reported at once if the goal is in no obstacle, but so near to one
/// that the robot has no room within its tolerance; [`Unreachable`](NavigatorOutcome::Unreachable) if the
/// known world has no way there. Cells that may close one are halved twice first; a passage with less room to
/// spare on either side than one and a half of the resulting cells may count as closed. If seen obstacles
/// leave none, they are forgotten and looked at anew first. A robot without progress records what is in front
/// of it, backs off and plans anew; after several attempts it is [`Stuck`](NavigatorOutcome::Stuck).
///
/// In a world so large that small cells do not cover it, a way is looked for in as much of it around start
/// and goal as they do cover, then with larger cells.
///
/// ```
/// use roverlab::geometry::{Point, Pose};
/// use roverlab::io::control::run;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::nav::{Navigator, NavigatorOutcome, NavigatorParameters};
/// use roverlab::world::{RobotSpec, Scene, Wall, World};
/// let mut world = World::walled(3.0, 2.0);
/// world.walls.push(Wall::new(Point::new(1.5, 0.0), Point::new(1.5, 1.4)));
/// let (start, goal) = (Pose::new(0.5, 0.5, 0.0), Point::new(2.5, 0.5));
/// let mut navigator = Navigator::new(&world, start, goal, NavigatorParameters::default())?;
/// let scene = Scene::with_robot(world, RobotSpec::s4(), start);
/// let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
/// let outcome = run(&mut simulation.robot(0)?, &mut navigator, 120.0, |_, _, _| {})?;
/// let truth = simulation.truth().robot(0)?;
/// assert_eq!((outcome, truth.contacts), (NavigatorOutcome::Reached, 0));
/// assert!(truth.pose.distance_to(goal) < 0.1);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Navigator {
    parameters: NavigatorParameters,
    goal: Point,
    destination: Destination,
    phase: NavigatorPhase,
    chart: Chart,
    route: Option<Route>,
    locator: Locator,
    start: Pose,
    pose: Pose,
    filter: ScanFilter,
    surroundings: Surroundings,
    /// Noise-filtered points of the scan in the robot's frame, and those near it.
    points: Vec<Point>,
    near: Vec<Point>,
    events: Vec<NavigatorEvent>,
    /// Cells with obstacles seen since the plan was made.
    marks: Vec<GridCell>,
    progress: Progress,
    /// Remaining steps of looking or backing off.
    left: u32,
    doubts: u32,
    /// Position of the last search for a wider way.
    widened_at: Point,
}

/// Monitors the robot's progress.
#[derive(Debug, Clone)]
struct Progress {
    anchor: Pose,
    idle: f64,
    least: f64,
    waiting: f64,
    blocked_at: Point,
    blocked: u32,
}

/// Distance within which detections count for the next step, whose target is no farther away (m).
const NEAR: f64 = 0.6;
/// The same distance for a robot without progress, and the distance from a known obstacle at which a
/// detection is that obstacle (m).
const TOUCHING: f64 = 0.045;
/// Time of observation before planning, and duration of backing up (s).
const PAUSE: f64 = 1.0;
/// Time without motion after which the robot makes no progress (s).
const IDLE_TIME: f64 = 2.0;
/// Time without getting nearer after which the robot makes no progress (s).
const WAITING_TIME: f64 = 25.0;
/// Speed of backing up (m/s).
const BACKING_SPEED: f64 = 0.06;
/// Maximum number of failures in one place.
const MAX_BLOCKED: u32 = 8;
/// Maximum number of times that detections may be discarded.
const MAX_DOUBTS: u32 = 2;
/// Distance driven between two searches for a path with more clearance (m).
const WIDENING: f64 = 0.3;

impl Navigator {
    /// Creates a run through a known world, from a pose to a goal in it.
    ///
    /// Fails if a parameter is out of range, the start or the goal is not finite, or the world is too large.
    pub fn new(world: &World, start: Pose, goal: Point, parameters: NavigatorParameters) -> Result<Self> {
        parameters.validate()?;
        if !start.is_finite() {
            return Err(Error::invalid_input("start", pose_in_words(&start), "finite numbers"));
        }
        if !(goal.x.is_finite() && goal.y.is_finite()) {
            return Err(Error::invalid_input("goal", point_in_words(goal), "finite numbers"));
        }
        let mut this = Self {
            chart: Chart::new(world, [start.position(), goal], &parameters, parameters.resolution)?,
            destination: Destination::new(world, goal, &parameters).map_err(|error| refused(&error))?,
            parameters,
            goal,
            phase: NavigatorPhase::Looking,
            route: None,
            locator: Locator::new(world, start),
            start,
            pose: start,
            filter: ScanFilter::new(),
            surroundings: Surroundings::default(),
            points: Vec::new(),
            near: Vec::new(),
            events: Vec::new(),
            marks: Vec::new(),
            progress: Progress {
                anchor: start,
                idle: 0.0,
                least: f64::INFINITY,
                waiting: 0.0,
                blocked_at: start.position(),
                blocked: 0,
            },
            left: (PAUSE / parameters.period).ceil() as u32,
            doubts: 0,
            widened_at: start.position(),
        };
        if let Some(verdict) = this.destination.verdict() {
            this.end(verdict);
        } else if !this.find_way(world)? {
            this.end(NavigatorOutcome::Unreachable);
        }
        Ok(this)
    }

    /// Current phase.
    pub fn phase(&self) -> NavigatorPhase {
        self.phase
    }

    /// Estimated pose in the world.
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// Estimated distance to the goal (m).
    pub fn goal_distance(&self) -> f64 {
        self.pose.distance_to(self.goal)
    }

    /// The remaining path from the robot to the goal, in the world.
    pub fn path(&self) -> &[Point] {
        self.route.as_ref().map_or(&[], Route::path)
    }

    /// Length of the remaining path along the edges and diagonals of cells (m).
    pub fn path_length(&self) -> Option<f64> {
        self.route.as_ref().map(Route::length)
    }

    /// Noise-filtered points of the current scan, in the robot's frame.
    pub fn visible_points(&self) -> &[Point] {
        &self.points
    }

    /// Positions in the world of seen obstacles that the known world lacks.
    pub fn unknown_obstacles(&self) -> Vec<Point> {
        self.chart.seen().collect()
    }

    /// Takes the events since the last call.
    pub fn take_events(&mut self) -> Vec<NavigatorEvent> {
        std::mem::take(&mut self.events)
    }

    fn end(&mut self, outcome: NavigatorOutcome) {
        if !matches!(self.phase, NavigatorPhase::Ended(_)) {
            self.phase = NavigatorPhase::Ended(outcome);
            self.events.push(NavigatorEvent::End(outcome));
        }
    }

    /// The velocity until the next step.
    fn steer(&mut self, observation: &LidarObservation) -> Result<Twist> {
        if matches!(self.phase, NavigatorPhase::Ended(_)) {
            return Ok(Twist::STOP);
        }
        self.perceive(observation)?;
        if self.goal_distance() <= self.parameters.goal_tolerance {
            self.end(NavigatorOutcome::Reached);
        }
        Ok(match self.phase {
            NavigatorPhase::Looking => {
                self.look();
                Twist::STOP
            }
            NavigatorPhase::Driving => self.drive(observation.speed),
            NavigatorPhase::BackingOff => self.back_off(),
            NavigatorPhase::Ended(_) => Twist::STOP,
        })
    }

    /// Updates pose and obstacles from an observation.
    fn perceive(&mut self, observation: &LidarObservation) -> Result<()> {
        check_pose(&observation.odometry)?;
        check_scan(&observation.scan)?;
        self.pose = if self.parameters.match_scans {
            self.locator.locate(observation.odometry, &observation.scan)
        } else {
            self.start.compose(&observation.odometry)
        };
        self.filter.update(self.pose, &observation.scan)?;
        self.points.clear();
        self.points.extend(self.filter.points());
        self.surroundings.update(self.points.iter().copied(), NEAR);
        self.near.clear();
        self.near.extend(self.points.iter().filter(|point| point.coords.norm() < NEAR));
        let stray = TOUCHING.max(OUTLIER * self.filter.noise());
        for point in &self.points {
            self.marks.extend(self.chart.note(self.pose.to_world(*point), stray));
        }
        Ok(())
    }

    fn look(&mut self) {
        self.left = self.left.saturating_sub(1);
        if self.left > 0 {
            return;
        }
        self.phase = NavigatorPhase::Driving;
        if !self.plan(LEVELS) {
            self.lose_way();
        }
    }

    /// Plans with the largest of the first `levels` clearances that leaves a way.
    fn plan(&mut self, levels: usize) -> bool {
        let from = self.pose.position();
        let mut routes = (0..levels)
            .filter_map(|level| Route::new(&self.chart, level, from, &self.destination, &self.parameters));
        let Some(route) = routes.next() else { return false };
        let clearance = self.chart.clearance(route.level);
        self.events.push(NavigatorEvent::Planned { length: route.length(), clearance });
        self.progress.least = f64::INFINITY;
        self.marks.clear();
        self.route = Some(route);
        true
    }

    /// Handles the loss of the last way at the current clearance.
    fn lose_way(&mut self) {
        if self.plan(LEVELS) {
            return;
        }
        self.route = None;
        if !self.chart.forget() || self.doubts >= MAX_DOUBTS {
            let is_all = !self.chart.is_part();
            return self.end(if is_all { NavigatorOutcome::Unreachable } else { NavigatorOutcome::Stuck });
        }
        self.doubts += 1;
        self.events.push(NavigatorEvent::Doubted { point: self.pose.position() });
        self.marks.clear();
        self.left = (PAUSE / self.parameters.period).ceil() as u32;
        self.phase = NavigatorPhase::Looking;
    }

    /// Follows the path.
    fn drive(&mut self, speed: Twist) -> Twist {
        if !self.repair() {
            self.lose_way();
            return Twist::STOP;
        }
        self.widen();
        if !self.gets_on() {
            return self.give_way();
        }
        let Some(route) = &self.route else { return Twist::STOP };
        let target = route.target(&self.chart, self.pose.position(), NEAR);
        let clearance = route.clearance_to(&self.chart, target);
        let rest = self.pose.distance_to(route.place());
        self.steering(clearance).towards(self.pose.to_local(target), rest, speed)
    }

    /// Updates the plan. `false` if no way is left.
    fn repair(&mut self) -> bool {
        let position = self.pose.position();
        let Some(route) = &mut self.route else { return false };
        let changed = route.block(&self.chart, &self.marks, position);
        self.marks.clear();
        let (Some(changed), true) = (changed, changed.is_some() && route.follow(&self.chart, position))
        else {
            return false;
        };
        if changed {
            self.events.push(NavigatorEvent::Replanned { point: position, length: route.length() });
            self.progress.least = f64::INFINITY;
        }
        true
    }

    /// Looks for a way with more clearance than the current one.
    fn widen(&mut self) {
        let level = self.route.as_ref().map_or(0, |route| route.level);
        if level > 0 && self.pose.distance_to(self.widened_at) > WIDENING {
            self.widened_at = self.pose.position();
            self.plan(level);
        }
    }

    /// Whether the robot moves and its remaining path gets shorter.
    fn gets_on(&mut self) -> bool {
        let (period, pose) = (self.parameters.period, self.pose);
        let length = self.path_length().unwrap_or(f64::INFINITY);
        let progress = &mut self.progress;
        let moved = pose.distance_to(progress.anchor.position()) > 0.03
            || angle_difference(pose.heading, progress.anchor.heading).abs() > 0.3;
        if moved {
            (progress.anchor, progress.idle) = (pose, 0.0);
        }
        progress.idle += period;
        if length < progress.least - 0.05 {
            (progress.least, progress.waiting) = (length, 0.0);
        }
        progress.waiting += period;
        progress.idle < IDLE_TIME && progress.waiting < WAITING_TIME
    }

    /// Records what is in front of the robot and begins to back off.
    fn give_way(&mut self) -> Twist {
        let position = self.pose.position();
        self.events.push(NavigatorEvent::Blocked { point: position });
        let progress = &mut self.progress;
        (progress.idle, progress.waiting, progress.least) = (0.0, 0.0, f64::INFINITY);
        if (position - progress.blocked_at).norm() > 5.0 * TOUCHING {
            progress.blocked = 0;
        }
        progress.blocked += 1;
        progress.blocked_at = position;
        if progress.blocked > MAX_BLOCKED {
            self.end(NavigatorOutcome::Stuck);
            return Twist::STOP;
        }
        if progress.blocked.is_multiple_of(3) {
            // The recorded obstacles may be wrong.
            self.chart.forget();
            self.plan(LEVELS);
        }
        let reach = self.parameters.radius() + TOUCHING;
        for point in self.points.iter().filter(|point| point.x > 0.0 && point.coords.norm() < reach) {
            self.marks.extend(self.chart.insist(self.pose.to_world(*point)));
        }
        self.phase = NavigatorPhase::BackingOff;
        self.left = (PAUSE / self.parameters.period).ceil() as u32;
        self.back_off()
    }

    fn back_off(&mut self) -> Twist {
        self.left = self.left.saturating_sub(1);
        let twist = self.steering(self.parameters.least_clearance).safe(Twist::new(-BACKING_SPEED, 0.0));
        if self.left == 0 || twist.linear > -0.2 * BACKING_SPEED {
            self.phase = NavigatorPhase::Driving;
            return Twist::STOP;
        }
        twist
    }

    fn steering(&self, clearance: f64) -> Steering<'_> {
        let Self { parameters, surroundings, near: points, .. } = self;
        Steering { parameters, surroundings, points, clearance }
    }
}

impl Behaviour for Navigator {
    type Observation = LidarObservation;
    type Command = Twist;
    type Outcome = NavigatorOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, _time: f64, seen: &LidarObservation) -> Decision<Self> {
        let twist = self.steer(seen)?;
        Ok(match self.phase {
            NavigatorPhase::Ended(outcome) => ControlFlow::Break(outcome),
            _ => ControlFlow::Continue(twist),
        })
    }

    fn halt(&mut self, halt: Halt) -> NavigatorOutcome {
        self.end(halt.into());
        halt.into()
    }
}

impl<R: Odometry + Lidar + ?Sized> Senses<R> for Navigator {
    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut LidarObservation) -> Result<()> {
        seen.read(robot)
    }
}
