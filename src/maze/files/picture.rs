//! Pictures of mazes with a post at every corner: four columns and two lines for each cell.
//!
//! ```text
//! o---o---o   +---+---+
//! |     G |   |   . G |
//! o   o---o   + . +---+
//! | S     |   | S     |
//! o---o---o   +---+---+
//! ```
//!
//! Text before and after the picture, and to the right of it, is ignored.

use super::{MazeFile, MazeFormat, size_error};
use crate::maze::{Cell, Defect, Direction, Maze, Wall};
use crate::world::formats::{FormatError, Location};

/// Where a picture begins.
#[derive(Debug, Clone, Copy)]
pub(super) struct Top {
    /// The index of its first line.
    line: usize,
    /// Blanks to the left of it.
    indent: usize,
    /// Cells from left to right.
    width: usize,
    post: char,
}

/// Looks for the first line of a picture: posts four columns apart, and the walls between them.
pub(super) fn find(lines: &[&str]) -> Option<Top> {
    lines.iter().enumerate().find_map(|(line, text)| {
        let indent = text.len() - text.trim_start().len();
        let bytes = text.trim().as_bytes();
        let post = *bytes.first().filter(|byte| b"oO+*".contains(byte))?;
        let posts = bytes.iter().step_by(4).take_while(|&&byte| byte == post).count();
        // A post may be missing from a line of the right length.
        let whole = bytes.len() % 4 == 1 && 2 * posts > bytes.len() / 4;
        let width = if whole { bytes.len() / 4 } else { posts - 1 };
        let drawn = bytes.get(1..4).is_some_and(|wall| wall.iter().all(|byte| b"-_= .".contains(byte)));
        (width > 0 && drawn).then_some(Top { line, indent, width, post: char::from(post) })
    })
}

/// The lines of a picture: posts and cells by turns, uppermost first.
struct Picture<'a> {
    /// What is left of each line without the indentation.
    lines: Vec<&'a [u8]>,
    top: Top,
    defects: Vec<Defect>,
}

pub(super) fn read(lines: &[&str], top: Top, file: &str) -> Result<MazeFile, FormatError> {
    let mut picture = Picture { lines: cut(lines, top), top, defects: Vec::new() };
    let height = picture.lines.len() / 2;
    if height == 0 {
        let at = Location { line: top.line + 1, column: 1 };
        return Err(FormatError::new(file, at, "one line of posts", "lines of cells and posts below it"));
    }
    let mut maze = Maze::open(top.width, height).map_err(|error| size_error(error, file, top.line + 1))?;
    let (mut starts, mut goals) = (Vec::new(), Vec::new());
    for index in 0..picture.lines.len() {
        if index % 2 == 0 {
            picture.posts(index, &mut maze);
        } else {
            picture.cells(index, &mut maze, &mut starts, &mut goals);
        }
    }
    let format = match (top.post, starts.is_empty() && goals.is_empty() && maze.unknown_walls() == 0) {
        ('+', true) => MazeFormat::Map,
        ('+', false) => MazeFormat::Maze,
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
    Ok(MazeFile { maze, format, cell: None, defects: picture.defects })
}

/// The lines that belong to the picture: it goes on while another line of posts follows the one of cells.
fn cut<'a>(lines: &[&'a str], top: Top) -> Vec<&'a [u8]> {
    let from = |line: &'a str| -> &'a [u8] {
        let blanks = line.bytes().take(top.indent).take_while(u8::is_ascii_whitespace).count();
        &line.as_bytes()[blanks..]
    };
    let body: Vec<&[u8]> = lines[top.line..].iter().map(|line| from(line)).collect();
    let mut end = 1;
    while body.get(end + 1).is_some_and(|line| has_posts(line, top)) {
        end += 2;
    }
    body[..end].to_vec()
}

/// Whether most of a line's posts are there, and hardly anything else but walls.
fn has_posts(line: &[u8], top: Top) -> bool {
    let line = &line[..line.len().min(4 * top.width + 1)];
    let posts = line.iter().step_by(4).filter(|&&byte| is_post(byte, top)).count();
    let odd = |&&byte: &&u8| !is_post(byte, top) && !b"-_= .|".contains(&byte);
    2 * posts > top.width && line.iter().filter(odd).count() <= (top.width / 4).max(1)
}

fn is_post(byte: u8, top: Top) -> bool {
    char::from(byte) == top.post || b"oO+*".contains(&byte)
}

impl Picture<'_> {
    /// A character; blank where the line has ended.
    fn at(&self, index: usize, column: usize) -> u8 {
        self.lines[index].get(column).copied().unwrap_or(b' ')
    }

    fn note(&mut self, index: usize, message: String) {
        self.defects.push(Defect::at(self.top.line + index + 1, message));
    }

    /// Enters the walls between the posts of a line.
    fn posts(&mut self, index: usize, maze: &mut Maze) {
        for x in 0..=self.top.width {
            let post = self.at(index, 4 * x);
            if !is_post(post, self.top) {
                self.note(index, format!("{} instead of a post in column {}", shown(&[post]), 4 * x + 1));
            }
        }
        for x in 0..self.top.width {
            let marks = [1, 2, 3].map(|i| self.at(index, 4 * x + i));
            let wall = match &marks {
                b"---" => Wall::Present,
                b"   " => Wall::Absent,
                b" . " => Wall::Unknown,
                other => {
                    self.note(
                        index,
                        format!("{} instead of a wall in column {}; taken as one", shown(other), 4 * x + 2),
                    );
                    Wall::Present
                }
            };
            // The uppermost line is above the uppermost row, any other below one.
            let (cell, side) = match index {
                0 => (self.cell(x, 1), Direction::North),
                _ => (self.cell(x, index - 1), Direction::South),
            };
            maze.set_wall(cell, side, wall);
        }
    }

    /// Enters the walls beside cells, and what stands in the cells.
    fn cells(&mut self, index: usize, maze: &mut Maze, starts: &mut Vec<Cell>, goals: &mut Vec<Cell>) {
        for x in 0..=self.top.width {
            let mark = self.at(index, 4 * x);
            let wall = match mark {
                b'|' => Wall::Present,
                b' ' | b'\t' => Wall::Absent,
                b'.' => Wall::Unknown,
                other => {
                    self.note(
                        index,
                        format!(
                            "{} instead of a wall in column {}; taken as one",
                            shown(&[other]),
                            4 * x + 1
                        ),
                    );
                    Wall::Present
                }
            };
            match x.checked_sub(1) {
                Some(left) => maze.set_wall(self.cell(left, index), Direction::East, wall),
                None => maze.set_wall(self.cell(x, index), Direction::West, wall),
            }
        }
        for x in 0..self.top.width {
            let marks = [1, 2, 3].map(|i| self.at(index, 4 * x + i));
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

    /// The cell of a column and of a line of cells.
    fn cell(&self, x: usize, index: usize) -> Cell {
        Cell::new(x as u16, (self.lines.len() / 2 - 1 - index / 2) as u16)
    }
}

/// Characters as messages show them.
fn shown(bytes: &[u8]) -> String {
    format!("{:?}", String::from_utf8_lossy(bytes))
}

/// Draws a maze. Without `marks`, start, goals and unknown walls are left out.
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
                // A goal at the start stays a goal: the start is found without a mark, the goal is not.
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
            Wall::Present => "---",
            Wall::Unknown if marks => " . ",
            _ => "   ",
        });
    }
    text.push(post);
    text.push('\n');
}

fn beside(wall: Wall, marks: bool) -> char {
    match wall {
        Wall::Present => '|',
        Wall::Unknown if marks => '.',
        _ => ' ',
    }
}
