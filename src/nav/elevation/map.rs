use super::climber::Climber;
use crate::ParameterError;
use crate::geometry::{Point, Point3, Vector, math};
use crate::nav::grid::GridComponents;
use crate::world::{BitGrid, GridCell, HeightField};

/// A map of where a robot can stand on a surface. The samples of the surface are the cells of a grid; a cell
/// is free if the robot can stand there.
///
/// A cell is occupied if the plane through the ground under the robot is too steep, if a step under the robot
/// is too high, or if the robot would reach beyond the surface.
///
/// ```
/// use roverlab::geometry::{Aabb, Point};
/// use roverlab::nav::elevation::{Climber, ElevationMap};
/// use roverlab::world::HeightField;
///
/// // A gentle hill of 0.2 m, and a steep one of 0.8 m.
/// let area = Aabb::new(Point::origin(), Point::new(4.0, 4.0));
/// let hills = HeightField::from_fn(81, 81, area, |at| {
///     let hill = |x, height: f64| height * (-2.0 * (at - Point::new(x, 2.0)).norm_squared()).exp();
///     hill(1.0, 0.2) + hill(3.0, 0.8)
/// })?;
/// let map = ElevationMap::new(&hills, &Climber { slope: 0.3, step: 0.02, radius: 0.15 })?;
/// let top = map.highest_reachable(Point::new(0.5, 0.5)).expect("the robot can stand there");
/// assert!((top.xy() - Point::new(1.0, 2.0)).norm() < 0.3 && top.z < 0.25);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone)]
pub struct ElevationMap {
    field: HeightField,
    footing: Footing,
    open: BitGrid,
}

/// What of the ground counts as under the robot, in whole samples and micrometres: sums of these are the same
/// in any order.
#[derive(Debug, Clone)]
struct Footing {
    columns: usize,
    rows: usize,
    heights: Vec<i64>,
    /// Samples to each side.
    reach: [usize; 2],
    /// What the sum of moments along an axis is for a slope of 1.
    moment: [f64; 2],
    steepest: f64,
    /// The most micrometres between neighbours along an axis.
    step: [i64; 2],
}

/// Micrometres per metre.
const MICROMETRES: f64 = 1e6;

impl ElevationMap {
    /// Creates the map of a surface for a robot's limits. Fails for limits out of range.
    pub fn new(field: &HeightField, climber: &Climber) -> Result<Self, ParameterError> {
        climber.validate()?;
        let footing = Footing::new(field, climber);
        let open = footing.open();
        Ok(Self { field: field.clone(), footing, open })
    }

    /// The surface.
    pub fn field(&self) -> &HeightField {
        &self.field
    }

    /// The grid of samples, free where the robot can stand.
    pub fn open(&self) -> &BitGrid {
        &self.open
    }

    /// The sample nearest to a position; `None` outside the surface.
    pub fn cell_at(&self, place: Point) -> Option<GridCell> {
        self.field.height(place)?;
        let at = (place - self.field.area().min).component_div(&self.field.pitch());
        Some(GridCell::new(at.x.round() as usize, at.y.round() as usize))
    }

    /// Position of a sample.
    ///
    /// # Panics
    ///
    /// If there is no such sample.
    pub fn point(&self, cell: GridCell) -> Point3 {
        let at = self.place(Point::new(cell.column as f64, cell.row as f64));
        Point3::new(at.x, at.y, self.field.sample(cell.column, cell.row))
    }

    /// The highest place that the robot can reach; `None` if it cannot stand at the start.
    pub fn highest_reachable(&self, start: Point) -> Option<Point3> {
        let start = self.cell_at(start).filter(|&cell| self.open.is_free(cell))?;
        let components = GridComponents::new(&self.open);
        let reached = self.open.free_cells().filter(|&cell| components.connected(start, cell));
        reached.map(|cell| self.point(cell)).max_by(|a, b| a.z.total_cmp(&b.z))
    }

    /// The place of coordinates in samples.
    pub(super) fn place(&self, samples: Point) -> Point {
        self.field.area().min + samples.coords.component_mul(&self.field.pitch())
    }

    /// Changes a sample, and tells about those around it that open or close by that.
    pub(super) fn set_height(
        &mut self,
        cell: GridCell,
        height: f64,
        mut changed: impl FnMut(GridCell, bool),
    ) {
        self.footing.heights[cell.row * self.footing.columns + cell.column] = micrometres(height);
        let [x, y] = self.footing.reach;
        // A step to the next sample counts at the first of the two.
        let first = |at: usize, reach: usize| at.saturating_sub(reach + 1);
        let last = |at: usize, reach: usize, count: usize| (at + reach + 1).min(count - 1);
        for row in first(cell.row, y)..=last(cell.row, y, self.footing.rows) {
            for column in first(cell.column, x)..=last(cell.column, x, self.footing.columns) {
                let near = GridCell::new(column, row);
                let open = self.footing.is_open(near);
                if open != self.open.is_free(near) {
                    self.open.set_free(near, open);
                    changed(near, open);
                }
            }
        }
    }
}

