//! The binary files of the first collections: one byte per cell of a square, column by column from the left,
//! each from below, with bits for walls to the north, east, south and west.

use super::{MazeFile, MazeFormat};
use crate::maze::{Cell, Defect, Direction, Maze, WallState};

/// Whether the bytes are a maze: the number of cells of a known square, and wall bits only.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    side(bytes).is_some() && bytes.iter().all(|&byte| byte < 16) && bytes.iter().any(|&byte| byte > 0)
}

fn side(bytes: &[u8]) -> Option<usize> {
    [16, 32].into_iter().find(|side| side * side == bytes.len())
}

pub(super) fn read(bytes: &[u8]) -> MazeFile {
    let side = side(bytes).unwrap_or(1);
    let mut defects = Vec::new();
    // A side of 16 or 32 is valid.
    let mut maze = Maze::open(side, side).unwrap_or_else(|_| unreachable!("a square of known size"));
    for (index, &byte) in bytes.iter().enumerate() {
        let cell = Cell::new((index / side) as u16, (index % side) as u16);
        for direction in Direction::ALL {
            let wall = byte >> direction as u8 & 1 != 0;
            let backward = maze.neighbour(cell, direction).map(|other| {
                let byte = bytes[usize::from(other.x) * side + usize::from(other.y)];
                byte >> direction.opposite() as u8 & 1 != 0
            });
            if wall && backward == Some(false) {
                let message = format!(
                    "cell {cell} has a wall to the {direction} that its neighbour has not; taken as a wall"
                );
                defects.push(Defect::of_maze(message));
            }
            let present = wall || backward == Some(true);
            maze.set_wall(cell, direction, if present { WallState::Present } else { WallState::Absent });
        }
    }
    MazeFile { maze, format: MazeFormat::Binary, cell: None, defects }
}
