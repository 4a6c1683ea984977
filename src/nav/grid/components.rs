use crate::world::{BitGrid, GridCell};

/// The connected regions of a grid's free cells: answers at once whether a path between two cells exists.
///
/// Cells are connected through edges. A diagonal step needs both cells beside it free, so it connects nothing
/// more.
///
/// Union-find over the runs of free cells in neighbouring rows. Time is proportional to the number of the
/// grid's words and runs, memory to the number of runs.
///
/// ```
/// use roverlab::nav::grid::GridComponents;
/// use roverlab::world::{BitGrid, GridCell};
/// let grid = BitGrid::from_text("..#.\n.#..\n#...")?;
/// let components = GridComponents::new(&grid);
/// assert_eq!(components.count(), 2);
/// // Two cells that only touch at a corner.
/// assert!(!components.connected(GridCell::new(0, 1), GridCell::new(1, 2)));
/// # Ok::<(), roverlab::world::BitGridError>(())
/// ```
#[derive(Debug, Clone)]
pub struct GridComponents {
    /// Index of the first run of each row, and the end.
    rows: Vec<u32>,
    runs: Vec<Run>,
    count: usize,
}

/// A maximal stretch of free cells in a row.
#[derive(Debug, Clone, Copy)]
struct Run {
    first: u32,
    end: u32,
    /// A lower-numbered run of the same region, or itself; finally the number of the region.
    label: u32,
}

impl GridComponents {
    /// Finds the regions of a grid.
    pub fn new(grid: &BitGrid) -> Self {
        let mut this = Self { rows: vec![0], runs: Vec::new(), count: 0 };
        for row in 0..grid.height() {
            let above = this.rows[row.saturating_sub(1)] as usize..this.runs.len();
            for_each_run(grid.row(row), grid.width(), |first, end| {
                let label = this.runs.len() as u32;
                this.runs.push(Run { first: first as u32, end: end as u32, label });
            });
            this.join(above);
            this.rows.push(this.runs.len() as u32);
        }
        this.number();
        this
    }

    /// Number of regions.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The region of a cell, numbered from 0 in the order of first cells; `None` if the cell is not free.
    pub fn region(&self, cell: GridCell) -> Option<usize> {
        let rows = self.rows.get(cell.row..cell.row.saturating_add(2))?;
        let runs = &self.runs[rows[0] as usize..rows[1] as usize];
        let index = runs.partition_point(|run| run.end as usize <= cell.column);
        runs.get(index).filter(|run| run.first as usize <= cell.column).map(|run| run.label as usize)
    }

    /// Whether both cells are free and a path connects them.
    pub fn connected(&self, a: GridCell, b: GridCell) -> bool {
        self.region(a).is_some_and(|region| Some(region) == self.region(b))
    }

    /// Number of cells in each region.
    pub fn sizes(&self) -> Vec<usize> {
        let mut sizes = vec![0; self.count];
        for run in &self.runs {
            sizes[run.label as usize] += (run.end - run.first) as usize;
        }
        sizes
    }

    /// Joins the runs of the last row with those they touch in the row above.
    fn join(&mut self, above: std::ops::Range<usize>) {
        let (mut a, mut b) = (above.start, above.end);
        while a < above.end && b < self.runs.len() {
            let (upper, lower) = (self.runs[a], self.runs[b]);
            if upper.first < lower.end && lower.first < upper.end {
                let (i, j) = (self.root(a), self.root(b));
                let (low, high) = (i.min(j), i.max(j));
                self.runs[high].label = low as u32;
            }
            if upper.end < lower.end {
                a += 1;
            } else {
                b += 1;
            }
        }
    }

    fn root(&mut self, mut run: usize) -> usize {
        while self.runs[run].label as usize != run {
            let next = self.runs[run].label as usize;
            // Path halving keeps the chains short.
            self.runs[run].label = self.runs[next].label;
            run = self.runs[run].label as usize;
        }
        run
    }

    fn number(&mut self) {
        for run in 0..self.runs.len() {
            let label = self.runs[run].label as usize;
            self.runs[run].label = if label == run {
                self.count += 1;
                self.count as u32 - 1
            } else {
                // Labels point to earlier runs, which are already numbered.
                self.runs[label].label
            };
        }
    }
}

/// Calls `found(first, end)` for each maximal stretch of set bits.
fn for_each_run(words: &[u64], width: usize, mut found: impl FnMut(usize, usize)) {
    let mut from = 0;
    while let Some(first) = next_bit(words, width, from, true) {
        let end = next_bit(words, width, first, false).unwrap_or(width);
        found(first, end);
        from = end;
    }
}

/// The first bit at or after `from`, below `width`, that equals `set`.
fn next_bit(words: &[u64], width: usize, from: usize, set: bool) -> Option<usize> {
    let flip = if set { 0 } else { u64::MAX };
    let mut index = from / 64;
    let mut word = (words.get(index)? ^ flip) & (u64::MAX << (from % 64));
    while word == 0 {
        index += 1;
        word = words.get(index)? ^ flip;
    }
    Some(64 * index + word.trailing_zeros() as usize).filter(|&bit| bit < width)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;
    use proptest::prelude::*;

    #[test]
    fn grids_without_free_cells_have_no_regions() {
        for grid in [BitGrid::blocked(0, 0), BitGrid::blocked(70, 3), BitGrid::blocked(0, 5)] {
            let components = GridComponents::new(&grid.unwrap());
            assert_eq!((components.count(), components.region(GridCell::new(0, 0))), (0, None));
            assert_eq!(components.region(GridCell::new(usize::MAX, usize::MAX)), None);
        }
    }

    #[test]
    fn a_comb_is_one_region() {
        let grid = BitGrid::from_text(".#.#.#.\n.#.#.#.\n.......").unwrap();
        let components = GridComponents::new(&grid);
        assert_eq!((components.count(), components.sizes()), (1, vec![15]));
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        /// Regions agree with flood fill.
        #[test]
        fn regions_are_flooded(width in 1..140usize, height in 1..20usize, seed in any::<u64>(), share in 0.3..0.9f64) {
            let mut stream = Stream::new(seed);
            let grid = BitGrid::from_fn(width, height, |_, _| stream.chance(share)).unwrap();
            let components = GridComponents::new(&grid);
            let mut seen = vec![false; width * height];
            let mut region = 0;
            for seed in grid.free_cells() {
                if seen[seed.row * width + seed.column] {
                    continue;
                }
                let (mut stack, mut size) = (vec![seed], 0);
                while let Some(cell) = stack.pop() {
                    let index = cell.row.wrapping_mul(width).wrapping_add(cell.column);
                    if !grid.is_free(cell) || std::mem::replace(&mut seen[index], true) {
                        continue;
                    }
                    size += 1;
                    prop_assert_eq!(components.region(cell), Some(region));
                    stack.extend([(1, 0), (usize::MAX, 0), (0, 1), (0, usize::MAX)].map(|(x, y)| {
                        GridCell::new(cell.column.wrapping_add(x), cell.row.wrapping_add(y))
                    }));
                }
                prop_assert_eq!(components.sizes()[region], size);
                region += 1;
            }
            prop_assert_eq!(components.count(), region);
        }
    }
}
