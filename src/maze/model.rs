use super::bits::BitGrid;
use super::{Cell, Direction};
use crate::ParameterError;
use crate::parameter::require;

/// State of a wall position.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum WallState {
    /// There is no wall.
    Absent,
    /// There is a wall.
    Present,
    /// Not yet seen.
    Unknown,
}

/// How unknown walls are treated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Unknown {
    /// As passages: an optimistic route.
    Open,
    /// As walls: a certain route.
    Closed,
}

/// A rectangle of cells with walls, a start and a goal.
///
/// Every wall, including the outer ones, is present, absent or unknown, stored as two bits; each row starts
/// at a new word. No route leaves the rectangle, even through gaps in the outer wall.
///
/// ```
/// use roverlab::maze::{Cell, Direction, Maze, WallState};
///
/// let mut maze = Maze::open(3, 2)?;
/// maze.set_wall(Cell::new(0, 0), Direction::East, WallState::Present);
/// assert_eq!(maze.wall(Cell::new(1, 0), Direction::West), WallState::Present);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Maze {
    width: u16,
    height: u16,
    /// Walls to the left of cells, and those of the right edge.
    vertical: Layer,
    /// Walls below cells, and those of the upper edge.
    horizontal: Layer,
    goals: BitGrid,
    start: Cell,
    heading: Direction,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash)]
struct Layer {
    present: BitGrid,
    /// Set for walls that are neither present nor absent.
    unknown: BitGrid,
}

impl Layer {
    fn new(columns: usize, rows: usize) -> Self {
        Self { present: BitGrid::new(columns, rows), unknown: BitGrid::new(columns, rows) }
    }

    fn get(&self, (column, row): (usize, usize)) -> WallState {
        if self.unknown.get(column, row) {
            WallState::Unknown
        } else if self.present.get(column, row) {
            WallState::Present
        } else {
            WallState::Absent
        }
    }

    /// The first 64 walls of a row that block, one bit each.
    #[inline]
    fn closed_row(&self, row: usize, unknown: Unknown) -> u64 {
        let doubtful = if unknown == Unknown::Closed { self.unknown.row(row) } else { 0 };
        self.present.row(row) | doubtful
    }

    fn set(&mut self, (column, row): (usize, usize), wall: WallState) {
        self.unknown.set(column, row, wall == WallState::Unknown);
        self.present.set(column, row, wall == WallState::Present);
    }
}

impl Maze {
    /// Maximum number of cells per row or column.
    pub const MAX_SIDE: usize = 256;

    /// A maze with outer walls whose inner walls are unknown, as a robot finds it. The start is the lower
    /// left cell, facing north, and the goal is the centre.
    ///
    /// # Errors
    ///
    /// If a side is not 1 to 256 cells.
    pub fn unexplored(width: usize, height: usize) -> Result<Self, ParameterError> {
        Self::filled(width, height, WallState::Unknown)
    }

    /// A maze with outer walls only.
    ///
    /// # Errors
    ///
    /// If a side is not 1 to 256 cells.
    pub fn open(width: usize, height: usize) -> Result<Self, ParameterError> {
        Self::filled(width, height, WallState::Absent)
    }

    /// A maze with outer walls, and inner walls of one state.
    ///
    /// # Errors
    ///
    /// If a side is not 1 to 256 cells.
    pub fn filled(width: usize, height: usize, within: WallState) -> Result<Self, ParameterError> {
        for (name, side) in [("width", width), ("height", height)] {
            require(name, side as f64, (1..=Self::MAX_SIDE).contains(&side), "1 to 256 cells")?;
        }
        let mut maze = Self {
            width: width as u16,
            height: height as u16,
            vertical: Layer::new(width + 1, height),
            horizontal: Layer::new(width, height + 1),
            goals: BitGrid::new(width, height),
            start: Cell::default(),
            heading: Direction::North,
        };
        for row in 0..=height {
            for column in 0..=width {
                let wall = |edge: bool| if edge { WallState::Present } else { within };
                if row < height {
                    maze.vertical.set((column, row), wall(column == 0 || column == width));
                }
                if column < width {
                    maze.horizontal.set((column, row), wall(row == 0 || row == height));
                }
            }
        }
        maze.set_goals(maze.centre());
        Ok(maze)
    }

