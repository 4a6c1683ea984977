use std::sync::{Mutex, PoisonError};

use numpy::{PyArray2, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use roverlab::nav::grid::{
    self, AnyAngle, DistanceField, GridPath, GridPlanner, GridSearch, JumpPointSearch, LazyThetaStar,
    PreparedJumps, StepCosts,
};
use roverlab::world::{BitGrid, GridCell};

use crate::arrays::{self, Natural};
use crate::errors::{Failure, Outcome};

/// A path through a grid.
///
/// Attributes
/// ----------
/// points : ndarray of float64, shape (points, 2)
///     Rows and columns from start to goal; the centre of cell (r, c) is (r + 0.5, c + 0.5).
/// cost : float
///     Length, or sum of the costs of the steps (cells).
/// expanded, generated : int
///     Numbers of nodes that the search has expanded and put on its queue.
#[pyclass(frozen, module = "roverlab.nav")]
#[derive(Debug)]
pub(crate) struct Path {
    #[pyo3(get)]
    points: Py<PyArray2<f64>>,
    #[pyo3(get)]
    cost: f64,
    #[pyo3(get)]
    expanded: usize,
    #[pyo3(get)]
    generated: usize,
}

impl Path {
    fn of(py: Python<'_>, path: &GridPath) -> Outcome<Self> {
        let points = path.points.iter().flat_map(|point| [point.y, point.x]).collect();
        let points = arrays::matrix(py, points, [path.points.len(), 2])?.unbind();
        let grid::SearchStatistics { expanded, generated } = path.statistics;
        Ok(Self { points, cost: path.cost, expanded, generated })
    }
}

#[pymethods]
impl Path {
    fn __len__(&self, py: Python<'_>) -> usize {
        self.points.bind(py).shape()[0]
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        format!("<Path: {} points, cost {}>", self.__len__(py), self.cost)
    }
}

/// Costs of entering and leaving cells.
#[derive(Debug)]
struct CellCosts {
    width: usize,
    values: Vec<f64>,
}

impl StepCosts for CellCosts {
    fn cost(&self, from: GridCell, to: GridCell) -> f64 {
        let of = |cell: GridCell| self.values[cell.row * self.width + cell.column];
        let diagonal = from.column != to.column && from.row != to.row;
        let length = if diagonal { std::f64::consts::SQRT_2 } else { 1.0 };
        0.5 * length * (of(from) + of(to))
    }
}

/// A map of free cells, with costs if the array has them.
struct Map {
    free: BitGrid,
    costs: Option<CellCosts>,
}

impl Map {
    fn of(object: &Bound<'_, PyAny>) -> Outcome<Self> {
        if let Ok(free) = object.extract::<PyReadonlyArray2<'_, bool>>() {
            return Ok(Self { free: bits(&free)?, costs: None });
        }
        Self::of_costs(&arrays::readable("grid", object, "an array of bool or float64 of two dimensions")?)
    }

    fn of_costs(costs: &PyReadonlyArray2<'_, f64>) -> Outcome<Self> {
        let (height, width) = (costs.shape()[0], costs.shape()[1]);
        // Views may stand for far more cells than there is memory: no copy before this.
        drop(BitGrid::blocked(width, height)?);
        let values: Vec<f64> = costs.as_array().iter().copied().collect();
        if let Some(value) =
            values.iter().find(|value| !(1.0..=7000.0).contains(*value) && !value.is_infinite())
        {
            return Err(Failure::value("cost of a cell", value, "1 to 7000, or inf for a blocked cell"));
        }
        if values.contains(&f64::NEG_INFINITY) {
            return Err(Failure::value("cost of a cell", "-inf", "1 to 7000, or inf for a blocked cell"));
        }
        let free = BitGrid::from_fn(width, height, |column, row| values[row * width + column].is_finite())?;
        Ok(Self { free, costs: Some(CellCosts { width, values }) })
    }
}

/// Free cells of an argument that should be a boolean array.
fn free_cells(object: &Bound<'_, PyAny>) -> Outcome<BitGrid> {
    bits(&arrays::readable("free", object, "an array of bool of two dimensions")?)
}

