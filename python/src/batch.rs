use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::ThreadId;

use numpy::PyUntypedArrayMethods;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use roverlab::geometry::Point;
use roverlab::io::sim::{SimOptions, TICK};
use roverlab::world;

use crate::arrays::{self, Natural};
use crate::batch_arrays::{Arrays, view};
use crate::errors::{Failure, Outcome};
use crate::scene::Scene;
use crate::simulation::{Simulation, options};
use crate::way::{COLUMNS, CentreLine, Way};
use crate::worlds::{Cell, Part, SPACE, Shape, sensors, step_all};

/// Many robots that are stepped in one call, with their state in arrays of one row per robot.
///
/// Each scene is a world of its own, with all its robots; the rows are the robots of the first world, then
/// those of the second, and so on. `step` writes into the same arrays each time, so a view of them stays
/// current. Results do not depend on `threads`.
///
/// Parameters
/// ----------
/// scenes : Scene or sequence of Scene
///     One scene for each world. One scene alone is taken `copies` times.
/// copies : int
///     Number of worlds that are made of each scene. A batch has at most 1,000,000 robots and 2**29 numbers
///     in its arrays.
/// seed : int
///     Seed of the first world; the next ones have the numbers that follow.
/// noise : float
///     Errors of drives and sensors as a multiple of those of the real robot; 0 for none.
/// threads : int
///     Number of threads among which the worlds are divided.
/// scan : bool
///     Whether each step takes a scan of each robot.
/// walls : bool
///     Whether each step finds the wall that is nearest to each robot, for `walls`.
/// ahead : sequence of float, optional
///     Distances along the scene's `centre_line` of the points that each step finds for `lanes`, at least 0
///     (m).
/// space : bool
///     Whether each step reads each robot's inertial unit and depth sensor, for `space`.
/// thrusters : bool
///     Whether commands are those of the thrusters of craft.
/// trail_interval : float, optional
///     Interval between the points of each robot's trail (s), at least 0.01; no trail without it.
///
/// Raises
/// ------
/// ValueError
///     If there is no robot or there are too many, a scene has no centre line for `ahead`, or the robots
///     differ in their numbers of beams or distance sensors.
#[pyclass(frozen, module = "roverlab.sim")]
#[derive(Debug)]
pub(crate) struct Batch {
    worlds: Mutex<Vec<Cell>>,
    /// The thread whose handlers of signals run in the midst of a step.
    interrupted: Mutex<Option<ThreadId>>,
    scenes: Vec<Start>,
    copies: usize,
    noise: f64,
    trail: Option<f64>,
    ahead: Option<Vec<f64>>,
    thrusters: bool,
    threads: usize,
    shape: Shape,
    arrays: Arrays,
}

/// How a world begins.
#[derive(Debug, Clone)]
struct Start {
    scene: Arc<world::Scene>,
    goal: Option<Point>,
    line: Option<CentreLine>,
}

impl Start {
    fn of(scene: &Scene) -> Self {
        let line = scene.centre_line.clone();
        Self { scene: Arc::new(scene.content.clone()), goal: scene.goal_point(), line }
    }

    /// A world that begins so.
    fn cell(&self, ahead: Option<&[f64]>, thrusters: bool, options: SimOptions) -> Outcome<Cell> {
        let way = match ahead {
            None => None,
            Some(ahead) => {
                let line = self.line.as_ref();
                let way = line.and_then(|line| Way::new(line, &self.scene.robots, ahead));
                Some(way.ok_or_else(|| {
                    Failure::value("centre line of a scene", "None", "one, as `Scene.track` has, for `ahead`")
                })?)
            }
        };
        Cell::new(Arc::clone(&self.scene), self.goal, way, thrusters, options)
    }
}

/// Which columns the arrays of a batch have.
#[derive(Debug, Clone, Copy)]
#[allow(clippy::struct_excessive_bools, reason = "Each is an option of the batch by itself")]
struct Columns {
    scan: bool,
    walls: bool,
    /// Number of points ahead.
    ahead: Option<usize>,
    space: bool,
    thrusters: bool,
}

