//! Peers written in C: flood fill of mazes of 16 x 16 cells by repeated passes over all cells, as the book
//! describes it in section 9.6, and by a queue.

/// Cells in a row and in a column.
pub const SIDE: usize = 16;
/// Cells of a maze. They are counted row by row.
pub const CELLS: usize = SIDE * SIDE;

/// The walls below and to the left of each cell, and of one row and column more; 0 where there is none.
#[derive(Debug, Clone)]
#[repr(C)]
pub struct Walls {
    /// By row and column.
    pub below: [[i32; SIDE + 1]; SIDE + 1],
    /// By row and column.
    pub left: [[i32; SIDE + 1]; SIDE + 1],
}

unsafe extern "C" {
    fn roverlab_sweep(walls: *const Walls, start: i32, goal: i32, steps: *mut i32);
    fn roverlab_queue(open: *const u8, start: i32, steps: *mut i32);
}

/// Steps from a cell, by passes over all cells until the goal is reached; -1 where it has not come to.
///
/// # Panics
///
/// If a cell lies outside of the maze.
pub fn sweep(walls: &Walls, start: usize, goal: usize, steps: &mut [i32; CELLS]) {
    assert!(start < CELLS && goal < CELLS, "cells {start} and {goal} of {CELLS}");
    // SAFETY: the layout of `Walls` is that of the C structure; the function writes `CELLS` numbers, and
    // reads maps at the cells that have just been checked.
    unsafe { roverlab_sweep(walls, start as i32, goal as i32, steps.as_mut_ptr()) }
}

/// Steps from a cell by breadth-first search with a queue; -1 where no way leads.
///
/// # Panics
///
/// If the cell lies outside of the maze.
pub fn queue(open: &Openings, start: usize, steps: &mut [i32; CELLS]) {
    assert!(start < CELLS, "cell {start} of {CELLS}");
    // SAFETY: openings lead to cells of the maze, and each cell enters the queue once, so that neither it nor
    // `steps`, of `CELLS` each, is overrun.
    unsafe { roverlab_queue(open.0.as_ptr(), start as i32, steps.as_mut_ptr()) }
}

/// The open directions of all cells, none of them out of the maze.
#[derive(Debug, Clone)]
pub struct Openings([u8; CELLS]);

impl Openings {
    /// A bit for each open direction of a cell, north in the lowest, clockwise. Those that lead out of the
    /// maze are closed.
    pub fn new(mut open: [u8; CELLS]) -> Self {
        for (index, open) in open.iter_mut().enumerate() {
            let (column, row) = (index % SIDE, index / SIDE);
            let inside = [row + 1 < SIDE, column + 1 < SIDE, row > 0, column > 0];
            *open &= (0..4).fold(0, |bits, side| bits | u8::from(inside[side]) << side);
        }
        Self(open)
    }
}
