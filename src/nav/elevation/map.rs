use std::collections::VecDeque;

use super::climber::Climber;
use crate::ParameterError;
use crate::geometry::{Point, Point3, Vector, math};
use crate::nav::grid::GridComponents;
use crate::parameter::require;
use crate::world::{BitGrid, Clearance, GridCell, HeightField, World};

/// A map of where a robot can stand on a surface. The samples of the surface are the cells of a grid; a cell
/// is free if the robot can stand there.
///
/// A cell is occupied if the plane through the ground under the robot is too steep, if a step under the robot
/// is too high, if the robot would reach beyond the surface, if it lies below a
/// [lowest elevation](Self::above), or if [walls](Self::clear_of) are too near.
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
    /// Elevation below which ground is closed.
    lowest: i64,
    /// Radius of the robot (m).
    radius: f64,
    /// The samples at which the robot touches no wall or object, if there are any of these.
    clear: Option<BitGrid>,
}

/// Running sums over a window: of heights, of their moments along the rows, of heights times their place on
/// the axis on which the window moves, and of steps that are too high. Surfaces of 1000 km need all
/// the digits.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    height: i128,
    along: i128,
    weighted: i128,
    steps: i128,
}

impl Sums {
    /// Adds what is at a place of the axis, or subtracts it (`sign` 1 or -1).
    fn add(&mut self, place: usize, what: &Self, sign: i128) {
        self.height += sign * what.height;
        self.along += sign * what.along;
        self.weighted += sign * place as i128 * what.height;
        self.steps += sign * what.steps;
    }
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

    /// The same map with all ground below an elevation closed (m), such as a water level. Fails for NaN.
    ///
    /// ```
    /// # use roverlab::geometry::{Aabb, Point};
    /// # use roverlab::nav::elevation::{Climber, ElevationMap};
    /// # use roverlab::world::HeightField;
    /// // A ridge of 0.2 m along y = 1 m, and another one along y = 3 m.
    /// let area = Aabb::new(Point::origin(), Point::new(4.0, 4.0));
    /// let ridges = HeightField::from_fn(81, 81, area, |at| 0.2 * (1.5 * at.y).sin().abs())?;
    /// let map = ElevationMap::new(&ridges, &Climber { slope: 0.3, step: 0.02, radius: 0.15 })?;
    /// let water = map.clone().above(0.1)?;
    /// let is_open = |map: &ElevationMap, y| map.open().is_free(map.cell_at(Point::new(1.0, y)).unwrap());
    /// assert!(is_open(&map, 2.1) && !is_open(&water, 2.1) && is_open(&water, 1.0) && is_open(&water, 3.0));
    /// # Ok::<(), roverlab::ParameterError>(())
    /// ```
    pub fn above(mut self, lowest: f64) -> Result<Self, ParameterError> {
        require("lowest elevation", lowest, !lowest.is_nan(), "a number")?;
        self.footing.lowest = micrometres(lowest);
        self.close(Footing::is_under);
        Ok(self)
    }

    /// The same map with all ground closed on which the robot would touch a wall or an object of a world.
    /// Fails if the samples are too far apart or too many to measure that.
    ///
    /// ```
    /// # use roverlab::geometry::{Aabb, Point};
    /// # use roverlab::nav::elevation::{Climber, ElevationMap};
    /// # use roverlab::world::{HeightField, Wall, World};
    /// // A slope that rises along x, with a wall across it at x = 2 m.
    /// let area = Aabb::new(Point::origin(), Point::new(4.0, 4.0));
    /// let slope = HeightField::from_fn(81, 81, area, |at| 0.1 * at.x)?;
    /// let wall = Wall::new(Point::new(2.0, 0.0), Point::new(2.0, 4.0));
    /// let world = World { walls: vec![wall], ..World::empty(4.0, 4.0) };
    /// let map = ElevationMap::new(&slope, &Climber { slope: 0.3, step: 0.02, radius: 0.15 })?;
    /// let top = |map: &ElevationMap| map.highest_reachable(Point::new(1.0, 1.0)).unwrap().x;
    /// assert!(top(&map) > 3.8);
    /// assert!(top(&map.clear_of(&world)?) < 1.85);
    /// # Ok::<(), roverlab::ParameterError>(())
    /// ```
    pub fn clear_of(mut self, world: &World) -> Result<Self, ParameterError> {
        if world.walls.is_empty() && world.objects.is_empty() && world.map.is_none() {
            return Ok(self);
        }
        let pitch = self.field.pitch().max();
        let area = self.field.area().inflated(0.5 * pitch);
        let radius = self.footing.radius;
        let clearance = Clearance::over(world, area, pitch, radius)?;
        let is_clear = |cell: GridCell| {
            let place = self.place(Point::new(cell.column as f64, cell.row as f64));
            clearance.at_point(place).is_none_or(|distance| distance >= radius)
        };
        let mut clear = self.open.clone();
        for row in 0..clear.height() {
            for column in 0..clear.width() {
                let cell = GridCell::new(column, row);
                clear.set_free(cell, is_clear(cell));
            }
        }
        self.footing.clear = Some(clear);
        self.close(Footing::is_obstructed);
        Ok(self)
    }

