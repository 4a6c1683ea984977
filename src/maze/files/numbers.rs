//! mms's `num`: one line `X Y N E S W` per cell, with 1 for a wall.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::{MazeFile, MazeFormat, size_error};
use crate::maze::{Cell, Defect, Direction, Maze, WallState};
use crate::world::formats::{FormatError, Location};

/// Whether most non-blank lines describe cells.
pub(super) fn is_list(lines: &[&str]) -> bool {
    let said = lines.iter().filter(|line| !line.trim().is_empty());
    let cells = said.clone().filter(|line| numbers(line).is_some()).count();
    2 * cells > said.count()
}

/// The six numbers of a line.
fn numbers(line: &str) -> Option<[i64; 6]> {
    let words: Option<Vec<i64>> = line.split_whitespace().map(|word| word.parse().ok()).collect();
    words?.try_into().ok()
}

/// The line of a cell.
struct Entry {
    line: usize,
    /// Walls to the north, east, south and west.
    walls: [bool; 4],
}

pub(super) fn read(lines: &[&str], file: &str) -> Result<MazeFile, FormatError> {
    let mut defects = Vec::new();
    let entries = entries(lines, file, &mut defects)?;
    let width = entries.keys().map(|cell| usize::from(cell.x) + 1).max().unwrap_or(0);
    let height = entries.keys().map(|cell| usize::from(cell.y) + 1).max().unwrap_or(0);
    let mut maze =
        Maze::filled(width, height, WallState::Unknown).map_err(|error| size_error(&error, file, 1))?;
    let missing: Vec<Cell> = maze.cells().filter(|cell| !entries.contains_key(cell)).collect();
    if let Some(first) = missing.first() {
        let message =
            format!("{} of {} cells have no line, the first is {first}", missing.len(), maze.cell_count());
        defects.push(Defect::of_maze(message));
    }
    for (&cell, entry) in &entries {
        for direction in Direction::ALL {
            let wall = entry.walls[direction as usize];
            let other = maze.neighbour(cell, direction).and_then(|other| entries.get(&other));
            let back = other.map(|other| other.walls[direction.opposite() as usize]);
            if wall && back == Some(false) {
                let message = format!(
                    "cell {cell} has a wall to the {direction} that its neighbour has not; taken as a wall"
                );
                defects.push(Defect::at(entry.line, message));
            }
            let present = wall || back == Some(true);
            maze.set_wall(cell, direction, if present { WallState::Present } else { WallState::Absent });
        }
    }
    Ok(MazeFile { maze, format: MazeFormat::Num, cell: None, defects })
}

fn entries(
    lines: &[&str],
    file: &str,
    defects: &mut Vec<Defect>,
) -> Result<BTreeMap<Cell, Entry>, FormatError> {
    let mut entries = BTreeMap::new();
    for (line, text) in (1..).zip(lines) {
        if text.trim().is_empty() {
            continue;
        }
        let Some([x, y, walls @ ..]) = numbers(text) else {
            defects.push(Defect::at(line, format!("{:?} is no line of a cell; ignored", text.trim())));
            continue;
        };
        let side = 0..Maze::MAX_SIDE as i64;
        if !(side.contains(&x) && side.contains(&y)) {
            let found = format!("cell {x},{y}");
            return Err(FormatError::new(
                file,
                Location { line, column: 1 },
                found,
                "columns and rows from 0 to 255",
            ));
        }
        if let Some(odd) = walls.iter().find(|&&wall| !(0..=1).contains(&wall)) {
            defects.push(Defect::at(line, format!("{odd} instead of 0 or 1; taken as a wall")));
        }
        let cell = Cell::new(x as u16, y as u16);
        if entries.insert(cell, Entry { line, walls: walls.map(|wall| wall != 0) }).is_some() {
            defects.push(Defect::at(line, format!("another line for cell {cell}; this one counts")));
        }
    }
    Ok(entries)
}

pub(super) fn print(maze: &Maze) -> String {
    let mut text = String::new();
    for x in 0..maze.width() as u16 {
        for y in 0..maze.height() as u16 {
            let cell = Cell::new(x, y);
            let walls = Direction::ALL.map(|side| u8::from(maze.wall(cell, side) == WallState::Present));
            let [north, east, south, west] = walls;
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{x} {y} {north} {east} {south} {west}");
        }
    }
    text
}
