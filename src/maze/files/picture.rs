//! Drawings of mazes with a post at every corner: four columns and two lines per cell.
//!
//! ```text
//! o---o---o   +---+---+
//! |     G |   |   . G |
//! o   o---o   + . +---+
//! | S     |   | S     |
//! o---o---o   +---+---+
//! ```
//!
//! Text before and after the drawing, and to its right after a blank, is ignored. The walls of a missing line
//! are unknown.

use super::layout::{Layout, Line, is_post, shown};
use super::{MazeFile, MazeFormat, size_error};
use crate::maze::{Cell, Defect, Direction, Maze, WallState};
use crate::world::formats::{FormatError, Location};

/// Lines of a drawing: posts and cells alternate, uppermost first.
struct Picture<'a> {
    lines: Vec<Line<'a>>,
    width: usize,
    defects: Vec<Defect>,
}

pub(super) fn read(layout: Layout<'_>, file: &str) -> Result<MazeFile, FormatError> {
    let Layout { lines, width, post, defects, remarks } = layout;
    let top = lines.first().map_or(1, |line| line.number);
    let error = |found: &str, expected: &str| {
        Err(FormatError::new(file, Location { line: top, column: 1 }, found, expected))
    };
    let height = lines.len() / 2;
    if height == 0 {
        return error("one line of posts", "lines of cells and posts below it");
    }
    if remarks > MOST_REMARKS.max(4 * lines.len()) {
        let found = format!("a picture of {} lines among {remarks} of text", lines.len());
        return error(&found, "a file that is a maze");
    }
    let mut maze = Maze::open(width, height).map_err(|error| size_error(&error, file, top))?;
    let mut picture = Picture { lines, width, defects };
    let (mut starts, mut goals) = (Vec::new(), Vec::new());
    for index in 0..picture.lines.len() {
        picture.note_doubts(index);
        if index % 2 == 0 {
            picture.posts(index, &mut maze);
        } else {
            picture.cells(index, &mut maze, &mut starts, &mut goals);
        }
    }
    let format = match (post, starts.is_empty() && goals.is_empty() && maze.unknown_walls() == 0) {
        (b'+', true) => MazeFormat::Map,
        (b'+', false) => MazeFormat::Maze,
        _ => MazeFormat::Text,
    };
    if let [first, rest @ ..] = starts.as_slice() {
        maze.set_start(*first, Direction::North);
        let more = rest.iter().map(|cell| Defect::of_maze(format!("a second start at cell {cell}; ignored")));
        picture.defects.extend(more);
    }
    if !goals.is_empty() {
        maze.set_goals(goals);
    } else if format != MazeFormat::Map {
        picture.defects.push(Defect::of_maze("no goal is marked; the centre is taken"));
    }
    picture.defects.sort_by_key(|defect| defect.line.unwrap_or(usize::MAX));
    Ok(MazeFile { maze, format, cell: None, defects: picture.defects })
}

/// Number of other text lines allowed beside the smallest maze; text with more of them merely contains a
/// drawing.
const MOST_REMARKS: usize = 20;

