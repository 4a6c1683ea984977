use std::collections::BTreeSet;

use super::parameters::NavigatorParameters;
use crate::ParameterError;
use crate::geometry::{Aabb, Point};
use crate::io::{Error, ErrorKind, Result};
use crate::world::{BitGrid, Clearance, GridCell, World};

/// A raster of the known world and of newly seen obstacles.
///
/// There are several *levels* of clearance, the largest first. At each level a cell is free if the robot,
/// with its centre anywhere in the cell, keeps the clearance. So the disc swept by a straight way through
/// free cells is free as well. A seen point counts as the centre of its cell, and may be nearer by half of a
/// diagonal.
#[derive(Debug, Clone)]
pub(super) struct Chart {
    clearance: Clearance,
    levels: [Level; LEVELS],
    /// Number of times an unknown obstacle was seen in each cell.
    evidence: Vec<u8>,
    marks: Vec<GridCell>,
    /// Whether the cells are larger than wished, and whether places that the robot may reach lie beyond them.
    is_coarse: bool,
    is_part: bool,
}

/// A clearance, and the distance it requires at the centre of a cell.
#[derive(Debug, Clone, Copy)]
struct Level {
    clearance: f64,
    room: f64,
}

/// Number of clearances.
pub(super) const LEVELS: usize = 3;
/// Maximum number of cells.
const MAX_CELLS: f64 = 4e6;
/// Ratio of the sizes of cells in which the robot's own rooms, or a way in a large world, are looked for.
pub(super) const COARSER: f64 = 4.0;
/// Maximum distance between a detection and the known obstacle that it is attributed to (m).
pub(super) const MAX_STRAY: f64 = 0.2;
/// Number of detections after which a cell counts as occupied.
const ENOUGH: u8 = 3;

/// Clearance of a level (m).
fn clearance_at(parameters: &NavigatorParameters, level: usize) -> f64 {
    let (wished, least) = (parameters.clearance, parameters.least_clearance);
    wished + (least - wished) * level as f64 / (LEVELS - 1) as f64
}

/// Maximum distance of a place from the centre of its cell (m).
fn inexact(resolution: f64) -> f64 {
    resolution * std::f64::consts::FRAC_1_SQRT_2
}

/// Distance up to which clearances are needed (m).
fn limit(parameters: &NavigatorParameters, resolution: f64) -> f64 {
    let room = parameters.radius() + clearance_at(parameters, 0) + inexact(resolution);
    room.max(MAX_STRAY) + resolution
}

/// Whether cells are small enough to tell where the robot has room.
fn tells_rooms(parameters: &NavigatorParameters, resolution: f64) -> bool {
    inexact(resolution) < parameters.radius()
}

/// Cell size for a box: the finest one with which the box has few enough cells (m).
fn resolution_of(bounds: &Aabb, finest: f64) -> f64 {
    let size = bounds.size();
    finest.max((size.x * size.y / MAX_CELLS).sqrt())
}

/// Where a robot may be on the way from a start to a goal: the world's site, or all of the world and what
/// lies between if one of them is elsewhere.
fn whole_around(world: &World, ends: [Point; 2]) -> Aabb {
    let site = world.site();
    let is_in_site = ends.iter().all(|end| site.contains(*end));
    let both = Aabb::new(ends[0].inf(&ends[1]), ends[0].sup(&ends[1]));
    if is_in_site { site } else { world.bounds().union(&both) }
}

