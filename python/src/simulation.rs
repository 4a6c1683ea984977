use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use roverlab::geometry::Point;
use roverlab::io::LidarScan;
use roverlab::io::sim::{NoiseModel, SimOptions, Stepped, TICK};
use roverlab::picture::Style;
use roverlab::world;

use crate::arrays::{self, Natural};
use crate::errors::{Failure, Outcome};
use crate::robot::Robot;
use crate::scene::Scene;
use crate::truth::Truth;

/// A world and its robots in virtual time.
///
/// The world stands still until `run` or a robot's `wait` lets time pass, in ticks of 10 ms. The same scene,
/// seed and calls give the same run, to the bit, on every platform.
///
/// Parameters
/// ----------
/// scene : Scene
///     The world and its robots; it is copied.
/// seed : int
///     Seed of all random numbers.
/// noise : float
///     Errors of drives and sensors as a multiple of those of the real robot; 0 for none.
/// pushing : bool
///     Whether robots push objects that are not heavier than they are, instead of stopping before them.
/// trail_interval : float, optional
///     Interval between the points of each robot's trail (s), at least 0.01; no trail without it.
///
/// Raises
/// ------
/// ValueError
///     If an option is out of range, or a robot's description or pose is not valid.
#[pyclass(frozen, module = "roverlab.sim")]
#[derive(Debug)]
pub(crate) struct Simulation {
    shared: Arc<Shared>,
}

/// A world that a simulation, its robots and its truth have in common.
#[derive(Debug)]
pub(crate) struct Shared {
    state: Mutex<State>,
    pub(crate) scene: Arc<world::Scene>,
    goal: Option<Point>,
}

#[derive(Debug)]
pub(crate) struct State {
    pub(crate) world: Stepped,
    /// The last scan, whose memory the next one takes.
    pub(crate) scan: LidarScan,
    /// When other threads of Python were last let run.
    shared_at: Instant,
}

/// Robot ticks below which a call lets other threads of Python run only when that is due.
const SHORT: usize = 64;
/// Robot ticks between two looks for Ctrl-C: some milliseconds.
const PART: usize = 20_000;
/// Real time after which other threads of Python are due: longer than the 5 ms after which a thread that
/// waits asks for its turn, as only one that has asked is sure to get it.
const DUE: Duration = Duration::from_millis(6);
/// What a path to draw should be.
const PATH: &str = "an array of float64 of shape (points, 2)";

impl Shared {
    /// A world at its start.
    pub(crate) fn new(scene: Arc<world::Scene>, goal: Option<Point>, options: SimOptions) -> Outcome<Self> {
        let world = Stepped::new(&scene, options)?;
        let state = State { world, scan: LidarScan::default(), shared_at: now() };
        Ok(Self { state: Mutex::new(state), scene, goal })
    }

