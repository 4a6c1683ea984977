use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use numpy::PyArray2;
use pyo3::prelude::*;
use roverlab::geometry::{Point, math};
use roverlab::picture::{Mark, Picture};
use roverlab::race::{self, TrackOptions};
use roverlab::random::Stream;
use roverlab::world;
use roverlab::world::formats::{DiskFiles, MemoryFiles, Parsed, load_scene, parse_scene};
use roverlab::world::generate::{
    CourseOptions, PoolKind, ReliefKind, ReliefOptions, RoomOptions, obstacle_course, pool, relief, room,
};
use roverlab::world::road::{self, Appearance, CourseError, RoadCourseOptions};
use roverlab::world::{Clearance, Object, ObjectKind, RobotPlacement, Wall, World};

use crate::arrays::{self, Natural};
use crate::errors::{Failure, Outcome};
use crate::robot_spec::RobotSpec;
use crate::way::CentreLine;

/// A world with robots: the start of a simulation.
///
/// Made by `load`, `parse`, `empty`, `walled`, `built_in`, `room`, `course`, `track`, `road`, `hills` or
/// `pool`; walls, objects and robots can be added. Lengths are in metres, angles in radians counter-clockwise from x.
#[pyclass(module = "roverlab.sim")]
#[derive(Debug, Clone)]
pub(crate) struct Scene {
    pub(crate) content: world::Scene,
    goal: Option<Point>,
    reachable: Option<bool>,
    pub(crate) centre_line: Option<CentreLine>,
    warnings: Vec<String>,
}

impl Scene {
    pub(crate) fn of(world: World) -> Self {
        let content = world::Scene::new(world);
        Self { content, goal: None, reachable: None, centre_line: None, warnings: Vec::new() }
    }

    fn read(parsed: Parsed<world::Scene>) -> Self {
        let warnings = parsed.warnings.iter().map(ToString::to_string).collect();
        let (goal, reachable, centre_line) = (None, None, None);
        Self { content: parsed.value, goal, reachable, centre_line, warnings }
    }

    /// A picture of the world; robots are left to the caller.
    pub(crate) fn picture(scene: &world::Scene, goal: Option<Point>, title: Option<String>) -> Picture {
        let mut picture = Picture::new(&scene.world);
        if let Some(title) = title {
            picture.title(title);
        }
        if let Some(goal) = goal {
            picture.mark(Mark::Goal, goal);
        }
        picture
    }

    pub(crate) fn goal_point(&self) -> Option<Point> {
        self.goal
    }
}

#[pymethods]
impl Scene {
    /// Reads a scene from a file: a script ``.sim``, or without robots a world ``.wld`` or ``.maz``, a ROS
    /// map ``.yaml`` or ``.yml``, or a MovingAI map ``.map``.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     The file. Files that it names are found as EyeSim finds them.
    ///
    /// Raises
    /// ------
    /// FileNotFoundError, FileFormatError
    ///     If there is no such file, or it is not understood; the message has file, line and column.
    #[staticmethod]
    fn load(path: PathBuf) -> Outcome<Self> {
        if !path.exists() {
            return Err(Failure::no_file(&path));
        }
        Ok(Self::read(load_scene(path)?))
    }

    /// Reads a scene from text.
    ///
    /// Parameters
    /// ----------
    /// text : str or bytes
    ///     What would stand in the file.
    /// name : str
    ///     Name of the file. Its ending tells the format, as in `load`.
    /// files : dict of str to bytes, optional
    ///     Files that the text may name. Without it, they are searched on disk.
    #[staticmethod]
    #[pyo3(signature = (text, name, files = None))]
    fn parse(text: Text, name: &str, files: Option<BTreeMap<String, Vec<u8>>>) -> Outcome<Self> {
        let parsed = match files {
            Some(files) => parse_scene(text.0, name, &mut MemoryFiles(files))?,
            None => parse_scene(text.0, name, &mut DiskFiles::new())?,
        };
        Ok(Self::read(parsed))
    }

    /// An empty floor from (0, 0) to (`width`, `height`), without walls (m).
    #[staticmethod]
    fn empty(width: f64, height: f64) -> Outcome<Self> {
        check_size(width, height)?;
        Ok(Self::of(World::empty(width, height)))
    }

