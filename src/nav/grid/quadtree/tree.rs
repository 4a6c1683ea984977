use crate::ParameterError;
use crate::parameter::require;
use crate::world::{BitGrid, GridCell};

/// Decomposition of a grid into free and blocked squares by quartering.
///
/// A *leaf* is a largest square with a side of a power of two whose cells are all free or all blocked. The
/// map may have any size: the root is the smallest power of two that contains it, squares that reach beyond
/// the map are divided further, and leaves lie within it. With a minimum leaf size, squares of that size are
/// not divided, and count as blocked if any of their cells is.
///
/// There are no nodes and no pointers: per level, one bit tells whether a square is free, another one whether
/// it is blocked. They are computed bottom-up, four squares of one level making one of the next, 64 at a
/// time, with less than two operations per cell; a changed cell changes one square per level.
///
/// ```
/// use roverlab::nav::grid::{Leaf, Quadtree};
/// use roverlab::world::{BitGrid, GridCell};
/// let grid = BitGrid::from_text("....\n....\n..#.\n....")?;
/// let tree = Quadtree::new(&grid);
/// let free = tree.free_leaves();
/// assert_eq!(free[0], Leaf { column: 0, row: 0, size: 2 });
/// assert_eq!((free.len(), tree.blocked_leaves().len()), (6, 1));
/// assert_eq!(tree.leaf_at(GridCell::new(1, 3)), Some(Leaf { column: 0, row: 2, size: 2 }));
/// # Ok::<(), roverlab::world::BitGridError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Quadtree {
    width: usize,
    height: usize,
    /// Level of the smallest leaves: their size is two to this power.
    smallest: usize,
    /// Free squares of each level; level 0 are the cells.
    free: Vec<BitGrid>,
    blocked: Vec<BitGrid>,
}

/// A square of cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Leaf {
    /// First column.
    pub column: usize,
    /// First row.
    pub row: usize,
    /// Side length (cells).
    pub size: usize,
}

impl Leaf {
    /// Whether a cell lies in it.
    pub fn contains(&self, cell: GridCell) -> bool {
        cell.column.wrapping_sub(self.column) < self.size && cell.row.wrapping_sub(self.row) < self.size
    }

    /// Centre (cells).
    pub fn centre(&self) -> crate::geometry::Point {
        let half = 0.5 * self.size as f64;
        crate::geometry::Point::new(self.column as f64 + half, self.row as f64 + half)
    }
}

impl Quadtree {
    /// Decomposes a grid down to its cells.
    pub fn new(grid: &BitGrid) -> Self {
        Self::build(grid, 0)
    }

    /// Decomposes a grid into squares of at least `minimum` cells, a power of two. At the far borders of a
    /// map whose size is no multiple of it, squares may be smaller. Fails for any other minimum.
    pub fn with_minimum_leaf(grid: &BitGrid, minimum: usize) -> Result<Self, ParameterError> {
        let good = minimum.is_power_of_two() && minimum <= 1 << 20;
        require("minimum leaf", minimum as f64, good, "a power of two up to 1048576 cells")?;
        Ok(Self::build(grid, minimum.trailing_zeros() as usize))
    }

    fn build(grid: &BitGrid, smallest: usize) -> Self {
        let (width, height) = (grid.width(), grid.height());
        let mut tree =
            Self { width, height, smallest, free: vec![grid.clone()], blocked: vec![grid.inverted()] };
        while tree.free.last().is_some_and(|level| level.width().max(level.height()) > 1) {
            let top = tree.free.len() - 1;
            let level = tree.free[top].quartered();
            tree.free.push(level);
            let level = tree.blocked[top].quartered();
            tree.blocked.push(level);
        }
        tree
    }

    /// Number of columns of the map.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows of the map.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The free leaves in the order of the book's program: upper left quarter, upper right, lower left, lower
    /// right, recursively.
    pub fn free_leaves(&self) -> Vec<Leaf> {
        let mut leaves = Vec::with_capacity(self.at_least(&self.free));
        self.visit(|leaf, free| {
            if free {
                leaves.push(leaf);
            }
        });
        leaves
    }

    /// The blocked leaves, in the same order.
    pub fn blocked_leaves(&self) -> Vec<Leaf> {
        let mut leaves = Vec::with_capacity(self.at_least(&self.blocked));
        self.visit(|leaf, free| {
            if !free {
                leaves.push(leaf);
            }
        });
        leaves
    }

    /// Lower bound on the number of leaves: per level, the squares not contained in one of the next.
    fn at_least(&self, squares: &[BitGrid]) -> usize {
        let counts: Vec<usize> =
            squares[self.smallest.min(squares.len())..].iter().map(BitGrid::count_free).collect();
        let larger = counts.iter().skip(1).chain([&0]);
        counts.iter().zip(larger).map(|(count, larger)| count - 4 * larger).sum()
    }

