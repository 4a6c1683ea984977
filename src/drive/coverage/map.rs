use crate::ParameterError;
use crate::geometry::{Aabb, Point, Segment};
use crate::io::{Error, ErrorKind, Result};
use crate::parameter::{require, require_positive, require_up_to};
use crate::world::{Clearance, Raster, World};

/// Parameters of a [`CoverageMap`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoverageMapParameters {
    /// Radius of the robot (m). It covers the floor beneath it.
    pub radius: f64,
    /// Clearance kept from everything (m).
    pub margin: f64,
    /// Overlap of neighbouring lanes (m).
    pub overlap: f64,
    /// Cell size of the map (m).
    pub resolution: f64,
}

impl Default for CoverageMapParameters {
    /// An S4.
    fn default() -> Self {
        Self { radius: 0.06, margin: 0.015, overlap: 0.01, resolution: 0.01 }
    }
}

impl CoverageMapParameters {
    /// Checks every parameter; the error names the one out of range.
    pub fn validate(&self) -> std::result::Result<(), ParameterError> {
        require_up_to("radius", self.radius, 1000.0)?;
        require_up_to("margin", self.margin, 1000.0)?;
        require_positive("resolution", self.resolution)?;
        let good = self.resolution <= 0.5 * self.radius;
        require("resolution", self.resolution, good, "at most half of the robot's radius")?;
        let good = (0.0..self.radius).contains(&self.overlap);
        require("overlap", self.overlap, good, "0 to the robot's radius")
    }
}

/// The floor that a robot can cover, and the part already covered.
///
/// Coverable floor is everything beneath the robot at any place reachable from its start with the clearance
/// kept.
///
/// ```
/// use roverlab::drive::{CoverageMap, CoverageMapParameters, CoveragePlan};
/// use roverlab::geometry::Point;
/// use roverlab::world::World;
/// let start = Point::new(0.4, 0.4);
/// let mut map = CoverageMap::new(&World::walled(2.0, 1.5), start, CoverageMapParameters::default())?;
/// let plan = CoveragePlan::new(&map, start)?;
/// for leg in plan.points().windows(2) {
///     map.cover_line(leg[0], leg[1], 0.0);
/// }
/// assert!(map.share() > 0.97, "a robot that drives the plan covers the floor");
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct CoverageMap {
    raster: Raster,
    /// Cells that the robot's centre may occupy.
    pub(super) places: Vec<bool>,
    floor: Vec<bool>,
    covered: Vec<bool>,
    parameters: CoverageMapParameters,
    /// Number of floor cells, and of covered ones.
    cells: usize,
    done: usize,
    /// Number of uncovered floor cells in each square of [`TILE`] cells; finished tiles are skipped.
    tiles: Vec<u32>,
}

/// Number of cells along an edge of a tile.
const TILE: usize = 16;
/// Offsets in columns and rows of the cells that share an edge with one.
const BESIDE: [(i64, i64); 4] = [(-1, 0), (1, 0), (0, -1), (0, 1)];

impl CoverageMap {
    /// The map of a world for a robot at a start. Fails for a start without the clearance and for a world
    /// that is too large.
    pub fn new(world: &World, start: Point, parameters: CoverageMapParameters) -> Result<Self> {
        parameters.validate()?;
        let CoverageMapParameters { radius, margin, resolution, .. } = parameters;
        let reach = radius + margin;
        let clearance = Clearance::new(world, resolution, reach + 2.0 * resolution).map_err(|error| {
            Error::new(ErrorKind::InvalidInput, format!("the world cannot be mapped: {error}"))
        })?;
        let raster = clearance.raster().clone();
        let inside = |cell: usize| world.floor.contains(raster.centre(cell));
        let regions = raster.regions(|cell| clearance.at(cell) >= reach && inside(cell));
        let home = raster.cell_at(start).and_then(|cell| regions[cell]);
        let Some(home) = home else {
            let found = format!("({}, {}) m", start.x, start.y);
            let expected = format!("a place {reach} m away from everything");
            return Err(Error::invalid_input("start", found, &expected));
        };
        let places: Vec<bool> = regions.iter().map(|&region| region == Some(home)).collect();
        let mut map = Self {
            floor: vec![false; raster.cells()],
            covered: vec![false; raster.cells()],
            raster,
            places,
            parameters,
            cells: 0,
            done: 0,
            tiles: Vec::new(),
        };
        map.find_floor();
        Ok(map)
    }

