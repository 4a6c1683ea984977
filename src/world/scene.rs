use std::sync::Arc;

use super::{Billboard, Marker, Object, Occupancy, OccupancyGrid, RobotSpec, Terrain, Texture, Wall, Water};
use crate::geometry::{Aabb, Point, Pose, Vector};

/// A place without robots: floor, walls, objects and marks.
#[derive(Debug, Clone, PartialEq)]
pub struct World {
    /// The floor. Its edge does not stop robots; only walls do.
    pub floor: Aabb,
    /// An image stretched over the floor.
    pub floor_texture: Option<Texture>,
    /// The walls.
    pub walls: Vec<Wall>,
    /// The map whose outlines are the walls, if there is one; walls alone do not define their solid side.
    pub map: Option<Arc<OccupancyGrid>>,
    /// The objects in the order of their placement.
    pub objects: Vec<Object>,
    /// Marks on the floor.
    pub markers: Vec<Marker>,
    /// Signs and figures, visible to cameras only.
    pub billboards: Vec<Billboard>,
    /// Pose at which a run starts, from the world's file or the first robot of a script. Of several places
    /// far from each other, it decides which one maps cover, see [`site`](World::site).
    pub start: Option<Pose>,
    /// Named places: the letters of a maze.
    pub places: Vec<Place>,
    /// Hills instead of a level floor.
    pub terrain: Option<Terrain>,
    /// Height of the water surface above the floor (m).
    pub water_level: Option<f64>,
    /// Properties and motion of the water.
    pub water: Water,
}

impl World {
    /// An empty floor from (0, 0) with `width` metres along x and `height` metres along y, without walls.
    /// Negative sizes extend it to the other side of (0, 0). A floor without an area is accepted: it shows in
    /// no picture, and robots drive beyond a floor's edges anyway.
    pub fn empty(width: f64, height: f64) -> Self {
        Self {
            floor: Aabb::new(Point::origin(), Point::new(width, height)),
            floor_texture: None,
            walls: Vec::new(),
            map: None,
            objects: Vec::new(),
            markers: Vec::new(),
            billboards: Vec::new(),
            start: None,
            places: Vec::new(),
            terrain: None,
            water_level: None,
            water: Water::default(),
        }
    }

    /// A floor from (0, 0) with walls on its four edges. Sizes are as for [`World::empty`]; with one of 0,
    /// the walls enclose nothing.
    ///
    /// ```
    /// let world = roverlab::world::World::walled(2.0, 1.0);
    /// assert_eq!(world.walls.len(), 4);
    /// ```
    pub fn walled(width: f64, height: f64) -> Self {
        let mut world = Self::empty(width, height);
        world.add_loop(&[
            Point::new(0.0, 0.0),
            Point::new(width, 0.0),
            Point::new(width, height),
            Point::new(0.0, height),
        ]);
        world
    }

    /// Adds walls along a closed line through some points.
    pub fn add_loop(&mut self, corners: &[Point]) {
        let next = corners.iter().cycle().skip(1);
        self.walls.extend(corners.iter().zip(next).map(|(&a, &b)| Wall::new(a, b)));
    }

    /// Whether a point is in an occupied cell of the map of the walls.
    pub fn is_inside_walls(&self, point: Point) -> bool {
        self.map.as_ref().is_some_and(|map| {
            map.cell_at(point).is_some_and(|(column, row)| map.cell(column, row) == Occupancy::Occupied)
        })
    }

    /// Bounding box of floor, walls and objects.
    pub fn bounds(&self) -> Aabb {
        let walls = self.walls.iter().flat_map(|w| [w.line.a, w.line.b]);
        let objects = self.objects.iter().flat_map(|o| {
            let r = o.kind.shape.bounding_radius();
            let reach = Vector::new(r, r);
            [o.pose.position() - reach, o.pose.position() + reach]
        });
        Aabb::around(walls.chain(objects)).map_or(self.floor, |b| b.union(&self.floor))
    }
}

/// A named place in a world: a letter in a maze file, used in scenes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// The letter as written.
    pub letter: char,
    /// Centre of its cell.
    pub position: Point,
    /// Heading of the letter (rad), if it has one.
    pub heading: Option<f64>,
}

/// A robot placed in a world.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotPlacement {
    /// Its description.
    pub spec: Arc<RobotSpec>,
    /// Start pose.
    pub pose: Pose,
    /// Height of its foot above the floor, for robots that swim, dive or are dropped (m).
    pub elevation: f64,
    /// Its program in the simulation script, as written.
    pub program: Option<String>,
    /// Number of the world's objects placed before it; robots and objects are numbered in one sequence.
    pub objects_before: usize,
}

impl RobotPlacement {
    /// A robot on the floor, without a program.
    pub fn new(spec: Arc<RobotSpec>, pose: Pose) -> Self {
        Self { spec, pose, elevation: 0.0, program: None, objects_before: 0 }
    }
}

/// A world with robots: the start of a simulation.
///
/// ```
/// use roverlab::geometry::Pose;
/// use roverlab::world::{RobotPlacement, RobotSpec, Scene, World};
/// let mut scene = Scene::with_robot(World::walled(2.0, 2.0), RobotSpec::s4(), Pose::new(0.5, 0.5, 0.0));
/// scene.robots.push(RobotPlacement::new(RobotSpec::labbot().into(), Pose::new(1.5, 1.5, 3.1)));
/// assert_eq!((scene.robots.len(), scene.world.walls.len()), (2, 4));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Floor, walls, objects and marks.
    pub world: World,
    /// The robots in the order of their placement.
    pub robots: Vec<RobotPlacement>,
    /// Display settings.
    pub settings: Settings,
}

/// Additional content of a scene's picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Settings {
    /// Sensor beams of the robots: `VIS` in a simulation script.
    pub show_sensors: bool,
    /// Trails of the robots: `TRACE` in a simulation script.
    pub show_traces: bool,
}

impl Scene {
    /// A world without robots.
    pub fn new(world: World) -> Self {
        Self { world, robots: Vec::new(), settings: Settings::default() }
    }

    /// A world with one robot.
    pub fn with_robot(world: World, spec: RobotSpec, pose: Pose) -> Self {
        Self { robots: vec![RobotPlacement::new(Arc::new(spec), pose)], ..Self::new(world) }
    }

    /// Numbers of the robots, from 1, in `EyeSim`'s single sequence of robots and objects by placement.
    ///
    /// ```
    /// use roverlab::world::formats::{MemoryFiles, sim};
    ///
    /// let script = "can 500 500 0\nS4 1000 500 0\ncan 1500 500 0\nS4 1000 1500 0\n";
    /// let scene = sim::parse(script, "cans.sim", &mut MemoryFiles::default())?.value;
    /// assert_eq!(scene.robot_numbers(), [2, 4]);
    /// assert_eq!(scene.object_numbers(), [1, 3]);
    /// # Ok::<(), roverlab::world::formats::FormatError>(())
    /// ```
    pub fn robot_numbers(&self) -> Vec<u32> {
        let objects = self.world.objects.len();
        let before = self.robots.iter().map(|robot| robot.objects_before.min(objects));
        before.enumerate().map(|(index, before)| (index + before + 1) as u32).collect()
    }

    /// Numbers of the objects in the sequence of [`robot_numbers`](Scene::robot_numbers).
    pub fn object_numbers(&self) -> Vec<u32> {
        let behind =
            |object: usize| self.robots.iter().filter(|robot| robot.objects_before <= object).count();
        (0..self.world.objects.len()).map(|object| (object + behind(object) + 1) as u32).collect()
    }
}
