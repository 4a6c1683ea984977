use super::parameters::BugParameters;
use super::report::{BugEvent, BugOutcome, BugPhase};
use super::wall_ends::{WallEnds, overhangs};
use crate::geometry::{Point, Pose, Twist, Vector, WallSide, angle_difference, direction, math};
use crate::io::control::LidarObservation;
use crate::io::reading::{check_pose, check_scan, point_in_words};
use crate::io::{Error, Result};
use crate::nav::boundary::nearer_side;
use crate::nav::surroundings::Surroundings;
use crate::scan::{ScanFilter, ScanMatcher};

/// State common to all bugs: localisation, perception and steering.
///
/// The robot is a disc; boundaries are those of obstacles inflated by its radius plus the minimum clearance.
#[derive(Debug, Clone)]
pub(super) struct Body {
    pub(super) parameters: BugParameters,
    pub(super) goal: Point,
    pub(super) phase: BugPhase,
    pub(super) pose: Pose,
    pub(super) surroundings: Surroundings,
    /// Noise-filtered points of the scan, in the robot's frame.
    pub(super) points: Vec<Point>,
    pub(super) events: Vec<BugEvent>,
    /// Points of the scan as measured, in the robot's frame.
    measured: Vec<Point>,
    /// How many more looks at the goal saw no room there than saw some.
    cramped: i32,
    slow_to_pass: bool,
    ends: WallEnds,
    look: LookRound,
    filter: ScanFilter,
    matcher: ScanMatcher,
}

/// Progress of the initial look round.
#[derive(Debug, Clone, Default)]
struct LookRound {
    steps: u32,
    turned: f64,
    last: Option<f64>,
}

/// The goal as seen from the robot.
#[derive(Debug, Clone, Copy)]
pub(super) struct GoalView {
    pub(super) bearing: f64,
    pub(super) distance: f64,
    /// How far the disc can move towards the goal, and the point it touches there.
    pub(super) free: f64,
    pub(super) obstacle: Option<Point>,
    /// Direction in which the disc can move straight to within the tolerance of a goal that is near.
    pub(super) at_hand: Option<f64>,
}

/// Radius around the robot within which points count for its next step (steps).
const REACH: f64 = 2.4;
/// Radius within which the ends of walls are remembered, relative to that.
const ENDS_REACH: f64 = 1.7;
/// Maximum distance between two observations of one point without noise (m).
const EXACT: f64 = 0.003;
/// Part of that distance by noise, relative to the range noise.
const ENDS_SLACK: f64 = 5.0;
/// Fraction of the goal's tolerance that is used where the robot cannot come nearer.
const USED_TOLERANCE: f64 = 0.9;
/// Distance within which a goal is near, relative to the distance kept from obstacles.
const NEAR: f64 = 1.5;
/// Maximum error of a point, relative to the noise of ranges and to the deviation of the pose, by which the
/// goal is off.
const NOISE_SLACK: f64 = 2.0;
/// Maximum error of a point without noise (m).
const POINT_ERROR: f64 = 0.002;
/// Points tried around the goal: number of rings, and points per ring.
const RINGS: u32 = 4;
const DIRECTIONS: u32 = 24;
/// Turn rate while looking around (rad/s).
const LOOKING_TURN: f64 = 2.0;
/// Minimum speed along a free heading (m/s).
const CREEP: f64 = 0.02;
/// Maximum deviation from that heading (rad).
const POINTING: f64 = 0.3;
/// Speed per distance of the approach to a stopping point (1/s).
const APPROACH_RATE: f64 = 4.0;
/// Turn above which the robot turns around (rad).
const TURNING_ROUND: f64 = 2.0;
/// Speed that is too high for turning around (m/s).
const ROLLING: f64 = 0.05;
/// Number of initial steps without motion.
const SETTLING_STEPS: u32 = 12;

impl Body {
    pub(super) fn new(goal: Point, parameters: BugParameters, slow_to_pass: bool) -> Result<Self> {
        parameters.validate()?;
        if !(goal.x.is_finite() && goal.y.is_finite()) {
            return Err(Error::invalid_input("goal", point_in_words(goal), "finite numbers"));
        }
        Ok(Self {
            parameters,
            goal,
            phase: BugPhase::LookingRound,
            pose: Pose::default(),
            surroundings: Surroundings::default(),
            points: Vec::new(),
            events: Vec::new(),
            measured: Vec::new(),
            cramped: 0,
            slow_to_pass,
            ends: WallEnds::default(),
            look: LookRound::default(),
            filter: ScanFilter::new(),
            matcher: ScanMatcher::new(),
        })
    }

    pub(super) fn goal_distance(&self) -> f64 {
        self.pose.distance_to(self.goal)
    }

    /// Ends the run, unless it has ended.
    pub(super) fn end(&mut self, outcome: BugOutcome) {
        if !matches!(self.phase, BugPhase::Ended(_)) {
            self.phase = BugPhase::Ended(outcome);
            self.events.push(BugEvent::End(outcome));
        }
    }