    /// A floor from (0, 0) to (`width`, `height`) with a wall on each edge (m).
    #[staticmethod]
    fn walled(width: f64, height: f64) -> Outcome<Self> {
        check_size(width, height)?;
        Ok(Self::of(World::walled(width, height)))
    }

    /// A built-in world, one of `Scene.names()` in any case.
    #[staticmethod]
    fn built_in(name: &str) -> Outcome<Self> {
        World::predefined(name).map(Self::of).ok_or_else(|| {
            Failure::value("name", format!("{name:?}"), &format!("one of {}", World::PREDEFINED.join(", ")))
        })
    }

    /// Names of the built-in worlds.
    #[staticmethod]
    fn names() -> Vec<&'static str> {
        World::PREDEFINED.to_vec()
    }

    /// A random room whose wall can be followed all the way round; `start` is a pose in it.
    ///
    /// Parameters
    /// ----------
    /// seed : int
    ///     Equal seeds give equal rooms on every platform.
    /// distance : float
    ///     Distance from the wall that a robot can keep everywhere, 0.05 to 1 (m).
    #[staticmethod]
    #[pyo3(signature = (seed, distance = 0.2))]
    fn room(seed: Natural, distance: f64) -> Outcome<Self> {
        let mut stream = Stream::new(seed.named("seed")?);
        let drawn = room(&mut stream, &RoomOptions { distance, ..RoomOptions::default() })?;
        Ok(Self::of(drawn.world))
    }

    /// A random field of obstacles with a start and a goal.
    ///
    /// Parameters
    /// ----------
    /// seed : int
    ///     Equal seeds give equal courses on every platform.
    /// robot_radius : float
    ///     Radius of the robot for which the course is made (m).
    /// unreachable : float
    ///     Share of the courses whose goal cannot be reached, 0 to 1.
    /// obstacles : tuple of int, optional
    ///     Smallest and largest number of obstacles, at most 100; otherwise 3 and 8.
    #[staticmethod]
    #[pyo3(signature = (seed, robot_radius = 0.06, unreachable = 0.0, obstacles = None))]
    fn course(
        seed: Natural,
        robot_radius: f64,
        unreachable: f64,
        obstacles: Option<(Natural, Natural)>,
    ) -> Outcome<Self> {
        let mut stream = Stream::new(seed.named("seed")?);
        let obstacles = obstacles.unwrap_or((Natural::of(3), Natural::of(8)));
        let options = CourseOptions {
            robot_radius,
            min_corridor: 3.0 * robot_radius,
            unreachable_share: unreachable,
            obstacles: (obstacles.0.index("obstacles")?, obstacles.1.index("obstacles")?),
            ..CourseOptions::default()
        };
        let course = obstacle_course(&mut stream, &options)?;
        Ok(Self { goal: Some(course.goal), reachable: Some(course.reachable), ..Self::of(course.world) })
    }

    /// A random closed track of cones, blue on the left and yellow on the right; `start` is before its start
    /// line.
    ///
    /// Parameters
    /// ----------
    /// seed : int
    ///     Equal seeds give equal tracks on every platform.
    #[staticmethod]
    fn track(seed: Natural) -> Outcome<Self> {
        let seed = seed.named("seed")?;
        let drawn = race::generate(seed, &TrackOptions::drawn(seed))
            .map_err(|error| Failure::value("seed", seed, &format!("one of a track: {error}")))?;
        let mut scene = Self::of(drawn.track.scene(&[]).world);
        scene.content.world.start = drawn.track.start_pose();
        let stations = drawn.corridor.stations().iter();
        let sections = stations.map(|station| {
            let along = math::atan2(-station.normal.x, station.normal.y);
            [station.position.x, station.position.y, along, station.left, station.right]
        });
        scene.centre_line = Some(sections.collect());
        Ok(scene)
    }

    /// A random closed road for model cars, with two lanes and their markings on the floor; `start` is in the
    /// right lane.
    ///
    /// Parameters
    /// ----------
    /// seed : int
    ///     Equal seeds give equal roads on every platform.
    /// pixel : float, optional
    ///     Size of a pixel of the floor's picture (m); with None, nothing is on the floor.
    #[staticmethod]
    #[pyo3(signature = (seed, pixel = Some(0.004)), text_signature = "(seed, pixel=0.004)")]
    fn road(py: Python<'_>, seed: Natural, pixel: Option<f64>) -> Outcome<Self> {
        let seed = seed.named("seed")?;
        let wrong = |error: CourseError| Failure::value("seed", seed, &format!("one of a road: {error}"));
        let course = road::generate(seed, &RoadCourseOptions::default()).map_err(wrong)?;
        let world = match pixel {
            Some(pixel) => {
                if !(0.001..=0.1).contains(&pixel) {
                    return Err(Failure::value("pixel", pixel, "0.001 to 0.1 m"));
                }
                let appearance = Appearance { pixel, seed, ..Appearance::default() };
                py.detach(|| course.world(&appearance)).map_err(wrong)?
            }
            None => World { floor: course.floor(), start: Some(course.start()), ..World::empty(1.0, 1.0) },
        };
        let half = 0.5 * course.lane_width;
        let count = (course.line.length() / LANE_STATIONS).ceil();
        let sections = (0..count as usize).map(|station| {
            let pose = course.pose(station as f64 * course.line.length() / count, 0.0);
            [pose.x, pose.y, pose.heading, half, half]
        });
        Ok(Self { centre_line: Some(sections.collect()), ..Self::of(world) })
    }

    /// Random hills, and a `start` on gentle ground near their border.
    ///
    /// Parameters
    /// ----------
    /// seed : int
    ///     Equal seeds give equal hills on every platform.
    /// kind : str
    ///     ``range``: hills and mesas on 5 m x 5 m, up to 0.5 m high, some too steep; ``crater``: a ring around
    ///     water; ``ramp``: a ramp up, a bank and a ramp down, on 4 m x 4 m, up to 0.2 m high; ``steps``:
    ///     terraces with a ramp up to each.
    #[staticmethod]
    #[pyo3(signature = (seed, kind = "range"))]
    fn hills(seed: Natural, kind: &str) -> Outcome<Self> {
        let name = |known: &ReliefKind| format!("{known:?}").to_lowercase();
        let found = ReliefKind::ALL.into_iter().find(|known| name(known) == kind).ok_or_else(|| {
            let expected = ReliefKind::ALL.iter().map(name).collect::<Vec<_>>().join(", ");
            Failure::value("kind", format!("{kind:?}"), &format!("one of {expected}"))
        })?;
        let mut stream = Stream::new(seed.named("seed")?);
        let drawn = relief(&mut stream, &ReliefOptions::of(found))?;
        Ok(Self::of(World { start: Some(drawn.start), ..drawn.world }))
    }

    /// A random pool of 6 to 16 m and at most 2.4 m depth, a rectangle, an L or a kidney; `start` is far from
    /// its sides.
    ///
    /// Parameters
    /// ----------
    /// seed : int
    ///     Equal seeds give equal pools on every platform.
    #[staticmethod]
    fn pool(seed: Natural) -> Outcome<Self> {
        let mut stream = Stream::new(seed.named("seed")?);
        let kind = PoolKind::ALL[stream.below(PoolKind::ALL.len())];
        let drawn = pool(&mut stream, kind)?;
        Ok(Self::of(World { start: Some(drawn.start), ..drawn.world }))
    }

    /// Another scene with the same content.
    fn copy(&self) -> Self {
        self.clone()
    }

    /// Adds a wall between two points, 10 mm thick and 200 mm high.
    fn add_wall(&mut self, a: [f64; 2], b: [f64; 2]) -> Outcome<()> {
        check_finite("wall", &[a[0], a[1], b[0], b[1]])?;
        self.content.world.walls.push(Wall::new(Point::new(a[0], a[1]), Point::new(b[0], b[1])));
        Ok(())
    }

    /// Adds an object.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     A built-in object, such as ``"can"``, ``"crate"``, ``"soccer"`` or ``"cone-o"``.
    /// pose : sequence of float
    ///     Its x, y and heading.
    ///
    /// Returns
    /// -------
    /// int
    ///     Index of the object.
    fn add_object(&mut self, name: &str, pose: [f64; 3]) -> Outcome<usize> {
        check_finite("pose", &pose)?;
        let kind = ObjectKind::predefined(name).ok_or_else(|| {
            Failure::value(
                "name",
                format!("{name:?}"),
                &format!("one of {}", ObjectKind::PREDEFINED.join(", ")),
            )
        })?;
        self.content.world.objects.push(Object::new(Arc::new(kind), arrays::pose(pose)));
        Ok(self.content.world.objects.len() - 1)
    }

    /// Adds a robot.
    ///
    /// Parameters
    /// ----------
    /// spec : str or RobotSpec
    ///     Its description, or the name of a built-in one.
    /// pose : sequence of float, optional
    ///     Its x, y and heading; otherwise the scene's `start`.
    ///
    /// Returns
    /// -------
    /// int
    ///     Index of the robot.
    #[pyo3(signature = (spec, pose = None))]
    fn add_robot(&mut self, spec: SpecOrName<'_>, pose: Option<[f64; 3]>) -> Outcome<usize> {
        let spec = match spec {
            SpecOrName::Spec(spec) => Arc::clone(&spec.get().spec),
            SpecOrName::Name(name) => RobotSpec::new(&name)?.spec,
        };
        let pose = match pose {
            Some(pose) => {
                check_finite("pose", &pose)?;
                arrays::pose(pose)
            }
            None => self.content.world.start.ok_or_else(|| {
                Failure::value("pose", "None", "x, y and heading, as the scene has no start")
            })?,
        };
        let objects_before = self.content.world.objects.len();
        self.content.robots.push(RobotPlacement { objects_before, ..RobotPlacement::new(spec, pose) });
        Ok(self.content.robots.len() - 1)
    }

    /// The cells where a disc-shaped robot has room: a boolean array for the planners of `roverlab.nav`.
    ///
    /// Parameters
    /// ----------
    /// resolution : float
    ///     Size of a cell (m).
    /// radius : float
    ///     Radius of the robot (m). Cells nearer than this to a wall or an object are not free.
    ///
    /// Returns
    /// -------
    /// free : ndarray of bool, shape (rows, columns)
    ///     Rows count along y, columns along x.
    /// origin : tuple of float
    ///     x and y of the outer corner of cell [0, 0] (m).
    fn free_cells<'py>(&self, py: Python<'py>, resolution: f64, radius: f64) -> Outcome<FreeCells<'py>> {
        check_finite("radius", &[radius])?;
        let world = &self.content.world;
        let limit = radius.max(resolution);
        let field = py.detach(|| Clearance::new(world, resolution, limit))?;
        let raster = field.raster();
        let free: Vec<bool> = (0..raster.cells()).map(|cell| field.at(cell) >= radius).collect();
        let shape = [raster.rows(), raster.columns()];
        let corner = raster.centre(0);
        let origin = (corner.x - 0.5 * raster.resolution(), corner.y - 0.5 * raster.resolution());
        Ok((arrays::matrix(py, free, shape)?, origin))
    }

    /// Picture of the world and its robots.
    ///
    /// Parameters
    /// ----------
    /// title : str, optional
    ///     Title above it.
    ///
    /// Returns
    /// -------
    /// str
    ///     Text of an SVG file.
    #[pyo3(signature = (title = None))]
    fn to_svg(&self, title: Option<String>) -> String {
        let mut picture = Self::picture(&self.content, self.goal, title);
        for robot in &self.content.robots {
            picture.robot(robot.pose, &robot.spec.footprint);
        }
        picture.to_svg()
    }

    fn _repr_svg_(&self) -> String {
        self.to_svg(None)
    }

    /// Ends of the walls: an array of shape (walls, 4) with x and y of both (m).
    #[getter]
    fn walls<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyArray2<f64>>> {
        let walls = &self.content.world.walls;
        let ends = walls.iter().flat_map(|wall| [wall.line.a.x, wall.line.a.y, wall.line.b.x, wall.line.b.y]);
        arrays::matrix(py, ends.collect(), [walls.len(), 4])
    }

    /// Names and poses of the robots.
    #[getter]
    fn robots(&self) -> Vec<(String, (f64, f64, f64))> {
        let robots = self.content.robots.iter();
        robots.map(|robot| (robot.spec.name.clone(), arrays::triple(robot.pose))).collect()
    }

    /// Names and poses of the objects.
    #[getter]
    fn objects(&self) -> Vec<(String, (f64, f64, f64))> {
        let objects = self.content.world.objects.iter();
        objects.map(|object| (object.kind.name.clone(), arrays::triple(object.pose))).collect()
    }

    /// Start pose of the world, if it has one.
    #[getter]
    fn start(&self) -> Option<(f64, f64, f64)> {
        self.content.world.start.map(arrays::triple)
    }

    /// Height of the water above the floor (m), if there is any.
    #[getter]
    fn water_level(&self) -> Option<f64> {
        self.content.world.water_level
    }

    /// Goal of a `course`; may be set.
    #[getter]
    fn goal(&self) -> Option<(f64, f64)> {
        self.goal.map(|goal| (goal.x, goal.y))
    }

    #[setter]
    fn set_goal(&mut self, goal: Option<[f64; 2]>) -> Outcome<()> {
        if let Some(goal) = goal {
            check_finite("goal", &goal)?;
        }
        self.goal = goal.map(|[x, y]| Point::new(x, y));
        self.reachable = None;
        Ok(())
    }

    /// Centre line of a `track` or of the right lane of a `road`: an array of shape (stations, 5) with x, y,
    /// heading (rad), and the widths to the left and to the right (m). None for other scenes.
    #[getter]
    fn centre_line<'py>(&self, py: Python<'py>) -> Outcome<Option<Bound<'py, PyArray2<f64>>>> {
        let Some(line) = &self.centre_line else { return Ok(None) };
        arrays::matrix(py, line.concat(), [line.len(), 5]).map(Some)
    }

    /// Whether the goal of a `course` can be reached; None for other scenes.
    #[getter]
    fn reachable(&self) -> Option<bool> {
        self.reachable
    }

    /// Smallest and largest x and y of floor, walls and objects: (x0, y0, x1, y1) in m.
    #[getter]
    fn bounds(&self) -> (f64, f64, f64, f64) {
        let bounds = self.content.world.bounds();
        (bounds.min.x, bounds.min.y, bounds.max.x, bounds.max.y)
    }

    /// What the reader of the file could work around, each with file, line and column.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    fn __repr__(&self) -> String {
        let world = &self.content.world;
        let (walls, objects, robots) = (world.walls.len(), world.objects.len(), self.content.robots.len());
        format!("<Scene: {walls} walls, {objects} objects, {robots} robots>")
    }
}