    fn find_floor(&mut self) {
        let under = self.disc(self.parameters.radius);
        for cell in (0..self.places.len()).filter(|&cell| self.places[cell]) {
            self.floor[cell] = true;
            // Steps lead from a place to a cell beneath the robot, nearer and nearer. If not all are places,
            // the cell is also beneath the robot at the last place before one that is none.
            if self.under(cell, &BESIDE).any(|beside| !self.places[beside]) {
                for floor in self.under(cell, &under) {
                    self.floor[floor] = true;
                }
            }
        }
        self.cells = self.floor.iter().filter(|&&floor| floor).count();
        self.count_tiles();
    }

    fn count_tiles(&mut self) {
        self.tiles = vec![0; self.raster.columns().div_ceil(TILE) * self.raster.rows().div_ceil(TILE)];
        for cell in (0..self.floor.len()).filter(|&cell| self.floor[cell] && !self.covered[cell]) {
            let tile = self.tile(cell);
            self.tiles[tile] += 1;
        }
    }

    fn tile(&self, cell: usize) -> usize {
        let (column, row) = (cell % self.raster.columns(), cell / self.raster.columns());
        row / TILE * self.raster.columns().div_ceil(TILE) + column / TILE
    }

    /// Whether all tiles within `reach` cells of a cell are fully covered.
    fn is_done_about(&self, cell: usize, reach: usize) -> bool {
        let (columns, rows) = (self.raster.columns(), self.raster.rows());
        let (column, row) = (cell % columns, cell / columns);
        let tiles = |middle: usize, most: usize| {
            middle.saturating_sub(reach) / TILE..=(middle + reach).min(most - 1) / TILE
        };
        tiles(row, rows).all(|row| {
            tiles(column, columns).all(|column| self.tiles[row * columns.div_ceil(TILE) + column] == 0)
        })
    }