/// Bounding box of all places that a robot may reach from a start, as far as cells can tell. Cells for the
/// whole of a large world have no room for a robot; so rooms of its own are looked for first, around it.
fn within_reach(
    world: &World,
    [start, goal]: [Point; 2],
    parameters: &NavigatorParameters,
    finest: f64,
) -> std::result::Result<Aabb, ParameterError> {
    let whole = whole_around(world, [start, goal]);
    let coarsest = resolution_of(&whole, finest);
    let mut resolution = finest;
    while COARSER * resolution <= coarsest && tells_rooms(parameters, resolution) && whole.contains(start) {
        let far = limit(parameters, resolution);
        let window = window(&whole.inflated(far), start, resolution);
        let clearance = Clearance::over(world, window, resolution, far)?;
        let (places, _) = reached(&clearance, &[start], start, parameters);
        let places = places.map(|places| places.inflated(far + resolution));
        if let Some(places) = places.filter(|places| is_within(places, &window, &whole)) {
            return Ok(places);
        }
        resolution *= COARSER;
    }
    let far = limit(parameters, coarsest);
    let margin = far + 2.0 * coarsest;
    let clearance = Clearance::over(world, whole.inflated(margin), coarsest, far)?;
    let (places, _) = reached(&clearance, &[start], start, parameters);
    Ok(places.map_or(whole, |places| places.inflated(far + coarsest)))
}

/// The part of a box around a point that has as many cells as a chart may have.
fn window(whole: &Aabb, around: Point, resolution: f64) -> Aabb {
    let half = 0.5 * MAX_CELLS.sqrt() * resolution;
    let window = Aabb::new(around, around).inflated(half);
    Aabb { min: window.min.sup(&whole.min), max: window.max.inf(&whole.max) }
}

/// Whether a box ends inside a window, or where the whole ends.
fn is_within(places: &Aabb, window: &Aabb, whole: &Aabb) -> bool {
    [0, 1].into_iter().all(|axis| {
        let low = window.min[axis] <= whole.min[axis] || places.min[axis] > window.min[axis];
        low && (window.max[axis] >= whole.max[axis] || places.max[axis] < window.max[axis])
    })
}

/// Bounding box of the centres of all cells that a robot may reach from one of some places, `None` if they
/// are in none, and whether another place is among them.
fn reached(
    clearance: &Clearance,
    from: &[Point],
    to: Point,
    parameters: &NavigatorParameters,
) -> (Option<Aabb>, bool) {
    let raster = clearance.raster();
    // The robot may start closer to something than it plans to be.
    let least = parameters.radius() - inexact(raster.resolution());
    let regions = raster.regions(|cell| clearance.at(cell) > least);
    let region = |place: &Point| raster.cell_at(*place).and_then(|cell| regions[cell]);
    let own: BTreeSet<u32> = from.iter().filter_map(region).collect();
    let cells = (0..raster.cells()).filter(|&cell| regions[cell].is_some_and(|region| own.contains(&region)));
    let is_among = region(&to).is_some_and(|region| own.contains(&region));
    (Aabb::around(cells.map(|cell| raster.centre(cell))), is_among)
}

/// Whether walls enclose some places near each other, as far as cells can tell, without another place among
/// what they enclose. In a large world, the same is looked for around these places alone.
pub(super) fn are_shut_in(
    world: &World,
    places: &[Point],
    from: Point,
    parameters: &NavigatorParameters,
) -> Result<bool> {
    let Some(&first) = places.first() else { return Ok(false) };
    let whole = whole_around(world, [from, first]);
    let mut resolution = parameters.resolution;
    while tells_rooms(parameters, resolution) && whole.contains(first) {
        let far = limit(parameters, resolution);
        let window = window(&whole.inflated(far), first, resolution);
        let clearance = Clearance::over(world, window, resolution, far).map_err(|error| refused(&error))?;
        let (enclosed, is_among) = reached(&clearance, places, from, parameters);
        if enclosed.is_some_and(|enclosed| is_within(&enclosed.inflated(far + resolution), &window, &whole)) {
            return Ok(!is_among);
        }
        resolution *= COARSER;
    }
    Ok(false)
}

pub(super) fn refused(error: &ParameterError) -> Error {
    Error::new(ErrorKind::InvalidInput, format!("the world cannot be planned in: {error}"))
}

