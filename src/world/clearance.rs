//! Distance from every point of the floor to the nearest solid.

use super::{BitGrid, Object, Shape, Wall, World};
use crate::ParameterError;
use crate::geometry::{Aabb, Point, Segment, Vector, direction, math};
use crate::parameter::require_positive;

/// Square cells in rows over a part of the floor. Cell indices run along x first, then along y.
///
/// ```
/// use roverlab::geometry::{Aabb, Point};
/// use roverlab::world::Raster;
/// let raster = Raster::over(Aabb::new(Point::origin(), Point::new(2.0, 1.0)), 0.5)?;
/// let cell = raster.cell_at(Point::new(0.6, 0.1)).expect("a cell");
/// assert!((raster.centre(cell) - Point::new(0.75, 0.25)).norm() < 1e-9);
/// assert_eq!(raster.cell_at(Point::new(-5.0, 0.0)), None);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Raster {
    corner: Point,
    resolution: f64,
    columns: usize,
    rows: usize,
}

impl Raster {
    /// Largest number of cells: as many as a grid may have.
    pub const MAX_CELLS: f64 = BitGrid::MAX_CELLS as f64;

    /// Cells of `resolution` metres over a box; the last column and row may extend beyond it.
    pub fn over(bounds: Aabb, resolution: f64) -> Result<Self, ParameterError> {
        require_positive("resolution", resolution)?;
        let size = bounds.size();
        if !(size.x.is_finite() && size.y.is_finite()) {
            let value = if size.x.is_finite() { size.y } else { size.x };
            return Err(ParameterError::new("extent of the world", value, "a finite number of metres"));
        }
        let cells_along = |length: f64| (length / resolution).ceil().max(1.0);
        let (columns, rows) = (cells_along(size.x), cells_along(size.y));
        if columns * rows > Self::MAX_CELLS {
            let expected =
                format!("at most {} of {resolution} m over {} x {} m", Self::MAX_CELLS, size.x, size.y);
            return Err(ParameterError::new("number of cells", columns * rows, expected));
        }
        Ok(Self { corner: bounds.min, resolution, columns: columns as usize, rows: rows as usize })
    }

    /// Size of a cell (m).
    pub fn resolution(&self) -> f64 {
        self.resolution
    }

    /// Number of cells along x.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of cells along y.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Total number of cells.
    pub fn cells(&self) -> usize {
        self.columns * self.rows
    }

    /// Centre of a cell.
    #[inline]
    pub fn centre(&self, cell: usize) -> Point {
        self.centre_of(cell % self.columns, cell / self.columns)
    }

    #[inline]
    fn centre_of(&self, column: usize, row: usize) -> Point {
        self.corner + Vector::new(column as f64 + 0.5, row as f64 + 0.5) * self.resolution
    }

    /// The cell that contains a point; `None` outside of the raster.
    pub fn cell_at(&self, point: Point) -> Option<usize> {
        let place = (point - self.corner) / self.resolution;
        let inside = |x: f64, n: usize| x >= 0.0 && x < n as f64;
        (inside(place.x, self.columns) && inside(place.y, self.rows))
            .then(|| place.y as usize * self.columns + place.x as usize)
    }

    /// Neighbours of a cell across its edges: right, left, above, below.
    #[inline]
    pub fn edge_neighbours(&self, cell: usize) -> [Option<usize>; 4] {
        if cell >= self.cells() {
            return [None; 4];
        }
        let column = cell % self.columns;
        [
            (column + 1 < self.columns).then(|| cell + 1),
            (column > 0).then(|| cell - 1),
            (cell + self.columns < self.cells()).then(|| cell + self.columns),
            cell.checked_sub(self.columns),
        ]
    }