/// Number of columns of a robot's commands.
fn commands(spec: &world::RobotSpec, thrusters: bool) -> Outcome<usize> {
    match &spec.drive {
        _ if !thrusters => Ok(2),
        world::DriveSpec::Craft(craft) => Ok(craft.thrusters.len()),
        _ => Err(Failure::value("robot", format!("{:?}", spec.name), "a craft, for `thrusters`")),
    }
}

/// Most robots of a batch.
const MOST_ROBOTS: usize = 1_000_000;
/// Most numbers in the arrays of a batch: 4 GiB.
const MOST_NUMBERS: usize = 1 << 29;

/// The shape of the arrays; fails if robots differ.
fn shape_of(scenes: &[Start], copies: usize, wanted: Columns) -> Outcome<Shape> {
    let Columns { scan, walls, ahead, space, thrusters } = wanted;
    let mut specs = scenes.iter().flat_map(|start| &start.scene.robots).map(|robot| &robot.spec);
    let Some(first) = specs.next() else {
        return Err(Failure::value("number of robots", 0, "at least one"));
    };
    let columns = commands(first, thrusters)?;
    let beams = |spec: &world::RobotSpec| spec.lidar.map_or(0, |lidar| lidar.points);
    for spec in specs {
        if beams(spec) != beams(first) && scan {
            let expected = format!("{}, as the first robot has", beams(first));
            return Err(Failure::value("number of beams of a robot", beams(spec), &expected));
        }
        if sensors(spec) != sensors(first) {
            let found = format!("{:?}", sensors(spec).iter().map(|psd| psd.0).collect::<Vec<_>>());
            return Err(Failure::value("distance sensors of a robot", found, "those of the first robot"));
        }
        if commands(spec, thrusters)? != columns {
            let expected = format!("{columns}, as the first robot has");
            return Err(Failure::value("number of thrusters of a robot", commands(spec, true)?, &expected));
        }
    }
    let each = scenes.iter().map(|start| start.scene.robots.len()).sum::<usize>();
    let beams = if scan { beams(first) } else { 0 };
    let (walls, lane) = (if walls { 3 } else { 0 }, ahead.map_or(0, |points| COLUMNS + 2 * points));
    let space = if space { SPACE } else { 0 };
    let shape =
        Shape { robots: each, beams, sensors: first.psds.len(), walls, lane, space, commands: columns };
    let most = (MOST_ROBOTS / each).min(MOST_NUMBERS / each / shape.columns());
    if copies > most {
        let expected = format!("at most {most}, for {each} robots of {} numbers each", shape.columns());
        return Err(Failure::value("copies", copies, &expected));
    }
    Ok(Shape { robots: copies * each, ..shape })
}

impl Batch {
    /// The worlds, once no other thread uses them; fails in a handler of a signal that has come in a step,
    /// which would wait for itself.
    fn lock(&self, py: Python<'_>) -> Outcome<MutexGuard<'_, Vec<Cell>>> {
        if *self.interrupted() == Some(std::thread::current().id()) {
            return Err(PyRuntimeError::new_err(
                "the batch is in the midst of a step; expected no use of it by the handler of a signal",
            )
            .into());
        }
        Ok(self.worlds.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner))
    }

    fn interrupted(&self) -> MutexGuard<'_, Option<ThreadId>> {
        self.interrupted.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// How a world begins.
    fn start(&self, world: usize) -> &Start {
        &self.scenes[world / self.copies]
    }

    /// Reads the sensors of a world that has just begun.
    fn read_world(&self, py: Python<'_>, worlds: &mut [Cell], world: usize) -> Outcome<()> {
        let before = worlds[..world].iter().map(Cell::robots).sum();
        let cell = &mut worlds[world];
        let shared = Arc::clone(&cell.shared);
        let mut state = shared.lock(py);
        self.arrays.with_rows(py, self.shape, |rows| {
            let (_, mut rows) = rows.split(before, self.shape);
            Ok(cell.read(&mut state, &mut rows, self.shape)?)
        })
    }
}

