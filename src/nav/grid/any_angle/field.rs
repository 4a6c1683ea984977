//! A grid prepared for lines of sight: free cells in rows, and the corners on the lines between them.

use crate::world::{BitGrid, GridCell};

/// Free cells and corners of a grid, as bits.
///
/// A *corner* is a grid point with exactly one blocked cell among the four around it; shortest paths turn
/// only there. Corners of a blocked cell on the *falling* diagonal (upper left or lower right, rows counted
/// downwards) bend only rising paths, the others only falling paths.
#[derive(Debug, Clone)]
pub(in crate::nav::grid) struct Field {
    width: usize,
    height: usize,
    /// Number of words in a row or line.
    stride: usize,
    /// Rows of cells, column c at bit c + 1, with a blocked row before and after.
    free: Vec<u64>,
    /// Lines of points, x at bit x.
    lines: Vec<Line>,
    /// Number of corners before each word of a line.
    before: Vec<u32>,
}

/// 64 points of a line.
#[derive(Debug, Clone, Copy, Default)]
struct Line {
    /// Corners with the blocked cell on the falling diagonal.
    falling: u64,
    /// Corners with the blocked cell on the rising diagonal.
    rising: u64,
    /// Points at which a path along the line ends, coming from lower x.
    end_right: u64,
    /// The same from higher x.
    end_left: u64,
}

/// A corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Corner {
    pub(super) x: i32,
    pub(super) y: i32,
    /// Direction of its blocked cell, (±1, ±1).
    pub(super) blocked: (i8, i8),
}

impl Corner {
    /// Whether the blocked cell lies on the falling diagonal.
    pub(super) fn is_falling(&self) -> bool {
        self.blocked.0 == self.blocked.1
    }
}

impl Field {
    pub(in crate::nav::grid) fn new(grid: &BitGrid) -> Self {
        let (width, height) = (grid.width(), grid.height());
        let stride = (width + 2).div_ceil(64) + 1;
        let mut free = vec![0; stride * (height + 2)];
        for row in 0..height {
            let mut carry = 0;
            for (index, word) in free[(row + 1) * stride..][..stride].iter_mut().enumerate() {
                let cells = grid.row(row).get(index).copied().unwrap_or(0);
                *word = cells << 1 | carry;
                carry = cells >> 63;
            }
        }
        let mut field = Self { width, height, stride, free, lines: Vec::new(), before: Vec::new() };
        let mut count = 0;
        for y in 0..=height {
            for index in 0..stride {
                let line = field.line(y, index);
                field.lines.push(line);
                field.before.push(count);
                count += (line.falling | line.rising).count_ones();
            }
        }
        field
    }

    /// The points of a line, from the cells around each: those to the right of point x at bit x, and those to
    /// the left.
    fn line(&self, y: usize, index: usize) -> Line {
        let word = |row: usize, index: usize| {
            if index < self.stride { self.free[row * self.stride + index] } else { 0 }
        };
        let left_and_right = |row: usize| {
            let left = word(row, index);
            (left, left >> 1 | word(row, index + 1) << 63)
        };
        let ((nw, ne), (sw, se)) = (left_and_right(y), left_and_right(y + 1));
        let falling = (!nw & ne & sw & se) | (nw & ne & sw & !se);
        let rising = (nw & !ne & sw & se) | (nw & ne & !sw & se);
        let diagonal = (nw & se & !ne & !sw) | (ne & sw & !nw & !se);
        let ends = falling | rising | diagonal;
        Line { falling, rising, end_right: ends | !(ne | se), end_left: ends | !(nw | sw) }
    }

    pub(super) fn height(&self) -> usize {
        self.height
    }

    #[inline]
    pub(super) fn is_free(&self, column: i32, row: i32) -> bool {
        let inside =
            column >= 0 && row >= 0 && (column as usize) < self.width && (row as usize) < self.height;
        inside && self.bit(row as usize + 1, column as usize + 1)
    }

    fn bit(&self, line: usize, at: usize) -> bool {
        self.free[line * self.stride + at / 64] >> (at % 64) & 1 != 0
    }

    /// The first free column at or after `column`.
    #[inline]
    pub(super) fn next_free(&self, row: i32, column: i32) -> i32 {
        self.next(row, column, 0)
    }

    /// The first blocked column at or after `column`.
    #[inline]
    pub(super) fn next_blocked(&self, row: i32, column: i32) -> i32 {
        self.next(row, column, u64::MAX)
    }

    /// The first column at or after `column` whose bit is set once the word is flipped; past the row if there
    /// is none.
    #[inline]
    fn next(&self, row: i32, column: i32, flip: u64) -> i32 {
        let line = (row + 1) as usize * self.stride;
        let first = (column + 1) as usize;
        let mut index = first / 64;
        let mut word = (self.free[line + index] ^ flip) & (u64::MAX << (first % 64));
        while word == 0 {
            index += 1;
            if index == self.stride {
                return self.width as i32 + 1;
            }
            word = self.free[line + index] ^ flip;
        }
        (64 * index) as i32 + word.trailing_zeros() as i32 - 1
    }

