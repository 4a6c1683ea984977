use std::fmt;

use super::flood::distances_from_start;
use super::{Cell, Direction, Maze, Unknown, WallState};

/// A defect of a maze or its file, and how it was handled.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Defect {
    /// Line of the file, from 1, if the defect belongs to one.
    pub line: Option<usize>,
    /// Description of the defect.
    pub message: String,
}

impl Defect {
    pub(super) fn at(line: usize, message: impl Into<String>) -> Self {
        Self { line: Some(line), message: message.into() }
    }

    pub(super) fn of_maze(message: impl Into<String>) -> Self {
        Self { line: None, message: message.into() }
    }
}

impl fmt::Display for Defect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(line) = self.line {
            write!(f, "line {line}: ")?;
        }
        f.write_str(&self.message)
    }
}

/// Defects that concern a robot: gaps in the outer wall, unknown walls, a missing or unreachable goal.
pub fn defects(maze: &Maze) -> Vec<Defect> {
    let mut list: Vec<Defect> = Direction::ALL.iter().filter_map(|&side| gaps(maze, side)).collect();
    let unknown = maze.unknown_walls();
    if unknown > 0 {
        list.push(Defect::of_maze(format!("{} unknown", counted(unknown, "wall is", "walls are"))));
    }
    let from_start = distances_from_start(maze, Unknown::Closed);
    if maze.goals().next().is_none() {
        list.push(Defect::of_maze("there is no goal"));
    } else if !maze.goals().any(|goal| from_start.get(goal).is_some()) {
        list.push(Defect::of_maze("the goal cannot be reached"));
    }
    list
}

fn gaps(maze: &Maze, side: Direction) -> Option<Defect> {
    let (right, top) = (maze.width() as u16 - 1, maze.height() as u16 - 1);
    let open = |cell: &Cell| maze.wall(*cell, side) == WallState::Absent;
    let edge: Vec<Cell> = match side {
        Direction::North => (0..=right).map(|x| Cell::new(x, top)).filter(open).collect(),
        Direction::South => (0..=right).map(|x| Cell::new(x, 0)).filter(open).collect(),
        Direction::East => (0..=top).map(|y| Cell::new(right, y)).filter(open).collect(),
        Direction::West => (0..=top).map(|y| Cell::new(0, y)).filter(open).collect(),
    };
    let first = edge.first()?;
    let gaps = counted(edge.len(), "gap", "gaps");
    Some(Defect::of_maze(format!("the outer wall has {gaps} to the {side}, the first at cell {first}")))
}

fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sound_maze_has_no_defects() {
        assert_eq!(defects(&Maze::open(5, 4).unwrap()), []);
    }

    #[test]
    fn each_defect_is_named() {
        let mut maze = Maze::open(5, 5).unwrap();
        maze.set_wall(Cell::new(2, 4), Direction::North, WallState::Absent);
        maze.set_wall(Cell::new(0, 0), Direction::East, WallState::Unknown);
        maze.set_wall(Cell::new(0, 0), Direction::North, WallState::Present);
        let texts: Vec<String> = defects(&maze).iter().map(ToString::to_string).collect();
        assert_eq!(
            texts,
            [
                "the outer wall has 1 gap to the north, the first at cell 2,4",
                "1 wall is unknown",
                "the goal cannot be reached"
            ]
        );
        maze.set_goals([]);
        assert_eq!(defects(&maze).last().unwrap().message, "there is no goal");
    }
}
