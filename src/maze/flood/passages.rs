use crate::maze::{Cell, Direction, Maze, Unknown};

/// Where one can go from cell to cell, in the form that flood fill is fastest on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Passages {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) grid: Grid,
}

/// Cells of the largest maze.
pub(super) const LARGEST: usize = Maze::MAX_SIDE * Maze::MAX_SIDE;

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Grid {
    /// Up to 16 x 16 cells, in rows of 16 bits.
    Small(Boards<4>),
    /// Up to 32 x 32 cells, in rows of 32 bits.
    Medium(Box<Boards<16>>),
    /// Any more: for each cell its open directions, north in the lowest bit; always as many as the largest maze has.
    Large(Vec<u8>),
}

/// A bit for each cell that is open to the east, and to the north. Of `N` words each has every `N`th row, so that the next
/// row is in the next word at the same place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Boards<const N: usize> {
    pub(super) east: [u64; N],
    pub(super) north: [u64; N],
}

impl<const N: usize> Boards<N> {
    /// Bits of a row, with which `N` words hold as many rows.
    pub(super) const ROW: usize = if N == 4 { 16 } else { 32 };

    /// The word of a row, and its lowest bit there.
    #[inline]
    pub(super) fn place(row: usize) -> (usize, usize) {
        (row % N, row / N * Self::ROW)
    }

    /// The boards of a maze that is no wider and no higher than a row is long.
    fn read(maze: &Maze, unknown: Unknown) -> Self {
        let mut boards = Self { east: [0; N], north: [0; N] };
        for row in 0..maze.height() {
            let (word, shift) = Self::place(row);
            let (east, north) = maze.open_row(row, unknown);
            boards.east[word] |= east << shift;
            boards.north[word] |= north << shift;
        }
        boards
    }

    fn set(&mut self, (x, y): (usize, usize), eastward: bool, open: bool) {
        let board = if eastward { &mut self.east } else { &mut self.north };
        let (word, shift) = Self::place(y);
        let mask = 1 << (shift + x);
        let word = &mut board[word];
        *word = if open { *word | mask } else { *word & !mask };
    }
}

impl Passages {
    /// The passages of a maze, with unknown walls taken as said.
    pub fn new(maze: &Maze, unknown: Unknown) -> Self {
        let (width, height) = (maze.width(), maze.height());
        let grid = match width.max(height) {
            0..=16 => Grid::Small(Boards::read(maze, unknown)),
            17..=32 => Grid::Medium(Box::new(Boards::read(maze, unknown))),
            _ => return Self::listed(maze, unknown),
        };
        Self { width, height, grid }
    }

    /// As [`new`](Self::new), but always in the form of large mazes, which are filled from a queue: for comparisons.
    pub fn listed(maze: &Maze, unknown: Unknown) -> Self {
        let (width, height) = (maze.width(), maze.height());
        let mut passages = Self { width, height, grid: Grid::Large(vec![0; LARGEST]) };
        for cell in maze.cells() {
            for direction in [Direction::North, Direction::East] {
                if maze.passage(cell, direction, unknown).is_some() {
                    passages.set(cell, direction, true);
                }
            }
        }
        passages
    }

    /// Cells from left to right.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Cells from bottom to top.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Whether a cell belongs to the maze.
    #[inline]
    pub fn contains(&self, cell: Cell) -> bool {
        usize::from(cell.x) < self.width && usize::from(cell.y) < self.height
    }

    /// Opens or closes the way between a cell and its neighbour, both ways. Where there is no neighbour nothing happens.
    pub fn set(&mut self, cell: Cell, direction: Direction, open: bool) {
        let Some((lower, eastward)) = self.lower(cell, direction) else { return };
        match &mut self.grid {
            Grid::Small(boards) => boards.set(lower, eastward, open),
            Grid::Medium(boards) => boards.set(lower, eastward, open),
            Grid::Large(openings) => {
                let (x, y) = lower;
                let here = y * self.width + x;
                let (forth, there) = if eastward {
                    (Direction::East, here + 1)
                } else {
                    (Direction::North, here + self.width)
                };
                for (index, direction) in [(here, forth), (there, forth.opposite())] {
                    let mask = 1 << direction as u8;
                    openings[index] = if open { openings[index] | mask } else { openings[index] & !mask };
                }
            }
        }
    }

    /// Whether one can go from a cell to its neighbour.
    #[inline]
    pub fn is_open(&self, cell: Cell, direction: Direction) -> bool {
        let Some((lower, eastward)) = self.lower(cell, direction) else { return false };
        match &self.grid {
            Grid::Small(boards) => boards.get(lower, eastward),
            Grid::Medium(boards) => boards.get(lower, eastward),
            Grid::Large(openings) => {
                let mask = 1 << if eastward { Direction::East as u8 } else { Direction::North as u8 };
                openings[lower.1 * self.width + lower.0] & mask != 0
            }
        }
    }

    /// Of a cell and its neighbour the western or southern one, and whether the other lies east of it.
    #[inline]
    fn lower(&self, cell: Cell, direction: Direction) -> Option<((usize, usize), bool)> {
        let (x, y) = (usize::from(cell.x), usize::from(cell.y));
        let (lower, eastward) = match direction {
            Direction::North => ((x, y), false),
            Direction::East => ((x, y), true),
            Direction::South => ((x, y.checked_sub(1)?), false),
            Direction::West => ((x.checked_sub(1)?, y), true),
        };
        let (right, top) = (lower.0 + usize::from(eastward), lower.1 + usize::from(!eastward));
        (right < self.width && top < self.height).then_some((lower, eastward))
    }
}

impl<const N: usize> Boards<N> {
    #[inline]
    fn get(&self, (x, y): (usize, usize), eastward: bool) -> bool {
        let board = if eastward { &self.east } else { &self.north };
        let (word, shift) = Self::place(y);
        board[word] >> (shift + x) & 1 != 0
    }
}
