use super::{Occupancy, OccupancyGrid};
use crate::ParameterError;
use crate::geometry::{Point, Pose};
use crate::parameter::debug_as_sentence;

/// A cell's position in a grid: column and row, from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct GridCell {
    /// The column.
    pub column: usize,
    /// The row.
    pub row: usize,
}

impl GridCell {
    /// The cell at a column and row.
    pub const fn new(column: usize, row: usize) -> Self {
        Self { column, row }
    }

    /// Centre of the cell, in cells.
    pub fn centre(self) -> Point {
        Point::new(self.column as f64 + 0.5, self.row as f64 + 0.5)
    }

    /// The cell that contains a point in cell units; `None` for negative or NaN coordinates.
    pub fn at(point: Point) -> Option<Self> {
        let inside = point.x >= 0.0 && point.y >= 0.0;
        inside.then(|| Self::new(point.x as usize, point.y as usize))
    }
}

impl std::fmt::Display for GridCell {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "({}, {})", self.column, self.row)
    }
}

/// A grid of free or blocked cells, one bit each, packed 64 to a word.
///
/// Everything outside is blocked. The direction of rows depends on the map: those of [`OccupancyGrid`] count
/// upwards, those of pictures and MovingAI maps downwards.
///
/// ```
/// use roverlab::world::{BitGrid, GridCell};
/// let grid = BitGrid::from_text("..#\n...")?;
/// assert_eq!((grid.width(), grid.height(), grid.count_free()), (3, 2, 5));
/// assert!(!grid.is_free(GridCell::new(2, 0)) && !grid.is_free(GridCell::new(3, 0)));
/// # Ok::<(), roverlab::world::BitGridError>(())
/// ```
#[derive(Clone, PartialEq, Eq)]
pub struct BitGrid {
    width: usize,
    height: usize,
    /// Words per row.
    stride: usize,
    /// Rows of cells; a set bit is a free cell, and the lowest bit is the first column. Bits beyond the width
    /// are 0.
    words: Vec<u64>,
}

/// Reason why a grid cannot be built.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BitGridError {
    /// The grid does not fit into memory.
    #[error("a grid of {width} x {height} cells; expected at most {} cells", BitGrid::MAX_CELLS)]
    TooLarge {
        /// Cells per row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// A drawing has lines of different lengths.
    #[error("line {line} of a drawn grid has {found} cells; expected {expected}, as the first line")]
    Ragged {
        /// The line, from 1.
        line: usize,
        /// Its number of cells.
        found: usize,
        /// Number of cells in the first line.
        expected: usize,
    },
}

debug_as_sentence!(BitGridError);

impl BitGrid {
    /// Largest number of cells.
    pub const MAX_CELLS: usize = 1 << 25;

    /// A grid of blocked cells only.
    pub fn blocked(width: usize, height: usize) -> Result<Self, BitGridError> {
        if width.saturating_mul(height) > Self::MAX_CELLS || width.max(height) > Self::MAX_CELLS {
            return Err(BitGridError::TooLarge { width, height });
        }
        let stride = width.div_ceil(64);
        Ok(Self { width, height, stride, words: vec![0; stride * height] })
    }

    /// A grid with free cells where `is_free(column, row)`.
    pub fn from_fn(
        width: usize,
        height: usize,
        mut is_free: impl FnMut(usize, usize) -> bool,
    ) -> Result<Self, BitGridError> {
        let mut grid = Self::blocked(width, height)?;
        for row in 0..height {
            let words = &mut grid.words[row * grid.stride..][..grid.stride];
            for column in 0..width {
                words[column / 64] |= u64::from(is_free(column, row)) << (column % 64);
            }
        }
        Ok(grid)
    }

    /// A grid from a drawing, one line per row, first row first: `#` and `@` are blocked, everything else is
    /// free.
    pub fn from_text(text: &str) -> Result<Self, BitGridError> {
        let rows: Vec<Vec<char>> = text.lines().map(|line| line.chars().collect()).collect();
        let width = rows.first().map_or(0, Vec::len);
        if let Some(row) = rows.iter().position(|row| row.len() != width) {
            return Err(BitGridError::Ragged { line: row + 1, found: rows[row].len(), expected: width });
        }
        Self::from_fn(width, rows.len(), |column, row| !matches!(rows[row][column], '#' | '@'))
    }

    /// Free cells of an occupancy grid, in the same columns and rows. Unknown cells are blocked.
    pub fn from_occupancy(grid: &OccupancyGrid) -> Self {
        let free = |column, row| grid.cell(column, row) == Occupancy::Free;
        Self::from_fn(grid.width(), grid.height(), free).unwrap_or_else(|_| Self::empty())
    }

    /// The same as an occupancy grid with a cell size of `resolution` metres; `origin` is the outer corner of
    /// the first cell.
    pub fn to_occupancy(&self, resolution: f64, origin: Pose) -> Result<OccupancyGrid, ParameterError> {
        let mut grid = OccupancyGrid::unknown(self.width, self.height, resolution, origin)?;
        for row in 0..self.height {
            for column in 0..self.width {
                let free = self.is_free(GridCell::new(column, row));
                grid.set(column, row, if free { Occupancy::Free } else { Occupancy::Occupied });
            }
        }
        Ok(grid)
    }

