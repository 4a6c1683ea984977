//! Scans along rows and columns, 64 cells at a time.

use crate::world::{BitGrid, GridCell};

/// 64 cells of a line.
#[derive(Debug, Clone, Copy, Default)]
struct Lane {
    free: u64,
    /// Cells at which an upward scan ends: blocked, or a jump point.
    up: u64,
    /// The same for downward scans.
    down: u64,
}

/// Lines of cells with a blocked border on all sides, so that no scan leaves them. Positions count from that
/// border.
#[derive(Debug, Clone)]
pub(super) struct Plane {
    stride: usize,
    lanes: Vec<Lane>,
}

impl Plane {
    fn new(grid: &BitGrid) -> Self {
        let stride = (grid.width() + 2).div_ceil(64);
        let mut plane = Self { stride, lanes: vec![Lane::default(); stride * (grid.height() + 2)] };
        for row in 0..grid.height() {
            let mut carry = 0;
            for (index, lane) in plane.lanes[(row + 1) * stride..][..stride].iter_mut().enumerate() {
                let word = grid.row(row).get(index).copied().unwrap_or(0);
                lane.free = word << 1 | carry;
                carry = word >> 63;
            }
        }
        for line in 0..grid.height() + 2 {
            plane.mark(line);
        }
        plane
    }

    /// Finds the cells of a line at which scans end.
    ///
    /// On an upward scan, a cell is a jump point if a wall beside it has just ended: the cell beside it is
    /// free, and the one before that is not.
    fn mark(&mut self, line: usize) {
        for index in 0..self.stride {
            let free = self.free_word(line, index);
            let (mut up, mut down) = (0, 0);
            for side in [line.wrapping_sub(1), line + 1] {
                let beside = self.free_word(side, index);
                let before = beside << 1 | self.free_word_at(side, index, -1) >> 63;
                let after = beside >> 1 | self.free_word_at(side, index, 1) << 63;
                up |= beside & !before;
                down |= beside & !after;
            }
            let lane = &mut self.lanes[line * self.stride + index];
            (lane.up, lane.down) = (up | !free, down | !free);
        }
    }

    fn free_word(&self, line: usize, index: usize) -> u64 {
        self.free_word_at(line, index, 0)
    }

    /// The free cells of an adjacent word; none outside.
    fn free_word_at(&self, line: usize, index: usize, beside: isize) -> u64 {
        let index = index.wrapping_add_signed(beside);
        if index >= self.stride || line >= self.lanes.len() / self.stride {
            return 0;
        }
        self.lanes[line * self.stride + index].free
    }

    /// The jump points of a word that scans along its line reach: those with a free cell before them.
    fn jump_points(&self, line: usize, index: usize) -> u64 {
        let Lane { free, up, down } = self.lanes[line * self.stride + index];
        let below = free << 1 | self.free_word_at(line, index, -1) >> 63;
        let above = free >> 1 | self.free_word_at(line, index, 1) << 63;
        free & ((up & below) | (down & above))
    }

    #[inline]
    pub(super) fn is_free(&self, line: usize, at: usize) -> bool {
        self.lanes[line * self.stride + at / 64].free >> (at % 64) & 1 != 0
    }

    /// The end of an upward scan from a position, and whether it is a jump point rather than blocked.
    #[inline]
    pub(super) fn scan_up(&self, line: usize, from: usize) -> (usize, bool) {
        let first = from + 1;
        let mut index = line * self.stride + first / 64;
        let lane = &self.lanes[index];
        let word = lane.up >> (first % 64);
        if word != 0 {
            let at = first + word.trailing_zeros() as usize;
            return (at, lane.free >> (at % 64) & 1 != 0);
        }
        loop {
            index += 1;
            let lane = &self.lanes[index];
            if lane.up != 0 {
                let bit = lane.up.trailing_zeros();
                return ((index - line * self.stride) * 64 + bit as usize, lane.free >> bit & 1 != 0);
            }
        }
    }

