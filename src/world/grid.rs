use crate::ParameterError;
use std::sync::Arc;

use crate::geometry::{Aabb, Point, Pose, Segment};
use crate::world::{Wall, World};

/// State of a cell of an occupancy grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Occupancy {
    /// Nothing.
    Free,
    /// An obstacle.
    Occupied,
    /// Unknown, or neither free nor occupied for certain.
    Unknown,
}

/// A map of square cells with an occupancy in percent: the `OccupancyGrid` of ROS.
///
/// Columns run along the grid's x axis and rows along its y axis, both from 0 at the lower left cell.
///
/// ```
/// use roverlab::geometry::{Point, Pose};
/// use roverlab::world::{Occupancy, OccupancyGrid};
/// let mut grid = OccupancyGrid::unknown(4, 3, 0.1, Pose::default())?;
/// grid.set(2, 1, Occupancy::Occupied);
/// assert_eq!(grid.cell_at(Point::new(0.25, 0.15)), Some((2, 1)));
/// assert_eq!((grid.count(Occupancy::Occupied), grid.count_unknown()), (1, 11));
/// assert_eq!(grid.to_walls().len(), 4, "an occupied cell has four walls");
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct OccupancyGrid {
    width: usize,
    height: usize,
    resolution: f64,
    origin: Pose,
    /// Rows from the lowest; -1 is unknown.
    values: Vec<i8>,
}

impl OccupancyGrid {
    /// Largest number of cells.
    pub const MAX_CELLS: usize = 1 << 25;

    /// A grid of `width` by `height` unknown cells of `resolution` metres, with the lower left corner of the
    /// lower left cell at `origin`.
    pub fn unknown(
        width: usize,
        height: usize,
        resolution: f64,
        origin: Pose,
    ) -> Result<Self, ParameterError> {
        let cells = width.saturating_mul(height);
        let error = |parameter: &'static str, value, expected: &'static str| {
            Err(ParameterError::new(parameter, value, expected))
        };
        if cells > Self::MAX_CELLS {
            return error("number of cells", cells as f64, "at most 33554432");
        }
        if !(resolution > 0.0 && resolution.is_finite()) {
            return error("resolution", resolution, "a positive, finite number of metres");
        }
        if let Some(value) = [origin.x, origin.y, origin.heading].into_iter().find(|v| !v.is_finite()) {
            return error("origin", value, "finite numbers");
        }
        Ok(Self { width, height, resolution, origin, values: vec![-1; cells] })
    }

    /// Number of cells along the grid's x axis.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of cells along the grid's y axis.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Cell size (m).
    pub fn resolution(&self) -> f64 {
        self.resolution
    }

    /// Pose in the world of the lower left corner of the lower left cell.
    pub fn origin(&self) -> Pose {
        self.origin
    }

    /// State of a cell: 0 % is free, 100 % is occupied, everything else is unknown, also outside the grid.
    pub fn cell(&self, column: usize, row: usize) -> Occupancy {
        match self.occupancy(column, row) {
            Some(0) => Occupancy::Free,
            Some(100) => Occupancy::Occupied,
            _ => Occupancy::Unknown,
        }
    }

    /// Occupancy of a cell in percent, 0 to 100; `None` if unknown or outside.
    pub fn occupancy(&self, column: usize, row: usize) -> Option<u8> {
        self.index(column, row).and_then(|index| u8::try_from(self.values[index]).ok())
    }

    /// Sets the percentage of a cell. More than 100 means unknown; no effect outside the grid.
    pub fn set_occupancy(&mut self, column: usize, row: usize, percent: Option<u8>) {
        if let Some(index) = self.index(column, row) {
            self.values[index] = percent.filter(|&p| p <= 100).map_or(-1, |p| p as i8);
        }
    }

    /// Sets the state of a cell; no effect outside the grid.
    pub fn set(&mut self, column: usize, row: usize, cell: Occupancy) {
        let percent = match cell {
            Occupancy::Free => Some(0),
            Occupancy::Occupied => Some(100),
            Occupancy::Unknown => None,
        };
        self.set_occupancy(column, row, percent);
    }

    /// Number of cells in a state.
    pub fn count(&self, cell: Occupancy) -> usize {
        let value = match cell {
            Occupancy::Free => 0,
            Occupancy::Occupied => 100,
            Occupancy::Unknown => {
                return self.values.len() - self.count(Occupancy::Free) - self.count(Occupancy::Occupied);
            }
        };
        self.values.iter().filter(|&&v| v == value).count()
    }

