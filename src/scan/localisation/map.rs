use crate::geometry::{Point, Pose};
use crate::io::{Error, ErrorKind, LidarScan, Result};
use crate::world::space::{Scanner, Solid, Space};
use crate::world::{Clearance, World};

/// A world as a lidar sees it: what localisation knows.
#[derive(Debug, Clone)]
pub struct LocalisationMap {
    space: Space,
    clearance: Clearance,
}

/// Metres along an edge of the cells in which free places are looked up.
const RESOLUTION: f64 = 0.02;
/// Metres from walls up to which places may have to be free.
const CLEARANCE: f64 = 0.3;

impl LocalisationMap {
    /// The map of a world with its walls and objects. Fails for a world that is too large.
    pub fn new(world: &World) -> Result<Self> {
        let mut space = Space::new(&world.walls);
        for object in &world.objects {
            space.add(Solid::from(object));
        }
        let clearance = Clearance::new(world, RESOLUTION, CLEARANCE).map_err(|error| {
            Error::new(ErrorKind::InvalidInput, "the world cannot be mapped").with_source(error)
        })?;
        Ok(Self { space, clearance })
    }

    /// Whether a disc about a place touches nothing, to within 20 mm. Radii beyond 0.3 m count as that.
    pub fn is_free(&self, place: Point, radius: f64) -> bool {
        self.clearance
            .at_point(place)
            .is_some_and(|distance| distance > radius.min(CLEARANCE - 1e-6) - RESOLUTION)
    }

    /// The places of a square grid over the world where a disc touches nothing.
    pub(super) fn free_places(&self, spacing: f64, radius: f64) -> Vec<Point> {
        let raster = self.clearance.raster();
        let (first, last) = (raster.centre(0), raster.centre(raster.cells() - 1));
        let along = |low: f64, high: f64| ((high - low) / spacing).floor().max(0.0) as usize;
        let (columns, rows) = (along(first.x, last.x), along(first.y, last.y));
        (0..=rows)
            .flat_map(|row| (0..=columns).map(move |column| (column, row)))
            .map(|(column, row)| {
                Point::new(first.x + column as f64 * spacing, first.y + row as f64 * spacing)
            })
            .filter(|&place| self.is_free(place, radius))
            .collect()
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
