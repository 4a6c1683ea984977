//! The native part of the Python package `roverlab`: the library's worlds, robots, planners, mazes and image
//! kernels on numpy arrays. Documentation of classes and functions is what Python's `help` shows, so it is in
//! numpy's style.

#![allow(clippy::doc_markdown, reason = "documentation that Python shows names exceptions without backticks")]
#![allow(clippy::needless_pass_by_value, reason = "arguments from Python arrive by value")]

use pyo3::prelude::pymodule;

mod arrays;
mod ascent;
mod batch;
mod batch_arrays;
mod behaviour;
mod bug;
mod cma_es;
mod dive;
mod errors;
mod follower;
mod image;
mod lane_keeper;
mod maze;
mod planner;
mod programs;
mod racer;
mod recording;
mod robot;
mod robot_spec;
mod scene;
mod simulation;
mod truth;
mod vision;
mod wall_follower;
mod way;
mod worlds;

/// Native part of the package; import `roverlab.sim`, `drive`, `nav`, `maze` or `vision` instead.
#[pymodule]
mod _native {
    use numpy::{PyArray1, PyArrayMethods};
    use pyo3::prelude::*;

    /// Version of the package.
    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "Python's name for it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");

    /// Fetches numpy's functions and the counters of borrowed arrays now: at their first use, a signal that
    /// waits would make that fail, which is a panic.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        drop(PyArray1::<f64>::zeros(module.py(), 0, false).try_readonly()?);
        Ok(())
    }

    #[pymodule_export]
    use crate::ascent::Ascent;
    #[pymodule_export]
    use crate::batch::Batch;
    #[pymodule_export]
    use crate::bug::Bug;
    #[pymodule_export]
    use crate::cma_es::CmaEs;
    #[pymodule_export]
    use crate::dive::Dive;
    #[pymodule_export]
    use crate::errors::{FileFormatError, NoPathError, RobotError, UnsupportedError};
    #[pymodule_export]
    use crate::follower::Follower;
    #[pymodule_export]
    use crate::lane_keeper::LaneKeeper;
    #[pymodule_export]
    use crate::maze::{Maze, Route};
    #[pymodule_export]
    use crate::planner::{DStarLite, Path, Planner, distance_field, inflate};
    #[pymodule_export]
    use crate::programs::{run_robios, run_roverlab};
    #[pymodule_export]
    use crate::racer::Racer;
    #[pymodule_export]
    use crate::recording::Recording;
    #[pymodule_export]
    use crate::robot::Robot;
    #[pymodule_export]
    use crate::robot_spec::RobotSpec;
    #[pymodule_export]
    use crate::scene::Scene;
    #[pymodule_export]
    use crate::simulation::Simulation;
    #[pymodule_export]
    use crate::truth::Truth;
    #[pymodule_export]
    use crate::vision::{absolute_difference, canny, gaussian, gray, hue, laplace, sobel, threshold};
    #[pymodule_export]
    use crate::wall_follower::WallFollower;
}
