use std::path::PathBuf;

use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use roverlab::maze::files::{self, MazeFile, MazeFormat};
use roverlab::maze::generate::{braided, competition};
use roverlab::maze::{
    self, Cell, Direction, Preference, Scale, Unknown, WallState, distances_to_goal, shortest_route,
};

use crate::arrays::{self, Natural};
use crate::errors::{Failure, NoPathError, Outcome};
use crate::scene::{Scene, Text};

/// A maze of cells with walls, a start and goals.
///
/// Cells are given as row and column, from the lower left one, (0, 0); rows count upwards. Made by `load`,
/// `parse`, `competition` or `braided`.
#[pyclass(frozen, module = "roverlab.maze")]
#[derive(Debug)]
pub(crate) struct Maze {
    model: maze::Maze,
    cell: Option<f64>,
    defects: Vec<String>,
}

/// Formats of text.
const FORMATS: [(&str, MazeFormat); 5] = [
    ("text", MazeFormat::Text),
    ("maze", MazeFormat::Maze),
    ("map", MazeFormat::Map),
    ("num", MazeFormat::Num),
    ("eyesim", MazeFormat::EyeSim),
];

/// Directions in the order of the array of walls.
const SIDES: [Direction; 4] = [Direction::North, Direction::East, Direction::South, Direction::West];

impl Maze {
    fn of(maze: maze::Maze) -> Self {
        Self { model: maze, cell: None, defects: Vec::new() }
    }

    fn read(file: MazeFile) -> Self {
        let defects = file.defects.iter().map(ToString::to_string).collect();
        Self { model: file.maze, cell: file.cell, defects }
    }
}

/// Row and column of a cell.
fn place(cell: Cell) -> (usize, usize) {
    (cell.y.into(), cell.x.into())
}

#[pymethods]
impl Maze {
    /// Reads a maze from a file of any of the common formats, which its content tells.
    ///
    /// Raises
    /// ------
    /// FileNotFoundError, FileFormatError
    ///     If there is no such file, or it holds no maze.
    #[staticmethod]
    fn load(path: PathBuf) -> Outcome<Self> {
        if !path.exists() {
            return Err(Failure::no_file(&path));
        }
        Ok(Self::read(files::load(path)?))
    }

    /// Reads a maze from a text, or from the bytes of a file, in any of the common formats.
    ///
    /// Parameters
    /// ----------
    /// text : str or bytes
    ///     The maze.
    /// name : str
    ///     Name for messages.
    #[staticmethod]
    #[pyo3(signature = (text, name = "maze"))]
    fn parse(text: Text, name: &str) -> Outcome<Self> {
        Ok(Self::read(files::parse(&text.0, name)?))
    }

    /// A random maze by the rules of micromouse competitions, with `side` cells on each side, at most 256.
    #[staticmethod]
    fn competition(side: Natural, seed: Natural) -> Outcome<Self> {
        Ok(Self::of(competition(side.index("side")?, seed.named("seed")?)?))
    }

    /// A random maze from which the share `part` of the inner walls, 0 to 1, was removed; its goal is the
    /// centre.
    ///
    /// With 0, exactly one way joins any two cells.
    #[staticmethod]
    fn braided(width: Natural, height: Natural, part: f64, seed: Natural) -> Outcome<Self> {
        if !(0.0..=1.0).contains(&part) {
            return Err(Failure::value("part", part, "0 to 1"));
        }
        let (width, height) = (width.index("width")?, height.index("height")?);
        let mut maze = braided(width, height, part, seed.named("seed")?)?;
        let centre = maze.centre();
        maze.set_goals(centre);
        Ok(Self::of(maze))
    }

    /// Numbers of steps from each cell to the nearest goal, by flood fill.
    ///
    /// Returns
    /// -------
    /// ndarray of int64, shape (rows, columns)
    ///     The steps; -1 where no way leads to a goal. Unknown walls count as walls.
    fn distances<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyArray2<i64>>> {
        let distances = py.detach(|| distances_to_goal(&self.model, Unknown::Closed));
        let steps =
            distances.as_slice().iter().map(|steps| if *steps == u32::MAX { -1 } else { i64::from(*steps) });
        arrays::matrix(py, steps.collect(), [self.model.height(), self.model.width()])
    }

