//! Evaluation of distance readings from the centre of a cell.

use crate::geometry::math;
use crate::maze::{Cell, Direction, Maze, Scale, Unknown, WallState};

/// A reading in one direction from a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct View {
    pub(super) cell: Cell,
    pub(super) direction: Direction,
    /// Distance from the cell centre to the echo (m); infinite without one.
    pub(super) distance: f64,
    /// Maximum range, from the cell centre (m).
    pub(super) range: f64,
    /// Standard deviation of the sensor's heading (rad).
    pub(super) heading_deviation: f64,
}

/// Enters a reading into a maze without changing what is known. Returns the number of newly known walls.
///
/// A beam runs along the middle of a corridor until it hits a wall; the positions in between have no walls.
/// It counts only as far as it certainly stays in the corridor.
pub(super) fn enter(maze: &mut Maze, scale: Scale, view: &View) -> usize {
    let free = 0.5 * (scale.cell - scale.wall);
    // Farther on, the beam may have left the corridor.
    let sure = 0.2 * scale.cell / math::tan((3.0 * view.heading_deviation).clamp(1e-3, 0.5));
    let seen = view.distance.min(view.range);
    let walls = ((seen - free) / scale.cell).round().max(0.0);
    let off = (view.distance - free - walls * scale.cell).abs();
    let meets = view.distance <= view.range && off < 0.25 * scale.cell;
    let (mut cell, mut learnt) = (view.cell, 0);
    for passed in 0..=maze.width().max(maze.height()) {
        let place = free + passed as f64 * scale.cell;
        // The wall of the robot's own cell is always certain.
        if passed > 0 && place > sure {
            break;
        }
        let found = if passed as f64 == walls && meets {
            WallState::Present
        } else if seen > place + 0.4 * scale.cell {
            WallState::Absent
        } else {
            break;
        };
        if maze.wall(cell, view.direction) == WallState::Unknown {
            maze.set_wall(cell, view.direction, found);
            learnt += 1;
        }
        match maze.passage(cell, view.direction, Unknown::Closed) {
            Some(next) => cell = next,
            None => break,
        }
    }
    learnt
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCALE: Scale = Scale::MICROMOUSE;

    fn learn(distance: f64, heading_deviation: f64) -> (usize, Vec<WallState>) {
        let mut maze = Maze::unexplored(6, 1).unwrap();
        let (cell, direction) = (Cell::new(0, 0), Direction::East);
        let view = View { cell, direction, distance, range: 1.0, heading_deviation };
        let learnt = enter(&mut maze, SCALE, &view);
        (learnt, (0..5).map(|x| maze.wall(Cell::new(x, 0), direction)).collect())
    }

    #[test]
    fn a_wall_is_seen_from_some_cells_away() {
        use WallState::{Absent, Present, Unknown};
        assert_eq!(learn(0.084, 0.005), (1, vec![Present, Unknown, Unknown, Unknown, Unknown]));
        assert_eq!(learn(0.100, 0.005), (1, vec![Present, Unknown, Unknown, Unknown, Unknown]));
        assert_eq!(learn(0.264, 0.005), (2, vec![Absent, Present, Unknown, Unknown, Unknown]));
        assert_eq!(learn(0.624, 0.005), (4, vec![Absent, Absent, Absent, Present, Unknown]));
        assert_eq!(learn(f64::INFINITY, 0.005).1[..4], [Absent; 4]);
    }

    #[test]
    fn what_is_in_doubt_stays_unknown() {
        // Between two walls: another object.
        assert_eq!(learn(0.175, 0.005).1[1], WallState::Unknown);
        // A heading uncertainty of 10 degrees reveals only the next wall.
        assert_eq!(learn(0.624, 0.06).0, 1);
    }

    #[test]
    fn what_is_known_stays() {
        let mut maze = Maze::open(3, 1).unwrap();
        let view = View {
            cell: Cell::new(0, 0),
            direction: Direction::East,
            distance: 0.08,
            range: 1.0,
            heading_deviation: 0.01,
        };
        assert_eq!(enter(&mut maze, SCALE, &view), 0);
        assert_eq!(maze.wall(Cell::new(0, 0), Direction::East), WallState::Absent);
    }
}