    /// The world, once no other thread uses it.
    pub(crate) fn lock(&self, py: Python<'_>) -> MutexGuard<'_, State> {
        self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets time pass. Other threads of Python run meanwhile or, if it is short, every few milliseconds of
    /// many calls. Ctrl-C ends it.
    pub(crate) fn run_for(&self, py: Python<'_>, seconds: f64) -> Outcome<()> {
        not_negative("seconds", seconds)?;
        let robots = self.scene.robots.len().max(1);
        let ticks = (seconds / TICK).round();
        if ticks.is_nan() || ticks * robots as f64 <= SHORT as f64 || ticks > 1e8 {
            let mut state = self.lock(py);
            state.world.run_for(seconds)?;
            let now = now();
            if now.duration_since(state.shared_at) > DUE {
                state.shared_at = now;
                drop(state);
                py.detach(std::thread::yield_now);
            }
            return Ok(());
        }
        let (mut left, part) = (ticks as usize, (PART / robots).max(1));
        while left > 0 {
            let now = left.min(part);
            py.detach(|| self.free_lock().world.run_for(now as f64 * TICK))?;
            left -= now;
            py.check_signals()?;
        }
        Ok(())
    }

    /// The world, for a thread that runs no Python.
    pub(crate) fn free_lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Fails if a duration is negative.
fn not_negative(name: &str, seconds: f64) -> Outcome<()> {
    if seconds < 0.0 { Err(Failure::value(name, seconds, "at least 0")) } else { Ok(()) }
}

/// Real time, on which no result depends.
#[allow(clippy::disallowed_methods, reason = "threads of Python take turns in real time")]
fn now() -> Instant {
    Instant::now()
}

/// Options of a world; `noise` multiplies the errors of the real robot.
pub(crate) fn options(seed: u64, noise: f64, pushing: bool, trail: Option<f64>) -> Outcome<SimOptions> {
    if !(noise >= 0.0 && noise.is_finite()) {
        return Err(Failure::value("noise", noise, "a finite number of at least 0"));
    }
    let noise = NoiseModel::real().scaled(noise);
    Ok(SimOptions { seed, noise, pushing, trail_interval: trail, ..SimOptions::default() })
}

impl Simulation {
    pub(crate) fn of(shared: Arc<Shared>) -> Self {
        Self { shared }
    }
}

#[pymethods]
impl Simulation {
    #[new]
    #[pyo3(
        signature = (scene, *, seed = Natural::ONE, noise = 1.0, pushing = false, trail_interval = None),
        text_signature = "(scene, *, seed=1, noise=1.0, pushing=False, trail_interval=None)"
    )]
    fn new(
        scene: PyRef<'_, Scene>,
        seed: Natural,
        noise: f64,
        pushing: bool,
        trail_interval: Option<f64>,
    ) -> Outcome<Self> {
        let options = options(seed.named("seed")?, noise, pushing, trail_interval)?;
        let shared = Shared::new(Arc::new(scene.content.clone()), scene.goal_point(), options)?;
        Ok(Self::of(Arc::new(shared)))
    }

    /// Lets time pass for all robots.
    ///
    /// Parameters
    /// ----------
    /// seconds : float
    ///     Duration (s), rounded to ticks of 10 ms; at most 1e6.
    fn run(&self, py: Python<'_>, seconds: f64) -> Outcome<()> {
        self.shared.run_for(py, seconds)
    }

    /// A robot by its index in the scene.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If there is no such robot.
    #[pyo3(signature = (index = Natural::ZERO), text_signature = "($self, index=0)")]
    fn robot(&self, index: Natural) -> Outcome<Robot> {
        Robot::new(&self.shared, index.index("robot")?)
    }

    /// All robots in the order of the scene.
    #[getter]
    fn robots(&self) -> Outcome<Vec<Robot>> {
        (0..self.shared.scene.robots.len()).map(|index| Robot::new(&self.shared, index)).collect()
    }

    /// What is true in the world, which no robot knows.
    #[getter]
    fn truth(&self) -> Truth {
        Truth::new(&self.shared)
    }

    /// Time since the start (s).
    #[getter]
    fn time(&self, py: Python<'_>) -> f64 {
        self.shared.lock(py).world.time()
    }

    /// Picture of the world and its robots, with their trails if the simulation keeps them.
    ///
    /// Parameters
    /// ----------
    /// title : str, optional
    ///     Title above it.
    /// path : ndarray of float, shape (points, 2), optional
    ///     A line to draw, such as a plan: x and y (m).
    ///
    /// Returns
    /// -------
    /// str
    ///     Text of an SVG file.
    #[pyo3(signature = (title = None, path = None))]
    fn to_svg(
        &self,
        py: Python<'_>,
        title: Option<String>,
        path: Option<&Bound<'_, PyAny>>,
    ) -> Outcome<String> {
        let shared = &self.shared;
        let mut picture = Scene::picture(&shared.scene, shared.goal, title);
        if let Some(path) = path {
            let path = arrays::readable::<f64, numpy::Ix2>("path", path, PATH)?;
            if path.shape()[1] != 2 {
                return Err(arrays::wrong_shape("path", path.shape(), "(points, 2)"));
            }
            let points: Vec<Point> =
                path.as_array().outer_iter().map(|row| Point::new(row[0], row[1])).collect();
            picture.line(points, Style::plan());
        }
        for (index, robot) in shared.scene.robots.iter().enumerate() {
            let truth = shared.lock(py).world.truth(index)?;
            let mut trail: Vec<_> = truth.trail.iter().map(|point| (point.time, point.pose)).collect();
            if trail.is_empty() {
                picture.robot(truth.pose, &robot.spec.footprint);
            } else {
                trail.insert(0, (0.0, robot.pose));
                picture.drive(&trail, &robot.spec.footprint);
            }
        }
        Ok(picture.to_svg())
    }

    fn _repr_svg_(&self, py: Python<'_>) -> Outcome<String> {
        self.to_svg(py, None, None)
    }

    fn __len__(&self) -> usize {
        self.shared.scene.robots.len()
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        format!("<Simulation: {} robots, {} s>", self.shared.scene.robots.len(), self.time(py))
    }
}

/// x, y and heading of a robot's pose.
pub(crate) fn pose_of(shared: &Shared, py: Python<'_>, robot: usize) -> Outcome<(f64, f64, f64)> {
    Ok(arrays::triple(shared.lock(py).world.pose(robot)?))
}
