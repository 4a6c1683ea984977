use std::f64::consts::{FRAC_PI_2, PI};

use super::{FollowsWalls, WallSide};
use crate::geometry::{FittedLine, Point, Twist, math};
use crate::io::reading::check_scan;
use crate::io::{Error, LidarScan, Result};
use crate::parameter::require_positive;

/// Parameters of [`LidarWallFollower`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LidarWallFollowerParameters {
    /// Side of the wall.
    pub side: WallSide,
    /// Distance from the wall to the robot's centre (m).
    pub distance: f64,
    /// Speed along the wall (m/s).
    pub speed: f64,
    /// Maximum turn rate (rad/s).
    pub turn_rate: f64,
    /// Decay length of a distance error (m); it stands for the two gains of the book's controller.
    pub reach: f64,
    /// Delay of the robot's response to commands (s).
    pub lag: f64,
    /// Control period (s).
    pub period: f64,
}

impl Default for LidarWallFollowerParameters {
    /// A wall to the left at 0.2 m, passed at 0.2 m/s.
    fn default() -> Self {
        Self {
            side: WallSide::Left,
            distance: 0.2,
            speed: 0.2,
            turn_rate: 2.5,
            reach: 0.12,
            lag: 0.25,
            period: 0.05,
        }
    }
}

/// Follows a wall with a lidar, steered by direction and length of the shortest beam (book, section 9.4).
///
/// The shortest of noisy beams is biased and its direction random, so a line through the points around it
/// takes its place. A wall ahead counts as nearer by the stopping distance.
///
/// ```
/// use roverlab::drive::{AlongWall, LidarWallFollower, LidarWallFollowerParameters};
/// use roverlab::geometry::Pose;
/// use roverlab::io::control::run;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::world::{RobotSpec, Scene, World};
/// let scene = Scene::with_robot(World::walled(2.0, 2.0), RobotSpec::s4(), Pose::new(0.5, 1.7, 0.0));
/// let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
/// let mut drive = AlongWall::new(LidarWallFollower::new(LidarWallFollowerParameters::default())?);
/// run(&mut simulation.robot(0)?, &mut drive, 30.0, |_, _, _| {})?;
/// let truth = simulation.truth().robot(0)?;
/// assert!(truth.contacts == 0 && truth.path_length > 3.0);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LidarWallFollower {
    parameters: LidarWallFollowerParameters,
    met: bool,
    aligned: bool,
}

/// Angle to either side of the shortest beam within which points define the line (rad).
const SECTOR: f64 = 0.3;
/// Number of beams averaged to find the shortest range.
const WINDOW: usize = 7;
/// Range of directions of the wall, from straight ahead towards the wall (rad). Away from the wall, it
/// depends on the robot's width.
const DIRECTIONS: [f64; 2] = [-0.35, 2.6];

impl LidarWallFollower {
    /// Creates a follower that has not met a wall. Fails for parameters out of range.
    pub fn new(parameters: LidarWallFollowerParameters) -> Result<Self> {
        require_positive("distance", parameters.distance)?;
        require_positive("speed", parameters.speed)?;
        require_positive("turn rate", parameters.turn_rate)?;
        require_positive("reach", parameters.reach)?;
        require_positive("lag", parameters.lag)?;
        require_positive("control period", parameters.period)?;
        Ok(Self { parameters, met: false, aligned: false })
    }

    /// The next velocity. Fails for a scan of fewer than 60 beams or less than half a turn, and for one with
    /// neighbouring beams that are no distances.
    pub fn step(&mut self, scan: &LidarScan) -> Result<Twist> {
        check_scan(scan)?;
        let LidarWallFollowerParameters { side, distance, speed, .. } = self.parameters;
        let span = scan.angle_increment * scan.ranges.len() as f64;
        if span.is_nan() || span < PI - 1e-6 || scan.ranges.len() < 60 {
            let found = format!("{} beams over {span:.2} rad", scan.ranges.len());
            return Err(Error::invalid_input(
                "lidar scan",
                found,
                "at least 60 beams over half a turn or more",
            ));
        }
        let towards = if side == WallSide::Left { 1.0 } else { -1.0 };
        // Mirrored if necessary, so that the wall is on the left.
        let points: Vec<Option<Point>> = hits(scan, towards);
        let Some((gap, bearing)) = self.nearest(&points) else {
            return Ok(Twist::new(speed, 0.0));
        };
        if !self.met {
            if gap > 1.3 * distance {
                return Ok(Twist::new(speed, 0.0));
            }
            self.met = true;
        }
        let twist = self.steer(gap - distance, bearing - FRAC_PI_2);
        Ok(Twist::new(twist.linear, towards * twist.angular))
    }