    /// Numbers the edge-connected regions of free cells from 0, in the order of their first cells; `None` for
    /// other cells.
    pub fn regions(&self, is_free: impl Fn(usize) -> bool) -> Vec<Option<u32>> {
        let mut regions = vec![None; self.cells()];
        let mut stack = Vec::new();
        let mut region = 0;
        for seed in 0..regions.len() {
            if regions[seed].is_some() || !is_free(seed) {
                continue;
            }
            regions[seed] = Some(region);
            stack.push(seed);
            while let Some(cell) = stack.pop() {
                for next in self.edge_neighbours(cell).into_iter().flatten() {
                    if regions[next].is_none() && is_free(next) {
                        regions[next] = Some(region);
                        stack.push(next);
                    }
                }
            }
            region += 1;
        }
        regions
    }

    /// Indices between two coordinates along an axis that starts at `corner` and has `count` cells: those
    /// with centres in the interval, and at most one more on each side.
    fn span(&self, corner: f64, count: usize, low: f64, high: f64) -> std::ops::Range<usize> {
        let first = ((low - corner) / self.resolution - 0.5).floor().max(0.0);
        let last = ((high - corner) / self.resolution + 0.5).ceil().clamp(0.0, count as f64);
        first as usize..last as usize
    }
}

/// Distance from the centre of every cell to the nearest wall or object, up to a limit.
///
/// Walls are rectangles of their thickness with square ends; objects are their outlines from above, whether
/// they stand on the floor or hang above it. Distances are exact up to rounding; inside a solid they are 0.
///
/// ```
/// use roverlab::geometry::Point;
/// use roverlab::world::{Clearance, World};
/// let field = Clearance::new(&World::walled(2.0, 1.0), 0.01, 0.3)?;
/// // 200 mm from the centre line of a wall 10 mm thick, plus or minus half a cell.
/// assert!((field.at_point(Point::new(1.0, 0.2)).unwrap() - 0.195).abs() < 0.0051);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Clearance {
    raster: Raster,
    limit: f64,
    distances: Vec<f64>,
}

impl Clearance {
    /// Computes the clearance of a world. The raster covers the world's [site](World::site) and a margin of
    /// `limit` metres, so that there is a way around a world without a border.
    ///
    /// The run time is proportional to the number of cells plus the cells within the limit of each solid.
    pub fn new(world: &World, resolution: f64, limit: f64) -> Result<Self, ParameterError> {
        let site = world.site();
        // How far walls in the site reach out of it.
        let is_in = |wall: &&Wall| site.inflated(0.5 * wall.thickness).span(&wall.line).is_some();
        let thickest = world.walls.iter().filter(is_in).map(|wall| 0.5 * wall.thickness).fold(0.0, f64::max);
        Self::over(world, site.inflated(limit + thickest + 2.0 * resolution), resolution, limit)
    }

    /// The same on a raster over a part of the world; solids beyond it count as well.
    pub fn over(world: &World, bounds: Aabb, resolution: f64, limit: f64) -> Result<Self, ParameterError> {
        require_positive("clearance limit", limit)?;
        let raster = Raster::over(bounds, resolution)?;
        let distances = vec![limit; raster.cells()];
        let mut field = Self { raster, limit, distances };
        world.walls.iter().map(Solid::of_wall).for_each(|solid| field.stamp(&solid));
        world.objects.iter().map(Solid::of_object).for_each(|solid| field.stamp(&solid));
        if world.map.is_some() {
            field.fill(|place| world.is_inside_walls(place));
        }
        Ok(field)
    }

    /// The raster of cells.
    pub fn raster(&self) -> &Raster {
        &self.raster
    }

    /// Distance beyond which all points count as equally far (m).
    pub fn limit(&self) -> f64 {
        self.limit
    }

    /// Distance from a cell's centre to the nearest solid, at most the limit (m); 0 outside of the raster.
    #[inline]
    pub fn at(&self, cell: usize) -> f64 {
        self.distances.get(cell).copied().unwrap_or(0.0)
    }

    /// Clearance of the cell that contains a point, at most the limit (m); `None` outside of the raster.
    pub fn at_point(&self, point: Point) -> Option<f64> {
        self.raster.cell_at(point).map(|cell| self.at(cell))
    }