impl Chart {
    /// The chart of what a robot can reach from a start on its way to a goal, in cells of `finest` metres or
    /// as small as the maximum number of cells allows.
    pub(super) fn new(
        world: &World,
        ends: [Point; 2],
        parameters: &NavigatorParameters,
        finest: f64,
    ) -> Result<Self> {
        let whole = whole_around(world, ends);
        let resolution = resolution_of(&whole, finest);
        let clearance = if resolution > finest || whole != world.site() {
            // A world may be large because of what lies far from the robot's own rooms.
            let part = within_reach(world, ends, parameters, finest).map_err(|error| refused(&error))?;
            let resolution = resolution_of(&part, finest);
            Clearance::over(world, part, resolution, limit(parameters, resolution))
        } else {
            Clearance::new(world, resolution, limit(parameters, resolution))
        };
        Ok(Self::of(clearance.map_err(|error| refused(&error))?, parameters, false))
    }

    /// The chart of as much of the world around start and goal as cells of `resolution` metres cover. `None`
    /// if they do not cover both.
    pub(super) fn between(
        world: &World,
        ends: [Point; 2],
        parameters: &NavigatorParameters,
        resolution: f64,
    ) -> Result<Option<Self>> {
        let far = limit(parameters, resolution);
        let ([start, goal], whole) = (ends, whole_around(world, ends));
        let window = window(&whole.inflated(far), start + 0.5 * (goal - start), resolution);
        if !(window.contains(start) && window.contains(goal)) {
            return Ok(None);
        }
        let clearance = Clearance::over(world, window, resolution, far).map_err(|error| refused(&error))?;
        Ok(Some(Self::of(clearance, parameters, true)))
    }

    fn of(clearance: Clearance, parameters: &NavigatorParameters, is_part: bool) -> Self {
        let resolution = clearance.raster().resolution();
        let levels = std::array::from_fn(|level| {
            let clearance = clearance_at(parameters, level);
            Level { clearance, room: parameters.radius() + clearance + inexact(resolution) }
        });
        let evidence = vec![0; clearance.raster().cells()];
        let is_coarse = resolution > parameters.resolution;
        Self { clearance, levels, evidence, marks: Vec::new(), is_coarse, is_part }
    }

    /// Whether the cells may close a way that exists between two points, to within a distance of the second
    /// one.
    pub(super) fn may_hide_a_way(&self, robot: Point, goal: Point, tolerance: f64) -> bool {
        let raster = self.clearance.raster();
        let inexact = inexact(self.resolution());
        let regions = raster.regions(|cell| self.may_have_room(cell));
        let own = raster.cell_at(robot).and_then(|cell| regions[cell]);
        let is_near = |cell: usize| (raster.centre(cell) - goal).norm() <= tolerance + inexact;
        own.is_some() && (0..raster.cells()).any(|cell| regions[cell] == own && is_near(cell))
    }

    /// Whether the cells are larger than wished.
    pub(super) fn is_coarse(&self) -> bool {
        self.is_coarse
    }

    /// Whether places that the robot may reach lie beyond it.
    pub(super) fn is_part(&self) -> bool {
        self.is_part
    }

    /// Whether the cells are larger than wished, and too large to tell where the robot has room.
    pub(super) fn is_blind(&self, parameters: &NavigatorParameters) -> bool {
        self.is_coarse && !tells_rooms(parameters, self.resolution())
    }

    /// Cell size (m).
    pub(super) fn resolution(&self) -> f64 {
        self.clearance.raster().resolution()
    }

    /// Free space beside the outline at a level (m).
    pub(super) fn clearance(&self, level: usize) -> f64 {
        self.levels[level].clearance
    }

    /// The cell that contains a point.
    pub(super) fn cell(&self, point: Point) -> Option<GridCell> {
        let raster = self.clearance.raster();
        raster.cell_at(point).map(|cell| GridCell::new(cell % raster.columns(), cell / raster.columns()))
    }

