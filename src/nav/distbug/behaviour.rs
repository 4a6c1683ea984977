use super::parameters::DistBugParameters;
use super::progress::LoopProgress;
use super::report::{DistBugEvent, DistBugObservation, DistBugOutcome, DistBugPhase};
use crate::geometry::{Point, Pose, Twist, angle_difference, direction, math};
use crate::io::{Clock, Drive, Error, ErrorKind, Lidar, LidarScan, Result};
use crate::nav::boundary::{BoundaryFollower, nearer_side};
use crate::nav::surroundings::Surroundings;
use crate::nav::{ScanFilter, ScanMatcher};

/// DistBug: to a goal through unknown obstacles, with a proof when there is no way (book, sections 10.1 and 10.2;
/// I. Kamon and E. Rivlin, "Sensory-based motion planning with global proofs", IEEE Transactions on Robotics and
/// Automation 13(6), 1997).
///
/// The robot drives straight at the goal until something is in the way: the *hit point*. It then follows the
/// obstacle's boundary and keeps the smallest distance `d_min` that the boundary has had to the goal. As soon as
/// `d - F <= d_min - STEP`, where `d` is the distance to the goal and `F` the free range towards it, it leaves: the
/// *leave point*. Back at the hit point without having left, it knows that the goal cannot be reached.
///
/// # Model
///
/// The robot is a disc; an obstacle grown by its radius and the least clearance is what the boundary is of. So the
/// proof holds for a robot of that size: a passage narrower than `2 (radius + least clearance)` counts as closed.
/// `F` is the distance that the whole disc can move towards the goal, and `d_min` starts at the place where the
/// disc would have touched the obstacle, so that the margins kept from obstacles do not enter the comparison.
///
/// # Failure modes
///
/// Odometry errors move the goal and can hide that the robot has come back to its hit point; with
/// [`match_scans`](DistBugParameters::match_scans) poses are corrected by the scans themselves.
#[derive(Debug, Clone)]
pub struct DistBug {
    parameters: DistBugParameters,
    goal: Point,
    phase: DistBugPhase,
    look: LookRound,
    /// `d_min`: the smallest distance to the goal that a boundary has had.
    least_distance: f64,
    /// The part of a free range that is not relied upon.
    doubt: f64,
    follower: Option<Following>,
    filter: ScanFilter,
    matcher: ScanMatcher,
    surroundings: Surroundings,
    points: Vec<Point>,
    pose: Pose,
    events: Vec<DistBugEvent>,
}

/// One obstacle's boundary, as far as it has been followed.
#[derive(Debug, Clone)]
struct Following {
    boundary: BoundaryFollower,
    /// The nearest that the robot has come to the goal.
    nearest: f64,
    progress: LoopProgress,
}

/// How far the robot has looked round.
#[derive(Debug, Clone, Default)]
struct LookRound {
    steps: u32,
    turned: f64,
    last: Option<f64>,
}

/// The standard deviation of a lidar's ranges that the filter starts from, in metres.
const EXPECTED_NOISE: f64 = 0.010;
/// How far round the robot points count for its next step, in steps.
const REACH: f64 = 2.4;
/// The part of a free range that is not relied upon at first, and at the most: gaps between beams and errors of
/// the pose grow with the distance.
const DOUBT: f64 = 0.02;
const MAX_DOUBT: f64 = 0.3;
/// The position may be wrong by so many times the noise of a range.
const NOISE_SLACK: f64 = 5.0;
/// The part of the robot's radius that must be free round a goal that counts in spite of not being met exactly.
const GOAL_ROOM: f64 = 0.7;
/// A goal that recedes by this much, in metres, has been passed.
const PASSING_MARGIN: f64 = 0.02;
/// Radians per second at which the robot turns to look round.
const LOOKING_TURN: f64 = 2.0;
/// Steps, at the start, that only look.
const SETTLING_STEPS: u32 = 12;