    /// Updates pose and surroundings from an observation.
    pub(super) fn perceive(&mut self, observation: &LidarObservation) -> Result<()> {
        check_pose(&observation.odometry)?;
        check_scan(&observation.scan)?;
        self.measured.clear();
        self.measured.extend(observation.scan.points());
        self.pose = self.locate(observation);
        self.filter.update(self.pose, &observation.scan)?;
        let reach = REACH * self.parameters.follow_distances().step;
        let error = EXACT + ENDS_SLACK * self.filter.noise();
        self.ends.update(&self.pose, &self.measured, ENDS_REACH * reach, error);
        self.points.clear();
        self.points.extend(self.filter.points());
        let hidden = self.ends.hidden(&self.pose, &self.points, error);
        let unseen = hidden.chain(overhangs(&self.measured, reach, error));
        self.surroundings.update(self.points.iter().copied().chain(unseen), reach);
        Ok(())
    }

    /// Pose by odometry, corrected by matching the measured scan.
    fn locate(&mut self, observation: &LidarObservation) -> Pose {
        if !self.parameters.match_scans {
            return observation.odometry;
        }
        self.matcher.update(observation.odometry, &self.measured)
    }

    /// Standard deviation of the position (m). Uncorrected odometry counts as exact.
    fn pose_deviation(&self) -> f64 {
        if self.parameters.match_scans { self.matcher.deviation() } else { 0.0 }
    }

    /// Adds the current points to the map for later corrections.
    pub(super) fn learn(&mut self) {
        self.matcher.learn(&self.points);
    }

    /// Stands until the range filter has enough scans, then turns once on the spot.
    pub(super) fn look_round(&mut self) -> Twist {
        self.look.steps += 1;
        if self.look.steps < SETTLING_STEPS {
            return Twist::STOP;
        }
        self.learn();
        let heading = self.pose.heading;
        self.look.turned += self.look.last.map_or(0.0, |last| angle_difference(heading, last));
        self.look.last = Some(heading);
        if !self.parameters.match_scans || self.look.turned >= std::f64::consts::TAU {
            self.phase = BugPhase::ToGoal;
            return Twist::STOP;
        }
        Twist::new(0.0, LOOKING_TURN)
    }

    /// Bearing and distance of the goal, free distance towards it, and the point that limits it.
    pub(super) fn look_at_goal(&self) -> GoalView {
        let bearing = self.pose.bearing_to(self.goal);
        let distance = self.goal_distance();
        let radius = self.parameters.follow_distances().least;
        let (free, obstacle) = self.surroundings.free_distance(direction(bearing), radius);
        let straight = free >= distance - USED_TOLERANCE * self.parameters.goal_tolerance;
        let at_hand = if distance >= NEAR * self.parameters.follow_distances().wished {
            None
        } else if straight {
            Some(bearing)
        } else {
            self.beside_goal()
        };
        GoalView { bearing, distance, free, obstacle, at_hand }
    }

    /// Direction to the nearest place within the goal's tolerance that the disc can move straight to. Near
    /// walls there may be room beside the straight way to the goal alone.
    fn beside_goal(&self) -> Option<f64> {
        let goal = self.pose.to_local(self.goal);
        let radius = self.parameters.follow_distances().least;
        let ways = around(USED_TOLERANCE * self.parameters.goal_tolerance).map(|away| goal.coords + away);
        let leads_there = |way: &Vector| {
            let (free, _) = self.surroundings.free_distance(direction(math::atan2(way.y, way.x)), radius);
            free >= way.norm()
        };
        let nearest = ways.filter(leads_there).min_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
        nearest.map(|way| math::atan2(way.y, way.x))
    }

    /// Whether the way to the goal is blocked at the robot.
    pub(super) fn is_blocked(&self, view: &GoalView) -> bool {
        let near = self.parameters.follow_distances().wished - self.parameters.robot_radius;
        view.free < near && view.free < view.distance
    }

    /// The side on which to follow an obstacle, unless the strategy chooses one.
    pub(super) fn usual_side(&mut self, view: &GoalView, obstacle: Point) -> WallSide {
        let distances = self.parameters.follow_distances();
        self.parameters
            .side
            .unwrap_or_else(|| nearer_side(view.bearing, obstacle, &mut self.surroundings, distances))
    }

    /// Whether the followed obstacle itself, within its margin, ends the way to the goal. Then the disc
    /// pushed up to it is a point of the boundary, not a reason to leave.
    pub(super) fn is_at_followed_boundary(&self, view: &GoalView, side: WallSide) -> bool {
        let distances = self.parameters.follow_distances();
        let margin = distances.wished - distances.least + self.parameters.step;
        let towards_it = math::sin(view.bearing) * side.sense() < 0.2;
        towards_it && view.free < margin && view.free < view.distance
    }