/// Free cells of a boolean array.
fn bits(free: &PyReadonlyArray2<'_, bool>) -> Outcome<BitGrid> {
    let array = free.as_array();
    let (height, width) = array.dim();
    let mut cells = array.iter();
    Ok(BitGrid::from_fn(width, height, |_, _| cells.next().is_some_and(|free| *free))?)
}

/// A boolean array of free cells.
fn array<'py>(py: Python<'py>, grid: &BitGrid) -> Outcome<Bound<'py, PyArray2<bool>>> {
    let (width, height) = (grid.width(), grid.height());
    let cells =
        (0..height).flat_map(|row| (0..width).map(move |column| grid.is_free(GridCell::new(column, row))));
    arrays::matrix(py, cells.collect(), [height, width])
}

/// The cell of a row and a column.
fn cell(name: &str, [row, column]: [Natural; 2]) -> Outcome<GridCell> {
    match (row.number(), column.number()) {
        (Some(row), Some(column)) => Ok(GridCell::new(column as usize, row as usize)),
        _ => Err(Failure::value(name, format!("({row}, {column})"), "a row and a column of at least 0")),
    }
}

/// Methods of planning on cells without costs.
const METHODS: &str = "dijkstra, astar, jps, prepared_jps, lazy_theta or any_angle";

/// A planner of paths on a grid, for many queries.
///
/// Parameters
/// ----------
/// grid : ndarray of bool or float64, shape (rows, columns)
///     True for free cells; or the cost of each cell, 1 to 7000, and inf for blocked ones. A step between two
///     cells costs its length times the mean of both. The array is copied, whatever its strides.
/// method : str
///     ``dijkstra`` or ``astar``: shortest from cell to cell, also by costs. ``jps`` and ``prepared_jps``:
///     the same by jump points, for free cells only. ``lazy_theta``: short, in any direction; ``any_angle``:
///     the shortest of all, in any direction.
///
/// Raises
/// ------
/// TypeError
///     If the array is not two-dimensional, or of another type.
/// ValueError
///     If a cost is out of range, or the method is unknown or does not plan by costs.
#[pyclass(frozen, module = "roverlab.nav")]
pub(crate) struct Planner {
    search: Mutex<Box<dyn GridPlanner + Send>>,
    shape: (usize, usize),
    method: String,
}

fn planner_of(map: Map, method: &str) -> Outcome<Box<dyn GridPlanner + Send>> {
    let grid = &map.free;
    Ok(match (method, map.costs) {
        ("dijkstra", Some(costs)) => Box::new(GridSearch::dijkstra_by(grid, costs)),
        ("astar", Some(costs)) => Box::new(GridSearch::astar_by(grid, costs)),
        (_, Some(_)) => {
            let expected = "dijkstra or astar, which plan by costs";
            return Err(Failure::value("method", format!("{method:?}"), expected));
        }
        ("dijkstra", None) => Box::new(GridSearch::dijkstra(grid)),
        ("astar", None) => Box::new(GridSearch::astar(grid)),
        ("jps", None) => Box::new(JumpPointSearch::new(grid)),
        ("prepared_jps", None) => Box::new(PreparedJumps::new(grid)),
        ("lazy_theta", None) => Box::new(LazyThetaStar::new(grid)),
        ("any_angle", None) => Box::new(AnyAngle::new(grid)),
        _ => return Err(Failure::value("method", format!("{method:?}"), METHODS)),
    })
}

#[pymethods]
impl Planner {
    #[new]
    #[pyo3(signature = (grid, method = "astar"))]
    fn new(py: Python<'_>, grid: &Bound<'_, PyAny>, method: &str) -> Outcome<Self> {
        let map = Map::of(grid)?;
        let shape = (map.free.height(), map.free.width());
        let planner = py.detach(|| planner_of(map, method))?;
        Ok(Self { search: Mutex::new(planner), shape, method: method.into() })
    }

    /// Finds a path.
    ///
    /// Parameters
    /// ----------
    /// start, goal : sequence of int
    ///     Row and column.
    ///
    /// Raises
    /// ------
    /// NoPathError
    ///     If no path leads from the start to the goal.
    /// ValueError
    ///     If one of them is outside the grid or blocked.
    fn plan(&self, py: Python<'_>, start: [Natural; 2], goal: [Natural; 2]) -> Outcome<Path> {
        let (start, goal) = (cell("start", start)?, cell("goal", goal)?);
        let mut planner = self.search.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        let planner = &mut *planner;
        let path = py.detach(|| planner.plan(start, goal))?;
        Path::of(py, &path)
    }