    /// The end of a downward scan from a position, and whether it is a jump point rather than blocked.
    #[inline]
    pub(super) fn scan_down(&self, line: usize, from: usize) -> (usize, bool) {
        let first = from - 1;
        let mut index = line * self.stride + first / 64;
        let lane = &self.lanes[index];
        let word = lane.down << (63 - first % 64);
        if word != 0 {
            let at = first - word.leading_zeros() as usize;
            return (at, lane.free >> (at % 64) & 1 != 0);
        }
        loop {
            index -= 1;
            let lane = &self.lanes[index];
            if lane.down != 0 {
                let bit = lane.down.ilog2();
                return ((index - line * self.stride) * 64 + bit as usize, lane.free >> bit & 1 != 0);
            }
        }
    }

    /// The free stretch of a line around a cell: its first and its last position.
    fn stretch(&self, line: usize, at: usize) -> (usize, usize) {
        let (mut first, mut last) = (at, at);
        while self.is_free(line, first - 1) {
            first -= 1;
        }
        while self.is_free(line, last + 1) {
            last += 1;
        }
        (first, last)
    }

    fn set_free(&mut self, line: usize, at: usize, free: bool) {
        let word = &mut self.lanes[line * self.stride + at / 64].free;
        *word = if free { *word | 1 << (at % 64) } else { *word & !(1 << (at % 64)) };
        for line in line - 1..=line + 1 {
            self.mark(line);
        }
    }
}

/// A direction: 0 north (the row before), 2 east, 4 south, 6 west, and the diagonals between them.
pub(super) type Direction = usize;

/// The end of a jump. Columns and rows count from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Landing {
    pub(super) x: usize,
    pub(super) y: usize,
    /// Straight direction of the jump's end.
    pub(super) direction: Direction,
}

/// A grid by rows and by columns, ready for scanning.
#[derive(Debug, Clone)]
pub(super) struct Planes {
    rows: Plane,
    columns: Plane,
}

impl Planes {
    pub(super) fn new(grid: &BitGrid) -> Self {
        Self { rows: Plane::new(grid), columns: Plane::new(&grid.transposed()) }
    }

    #[inline]
    pub(super) fn is_free(&self, x: usize, y: usize) -> bool {
        self.rows.is_free(y, x)
    }

    pub(super) fn set_free(&mut self, cell: GridCell, free: bool) {
        self.rows.set_free(cell.row + 1, cell.column + 1, free);
        self.columns.set_free(cell.column + 1, cell.row + 1, free);
    }

    /// The directions to continue in from a jump point reached in a straight direction, as bits: straight on,
    /// and on each side where a wall has ended, sideways and diagonally.
    #[inline]
    pub(super) fn onward(&self, at: Landing) -> u8 {
        let (x, y) = (at.x, at.y);
        let ends = |beside: (usize, usize), behind: (usize, usize)| {
            u8::from(self.is_free(beside.0, beside.1) && !self.is_free(behind.0, behind.1))
        };
        match at.direction {
            0 => {
                let (left, right) = (ends((x - 1, y), (x - 1, y + 1)), ends((x + 1, y), (x + 1, y + 1)));
                1 | (right * 0b110) | (left * 0b1100_0000)
            }
            2 => {
                let (left, right) = (ends((x, y - 1), (x - 1, y - 1)), ends((x, y + 1), (x - 1, y + 1)));
                0b100 | (left * 0b11) | (right * 0b1_1000)
            }
            4 => {
                let (left, right) = (ends((x + 1, y), (x + 1, y - 1)), ends((x - 1, y), (x - 1, y - 1)));
                0b1_0000 | (left * 0b1100) | (right * 0b110_0000)
            }
            _ => {
                let (left, right) = (ends((x, y + 1), (x + 1, y + 1)), ends((x, y - 1), (x + 1, y - 1)));
                0b100_0000 | (left * 0b11_0000) | (right * 0b1000_0001)
            }
        }
    }

    /// Calls `land` with the jump points at which jumps from a cell in some directions end. Returns the
    /// number of scans.
    #[inline]
    pub(super) fn jumps(&self, x: usize, y: usize, directions: u8, mut land: impl FnMut(Landing)) -> usize {
        let mut scans = (directions & 0b101_0101).count_ones() as usize;
        for direction in [0, 2, 4, 6] {
            if directions >> direction & 1 != 0 {
                self.straight(x, y, direction, &mut land);
            }
        }
        if directions >> 1 & 1 != 0 {
            scans += self.diagonal::<true, false>(x, y, &mut land);
        }
        if directions >> 3 & 1 != 0 {
            scans += self.diagonal::<true, true>(x, y, &mut land);
        }
        if directions >> 5 & 1 != 0 {
            scans += self.diagonal::<false, true>(x, y, &mut land);
        }
        if directions >> 7 != 0 {
            scans += self.diagonal::<false, false>(x, y, &mut land);
        }
        scans
    }