    /// Number of cells from left to right.
    #[inline]
    pub fn width(&self) -> usize {
        self.width.into()
    }

    /// Number of cells from bottom to top.
    #[inline]
    pub fn height(&self) -> usize {
        self.height.into()
    }

    /// All cells, row by row from below.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + use<> {
        let width = self.width;
        (0..self.height).flat_map(move |y| (0..width).map(move |x| Cell::new(x, y)))
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        self.width() * self.height()
    }

    /// Index of a cell in the order of [`cells`](Self::cells).
    #[inline]
    pub fn index(&self, cell: Cell) -> usize {
        usize::from(cell.y) * self.width() + usize::from(cell.x)
    }

    /// Cell at an index in the order of [`cells`](Self::cells).
    #[inline]
    pub fn cell_at(&self, index: usize) -> Cell {
        Cell::new((index % self.width()) as u16, (index / self.width()) as u16)
    }

    /// Whether a cell belongs to the maze.
    #[inline]
    pub fn contains(&self, cell: Cell) -> bool {
        cell.x < self.width && cell.y < self.height
    }

    /// Adjacent cell in a direction, regardless of walls; `None` beyond the edge.
    #[inline]
    pub fn neighbour(&self, cell: Cell, direction: Direction) -> Option<Cell> {
        let (dx, dy) = direction.step();
        let x = u16::try_from(i32::from(cell.x) + dx).ok()?;
        let y = u16::try_from(i32::from(cell.y) + dy).ok()?;
        Some(Cell { x, y }).filter(|&cell| self.contains(cell))
    }

    /// State of a wall of a cell; absent outside the maze.
    #[inline]
    pub fn wall(&self, cell: Cell, direction: Direction) -> WallState {
        if !self.contains(cell) {
            return WallState::Absent;
        }
        let (layer, place) = self.place(cell, direction);
        layer.get(place)
    }

    /// Sets the state of a wall of a cell, which is also its neighbour's wall. Outside the maze nothing
    /// happens.
    pub fn set_wall(&mut self, cell: Cell, direction: Direction, wall: WallState) {
        if self.contains(cell) {
            let place = self.place(cell, direction).1;
            let vertical = matches!(direction, Direction::East | Direction::West);
            if vertical { &mut self.vertical } else { &mut self.horizontal }.set(place, wall);
        }
    }

    fn place(&self, cell: Cell, direction: Direction) -> (&Layer, (usize, usize)) {
        let (x, y) = (usize::from(cell.x), usize::from(cell.y));
        match direction {
            Direction::North => (&self.horizontal, (x, y + 1)),
            Direction::South => (&self.horizontal, (x, y)),
            Direction::East => (&self.vertical, (x + 1, y)),
            Direction::West => (&self.vertical, (x, y)),
        }
    }

    /// The neighbour accessible from a cell, with `unknown` for unknown walls.
    #[inline]
    pub fn passage(&self, cell: Cell, direction: Direction, unknown: Unknown) -> Option<Cell> {
        let open = match self.wall(cell, direction) {
            WallState::Absent => true,
            WallState::Present => false,
            WallState::Unknown => unknown == Unknown::Open,
        };
        self.neighbour(cell, direction).filter(|_| open)
    }

    /// Cells of a row that are open to the east and to the north, one bit each; the maze must be less than 64
    /// cells wide.
    #[inline]
    pub(super) fn open_row(&self, row: usize, unknown: Unknown) -> (u64, u64) {
        debug_assert!(self.width < 64);
        let inner = |cells: usize| (1u64 << cells) - 1;
        let east = !self.vertical.closed_row(row, unknown) >> 1 & inner(self.width() - 1);
        if row + 1 == self.height() {
            return (east, 0);
        }
        (east, !self.horizontal.closed_row(row + 1, unknown) & inner(self.width()))
    }

    /// Whether all four walls of a cell are known.
    pub fn is_known(&self, cell: Cell) -> bool {
        Direction::ALL.iter().all(|&direction| self.wall(cell, direction) != WallState::Unknown)
    }

    /// Number of unknown walls.
    pub fn unknown_walls(&self) -> usize {
        self.vertical.unknown.count() + self.horizontal.unknown.count()
    }

    /// Number of walls, each one cell long.
    pub fn wall_count(&self) -> usize {
        self.vertical.present.count() + self.horizontal.present.count()
    }

    /// Start cell.
    #[inline]
    pub fn start(&self) -> Cell {
        self.start
    }

    /// Heading at the start.
    #[inline]
    pub fn heading(&self) -> Direction {
        self.heading
    }

    /// Sets the start. Outside the maze nothing happens.
    pub fn set_start(&mut self, cell: Cell, heading: Direction) {
        if self.contains(cell) {
            (self.start, self.heading) = (cell, heading);
        }
    }

    /// Goal cells, row by row from below.
    pub fn goals(&self) -> impl Iterator<Item = Cell> + '_ {
        self.goals.ones().map(|(x, y)| Cell::new(x as u16, y as u16))
    }

    /// Whether a cell belongs to the goal.
    #[inline]
    pub fn is_goal(&self, cell: Cell) -> bool {
        self.contains(cell) && self.goals.get(cell.x.into(), cell.y.into())
    }

    /// Replaces the goal cells; those outside the maze are ignored.
    pub fn set_goals(&mut self, cells: impl IntoIterator<Item = Cell>) {
        self.goals.clear();
        for cell in cells {
            if self.contains(cell) {
                self.goals.set(cell.x.into(), cell.y.into(), true);
            }
        }
    }

    /// Default goal: the four centre cells if both sides are even, otherwise the cell at half of each side.
    pub fn centre(&self) -> Vec<Cell> {
        let (x, y) = (self.width / 2, self.height / 2);
        if self.width.is_multiple_of(2) && self.height.is_multiple_of(2) {
            return vec![Cell::new(x - 1, y - 1), Cell::new(x, y - 1), Cell::new(x - 1, y), Cell::new(x, y)];
        }
        vec![Cell::new(x, y)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_checked() {
        assert!(Maze::open(256, 1).is_ok());
        for (width, height, wrong) in
            [(0, 1, "width is 0"), (1, 0, "height is 0"), (257, 4, "width is 257"), (4, 257, "height is 257")]
        {
            let error = Maze::open(width, height).unwrap_err();
            assert_eq!(error.to_string(), format!("{wrong}; expected 1 to 256 cells"));
        }
    }

    #[test]
    fn both_sides_of_a_wall_agree() {
        for (width, height) in [(1, 1), (5, 3), (70, 66), (256, 256)] {
            let mut maze = Maze::unexplored(width, height).unwrap();
            let middle = Cell::new(width as u16 / 2, height as u16 / 2);
            for direction in Direction::ALL {
                for wall in [WallState::Absent, WallState::Unknown, WallState::Present] {
                    maze.set_wall(middle, direction, wall);
                    assert_eq!(maze.wall(middle, direction), wall);
                    if let Some(other) = maze.neighbour(middle, direction) {
                        assert_eq!(maze.wall(other, direction.opposite()), wall);
                    }
                }
            }
        }
    }

    #[test]
    fn unknown_walls_are_counted() {
        let maze = Maze::unexplored(16, 16).unwrap();
        assert_eq!((maze.unknown_walls(), maze.wall_count()), (2 * 16 * 15, 64));
        assert!(!maze.is_known(Cell::new(0, 0)));
        assert!(Maze::open(2, 2).unwrap().is_known(Cell::new(0, 0)));
    }

    #[test]
    fn the_centre_has_four_cells_or_one() {
        let centre = |w, h| Maze::open(w, h).unwrap().centre();
        assert_eq!(centre(16, 16).len(), 4);
        assert_eq!(centre(16, 16)[0], Cell::new(7, 7));
        assert_eq!(centre(2, 3), [Cell::new(1, 1)]);
        assert_eq!(centre(1, 1), [Cell::new(0, 0)]);
        assert_eq!(centre(9, 9), [Cell::new(4, 4)]);
    }

    #[test]
    fn what_is_outside_is_nothing() {
        let mut maze = Maze::open(2, 2).unwrap();
        let before = maze.clone();
        let outside = Cell::new(2, 0);
        maze.set_wall(outside, Direction::North, WallState::Present);
        maze.set_start(outside, Direction::East);
        assert_eq!(maze, before);
        assert_eq!(maze.wall(outside, Direction::West), WallState::Absent);
        assert!(!maze.is_goal(outside));
        assert_eq!(maze.neighbour(Cell::new(0, 0), Direction::West), None);
    }
}
