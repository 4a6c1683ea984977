use std::collections::VecDeque;
use std::f64::consts::{FRAC_PI_2, TAU};

use super::super::way::{ALIGNED, TURN_GAIN};
use super::memory::{Median, Memory, hit};
use super::parameters::mirror;
use super::tracker::{ONE_SURFACE, Reading, WallTracker};
use super::{WallFollowerParameters, WallObservation, WallSensors, WallSide};
use crate::geometry::{FittedLine, Point, Pose, Twist, angle_difference, math, normalize_angle};
use crate::io::Result;

/// Phase of a [`WallFollower`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum WallPhase {
    /// Driving straight on until a wall is near (the book's step 1).
    Searching,
    /// Turning until the wall is beside the robot (steps 2 and 4).
    Turning,
    /// Driving along the wall (step 3).
    Following,
    /// Driving round an outer corner or the end of a wall.
    Rounding,
}

/// Follows walls with three distance sensors: ahead, left and right (an improved version of the book's
/// chapter 6).
///
/// Every reading becomes a point in the odometry frame; walls are lines and curves fitted to these points.
/// The robot drives until something is near, swaying a little so that the front ray covers its whole width.
/// Then it turns on the spot while the front ray sweeps over the obstacle. A line fit through these points,
/// not a fixed angle, gives the wall's direction; this works in corners too, where the left and right ranges
/// belong to different walls. Along the wall a Kalman filter estimates distance, direction and curvature.
/// Where the wall ends, the robot drives round the end at the same distance until it sees the next wall.
///
/// ```
/// use roverlab::drive::{AlongWall, WallFollower, WallFollowerParameters};
/// use roverlab::geometry::Pose;
/// use roverlab::io::control::run;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::world::{RobotSpec, Scene, World};
/// # fn main() -> roverlab::io::Result<()> {
/// let scene = Scene::with_robot(World::walled(2.0, 2.0), RobotSpec::s4(), Pose::new(1.0, 1.0, 0.4));
/// let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
/// let mut follower = WallFollower::new(WallFollowerParameters::default())?;
/// run(&mut simulation.robot(0)?, &mut AlongWall::new(&mut follower), 60.0, |_, _, _| {})?;
/// let truth = simulation.truth().robot(0)?;
/// assert_eq!(truth.contacts, 0);
/// assert!(truth.path_length > 6.0);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct WallFollower {
    parameters: WallFollowerParameters,
    /// Sensors of the robot or of its mirror image: internally the wall is always on the left.
    sensors: WallSensors,
    side: Option<WallSide>,
    state: State,
    last: Option<Pose>,
    /// Distance driven (m) and angle turned (rad) since the start.
    driven: f64,
    turned: f64,
    front: Median,
    /// Wall points from the side sensor, and points swept by the front sensor.
    beside: Memory,
    swept: Memory,
    /// Observations of the approach to a wall.
    approach: VecDeque<WallObservation>,
    /// Number of consecutive readings off the wall.
    strays: u32,
}

#[derive(Debug, Clone, PartialEq)]
enum State {
    Searching {
        /// Heading of the straight line, and its start.
        heading: f64,
        since: f64,
    },
    Turning {
        /// Angle turned since the wall was met.
        since: f64,
        /// Estimated heading along the wall.
        target: Option<f64>,
    },
    Following(WallTracker),
    Rounding {
        /// End of the wall, and its direction there.
        corner: Point,
        along: f64,
        /// Distance driven when it was lost.
        since: f64,
    },
}

/// Speed of the search for a wall, relative to the speed along it.
const SEARCH_SPEED: f64 = 0.6;
/// Amplitude of the swaying during the search, once a second, by which the single ray ahead covers the
/// robot's width (rad).
const SWAY: f64 = 0.42;
/// Number of remembered observations of the approach to a wall.
const APPROACH: usize = 50;
/// Angle beyond which a wall runs across the robot's path (rad).
const ACROSS: f64 = 0.6;
/// Number of points of the side sensor that determine anew a wall across the robot's path.
const RENEWAL_POINTS: usize = 12;
/// Number of consecutive readings after which a wall has ended, or another begins.
const STRAYS: u32 = 4;
/// Number of points for the line of a new wall.
const NEW_WALL_POINTS: usize = 20;
/// Weight of the corner in the line of a wall that begins there (points).
const CORNER_WEIGHT: usize = 8;
/// Angle to a new wall at which it is followed (rad).
const NEW_WALL_ANGLE: f64 = 0.3;
/// Radius around the nearest swept point within which points belong to the same wall (m).
const SAME_WALL: f64 = 0.13;