impl DistBug {
    /// A run to a goal given relative to the robot's start: metres ahead and to the left.
    pub fn new(goal: Point, parameters: DistBugParameters) -> Result<Self> {
        parameters.validate()?;
        if !(goal.x.is_finite() && goal.y.is_finite()) {
            return Err(Error::invalid_input("goal", goal, "finite numbers"));
        }
        Ok(Self {
            parameters,
            goal,
            phase: DistBugPhase::LookingRound,
            look: LookRound::default(),
            least_distance: f64::INFINITY,
            doubt: DOUBT,
            follower: None,
            filter: ScanFilter::new(EXPECTED_NOISE),
            matcher: ScanMatcher::new(),
            surroundings: Surroundings::default(),
            points: Vec::new(),
            pose: Pose::default(),
            events: Vec::new(),
        })
    }

    /// What the robot is doing.
    pub fn phase(&self) -> DistBugPhase {
        self.phase
    }

    /// Where the robot takes itself to be, relative to its start.
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// The distance to the goal that the robot takes itself to have.
    pub fn goal_distance(&self) -> f64 {
        self.pose.distance_to(self.goal)
    }

    /// What it sees at the moment: the noise-filtered hits of the scan in the robot's frame.
    pub fn visible_points(&self) -> &[Point] {
        &self.points
    }

    /// Takes the events that have happened since the last call.
    pub fn take_events(&mut self) -> Vec<DistBugEvent> {
        std::mem::take(&mut self.events)
    }

    /// One control step: what the robot shall do until the next.
    pub fn step(&mut self, observation: &DistBugObservation<'_>) -> Result<Twist> {
        self.perceive(observation)?;
        if self.phase == DistBugPhase::LookingRound {
            return Ok(self.look_round());
        }
        self.matcher.learn(&self.points);
        if self.goal_distance() <= self.parameters.goal_tolerance {
            self.end(DistBugOutcome::Reached);
        }
        let heading = match self.phase {
            DistBugPhase::ToGoal => self.head_for_goal(),
            DistBugPhase::Following(_) => self.follow(),
            DistBugPhase::LookingRound | DistBugPhase::Ended(_) => None,
        };
        Ok(heading.map_or(Twist::STOP, |heading| self.steer(heading, observation.speed)))
    }

    /// Stands until the filter has something to go by, then turns once on the spot.
    fn look_round(&mut self) -> Twist {
        self.look.steps += 1;
        if self.look.steps < SETTLING_STEPS {
            return Twist::STOP;
        }
        self.matcher.learn(&self.points);
        let heading = self.pose.heading;
        self.look.turned += self.look.last.map_or(0.0, |last| angle_difference(heading, last));
        self.look.last = Some(heading);
        if !self.parameters.match_scans || self.look.turned >= std::f64::consts::TAU {
            self.phase = DistBugPhase::ToGoal;
            return Twist::STOP;
        }
        Twist::new(0.0, LOOKING_TURN)
    }

    /// Ends the run with a verdict from outside, such as that the time is over.
    pub fn end(&mut self, outcome: DistBugOutcome) {
        if !matches!(self.phase, DistBugPhase::Ended(_)) {
            self.phase = DistBugPhase::Ended(outcome);
            self.events.push(DistBugEvent::End(outcome));
        }
    }

    fn perceive(&mut self, observation: &DistBugObservation<'_>) -> Result<()> {
        if !observation.odometry.is_finite() {
            let Pose { x, y, heading } = observation.odometry;
            let found = format!("{x} m, {y} m, {heading} rad");
            return Err(Error::invalid_input("odometry", found, "finite numbers"));
        }
        let ranges = &observation.scan.ranges;
        if !ranges.is_empty() && ranges.iter().all(|range| range.is_nan()) {
            return Err(Error::invalid_input(
                "every range of the lidar scan",
                f64::NAN,
                "metres or +infinity",
            ));
        }
        self.pose = self.locate(observation);
        self.filter.update(self.pose, observation.scan)?;
        self.points.clear();
        self.points.extend(self.filter.points());
        let reach = REACH * self.parameters.follow_distances().step;
        self.surroundings.update(self.points.iter().copied(), reach);
        Ok(())
    }