    /// Distance (m) and direction (rad) of the wall.
    fn nearest(&self, points: &[Option<Point>]) -> Option<(f64, f64)> {
        let LidarWallFollowerParameters { speed, lag, .. } = self.parameters;
        let stop = lag * speed;
        let direction = |point: &Point| math::atan2(point.y, point.x);
        let candidates: Vec<Point> = points
            .windows(WINDOW)
            .filter_map(|window| {
                let seen: Vec<&Point> = window.iter().flatten().collect();
                let middle = *seen.get(seen.len() / 2)?;
                let mean = seen.iter().map(|point| point.coords.norm()).sum::<f64>() / seen.len() as f64;
                (seen.len() == WINDOW).then(|| Point::from(middle.coords * (mean / middle.coords.norm())))
            })
            .filter(|point| (DIRECTIONS[0]..=DIRECTIONS[1]).contains(&direction(point)))
            .collect();
        let cost = |point: &Point| point.coords.norm() - stop * math::cos(direction(point)).max(0.0);
        let nearest = candidates.iter().min_by(|a, b| cost(a).total_cmp(&cost(b)))?;
        let middle = direction(nearest);
        let around = points.iter().flatten().copied().filter(|point| {
            (direction(point) - middle).abs() < SECTOR && point.coords.norm() < 1.5 * nearest.coords.norm()
        });
        let line = FittedLine::through(around)?;
        let foot = line.foot(Point::origin());
        // The foot of the perpendicular on a line through few points may be far off.
        let foot = if (foot - nearest).norm() < 0.5 * nearest.coords.norm() { foot } else { *nearest };
        let bearing = direction(&foot);
        Some((foot.coords.norm() - stop * math::cos(bearing).max(0.0), bearing))
    }

    fn steer(&mut self, error: f64, angle: f64) -> Twist {
        let LidarWallFollowerParameters { speed, turn_rate, reach, .. } = self.parameters;
        self.aligned = angle.abs() < 0.3;
        let pull = (error / reach).clamp(-1.2, 1.2);
        let bend = (2.0 * math::sin(angle.clamp(-FRAC_PI_2, FRAC_PI_2)) + pull) / reach;
        let slow = math::cos(angle).max(0.0);
        let along = (speed * slow).min(turn_rate / bend.abs().max(1e-9));
        // On the spot the robot turns at the maximum rate, and slows down near the end.
        let turn = if slow < 0.5 { (3.0 * angle).clamp(-turn_rate, turn_rate) } else { along * bend };
        Twist::new(if slow < 0.5 { 0.0 } else { along }, turn)
    }
}

/// Points of a scan in the robot's frame, or in that of its mirror image, counter-clockwise from the back.
fn hits(scan: &LidarScan, towards: f64) -> Vec<Option<Point>> {
    let point = |index: usize| {
        let range = scan.ranges[index];
        let angle = scan.mount.heading + scan.angle(index);
        let place = scan.mount.position() + crate::geometry::direction(angle) * range;
        range.is_finite().then(|| Point::new(place.x, towards * place.y))
    };
    let indices = 0..scan.ranges.len();
    if towards > 0.0 { indices.map(point).collect() } else { indices.rev().map(point).collect() }
}

impl FollowsWalls for LidarWallFollower {
    type Observation = LidarScan;

    fn steer(&mut self, scan: &LidarScan, _seconds: f64) -> Result<Twist> {
        self.step(scan)
    }

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn is_beside_wall(&self) -> bool {
        self.met && self.aligned
    }

    fn wall_side(&self) -> Option<WallSide> {
        Some(self.parameters.side)
    }
}
