use std::f64::consts::FRAC_PI_2;
use std::fmt;

/// One of the four directions, clockwise from north. North is up in files and along y in worlds.
///
/// ```
/// use roverlab::maze::Direction;
/// assert_eq!(Direction::North.left(), Direction::West);
/// assert_eq!(Direction::East.opposite().step(), (-1, 0), "a cell to the west");
/// assert_eq!(Direction::nearest(1.4), Direction::North, "radians counter-clockwise from east");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum Direction {
    /// Up, along y.
    #[default]
    North,
    /// Right, along x.
    East,
    /// Down.
    South,
    /// Left.
    West,
}

impl Direction {
    /// All directions, clockwise from north.
    pub const ALL: [Self; 4] = [Self::North, Self::East, Self::South, Self::West];

    /// The direction after a number of quarter turns to the right.
    #[must_use]
    pub const fn turned_right(self, quarters: usize) -> Self {
        Self::ALL[(self as usize + quarters % 4) % 4]
    }

    /// A quarter turn to the right.
    #[must_use]
    pub const fn right(self) -> Self {
        self.turned_right(1)
    }

    /// A quarter turn to the left.
    #[must_use]
    pub const fn left(self) -> Self {
        self.turned_right(3)
    }

    /// A half turn.
    #[must_use]
    pub const fn opposite(self) -> Self {
        self.turned_right(2)
    }

    /// Number of quarter turns to the right from this direction to another, 0 to 3.
    pub const fn quarters_to(self, other: Self) -> usize {
        (other as usize + 4 - self as usize) % 4
    }

    /// Cell offset of one step: right and up.
    pub const fn step(self) -> (i32, i32) {
        match self {
            Self::North => (0, 1),
            Self::East => (1, 0),
            Self::South => (0, -1),
            Self::West => (-1, 0),
        }
    }

    /// Heading, counter-clockwise from x (rad).
    pub const fn heading(self) -> f64 {
        match self {
            Self::North => FRAC_PI_2,
            Self::East => 0.0,
            Self::South => -FRAC_PI_2,
            Self::West => std::f64::consts::PI,
        }
    }

    /// The direction closest to a heading (rad).
    pub fn nearest(heading: f64) -> Self {
        let quarters = (crate::geometry::normalize_angle(heading) / FRAC_PI_2).round() as i32;
        Self::East.turned_right((4 - quarters).rem_euclid(4) as usize)
    }

    /// `n`, `e`, `s` or `w`.
    pub const fn letter(self) -> char {
        match self {
            Self::North => 'n',
            Self::East => 'e',
            Self::South => 's',
            Self::West => 'w',
        }
    }
}

impl fmt::Display for Direction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::North => "north",
            Self::East => "east",
            Self::South => "south",
            Self::West => "west",
        })
    }
}

/// A cell, by column from the left and row from below, both from 0.
///
/// ```
/// use roverlab::maze::{Cell, Direction, Maze};
/// let maze = Maze::open(3, 2)?;
/// let corner = Cell::new(2, 1);
/// assert_eq!(maze.neighbour(corner, Direction::South), Some(Cell::new(2, 0)));
/// assert_eq!(maze.neighbour(corner, Direction::East), None);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Cell {
    /// Column.
    pub x: u16,
    /// Row.
    pub y: u16,
}

impl Cell {
    /// A cell by column and row.
    pub const fn new(x: u16, y: u16) -> Self {
        Self { x, y }
    }
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{}", self.x, self.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_go_round() {
        for direction in Direction::ALL {
            assert_eq!(direction.left().right(), direction);
            assert_eq!(direction.opposite().opposite(), direction);
            assert_eq!(Direction::nearest(direction.heading() + 0.7), direction);
            assert_eq!(Direction::nearest(direction.heading() - 0.7), direction);
            for other in Direction::ALL {
                assert_eq!(direction.turned_right(direction.quarters_to(other)), other);
            }
        }
        assert_eq!(Direction::North.right(), Direction::East);
    }
}