    /// Number of cells without a percentage.
    pub fn count_unknown(&self) -> usize {
        self.values.iter().filter(|&&v| v < 0).count()
    }

    /// Column and row of the cell that contains a point of the world.
    pub fn cell_at(&self, point: Point) -> Option<(usize, usize)> {
        let local = self.origin.to_local(point);
        let (column, row) = ((local.x / self.resolution).floor(), (local.y / self.resolution).floor());
        let inside = column >= 0.0 && row >= 0.0 && column < self.width as f64 && row < self.height as f64;
        inside.then_some((column as usize, row as usize))
    }

    /// Centre of a cell in the world.
    pub fn centre(&self, column: usize, row: usize) -> Point {
        self.place(column as f64 + 0.5, row as f64 + 0.5)
    }

    /// Bounding box of the grid along the world's axes.
    pub fn bounds(&self) -> Aabb {
        let (w, h) = (self.width as f64, self.height as f64);
        let corners = [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)].map(|(x, y)| self.place(x, y));
        Aabb::around(corners).unwrap_or_else(|| Aabb::new(self.origin.position(), self.origin.position()))
    }

    /// Outlines of the occupied cells as walls of zero thickness. Collinear edges are joined, so a straight
    /// wall of the map is one wall of the world.
    pub fn to_walls(&self) -> Vec<Wall> {
        let mut walls = Vec::new();
        self.for_each_outline(|line| walls.push(Wall { thickness: 0.0, ..Wall::new(line.a, line.b) }));
        walls
    }

    /// A world with the outlines of the occupied cells as walls and a floor of the grid's size; it keeps the
    /// grid as its map.
    pub fn to_world(&self) -> World {
        let mut world = World::empty(0.0, 0.0);
        world.floor = self.bounds();
        world.walls = self.to_walls();
        world.map = Some(Arc::new(self.clone()));
        world
    }

    /// Number of walls of [`OccupancyGrid::to_walls`].
    pub fn count_walls(&self) -> usize {
        let mut count = 0;
        self.for_each_outline(|_| count += 1);
        count
    }

    fn for_each_outline(&self, mut found: impl FnMut(Segment)) {
        // A grid without rows may still have billions of columns.
        if self.values.is_empty() {
            return;
        }
        for row in 0..=self.height {
            let edge = |column| self.is_occupied(column, row) != self.is_occupied_below(column, row);
            for_each_run(self.width, edge, |a, b| found(self.segment((a, row), (b, row))));
        }
        for column in 0..=self.width {
            let edge =
                |row| self.is_occupied(column, row) != (column > 0 && self.is_occupied(column - 1, row));
            for_each_run(self.height, edge, |a, b| found(self.segment((column, a), (column, b))));
        }
    }

    fn is_occupied(&self, column: usize, row: usize) -> bool {
        self.index(column, row).is_some_and(|index| self.values[index] == 100)
    }

    fn is_occupied_below(&self, column: usize, row: usize) -> bool {
        row > 0 && self.is_occupied(column, row - 1)
    }

    fn segment(&self, a: (usize, usize), b: (usize, usize)) -> Segment {
        Segment::new(self.place(a.0 as f64, a.1 as f64), self.place(b.0 as f64, b.1 as f64))
    }

    /// World position of a point in cell units.
    fn place(&self, x: f64, y: f64) -> Point {
        self.origin.to_world(Point::new(x * self.resolution, y * self.resolution))
    }

    fn index(&self, column: usize, row: usize) -> Option<usize> {
        (column < self.width && row < self.height).then(|| row * self.width + column)
    }
}