    /// Looks for room at the goal; ends the run if there is certainly none.
    pub(super) fn look_for_room(&mut self) {
        if self.goal_distance() > 2.0 * NEAR * self.parameters.follow_distances().wished {
            return;
        }
        let tolerance = self.parameters.goal_tolerance;
        self.cramped += if self.has_room_within(USED_TOLERANCE * tolerance, 0.0) { -1 } else { 1 };
        let error = POINT_ERROR + NOISE_SLACK * (self.filter.noise() + self.pose_deviation());
        if !self.has_room_within(tolerance, error) {
            self.end(BugOutcome::NoRoom);
        }
    }

    /// Whether the visible points leave room for the disc within a distance of the goal, if they may be off
    /// by an error.
    fn has_room_within(&self, distance: f64, error: f64) -> bool {
        let least = self.parameters.follow_distances().least - error;
        let goal = self.pose.to_local(self.goal);
        let aways = self.points.iter().map(|point| point - goal);
        let near: Vec<Vector> = aways.filter(|away| away.norm() < least + distance).collect();
        let has_room = |place: Vector| near.iter().all(|point| (point - place).norm() >= least);
        has_room(Vector::zeros()) || around(distance).any(has_room)
    }

    /// Ends a run to a goal to which no way leads. If most looks saw no room at the goal, that is why.
    pub(super) fn give_up(&mut self) {
        self.end(if self.cramped > 0 { BugOutcome::NoRoom } else { BugOutcome::Unreachable });
    }

    /// The twist that turns the robot to a heading and drives it on.
    pub(super) fn steer(&self, heading: f64, speed: Twist) -> Twist {
        // Proportional to the error and damped by the turn rate: the motors' lag would cause oscillation
        // otherwise. A robot that turns round while rolling moves in an arc, into what it just passed; so it
        // stops first.
        let stops = heading.abs() > TURNING_ROUND && speed.linear > ROLLING;
        let turn = if stops { 0.0 } else { 8.0 * heading };
        let angular = (turn - 1.5 * speed.angular).clamp(-3.0, 3.0);
        let ahead = math::cos(heading).max(0.0);
        let aligned = ahead * ahead * ahead;
        let cruise = match self.phase {
            BugPhase::ToGoal => self.parameters.cruise_speed,
            _ => self.parameters.follow_speed,
        };
        // The heading is known to be free, but directions passed while turning to it may not be.
        let least = if heading.abs() < POINTING { CREEP } else { 0.0 };
        let linear = (cruise * aligned).min(self.safe_speed(speed.linear).max(least));
        Twist::new(linear, angular)
    }

    /// The maximum speed from which the robot can still stop before an obstacle ahead, or at the goal.
    fn safe_speed(&self, present: f64) -> f64 {
        /// Margin for rounding that is left to an obstacle ahead (m).
        const HAIR: f64 = 0.001;
        let passing = if self.slow_to_pass && self.phase == BugPhase::ToGoal { 1.0 } else { 0.5 };
        let outline = self.parameters.robot_radius + passing * self.parameters.least_clearance;
        // A robot nearer to something than that may drive away from it, but not the slightest bit nearer.
        if !self.surroundings.is_step_free(direction(0.0), HAIR, outline) {
            return 0.0;
        }
        let (ahead, _) = self.surroundings.free_distance(direction(0.0), outline);
        approach(ahead.min(self.goal_distance()), present, &self.parameters)
    }
}

/// Ways from the goal to the points that are tried around it, within a distance.
fn around(far: f64) -> impl Iterator<Item = Vector> {
    let places = (1..=RINGS).flat_map(|ring| (0..DIRECTIONS).map(move |turn| (ring, turn)));
    places.map(move |(ring, turn)| {
        let angle = std::f64::consts::TAU * f64::from(turn) / f64::from(DIRECTIONS);
        direction(angle) * (far * f64::from(ring) / f64::from(RINGS))
    })
}

/// The speed at which a robot now moving at `present` stops after at most `room` metres.
///
/// The distance it still rolls by itself is subtracted first. A speed proportional to all of the room would
/// change too fast for the motors, and the robot would overshoot.
fn approach(room: f64, present: f64, parameters: &BugParameters) -> f64 {
    // Within one step it must not use more room than there is.
    let rate = APPROACH_RATE.min(parameters.period.recip());
    (rate * (room - present * parameters.lag)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        /// Motors approach their command exponentially; a new command comes each period.
        #[test]
        fn an_approach_ends_where_it_should(
            lag in 0.05..0.5f64, period in 0.01..0.3f64, cruise in 0.05..0.5f64, spare in 0.0..1.0f64,
        ) {
            let parameters = BugParameters { lag, period, ..BugParameters::default() };
            let fade = math::exp(-period / lag);
            // The shortest distance at which an obstacle may appear at this speed.
            let (mut speed, mut room) = (cruise, cruise * lag + spare);
            for _ in 0..2000 {
                let told = approach(room, speed, &parameters).min(cruise);
                let lacking = speed - told;
                room -= told * period + lacking * lag * (1.0 - fade);
                speed = told + lacking * fade;
                prop_assert!(room > -1e-9, "{room} m left at {speed} m/s");
            }
            prop_assert!(room < 0.001, "stands {room} m before the place");
        }
    }
}