fn micrometres(height: f64) -> i64 {
    (height * MICROMETRES).round() as i64
}

impl Footing {
    fn new(field: &HeightField, climber: &Climber) -> Self {
        let (columns, rows) = (field.columns(), field.rows());
        let pitch = [field.pitch().x, field.pitch().y];
        // A window wider than the surface closes all of it.
        let reach =
            pitch.map(|pitch| ((climber.radius / pitch).round() as usize).clamp(1, HeightField::MAX_SAMPLES));
        let squares = reach.map(|reach| (1..=reach).map(|i| 2.0 * (i * i) as f64).sum::<f64>());
        let width = reach.map(|reach| (2 * reach + 1) as f64);
        let slope = math::tan(climber.slope);
        let moment = [0, 1].map(|axis| MICROMETRES * pitch[axis] * squares[axis] * width[1 - axis]);
        let step = pitch.map(|pitch| micrometres(climber.step + slope * pitch));
        let sample = |index: usize| micrometres(field.sample(index % columns, index / columns));
        let heights = (0..columns * rows).map(sample).collect();
        Self { columns, rows, heights, reach, moment, steepest: slope * slope, step }
    }

    /// All samples at once, by sums along rows and then along columns.
    fn open(&self) -> BitGrid {
        let [reach_x, reach_y] = self.reach;
        let (columns, rows) = (self.columns, self.rows);
        let mut open = BitGrid::blocked(columns, rows).expect("a surface is no larger than a grid may be");
        if columns <= 2 * reach_x || rows <= 2 * reach_y {
            return open;
        }
        // Of each sample's row of the window: the sum, the moment, and how many steps are too high.
        let mut sums = vec![[0_i64; 3]; columns * rows];
        for row in 0..rows {
            let line = &self.heights[row * columns..][..columns];
            let mut steps = vec![0; columns + 1];
            for column in 0..columns {
                steps[column + 1] = steps[column] + i64::from(self.is_step(GridCell::new(column, row)));
            }
            for column in reach_x..columns - reach_x {
                let window = &line[column - reach_x..=column + reach_x];
                let sum: i64 = window.iter().sum();
                let moment: i64 = (-(reach_x as i64)..).zip(window).map(|(x, z)| x * z).sum();
                let count = steps[column + reach_x + 1] - steps[column - reach_x];
                sums[row * columns + column] = [sum, moment, count];
            }
        }
        for row in reach_y..rows - reach_y {
            for column in reach_x..columns - reach_x {
                let (mut along, mut across, mut steps) = (0, 0, 0);
                for (y, near) in (-(reach_y as i64)..).zip(row - reach_y..=row + reach_y) {
                    let [sum, moment, count] = sums[near * columns + column];
                    (along, across, steps) = (along + moment, across + y * sum, steps + count);
                }
                open.set_free(GridCell::new(column, row), steps == 0 && self.is_gentle(along, across));
            }
        }
        open
    }

    /// One sample by itself.
    fn is_open(&self, cell: GridCell) -> bool {
        let [reach_x, reach_y] = self.reach;
        let inside = |at: usize, reach: usize, count: usize| at >= reach && at + reach < count;
        if !inside(cell.column, reach_x, self.columns) || !inside(cell.row, reach_y, self.rows) {
            return false;
        }
        let (mut along, mut across) = (0, 0);
        for (y, row) in (-(reach_y as i64)..).zip(cell.row - reach_y..=cell.row + reach_y) {
            for (x, column) in (-(reach_x as i64)..).zip(cell.column - reach_x..=cell.column + reach_x) {
                if self.is_step(GridCell::new(column, row)) {
                    return false;
                }
                let height = self.heights[row * self.columns + column];
                (along, across) = (along + x * height, across + y * height);
            }
        }
        self.is_gentle(along, across)
    }

    fn is_gentle(&self, along: i64, across: i64) -> bool {
        let slope = Vector::new(along as f64 / self.moment[0], across as f64 / self.moment[1]);
        slope.norm_squared() <= self.steepest
    }

    /// Whether the step from a sample to the next one along x or y is too high.
    fn is_step(&self, cell: GridCell) -> bool {
        let index = cell.row * self.columns + cell.column;
        let rise = |next: usize| (self.heights[next] - self.heights[index]).abs();
        (cell.column + 1 < self.columns && rise(index + 1) > self.step[0])
            || (cell.row + 1 < self.rows && rise(index + self.columns) > self.step[1])
    }
}