    #[inline]
    fn straight(&self, x: usize, y: usize, direction: Direction, land: &mut impl FnMut(Landing)) {
        let (at, is_jump) = match direction {
            0 => self.columns.scan_down(x, y),
            2 => self.rows.scan_up(y, x),
            4 => self.columns.scan_up(x, y),
            _ => self.rows.scan_down(y, x),
        };
        if is_jump {
            let vertical = direction & 2 == 0;
            land(if vertical { Landing { x, y: at, direction } } else { Landing { x: at, y, direction } });
        }
    }

    /// Follows a diagonal. Its own cells are not reported; the ends of straight jumps from them are. Returns
    /// the number of scans.
    #[inline]
    fn diagonal<const EAST: bool, const SOUTH: bool>(
        &self,
        mut x: usize,
        mut y: usize,
        land: &mut impl FnMut(Landing),
    ) -> usize {
        let mut scans = 0;
        loop {
            let next_x = if EAST { x + 1 } else { x - 1 };
            let next_y = if SOUTH { y + 1 } else { y - 1 };
            let open = self.rows.is_free(y, next_x)
                && self.rows.is_free(next_y, x)
                && self.rows.is_free(next_y, next_x);
            if !open {
                return scans;
            }
            (x, y) = (next_x, next_y);
            scans += 2;
            self.straight(x, y, if EAST { 2 } else { 6 }, land);
            self.straight(x, y, if SOUTH { 4 } else { 0 }, land);
        }
    }

    /// Prepares the test for paths that lead to a cell diagonally first, then straight.
    pub(super) fn target(&self, x: usize, y: usize) -> Target {
        Target { x, y, row: self.rows.stretch(y, x), column: self.columns.stretch(x, y) }
    }

    /// Whether such a path leads from a cell to the goal.
    #[inline]
    pub(super) fn sees(&self, x: usize, y: usize, goal: &Target) -> bool {
        let (across, along) = (x.abs_diff(goal.x), y.abs_diff(goal.y));
        let steps = across.min(along);
        let (east, south) = (goal.x > x, goal.y > y);
        let forward = |from: usize, up: bool| if up { from + steps } else { from - steps };
        let straight_is_free = if across > along {
            let turn = forward(x, east);
            goal.row.0 <= turn && turn <= goal.row.1
        } else {
            let turn = forward(y, south);
            goal.column.0 <= turn && turn <= goal.column.1
        };
        straight_is_free && self.diagonal_is_free(x, y, east, south, steps)
    }

    fn diagonal_is_free(&self, mut x: usize, mut y: usize, east: bool, south: bool, steps: usize) -> bool {
        (0..steps).all(|_| {
            let next_x = if east { x + 1 } else { x - 1 };
            let next_y = if south { y + 1 } else { y - 1 };
            let open = self.rows.is_free(y, next_x)
                && self.rows.is_free(next_y, x)
                && self.rows.is_free(next_y, next_x);
            (x, y) = (next_x, next_y);
            open
        })
    }

    /// The jump points of a row, as words of bits including the border.
    pub(super) fn jump_points(&self, y: usize) -> Vec<u64> {
        let mut words: Vec<u64> =
            (0..self.rows.stride).map(|index| self.rows.jump_points(y, index)).collect();
        for (index, word) in words.iter_mut().enumerate() {
            for bit in 0..64 {
                let x = 64 * index + bit;
                if (x + 1) * self.columns.stride > self.columns.lanes.len() {
                    break;
                }
                *word |= self.columns.jump_points(x, y / 64) >> (y % 64) << 63 >> (63 - bit);
            }
        }
        words
    }
}

/// A goal, and the free stretches of its row and its column.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Target {
    pub(super) x: usize,
    pub(super) y: usize,
    row: (usize, usize),
    column: (usize, usize),
}
