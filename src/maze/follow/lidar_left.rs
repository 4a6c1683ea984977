use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use std::ops::ControlFlow;

use crate::geometry::{Point, Pose, Twist};
use crate::io::control::{Behaviour, Decision, Halt, Senses};
use crate::io::{Lidar, LidarScan, Odometry, Result};
use crate::parameter::{require_finite, require_positive};

/// What [`LidarLeft`] goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LidarLeftParameters {
    /// Metres per second.
    pub speed: f64,
    /// Metres to keep from the wall on the left.
    pub distance: f64,
    /// Metres to the wall ahead at which the robot turns right.
    pub front: f64,
    /// Radians per second for a radian between the robot and the wall.
    pub angle_gain: f64,
    /// Radians per second for a metre too far from the wall.
    pub distance_gain: f64,
    /// The largest turning speed, in rad/s.
    pub turn_rate: f64,
    /// Seconds from one scan to the next.
    pub period: f64,
}

impl LidarLeftParameters {
    /// For corridors of a width, in metres, that the robot keeps to the middle of; the ratio of the gains is the book's.
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

/// Drives along the wall on the left by a lidar, and turns right where a wall is ahead (book, section 9.4).
///
/// The shortest beam within 45 degrees of the left meets the wall at a right angle: its direction tells how
/// the robot stands to the wall, its length how far it is. A proportional controller of both steers. All
/// points that were [seen](LidarLeftObservation::points), put down where odometry has the robot, make a map
/// that is as good as odometry.
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
/// assert!(driven.path_length > 4.0 && driven.contacts == 0, "round the room along its wall");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct LidarLeft {
    parameters: LidarLeftParameters,
    /// The heading, by odometry, of the turn that is under way.
    turning_to: Option<f64>,
}

impl LidarLeft {
    /// A robot about to drive. Fails with the name of the parameter that is out of range.
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

    /// The speed for a pose by odometry and a scan.
    pub fn step(&mut self, pose: Pose, scan: &LidarScan) -> Twist {
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
        // Without a wall on the left the robot goes round to where there is one.
        let off = (distance - p.distance).min(0.5 * p.distance);
        let turn = p.angle_gain * (angle - FRAC_PI_2) + p.distance_gain * off;
        Twist::new(p.speed, turn.clamp(-p.turn_rate, p.turn_rate))
    }
}

/// What a [`LidarLeft`] sees at a step.
#[derive(Debug, Clone, Default)]
pub struct LidarLeftObservation {
    /// Where odometry takes the robot to be.
    pub pose: Pose,
    /// What it sees from there.
    pub scan: LidarScan,
}

impl LidarLeftObservation {
    /// What was seen, as points in odometry's frame: a piece of the map.
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
        Ok(ControlFlow::Continue(LidarLeft::step(self, seen.pose, &seen.scan)))
    }
}

impl<R: Odometry + Lidar + ?Sized> Senses<R> for LidarLeft {
    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut LidarLeftObservation) -> Result<()> {
        seen.pose = robot.pose()?;
        robot.scan_into(&mut seen.scan)
    }
}
