use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use roverlab::drive::marine::{self, DiveObservation, DiveParameters, Thrust};
use roverlab::io::control::{Behaviour, Command, Senses};
use roverlab::world::DriveSpec;

use crate::behaviour::{acting, command};
use crate::errors::{Failure, Outcome};
use crate::robot::Robot;
use crate::robot_spec::RobotSpec;

/// Brings a craft to a depth, and holds that and its heading.
///
/// Parameters
/// ----------
/// spec : RobotSpec
///     The craft, such as ``RobotSpec("Mako")``.
/// depth : float
///     Depth of its sensor (m).
/// heading : float
///     Heading (rad).
///
/// Raises
/// ------
/// ValueError
///     If the robot is no craft, or a parameter is out of range.
#[pyclass(frozen, module = "roverlab.drive")]
#[derive(Debug)]
pub(crate) struct Dive {
    state: Mutex<(marine::Dive, DiveObservation)>,
    thrusters: usize,
    period: f64,
    /// Dives have no outcome.
    ended: Mutex<Option<String>>,
}

/// Longest dive (s): as good as without an end.
const DURATION: f64 = 1e9;

#[pymethods]
impl Dive {
    #[new]
    #[pyo3(signature = (spec, depth = 1.0, heading = 0.0))]
    fn new(spec: &RobotSpec, depth: f64, heading: f64) -> Outcome<Self> {
        let DriveSpec::Craft(craft) = &spec.spec.drive else {
            return Err(Failure::value("spec", format!("{:?}", spec.spec.name), "a craft"));
        };
        let parameters = DiveParameters { depth, heading, duration: DURATION, ..DiveParameters::default() };
        let state = Mutex::new((marine::Dive::new(craft, parameters)?, DiveObservation::default()));
        let (thrusters, period) = (craft.thrusters.len(), parameters.period);
        Ok(Self { state, thrusters, period, ended: Mutex::new(None) })
    }

    /// Reads the craft's sensors and decides; the craft is not told.
    ///
    /// Returns
    /// -------
    /// list of float
    ///     Command of each thruster as a fraction of its full speed, -1 to 1.
    fn decide(&self, py: Python<'_>, robot: &Robot) -> Outcome<Vec<f64>> {
        let thrust = self.thrust(py, robot)?;
        Ok(thrust.map_or(vec![0.0; self.thrusters], |thrust| thrust.commands().to_vec()))
    }

    /// Drives a craft for `time_limit` seconds.
    #[pyo3(signature = (robot, time_limit = 60.0))]
    fn run(&self, py: Python<'_>, robot: &Robot, time_limit: f64) -> Outcome<()> {
        acting(py, robot, (self.period, time_limit), &self.ended, || match self.thrust(py, robot)? {
            Some(thrust) => robot.call(py, |robot| thrust.apply(robot)),
            None => Ok(()),
        })?;
        robot.call(py, |robot| Thrust::stop(robot))
    }

    /// Time between two decisions (s).
    #[getter]
    fn period(&self) -> f64 {
        self.period
    }
}

impl Dive {
    fn thrust(&self, py: Python<'_>, robot: &Robot) -> Outcome<Option<Thrust>> {
        let mut guard = self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        let (dive, seen) = &mut *guard;
        command(py, robot, &self.ended, |time, robot| {
            dive.sense(robot, time, seen)?;
            Ok(dive.step(time, seen)?.map_break(|outcome| outcome.to_string()))
        })
    }
}
