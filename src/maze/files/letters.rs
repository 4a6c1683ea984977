//! EyeSim's `.maz`, through the reader that simulated worlds use.

use super::{MazeFile, MazeFormat, size_error};
use crate::maze::{Cell, Defect, Direction, Maze, Wall};
use crate::world::formats::{FormatError, maz};

pub(super) fn read(text: &str, file: &str) -> Result<MazeFile, FormatError> {
    let parsed = maz::parse_maze(text, file)?;
    let warnings = parsed.warnings.into_iter();
    let mut defects: Vec<Defect> =
        warnings.map(|warning| Defect::at(warning.line, warning.message)).collect();
    let grid = parsed.value;
    let mut maze = Maze::open(grid.columns(), grid.rows()).map_err(|error| size_error(error, file, 1))?;
    enter_walls(&grid, &mut maze);
    match start(&grid, &maze) {
        Some((cell, heading)) => maze.set_start(cell, heading),
        None => defects.push(Defect::of_maze("no start is marked; the lower left cell is taken")),
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

fn enter_walls(grid: &maz::Maze, maze: &mut Maze) {
    let wall = |present| if present { Wall::Present } else { Wall::Absent };
    for cell in maze.cells() {
        let (x, y) = (usize::from(cell.x), usize::from(cell.y));
        maze.set_wall(cell, Direction::South, wall(grid.wall_below(x, y)));
        maze.set_wall(cell, Direction::West, wall(grid.wall_left(x, y)));
        maze.set_wall(cell, Direction::North, wall(grid.wall_below(x, y + 1)));
        maze.set_wall(cell, Direction::East, wall(grid.wall_left(x + 1, y)));
    }
}

/// The first `s` as the picture is read, or else the first other letter that stands for a heading.
fn start(grid: &maz::Maze, maze: &Maze) -> Option<(Cell, Direction)> {
    let (width, height) = (maze.width() as u16, maze.height() as u16);
    let cells = || (0..height).rev().flat_map(|y| (0..width).map(move |x| Cell::new(x, y)));
    let found = |wanted: fn(char) -> Option<Direction>| {
        cells().find_map(|cell| Some((cell, wanted(grid.letter(cell.x.into(), cell.y.into())?)?)))
    };
    found(|letter| (letter == 's').then_some(Direction::North)).or_else(|| {
        found(|letter| match letter {
            'u' => Some(Direction::North),
            'r' => Some(Direction::East),
            'd' => Some(Direction::South),
            'l' => Some(Direction::West),
            _ => None,
        })
    })
}

/// Writes a maze with cells of so many metres.
pub(super) fn print(maze: &Maze, cell_size: f64) -> String {
    let Some(mut grid) = maz::Maze::new(maze.width(), maze.height(), cell_size) else { return String::new() };
    let present = |cell, direction| maze.wall(cell, direction) == Wall::Present;
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