    /// Closes open cells by a rule.
    fn close(&mut self, is_closed: impl Fn(&Footing, GridCell) -> bool) {
        let open: Vec<GridCell> = self.open.free_cells().collect();
        for cell in open {
            self.open.set_free(cell, !is_closed(&self.footing, cell));
        }
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
        Self {
            columns,
            rows,
            heights,
            reach,
            moment,
            steepest: slope * slope,
            step,
            lowest: i64::MIN,
            radius: climber.radius,
            clear: None,
        }
    }

    /// All samples at once, by running sums along rows and then along columns.
    fn open(&self) -> BitGrid {
        let [reach_x, reach_y] = self.reach;
        let (columns, rows) = (self.columns, self.rows);
        let mut open = BitGrid::blocked(columns, rows).expect("a surface is no larger than a grid may be");
        if columns <= 2 * reach_x || rows <= 2 * reach_y {
            return open;
        }
        let mut lines: VecDeque<Vec<Sums>> = VecDeque::new();
        let mut windows = vec![Sums::default(); columns];
        for last in 0..rows {
            let line = self.line(last);
            for (window, sums) in windows.iter_mut().zip(&line) {
                window.add(last, sums, 1);
            }
            lines.push_back(line);
            let Some(first) = last.checked_sub(2 * reach_y) else { continue };
            let row = first + reach_y;
            let inner = windows.iter().enumerate().take(columns - reach_x).skip(reach_x);
            for (column, &Sums { height, along, weighted, steps }) in inner {
                let across = weighted - row as i128 * height;
                open.set_free(GridCell::new(column, row), steps == 0 && self.is_gentle(along, across));
            }
            let gone = lines.pop_front().expect("the lines of the window");
            for (window, sums) in windows.iter_mut().zip(&gone) {
                window.add(first, sums, -1);
            }
        }
        open
    }

    /// Sums over the part of each window that lies in a row.
    fn line(&self, row: usize) -> Vec<Sums> {
        let reach = self.reach[0];
        let heights = &self.heights[row * self.columns..][..self.columns];
        let sample = |column: usize| Sums {
            height: heights[column].into(),
            steps: i128::from(self.is_step(GridCell::new(column, row))),
            ..Sums::default()
        };
        let mut line = vec![Sums::default(); self.columns];
        let mut window = Sums::default();
        for last in 0..self.columns {
            window.add(last, &sample(last), 1);
            let Some(first) = last.checked_sub(2 * reach) else { continue };
            let column = first + reach;
            let along = window.weighted - column as i128 * window.height;
            line[column] = Sums { along, weighted: 0, ..window };
            window.add(first, &sample(first), -1);
        }
        line
    }

    /// One sample by itself.
    fn is_open(&self, cell: GridCell) -> bool {
        let [reach_x, reach_y] = self.reach;
        let inside = |at: usize, reach: usize, count: usize| at >= reach && at + reach < count;
        let is_inside = inside(cell.column, reach_x, self.columns) && inside(cell.row, reach_y, self.rows);
        if !is_inside || self.is_under(cell) || self.is_obstructed(cell) {
            return false;
        }
        let (mut along, mut across) = (0, 0);
        for (y, row) in (-(reach_y as i128)..).zip(cell.row - reach_y..=cell.row + reach_y) {
            for (x, column) in (-(reach_x as i128)..).zip(cell.column - reach_x..=cell.column + reach_x) {
                if self.is_step(GridCell::new(column, row)) {
                    return false;
                }
                let height = i128::from(self.heights[row * self.columns + column]);
                (along, across) = (along + x * height, across + y * height);
            }
        }
        self.is_gentle(along, across)
    }

    /// Whether a sample lies below the lowest elevation.
    fn is_under(&self, cell: GridCell) -> bool {
        self.heights[cell.row * self.columns + cell.column] < self.lowest
    }

    fn is_obstructed(&self, cell: GridCell) -> bool {
        self.clear.as_ref().is_some_and(|clear| !clear.is_free(cell))
    }

    fn is_gentle(&self, along: i128, across: i128) -> bool {
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
