use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use roverlab::drive::terrain::{self, AscentObservation, AscentParameters, SlopeSensor};
use roverlab::io::control::{Behaviour, Senses};

use crate::behaviour::{decide, outcome, run};
use crate::errors::{Failure, Outcome};
use crate::robot::Robot;
use crate::robot_spec::RobotSpec;

/// Climbs a hill by steepest ascent, by distance sensors that look down, to a local maximum.
///
/// Parameters
/// ----------
/// spec : RobotSpec
///     The robot, which has to have such sensors (`RobotSpec.with_slope_sensors`).
///
/// Raises
/// ------
/// ValueError
///     If it has fewer than three.
#[pyclass(frozen, module = "roverlab.drive")]
#[derive(Debug)]
pub(crate) struct Ascent {
    state: Mutex<(terrain::Ascent, AscentObservation)>,
    period: f64,
    ended: Mutex<Option<String>>,
}

#[pymethods]
impl Ascent {
    #[new]
    fn new(spec: &RobotSpec) -> Outcome<Self> {
        let spec = &spec.spec;
        let sensor = SlopeSensor::psds(spec).ok_or_else(|| {
            Failure::value(
                "spec",
                format!("{:?}", spec.name),
                "a robot with three sensors that look down, at least",
            )
        })?;
        let parameters = AscentParameters::of(spec);
        let state = Mutex::new((terrain::Ascent::new(sensor, parameters)?, AscentObservation::default()));
        Ok(Self { state, period: parameters.period, ended: Mutex::new(None) })
    }

    /// Reads the robot's sensors and decides; the robot is not told.
    ///
    /// Returns
    /// -------
    /// tuple of float
    ///     Linear (m/s) and angular speed (rad/s); (0, 0) once there is an `outcome`.
    fn decide(&self, py: Python<'_>, robot: &Robot) -> Outcome<(f64, f64)> {
        let mut guard = self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        let (ascent, seen) = &mut *guard;
        decide(py, robot, &self.ended, |time, robot| {
            let mut ascent = ascent.by_distance_sensors();
            ascent.sense(robot, time, seen)?;
            Ok(ascent.step(time, seen)?.map_break(|outcome| outcome.to_string()))
        })
    }

    /// Drives a robot until the outcome, or for at most `time_limit` seconds.
    ///
    /// Returns
    /// -------
    /// str or None
    ///     The outcome; None if the time was over.
    #[pyo3(signature = (robot, time_limit = 300.0))]
    fn run(&self, py: Python<'_>, robot: &Robot, time_limit: f64) -> Outcome<Option<String>> {
        run(py, robot, (self.period, time_limit), &self.ended, || self.decide(py, robot))
    }

    /// A sentence about the end, such as ``"it does not get higher"``; None before it.
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
