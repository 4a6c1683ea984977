use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use std::ops::ControlFlow;

use crate::geometry::{Point, Pose, Twist};
use crate::io::control::{Behaviour, Decision, Halt, Senses};
use crate::io::reading::{check_pose, check_scan};
use crate::io::{Lidar, LidarScan, Odometry, Result};
use crate::parameter::{require_finite, require_positive};

/// Parameters of [`LidarLeft`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LidarLeftParameters {
    /// Speed (m/s).
    pub speed: f64,
    /// Desired distance from the left wall (m).
    pub distance: f64,
    /// Distance from a wall ahead at which the robot turns right (m).
    pub front: f64,
    /// Gain of the angle to the wall (rad/s per rad).
    pub angle_gain: f64,
    /// Gain of the distance error (rad/s per m).
    pub distance_gain: f64,
    /// Maximum angular velocity (rad/s).
    pub turn_rate: f64,
    /// Control period (s).
    pub period: f64,
}

impl LidarLeftParameters {
    /// Parameters for the middle of a corridor of a width (m); the ratio of the gains is the book's.
    pub fn for_corridor(width: f64) -> Self {
        Self {
            speed: 0.15,
            distance: 0.5 * width,
            front: 0.5 * width,
            angle_gain: 3.0,
            distance_gain: 17.0,
            turn_rate: 1.5,
            period: 0.05,
        }
    }
}

/// Follows the left wall by lidar, and turns right at a wall ahead (book, section 9.4).
///
/// The shortest beam within 45 degrees of the left is perpendicular to the wall: its direction gives the
/// angle to the wall, its length the distance. A proportional controller uses both. All observed
/// [points](LidarLeftObservation::points), placed by odometry, form a map as accurate as odometry.
///
/// ```
/// use roverlab::geometry::Pose;
/// use roverlab::io::control::run;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::maze::{LidarLeft, LidarLeftParameters};
/// use roverlab::world::{RobotSpec, Scene, World};
/// let mut follower = LidarLeft::new(LidarLeftParameters::for_corridor(0.4))?;
/// let scene = Scene::with_robot(World::walled(2.0, 2.0), RobotSpec::s4(), Pose::new(0.5, 1.7, 0.0));
/// let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
/// run(&mut simulation.robot(0)?, &mut follower, 60.0, |_, _, _| {})?;
/// let driven = simulation.truth().robot(0)?;
/// assert!(driven.path_length > 4.0 && driven.contacts == 0, "around the room along its walls");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct LidarLeft {
    parameters: LidarLeftParameters,
    /// Target heading, by odometry, of the turn in progress.
    turning_to: Option<f64>,
}

impl LidarLeft {
    /// A robot about to drive.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
    pub fn new(parameters: LidarLeftParameters) -> Result<Self> {
        require_positive("speed", parameters.speed)?;
        require_positive("distance", parameters.distance)?;
        require_positive("front distance", parameters.front)?;
        require_positive("turn rate", parameters.turn_rate)?;
        require_positive("control period", parameters.period)?;
        require_finite("angle gain", parameters.angle_gain)?;
        require_finite("distance gain", parameters.distance_gain)?;
        Ok(Self { parameters, turning_to: None })
    }

    /// Velocity command for a pose by odometry and a scan. Without readings to drive by, the robot stands.
    pub fn step(&mut self, pose: Pose, scan: &LidarScan) -> Twist {
        if check_pose(&pose).and_then(|()| check_scan(scan)).is_err() {
            return Twist::STOP;
        }
        let p = &self.parameters;
        if let Some(heading) = self.turning_to {
            let rest = crate::geometry::angle_difference(heading, pose.heading);
            if rest.abs() > 0.04 {
                return Twist::new(0.0, (4.0 * rest).clamp(-p.turn_rate, p.turn_rate));
            }
            self.turning_to = None;
        }
        let beams = || scan.ranges.iter().enumerate().map(move |(i, &range)| (scan.angle(i), range));
        let within = |middle: f64, half: f64| {
            let near = move |&(angle, _): &(f64, f64)| {
                crate::geometry::angle_difference(angle, middle).abs() <= half
            };
            beams().filter(near).filter(|(_, range)| range.is_finite())
        };
        let nearest = |a: (f64, f64), b: (f64, f64)| if b.1 < a.1 { b } else { a };
        let ahead = within(0.0, 0.1).fold((0.0, f64::INFINITY), nearest).1;
        if ahead < p.front {
            self.turning_to = Some(crate::geometry::normalize_angle(pose.heading - FRAC_PI_2));
            return Twist::STOP;
        }
        let (angle, distance) = within(FRAC_PI_2, FRAC_PI_4).fold((FRAC_PI_2, f64::INFINITY), nearest);
        // Without a wall on the left, the robot turns left until there is one.
        let off = (distance - p.distance).min(0.5 * p.distance);
        let turn = p.angle_gain * (angle - FRAC_PI_2) + p.distance_gain * off;
        Twist::new(p.speed, turn.clamp(-p.turn_rate, p.turn_rate))
    }
}

/// Observation of a [`LidarLeft`].
#[derive(Debug, Clone, Default)]
pub struct LidarLeftObservation {
    /// Pose by odometry.
    pub pose: Pose,
    /// Scan from that pose.
    pub scan: LidarScan,
}

impl LidarLeftObservation {
    /// Observed points in the odometry frame: a part of the map.
    pub fn points(&self) -> impl Iterator<Item = Point> {
        self.scan.points().map(|point| self.pose.to_world(point))
    }
}

impl Behaviour for LidarLeft {
    type Observation = LidarLeftObservation;
    type Command = Twist;
    type Outcome = Halt;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, _time: f64, seen: &LidarLeftObservation) -> Decision<Self> {
        check_pose(&seen.pose)?;
        check_scan(&seen.scan)?;
        Ok(ControlFlow::Continue(LidarLeft::step(self, seen.pose, &seen.scan)))
    }
}

impl<R: Odometry + Lidar + ?Sized> Senses<R> for LidarLeft {
    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut LidarLeftObservation) -> Result<()> {
        seen.pose = robot.pose()?;
        robot.scan_into(&mut seen.scan)
    }
}