    /// Rows and columns of the grid.
    #[getter]
    fn shape(&self) -> (usize, usize) {
        self.shape
    }

    /// Method of planning.
    #[getter]
    fn method(&self) -> &str {
        &self.method
    }

    fn __repr__(&self) -> String {
        format!("<Planner: {} on {} x {} cells>", self.method, self.shape.0, self.shape.1)
    }
}

/// D* Lite: repairs its plan while the map changes.
///
/// Parameters
/// ----------
/// free : ndarray of bool, shape (rows, columns)
///     True for free cells.
/// robot, goal : sequence of int
///     Row and column. The goal may be blocked now and become free later.
#[pyclass(frozen, module = "roverlab.nav")]
#[derive(Debug)]
pub(crate) struct DStarLite {
    planner: Mutex<grid::DStarLite>,
}

#[pymethods]
impl DStarLite {
    #[new]
    fn new(free: &Bound<'_, PyAny>, robot: [Natural; 2], goal: [Natural; 2]) -> Outcome<Self> {
        let planner = grid::DStarLite::new(&free_cells(free)?, cell("robot", robot)?, cell("goal", goal)?)?;
        Ok(Self { planner: Mutex::new(planner) })
    }

    /// Sets the robot's cell: row and column.
    fn move_to(&self, py: Python<'_>, robot: [Natural; 2]) -> Outcome<()> {
        let mut planner = self.planner.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        Ok(planner.move_to(cell("robot", robot)?)?)
    }

    /// Makes a cell, row and column, free or blocked. Cells outside the map are ignored.
    fn set_free(&self, py: Python<'_>, cell: [Natural; 2], free: bool) -> Outcome<()> {
        let mut planner = self.planner.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        planner.set_free(self::cell("cell", cell)?, free);
        Ok(())
    }

    /// The shortest path from the robot to the goal on the map as it is known.
    ///
    /// Raises
    /// ------
    /// NoPathError
    ///     If no path leads to the goal.
    /// ValueError
    ///     If the robot's cell or the goal is blocked.
    fn plan(&self, py: Python<'_>) -> Outcome<Path> {
        let mut planner = self.planner.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        let planner = &mut *planner;
        let path = py.detach(|| planner.plan())?;
        Path::of(py, &path)
    }
}

/// Distance of each cell's centre from the nearest edge of a blocked cell or of the map, exact.
///
/// Parameters
/// ----------
/// free : ndarray of bool, shape (rows, columns)
///     True for free cells.
///
/// Returns
/// -------
/// ndarray of float64, shape (rows, columns)
///     Distances (cells); 0 at blocked cells.
#[pyfunction]
pub(crate) fn distance_field<'py>(
    py: Python<'py>,
    free: &Bound<'py, PyAny>,
) -> Outcome<Bound<'py, PyArray2<f64>>> {
    let grid = free_cells(free)?;
    let (width, height) = (grid.width(), grid.height());
    let distances = py.detach(|| {
        let field = DistanceField::new(&grid);
        let cells = (0..height).flat_map(|row| (0..width).map(move |column| GridCell::new(column, row)));
        cells.map(|cell| field.at(cell)).collect()
    });
    arrays::matrix(py, distances, [height, width])
}

/// The cells where a disc has room at the centre; it may touch blocked cells and the map's edge.
///
/// Parameters
/// ----------
/// free : ndarray of bool, shape (rows, columns)
///     True for free cells.
/// radius : float
///     Radius of the disc (cells).
#[pyfunction]
pub(crate) fn inflate<'py>(
    py: Python<'py>,
    free: &Bound<'py, PyAny>,
    radius: f64,
) -> Outcome<Bound<'py, PyArray2<bool>>> {
    if !(radius >= 0.0 && radius.is_finite()) {
        return Err(Failure::value("radius", radius, "a finite number of at least 0"));
    }
    let grid = free_cells(free)?;
    let grown = py.detach(|| DistanceField::new(&grid).grid(radius));
    array(py, &grown)
}
