use std::f64::consts::PI;

use super::way::{AHEAD, BRAKING, TURN_GAIN, Way};
use crate::ParameterError;
use crate::geometry::{Point, Pose, Twist, Vector, math, normalize_angle};
use crate::io::reading::check_pose;
use crate::io::{LidarScan, Result};
use crate::parameter::{require, require_finite, require_positive, require_up_to};

/// Parameters of [`Follower`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FollowerParameters {
    /// Distance kept between the centres of the follower and the robot ahead (m).
    pub gap: f64,
    /// Maximum speed (m/s).
    pub speed: f64,
    /// Maximum turn rate (rad/s).
    pub turn_rate: f64,
    /// Radius of the robot (m).
    pub radius: f64,
    /// Clearance kept beside the robot (m).
    pub margin: f64,
    /// Radius of the robot ahead (m).
    pub leader_radius: f64,
    /// Time without a detection after which the robot ahead counts as lost (s).
    pub patience: f64,
    /// Control period (s).
    pub period: f64,
}

impl Default for FollowerParameters {
    /// An S4 behind another robot of about its size.
    fn default() -> Self {
        Self {
            gap: 0.4,
            speed: 0.35,
            turn_rate: 2.0,
            radius: 0.06,
            margin: 0.04,
            leader_radius: 0.07,
            patience: 3.0,
            period: 0.1,
        }
    }
}

impl FollowerParameters {
    /// Fails with the name of the parameter that is out of range.
    pub fn validate(&self) -> std::result::Result<(), ParameterError> {
        require_positive("speed", self.speed)?;
        require_positive("turn rate", self.turn_rate)?;
        require_up_to("radius", self.radius, 1000.0)?;
        require_up_to("margin", self.margin, 1000.0)?;
        require_up_to("radius of the leader", self.leader_radius, 1000.0)?;
        require_positive("patience", self.patience)?;
        require_positive("control period", self.period)?;
        let least = self.radius + self.leader_radius + 2.0 * self.margin;
        let good = self.gap >= least && self.gap.is_finite();
        require("gap", self.gap, good, format!("at least {least:.3} m, for both robots"))
    }
}

/// Observation of a [`Follower`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FollowerObservation<'a> {
    /// Time (s).
    pub time: f64,
    /// Pose by odometry.
    pub pose: Pose,
    /// Possible positions of the robot ahead: centres of things of its size, in the follower's frame.
    pub candidates: &'a [Point],
    /// Points not to be touched, in the follower's frame.
    pub obstacles: &'a [Point],
}