    /// The pose by odometry, corrected by matching the scan as measured.
    fn locate(&mut self, observation: &DistBugObservation<'_>) -> Pose {
        if !self.parameters.match_scans {
            return observation.odometry;
        }
        self.points.clear();
        self.points.extend(observation.scan.points());
        self.matcher.update(observation.odometry, &self.points)
    }

    /// Bearing and distance of the goal, how far the way there is free, and what ends it.
    fn look_at_goal(&self) -> GoalView {
        let bearing = self.pose.bearing_to(self.goal);
        let distance = self.goal_distance();
        let radius = self.parameters.follow_distances().least;
        let (free, obstacle) = self.surroundings.free_distance(direction(bearing), radius);
        GoalView { bearing, distance, free, obstacle }
    }

    /// Drives at the goal; the heading to take.
    fn head_for_goal(&mut self) -> Option<f64> {
        let view = self.look_at_goal();
        let near = self.parameters.follow_distances().wished - self.parameters.robot_radius;
        match view.obstacle {
            Some(obstacle) if view.free < near && view.free < view.distance => self.hit(&view, obstacle),
            _ => Some(view.bearing),
        }
    }

    /// Starts to follow what is in the way.
    fn hit(&mut self, view: &GoalView, obstacle: Point) -> Option<f64> {
        let distances = self.parameters.follow_distances();
        let side = self
            .parameters
            .side
            .unwrap_or_else(|| nearer_side(view.bearing, obstacle, &mut self.surroundings, distances));
        let point = self.pose.position();
        self.note_boundary(view.distance - view.free);
        self.follower = Some(Following {
            boundary: BoundaryFollower::new(side, distances, self.pose.to_world(obstacle)),
            nearest: view.distance,
            progress: LoopProgress::new(self.pose),
        });
        self.phase = DistBugPhase::Following(side);
        self.events.push(DistBugEvent::Hit { point, side });
        self.follow()
    }

    /// Follows the boundary until it can be left or is closed; the heading to take.
    fn follow(&mut self) -> Option<f64> {
        let view = self.look_at_goal();
        let along_boundary = self.is_at_followed_boundary(&view);
        let boundary = if along_boundary { view.distance - view.free } else { view.distance };
        self.least_distance = self.least_distance.min(boundary);
        if !along_boundary && self.may_leave(&view) {
            self.leave(&view);
            return Some(view.bearing);
        }
        let slack = self.position_slack();
        let goal_has_room = self.goal_has_room();
        let following = self.follower.as_mut()?;
        following.nearest = following.nearest.min(view.distance);
        // As near as obstacles and the knowledge of the position allow, and going away again.
        let passed = view.distance > following.nearest + PASSING_MARGIN;
        if passed && following.nearest <= self.parameters.goal_tolerance + slack && goal_has_room {
            self.end(DistBugOutcome::Reached);
            return None;
        }
        let heading = following.boundary.heading(&self.pose, &mut self.surroundings);
        let all_round = following.progress.update(self.pose, heading, self.parameters.robot_radius);
        if all_round {
            self.end(DistBugOutcome::Unreachable);
            return None;
        }
        heading
    }

    /// Whether nothing is seen where the robot would stand at the goal, errors of the position aside.
    fn goal_has_room(&self) -> bool {
        let goal = self.pose.to_local(self.goal);
        let room = GOAL_ROOM * self.parameters.robot_radius;
        self.points.iter().all(|point| (point - goal).norm() > room)
    }

    /// Takes in how near to the goal the boundary of a new obstacle begins. If the last leave has not brought the
    /// robot as much nearer as it promised, free ranges are relied upon less from now on; so the robot cannot go back
    /// and forth for ever because of errors.
    fn note_boundary(&mut self, distance: f64) {
        if distance > self.least_distance - 0.5 * self.parameters.step && self.least_distance.is_finite() {
            self.doubt = (2.0 * self.doubt).min(MAX_DOUBT);
        }
        self.least_distance = self.least_distance.min(distance);
    }

