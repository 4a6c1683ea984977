//! EyeSim's mazes (`.maz`): walls drawn with `_` and `|`, two columns per cell.
//!
//! The character in column `i` (from 0) is at `x = (i + 1) / 2` cells from the left edge, rounded down.
//!
//! ```text
//!  _ _ _
//! |_   _|
//! | |_  |
//! |S|_ _|
//! 360
//! ```
//!
//! * `|` is a wall of one cell's height at `x`, usually in an even column. In an odd column, the place of a
//!   cell, it also counts: it closes that cell on the right.
//! * `_` in an odd column is a wall below the cell that ends at `x`; in the first line it is the upper edge
//!   of the maze.
//! * A letter is in the middle of the cell that ends at `x`, in an odd or even column. A capital also has a
//!   wall below it. `s` and `u` head up, `l` left, `d` down, `r` right; `o` is a golf ball, `x` a crate;
//!   other letters are places for simulation scripts. `.` and blanks are empty.
//! * The cell size in millimetres is a single number before or after the picture; default 360.
//! * The lower left corner of the picture is the origin. Empty lines, comments and lines that begin with
//!   anything but `|`, `_` or a blank are skipped.
//!
//! Walls have EyeSim's default thickness and height, independent of the cell size.
//!
//! ```
//! use roverlab::world::formats::maz;
//! let text = " _ _\n|S _|\n|_ _|\n360\n";
//! let maze: maz::MazGrid = maz::parse_maze(text, "small.maz")?.value;
//! assert_eq!((maze.columns(), maze.rows(), maze.cell), (2, 2, 0.36));
//! assert_eq!(maz::parse_maze(&maz::print(&maze), "again.maz")?.value, maze);
//! assert_eq!(maz::parse(text, "small.maz")?.value.walls, maze.to_world().walls);
//! # Ok::<(), roverlab::world::formats::FormatError>(())
//! ```

use std::sync::Arc;

use super::error::{FormatError, Location, Notes, Parsed};
use super::lexer::{self, shown};
use super::limits::{MAX_MAZE_CELLS, MAX_METRES};
use super::number::{self, MILLI, millimetres};
use super::source::check_length;
use crate::geometry::{Point, Pose, units};
use crate::world::{Object, ObjectKind, Place, Wall, World};

/// A maze file: a grid of cells with walls between them and letters in them.
///
/// Columns count from the left, rows from the bottom, both from 0.
#[derive(Debug, Clone, PartialEq)]
pub struct MazGrid {
    columns: usize,
    rows: usize,
    /// Cell size (m).
    pub cell: f64,
    /// `rows + 1` lines of `columns` walls, starting with the lower edge.
    horizontal: Vec<bool>,
    /// `rows` lines of `columns + 1` walls, starting with the left edge.
    vertical: Vec<bool>,
    letters: Vec<Option<char>>,
}

impl MazGrid {
    /// Default cell size (m).
    pub const DEFAULT_CELL: f64 = 0.360;

    /// A maze without walls, with at least one column; `None` above a million cells.
    pub fn new(columns: usize, rows: usize, cell: f64) -> Option<Self> {
        let (columns, lines) = (columns.max(1), rows.checked_add(1)?);
        let size = columns.checked_add(1)?.checked_mul(lines).filter(|&size| size <= MAX_MAZE_CELLS)?;
        Some(Self {
            columns,
            rows,
            cell,
            horizontal: vec![false; columns * lines],
            vertical: vec![false; size - columns - 1],
            letters: vec![None; columns * rows],
        })
    }

    /// Number of cells from left to right.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of cells from bottom to top.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Whether there is a wall below the cell at a column and row; row [`MazGrid::rows`] is the upper edge.
    /// There are no walls outside the maze.
    pub fn wall_below(&self, column: usize, row: usize) -> bool {
        column < self.columns && row <= self.rows && self.horizontal[row * self.columns + column]
    }

    /// Whether there is a wall to the left of the cell at a column and row; column [`MazGrid::columns`] is
    /// the right edge. There are no walls outside the maze.
    pub fn wall_left(&self, column: usize, row: usize) -> bool {
        column <= self.columns && row < self.rows && self.vertical[row * (self.columns + 1) + column]
    }