/// A world by its index.
fn world_of(worlds: &mut [Cell], world: Natural) -> Outcome<(usize, &mut Cell)> {
    let (world, count) = (world.index("world")?, worlds.len());
    let cell = worlds.get_mut(world).ok_or_else(|| {
        Failure::value("world", world, &format!("an index below {count}, the number of worlds"))
    })?;
    Ok((world, cell))
}

#[pymethods]
impl Batch {
    #[new]
    #[pyo3(
        signature = (
            scenes, *, copies = Natural::ONE, seed = Natural::ONE, noise = 1.0, threads = Natural::ONE,
            scan = true, walls = false, ahead = None, space = false, thrusters = false, trail_interval = None
        ),
        text_signature = "(scenes, *, copies=1, seed=1, noise=1.0, threads=1, scan=True, walls=False, \
            ahead=None, space=False, thrusters=False, trail_interval=None)"
    )]
    #[allow(clippy::too_many_arguments, clippy::fn_params_excessive_bools, reason = "keywords of Python")]
    fn new(
        py: Python<'_>,
        scenes: &Bound<'_, PyAny>,
        copies: Natural,
        seed: Natural,
        noise: f64,
        threads: Natural,
        scan: bool,
        walls: bool,
        ahead: Option<Vec<f64>>,
        space: bool,
        thrusters: bool,
        trail_interval: Option<f64>,
    ) -> Outcome<Self> {
        let seed = seed.named("seed")?;
        let (copies, threads) = (at_least_one("copies", copies)?, at_least_one("threads", threads)?);
        let scenes = scenes_of(scenes)?;
        if let Some(wrong) = ahead.iter().flatten().find(|metres| !(0.0..=1e6).contains(*metres)) {
            return Err(Failure::value("ahead", wrong, "distances of 0 to 1000000 m"));
        }
        let columns = Columns { scan, walls, ahead: ahead.as_ref().map(Vec::len), space, thrusters };
        let shape = shape_of(&scenes, copies, columns)?;
        let cell = |world: usize| {
            py.check_signals()?;
            let options = options(seed.wrapping_add(world as u64), noise, false, trail_interval)?;
            py.detach(|| scenes[world / copies].cell(ahead.as_deref(), thrusters, options))
        };
        let mut worlds = (0..copies * scenes.len()).map(cell).collect::<Outcome<Vec<_>>>()?;
        let (arrays, trail) = (Arrays::new(py, shape), trail_interval);
        let (none, interrupted) = (Mutex::new(Vec::new()), Mutex::new(None));
        let batch = Self {
            worlds: none,
            interrupted,
            scenes,
            copies,
            noise,
            trail,
            ahead,
            thrusters,
            threads,
            shape,
            arrays,
        };
        (0..worlds.len()).try_for_each(|world| batch.read_world(py, &mut worlds, world))?;
        *batch.lock(py)? = worlds;
        Ok(batch)
    }

    /// Commands all robots, lets time pass in all worlds, and reads all sensors into the arrays.
    ///
    /// Parameters
    /// ----------
    /// commands : ndarray of float64, shape (robots, 2)
    ///     Linear (m/s) and angular speed (rad/s) of each robot. With the option `thrusters`, of shape
    ///     (robots, thrusters), the command of each thruster as a fraction of its full speed, -1 to 1.
    /// seconds : float
    ///     Duration (s), rounded to ticks of 10 ms.
    fn step(&self, py: Python<'_>, commands: &Bound<'_, PyAny>, seconds: f64) -> Outcome<()> {
        let columns = self.shape.commands;
        let expected = &format!("an array of float64 of shape (robots, {columns})");
        let commands = arrays::readable::<f64, numpy::Ix2>("commands", commands, expected)?;
        let shape = [self.shape.robots, columns];
        if commands.shape() != shape {
            return Err(arrays::wrong_shape("commands", commands.shape(), &arrays::shown(&shape)));
        }
        let ordered: Vec<f64>;
        // Contiguous by columns is contiguous as well, but in another order.
        let commands = if commands.is_c_contiguous() {
            commands.as_slice().map_err(PyErr::from)?
        } else {
            ordered = commands.as_array().iter().copied().collect();
            &ordered
        };
        check_commands(commands, columns, self.thrusters)?;
        let mut worlds = self.lock(py)?;
        let ticks = ticks_of(seconds)?;
        let most = (PART / self.shape.robots as u64).max(1);
        let mut done = 0;
        loop {
            let now = most.min(ticks - done);
            let part = Part { ticks: now, begins: done == 0, ends: done + now == ticks };
            self.arrays.with_rows(py, self.shape, |rows| {
                let (worlds, how) = (&mut *worlds, (self.shape, self.threads));
                Ok(py.detach(|| step_all(worlds, commands, rows, part, how))?)
            })?;
            done += now;
            if part.ends {
                return Ok(());
            }
            *self.interrupted() = Some(std::thread::current().id());
            let signals = py.check_signals();
            *self.interrupted() = None;
            signals?;
        }
    }

    /// Begins a world again, and reads its robots' sensors.
    ///
    /// Parameters
    /// ----------
    /// world : int
    ///     Index of the world.
    /// seed : int
    ///     Its seed from now on.
    /// scene : Scene, optional
    ///     Another scene with as many robots; otherwise the one that it had at first.
    #[pyo3(signature = (world, seed, scene = None))]
    fn reset(
        &self,
        py: Python<'_>,
        world: Natural,
        seed: Natural,
        scene: Option<PyRef<'_, Scene>>,
    ) -> Outcome<()> {
        let seed = seed.named("seed")?;
        let mut worlds = self.lock(py)?;
        let (world, cell) = world_of(&mut worlds, world)?;
        let start = scene.as_ref().map_or_else(|| self.start(world).clone(), |scene| Start::of(scene));
        let ahead = self.ahead.as_deref();
        let columns = Columns {
            scan: self.shape.beams > 0,
            walls: self.shape.walls > 0,
            ahead: ahead.map(<[f64]>::len),
            space: self.shape.space > 0,
            thrusters: self.thrusters,
        };
        let shape = shape_of(std::slice::from_ref(&start), 1, columns)?;
        if shape != (Shape { robots: cell.robots(), ..self.shape }) {
            let found = format!("{} robots of {} beams", shape.robots, shape.beams);
            let expected = format!("{} robots of {} beams", cell.robots(), self.shape.beams);
            return Err(Failure::value("scene", found, &expected));
        }
        *cell = start.cell(ahead, self.thrusters, options(seed, self.noise, false, self.trail)?)?;
        self.read_world(py, &mut worlds, world)
    }

    /// A world as a `Simulation`: its robots one by one, its truth and its picture.
    ///
    /// It is the same world until `reset` begins that again. What its robots are told, and time that passes
    /// in it, counts in the batch too; the arrays show it after the next step.
    ///
    /// Parameters
    /// ----------
    /// world : int
    ///     Index of the world.
    #[pyo3(signature = (world = Natural::ZERO), text_signature = "($self, world=0)")]
    fn simulation(&self, py: Python<'_>, world: Natural) -> Outcome<Simulation> {
        let mut worlds = self.lock(py)?;
        Ok(Simulation::of(Arc::clone(&world_of(&mut worlds, world)?.1.shared)))
    }

    /// Ranges of the lidars (m), of shape (robots, beams); inf without a return. No columns without scans.
    #[getter]
    fn ranges<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        view(py, &self.arrays.ranges)
    }

    /// Distances that the sensors measure (m), of shape (robots, sensors), in the order of
    /// `RobotSpec.distance_sensors`.
    #[getter]
    fn distances<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        view(py, &self.arrays.distances)
    }

    /// Poses by odometry, of shape (robots, 3): x, y and heading (m, m, rad).
    #[getter]
    fn poses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        view(py, &self.arrays.poses)
    }

    /// Velocities by the wheels, of shape (robots, 2): linear (m/s) and angular (rad/s).
    #[getter]
    fn speeds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        view(py, &self.arrays.speeds)
    }

    /// Whether something holds each robot, of shape (robots,).
    #[getter]
    fn stalled<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        view(py, &self.arrays.stalled)
    }

    /// Ground truth: poses in the world, of shape (robots, 3).
    #[getter]
    fn true_poses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        view(py, &self.arrays.true_poses)
    }

    /// Ground truth: number of contacts so far, of shape (robots,).
    #[getter]
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        view(py, &self.arrays.contacts)
    }

    /// Ground truth: the nearest walls, of shape (robots, 3): distance from the wall's surface (m), and x and
    /// y of the unit vector towards it; inf and zeros without walls. No columns without the option `walls`.
    #[getter]
    fn walls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        view(py, &self.arrays.walls)
    }

    /// Ground truth: the robots on the centre lines of their scenes, of shape (robots, 5 + 2 points).
    /// Distance along the line and length of the line (m), distance to the left of it (m), turn from its
    /// direction (rad), distance from the nearer edge, negative outside (m), all of the middle of the robot's
    /// outline; then for each point ahead its distances ahead of the robot and to the left (m). No columns
    /// without the option `ahead`.
    #[getter]
    fn lanes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        view(py, &self.arrays.lanes)
    }

    /// The robots in space, of shape (robots, 9). Measured: roll, pitch and yaw (rad), turn rates about the
    /// axes ahead, to the left and upwards (rad/s), and depth of the sensor below the surface (m), 0 without
    /// a sensor. Ground truth: height above the world's origin (m), and 1 if the robot has tipped, fallen or
    /// drowned, otherwise 0. No columns without the option `space`.
    #[getter]
    fn space<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        view(py, &self.arrays.space)
    }

    /// Number of worlds.
    #[getter]
    fn worlds(&self) -> usize {
        self.copies * self.scenes.len()
    }

    /// Times of the worlds since their start (s).
    #[getter]
    fn times(&self, py: Python<'_>) -> Outcome<Vec<f64>> {
        let worlds = self.lock(py)?;
        Ok(worlds.iter().map(|cell| cell.shared.lock(py).world.time()).collect())
    }

    fn __len__(&self) -> usize {
        self.shape.robots
    }

    fn __repr__(&self) -> String {
        format!("<Batch: {} robots in {} worlds>", self.shape.robots, self.worlds())
    }
}