    fn empty() -> Self {
        Self { width: 0, height: 0, stride: 0, words: Vec::new() }
    }

    /// Cells per row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Whether a cell is within the grid.
    #[inline]
    pub fn contains(&self, cell: GridCell) -> bool {
        cell.column < self.width && cell.row < self.height
    }

    /// Whether a cell is free; cells outside are not.
    #[inline]
    pub fn is_free(&self, cell: GridCell) -> bool {
        self.contains(cell) && self.words[self.word(cell)] >> (cell.column % 64) & 1 != 0
    }

    /// Makes a cell free or blocked; no effect outside the grid.
    pub fn set_free(&mut self, cell: GridCell, free: bool) {
        if self.contains(cell) {
            let (word, bit) = (self.word(cell), 1 << (cell.column % 64));
            if free {
                self.words[word] |= bit;
            } else {
                self.words[word] &= !bit;
            }
        }
    }

    /// Words of a row: bit `c % 64` of word `c / 64` is set if column `c` is free.
    ///
    /// # Panics
    ///
    /// If there is no such row.
    #[inline]
    pub fn row(&self, row: usize) -> &[u64] {
        &self.words[row * self.stride..][..self.stride]
    }

    /// Number of free cells.
    pub fn count_free(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Free cells, row by row.
    pub fn free_cells(&self) -> impl Iterator<Item = GridCell> + '_ {
        (0..self.height)
            .flat_map(move |row| ones(self.row(row)).map(move |column| GridCell::new(column, row)))
    }

    /// The grid with columns and rows exchanged.
    #[must_use]
    pub fn transposed(&self) -> Self {
        let stride = self.height.div_ceil(64);
        let mut words = vec![0; stride * self.width];
        for block_row in 0..stride {
            for block_column in 0..self.stride {
                let mut block = [0; 64];
                for (i, word) in block.iter_mut().enumerate() {
                    let row = block_row * 64 + i;
                    *word = if row < self.height { self.words[row * self.stride + block_column] } else { 0 };
                }
                transpose_block(&mut block);
                let columns = self.width - block_column * 64;
                for (i, word) in block.iter().enumerate().take(columns) {
                    words[(block_column * 64 + i) * stride + block_row] = *word;
                }
            }
        }
        Self { width: self.height, height: self.width, stride, words }
    }

    /// The grid with free and blocked cells exchanged.
    pub(crate) fn inverted(&self) -> Self {
        let mut grid = self.clone();
        let beyond = self.width % 64;
        for row in grid.words.chunks_mut(self.stride.max(1)) {
            for word in row.iter_mut() {
                *word = !*word;
            }
            if let Some(last) = row.last_mut().filter(|_| beyond > 0) {
                *last &= (1 << beyond) - 1;
            }
        }
        grid
    }

    /// The grid at half the size; a cell is free if all its four original cells are.
    pub(crate) fn quartered(&self) -> Self {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let stride = width.div_ceil(64);
        let mut words = vec![0; stride * height];
        for row in 0..self.height / 2 {
            let (upper, lower) = (self.row(2 * row), self.row(2 * row + 1));
            for (index, (a, b)) in upper.iter().zip(lower).enumerate() {
                let both = a & b;
                words[row * stride + index / 2] |= every_second(both & both >> 1) << (32 * (index % 2));
            }
        }
        Self { width, height, stride, words }
    }

    #[inline]
    fn word(&self, cell: GridCell) -> usize {
        cell.row * self.stride + cell.column / 64
    }
}

impl std::fmt::Debug for BitGrid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "{} x {} cells", self.width, self.height)?;
        for row in 0..self.height.min(64) {
            let symbol = |column| if self.is_free(GridCell::new(column, row)) { '.' } else { '#' };
            writeln!(f, "{}", (0..self.width.min(128)).map(symbol).collect::<String>())?;
        }
        Ok(())
    }
}

/// Positions of the set bits in a row of words.
pub(crate) fn ones(words: &[u64]) -> impl Iterator<Item = usize> + '_ {
    words.iter().enumerate().flat_map(|(index, &word)| {
        let mut rest = word;
        std::iter::from_fn(move || {
            (rest != 0).then(|| {
                let bit = rest.trailing_zeros() as usize;
                rest &= rest - 1;
                64 * index + bit
            })
        })
    })
}

/// Compacts the bits at even positions.
fn every_second(mut word: u64) -> u64 {
    word &= 0x5555_5555_5555_5555;
    for (shift, mask) in [
        (1, 0x3333_3333_3333_3333),
        (2, 0x0f0f_0f0f_0f0f_0f0f),
        (4, 0x00ff_00ff_00ff_00ff),
        (8, 0x0000_ffff_0000_ffff),
        (16, 0x0000_0000_ffff_ffff),
    ] {
        word = (word | word >> shift) & mask;
    }
    word
}