impl WallFollower {
    /// Creates a follower that knows no wall yet. Fails for parameters out of range.
    pub fn new(parameters: WallFollowerParameters) -> Result<Self> {
        parameters.validate()?;
        let side = parameters.side;
        let mut follower = Self {
            parameters,
            sensors: parameters.sensors,
            side: None,
            state: State::Searching { heading: 0.0, since: 0.0 },
            last: None,
            driven: 0.0,
            turned: 0.0,
            front: Median::new(),
            beside: Memory::new(120),
            swept: Memory::new(400),
            approach: VecDeque::new(),
            strays: 0,
        };
        if let Some(side) = side {
            follower.choose(side);
        }
        Ok(follower)
    }

    fn choose(&mut self, side: WallSide) {
        self.side = Some(side);
        self.sensors = match side {
            WallSide::Left => self.parameters.sensors,
            WallSide::Right => self.parameters.sensors.mirrored(),
        };
        // Remembered points belong to the other mirror image.
        if side == WallSide::Right {
            self.last = self.last.map(mirror);
            self.approach.iter_mut().for_each(|seen| *seen = seen.mirrored());
        }
    }

    /// Side of the wall, once decided.
    pub fn side(&self) -> Option<WallSide> {
        self.side
    }

    /// Current phase.
    pub fn phase(&self) -> WallPhase {
        match self.state {
            State::Searching { .. } => WallPhase::Searching,
            State::Turning { .. } => WallPhase::Turning,
            State::Following(_) => WallPhase::Following,
            State::Rounding { .. } => WallPhase::Rounding,
        }
    }

    /// Its parameters.
    pub fn parameters(&self) -> &WallFollowerParameters {
        &self.parameters
    }

    /// The next velocity. Fails for a NaN range or a pose that is not finite.
    pub fn step(&mut self, observation: &WallObservation) -> Result<Twist> {
        observation.check()?;
        if self.side == Some(WallSide::Right) {
            let twist = self.step_left(&observation.mirrored());
            return Ok(Twist::new(twist.linear, -twist.angular));
        }
        Ok(self.step_left(observation))
    }

    /// The velocity of the robot, or of its mirror image, with the wall on the left.
    fn step_left(&mut self, seen: &WallObservation) -> Twist {
        let pose = seen.pose;
        let motion = self.last.map_or(Pose::default(), |last| last.inverse().compose(&pose));
        if self.last.is_none() {
            self.state = State::Searching { heading: pose.heading, since: 0.0 };
        }
        self.last = Some(pose);
        self.driven += math::hypot(motion.x, motion.y);
        self.turned += motion.heading.abs();
        let ahead = self.front.add(seen.front) + self.sensors.front.x;
        let aside = hit(&pose, &self.sensors.left, seen.left);
        let before = hit(&pose, &self.sensors.front, seen.front);
        match self.state.clone() {
            State::Searching { heading, since } => self.search(seen, ahead, heading, since),
            State::Turning { since, target } => self.turn(seen, before, since, target),
            State::Following(tracker) => self.follow(tracker, &motion, &pose, ahead, aside),
            State::Rounding { corner, along, since } => self.round(&pose, ahead, aside, corner, along, since),
        }
    }

    /// Step 1: drives straight on, swaying.
    fn search(&mut self, seen: &WallObservation, ahead: f64, heading: f64, since: f64) -> Twist {
        let WallFollowerParameters { distance, speed, lag, .. } = self.parameters;
        let pose = seen.pose;
        let [left, right] = [(seen.left, self.sensors.left), (seen.right, self.sensors.right)]
            .map(|(range, mount)| range + mount.y.abs());
        let slow = SEARCH_SPEED * speed;
        if self.approach.len() == APPROACH {
            self.approach.pop_front();
        }
        self.approach.push_back(*seen);
        if ahead < distance + lag * slow || left.min(right) < 0.9 * distance {
            return self.meet(left, right, ahead);
        }
        let wish = SWAY * math::sin(TAU * (self.driven - since) / slow);
        let rate = SWAY * TAU * math::cos(TAU * (self.driven - since + lag * slow) / slow);
        let error = angle_difference(heading + wish, pose.heading);
        Twist::new(slow, rate + 2.0 * error)
    }

