use super::parameters::NavigatorParameters;
use crate::geometry::Point;
use crate::io::{Error, ErrorKind, Result};
use crate::world::{BitGrid, Clearance, GridCell, World};

/// The known world in cells, and what has been seen that it lacks.
///
/// There are several *levels* of clearance, the largest first. At each a cell is free if the robot touches nothing wherever
/// in the cell its middle is, with the clearance beside it: so the disc that a straight way through free cells sweeps is
/// free as well. What has been seen counts as a point in the middle of its cell, and may be nearer by half of a diagonal.
#[derive(Debug, Clone)]
pub(super) struct Chart {
    clearance: Clearance,
    levels: [Level; LEVELS],
    /// How often each cell has been seen to hold something unknown.
    evidence: Vec<u8>,
    marks: Vec<GridCell>,
}

/// A clearance, and what it asks of the middle of a cell.
#[derive(Debug, Clone, Copy)]
struct Level {
    clearance: f64,
    room: f64,
}

/// How many clearances there are.
pub(super) const LEVELS: usize = 3;
/// The most cells.
const MAX_CELLS: f64 = 4e6;
/// The farthest, in metres, that what is seen may be from something known and still be that.
pub(super) const MAX_STRAY: f64 = 0.2;
/// So often something must have been seen in a cell.
const ENOUGH: u8 = 3;

impl Chart {
    pub(super) fn new(world: &World, parameters: &NavigatorParameters) -> Result<Self> {
        let size = world.site().size();
        let resolution = parameters.resolution.max((size.x * size.y / MAX_CELLS).sqrt());
        let inexact = resolution * std::f64::consts::FRAC_1_SQRT_2;
        let (wished, least) = (parameters.clearance, parameters.least_clearance);
        let levels = std::array::from_fn(|level| {
            let clearance = wished + (least - wished) * level as f64 / (LEVELS - 1) as f64;
            Level { clearance, room: parameters.radius() + clearance + inexact }
        });
        let limit = levels[0].room.max(MAX_STRAY) + resolution;
        let clearance = Clearance::new(world, resolution, limit).map_err(|error| {
            Error::new(ErrorKind::InvalidInput, format!("the world cannot be planned in: {error}"))
        })?;
        let evidence = vec![0; clearance.raster().cells()];
        Ok(Self { clearance, levels, evidence, marks: Vec::new() })
    }

    /// Metres along an edge of a cell.
    pub(super) fn resolution(&self) -> f64 {
        self.clearance.raster().resolution()
    }

    /// The free space beside the outline at a level.
    pub(super) fn clearance(&self, level: usize) -> f64 {
        self.levels[level].clearance
    }

    /// The cell that holds a point.
    pub(super) fn cell(&self, point: Point) -> Option<GridCell> {
        let raster = self.clearance.raster();
        raster.cell_at(point).map(|cell| GridCell::new(cell % raster.columns(), cell / raster.columns()))
    }

    /// The middle of a cell.
    pub(super) fn centre(&self, cell: GridCell) -> Point {
        self.clearance.raster().centre(self.index(cell))
    }

    /// A point in cells.
    pub(super) fn in_cells(&self, point: Point) -> Point {
        let first = self.clearance.raster().centre(0);
        Point::from((point - first) / self.resolution() + crate::geometry::Vector::new(0.5, 0.5))
    }

    /// The free cells at a level.
    pub(super) fn grid(&self, level: usize) -> BitGrid {
        let raster = self.clearance.raster();
        let room = self.levels[level].room;
        let free = |column, row| self.clearance.at(row * raster.columns() + column) >= room;
        let mut grid = BitGrid::from_fn(raster.columns(), raster.rows(), free)
            .unwrap_or_else(|_| unreachable!("fewer cells than a grid may have"));
        for &mark in &self.marks {
            self.around(mark, level, |cell| grid.set_free(cell, false));
        }
        grid
    }

    /// Whether the robot could stand at a point, by the known world and the least clearance.
    pub(super) fn has_room(&self, point: Point, radius: f64) -> bool {
        let least = self.levels[LEVELS - 1].clearance;
        self.clearance.at_point(point).is_some_and(|distance| distance >= radius + least)
    }

    /// Whether a point lies in the known world, and not in what stands there.
    pub(super) fn is_open(&self, point: Point) -> bool {
        self.clearance.at_point(point).is_some_and(|distance| distance > self.resolution())
    }

    /// Calls `blocked` for all cells that a marked cell blocks at a level.
    pub(super) fn around(&self, mark: GridCell, level: usize, mut blocked: impl FnMut(GridCell)) {
        let raster = self.clearance.raster();
        let reach = self.levels[level].room / self.resolution();
        let whole = reach.floor() as usize;
        let rows = mark.row.saturating_sub(whole)..(mark.row + whole + 1).min(raster.rows());
        for row in rows {
            let columns = mark.column.saturating_sub(whole)..(mark.column + whole + 1).min(raster.columns());
            for column in columns {
                let (x, y) = (column.abs_diff(mark.column) as f64, row.abs_diff(mark.row) as f64);
                if x * x + y * y < reach * reach {
                    blocked(GridCell::new(column, row));
                }
            }
        }
    }

    /// Takes down that something is at a point. Returns its cell if that is news: it is farther than `stray` metres from
    /// what the known world has there, and it has been seen often enough.
    pub(super) fn note(&mut self, point: Point, stray: f64) -> Option<GridCell> {
        let known = self.clearance.at_point(point)? <= stray.min(MAX_STRAY);
        if known { None } else { self.count(point, 1) }
    }

    /// Takes down that something is at a point, beyond doubt and whatever the known world has there.
    pub(super) fn insist(&mut self, point: Point) -> Option<GridCell> {
        self.count(point, ENOUGH)
    }

    fn count(&mut self, point: Point, weight: u8) -> Option<GridCell> {
        let cell = self.cell(point)?;
        let index = self.index(cell);
        let before = self.evidence[index];
        self.evidence[index] = before.saturating_add(weight);
        let is_news = before < ENOUGH && self.evidence[index] >= ENOUGH;
        if is_news {
            self.marks.push(cell);
        }
        is_news.then_some(cell)
    }

    /// Forgets all that has been seen. Returns whether that was anything.
    pub(super) fn forget(&mut self) -> bool {
        self.evidence.fill(0);
        let any = !self.marks.is_empty();
        self.marks.clear();
        any
    }

    /// The middles of the cells that hold what the known world lacks.
    pub(super) fn seen(&self) -> impl Iterator<Item = Point> + '_ {
        self.marks.iter().map(|&cell| self.centre(cell))
    }

    fn index(&self, cell: GridCell) -> usize {
        cell.row * self.clearance.raster().columns() + cell.column
    }
}
