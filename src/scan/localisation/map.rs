use super::surfaces::Surfaces;
use crate::geometry::{Aabb, Point, Pose};
use crate::io::{Error, ErrorKind, LidarScan, Result};
use crate::world::space::{Scanner, Solid, Space};
use crate::world::{Clearance, World};

/// A world as a lidar sees it: what localisation knows.
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
    clearance: Clearance,
    surfaces: Surfaces,
    /// Nothing but the map that tells on which side of walls it is solid.
    blocks: World,
}

/// Metres along an edge of the cells in which places are looked up, at the least and at the most, and about how many there are
/// in between.
const RESOLUTION: (f64, f64) = (0.02, 0.05);
const CELLS: f64 = 2e6;
/// Metres from walls up to which places may have to be free.
const CLEARANCE: f64 = 0.3;

impl LocalisationMap {
    /// The map of a world with its walls and objects. Fails for a world that is too large.
    pub fn new(world: &World) -> Result<Self> {
        let mut space = Space::new(&world.walls);
        for object in &world.objects {
            space.add(Solid::from(object));
        }
        // The inside of what is solid has no surface.
        let hollow = World { map: None, ..world.clone() };
        let (finest, coarsest) = RESOLUTION;
        let size = world.site().size();
        let resolution = (size.x * size.y / CELLS).sqrt().clamp(finest, coarsest);
        let clearance = Clearance::new(&hollow, resolution, CLEARANCE).map_err(|error| {
            Error::new(ErrorKind::InvalidInput, format!("the world cannot be mapped: {error}"))
        })?;
        let surfaces = Surfaces::new(&clearance);
        let blocks = World { map: world.map.clone(), ..World::empty(0.0, 0.0) };
        Ok(Self { space, bounds: world.site(), clearance, surfaces, blocks })
    }

    /// Whether a disc about a place touches nothing, to within 40 mm. Radii beyond 0.3 m count as that.
    pub fn is_free(&self, place: Point, radius: f64) -> bool {
        let far = self.clearance.at_point(place);
        let least = radius.min(CLEARANCE - 1e-6)
            - std::f64::consts::FRAC_1_SQRT_2 * self.clearance.raster().resolution();
        far.is_some_and(|distance| distance > least) && !self.blocks.is_inside_walls(place)
    }

    /// The box around the world.
    pub(super) fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Distances to surfaces.
    pub(super) fn surfaces(&self) -> &Surfaces {
        &self.surfaces
    }

    /// The scan that is to be expected from a scanner's pose.
    pub(super) fn expect(&self, scanner: &mut Scanner, pose: &Pose, ranges: &mut [f64]) {
        self.space.scan(scanner, pose, None, ranges);
    }
}

/// The height above the floor of a scanner that does not tell. What objects are lower is not in the map then, either.
pub(crate) const HEIGHT: f64 = 0.04;

/// A scanner with the beams of a scan.
pub(super) fn scanner_of(scan: &LidarScan) -> Scanner {
    Scanner::new(scan.angle_min, scan.angle_increment, scan.ranges.len(), HEIGHT, 0.0, scan.range_max)
}
