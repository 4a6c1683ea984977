use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use roverlab::drive::lane_keeping::{self, LaneKeeperParameters, LaneObservation};
use roverlab::io::control::{Behaviour, Senses};
use roverlab::vision::lane_markings::{RoadCamera, RoadModel};
use roverlab::world::RobotSpec;

use crate::behaviour::{decide, run};
use crate::errors::{Failure, Outcome};
use crate::robot::Robot;

/// Keeps a ``RoadCar`` in its lane by camera and odometry.
///
/// Parameters
/// ----------
/// speed : float
///     Maximum speed (m/s).
///
/// Raises
/// ------
/// ValueError
///     If the speed is not positive.
#[pyclass(frozen, module = "roverlab.drive")]
pub(crate) struct LaneKeeper {
    state: Mutex<(lane_keeping::LaneKeeper, LaneObservation)>,
    /// Lane keepers have no outcome.
    ended: Mutex<Option<String>>,
}

/// Time between two images (s): the simulator's nearest to the 30 images a second of a camera.
const PERIOD: f64 = 0.03;

#[pymethods]
impl LaneKeeper {
    #[new]
    #[pyo3(signature = (speed = 2.6))]
    fn new(speed: f64) -> Outcome<Self> {
        let spec = RobotSpec::road_car();
        let camera = spec.camera.as_ref().map(RoadCamera::from);
        let camera = camera.ok_or_else(|| Failure::value("robot", &spec.name, "one with a camera"))?;
        let parameters = LaneKeeperParameters { speed, period: PERIOD, ..LaneKeeperParameters::default() };
        let keeper = lane_keeping::LaneKeeper::new(camera, RoadModel::default(), parameters)?;
        Ok(Self { state: Mutex::new((keeper, LaneObservation::default())), ended: Mutex::new(None) })
    }

    /// Takes an image and decides; the robot is not told.
    ///
    /// Returns
    /// -------
    /// tuple of float
    ///     Linear (m/s) and angular speed (rad/s).
    fn decide(&self, py: Python<'_>, robot: &Robot) -> Outcome<(f64, f64)> {
        let mut guard = self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        let (keeper, seen) = &mut *guard;
        decide(py, robot, &self.ended, |time, robot| {
            keeper.sense(robot, time, seen)?;
            Ok(keeper.step(time, seen)?.map_break(|outcome| outcome.to_string()))
        })
    }

    /// Drives a robot for `time_limit` seconds.
    #[pyo3(signature = (robot, time_limit = 60.0))]
    fn run(&self, py: Python<'_>, robot: &Robot, time_limit: f64) -> Outcome<()> {
        run(py, robot, (PERIOD, time_limit), &self.ended, || self.decide(py, robot))?;
        Ok(())
    }

    /// Time between two decisions (s).
    #[getter]
    #[allow(clippy::unused_self, reason = "a property of Python")]
    fn period(&self) -> f64 {
        PERIOD
    }
}