    /// Sets the distance to 0 inside solids.
    fn fill(&mut self, is_solid: impl Fn(Point) -> bool) {
        for (cell, distance) in self.distances.iter_mut().enumerate() {
            if is_solid(self.raster.centre(cell)) {
                *distance = 0.0;
            }
        }
    }

    fn stamp(&mut self, solid: &Solid) {
        let raster = &self.raster;
        let (low, high) = solid.spine_rows(self.limit);
        for row in raster.span(raster.corner.y, raster.rows, low, high) {
            let y = raster.centre_of(0, row).y;
            let Some((left, right)) = solid.columns_at(y, self.limit) else { continue };
            for column in raster.span(raster.corner.x, raster.columns, left, right) {
                let distance = solid.distance_to(raster.centre_of(column, row));
                let cell = &mut self.distances[row * raster.columns + column];
                *cell = cell.min(distance);
            }
        }
    }
}

/// Outline of a wall or object on the floor.
enum Solid {
    /// A rectangle: all points beside a spine, within half its width.
    Bar { spine: Segment, axis: Vector, half_length: f64, half_width: f64 },
    /// A disc.
    Disc { middle: Point, radius: f64 },
}

impl Solid {
    fn of_wall(wall: &Wall) -> Self {
        let along = wall.line.b - wall.line.a;
        let length = math::hypot(along.x, along.y);
        let axis = if length > 0.0 { along / length } else { Vector::new(1.0, 0.0) };
        Self::bar(wall.line, axis, length, wall.thickness)
    }

    fn of_object(object: &Object) -> Self {
        let middle = object.pose.position();
        match object.kind.shape {
            Shape::Cylinder { radius, .. } | Shape::Cone { radius, .. } | Shape::Sphere { radius } => {
                Self::Disc { middle, radius }
            }
            Shape::Box { length, width, .. } => {
                let axis = direction(object.pose.heading);
                let half = axis * (0.5 * length);
                Self::bar(Segment::new(middle - half, middle + half), axis, length, width)
            }
        }
    }

    fn bar(spine: Segment, axis: Vector, length: f64, width: f64) -> Self {
        Self::Bar { spine, axis, half_length: 0.5 * length, half_width: 0.5 * width.max(0.0) }
    }

    #[inline]
    fn distance_to(&self, point: Point) -> f64 {
        match *self {
            Self::Disc { middle, radius } => {
                let offset = point - middle;
                (math::hypot(offset.x, offset.y) - radius).max(0.0)
            }
            Self::Bar { spine, axis, half_length, half_width } => {
                let offset = point - spine.a;
                let along = ((offset.x * axis.x + offset.y * axis.y) - half_length).abs() - half_length;
                let across = (axis.x * offset.y - axis.y * offset.x).abs() - half_width;
                math::hypot(along.max(0.0), across.max(0.0))
            }
        }
    }

    /// Lowest and highest y within `limit` of the solid, or slightly beyond.
    fn spine_rows(&self, limit: f64) -> (f64, f64) {
        match *self {
            Self::Disc { middle, radius } => (middle.y - radius - limit, middle.y + radius + limit),
            Self::Bar { spine, half_width, .. } => {
                let reach = half_width + limit;
                (spine.a.y.min(spine.b.y) - reach, spine.a.y.max(spine.b.y) + reach)
            }
        }
    }