    /// Something is near for the first time.
    fn meet(&mut self, left: f64, right: f64, ahead: f64) -> Twist {
        let nearer = if right < left { WallSide::Right } else { WallSide::Left };
        // The robot turns less if the wall goes to the side where it is nearer.
        let undecided = self.side.is_none();
        if undecided {
            self.choose(nearer);
        }
        // From here on the wall is to be on the left of the robot or of its mirror image.
        let beside = if undecided { left.min(right) } else { left };
        let distance = self.parameters.distance;
        let line = self.approached_wall().filter(|_| beside < distance && beside < ahead);
        if let Some(line) = line {
            self.begin_following(WallTracker::of_line(&line, self.parameters.range_error));
            return Twist::new(0.5 * self.parameters.speed, 0.0);
        }
        self.begin_turning();
        Twist::STOP
    }

    /// Line of the wall in the robot's frame, from the front and left readings of the approach (the book's
    /// figure 6.2), if both belong to one wall.
    fn approached_wall(&self) -> Option<FittedLine> {
        let pose = self.approach.back()?.pose;
        let front = self.approach.iter().filter_map(|seen| hit(&seen.pose, &self.sensors.front, seen.front));
        let left = self.approach.iter().filter_map(|seen| hit(&seen.pose, &self.sensors.left, seen.left));
        let near = |point: &Point| pose.distance_to(*point) < 3.0 * self.parameters.distance;
        let line = FittedLine::through(left.chain(front).filter(near).map(|point| pose.to_local(point)))?;
        let error = 1.8 * self.parameters.range_error.max(0.003);
        let ahead = line.direction.x > 0.5 && line.distance_to(Point::origin()) < 0.0;
        (ahead && line.rms < error && line.length > 0.05).then_some(line)
    }

    /// Steps 2 and 4: turns clockwise on the spot until the swept wall is on the left.
    fn turn(
        &mut self,
        seen: &WallObservation,
        before: Option<Point>,
        since: f64,
        target: Option<f64>,
    ) -> Twist {
        let pose = seen.pose;
        if let Some(point) = before {
            self.swept.add(point);
        }
        let turned = self.turned - since;
        let line = self.swept_wall(&pose);
        let target = line.map_or(target, |line| Some(normalize_angle(pose.heading + line.angle())));
        self.state = State::Turning { since, target };
        let rate = self.parameters.turn_rate;
        // The heading error is taken the long way round: the wall must pass ahead of the robot first.
        let rest = target.map_or(FRAC_PI_2, |target| {
            let rest = -angle_difference(target, pose.heading);
            if rest < -0.5 * FRAC_PI_2 { rest + TAU } else { rest }
        });
        if let Some(line) = line.filter(|_| rest.abs() < ALIGNED) {
            self.begin_following(self.swept_tracker(&line, &pose));
            return Twist::STOP;
        }
        if turned > 1.5 * TAU {
            self.state = State::Searching { heading: pose.heading, since: self.driven };
        }
        Twist::new(0.0, -(TURN_GAIN * rest).clamp(-rate, rate))
    }

    /// The line through the swept points around the nearest one, in the robot's frame, directed along the
    /// robot's way.
    fn swept_wall(&self, pose: &Pose) -> Option<FittedLine> {
        /// Minimum number of points for a line.
        const LEAST: usize = 15;
        if self.swept.len() < LEAST {
            return None;
        }
        let nearest = self.swept.nearest(pose.position(), f64::INFINITY)?;
        let near = self.swept.iter().filter(|point| (point - nearest).norm() < SAME_WALL);
        let line = FittedLine::through(near.map(|point| pose.to_local(point)))?;
        // Seen from inside, a wall on the left runs in the driving direction.
        let left_of_robot = line.distance_to(Point::origin()) < 0.0;
        let direction = if left_of_robot { line.direction } else { -line.direction };
        (line.length > 0.4 * SAME_WALL && line.points >= LEAST).then_some(FittedLine { direction, ..line })
    }