    /// Centre of a cell.
    pub(super) fn centre(&self, cell: GridCell) -> Point {
        self.clearance.raster().centre(self.index(cell))
    }

    /// A point in units of cells.
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

    /// Whether a robot at a point has room beside all seen obstacles, as far as cells can tell.
    pub(super) fn is_clear_of_seen(&self, point: Point, parameters: &NavigatorParameters) -> bool {
        let room = parameters.room() - inexact(self.resolution());
        self.seen().all(|obstacle| (obstacle - point).norm() >= room)
    }

    /// Whether the known world may leave a robot in a cell room, with the least clearance.
    pub(super) fn may_have_room(&self, cell: usize) -> bool {
        self.clearance.at(cell) >= self.levels[LEVELS - 1].room - 2.0 * inexact(self.resolution())
    }

    /// Whether the known world may leave a robot room all the way from a place to another one, if it has room
    /// at the first one; otherwise, as much as there.
    pub(super) fn is_straight_way(&self, from: Point, to: Point) -> bool {
        let own = self.clearance.at_point(from).unwrap_or(0.0);
        let room = own.min(self.levels[LEVELS - 1].room) - 2.0 * inexact(self.resolution());
        let has_room = |cell| self.clearance.at(self.index(cell)) >= room;
        is_line_of(self.in_cells(from), self.in_cells(to), has_room)
    }

    /// Regions of free cells with ways between them, by the index of the cell.
    pub(super) fn regions(&self, grid: &BitGrid) -> Vec<Option<u32>> {
        let columns = self.clearance.raster().columns();
        self.clearance.raster().regions(|cell| grid.is_free(GridCell::new(cell % columns, cell / columns)))
    }

    /// Whether a point is in the known world's free space.
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

    /// Records an obstacle at a point. Returns its cell if it is new: farther than `stray` metres from known
    /// obstacles, and seen often enough.
    pub(super) fn note(&mut self, point: Point, stray: f64) -> Option<GridCell> {
        let known = self.clearance.at_point(point)? <= stray.min(MAX_STRAY);
        if known { None } else { self.count(point, 1) }
    }

    /// Records an obstacle at a point as certain, whatever the known world shows.
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

    /// Forgets all seen obstacles. Returns whether there were any.
    pub(super) fn forget(&mut self) -> bool {
        self.evidence.fill(0);
        let any = !self.marks.is_empty();
        self.marks.clear();
        any
    }

    /// Centres of the cells with obstacles that the known world lacks.
    pub(super) fn seen(&self) -> impl Iterator<Item = Point> + '_ {
        self.marks.iter().map(|&cell| self.centre(cell))
    }

    /// Index of a cell in what is told of all cells.
    pub(super) fn index(&self, cell: GridCell) -> usize {
        cell.row * self.clearance.raster().columns() + cell.column
    }
}

/// Whether all cells met by a line, given in units of cells, are of a kind.
pub(super) fn is_line_of(a: Point, b: Point, is_of_it: impl Fn(GridCell) -> bool) -> bool {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    // Row by row: the columns between the line's entry and its exit.
    let (low, high) = (a.y.min(b.y).floor(), a.y.max(b.y).floor());
    let mut row = low;
    while row <= high {
        let at = |y: f64| if dy == 0.0 { a.x } else { a.x + dx * ((y - a.y) / dy).clamp(0.0, 1.0) };
        let (from, to) = if dy == 0.0 { (a.x, b.x) } else { (at(row), at(row + 1.0)) };
        let (from, to) = (from.min(to), from.max(to));
        let mut column = (from - 1e-9).floor();
        while column <= (to + 1e-9).floor() {
            if column < 0.0 || row < 0.0 || !is_of_it(GridCell::new(column as usize, row as usize)) {
                return false;
            }
            column += 1.0;
        }
        row += 1.0;
    }
    true
}