    /// Builds or removes the wall of [`MazGrid::wall_below`]; no effect outside the maze.
    pub fn set_wall_below(&mut self, column: usize, row: usize, wall: bool) {
        if column < self.columns && row <= self.rows {
            self.horizontal[row * self.columns + column] = wall;
        }
    }

    /// Builds or removes the wall of [`MazGrid::wall_left`]; no effect outside the maze.
    pub fn set_wall_left(&mut self, column: usize, row: usize, wall: bool) {
        if column <= self.columns && row < self.rows {
            self.vertical[row * (self.columns + 1) + column] = wall;
        }
    }

    /// Letter of a cell, in lower case.
    pub fn letter(&self, column: usize, row: usize) -> Option<char> {
        if column < self.columns && row < self.rows {
            self.letters.get(row * self.columns + column).copied().flatten()
        } else {
            None
        }
    }

    /// Sets the letter of a cell, in lower case. Anything but an ASCII letter empties it; no effect outside
    /// the maze.
    pub fn set_letter(&mut self, column: usize, row: usize, letter: Option<char>) {
        if column < self.columns && row < self.rows {
            let letter = letter.filter(char::is_ascii_alphabetic).map(|c| c.to_ascii_lowercase());
            self.letters[row * self.columns + column] = letter;
        }
    }

    /// The world of the maze. Collinear walls are joined.
    pub fn to_world(&self) -> World {
        let mut world = World::empty(self.columns as f64 * self.cell, self.rows as f64 * self.cell);
        for row in 0..=self.rows {
            let runs = runs(self.columns, |column| self.wall_below(column, row));
            world.walls.extend(runs.map(|(a, b)| Wall::new(self.corner(a, row), self.corner(b, row))));
        }
        for column in 0..=self.columns {
            let runs = runs(self.rows, |row| self.wall_left(column, row));
            world.walls.extend(runs.map(|(a, b)| Wall::new(self.corner(column, a), self.corner(column, b))));
        }
        self.furnish(&mut world);
        world
    }

    fn furnish(&self, world: &mut World) {
        let kind = |name| ObjectKind::predefined(name).map(Arc::new);
        let (golf, crates) = (kind("golf"), kind("crate"));
        // In the order of the picture: from the upper left corner.
        let cells = (0..self.rows).rev().flat_map(|row| (0..self.columns).map(move |column| (column, row)));
        for (column, row) in cells {
            let Some(letter) = self.letter(column, row) else { continue };
            let position = Point::new((column as f64 + 0.5) * self.cell, (row as f64 + 0.5) * self.cell);
            let kind = match letter {
                'o' => golf.clone(),
                'x' => crates.clone(),
                _ => None,
            };
            if let Some(kind) = kind {
                world.objects.push(Object::new(kind, Pose::new(position.x, position.y, 0.0)));
            } else {
                let written = if self.wall_below(column, row) { letter.to_ascii_uppercase() } else { letter };
                world.places.push(Place { letter: written, position, heading: heading(letter) });
            }
        }
        world.start = start(&world.places);
    }

    fn corner(&self, column: usize, row: usize) -> Point {
        Point::new(column as f64 * self.cell, row as f64 * self.cell)
    }
}

/// Maximal intervals `a..b` of `0..count` in which a condition holds.
fn runs(count: usize, holds: impl Fn(usize) -> bool) -> impl Iterator<Item = (usize, usize)> {
    let mut next = 0;
    std::iter::from_fn(move || {
        let first = (next..count).find(|&i| holds(i))?;
        let end = (first..count).find(|&i| !holds(i)).unwrap_or(count);
        next = end;
        Some((first, end))
    })
}

/// Heading of a start letter.
fn heading(letter: char) -> Option<f64> {
    let degrees = match letter.to_ascii_lowercase() {
        's' | 'u' => 90.0,
        'l' => 180.0,
        'd' => -90.0,
        'r' => 0.0,
        _ => return None,
    };
    Some(units::from_deg(degrees))
}

/// The first `s`, otherwise the first other letter with a heading.
fn start(places: &[Place]) -> Option<Pose> {
    let s = places.iter().find(|place| place.letter.eq_ignore_ascii_case(&'s'));
    let place = s.or_else(|| places.iter().find(|place| place.heading.is_some()))?;
    Some(Pose::new(place.position.x, place.position.y, place.heading?))
}

