use crate::maze::{Cell, Direction, Maze, Unknown};

/// Passages between cells, in the form that flood fill processes fastest.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Passages {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) grid: Grid,
}

/// Number of cells of the largest maze.
pub(super) const LARGEST: usize = Maze::MAX_SIDE * Maze::MAX_SIDE;

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Grid {
    /// Up to 16 x 16 cells, in rows of 16 bits.
    Small(Boards<4>),
    /// Up to 32 x 32 cells, in rows of 32 bits.
    Medium(Box<Boards<16>>),
    /// Larger mazes: open directions per cell, north in the lowest bit; always sized for the largest maze.
    Large(Vec<u8>),
}

/// Bit boards of the cells that are open to the east and to the north. Word `i` of `N` holds every `N`th row
/// from `i`, so that the next row is at the same place in the next word.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Boards<const N: usize> {
    pub(super) east: [u64; N],
    pub(super) north: [u64; N],
}

impl<const N: usize> Boards<N> {
    /// Bits per row; `N` words hold as many rows.
    pub(super) const ROW: usize = if N == 4 { 16 } else { 32 };

    /// Word of a row, and its lowest bit there.
    #[inline]
    pub(super) fn place(row: usize) -> (usize, usize) {
        (row % N, row / N * Self::ROW)
    }

    /// Boards of a maze whose sides are at most `ROW`.
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
    /// Passages of a maze, with `unknown` for unknown walls.
    pub fn new(maze: &Maze, unknown: Unknown) -> Self {
        let (width, height) = (maze.width(), maze.height());
        let grid = match width.max(height) {
            0..=16 => Grid::Small(Boards::read(maze, unknown)),
            17..=32 => Grid::Medium(Box::new(Boards::read(maze, unknown))),
            _ => return Self::listed(maze, unknown),
        };
        Self { width, height, grid }
    }

    /// As [`new`](Self::new), but always in the form for large mazes, for comparisons.
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

    /// Number of cells from left to right.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of cells from bottom to top.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Whether a cell belongs to the maze.
    #[inline]
    pub fn contains(&self, cell: Cell) -> bool {
        usize::from(cell.x) < self.width && usize::from(cell.y) < self.height
    }

    /// Opens or closes the passage between a cell and its neighbour, in both directions. Without a neighbour,
    /// nothing happens.
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

    /// Whether the passage from a cell to its neighbour is open.
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

    /// The western or southern one of a cell and its neighbour, and whether the other lies to its east.
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