impl Picture<'_> {
    /// A character; blank beyond the end of the line, `None` if the line is missing.
    fn at(&self, index: usize, column: usize) -> Option<u8> {
        self.lines[index].text.map(|text| text.get(column).copied().unwrap_or(b' '))
    }

    fn note(&mut self, index: usize, message: String) {
        self.defects.push(Defect::at(self.lines[index].number, message));
    }

    /// Reports ambiguities: tabs, and walls beyond the last column.
    fn note_doubts(&mut self, index: usize) {
        let end = 4 * self.width + 1;
        let Some(text) = self.lines[index].text else { return };
        if let Some(column) = text.iter().take(end).position(|&byte| byte == b'\t') {
            self.note(index, format!("a tab in column {}; taken as one blank", column + 1));
        }
        if text.get(end).is_some_and(|byte| !byte.is_ascii_whitespace()) {
            let rest = &text[end..text.len().min(end + 40)];
            self.note(index, format!("{} to the right of the maze; ignored", shown(rest)));
        }
    }

    /// Stores the walls between the posts of a line.
    fn posts(&mut self, index: usize, maze: &mut Maze) {
        for x in 0..=self.width {
            if let Some(post) = self.at(index, 4 * x).filter(|&post| !is_post(post)) {
                self.note(index, format!("{} instead of a post in column {}", shown(&[post]), 4 * x + 1));
            }
        }
        for x in 0..self.width {
            let marks = [1, 2, 3].map(|i| self.at(index, 4 * x + i).unwrap_or(b'.'));
            let wall = match &marks {
                b"---" => WallState::Present,
                b"   " => WallState::Absent,
                b" . " | b"..." => WallState::Unknown,
                other => {
                    self.note(
                        index,
                        format!("{} instead of a wall in column {}; taken as one", shown(other), 4 * x + 2),
                    );
                    WallState::Present
                }
            };
            // The top line is above the uppermost row, any other line below a row.
            let (cell, side) = match index {
                0 => (self.cell(x, 1), Direction::North),
                _ => (self.cell(x, index - 1), Direction::South),
            };
            maze.set_wall(cell, side, wall);
        }
    }

    /// Stores the walls beside cells, and the marks in the cells.
    fn cells(&mut self, index: usize, maze: &mut Maze, starts: &mut Vec<Cell>, goals: &mut Vec<Cell>) {
        for x in 0..=self.width {
            let mark = self.at(index, 4 * x).unwrap_or(b'.');
            let wall = match mark {
                b'|' => WallState::Present,
                b' ' | b'\t' => WallState::Absent,
                b'.' => WallState::Unknown,
                other => {
                    self.note(
                        index,
                        format!(
                            "{} instead of a wall in column {}; taken as one",
                            shown(&[other]),
                            4 * x + 1
                        ),
                    );
                    WallState::Present
                }
            };
            match x.checked_sub(1) {
                Some(left) => maze.set_wall(self.cell(left, index), Direction::East, wall),
                None => maze.set_wall(self.cell(x, index), Direction::West, wall),
            }
        }
        for x in 0..self.width {
            let marks = [1, 2, 3].map(|i| self.at(index, 4 * x + i).unwrap_or(b' '));
            let cell = self.cell(x, index);
            match marks.trim_ascii() {
                b"" => {}
                b"S" | b"s" => starts.push(cell),
                b"G" | b"g" => goals.push(cell),
                other => {
                    let message = format!("{} in cell {cell} has no meaning; ignored", shown(other));
                    self.note(index, message);
                }
            }
        }
    }

    /// The cell of a column and a line of cells.
    fn cell(&self, x: usize, index: usize) -> Cell {
        Cell::new(x as u16, (self.lines.len() / 2 - 1 - index / 2) as u16)
    }
}

/// Draws a maze. Without `marks`, start, goals and unknown walls are omitted.
pub(super) fn print(maze: &Maze, post: char, marks: bool) -> String {
    let mut text = String::new();
    for y in (0..maze.height() as u16).rev() {
        let row = |side| (0..maze.width() as u16).map(move |x| (Cell::new(x, y), side));
        if usize::from(y) + 1 == maze.height() {
            print_posts(&mut text, maze, post, marks, row(Direction::North));
        }
        for x in 0..maze.width() as u16 {
            let cell = Cell::new(x, y);
            text.push(beside(maze.wall(cell, Direction::West), marks));
            let mark = match cell {
                _ if !marks => ' ',
                // A goal at the start stays a goal: readers find the start without a mark, but not the goal.
                _ if maze.is_goal(cell) => 'G',
                _ if cell == maze.start() => 'S',
                _ => ' ',
            };
            text.extend([' ', mark, ' ']);
        }
        let last = Cell::new(maze.width() as u16 - 1, y);
        text.push(beside(maze.wall(last, Direction::East), marks));
        text.push('\n');
        print_posts(&mut text, maze, post, marks, row(Direction::South));
    }
    text
}

fn print_posts(
    text: &mut String,
    maze: &Maze,
    post: char,
    marks: bool,
    sides: impl Iterator<Item = (Cell, Direction)>,
) {
    for (cell, side) in sides {
        text.push(post);
        text.push_str(match maze.wall(cell, side) {
            WallState::Present => "---",
            WallState::Unknown if marks => " . ",
            _ => "   ",
        });
    }
    text.push(post);
    text.push('\n');
}

fn beside(wall: WallState, marks: bool) -> char {
    match wall {
        WallState::Present => '|',
        WallState::Unknown if marks => '.',
        _ => ' ',
    }
}
