use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use roverlab::io::control::{Behaviour, Senses};
use roverlab::race::{self, RaceObservation, RacerParameters};

use crate::arrays::Natural;
use crate::behaviour::{decide, outcome, run};
use crate::errors::Outcome;
use crate::robot::Robot;

/// Races laps on a track of cones, which it maps with the lidar in the first one.
///
/// Parameters
/// ----------
/// laps : int
///     Number of laps.
#[pyclass(frozen, module = "roverlab.drive")]
pub(crate) struct Racer {
    state: Mutex<(race::Racer, RaceObservation)>,
    period: f64,
    ended: Mutex<Option<String>>,
}

#[pymethods]
impl Racer {
    #[new]
    #[pyo3(signature = (laps = Natural::ONE), text_signature = "(laps=1)")]
    fn new(laps: Natural) -> Outcome<Self> {
        let parameters = RacerParameters { laps: laps.index("laps")?, ..RacerParameters::default() };
        let state = Mutex::new((race::Racer::new(parameters)?, RaceObservation::default()));
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
        let (racer, seen) = &mut *guard;
        decide(py, robot, &self.ended, |time, robot| {
            racer.sense(robot, time, seen)?;
            Ok(Behaviour::step(racer, time, seen)?.map_break(|outcome| outcome.to_string()))
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

    /// A sentence about the end, such as ``"the race is finished"``; None before it.
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