    /// The part of the spine relevant to the points of height `y` within `limit` of the solid, and its reach
    /// to both sides, or slightly more.
    fn columns_at(&self, y: f64, limit: f64) -> Option<(f64, f64)> {
        let (spine, reach) = match *self {
            Self::Disc { middle, radius } => (Segment::new(middle, middle), radius + limit),
            Self::Bar { spine, half_width, .. } => (spine, half_width + limit),
        };
        let (lower, upper) = if spine.a.y <= spine.b.y { (spine.a, spine.b) } else { (spine.b, spine.a) };
        let rise = upper.y - lower.y;
        let x_at = |height: f64| {
            if rise > 0.0 {
                lower.x + (upper.x - lower.x) * ((height - lower.y) / rise).clamp(0.0, 1.0)
            } else {
                lower.x
            }
        };
        if y + reach < lower.y || y - reach > upper.y {
            return None;
        }
        let (one, other) = if rise > 0.0 { (x_at(y - reach), x_at(y + reach)) } else { (lower.x, upper.x) };
        Some((one.min(other) - reach, one.max(other) + reach))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::geometry::Pose;
    use crate::world::{ObjectKind, Occupancy, OccupancyGrid};
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Point> {
        (0.0..1.0, 0.0..1.0).prop_map(|(x, y)| Point::new(x, y))
    }

    proptest! {
        #![proptest_config(crate::testing::cases(32))]

        #[test]
        fn every_cell_holds_the_least_distance_of_all_solids(
            ends in proptest::collection::vec((point(), point(), 0.0..0.1), 1..5),
            can in point(),
            crate_at in (point(), -3.0..3.0),
        ) {
            let mut world = World::empty(1.0, 1.0);
            for &(a, b, thickness) in &ends {
                world.walls.push(Wall { thickness, ..Wall::new(a, b) });
            }
            for (name, pose) in [("can", Pose::new(can.x, can.y, 0.0)),
                                 ("crate", Pose::new(crate_at.0.x, crate_at.0.y, crate_at.1))] {
                let kind = Arc::new(ObjectKind::predefined(name).unwrap());
                world.objects.push(Object::new(kind, pose));
            }
            let field = Clearance::new(&world, 0.03, 0.2).unwrap();
            let solids: Vec<Solid> = world.walls.iter().map(Solid::of_wall)
                .chain(world.objects.iter().map(Solid::of_object)).collect();
            for cell in 0..field.raster().cells() {
                let centre = field.raster().centre(cell);
                let least = solids.iter().map(|s| s.distance_to(centre)).fold(0.2, f64::min);
                prop_assert_eq!(field.at(cell), least);
                prop_assert_eq!(field.raster().cell_at(centre), Some(cell));
            }
        }

        #[test]
        fn a_thin_wall_is_as_far_as_its_segment(a in point(), b in point(), from in point()) {
            let wall = Wall { thickness: 0.0, ..Wall::new(a, b) };
            let distance = Solid::of_wall(&wall).distance_to(from);
            prop_assert!((distance - wall.line.distance_to(from)).abs() < 1e-9);
        }
    }

    /// The walls of a map surround its blocks. Their inside is also solid, wherever the map lies and however
    /// it is rotated.
    #[test]
    fn the_inside_of_a_block_of_a_map_is_solid() {
        let mut map = OccupancyGrid::unknown(10, 10, 0.5, Pose::new(2.0, -1.0, 0.4)).unwrap();
        for (row, column) in (2..8).flat_map(|row| (2..8).map(move |column| (row, column))) {
            map.set(column, row, Occupancy::Occupied);
        }
        let world = map.to_world();
        let field = Clearance::new(&world, 0.1, 0.2).unwrap();
        assert_eq!(field.at_point(map.centre(4, 4)), Some(0.0));
        assert_eq!(field.at_point(map.centre(0, 0)), Some(0.2));
        let hollow = World { map: None, ..world };
        assert_eq!(Clearance::new(&hollow, 0.1, 0.2).unwrap().at_point(map.centre(4, 4)), Some(0.2));
    }

    #[test]
    fn nonsense_is_refused() {
        let world = World::walled(1.0, 1.0);
        let refused = |world: &World, resolution, limit| {
            Clearance::new(world, resolution, limit).unwrap_err().name().to_string()
        };
        assert_eq!(refused(&world, 0.0, 0.1), "resolution");
        assert_eq!(refused(&world, 0.01, f64::NAN), "clearance limit");
        assert_eq!(refused(&world, 1e-6, 0.1), "number of cells");
        let mut endless = world;
        endless.walls.push(Wall::new(Point::origin(), Point::new(f64::INFINITY, 0.0)));
        assert_eq!(refused(&endless, 0.01, 0.1), "extent of the world");
    }
}
