//! Maze files: EyeSim's `.maz`, drawings with posts (the micromouse text format, kerikun11's `.maze`, mms's
//! `map`), mms's `num`, and the old binary files.
//!
//! The format is recognised from the content, because several formats share the same names. An error that
//! leaves the rest unambiguous is a [`Defect`]; any other is an error.

mod binary;
mod layout;
mod letters;
mod numbers;
mod picture;
#[cfg(test)]
mod tests;

use crate::ParameterError;
use std::io::{ErrorKind, Read};
use std::path::Path;

use super::{Defect, Maze, defects};
use crate::files::open_regular;
use crate::world::formats::{FormatError, Location};

/// A maze read from a file.
#[derive(Debug, Clone, PartialEq)]
pub struct MazeFile {
    /// The maze.
    pub maze: Maze,
    /// Format of the file.
    pub format: MazeFormat,
    /// Cell size (m), if the file states it.
    pub cell: Option<f64>,
    /// Defects of the file and of the maze; at most [`MazeFile::MAX_DEFECTS`].
    pub defects: Vec<Defect>,
}

impl MazeFile {
    /// Maximum number of stored defects, so that a broken file does not exhaust the memory.
    pub const MAX_DEFECTS: usize = 1000;
}

/// A file format for mazes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MazeFormat {
    /// The micromouse text format: a drawing with posts `o`.
    Text,
    /// kerikun11's `.maze`: posts `+`, start, goals and unknown walls.
    Maze,
    /// mms's `map`: walls only, with posts `+`.
    Map,
    /// mms's `num`: one line per cell.
    Num,
    /// EyeSim's `.maz`: `_` and `|`, with letters in the cells.
    EyeSim,
    /// One byte per cell, column by column.
    Binary,
}

/// Maximum file size (bytes): more than twice the text of a maze of 256 x 256 cells.
const LONGEST: u64 = 4 << 20;

fn require_length(bytes: u64, file: &str) -> Result<(), FormatError> {
    if bytes <= LONGEST {
        return Ok(());
    }
    Err(FormatError::new(file, Location::START, format!("{bytes} bytes"), "a file of at most 4 MiB"))
}

/// Reads a maze file from disk, in any format.
///
/// ```
/// use roverlab::maze::files::{load, parse, print};
/// let maze = parse(b"o---o---o\n| S   G |\no---o---o\n", "two cells")?;
/// let path = std::env::temp_dir().join(format!("two-cells-{}.txt", std::process::id()));
/// std::fs::write(&path, print(&maze.maze, maze.format)?)?;
/// assert_eq!(load(&path)?, maze);
/// assert!(load("no-such-file.txt").unwrap_err().to_string().contains("no-such-file.txt"));
/// # std::fs::remove_file(&path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn load(path: impl AsRef<Path>) -> Result<MazeFile, FormatError> {
    let path = path.as_ref();
    let name = path.display().to_string();
    let error = |found: String, expected: &str| FormatError::new(&name, Location::START, found, expected);
    let unreadable = |e: std::io::Error| match e.kind() {
        ErrorKind::NotFound => error("no such file".into(), "a file that exists"),
        ErrorKind::IsADirectory | ErrorKind::Unsupported => {
            error(format!("a file that {e}"), "a regular file")
        }
        kind => error(format!("a file that cannot be read ({kind})"), "a readable file"),
    };
    let mut bytes = Vec::new();
    let opened = open_regular(path).map_err(unreadable)?;
    require_length(opened.metadata().map_err(unreadable)?.len(), &name)?;
    opened.take(LONGEST + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    parse(&bytes, &name)
}

/// Reads a maze in any format; messages use `file` as its name.
///
/// # Errors
///
/// If the text is not a maze, its size is out of range, or it is longer than 4 MiB.
pub fn parse(bytes: &[u8], file: &str) -> Result<MazeFile, FormatError> {
    require_length(bytes.len() as u64, file)?;
    let mut read = if binary::is_binary(bytes) { binary::read(bytes) } else { read_text(bytes, file)? };
    read.defects.extend(defects(&read.maze));
    read.defects.truncate(MazeFile::MAX_DEFECTS);
    Ok(read)
}

fn read_text(bytes: &[u8], file: &str) -> Result<MazeFile, FormatError> {
    if bytes.contains(&0) {
        return Err(FormatError::new(file, Location::START, "bytes that are no text", "a maze"));
    }
    // Mazes need only ASCII characters. Any other one takes one column, as on screen.
    let text = String::from_utf8_lossy(bytes);
    let text = text.trim_start_matches('\u{feff}').replace("\r\n", "\n").replace('\r', "\n");
    let text = text.replace(|character: char| !character.is_ascii(), "?");
    let lines: Vec<&str> = text.split('\n').collect();
    if let Some(layout) = layout::find(&lines) {
        picture::read(layout, file)
    } else if numbers::is_list(&lines) {
        numbers::read(&lines, file)
    } else {
        letters::read(&text, file)
    }
}

/// Writes a maze. Information that the format cannot express is omitted: `map` and `num` have no start, goals
/// or unknown walls, and only EyeSim's format has headings other than north. Unknown walls become absent
/// there.
///
/// # Errors
///
/// If the format is binary.
pub fn print(maze: &Maze, format: MazeFormat) -> Result<String, FormatError> {
    match format {
        MazeFormat::Text => Ok(picture::print(maze, 'o', true)),
        MazeFormat::Maze => Ok(picture::print(maze, '+', true)),
        MazeFormat::Map => Ok(picture::print(maze, '+', false)),
        MazeFormat::Num => Ok(numbers::print(maze)),
        MazeFormat::EyeSim => Ok(letters::print(maze, crate::world::formats::maz::MazGrid::DEFAULT_CELL)),
        MazeFormat::Binary => {
            let (found, expected) = ("a binary format", "a format of text");
            Err(FormatError::new("maze", Location::START, found, expected))
        }
    }
}

/// The error for a maze of invalid size, at a line.
fn size_error(error: &ParameterError, file: &str, line: usize) -> FormatError {
    let found = format!("a {} of {} cells", error.name(), error.value());
    FormatError::new(file, Location { line, column: 1 }, found, error.expected())
}
