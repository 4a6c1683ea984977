use std::sync::Arc;

use numpy::PyArray2;
use pyo3::prelude::*;

use crate::arrays::{self, Natural};
use crate::errors::Outcome;
use crate::simulation::{Shared, pose_of};

/// What is true in a simulated world, for verdicts, pictures and tests. Robots are given by their index.
#[pyclass(frozen, module = "roverlab.sim")]
#[derive(Debug)]
pub(crate) struct Truth {
    shared: Arc<Shared>,
}

impl Truth {
    pub(crate) fn new(shared: &Arc<Shared>) -> Self {
        Self { shared: Arc::clone(shared) }
    }
}

#[pymethods]
impl Truth {
    /// True x, y and heading of a robot (m, m, rad).
    #[pyo3(signature = (robot = Natural::ZERO), text_signature = "($self, robot=0)")]
    fn pose(&self, py: Python<'_>, robot: Natural) -> Outcome<(f64, f64, f64)> {
        pose_of(&self.shared, py, robot.index("robot")?)
    }

    /// True x, y and height (m) of a robot's origin in space, with roll, pitch and yaw (rad) as
    /// `Robot.attitude` has them.
    #[pyo3(signature = (robot = Natural::ZERO), text_signature = "($self, robot=0)")]
    fn pose_in_space(&self, py: Python<'_>, robot: Natural) -> Outcome<[f64; 6]> {
        let pose = self.shared.lock(py).world.in_space(robot.index("robot")?)?.pose;
        let [roll, pitch, yaw] = pose.roll_pitch_yaw();
        Ok([pose.position.x, pose.position.y, pose.position.z, roll, pitch, yaw])
    }

    /// Why a robot no longer drives, or makes no progress, such as ``"tipped over"``; None if nothing has
    /// happened.
    #[pyo3(signature = (robot = Natural::ZERO), text_signature = "($self, robot=0)")]
    fn mishap(&self, py: Python<'_>, robot: Natural) -> Outcome<Option<String>> {
        let truth = self.shared.lock(py).world.in_space(robot.index("robot")?)?;
        Ok(truth.mishap.map(|mishap| mishap.to_string()))
    }

    /// Number of a robot's contacts with walls, objects and robots so far.
    #[pyo3(signature = (robot = Natural::ZERO), text_signature = "($self, robot=0)")]
    fn contacts(&self, py: Python<'_>, robot: Natural) -> Outcome<u32> {
        Ok(self.shared.lock(py).world.contacts(robot.index("robot")?)?)
    }

    /// Where a robot's contacts began: an array of shape (contacts, 2), at most the first 1000 (m).
    #[pyo3(signature = (robot = Natural::ZERO), text_signature = "($self, robot=0)")]
    fn contact_places<'py>(&self, py: Python<'py>, robot: Natural) -> Outcome<Bound<'py, PyArray2<f64>>> {
        let places = self.shared.lock(py).world.truth(robot.index("robot")?)?.contact_places;
        let shape = [places.len(), 2];
        arrays::matrix(py, places.iter().flat_map(|place| [place.x, place.y]).collect(), shape)
    }

    /// Distance that a robot has travelled (m).
    #[pyo3(signature = (robot = Natural::ZERO), text_signature = "($self, robot=0)")]
    fn path_length(&self, py: Python<'_>, robot: Natural) -> Outcome<f64> {
        Ok(self.shared.lock(py).world.truth(robot.index("robot")?)?.path_length)
    }

    /// Trail of a robot, if the simulation has a `trail_interval`.
    ///
    /// Returns
    /// -------
    /// ndarray of float, shape (points, 7)
    ///     Time (s), true x, y and heading, and x, y and heading by odometry.
    #[pyo3(signature = (robot = Natural::ZERO), text_signature = "($self, robot=0)")]
    fn trail<'py>(&self, py: Python<'py>, robot: Natural) -> Outcome<Bound<'py, PyArray2<f64>>> {
        let trail = self.shared.lock(py).world.truth(robot.index("robot")?)?.trail;
        let rows = trail.iter().flat_map(|point| {
            let (pose, odometry) = (point.pose, point.odometry);
            [point.time, pose.x, pose.y, pose.heading, odometry.x, odometry.y, odometry.heading]
        });
        arrays::matrix(py, rows.collect(), [trail.len(), 7])
    }

    fn __repr__(&self) -> String {
        format!("<Truth: {} robots>", self.shared.scene.robots.len())
    }
}