/// Reads a maze as a world: walls, start, places, balls and crates.
pub fn parse(text: &str, file: &str) -> Result<Parsed<World>, FormatError> {
    Ok(parse_maze(text, file)?.map(|maze| maze.to_world()))
}

/// Reads a maze as a grid.
pub fn parse_maze(text: &str, file: &str) -> Result<Parsed<MazGrid>, FormatError> {
    check_length(text, file)?;
    let mut picture = Picture { rows: Vec::new(), sizes: Vec::new(), notes: Notes::new(file) };
    lexer::numbered(text).try_for_each(|(number, line)| picture.line(number, line))?;
    picture.finish()
}

/// Classified lines of a maze file.
struct Picture<'a> {
    /// Line number and text of each row, uppermost first.
    rows: Vec<(usize, &'a str)>,
    /// Line number, number of preceding rows, and value of each cell size (m).
    sizes: Vec<(usize, usize, f64)>,
    notes: Notes<'a>,
}

impl<'a> Picture<'a> {
    fn line(&mut self, number: usize, text: &'a str) -> Result<(), FormatError> {
        let content = text.trim();
        let bare = content.split([';', '#']).next().unwrap_or("").trim_end();
        if text.is_empty() || (bare.is_empty() && !content.is_empty()) {
            return Ok(());
        }
        if number::looks_like_number(bare) {
            let size = cell_size(bare, self.notes.file, number, text)?;
            self.check_count(number, self.sizes.len())?;
            self.sizes.push((number, self.rows.len(), size));
        } else if text.starts_with(['|', '_']) || text.starts_with(char::is_whitespace) {
            self.check_count(number, self.rows.len())?;
            self.rows.push((number, text.trim_end()));
        } else {
            let message = format!("{} is no row of a maze; skipped", shown(content));
            self.notes.warn(Location { line: number, column: 1 }, message);
        }
        Ok(())
    }

    fn check_count(&self, line: usize, count: usize) -> Result<(), FormatError> {
        if count < MAX_MAZE_CELLS {
            return Ok(());
        }
        let expected = format!("at most {MAX_MAZE_CELLS} lines");
        Err(FormatError::new(self.notes.file, Location { line, column: 1 }, "one more line", expected))
    }

    fn finish(mut self) -> Result<Parsed<MazGrid>, FormatError> {
        let blank = |row: &(usize, &str)| row.1.is_empty();
        let first = self.rows.iter().position(|row| !blank(row));
        let Some(first) = first else {
            let (found, expected) = ("no row of a maze", "rows of `|`, `_`, letters and blanks");
            return Err(FormatError::new(self.notes.file, Location::START, found, expected));
        };
        let last = self.rows.iter().rposition(|row| !blank(row)).unwrap_or(first);
        let rows: Vec<_> = self.rows[first..=last].to_vec();
        let (line, cell) = self.choose_size(first, last).unwrap_or((rows[0].0, MazGrid::DEFAULT_CELL));
        let maze = self.draw(&rows, cell)?;
        self.check_extent(&maze, line)?;
        Ok(self.notes.finish(maze))
    }

    /// Line and value (m) of the effective cell size; `None` without one.
    fn choose_size(&mut self, first: usize, last: usize) -> Option<(usize, f64)> {
        let mut chosen = None;
        for &(line, before, size) in &self.sizes {
            let at = Location { line, column: 1 };
            if before > first && before <= last {
                self.notes.warn(at, "a number inside the picture; ignored");
                continue;
            }
            if chosen.is_some_and(|(_, other)| other != size) {
                self.notes.warn(at, "a second cell size; this one counts");
            }
            chosen = Some((line, size));
        }
        chosen
    }

    /// Checks that the world's coordinates can be written to other files. `line` is that of the cell size.
    fn check_extent(&self, maze: &MazGrid, line: usize) -> Result<(), FormatError> {
        let extent = maze.columns.max(maze.rows) as f64 * maze.cell;
        if extent <= MAX_METRES {
            return Ok(());
        }
        let (columns, rows, cell) = (maze.columns, maze.rows, units::to_mm(maze.cell));
        let found = format!("a maze of {columns} by {rows} cells of {cell} mm");
        let expected = format!("at most {} mm from edge to edge", units::to_mm(MAX_METRES));
        Err(FormatError::new(self.notes.file, Location { line, column: 1 }, found, expected))
    }