    /// A tracker of the swept wall, with its curvature.
    fn swept_tracker(&self, line: &FittedLine, pose: &Pose) -> WallTracker {
        let error = self.parameters.range_error;
        let mut tracker = WallTracker::like_line(line);
        let near = |point: &Point| (point - line.middle).norm() < 1.5 * SAME_WALL;
        for point in self.swept.iter().map(|point| pose.to_local(point)).filter(near) {
            tracker.update(point, error);
        }
        tracker
    }

    fn begin_following(&mut self, tracker: WallTracker) {
        self.state = State::Following(tracker);
        self.beside.clear();
        self.strays = 0;
    }

    /// Step 3: drives along the wall.
    fn follow(
        &mut self,
        mut tracker: WallTracker,
        motion: &Pose,
        pose: &Pose,
        ahead: f64,
        aside: Option<Point>,
    ) -> Twist {
        tracker.predict(motion);
        let reading = aside.map_or(Reading::Beyond, |point| {
            tracker.update(pose.to_local(point), self.parameters.range_error)
        });
        if let Some(point) = aside {
            self.beside.add(point);
        }
        self.strays = if reading == Reading::Wall { 0 } else { self.strays + 1 };
        if self.strays >= STRAYS {
            self.strays = 0;
            if reading == Reading::Before {
                let distance = aside.map_or(self.parameters.distance, |point| pose.to_local(point).y);
                tracker = WallTracker::beside(distance, self.parameters.range_error);
            } else {
                return self.lose(&tracker, pose, ahead);
            }
        }
        if tracker.angle().abs() > ACROSS && self.beside.len() >= RENEWAL_POINTS {
            tracker = self.renewed(tracker, pose);
        }
        self.state = State::Following(tracker);
        if self.meets_wall(ahead) {
            return self.begin_turning();
        }
        let error = tracker.distance() - self.parameters.distance;
        self.steer(error, tracker.angle(), self.path_curvature(tracker.curvature()))
    }

    /// Refits the wall to its last points: a parabola in the robot's frame fails for a wall that runs across
    /// it.
    fn renewed(&mut self, tracker: WallTracker, pose: &Pose) -> WallTracker {
        let error = self.parameters.range_error;
        let line = self.beside.last_line(RENEWAL_POINTS, &[], pose);
        let along = |line: &FittedLine| line.direction.x > 0.0 && line.angle().abs() < ACROSS;
        let line = line.filter(|line| line.rms < 2.0 * error.max(0.002) && along(line));
        let beside = self.beside.iter().last().map(|point| pose.to_local(point).y);
        self.beside.clear();
        match (line, beside) {
            (Some(line), _) => WallTracker::of_line(&line, error),
            // So few points say too little about the direction.
            (None, Some(distance)) => WallTracker::beside(distance, error),
            (None, None) => tracker,
        }
    }

    /// Whether the wall ahead is within the stopping distance.
    fn meets_wall(&self, ahead: f64) -> bool {
        ahead < self.parameters.distance + 0.9 * self.parameters.lag * self.parameters.speed
    }

    fn begin_turning(&mut self) -> Twist {
        self.state = State::Turning { since: self.turned, target: None };
        self.swept.clear();
        Twist::new(0.0, -self.parameters.turn_rate)
    }

    /// Curvature of the path beside a wall of this curvature (1/m).
    fn path_curvature(&self, wall: f64) -> f64 {
        wall / (1.0 + wall * self.parameters.distance).max(0.25)
    }