/// Calls `found(first, end)` for each maximal interval of `0..count` where `holds`.
fn for_each_run(count: usize, holds: impl Fn(usize) -> bool, mut found: impl FnMut(usize, usize)) {
    let mut start = None;
    for i in 0..=count {
        match (start, i < count && holds(i)) {
            (None, true) => start = Some(i),
            (Some(first), false) => {
                found(first, i);
                start = None;
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn grid(rows: &[&str], origin: Pose) -> OccupancyGrid {
        let mut grid = OccupancyGrid::unknown(rows[0].len(), rows.len(), 0.5, origin).unwrap();
        for (row, text) in rows.iter().rev().enumerate() {
            for (column, c) in text.chars().enumerate() {
                let cell = match c {
                    '#' => Occupancy::Occupied,
                    '.' => Occupancy::Free,
                    _ => Occupancy::Unknown,
                };
                grid.set(column, row, cell);
            }
        }
        grid
    }

    #[test]
    fn a_block_has_four_walls() {
        let grid = grid(&["....", ".##.", ".##.", "...."], Pose::new(1.0, 2.0, 0.0));
        let walls = grid.to_walls();
        assert_eq!(walls.len(), 4);
        assert!(walls.iter().all(|w| w.thickness == 0.0 && w.line.length() == 1.0));
        let bounds = Aabb::around(walls.iter().flat_map(|w| [w.line.a, w.line.b])).unwrap();
        assert_eq!(bounds, Aabb::new(Point::new(1.5, 2.5), Point::new(2.5, 3.5)));
    }

    #[test]
    fn the_border_counts_as_an_outline_and_unknown_as_open() {
        assert_eq!(grid(&["#"], Pose::default()).count_walls(), 4);
        assert_eq!(grid(&["?"], Pose::default()).count_walls(), 0);
        assert_eq!(grid(&["#?#"], Pose::default()).count_walls(), 8);
        assert_eq!(OccupancyGrid::unknown(usize::MAX, 0, 1.0, Pose::default()).unwrap().count_walls(), 0);
    }

    #[test]
    fn a_turned_grid_turns_its_walls() {
        let turned = grid(&["##"], Pose::new(0.0, 0.0, std::f64::consts::FRAC_PI_2));
        assert!((turned.centre(1, 0) - Point::new(-0.25, 0.75)).norm() < 1e-12);
        assert_eq!(turned.cell_at(Point::new(-0.25, 0.75)), Some((1, 0)));
        assert_eq!(turned.cell_at(Point::new(0.25, 0.75)), None);
        let b = turned.bounds();
        assert!(
            (b.min - Point::new(-0.5, 0.0)).norm() < 1e-12 && (b.max - Point::new(0.0, 1.0)).norm() < 1e-12
        );
    }

    #[test]
    fn absurd_grids_are_refused() {
        let error = OccupancyGrid::unknown(usize::MAX, 2, 1.0, Pose::default()).unwrap_err();
        assert!(error.to_string().contains("number of cells"));
        assert!(OccupancyGrid::unknown(2, 2, f64::NAN, Pose::default()).is_err());
        assert!(OccupancyGrid::unknown(2, 2, 1.0, Pose::new(f64::INFINITY, 0.0, 0.0)).is_err());
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        /// Outlines separate occupied cells from others: the walls' total length is that of all such edges.
        #[test]
        fn outlines_are_as_long_as_the_edges_between_cells(
            cells in proptest::collection::vec(any::<bool>(), 24), heading in -3.0..3.0f64
        ) {
            let mut grid = OccupancyGrid::unknown(6, 4, 0.5, Pose::new(3.0, -1.0, heading)).unwrap();
            for (i, &occupied) in cells.iter().enumerate() {
                grid.set(i % 6, i / 6, if occupied { Occupancy::Occupied } else { Occupancy::Free });
            }
            let at = |x: i32, y: i32| {
                (0..6).contains(&x) && (0..4).contains(&y) && cells[(y * 6 + x) as usize]
            };
            let edges = (0..=4).flat_map(|y| (0..=6).map(move |x| (x, y)))
                .map(|(x, y)| i32::from(at(x, y) != at(x - 1, y)) + i32::from(at(x, y) != at(x, y - 1)))
                .sum::<i32>();
            let length: f64 = grid.to_walls().iter().map(|wall| wall.line.length()).sum();
            prop_assert!((length - 0.5 * f64::from(edges)).abs() < 1e-9);
            prop_assert_eq!(grid.to_walls().len(), grid.count_walls());
        }

        #[test]
        fn the_centre_of_a_cell_lies_in_it(column in 0..6usize, row in 0..4usize, heading in -3.0..3.0f64) {
            let grid = OccupancyGrid::unknown(6, 4, 0.05, Pose::new(3.0, -1.0, heading)).unwrap();
            prop_assert_eq!(grid.cell_at(grid.centre(column, row)), Some((column, row)));
        }
    }
}