/// Largest distance between two stations of a lane's centre line (m).
const LANE_STATIONS: f64 = 0.1;

type FreeCells<'py> = (Bound<'py, PyArray2<bool>>, (f64, f64));

/// A text, or its bytes.
pub(crate) struct Text(pub(crate) Vec<u8>);

impl FromPyObject<'_, '_> for Text {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        if let Ok(text) = object.extract::<String>() {
            return Ok(Self(text.into_bytes()));
        }
        let bytes = object.extract::<Vec<u8>>();
        bytes.map(Self).map_err(|_| Failure::kind("text", object.get_type(), "str or bytes").into())
    }
}

/// A description of a robot, or the name of a built-in one.
enum SpecOrName<'py> {
    Spec(Bound<'py, RobotSpec>),
    Name(String),
}

impl<'py> FromPyObject<'_, 'py> for SpecOrName<'py> {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(spec) = object.cast::<RobotSpec>() {
            return Ok(Self::Spec(spec.to_owned()));
        }
        let name = object.extract::<String>();
        name.map(Self::Name).map_err(|_| Failure::kind("spec", object.get_type(), "str or RobotSpec").into())
    }
}

fn check_size(width: f64, height: f64) -> Outcome<()> {
    for (name, value) in [("width", width), ("height", height)] {
        if !(value.is_finite() && value > 0.0) {
            return Err(Failure::value(name, value, "a positive, finite number of metres"));
        }
    }
    Ok(())
}

pub(crate) fn check_finite(name: &str, values: &[f64]) -> Outcome<()> {
    if values.iter().all(|value| value.is_finite()) {
        return Ok(());
    }
    Err(Failure::value(name, format!("{values:?}"), "finite numbers"))
}
