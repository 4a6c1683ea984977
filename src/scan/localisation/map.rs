use super::surfaces::Surfaces;
use crate::geometry::{Aabb, Point, Pose};
use crate::io::{Error, ErrorKind, LidarScan, Result};
use crate::parameter::require_not_negative;
use crate::world::space::{Scanner, Solid, Space};
use crate::world::{Clearance, World};

/// The world as a lidar sees it: the map for localisation.
///
/// ```
/// use roverlab::geometry::Point;
/// use roverlab::scan::LocalisationMap;
/// use roverlab::world::World;
/// let map = LocalisationMap::new(&World::walled(2.0, 2.0))?;
/// assert!(map.is_free(Point::new(1.0, 1.0), 0.2));
/// assert!(!map.is_free(Point::new(0.1, 1.0), 0.2), "a wall is in the way");
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct LocalisationMap {
    space: Space,
    bounds: Aabb,
    /// Whether a robot may leave these.
    is_open: bool,
    clearance: Clearance,
    surfaces: Surfaces,
    /// Height of the lidar above the floor (m).
    height: f64,
    /// A world with only the occupancy map, which tells on which side of surfaces it is solid.
    blocks: World,
}

/// Minimum and maximum cell size of the clearance map (m).
const RESOLUTION: (f64, f64) = (0.02, 0.05);
/// Radius of the smallest robot that may leave the map through a gap (m).
const NARROW: f64 = 0.05;
/// Approximate number of cells of the clearance map.
const CELLS: f64 = 2e6;
/// Maximum clearance that can be queried (m).
const CLEARANCE: f64 = 0.3;

impl LocalisationMap {
    /// The map of a world's walls and objects for a lidar 40 mm above the floor, as most robots have it.
    ///
    /// # Errors
    ///
    /// If the world is too large.
    pub fn new(world: &World) -> Result<Self> {
        Self::at_height(world, HEIGHT)
    }

    /// The map for a level lidar at a height above the floor (m): it passes over lower walls and objects.
    ///
    /// ```
    /// use roverlab::geometry::Point;
    /// use roverlab::scan::LocalisationMap;
    /// use roverlab::world::{Wall, World};
    /// let mut world = World::walled(2.0, 2.0);
    /// world.walls.push(Wall { height: 0.1, ..Wall::new(Point::new(1.0, 0.0), Point::new(1.0, 1.0)) });
    /// let map = LocalisationMap::at_height(&world, 0.15)?;
    /// assert!(!map.is_free(Point::new(1.0, 0.5), 0.05), "the robot does not pass over it");
    /// # Ok::<(), roverlab::io::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the world is too large, or the height is negative or not finite.
    pub fn at_height(world: &World, height: f64) -> Result<Self> {
        require_not_negative("height of the lidar", height)?;
        let mut space = Space::new(&world.walls);
        for object in &world.objects {
            space.add(Solid::from(object));
        }
        // The inside of solid areas has no surface.
        let hollow = World { map: None, ..world.clone() };
        let (finest, coarsest) = RESOLUTION;
        let size = world.site().size();
        let resolution = (size.x * size.y / CELLS).sqrt().clamp(finest, coarsest);
        let clearance = Clearance::new(&hollow, resolution, CLEARANCE).map_err(|error| refused(&error))?;
        let seen = seen_at(&hollow, height);
        let surfaces = if seen == hollow {
            Surfaces::new(&clearance)
        } else {
            // Where nothing is seen, a robot may be all the same.
            let seen = Clearance::new(&World { floor: hollow.site(), ..seen }, resolution, CLEARANCE);
            Surfaces::new(&seen.map_err(|error| refused(&error))?)
        };
        let blocks = World { map: world.map.clone(), ..World::empty(0.0, 0.0) };
        let mut map =
            Self { space, bounds: world.site(), is_open: false, clearance, surfaces, height, blocks };
        map.is_open = map.edge().any(|place| map.is_free(place, NARROW));
        Ok(map)
    }

    /// Places around the bounds, a cell from each other.
    fn edge(&self) -> impl Iterator<Item = Point> + use<> {
        let (Aabb { min, max }, step) = (self.bounds, self.clearance.raster().resolution());
        let along = move |length: f64| (0..=(length / step) as usize).map(move |index| index as f64 * step);
        let across = along(max.x - min.x).flat_map(move |x| [min.y, max.y].map(|y| Point::new(min.x + x, y)));
        across.chain(along(max.y - min.y).flat_map(move |y| [min.x, max.x].map(|x| Point::new(x, min.y + y))))
    }

    /// Whether a disc touches nothing, to within 40 mm. Radii above 0.3 m count as 0.3 m. Beyond the map,
    /// there is nothing.
    pub fn is_free(&self, place: Point, radius: f64) -> bool {
        let far = self.clearance.at_point(place);
        let least = radius.min(CLEARANCE - 1e-6)
            - std::f64::consts::FRAC_1_SQRT_2 * self.clearance.raster().resolution();
        far.is_none_or(|distance| distance > least) && !self.blocks.is_inside_walls(place)
    }

    /// Bounding box of the places where a robot may be that started in the world and has driven some way (m).
    pub(super) fn within_reach(&self, driven: f64) -> Aabb {
        self.bounds.inflated(if self.is_open { driven } else { 0.0 })
    }

    /// Distances to surfaces.
    pub(super) fn surfaces(&self) -> &Surfaces {
        &self.surfaces
    }

    /// A scanner with the beams of a scan, each followed by further ones, so that there are `finer` times as
    /// many.
    pub(super) fn scanner(&self, scan: &LidarScan, finer: usize) -> Scanner {
        let (beams, spacing) = (finer * scan.ranges.len(), scan.angle_increment / finer as f64);
        Scanner::new(scan.angle_min, spacing, beams, self.height, 0.0, scan.range_max)
    }

    /// The expected scan at a scanner's pose.
    pub(super) fn expect(&self, scanner: &mut Scanner, pose: &Pose, ranges: &mut [f64]) {
        self.space.scan(scanner, pose, None, ranges);
    }
}

/// Usual height of a lidar above the floor (m).
pub(crate) const HEIGHT: f64 = 0.04;

fn refused(error: &crate::ParameterError) -> Error {
    Error::new(ErrorKind::InvalidInput, format!("the world cannot be mapped: {error}"))
}

/// What a level lidar sees at a height.
fn seen_at(world: &World, height: f64) -> World {
    let mut seen = world.clone();
    seen.walls.retain(|wall| wall.height >= height);
    seen.objects.retain(|object| {
        let solid = Solid::from(object);
        solid.mast.is_some() || (solid.bottom..=solid.top).contains(&height)
    });
    seen
}