/// Follows a robot that it sees (book, sections 5.2 and 5.3).
///
/// The follower tracks the robot ahead: the thing of its size nearest to the predicted position. The book
/// follows the nearest thing around, so any other object can take the leader's place. The follower closes up
/// to the gap, adds the leader's own speed, and goes round obstacles in between.
///
/// ```
/// use roverlab::drive::{Follower, FollowerObservation, FollowerParameters};
/// use roverlab::geometry::{Point, Pose};
/// let mut follower = Follower::new(FollowerParameters::default())?;
/// let leader = [Point::new(1.0, 0.2)];
/// let seen = FollowerObservation { time: 0.0, pose: Pose::default(), candidates: &leader, obstacles: &[] };
/// let twist = follower.step(&seen)?;
/// assert!(twist.linear > 0.0 && twist.angular > 0.0, "after it, to the left");
/// assert!(follower.target().is_some() && !follower.is_lost(0.1));
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Follower {
    parameters: FollowerParameters,
    /// The robot ahead: position in the odometry frame, velocity, and time of the last detection.
    target: Option<Target>,
    /// Bearing towards which it looks round for a lost robot.
    looking: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Target {
    place: Point,
    velocity: Vector,
    seen: f64,
}

/// Distance from the predicted position of the robot ahead within which a detection is that robot, including
/// its motion in between (m).
const GATE: f64 = 0.15;
/// Weight of a new detection in the position of the robot ahead (alpha of an alpha-beta filter).
const OF_PLACE: f64 = 0.5;

impl Follower {
    /// Creates a follower without a target.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
    pub fn new(parameters: FollowerParameters) -> Result<Self> {
        parameters.validate()?;
        Ok(Self { parameters, target: None, looking: None })
    }

    /// Estimated position of the robot ahead in the odometry frame, if it has been seen.
    pub fn target(&self) -> Option<Point> {
        self.target.map(|target| target.place)
    }

    /// Time since the last detection of the robot ahead (s); infinite before the first.
    pub fn unseen(&self, time: f64) -> f64 {
        self.target.map_or(f64::INFINITY, |target| time - target.seen)
    }

    /// Whether the robot ahead is lost.
    pub fn is_lost(&self, time: f64) -> bool {
        self.unseen(time) > self.parameters.patience
    }

    /// The next velocity. Fails if pose or time is not finite.
    pub fn step(&mut self, seen: &FollowerObservation<'_>) -> Result<Twist> {
        require_finite("time", seen.time)?;
        check_pose(&seen.pose)?;
        self.track(seen);
        let parameters = self.parameters;
        let Some(target) = self.target else { return Ok(Twist::STOP) };
        let away = seen.pose.to_local(target.place);
        let distance = away.coords.norm();
        let bearing = math::atan2(away.y, away.x);
        let lost = self.is_lost(seen.time);
        if lost && distance < parameters.gap {
            // It looks all round for the robot ahead, first to where that was.
            let side = *self.looking.get_or_insert(bearing);
            return Ok(Twist::new(0.0, parameters.turn_rate.copysign(side)));
        }
        self.looking = None;
        // The robot ahead is not an obstacle.
        let near_target = parameters.leader_radius + 0.05;
        let obstacles: Vec<Point> =
            seen.obstacles.iter().copied().filter(|point| (point - away).norm() > near_target).collect();
        let way = Way { radius: parameters.radius, margin: parameters.margin };
        let (towards, free) = way.towards(&obstacles, bearing, AHEAD.min(distance));
        let along = crate::geometry::direction(seen.pose.heading + bearing).dot(&target.velocity);
        // A lost robot is looked for where it was last seen.
        let closing = if lost { parameters.speed } else { (distance - parameters.gap) / BRAKING + along };
        let turn = normalize_angle(towards);
        let facing = math::cos(turn).max(0.0);
        // Obstacles straight ahead limit the speed as well.
        let free =
            free.min(way.free(&obstacles, 0.0)).min(distance - parameters.radius - parameters.leader_radius);
        let most = ((free - parameters.margin) / BRAKING).clamp(0.0, parameters.speed);
        let linear = (closing * facing * facing).clamp(0.0, most);
        Ok(Twist::new(linear, (TURN_GAIN * turn).clamp(-parameters.turn_rate, parameters.turn_rate)))
    }

    /// Associates the robot ahead with one of the candidates.
    fn track(&mut self, seen: &FollowerObservation<'_>) {
        let nearest_to = |place: Point| {
            let candidates = seen.candidates.iter().map(|&candidate| seen.pose.to_world(candidate));
            candidates.min_by(|a, b| (a - place).norm().total_cmp(&(b - place).norm()))
        };
        let begin = |place: Point| Target { place, velocity: Vector::zeros(), seen: seen.time };
        let Some(target) = self.target else {
            // The first target is the nearest candidate ahead.
            let ahead = seen.candidates.iter().filter(|point| math::atan2(point.y, point.x).abs() < 0.3 * PI);
            let first = ahead.min_by(|a, b| a.coords.norm().total_cmp(&b.coords.norm()));
            self.target = first.map(|&point| begin(seen.pose.to_world(point)));
            return;
        };
        if self.is_lost(seen.time) {
            // A lost target is the candidate nearest to its last position, if within reach since then.
            let reach = GATE + self.parameters.speed * (seen.time - target.seen);
            let found = nearest_to(target.place).filter(|found| (found - target.place).norm() < reach);
            self.target = found.map(begin).or(self.target);
            return;
        }
        let since = (seen.time - target.seen).max(1e-3);
        let moved = target.velocity * since.min(1.0);
        let expected = target.place + moved;
        let Some(found) = nearest_to(expected)
            .filter(|found| (found - expected).norm() < GATE + self.parameters.speed * since)
        else {
            return;
        };
        let place = expected + (found - expected) * OF_PLACE;
        // The beta that goes with an alpha, by which place and velocity together err least.
        let of_velocity = OF_PLACE * OF_PLACE / (2.0 - OF_PLACE);
        let velocity =
            target.velocity + (found - expected) * (of_velocity / since.max(self.parameters.period));
        self.target = Some(Target { place, velocity, seen: seen.time });
    }
}

/// Centres of the things in a scan that may be a robot of this radius, in the robot's frame.
///
/// Neighbouring beams with end points near each other form a thing. It counts if about as many beams hit it
/// as would hit a round robot, and if its surroundings are farther away.
///
/// ```
/// use roverlab::drive::robots_in;
/// use roverlab::io::LidarScan;
/// // A round robot of 90 mm radius, 0.8 m ahead, in a scan of a beam for each degree.
/// let step = 1_f64.to_radians();
/// let range = |beam: i32| {
///     let (sin, cos) = (f64::from(beam - 180) * step).sin_cos();
///     let half = 0.09 * 0.09 - 0.64 * sin * sin;
///     if cos > 0.0 && half > 0.0 { 0.8 * cos - half.sqrt() } else { 3.0 }
/// };
/// let scan = LidarScan {
///     angle_min: -180.0 * step,
///     angle_increment: step,
///     range_max: 4.0,
///     ranges: (0..360).map(range).collect(),
///     ..LidarScan::default()
/// };
/// let found = robots_in(&scan, 0.09);
/// assert!(found.len() == 1 && (found[0].x - 0.8).abs() < 0.02 && found[0].y.abs() < 0.02);
/// ```
pub fn robots_in(scan: &LidarScan, radius: f64) -> Vec<Point> {
    let beams = scan.ranges.len();
    let all_round = (scan.angle_increment.abs() * beams as f64 - std::f64::consts::TAU).abs() < 1e-6;
    let joined = |a: usize, b: usize| {
        let (one, other) = (scan.ranges[a], scan.ranges[b]);
        one.is_finite() && other.is_finite() && (one - other).abs() < radius
    };
    let first =
        if all_round { (0..beams).find(|&beam| !joined((beam + beams - 1) % beams, beam)) } else { Some(0) };
    let Some(first) = first else { return Vec::new() };
    let mut found = Vec::new();
    let mut start = 0;
    for step in 1..=beams {
        let at = |step: usize| (first + step) % beams;
        if step < beams && joined(at(step - 1), at(step)) {
            continue;
        }
        let thing: Vec<usize> = (start..step).map(at).collect();
        // The surroundings must be farther away.
        let before = if start > 0 || all_round { Some(at(start + beams - 1)) } else { None };
        let after = if step < beams || all_round { Some(at(step)) } else { None };
        // At the edge of the field of view a wall may end anywhere.
        let farther = |beside: Option<usize>, end: usize| {
            beside.is_some_and(|beside| scan.ranges[beside] > scan.ranges[end] + radius)
        };
        if farther(before, at(start)) && farther(after, at(step - 1)) {
            found.extend(middle_of(scan, &thing, radius));
        }
        start = step;
    }
    found
}

/// Centre of the disc hit by a run of beams, if it can be one.
fn middle_of(scan: &LidarScan, beams: &[usize], radius: f64) -> Option<Point> {
    /// Range of the apparent width relative to the robot's: range noise widens it, missed beams narrow it.
    const SEEN: [f64; 2] = [0.9, 1.25];
    /// Number of beams by which the apparent width may be smaller, and larger, than the robot.
    const BEAMS: [f64; 2] = [1.0, 2.0];
    let ranges = || beams.iter().map(|&beam| scan.ranges[beam]).filter(|range| range.is_finite());
    let count = ranges().count();
    if count != beams.len() || count == 0 {
        return None;
    }
    let mean = ranges().sum::<f64>() / count as f64;
    // Beams hit a disc's front on average pi/4 of its radius before its centre.
    let distance = mean + radius * std::f64::consts::FRAC_PI_4;
    let expected = 2.0 * math::asin((radius / distance).min(1.0)) / scan.angle_increment.abs();
    let likely = SEEN[0] * expected - BEAMS[0]..=SEEN[1] * expected + BEAMS[1];
    if !likely.contains(&(count as f64)) {
        return None;
    }
    let middle = scan.angle(beams[0]) + 0.5 * scan.angle_increment * (count - 1) as f64;
    let ray = crate::geometry::direction(scan.mount.heading + middle);
    Some(scan.mount.position() + ray * distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::{Displacement, advance};
    use proptest::prelude::*;

    fn follower() -> Follower {
        Follower::new(FollowerParameters::default()).unwrap()
    }

    proptest! {
        #![proptest_config(crate::testing::cases(48))]
        /// The robot ahead drives along a circle, more slowly than the follower can.
        #[test]
        fn the_gap_is_kept(curvature in -0.8..0.8f64, speed in 0.05..0.25f64, aside in -0.3..0.3f64) {
            let mut follower = follower();
            let (mut robot, mut leader) = (Pose::default(), Pose::new(0.7, aside, 0.0));
            for step in 0..600 {
                let place = robot.to_local(leader.position());
                let others = [Point::new(-0.5, 0.3), Point::new(1.5, -1.4)];
                let candidates = [others[0], place, others[1]];
                let seen = FollowerObservation {
                    time: 0.1 * f64::from(step), pose: robot, candidates: &candidates, obstacles: &[],
                };
                let twist = follower.step(&seen).unwrap();
                robot = advance(robot, Displacement { length: 0.1 * twist.linear, angle: 0.1 * twist.angular });
                leader = advance(leader, Displacement { length: 0.1 * speed, angle: 0.1 * speed * curvature });
                prop_assert!(robot.distance_to(leader.position()) > 0.2);
            }
            let gap = robot.distance_to(leader.position());
            prop_assert!((gap - 0.4).abs() < 0.1, "{}", gap);
        }
    }

    #[test]
    fn it_does_not_take_another_thing_for_the_robot_ahead() {
        let mut follower = follower();
        let step = |follower: &mut Follower, time: f64, candidates: &[Point]| {
            let seen = FollowerObservation { time, pose: Pose::default(), candidates, obstacles: &[] };
            follower.step(&seen).unwrap()
        };
        step(&mut follower, 0.0, &[Point::new(0.8, 0.0), Point::new(0.5, 0.9)]);
        // The other robot comes nearer.
        let twist = step(&mut follower, 0.1, &[Point::new(0.8, 0.01), Point::new(0.4, 0.4)]);
        assert!(twist.angular.abs() < 0.2 && twist.linear > 0.0);
        // The robot ahead is gone: its position is predicted at first, then it counts as lost.
        assert!(step(&mut follower, 0.2, &[Point::new(0.2, 0.9)]).linear > 0.0);
        let twist = step(&mut follower, 5.0, &[Point::new(-1.9, 0.9)]);
        assert!(follower.is_lost(5.0) && twist.linear > 0.0, "it drives to where the robot was");
        // Once there, it looks round.
        let there = Pose::new(0.75, 0.0, 0.0);
        let seen = FollowerObservation { time: 9.0, pose: there, candidates: &[], obstacles: &[] };
        let twist = follower.step(&seen).unwrap();
        assert!(follower.is_lost(9.0) && twist.linear == 0.0 && twist.angular != 0.0);
        // It is found again.
        step(&mut follower, 9.1, &[Point::new(0.9, 0.3)]);
        assert!(!follower.is_lost(9.1) && step(&mut follower, 9.2, &[Point::new(0.9, 0.3)]).linear > 0.0);
    }

    #[test]
    fn only_what_is_as_wide_as_the_robot_may_be_it() {
        use crate::io::Lidar;
        use crate::io::sim::{SimOptions, Simulation};
        use crate::world::{Object, ObjectKind, RobotPlacement, RobotSpec, Scene, World};
        use std::sync::Arc;
        let can = Arc::new(ObjectKind::predefined("can").unwrap());
        for (seed, distance) in [0.35, 0.6, 1.0, 1.5, 2.0, 2.5, 3.0].into_iter().enumerate() {
            let mut world = World::walled(8.0, 4.0);
            world.objects.push(Object::new(Arc::clone(&can), Pose::new(2.0, 2.0 + distance, 0.0)));
            let mut scene = Scene::with_robot(world, RobotSpec::s4(), Pose::new(2.0, 2.0, 0.0));
            let leader = Pose::new(2.0 + distance, 2.0, 1.0);
            scene.robots.push(RobotPlacement::new(Arc::new(RobotSpec::labbot()), leader));
            let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, seed as u64)).unwrap();
            let scan = simulation.robot(0).unwrap().scan().unwrap();
            let found = robots_in(&scan, 0.09);
            assert_eq!(found.len(), 1, "{distance}: {found:?}");
            assert!((found[0] - Point::new(distance, 0.0)).norm() < 0.04, "{distance}: {found:?}");
        }
    }

    #[test]
    fn obstacles_are_passed_and_not_driven_at() {
        let mut follower = follower();
        let obstacles: Vec<Point> = (-2..3).map(|i| Point::new(0.35, 0.03 * f64::from(i))).collect();
        let seen = FollowerObservation {
            time: 0.0,
            pose: Pose::default(),
            candidates: &[Point::new(1.5, 0.0)],
            obstacles: &obstacles,
        };
        let twist = follower.step(&seen).unwrap();
        assert!(twist.angular.abs() > 0.2, "{twist:?}");
        let wall: Vec<Point> = (-20..21).map(|i| Point::new(0.12, 0.03 * f64::from(i))).collect();
        let blocked = follower.step(&FollowerObservation { time: 0.1, obstacles: &wall, ..seen }).unwrap();
        assert!(blocked.linear < 0.05, "{blocked:?}");
    }

    #[test]
    fn nonsense_is_refused() {
        let good = FollowerParameters::default();
        for bad in [
            FollowerParameters { gap: 0.1, ..good },
            FollowerParameters { speed: -1.0, ..good },
            FollowerParameters { patience: f64::NAN, ..good },
        ] {
            assert!(Follower::new(bad).is_err());
        }
        let lost = Pose::new(f64::NAN, 0.0, 0.0);
        let seen = FollowerObservation { time: 0.0, pose: lost, candidates: &[], obstacles: &[] };
        assert!(follower().step(&seen).is_err());
        assert!(robots_in(&LidarScan::default(), 0.07).is_empty());
    }
}