    /// Calls `found` with each leaf and whether it is free, in the order of [`Quadtree::free_leaves`].
    pub fn visit(&self, mut found: impl FnMut(Leaf, bool)) {
        if self.width > 0 && self.height > 0 {
            self.divide(self.free.len() - 1, 0, 0, &mut found);
        }
    }

    /// Squares are numbered by column and row among those of their level.
    fn divide(&self, level: usize, x: usize, y: usize, found: &mut impl FnMut(Leaf, bool)) {
        let square = GridCell::new(x, y);
        let leaf = Leaf { column: x << level, row: y << level, size: 1 << level };
        if leaf.column >= self.width || leaf.row >= self.height {
            return;
        }
        if self.free[level].is_free(square) {
            return found(leaf, true);
        }
        if self.is_solid(level, x, y) {
            return found(leaf, false);
        }
        if level == BLOCK && self.smallest == 0 && self.is_whole(leaf) {
            return self.visit_block(leaf, found);
        }
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            self.divide(level - 1, 2 * x + dx, 2 * y + dy, found);
        }
    }

    /// The leaves of a square of 64 cells, which make one word in the order of quarters.
    #[inline]
    fn visit_block(&self, block: Leaf, found: &mut impl FnMut(Leaf, bool)) {
        let rows = (0..8).map(|row| {
            let cells = self.free[0].row(block.row + row)[block.column / 64] >> (block.column % 64);
            (cells & 0xff) << (8 * row)
        });
        let cells = by_quarters(rows.fold(0, |all, row| all | row));
        let (free, blocked) = (joined(cells, 1) & FOURS, joined(!cells, 1) & FOURS);
        let fours = free | blocked;
        let sixteens = (joined(free, 4) | joined(blocked, 4)) & SIXTEENS;
        // A leaf is reported at its first cell.
        let mut firsts = !((fours * 0xe) | (sixteens * 0xfffe));
        while firsts != 0 {
            let index = firsts.trailing_zeros() as usize;
            let leaf = Leaf {
                column: block.column + every_second_bit(index),
                row: block.row + every_second_bit(index >> 1),
                size: 1 << ((fours >> index & 1) + (sixteens >> index & 1)),
            };
            found(leaf, cells >> index & 1 != 0);
            firsts &= firsts - 1;
        }
    }

    /// The free leaf that contains a cell, if any. Time is proportional to the number of levels.
    pub fn leaf_at(&self, cell: GridCell) -> Option<Leaf> {
        let square = |level: usize| GridCell::new(cell.column >> level, cell.row >> level);
        let free = |level: usize| self.free[level].is_free(square(level));
        let level = (0..self.free.len()).take_while(|&level| free(level)).last()?;
        let leaf = square_at(cell, level);
        (level >= self.smallest_at(cell)).then_some(leaf)
    }

    /// The blocked leaf that contains a cell, if any.
    pub fn blocked_leaf_at(&self, cell: GridCell) -> Option<Leaf> {
        if cell.column >= self.width || cell.row >= self.height || self.leaf_at(cell).is_some() {
            return None;
        }
        let square = |level: usize| GridCell::new(cell.column >> level, cell.row >> level);
        let blocked = |level: usize| self.blocked[level].is_free(square(level));
        let level = (0..self.free.len()).take_while(|&level| blocked(level)).last().unwrap_or(0);
        Some(square_at(cell, level.max(self.smallest_at(cell))))
    }

    /// Level of the smallest leaves around a cell; below the minimum only at the far borders.
    fn smallest_at(&self, cell: GridCell) -> usize {
        let is_whole = |level: &usize| self.is_whole(square_at(cell, *level));
        (0..=self.smallest).rev().find(is_whole).unwrap_or(0)
    }

    fn is_whole(&self, leaf: Leaf) -> bool {
        leaf.column + leaf.size <= self.width && leaf.row + leaf.size <= self.height
    }

    /// The free leaves that share part of an edge with a leaf: on the right, below, on the left, above. None
    /// where there is no such leaf.
    pub fn neighbours(&self, leaf: Leaf) -> Vec<Leaf> {
        let mut found = Vec::new();
        if self.leaf_at(GridCell::new(leaf.column, leaf.row)) != Some(leaf) {
            return found;
        }
        let (end_column, end_row) = (leaf.column + leaf.size, leaf.row + leaf.size);
        let mut side = |at: &dyn Fn(usize) -> GridCell| {
            let mut along = 0;
            while along < leaf.size {
                let cell = at(along);
                let next = self.leaf_at(cell);
                along += next.map_or(1, |next| {
                    // A larger neighbour covers the rest of the side, a smaller one its own size of it.
                    let within = if cell.column == at(along + 1).column {
                        next.row + next.size - cell.row
                    } else {
                        next.column + next.size - cell.column
                    };
                    found.push(next);
                    within
                });
            }
        };
        side(&|i| GridCell::new(end_column, leaf.row + i));
        side(&|i| GridCell::new(leaf.column + i, end_row));
        if leaf.column > 0 {
            side(&|i| GridCell::new(leaf.column - 1, leaf.row + i));
        }
        if leaf.row > 0 {
            side(&|i| GridCell::new(leaf.column + i, leaf.row - 1));
        }
        found
    }

    /// Makes a cell free or blocked. Changes at most one square per level. Ignores cells outside the map.
    pub fn set_free(&mut self, cell: GridCell, free: bool) {
        if cell.column >= self.width || cell.row >= self.height {
            return;
        }
        self.free[0].set_free(cell, free);
        self.blocked[0].set_free(cell, !free);
        for level in 1..self.free.len() {
            let square = GridCell::new(cell.column >> level, cell.row >> level);
            for squares in [&mut self.free, &mut self.blocked] {
                let quarters = [(0, 0), (1, 0), (0, 1), (1, 1)];
                let set = quarters.iter().all(|(dx, dy)| {
                    squares[level - 1].is_free(GridCell::new(2 * square.column + dx, 2 * square.row + dy))
                });
                squares[level].set_free(square, set);
            }
        }
    }

    /// Whether all cells of a square are free; `false` if it reaches beyond the map.
    pub(super) fn is_clear(&self, level: usize, x: usize, y: usize) -> bool {
        self.free[level].is_free(GridCell::new(x, y))
    }

    /// Whether a square that is not free is a blocked leaf, or part of one.
    pub(super) fn is_solid(&self, level: usize, x: usize, y: usize) -> bool {
        let leaf = square_at(GridCell::new(x << level, y << level), level);
        self.blocked[level].is_free(GridCell::new(x, y)) || (level <= self.smallest && self.is_whole(leaf))
    }

    pub(super) fn levels(&self) -> usize {
        self.free.len()
    }

    /// The cells in free leaves.
    pub(super) fn grid(&self) -> BitGrid {
        if self.smallest == 0 {
            return self.free[0].clone();
        }
        let mut grid = self.free[0].clone();
        for leaf in self.blocked_leaves() {
            for row in leaf.row..(leaf.row + leaf.size).min(self.height) {
                for column in leaf.column..(leaf.column + leaf.size).min(self.width) {
                    grid.set_free(GridCell::new(column, row), false);
                }
            }
        }
        grid
    }
}

