/// Lowest and highest elevation of some cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds {
    pub(super) low: f32,
    pub(super) high: f32,
}

impl Bounds {
    const NONE: Self = Self { low: f32::INFINITY, high: f32::NEG_INFINITY };

    fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }
}

/// Lowest and highest elevations of blocks of cells; each level's blocks are twice as wide as those of the
/// level below. A ray skips blocks that it passes completely above or below.
///
/// The first level's blocks are four cells wide; below that, testing the cells' corners is as fast.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pyramid {
    levels: Vec<Level>,
}

#[derive(Debug, Clone, PartialEq)]
struct Level {
    columns: usize,
    blocks: Vec<Bounds>,
}

/// Blocks of the first level are `1 << FIRST` cells wide.
pub(super) const FIRST: u32 = 2;

impl Pyramid {
    /// The pyramid over a grid of samples in rows.
    pub(super) fn over(columns: usize, rows: usize, heights: &[f32]) -> Self {
        let size = |samples: usize| ((samples - 2) >> FIRST) + 1;
        let mut levels = vec![Level::from_samples((size(columns), size(rows)), (columns, rows), heights)];
        while let Some(above) = levels.last().and_then(Level::above) {
            levels.push(above);
        }
        Self { levels }
    }

    /// Level of the largest block, which covers everything.
    pub(super) fn top(&self) -> u32 {
        self.levels.len() as u32 - 1 + FIRST
    }

    /// Bounds of the block of `1 << level` cells in each direction that contains a cell.
    #[inline]
    pub(super) fn block(&self, level: u32, column: usize, row: usize) -> Bounds {
        let blocks = &self.levels[(level - FIRST) as usize];
        blocks.blocks[(row >> level) * blocks.columns + (column >> level)]
    }

    /// Bounds of the whole grid.
    pub(super) fn whole(&self) -> Bounds {
        self.block(self.top(), 0, 0)
    }
}

impl Level {
    fn from_samples(
        (columns, rows): (usize, usize),
        (sample_columns, sample_rows): (usize, usize),
        heights: &[f32],
    ) -> Self {
        let mut blocks = Vec::with_capacity(columns * rows);
        // Samples on the border of two blocks belong to both.
        let part = |block: usize, samples: usize| (block << FIRST)..(((block + 1) << FIRST) + 1).min(samples);
        for row in 0..rows {
            for column in 0..columns {
                let mut bounds = Bounds::NONE;
                for sample_row in part(row, sample_rows) {
                    let line = &heights[sample_row * sample_columns..][part(column, sample_columns)];
                    bounds = line.iter().fold(bounds, |all, &h| all.union(Bounds { low: h, high: h }));
                }
                blocks.push(bounds);
            }
        }
        Self { columns, blocks }
    }

    /// The level above; `None` if this one is a single block.
    fn above(&self) -> Option<Self> {
        if self.blocks.len() == 1 {
            return None;
        }
        let rows = self.blocks.len() / self.columns;
        let columns = self.columns.div_ceil(2);
        let mut blocks = vec![Bounds::NONE; columns * rows.div_ceil(2)];
        for (number, &bounds) in self.blocks.iter().enumerate() {
            let (column, row) = (number % self.columns, number / self.columns);
            let above = &mut blocks[(row / 2) * columns + column / 2];
            *above = above.union(bounds);
        }
        Some(Self { columns, blocks })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(64))]
        #[test]
        fn each_block_holds_the_corners_of_its_cells_and_no_more(
            seed in any::<u64>(), columns in 2..40_usize, rows in 2..40_usize,
        ) {
            let mut stream = crate::random::Stream::new(seed);
            let heights: Vec<f32> = (0..columns * rows).map(|_| stream.between(-1.0, 1.0) as f32).collect();
            let pyramid = Pyramid::over(columns, rows, &heights);
            for level in FIRST..=pyramid.top() {
                for row in 0..rows - 1 {
                    for column in 0..columns - 1 {
                        let from = |cell: usize| cell >> level << level;
                        let to = |cell: usize, samples: usize| (from(cell) + (1 << level)).min(samples - 1);
                        let mut expected = Bounds::NONE;
                        for r in from(row)..=to(row, rows) {
                            for c in from(column)..=to(column, columns) {
                                let h = heights[r * columns + c];
                                expected = expected.union(Bounds { low: h, high: h });
                            }
                        }
                        prop_assert_eq!(pyramid.block(level, column, row), expected);
                    }
                }
            }
        }
    }
}