    fn draw(&mut self, rows: &[(usize, &str)], cell: f64) -> Result<MazGrid, FormatError> {
        // The uppermost line contains only the upper edge, unless a cell's character is in it.
        let roof = usize::from(!rows[0].1.contains(|c: char| c == '|' || c.is_alphabetic()));
        let count = rows.len() - roof;
        // The last character of a row is at, or begins at, half the row's length.
        let columns = rows.iter().map(|row| row.1.chars().count() / 2).max().unwrap_or(0);
        let mut maze = MazGrid::new(columns, count, cell).ok_or_else(|| {
            let found = format!("a maze of {columns} by {count} cells");
            let expected = format!("at most {MAX_MAZE_CELLS} cells");
            FormatError::new(self.notes.file, Location { line: rows[0].0, column: 1 }, found, expected)
        })?;
        for (index, &(number, text)) in rows.iter().enumerate() {
            let row = rows.len() - 1 - index;
            for (column, c) in text.chars().enumerate() {
                if !maze.draw(row, column, c) {
                    let at = Location { line: number, column: column + 1 };
                    self.notes.warn(at, format!("{} has no meaning here; ignored", shown(&c.to_string())));
                }
            }
        }
        Ok(maze)
    }
}

impl MazGrid {
    /// Adds a character of the picture. Returns whether it has a meaning in its column.
    fn draw(&mut self, row: usize, column: usize, c: char) -> bool {
        let edge = column.div_ceil(2);
        match (c, edge.checked_sub(1)) {
            ('|', _) => self.set_wall_left(edge, row, true),
            ('_', Some(cell)) if column % 2 == 1 => self.set_wall_below(cell, row, true),
            (c, Some(cell)) if c.is_ascii_alphabetic() => {
                self.set_letter(cell, row, Some(c));
                if c.is_ascii_uppercase() {
                    self.set_wall_below(cell, row, true);
                }
            }
            (' ' | '.' | '_', _) => {}
            _ => return false,
        }
        true
    }

    fn print_row(&self, row: usize) -> String {
        let in_cell = |column| match (self.letter(column, row), self.wall_below(column, row)) {
            (Some(letter), true) => letter.to_ascii_uppercase(),
            (Some(letter), false) => letter,
            (None, true) => '_',
            (None, false) => ' ',
        };
        let before = |column| if self.wall_left(column, row) { '|' } else { ' ' };
        let mut line: String =
            (0..self.columns).flat_map(|column| [before(column), in_cell(column)]).collect();
        line.push(before(self.columns));
        line
    }
}

fn cell_size(text: &str, file: &str, number: usize, line: &str) -> Result<f64, FormatError> {
    let indent = line.chars().take_while(|c| c.is_whitespace()).count();
    let error = |expected: &str| {
        let at = Location { line: number, column: indent + 1 };
        FormatError::new(file, at, shown(text), format!("the size of a cell in millimetres, {expected}"))
    };
    let size = number::parse(text, MILLI).ok_or_else(|| error("a single number"))?;
    if size > 0.0 && size <= MAX_METRES { Ok(size) } else { Err(error("more than 0 and at most 1000000000")) }
}

/// Writes a maze in a form that [`parse_maze`] reads back.
pub fn print(maze: &MazGrid) -> String {
    let mut lines: Vec<String> = (0..=maze.rows).rev().map(|row| maze.print_row(row)).collect();
    let width = 2 * maze.columns;
    if lines.iter().all(|line| line.trim_end().len() < width) {
        // The last column is empty; a dot preserves it.
        if let Some(last) = lines.last_mut() {
            last.replace_range(width - 1..width, ".");
        }
    }
    let mut text = String::new();
    for line in &lines {
        text.push_str(if line.trim().is_empty() { " ." } else { line.trim_end() });
        text.push('\n');
    }
    text + &millimetres(maze.cell) + "\n"
}

#[cfg(test)]
mod tests;