    /// The velocity for a distance error (m, positive too far from the wall), the wall's direction (rad) and
    /// the path's curvature (1/m).
    fn steer(&self, error: f64, angle: f64, curvature: f64) -> Twist {
        let WallFollowerParameters { distance, speed, turn_rate, reach, .. } = self.parameters;
        // Far from its line the robot approaches at an angle of at most a radian.
        let pull = (error / reach).clamp(-1.5, 1.5);
        let bend = curvature + (2.0 * math::sin(angle) + pull) / reach;
        let slow = math::cos(angle).max(0.2) * (1.0 - 0.5 * (error.abs() / distance).min(1.0));
        let speed = (speed * slow).min(1.6 * turn_rate / bend.abs().max(1e-9));
        Twist::new(speed, (speed * bend).clamp(-1.6 * turn_rate, 1.6 * turn_rate))
    }

    /// Handles the loss of the wall by the side sensor.
    fn lose(&mut self, tracker: &WallTracker, pose: &Pose, ahead: f64) -> Twist {
        // The wall's last point is where the sensor was a few readings ago.
        let back = f64::from(STRAYS) * self.parameters.speed * self.parameters.period;
        let corner = pose.to_world(tracker.point_at(self.sensors.left.x - back));
        let along = normalize_angle(pose.heading + tracker.angle());
        self.beside.clear();
        self.state = State::Rounding { corner, along, since: self.driven };
        self.round(pose, ahead, None, corner, along, self.driven)
    }

    /// Drives round the end of the wall until the next one is beside the robot.
    fn round(
        &mut self,
        pose: &Pose,
        ahead: f64,
        aside: Option<Point>,
        corner: Point,
        along: f64,
        since: f64,
    ) -> Twist {
        let WallFollowerParameters { distance, speed, lag, range_error, .. } = self.parameters;
        if self.meets_wall(ahead) {
            return self.begin_turning();
        }
        if let Some(point) = aside.filter(|point| (point - corner).norm() < 2.5 * distance) {
            self.beside.add(point);
        }
        if let Some(line) = self.new_wall(pose, corner) {
            self.begin_following(WallTracker::of_line(&line, range_error));
        } else if self.driven - since > 1.3 * TAU * distance {
            self.state = State::Searching { heading: pose.heading, since: self.driven };
        }
        let beside = Pose::new(corner.x, corner.y, along).to_local(pose.position());
        // Before the corner the robot keeps to the known wall, beyond it to a circle.
        if beside.x < 0.0 {
            let curvature = if beside.x + lag * speed > 0.0 { 1.0 / distance } else { 0.0 };
            return self.steer(-beside.y - distance, angle_difference(along, pose.heading), curvature);
        }
        let (pivot, curvature) = self.pivot(pose, corner);
        let away = pivot - pose.position();
        let direction = math::atan2(away.y, away.x) - FRAC_PI_2;
        self.steer(away.norm() - distance, angle_difference(direction, pose.heading), curvature)
    }

    /// Pivot of the robot's path, and the path's curvature: the end of the wall, or a nearer point seen
    /// behind it. The end may be thick, with another corner before the next wall is known.
    fn pivot(&self, pose: &Pose, corner: Point) -> (Point, f64) {
        let round = 1.0 / self.parameters.distance;
        let gap = |point: Point| (point - pose.position()).norm();
        let seen = self.beside.nearest(pose.position(), ONE_SURFACE);
        // Along a surface the path is straight, round its end curved; here either is possible.
        seen.filter(|&seen| gap(seen) < gap(corner)).map_or((corner, round), |seen| (seen, 0.5 * round))
    }

    /// The wall behind a corner, once the robot drives nearly along it.
    fn new_wall(&self, pose: &Pose, corner: Point) -> Option<FittedLine> {
        let WallFollowerParameters { distance, range_error, .. } = self.parameters;
        let line = self.beside.last_line(NEW_WALL_POINTS, &[], pose)?;
        // A wall that begins at the corner is known better with it.
        let at_corner = line.distance_to(pose.to_local(corner)).abs() < ONE_SURFACE;
        let line = if at_corner {
            self.beside.last_line(NEW_WALL_POINTS, &[corner; CORNER_WEIGHT], pose)?
        } else {
            line
        };
        let gap = -line.distance_to(Point::origin());
        let good = line.direction.x > 0.0
            && line.rms < 2.0 * range_error.max(0.002)
            && line.angle().abs() < NEW_WALL_ANGLE
            && (gap - distance).abs() < 0.5 * distance;
        good.then_some(line)
    }
}
