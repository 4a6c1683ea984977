use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use roverlab::drive::{self, FollowerObservation, FollowerParameters, robots_in};
use roverlab::geometry::Point;
use roverlab::io::{Lidar, LidarScan, Odometry};

use crate::behaviour::{decide, run};
use crate::errors::Outcome;
use crate::robot::Robot;

/// Follows a robot that the lidar sees.
///
/// Parameters
/// ----------
/// gap : float
///     Distance kept between the centres of the robots (m).
/// speed : float
///     Maximum speed (m/s).
/// radius, leader_radius : float
///     Radii of the robot and of the robot ahead (m).
///
/// Raises
/// ------
/// ValueError
///     If a parameter is out of range.
#[pyclass(frozen, module = "roverlab.drive")]
#[derive(Debug)]
pub(crate) struct Follower {
    state: Mutex<(drive::Follower, LidarScan)>,
    parameters: FollowerParameters,
    /// Followers have no outcome.
    ended: Mutex<Option<String>>,
}

#[pymethods]
impl Follower {
    #[new]
    #[pyo3(signature = (gap = 0.4, speed = 0.35, radius = 0.06, leader_radius = 0.06))]
    fn new(gap: f64, speed: f64, radius: f64, leader_radius: f64) -> Outcome<Self> {
        let parameters =
            FollowerParameters { gap, speed, radius, leader_radius, ..FollowerParameters::default() };
        let state = Mutex::new((drive::Follower::new(parameters)?, LidarScan::default()));
        Ok(Self { state, parameters, ended: Mutex::new(None) })
    }

    /// Reads the robot's sensors and decides; the robot is not told.
    ///
    /// Returns
    /// -------
    /// tuple of float
    ///     Linear (m/s) and angular speed (rad/s).
    fn decide(&self, py: Python<'_>, robot: &Robot) -> Outcome<(f64, f64)> {
        let mut guard = self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        let (follower, scan) = &mut *guard;
        decide(py, robot, &self.ended, |time, robot| {
            let pose = robot.pose()?;
            robot.scan_into(scan)?;
            let candidates = robots_in(scan, self.parameters.leader_radius);
            let obstacles: Vec<Point> = scan.points().collect();
            let seen = FollowerObservation { time, pose, candidates: &candidates, obstacles: &obstacles };
            follower.step(&seen).map(ControlFlow::Continue)
        })
    }

    /// Drives a robot for `time_limit` seconds.
    #[pyo3(signature = (robot, time_limit = 60.0))]
    fn run(&self, py: Python<'_>, robot: &Robot, time_limit: f64) -> Outcome<()> {
        run(py, robot, (self.parameters.period, time_limit), &self.ended, || self.decide(py, robot))?;
        Ok(())
    }

    /// Time between two decisions (s).
    #[getter]
    fn period(&self) -> f64 {
        self.parameters.period
    }
}
