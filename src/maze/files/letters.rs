//! EyeSim's `.maz`, read by the parser of simulated worlds.

use super::{MazeFile, MazeFormat, size_error};
use crate::maze::{Cell, Defect, Direction, Maze, WallState};
use crate::world::formats::{FormatError, Location, maz};

pub(super) fn read(text: &str, file: &str) -> Result<MazeFile, FormatError> {
    refuse_prose(text, file)?;
    let parsed = maz::parse_maze(text, file)?;
    let warnings = parsed.warnings.into_iter();
    let mut defects: Vec<Defect> =
        warnings.map(|warning| Defect::at(warning.line, warning.message)).collect();
    let grid = parsed.value;
    let mut maze = Maze::open(grid.columns(), grid.rows()).map_err(|error| size_error(&error, file, 1))?;
    enter_walls(&grid, &mut maze);
    match starts(&grid, &maze).as_slice() {
        [(cell, heading), rest @ ..] => {
            maze.set_start(*cell, *heading);
            let more =
                |(cell, _): &(Cell, _)| Defect::of_maze(format!("a second start at cell {cell}; ignored"));
            defects.extend(rest.iter().map(more));
        }
        [] => defects.push(Defect::of_maze("no start is marked; the lower left cell is taken")),
    }
    let letter = |cell: &Cell| grid.letter(cell.x.into(), cell.y.into());
    let goals: Vec<Cell> = maze.cells().filter(|cell| letter(cell) == Some('g')).collect();
    if goals.is_empty() {
        defects.push(Defect::of_maze("no goal is marked; the centre is taken"));
    } else {
        maze.set_goals(goals);
    }
    Ok(MazeFile { maze, format: MazeFormat::EyeSim, cell: Some(grid.cell), defects })
}

fn enter_walls(grid: &maz::MazGrid, maze: &mut Maze) {
    let wall = |present| if present { WallState::Present } else { WallState::Absent };
    for cell in maze.cells() {
        let (x, y) = (usize::from(cell.x), usize::from(cell.y));
        maze.set_wall(cell, Direction::South, wall(grid.wall_below(x, y)));
        maze.set_wall(cell, Direction::West, wall(grid.wall_left(x, y)));
        maze.set_wall(cell, Direction::North, wall(grid.wall_below(x, y + 1)));
        maze.set_wall(cell, Direction::East, wall(grid.wall_left(x + 1, y)));
    }
}

/// Rejects text with walls or letters in the wrong places, or without walls and the dots of open cells.
fn refuse_prose(text: &str, file: &str) -> Result<(), FormatError> {
    let is_row = |row: &str| row.starts_with(['|', '_']) || row.starts_with(char::is_whitespace);
    let rows = || text.lines().zip(1..).filter(|(row, _)| is_row(row));
    let marks =
        || rows().flat_map(|(row, _)| row.chars().enumerate()).filter(|(_, mark)| !mark.is_whitespace());
    let misplaced =
        |&(column, mark): &(usize, char)| !"_.".contains(mark) && (mark == '|') != (column % 2 == 0);
    let odd = marks().filter(misplaced).count();
    let drawn = marks().any(|(_, mark)| "|_.".contains(mark));
    match rows().find(|(row, _)| !row.trim().is_empty()) {
        Some((row, line)) if !drawn || 4 * odd > marks().count() => {
            let found: String = row.trim().chars().take(40).collect();
            let (found, expected) = (format!("{found:?}"), "rows of a maze of `|`, `_`, letters and blanks");
            Err(FormatError::new(file, Location { line, column: 1 }, found, expected))
        }
        _ => Ok(()),
    }
}

/// Cells with a start letter, the valid one first: the first `s` in reading order, otherwise the first other
/// letter.
fn starts(grid: &maz::MazGrid, maze: &Maze) -> Vec<(Cell, Direction)> {
    let (width, height) = (maze.width() as u16, maze.height() as u16);
    let cells = (0..height).rev().flat_map(|y| (0..width).map(move |x| Cell::new(x, y)));
    let mut found: Vec<(bool, Cell, Direction)> = cells
        .filter_map(|cell| {
            let letter = grid.letter(cell.x.into(), cell.y.into())?;
            let heading = match letter {
                's' | 'u' => Direction::North,
                'r' => Direction::East,
                'd' => Direction::South,
                'l' => Direction::West,
                _ => return None,
            };
            Some((letter != 's', cell, heading))
        })
        .collect();
    found.sort_by_key(|&(other, ..)| other);
    found.into_iter().map(|(_, cell, heading)| (cell, heading)).collect()
}

/// Writes a maze with a cell size (m).
pub(super) fn print(maze: &Maze, cell_size: f64) -> String {
    let Some(mut grid) = maz::MazGrid::new(maze.width(), maze.height(), cell_size) else {
        return String::new();
    };
    let present = |cell, direction| maze.wall(cell, direction) == WallState::Present;
    for cell in maze.cells() {
        let (x, y) = (usize::from(cell.x), usize::from(cell.y));
        grid.set_wall_below(x, y, present(cell, Direction::South));
        grid.set_wall_left(x, y, present(cell, Direction::West));
        grid.set_wall_below(x, y + 1, present(cell, Direction::North));
        grid.set_wall_left(x + 1, y, present(cell, Direction::East));
        if maze.is_goal(cell) {
            grid.set_letter(x, y, Some('g'));
        }
    }
    let start = match maze.heading() {
        Direction::North => 's',
        Direction::East => 'r',
        Direction::South => 'd',
        Direction::West => 'l',
    };
    grid.set_letter(maze.start().x.into(), maze.start().y.into(), Some(start));
    maz::print(&grid)
}