    /// Offsets in columns and rows of the cells with centres within a radius.
    fn disc(&self, radius: f64) -> Vec<(i64, i64)> {
        let cells = radius / self.raster.resolution();
        let reach = cells.ceil() as i64;
        let within = |&(x, y): &(i64, i64)| ((x * x + y * y) as f64) <= cells * cells;
        (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| (x, y))).filter(within).collect()
    }

    fn under<'a>(&self, cell: usize, disc: &'a [(i64, i64)]) -> impl Iterator<Item = usize> + use<'a> {
        let (columns, rows) = (self.raster.columns() as i64, self.raster.rows() as i64);
        let (column, row) = (cell as i64 % columns, cell as i64 / columns);
        disc.iter().filter_map(move |&(x, y)| {
            let (x, y) = (column + x, row + y);
            ((0..columns).contains(&x) && (0..rows).contains(&y)).then_some((y * columns + x) as usize)
        })
    }

    /// Marks the floor beneath a robot at a place as covered.
    pub fn cover(&mut self, place: Point) {
        let disc = self.disc(self.parameters.radius);
        self.cover_by(place, &disc);
    }

    fn cover_by(&mut self, place: Point, disc: &[(i64, i64)]) {
        let Some(cell) = self.raster.cell_at(place) else { return };
        for under in self.under(cell, disc) {
            if self.floor[under] && !self.covered[under] {
                self.covered[under] = true;
                self.done += 1;
                let tile = self.tile(under);
                self.tiles[tile] -= 1;
            }
        }
    }

    /// Marks the floor along a line as covered by a robot with a cross-track error of up to `error` metres.
    pub fn cover_line(&mut self, from: Point, to: Point, error: f64) {
        let disc = self.disc((self.parameters.radius - error).clamp(0.0, self.parameters.radius));
        let length = (to - from).norm();
        let steps = (length / self.raster.resolution()).ceil().max(1.0);
        if !steps.is_finite() {
            return;
        }
        // Only what is in the map counts, however long the line.
        let ends = [0, self.raster.cells().saturating_sub(1)].map(|cell| self.raster.centre(cell));
        let map = Aabb::new(ends[0], ends[1]).inflated(self.raster.resolution());
        let Some([begin, end]) = map.span(&Segment::new(from, to)) else { return };
        for step in (begin * steps).floor() as usize..=(end * steps).ceil().min(steps) as usize {
            self.cover_by(from + (to - from) * (step as f64 / steps), &disc);
        }
    }

    /// Fraction of the floor covered, 0 to 1.
    pub fn share(&self) -> f64 {
        self.done as f64 / self.cells.max(1) as f64
    }

    /// Area of the coverable floor (m²).
    pub fn area(&self) -> f64 {
        self.cells as f64 * self.raster.resolution() * self.raster.resolution()
    }

    /// Raster of the map's cells.
    pub fn raster(&self) -> &Raster {
        &self.raster
    }

    /// Parameters of the map.
    pub fn parameters(&self) -> &CoverageMapParameters {
        &self.parameters
    }

    /// Whether the robot's centre may be at a place.
    pub fn is_place(&self, place: Point) -> bool {
        self.raster.cell_at(place).is_some_and(|cell| self.places[cell])
    }

    /// Centres of the floor's covered, or uncovered, cells.
    pub fn cells(&self, covered: bool) -> impl Iterator<Item = Point> + '_ {
        let wanted = move |&cell: &usize| self.floor[cell] && self.covered[cell] == covered;
        (0..self.floor.len()).filter(wanted).map(|cell| self.raster.centre(cell))
    }

    /// The same map with nothing covered.
    pub(super) fn uncovered(mut self) -> Self {
        self.covered.fill(false);
        self.done = 0;
        self.count_tiles();
        self
    }

    /// Number of uncovered cells that a robot at a cell would cover.
    pub(super) fn gain(&self, cell: usize, disc: &[(i64, i64)]) -> usize {
        let reach = (self.parameters.radius / self.raster.resolution()).ceil() as usize;
        if self.is_done_about(cell, reach) {
            return 0;
        }
        self.under(cell, disc).filter(|&under| self.floor[under] && !self.covered[under]).count()
    }

    /// The cells beneath a robot, as offsets.
    pub(super) fn robot(&self) -> Vec<(i64, i64)> {
        self.disc(0.9 * self.parameters.radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::Wall;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(16))]
        #[test]
        fn the_floor_is_what_is_beneath_the_robot_at_all_places(
            ends in [0.0..1.2f64, 0.0..0.9, 0.0..1.2, 0.0..0.9], radius in 0.02..0.2f64,
        ) {
            let mut world = World::walled(1.2, 0.9);
            world.walls.push(Wall::new(Point::new(ends[0], ends[1]), Point::new(ends[2], ends[3])));
            let parameters = CoverageMapParameters { radius, ..CoverageMapParameters::default() };
            let Ok(map) = CoverageMap::new(&world, Point::new(0.25, 0.25), parameters) else { return Ok(()) };
            let disc = map.disc(radius);
            let mut beneath = vec![false; map.floor.len()];
            for place in (0..beneath.len()).filter(|&place| map.places[place]) {
                map.under(place, &disc).for_each(|cell| beneath[cell] = true);
            }
            prop_assert!(map.floor == beneath);
        }
    }
}