    /// The best route from the start to a goal.
    ///
    /// Parameters
    /// ----------
    /// preference : str
    ///     What it has fewest of: ``steps``, ``turns``, or ``both`` in sum. Unknown walls count as walls.
    ///
    /// Raises
    /// ------
    /// NoPathError
    ///     If no way leads to a goal.
    #[pyo3(signature = (preference = "steps"))]
    fn shortest_route(&self, py: Python<'_>, preference: &str) -> Outcome<Route> {
        let preference = match preference {
            "steps" => Preference::Steps,
            "turns" => Preference::Turns,
            "both" => Preference::StepsAndTurns,
            _ => return Err(Failure::value("preference", format!("{preference:?}"), "steps, turns or both")),
        };
        let route = py.detach(|| shortest_route(&self.model, Unknown::Closed, preference));
        let route = route.ok_or_else(|| NoPathError::new_err("no way leads from the start to a goal"))?;
        Route::of(py, &route)
    }

    /// The maze as a world for the simulator, with its start; lengths in metres.
    ///
    /// Parameters
    /// ----------
    /// cell : float, optional
    ///     Size of a cell (m); otherwise that in the file, or the 0.18 m of competitions.
    #[pyo3(signature = (cell = None))]
    fn to_scene(&self, cell: Option<f64>) -> Outcome<Scene> {
        let cell = cell.or(self.cell).unwrap_or(Scale::MICROMOUSE.cell);
        if !(0.05..=100.0).contains(&cell) {
            return Err(Failure::value("cell", cell, "0.05 to 100 m"));
        }
        let grown = cell / Scale::MICROMOUSE.cell;
        let Scale { wall, height, .. } = Scale::MICROMOUSE;
        let scale = Scale { cell, wall: wall * grown, height: height * grown };
        let mut world = scale.world(&self.model);
        world.start = Some(scale.pose(self.model.start(), self.model.heading()));
        Ok(Scene::of(world))
    }

    /// The maze as a text.
    ///
    /// Parameters
    /// ----------
    /// format : str
    ///     ``text`` (posts ``o``), ``maze`` (posts ``+``), ``map``, ``num`` or ``eyesim``.
    #[pyo3(signature = (format = "text"))]
    fn to_text(&self, format: &str) -> Outcome<String> {
        let found = FORMATS.iter().find(|(name, _)| *name == format);
        let expected = FORMATS.map(|(name, _)| name).join(", ");
        let (_, format) = found.ok_or_else(|| Failure::value("format", format!("{format:?}"), &expected))?;
        Ok(files::print(&self.model, *format)?)
    }

    /// Walls: an array of shape (rows, columns, 4), True where a wall stands to the north, east, south or
    /// west.
    #[getter]
    fn walls<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyArray3<bool>>> {
        let (width, height) = (self.model.width(), self.model.height());
        let cells = (0..height).flat_map(|row| (0..width).map(move |column| (row, column)));
        let walls = cells.flat_map(|(row, column)| {
            let cell = Cell::new(column as u16, row as u16);
            SIDES.map(|side| self.model.wall(cell, side) == WallState::Present)
        });
        Ok(PyArray1::from_vec(py, walls.collect()).reshape([height, width, 4])?)
    }

    /// Numbers of rows and columns.
    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.model.height(), self.model.width())
    }

    /// Row and column of the start.
    #[getter]
    fn start(&self) -> (usize, usize) {
        place(self.model.start())
    }

    /// Rows and columns of the goals.
    #[getter]
    fn goals(&self) -> Vec<(usize, usize)> {
        self.model.goals().map(place).collect()
    }

    /// Defects of the file and of the maze, such as a gap in the outer wall or a goal that cannot be reached.
    #[getter]
    fn defects(&self) -> Vec<String> {
        self.defects.clone()
    }

    fn __str__(&self) -> Outcome<String> {
        self.to_text("text")
    }

    fn __repr__(&self) -> String {
        format!("<Maze: {} x {} cells>", self.model.height(), self.model.width())
    }
}

/// A route through a maze.
///
/// Attributes
/// ----------
/// cells : ndarray of int64, shape (steps + 1, 2)
///     Row and column of each cell.
/// steps, turns : int
///     Numbers of steps and of changes of direction.
#[pyclass(frozen, module = "roverlab.maze")]
#[derive(Debug)]
pub(crate) struct Route {
    #[pyo3(get)]
    cells: Py<PyArray2<i64>>,
    #[pyo3(get)]
    steps: usize,
    #[pyo3(get)]
    turns: usize,
}

impl Route {
    fn of(py: Python<'_>, route: &maze::Route) -> Outcome<Self> {
        let cells: Vec<i64> = route.cells().flat_map(|cell| [cell.y.into(), cell.x.into()]).collect();
        let count = cells.len() / 2;
        let cells = arrays::matrix(py, cells, [count, 2])?.unbind();
        Ok(Self { cells, steps: route.steps(), turns: route.turns() })
    }
}

#[pymethods]
impl Route {
    fn __len__(&self) -> usize {
        self.steps
    }

    fn __repr__(&self) -> String {
        format!("<Route: {} steps, {} turns>", self.steps, self.turns)
    }
}