    /// Whether what ends the way to the goal is the followed obstacle itself, a margin away: then the disc pushed up
    /// to it is a point of the boundary, not a place to leave for.
    fn is_at_followed_boundary(&self, view: &GoalView) -> bool {
        let DistBugPhase::Following(side) = self.phase else { return false };
        let distances = self.parameters.follow_distances();
        let margin = distances.wished - distances.least + self.parameters.step;
        let towards_it = math::sin(view.bearing) * side.sense() < 0.2;
        towards_it && view.free < margin && view.free < view.distance
    }

    /// The leave condition.
    fn may_leave(&self, view: &GoalView) -> bool {
        if view.free >= view.distance && view.distance < self.parameters.robot_radius {
            return true;
        }
        let free = view.free.min(view.distance) * (1.0 - self.doubt);
        view.distance - free <= self.least_distance - self.parameters.step
    }

    /// How wrong the robot's position may well be, in metres, judged by the noise of its ranges; never as much as
    /// would let a goal behind a wall count.
    fn position_slack(&self) -> f64 {
        (NOISE_SLACK * self.filter.noise()).min(self.parameters.robot_radius)
    }

    fn leave(&mut self, view: &GoalView) {
        self.follower = None;
        self.phase = DistBugPhase::ToGoal;
        let point = self.pose.position();
        self.events.push(DistBugEvent::Leave { point, free: view.free.min(view.distance) });
    }

    /// The twist that turns the robot to a heading and drives it on.
    fn steer(&self, heading: f64, speed: Twist) -> Twist {
        // Proportional to the error, damped by the turn rate: the motors' lag would make it swing otherwise.
        let angular = (8.0 * heading - 1.5 * speed.angular).clamp(-3.0, 3.0);
        let ahead = math::cos(heading).max(0.0);
        let aligned = ahead * ahead * ahead;
        let cruise = match self.phase {
            DistBugPhase::ToGoal => self.parameters.cruise_speed,
            _ => self.parameters.follow_speed,
        };
        let linear = (cruise * aligned).min(self.safe_speed());
        Twist::new(linear, angular)
    }

    /// The speed from which the robot can still stop before what is ahead, or at the goal.
    fn safe_speed(&self) -> f64 {
        // The motors' lag lets the robot roll on for about 0.2 s; a little more is reserve.
        const STOPPING_TIME: f64 = 0.45;
        let outline = self.parameters.robot_radius + 0.5 * self.parameters.least_clearance;
        let (ahead, _) = self.surroundings.free_distance(direction(0.0), outline);
        let goal = self.goal_distance();
        let creep = 0.02;
        (ahead / STOPPING_TIME).min(goal / STOPPING_TIME).max(creep)
    }

    /// Drives a robot to the goal, or finds that there is no way, within `time_limit` seconds. `observe` is called
    /// after every step.
    pub fn run<R: Clock + Drive + Lidar + ?Sized>(
        &mut self,
        robot: &mut R,
        time_limit: f64,
        mut observe: impl FnMut(&mut Self, f64),
    ) -> Result<DistBugOutcome> {
        let mut scan = LidarScan::default();
        let begin = robot.now()?;
        let mut next = begin;
        let mut last = f64::NEG_INFINITY;
        loop {
            let now = robot.now()?;
            if now <= last {
                return Err(Error::new(ErrorKind::Other, "the robot's clock stands still"));
            }
            last = now;
            if now - begin >= time_limit {
                self.end(DistBugOutcome::TimedOut);
            }
            robot.scan_into(&mut scan)?;
            let observation =
                DistBugObservation { odometry: robot.pose()?, speed: robot.speed()?, scan: &scan };
            let twist = self.step(&observation)?;
            robot.set_speed(twist)?;
            observe(self, now);
            if let DistBugPhase::Ended(outcome) = self.phase {
                return Ok(outcome);
            }
            next += self.parameters.period;
            let pause = next - robot.now()?;
            robot.wait(pause)?;
        }
    }
}

/// The goal as the robot sees it.
#[derive(Debug, Clone, Copy)]
struct GoalView {
    bearing: f64,
    distance: f64,
    free: f64,
    obstacle: Option<Point>,
}