/// Robot ticks between two looks for Ctrl-C: about a tenth of a second.
const PART: u64 = 1_000_000;

/// Ticks of a step.
fn ticks_of(seconds: f64) -> Outcome<u64> {
    if !(0.0..=1e6).contains(&seconds) {
        return Err(Failure::value("seconds", seconds, "a finite number from 0 to 1000000"));
    }
    Ok((seconds / TICK).round() as u64)
}

/// Checks all commands before any robot is told.
fn check_commands(commands: &[f64], columns: usize, thrusters: bool) -> Outcome<()> {
    let (most, expected) =
        if thrusters { (1.0, "-1 to 1") } else { (1e6, "a finite number of at most 1e6 either way") };
    let wrong = commands.iter().position(|command| command.is_nan() || command.abs() > most);
    wrong.map_or(Ok(()), |at| {
        let name = format!("commands[{}, {}]", at / columns, at % columns);
        Err(Failure::value(&name, commands[at], expected))
    })
}

fn at_least_one(name: &str, count: Natural) -> Outcome<usize> {
    match count.index(name)? {
        0 => Err(Failure::value(name, 0, "at least 1")),
        count => Ok(count),
    }
}

/// One scene, or each of a sequence.
fn scenes_of(scenes: &Bound<'_, PyAny>) -> Outcome<Vec<Start>> {
    let taken = |object: &Bound<'_, PyAny>| {
        let scene = object.cast::<Scene>();
        let scene =
            scene.map_err(|_| Failure::kind("scenes", object.get_type(), "Scene or a sequence of them"))?;
        Ok(Start::of(&*scene.try_borrow().map_err(PyErr::from)?))
    };
    if scenes.is_instance_of::<Scene>() {
        return Ok(vec![taken(scenes)?]);
    }
    let scenes = scenes
        .try_iter()
        .map_err(|_| Failure::kind("scenes", scenes.get_type(), "Scene or a sequence of them"))?;
    scenes.map(|scene| taken(&scene?)).collect()
}
