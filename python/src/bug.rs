use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use roverlab::geometry::Point;
use roverlab::io::control::LidarObservation;
use roverlab::nav::{self, BugKind, BugParameters};

use crate::behaviour::{decide, outcome, run};
use crate::errors::{Failure, Outcome};
use crate::robot::Robot;

/// Navigation to a goal among unknown obstacles, by lidar and odometry.
///
/// Parameters
/// ----------
/// goal : sequence of float
///     x and y of the goal (m), relative to the robot's start: ahead and to the left.
/// kind : str
///     The algorithm, one of `Bug.names()` in any case.
/// radius : float
///     Radius of the robot (m); distances to obstacles scale with it.
///
/// Raises
/// ------
/// ValueError
///     If there is no such algorithm, or a parameter is out of range.
#[pyclass(frozen, module = "roverlab.nav")]
pub(crate) struct Bug {
    state: Mutex<(Box<dyn nav::Bug + Send>, LidarObservation)>,
    period: f64,
    ended: Mutex<Option<String>>,
}

#[pymethods]
impl Bug {
    #[new]
    #[pyo3(signature = (goal, kind = "DistBug", radius = 0.06))]
    fn new(goal: [f64; 2], kind: &str, radius: f64) -> Outcome<Self> {
        let kind: BugKind = kind.parse().map_err(|_| {
            Failure::value("kind", format!("{kind:?}"), &format!("one of {}", Self::names().join(", ")))
        })?;
        let parameters = BugParameters::for_radius(radius);
        let bug = kind.with(Point::new(goal[0], goal[1]), parameters)?;
        let state = Mutex::new((bug, LidarObservation::default()));
        Ok(Self { state, period: parameters.period, ended: Mutex::new(None) })
    }

    /// Names of the algorithms.
    #[staticmethod]
    fn names() -> Vec<&'static str> {
        BugKind::ALL.map(BugKind::name).to_vec()
    }

    /// Reads the robot's sensors and decides; the robot is not told.
    ///
    /// Returns
    /// -------
    /// tuple of float
    ///     Linear (m/s) and angular speed (rad/s); (0, 0) once there is an `outcome`.
    fn decide(&self, py: Python<'_>, robot: &Robot) -> Outcome<(f64, f64)> {
        let mut guard = self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        let (bug, seen) = &mut *guard;
        decide(py, robot, &self.ended, |time, robot| {
            seen.read(robot)?;
            Ok(bug.step(time, seen)?.map_break(|outcome| outcome.to_string()))
        })
    }

    /// Drives a robot until the outcome, or for at most `time_limit` seconds.
    ///
    /// Returns
    /// -------
    /// str or None
    ///     The outcome; None if the time was over.
    #[pyo3(signature = (robot, time_limit = 600.0))]
    fn run(&self, py: Python<'_>, robot: &Robot, time_limit: f64) -> Outcome<Option<String>> {
        run(py, robot, (self.period, time_limit), &self.ended, || self.decide(py, robot))
    }

    /// A sentence about the end, such as ``"the goal is reached"``; None before it.
    #[getter]
    fn outcome(&self) -> Option<String> {
        outcome(&self.ended).clone()
    }

    /// Time between two decisions (s).
    #[getter]
    fn period(&self) -> f64 {
        self.period
    }
}
