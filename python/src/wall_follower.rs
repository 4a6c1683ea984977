use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use roverlab::drive::{
    AlongWall, AlongWallObservation, PidWallFollower, PidWallFollowerParameters, WallObservation,
};
use roverlab::geometry::WallSide;
use roverlab::io::control::{Behaviour, Senses};

use crate::behaviour::{decide, outcome, run};
use crate::errors::{Failure, Outcome};
use crate::robot::Robot;

/// Follows a wall by a PID controller on one distance sensor.
///
/// Parameters
/// ----------
/// side : str
///     Side of the wall: ``left`` or ``right``.
/// distance : float
///     Distance from the wall to the robot's centre (m).
/// speed : float
///     Speed along the wall (m/s).
///
/// Raises
/// ------
/// ValueError
///     If a parameter is out of range.
#[pyclass(frozen, module = "roverlab.drive")]
#[derive(Debug)]
pub(crate) struct WallFollower {
    drive: Mutex<(AlongWall<PidWallFollower>, AlongWallObservation<WallObservation>)>,
    period: f64,
    ended: Mutex<Option<String>>,
}

#[pymethods]
impl WallFollower {
    #[new]
    #[pyo3(signature = (side = "left", distance = 0.2, speed = 0.2))]
    fn new(side: &str, distance: f64, speed: f64) -> Outcome<Self> {
        let side = match side {
            "left" => WallSide::Left,
            "right" => WallSide::Right,
            _ => return Err(Failure::value("side", format!("{side:?}"), "left or right")),
        };
        let parameters = PidWallFollowerParameters { side, distance, speed, ..Default::default() };
        let drive = AlongWall::new(PidWallFollower::new(parameters)?);
        let drive = Mutex::new((drive, AlongWallObservation::default()));
        Ok(Self { drive, period: parameters.period, ended: Mutex::new(None) })
    }

    /// Reads the robot's sensors and decides; the robot is not told.
    ///
    /// Returns
    /// -------
    /// tuple of float
    ///     Linear (m/s) and angular speed (rad/s); (0, 0) once there is an `outcome`.
    fn decide(&self, py: Python<'_>, robot: &Robot) -> Outcome<(f64, f64)> {
        let mut guard = self.drive.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        let (drive, seen) = &mut *guard;
        decide(py, robot, &self.ended, |time, robot| {
            drive.sense(robot, time, seen)?;
            Ok(drive.step(time, seen)?.map_break(|outcome| outcome.to_string()))
        })
    }

    /// Drives a robot until the outcome, or for at most `time_limit` seconds.
    ///
    /// Returns
    /// -------
    /// str or None
    ///     The outcome; None if the time was over.
    #[pyo3(signature = (robot, time_limit = 60.0))]
    fn run(&self, py: Python<'_>, robot: &Robot, time_limit: f64) -> Outcome<Option<String>> {
        run(py, robot, (self.period, time_limit), &self.ended, || self.decide(py, robot))
    }

    /// A sentence about the end, such as something that holds the robot; None before it.
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