/// Size of squares whose cells fill a word (power of two).
const BLOCK: usize = 3;

/// In the order of quarters, the first cells of the squares of four cells.
const FOURS: u64 = 0x1111_1111_1111_1111;
/// In the order of quarters, the first cells of the squares of sixteen cells.
const SIXTEENS: u64 = 0x0001_0001_0001_0001;

/// The bits that are set together with the three bits at multiples of `apart` above them.
fn joined(bits: u64, apart: u32) -> u64 {
    bits & bits >> apart & bits >> (2 * apart) & bits >> (3 * apart)
}

/// The number formed by bits 0, 2 and 4: the column of a cell from its number in the order of quarters.
fn every_second_bit(number: usize) -> usize {
    number & 1 | number >> 1 & 2 | number >> 2 & 4
}

/// Reorders eight rows of eight cells into the order of quarters, recursively. A cell's number has the bits
/// of its row followed by those of its column; they become interleaved.
fn by_quarters(rows: u64) -> u64 {
    SWAPS.into_iter().fold(rows, |cells, (mask, shift)| {
        let moved = (cells >> shift ^ cells) & mask;
        cells ^ (moved | moved << shift)
    })
}

/// Exchanges of two bits of the numbers: positions where the higher one is set, and distance to the others.
const SWAPS: [(u64, u32); 3] = [swap(4, 2), swap(3, 2), swap(2, 1)];

const fn swap(high: u32, low: u32) -> (u64, u32) {
    (numbers(high, low), (1 << high) - (1 << low))
}

/// The numbers below 64 with one bit clear and a lower one set, as bits.
const fn numbers(clear: u32, set: u32) -> u64 {
    let (mut mask, mut number) = (0, 0);
    while number < 64 {
        if number >> clear & 1 == 0 && number >> set & 1 == 1 {
            mask |= 1 << number;
        }
        number += 1;
    }
    mask
}

/// The square of a level around a cell.
fn square_at(cell: GridCell, level: usize) -> Leaf {
    Leaf { column: cell.column >> level << level, row: cell.row >> level << level, size: 1 << level }
}
