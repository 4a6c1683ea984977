/// A bit matrix; each row starts at a new word.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct BitGrid {
    columns: usize,
    words_per_row: usize,
    words: Vec<u64>,
}

impl BitGrid {
    pub(super) fn new(columns: usize, rows: usize) -> Self {
        let words_per_row = columns.div_ceil(64);
        Self { columns, words_per_row, words: vec![0; words_per_row * rows] }
    }

    #[inline]
    pub(super) fn get(&self, column: usize, row: usize) -> bool {
        debug_assert!(column < self.columns);
        self.words[row * self.words_per_row + column / 64] >> (column % 64) & 1 != 0
    }

    #[inline]
    pub(super) fn set(&mut self, column: usize, row: usize, bit: bool) {
        debug_assert!(column < self.columns);
        let word = &mut self.words[row * self.words_per_row + column / 64];
        let mask = 1 << (column % 64);
        *word = if bit { *word | mask } else { *word & !mask };
    }

    /// First 64 columns of a row.
    #[inline]
    pub(super) fn row(&self, row: usize) -> u64 {
        self.words[row * self.words_per_row]
    }

    pub(super) fn count(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    pub(super) fn clear(&mut self) {
        self.words.fill(0);
    }

    /// Columns and rows of the set bits, row by row.
    pub(super) fn ones(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.words.iter().enumerate().flat_map(move |(index, &word)| {
            let (row, first) = (index / self.words_per_row, index % self.words_per_row * 64);
            Ones(word).map(move |bit| (first + bit, row))
        })
    }
}

/// Positions of the set bits of a word, lowest first.
struct Ones(u64);

impl Iterator for Ones {
    type Item = usize;

    fn next(&mut self) -> Option<usize> {
        let place = self.0.trailing_zeros() as usize;
        self.0 &= self.0.wrapping_sub(1);
        (place < 64).then_some(place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_come_back_where_they_were_set() {
        let mut grid = BitGrid::new(130, 3);
        let places = [(0, 0), (63, 0), (64, 0), (129, 0), (5, 1), (127, 2), (128, 2)];
        for (column, row) in places {
            grid.set(column, row, true);
        }
        assert_eq!(grid.ones().collect::<Vec<_>>(), places);
        assert_eq!(grid.count(), places.len());
        grid.set(64, 0, false);
        assert!(!grid.get(64, 0) && grid.get(63, 0));
        grid.clear();
        assert_eq!(grid.count(), 0);
    }
}