/// Transposes a block of 64 x 64 bits recursively.
fn transpose_block(block: &mut [u64; 64]) {
    let (mut width, mut mask) = (32, 0x0000_0000_ffff_ffffu64);
    while width != 0 {
        let mut row = 0;
        while row < 64 {
            let swap = ((block[row] >> width) ^ block[row + width]) & mask;
            block[row] ^= swap << width;
            block[row + width] ^= swap;
            row = (row + width + 1) & !width;
        }
        width >>= 1;
        mask ^= mask << width;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_drawing_becomes_a_grid() {
        let grid = BitGrid::from_text(".#.\n@..").unwrap();
        let free: Vec<_> = grid.free_cells().map(|cell| (cell.column, cell.row)).collect();
        assert_eq!(free, [(0, 0), (2, 0), (1, 1), (2, 1)]);
        assert_eq!(format!("{grid:?}"), "3 x 2 cells\n.#.\n#..\n");
        let error = BitGrid::from_text("..\n...").unwrap_err();
        assert_eq!(error.to_string(), "line 2 of a drawn grid has 3 cells; expected 2, as the first line");
        assert_eq!(BitGrid::from_text("").unwrap().count_free(), 0);
    }

    #[test]
    fn absurd_grids_are_refused() {
        assert!(BitGrid::blocked(usize::MAX, 2).is_err() && BitGrid::blocked(usize::MAX, 0).is_err());
        assert!(BitGrid::blocked(1 << 13, (1 << 12) + 1).is_err());
        assert_eq!(BitGrid::blocked(0, 7).unwrap().count_free(), 0);
    }

    #[test]
    fn occupancy_keeps_free_cells() {
        let mut map = OccupancyGrid::unknown(3, 2, 0.1, Pose::default()).unwrap();
        map.set(1, 0, Occupancy::Free);
        map.set(2, 1, Occupancy::Occupied);
        let grid = BitGrid::from_occupancy(&map);
        assert_eq!(grid.free_cells().collect::<Vec<_>>(), [GridCell::new(1, 0)]);
        let back = grid.to_occupancy(0.1, Pose::default()).unwrap();
        assert_eq!((back.count(Occupancy::Free), back.count(Occupancy::Occupied)), (1, 5));
    }

    #[test]
    fn the_cell_of_a_point() {
        assert_eq!(GridCell::at(Point::new(2.9, 0.0)), Some(GridCell::new(2, 0)));
        assert_eq!(GridCell::at(GridCell::new(5, 7).centre()), Some(GridCell::new(5, 7)));
        assert_eq!(GridCell::at(Point::new(-0.1, 0.0)), None);
        assert_eq!(GridCell::at(Point::new(f64::NAN, 0.0)), None);
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn transposing_exchanges_columns_and_rows(
            width in 0..150usize, height in 0..150usize, seed in any::<u64>()
        ) {
            let mut stream = crate::random::Stream::new(seed);
            let grid = BitGrid::from_fn(width, height, |_, _| stream.between(0.0, 1.0) < 0.5).unwrap();
            let turned = grid.transposed();
            prop_assert_eq!((turned.width(), turned.height()), (height, width));
            prop_assert!(grid.free_cells().all(|c| turned.is_free(GridCell::new(c.row, c.column))));
            prop_assert_eq!(turned.count_free(), grid.count_free());
            prop_assert_eq!(turned.transposed(), grid);
        }

        #[test]
        fn quarters_are_free_if_all_their_cells_are(width in 0..300usize, height in 0..9usize, seed in any::<u64>()) {
            let mut stream = crate::random::Stream::new(seed);
            let grid = BitGrid::from_fn(width, height, |_, _| stream.chance(0.8)).unwrap();
            let quartered = grid.quartered();
            prop_assert_eq!((quartered.width(), quartered.height()), (width.div_ceil(2), height.div_ceil(2)));
            for (x, y) in (0..=height / 2).flat_map(|y| (0..=width / 2).map(move |x| (x, y))) {
                let cells = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| GridCell::new(2 * x + dx, 2 * y + dy));
                prop_assert_eq!(quartered.is_free(GridCell::new(x, y)), cells.iter().all(|&c| grid.is_free(c)));
            }
            let inverted = grid.inverted();
            prop_assert_eq!(inverted.count_free(), width * height - grid.count_free());
            prop_assert!(grid.free_cells().all(|cell| !inverted.is_free(cell)));
        }

        #[test]
        fn a_set_cell_is_read_back(column in 0..200usize, row in 0..3usize, free in any::<bool>()) {
            let mut grid = BitGrid::from_fn(130, 3, |_, _| !free).unwrap();
            let before = grid.clone();
            let cell = GridCell::new(column, row);
            grid.set_free(cell, free);
            prop_assert_eq!(grid.is_free(cell), free && column < 130);
            prop_assert_eq!(grid == before, column >= 130);
        }
    }
}