    /// The last blocked column at or before `column`, at least -1.
    #[inline]
    pub(super) fn last_blocked(&self, row: i32, column: i32) -> i32 {
        let line = (row + 1) as usize * self.stride;
        let first = (column + 1) as usize;
        let mut index = first / 64;
        let mut word = !self.free[line + index] & (u64::MAX >> (63 - first % 64));
        while word == 0 {
            index -= 1;
            word = !self.free[line + index];
        }
        (64 * index) as i32 + 63 - word.leading_zeros() as i32 - 1
    }

    /// Calls `found` with the x of each corner of a kind on a line, from `first` to `last`.
    #[inline]
    pub(super) fn corners(&self, y: i32, first: i32, last: i32, falling: bool, mut found: impl FnMut(i32)) {
        if first > last {
            return;
        }
        let (first, last) = (first as usize, last as usize);
        for index in first / 64..=last / 64 {
            let line = &self.lines[y as usize * self.stride + index];
            let mut word = if falling { line.falling } else { line.rising };
            if index == first / 64 {
                word &= u64::MAX << (first % 64);
            }
            if index == last / 64 {
                word &= u64::MAX >> (63 - last % 64);
            }
            while word != 0 {
                found((64 * index) as i32 + word.trailing_zeros() as i32);
                word &= word - 1;
            }
        }
    }

    /// The nearest corner on a line to the right of a point, if the way along the line is free.
    pub(super) fn along_right(&self, x: i32, y: i32) -> Option<i32> {
        // The first cell beside the line must be free above or below.
        if !self.is_free(x, y - 1) && !self.is_free(x, y) {
            return None;
        }
        let first = (x + 1) as usize;
        let mut index = first / 64;
        let mut mask = u64::MAX << (first % 64);
        loop {
            let line = self.lines[y as usize * self.stride + index];
            let word = line.end_right & mask;
            if word != 0 {
                let bit = word.trailing_zeros();
                let is_corner = (line.falling | line.rising) >> bit & 1 != 0;
                return is_corner.then_some((64 * index) as i32 + bit as i32);
            }
            (index, mask) = (index + 1, u64::MAX);
        }
    }

    /// The same to the left.
    pub(super) fn along_left(&self, x: i32, y: i32) -> Option<i32> {
        if !self.is_free(x - 1, y - 1) && !self.is_free(x - 1, y) {
            return None;
        }
        let first = (x - 1) as usize;
        let mut index = first / 64;
        let mut mask = u64::MAX >> (63 - first % 64);
        loop {
            let line = self.lines[y as usize * self.stride + index];
            let word = line.end_left & mask;
            if word != 0 {
                let bit = word.ilog2();
                let is_corner = (line.falling | line.rising) >> bit & 1 != 0;
                return is_corner.then_some((64 * index) as i32 + bit as i32);
            }
            (index, mask) = (index - 1, u64::MAX);
        }
    }

    /// All corners, line by line; their indices are their numbers.
    pub(super) fn all_corners(&self) -> Vec<Corner> {
        let mut corners = Vec::new();
        for y in 0..=self.height as i32 {
            for index in 0..self.stride {
                let line = self.lines[y as usize * self.stride + index];
                let mut word = line.falling | line.rising;
                while word != 0 {
                    let x = (64 * index) as i32 + word.trailing_zeros() as i32;
                    word &= word - 1;
                    let sides = [(-1, -1), (1, -1), (-1, 1), (1, 1)];
                    let cell = |(dx, dy): (i8, i8)| (x + i32::from(dx - 1) / 2, y + i32::from(dy - 1) / 2);
                    let blocked = sides.into_iter().find(|&side| !self.is_free(cell(side).0, cell(side).1));
                    corners.push(Corner { x, y, blocked: blocked.unwrap_or((1, 1)) });
                }
            }
        }
        corners
    }

    /// Number of a corner.
    #[inline]
    pub(super) fn number(&self, x: i32, y: i32) -> u32 {
        let index = y as usize * self.stride + x as usize / 64;
        let line = self.lines[index];
        let below = (line.falling | line.rising) & ((1 << (x % 64)) - 1);
        self.before[index] + below.count_ones()
    }
}

/// A point in half cells: the centre of column c is at 2c + 1, the line before it at 2c.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::nav::grid) struct HalfPoint {
    pub(in crate::nav::grid) x: i32,
    pub(in crate::nav::grid) y: i32,
}

impl HalfPoint {
    pub(in crate::nav::grid) fn centre(cell: GridCell) -> Self {
        Self { x: 2 * cell.column as i32 + 1, y: 2 * cell.row as i32 + 1 }
    }

    pub(in crate::nav::grid) fn corner(x: i32, y: i32) -> Self {
        Self { x: 2 * x, y: 2 * y }
    }
}
