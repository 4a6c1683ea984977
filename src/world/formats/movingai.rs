//! MovingAI's grid maps (`.map`) and scenarios (`.scen`).
//!
//! A map has a header (`type octile`, `height H`, `width W`, `map`) and one line of characters per row, upper
//! row first:
//!
//! | character | meaning |
//! |---|---|
//! | `.` `G` | ground |
//! | `S` | swamp, accessible from the ground |
//! | `W` | water, connected to itself only |
//! | `T` | trees |
//! | `@` `O` | out of bounds |
//!
//! A scenario file has a line `version 1` and one line per query: bucket, map, width, height, start column
//! and row, goal column and row, and length of the shortest path along edges and diagonals. A diagonal step
//! requires both adjacent cells to be free.
//!
//! N. R. Sturtevant, *Benchmarks for Grid-Based Pathfinding*, IEEE Trans. Computational Intelligence and AI
//! in Games 4(2), 2012.
//!
//! ```
//! use roverlab::world::formats::movingai::{Map, parse_map, parse_scenarios, print_map, print_scenarios};
//! let text = "type octile\nheight 2\nwidth 3\nmap\n..@\n.T.\n";
//! let map: Map = parse_map(text, "yard.map")?.value;
//! assert_eq!((map.grid().count_free(), print_map(&map).as_str()), (4, text));
//! let queries = parse_scenarios("version 1\n0 yard.map 3 2 0 0 0 1 1.0\n", "yard.map.scen")?.value;
//! assert_eq!((queries[0].goal.row, queries[0].optimal), (1, 1.0));
//! assert_eq!(parse_scenarios(&print_scenarios(&queries), "again.scen")?.value, queries);
//! # Ok::<(), roverlab::world::formats::FormatError>(())
//! ```

use std::fmt::Write as _;
use std::path::Path;

use super::error::{FormatError, Location, Notes, Parsed};
use super::lexer::{self, shown};
use super::limits::{MAX_GRID_BYTES, MAX_QUERIES};
use super::number;
use super::source::{decode, read_limited, unreadable};
use crate::geometry::{Pose, units};
use crate::world::{BitGrid, GridCell, Occupancy, OccupancyGrid};

/// A map, character by character.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Map {
    width: usize,
    height: usize,
    terrain: Vec<u8>,
}

impl Map {
    /// A map with ground on the grid's free cells, and `@` elsewhere.
    pub fn from_grid(grid: &BitGrid) -> Self {
        let (width, height) = (grid.width(), grid.height());
        let cells = (0..height).flat_map(|row| (0..width).map(move |column| GridCell::new(column, row)));
        let terrain = cells.map(|cell| if grid.is_free(cell) { b'.' } else { b'@' }).collect();
        Self { width, height, terrain }
    }

    /// Cells per row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The character of a cell; `@` outside.
    pub fn terrain(&self, cell: GridCell) -> char {
        let inside = cell.column < self.width && cell.row < self.height;
        if inside { char::from(self.terrain[cell.row * self.width + cell.column]) } else { '@' }
    }

    /// Cells accessible from the ground: ground and swamp. Row 0 is the upper one.
    pub fn grid(&self) -> BitGrid {
        self.cells_of(b".GS")
    }

    /// Water cells, which form a separate map.
    ///
    /// ```
    /// use roverlab::world::GridCell;
    /// use roverlab::world::formats::movingai;
    /// let map = movingai::parse_map("type octile\nheight 1\nwidth 3\nmap\n.WW\n", "pond.map")?.value;
    /// assert_eq!((map.grid().count_free(), map.water().count_free()), (1, 2));
    /// # Ok::<(), roverlab::world::formats::FormatError>(())
    /// ```
    pub fn water(&self) -> BitGrid {
        self.cells_of(b"W")
    }

    fn cells_of(&self, terrain: &[u8]) -> BitGrid {
        let free = |column, row| terrain.contains(&self.terrain[row * self.width + column]);
        // A map never exceeds the size limit of a grid.
        BitGrid::from_fn(self.width, self.height, free)
            .unwrap_or_else(|_| unreachable!("checked by the reader"))
    }
}

/// Cell size of a map used as a floor (mm). Paths one cell wide then have room for small robots, even on
/// plans with coarse cells.
pub const CELL_MM: f64 = 500.0;

impl Map {
    /// The map as a floor: cells of [`CELL_MM`], with the map's lower left corner at the origin, and a border
    /// of occupied cells, one column or row on each side, because outside of every map there is no way.
    pub fn occupancy(&self) -> OccupancyGrid {
        let (width, height) = (self.width + 2, self.height + 2);
        let cell = units::from_mm(CELL_MM);
        let mut grid = OccupancyGrid::unknown(width, height, cell, Pose::new(-cell, -cell, 0.0))
            .or_else(|_| OccupancyGrid::unknown(0, 0, cell, Pose::default()))
            .unwrap_or_else(|_| unreachable!("an empty grid"));
        let free = self.grid();
        for row in 0..grid.height() {
            for column in 0..grid.width() {
                // Rows count downwards in the map and upwards on the floor.
                let from = GridCell::new(column.wrapping_sub(1), self.height.wrapping_sub(row));
                grid.set(column, row, if free.is_free(from) { Occupancy::Free } else { Occupancy::Occupied });
            }
        }
        grid
    }
}

/// A query with its answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Query {
    /// Bucket: queries of similar lengths.
    pub bucket: u32,
    /// Name of the map as written.
    pub map: String,
    /// Cells per row of the map.
    pub width: usize,
    /// Number of rows of the map.
    pub height: usize,
    /// Start cell.
    pub start: GridCell,
    /// Goal cell.
    pub goal: GridCell,
    /// Length of the shortest path (cells).
    pub optimal: f64,
}

/// Reads a map from a file.
///
/// ```
/// use roverlab::world::formats::movingai::{load_map, load_scenarios, parse_map, parse_scenarios};
/// let map = parse_map("type octile\nheight 1\nwidth 3\nmap\n..@\n", "corridor.map")?.value;
/// let text = "version 1\n0 corridor.map 3 1 0 0 1 0 1.0\n";
/// let queries = parse_scenarios(text, "corridor.map.scen")?.value;
/// assert_eq!((map.grid().count_free(), queries[0].optimal), (2, 1.0));
/// // From a file:
/// assert!(load_map("none.map").is_err() && load_scenarios("none.map.scen").is_err());
/// # Ok::<(), roverlab::world::formats::FormatError>(())
/// ```
pub fn load_map(path: impl AsRef<Path>) -> Result<Parsed<Map>, FormatError> {
    read(path.as_ref(), parse_map)
}

/// Reads scenarios from a file.
pub fn load_scenarios(path: impl AsRef<Path>) -> Result<Parsed<Vec<Query>>, FormatError> {
    read(path.as_ref(), parse_scenarios)
}

fn read<T>(
    path: &Path,
    parse: impl FnOnce(&str, &str) -> Result<Parsed<T>, FormatError>,
) -> Result<Parsed<T>, FormatError> {
    let file = path.display().to_string();
    let bytes = read_limited(path, MAX_GRID_BYTES)
        .map_err(|error| unreadable(&error, &file, &file, Location::START, MAX_GRID_BYTES))?;
    let mut notes = Notes::new(&file);
    let text = decode(bytes, &mut notes)?;
    let parsed = parse(&text, &file)?;
    notes.extend(parsed.warnings);
    Ok(notes.finish(parsed.value))
}

/// Reads a map.
pub fn parse_map(text: &str, file: &str) -> Result<Parsed<Map>, FormatError> {
    check_length(text, file)?;
    let mut lines = Lines { file, inner: lexer::numbered(text), last: 1 };
    let (mut width, mut height, mut kind) = (None, None, false);
    loop {
        let (number, line) = lines.next("the line `map`")?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let at = |word: usize| place(number, line, words.get(word).copied());
        let wrong = |word: usize, expected: &str| {
            let found = words.get(word).map_or_else(|| "the end of the line".into(), |word| shown(word));
            FormatError::new(file, at(word), found, expected)
        };
        match words.as_slice() {
            [] => {}
            ["map"] => break,
            ["type", "octile"] => kind = true,
            ["type", ..] => return Err(wrong(1, "`octile` alone, the only type that is known")),
            ["width", text] => width = Some(size(text).ok_or_else(|| wrong(1, SIZE))?),
            ["height", text] => height = Some(size(text).ok_or_else(|| wrong(1, SIZE))?),
            ["width" | "height"] => return Err(wrong(1, SIZE)),
            ["width" | "height", ..] => return Err(wrong(2, "the end of the line")),
            _ => return Err(wrong(0, "`type octile`, `height H`, `width W` or `map`")),
        }
    }
    let header = |what: &str| {
        let at = Location { line: lines.last, column: 1 };
        FormatError::new(
            file,
            at,
            format!("`map` without a {what} before it"),
            format!("the map's {what} first"),
        )
    };
    let (Some(width), Some(height)) = (width, height) else {
        return Err(header(if width.is_none() { "width" } else { "height" }));
    };
    if !kind {
        return Err(header("type"));
    }
    if width * height > BitGrid::MAX_CELLS {
        let at = Location { line: lines.last, column: 1 };
        let expected = format!("at most {} cells", BitGrid::MAX_CELLS);
        return Err(FormatError::new(file, at, format!("a map of {width} x {height} cells"), expected));
    }
    let terrain = lines.rows(width, height)?;
    Ok(Notes::new(file).finish(Map { width, height, terrain }))
}

/// Valid widths and heights, for messages.
const SIZE: &str = "a number of cells from 1 to 33554432";

fn size(text: &str) -> Option<usize> {
    text.parse().ok().filter(|&n| n > 0 && n <= BitGrid::MAX_CELLS)
}

/// Location of a word in a line, or of the line's end.
fn place(number: usize, line: &str, word: Option<&str>) -> Location {
    let offset = word.map_or(line.trim_end().len(), |word| word.as_ptr() as usize - line.as_ptr() as usize);
    Location { line: number, column: line[..offset].chars().count() + 1 }
}

fn check_length(text: &str, file: &str) -> Result<(), FormatError> {
    if text.len() as u64 <= MAX_GRID_BYTES {
        return Ok(());
    }
    let expected = format!("a file of at most {} MiB", MAX_GRID_BYTES >> 20);
    Err(FormatError::new(file, Location::START, "a larger file", expected))
}

/// Unread lines.
struct Lines<'a, I> {
    file: &'a str,
    inner: I,
    /// Number of the last line read.
    last: usize,
}

impl<'a, I: Iterator<Item = (usize, &'a str)>> Lines<'a, I> {
    fn next(&mut self, expected: &str) -> Result<(usize, &'a str), FormatError> {
        let at = Location { line: self.last + 1, column: 1 };
        let next = self.inner.next();
        let line = next.ok_or_else(|| FormatError::new(self.file, at, "the end of the file", expected))?;
        self.last = line.0;
        Ok(line)
    }

    fn rows(&mut self, width: usize, height: usize) -> Result<Vec<u8>, FormatError> {
        let mut terrain = Vec::with_capacity(width * height);
        for row in 0..height {
            let expected = format!("row {} of {height}", row + 1);
            let (number, line) = self.next(&expected)?;
            if line.trim().is_empty() {
                let rest = self.inner.by_ref().any(|(_, line)| !line.trim().is_empty());
                let found = if rest { "an empty line" } else { "the end of the file" };
                return Err(FormatError::new(
                    self.file,
                    Location { line: number, column: 1 },
                    found,
                    expected,
                ));
            }
            self.row(number, line.trim_end(), width, &mut terrain)?;
        }
        for (number, line) in self.inner.by_ref() {
            if !line.trim().is_empty() {
                let at = Location { line: number, column: 1 };
                let expected = format!("the end of the file after {height} rows");
                return Err(FormatError::new(self.file, at, shown(line), expected));
            }
        }
        Ok(terrain)
    }

    fn row(&self, number: usize, line: &str, width: usize, terrain: &mut Vec<u8>) -> Result<(), FormatError> {
        let error = |column: usize, found: String, expected: String| {
            Err(FormatError::new(self.file, Location { line: number, column }, found, expected))
        };
        let wrong = line.chars().position(|c| !matches!(c, '.' | 'G' | '@' | 'O' | 'T' | 'S' | 'W'));
        if let Some(column) = wrong {
            let found = line.chars().nth(column).map_or_else(String::new, |c| shown(&c.to_string()));
            return error(column + 1, found, "one of the characters .G@OTSW".into());
        }
        if line.len() != width {
            let found = format!("a row of {} cells", line.len());
            return error(line.len().min(width) + 1, found, format!("{width} cells"));
        }
        terrain.extend_from_slice(line.as_bytes());
        Ok(())
    }
}

/// Reads scenarios.
pub fn parse_scenarios(text: &str, file: &str) -> Result<Parsed<Vec<Query>>, FormatError> {
    check_length(text, file)?;
    let mut lines = lexer::numbered(text).filter(|(_, line)| !line.trim().is_empty());
    let expected = "the line `version 1`";
    let (number, first) =
        lines.next().ok_or_else(|| FormatError::new(file, Location::START, "an empty file", expected))?;
    let version: Vec<&str> = first.split_whitespace().collect();
    if !matches!(version.as_slice(), ["version", "1" | "1.0"]) {
        let at = Location { line: number, column: 1 };
        return Err(FormatError::new(file, at, shown(first.trim()), expected));
    }
    let mut queries = Vec::new();
    for (number, line) in lines {
        if queries.len() == MAX_QUERIES {
            let at = Location { line: number, column: 1 };
            return Err(FormatError::new(file, at, "one more query", format!("at most {MAX_QUERIES}")));
        }
        queries.push(query(file, number, line)?);
    }
    Ok(Notes::new(file).finish(queries))
}

/// A query line. The name of the map may contain blanks, so the numbers are counted from the end.
fn query(file: &str, number: usize, line: &str) -> Result<Query, FormatError> {
    let words: Vec<&str> = line.split_whitespace().collect();
    if words.len() < 9 {
        let expected = "9 words: bucket, map, width, height, start, goal and length";
        let at = place(number, line, None);
        return Err(FormatError::new(file, at, format!("a line of {} words", words.len()), expected));
    }
    let tail = words.len() - 7;
    let wrong = |index: usize, expected: &str| {
        FormatError::new(file, place(number, line, Some(words[index])), shown(words[index]), expected)
    };
    let whole = |index: usize, what: &str| {
        let value = words[index].parse::<usize>().ok().filter(|&n| n <= BitGrid::MAX_CELLS);
        value.ok_or_else(|| wrong(index, what))
    };
    let cell = |index: usize, width: usize, height: usize, what: &str| {
        let (column, row) = (whole(index, what)?, whole(index + 1, what)?);
        if column >= width {
            return Err(wrong(index, &format!("{what} below the map's width, {width}")));
        }
        if row >= height {
            return Err(wrong(index + 1, &format!("{what} below the map's height, {height}")));
        }
        Ok(GridCell::new(column, row))
    };
    let bucket = words[0].parse().map_err(|_| wrong(0, "the number of a bucket"))?;
    let (width, height) = (whole(tail, "the map's width")?, whole(tail + 1, "the map's height")?);
    let start = cell(tail + 2, width, height, "a coordinate of the start")?;
    let goal = cell(tail + 4, width, height, "a coordinate of the goal")?;
    let optimal = number::parse(words[tail + 6], 0).filter(|length| length.is_finite() && *length >= 0.0);
    let optimal = optimal.ok_or_else(|| wrong(tail + 6, "the length of a path, 0 or more"))?;
    Ok(Query { bucket, map: words[1..tail].join(" "), width, height, start, goal, optimal })
}

/// The text of a map.
pub fn print_map(map: &Map) -> String {
    let mut text = format!("type octile\nheight {}\nwidth {}\nmap\n", map.height, map.width);
    for row in map.terrain.chunks(map.width.max(1)) {
        text.extend(row.iter().map(|&c| char::from(c)));
        text.push('\n');
    }
    text
}

/// The text of scenarios.
pub fn print_scenarios(queries: &[Query]) -> String {
    lexer::written(|text| {
        writeln!(text, "version 1")?;
        for q in queries {
            let (start, goal) = (q.start, q.goal);
            write!(
                text,
                "{}\t{}\t{}\t{}\t{}\t{}\t",
                q.bucket, q.map, q.width, q.height, start.column, start.row
            )?;
            writeln!(text, "{}\t{}\t{}", goal.column, goal.row, number::print(q.optimal, 0))?;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const MAP: &str = "type octile\r\nheight 2\r\nwidth 4\r\nmap\r\n.G@O\r\nTSW.\r\n";

    #[test]
    fn a_map_is_read() {
        let map = parse_map(MAP, "m.map").unwrap().value;
        assert_eq!((map.width(), map.height()), (4, 2));
        let free: Vec<_> = map.grid().free_cells().map(|cell| (cell.column, cell.row)).collect();
        assert_eq!(free, [(0, 0), (1, 0), (1, 1), (3, 1)]);
        assert_eq!((map.terrain(GridCell::new(2, 1)), map.terrain(GridCell::new(4, 1))), ('W', '@'));
        let water: Vec<_> = map.water().free_cells().map(|cell| (cell.column, cell.row)).collect();
        assert_eq!(water, [(2, 1)]);
        assert_eq!(print_map(&map), MAP.replace('\r', ""));
    }

    #[test]
    fn broken_maps_are_named() {
        let message = |text: &str| parse_map(text, "m.map").unwrap_err().to_string();
        let head = "type octile\nheight 2\nwidth 2\nmap\n";
        assert_eq!(
            message(&format!("{head}..\n.x\n")),
            "m.map:6:2: found `x`; expected one of the characters .G@OTSW"
        );
        assert_eq!(
            message(&format!("{head}..\n")),
            "m.map:6:1: found the end of the file; expected row 2 of 2"
        );
        assert_eq!(message(&format!("{head}..\n.\n")), "m.map:6:2: found a row of 1 cells; expected 2 cells");
        assert_eq!(
            message(&format!("{head}..\n...\n")),
            "m.map:6:3: found a row of 3 cells; expected 2 cells"
        );
        assert!(
            message(&format!("{head}..\n..\n\n..")).starts_with("m.map:8:1: found `..`; expected the end")
        );
        assert!(message("type octile\nheight -1").starts_with("m.map:2:8: found `-1`; expected a number"));
        assert!(
            message("type octile\nheight 2\nmap\n").starts_with("m.map:3:1: found `map` without a width")
        );
        assert!(message("height 2\nwidth 2\nmap\n").contains("without a type"));
        assert!(message("type hex\n").starts_with("m.map:1:6: found `hex`"));
        assert!(message("type octile\nheight 10000\nwidth 10000\nmap\n").contains("10000 x 10000"));
        assert!(message("").starts_with("m.map:2:1: found the end of the file"), "{}", message(""));
    }

    #[test]
    fn scenarios_are_read() {
        let text =
            "version 1.0\n61 maps/my map.map 512 512 210 395 87 201 244.95\n\n0\ta\t4\t2\t0\t0\t3\t1\t0\n";
        let queries = parse_scenarios(text, "s").unwrap().value;
        assert_eq!(queries.len(), 2);
        assert_eq!((queries[0].map.as_str(), queries[0].optimal), ("maps/my map.map", 244.95));
        assert_eq!((queries[0].start, queries[0].goal), (GridCell::new(210, 395), GridCell::new(87, 201)));
        assert_eq!(parse_scenarios(&print_scenarios(&queries), "s").unwrap().value, queries);
    }

    #[test]
    fn broken_scenarios_are_named() {
        let message = |text: &str| parse_scenarios(text, "s").unwrap_err().to_string();
        assert_eq!(message("version 2\n"), "s:1:1: found `version 2`; expected the line `version 1`");
        assert!(message("version 1\n0 a 4 2 0 0 3 1\n").starts_with("s:2:16: found a line of 8 words"));
        assert!(
            message("version 1\n0 a 4 2 0 0 4 1 5\n")
                .contains("s:2:13: found `4`; expected a coordinate of the goal below")
        );
        assert!(message("version 1\n0 a 4 2 0 2 3 1 5\n").contains("the map's height, 2"));
        assert!(message("version 1\n0 a 4 2 0 0 3 1 nan\n").contains("found `nan`; expected the length"));
        assert!(message("version 1\n0 a 4 2 0 0 3 1 1e999\n").contains("expected the length"));
        assert!(message("").contains("an empty file"));
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn no_text_panics(text in "(type octile|height 3|width 2|map|[.@TG]{0,4}|\\PC{0,9}|\n|\r| ){0,20}") {
            let _ = parse_map(&text, "m");
            let _ = parse_scenarios(&format!("version 1\n{text}"), "s");
        }

        #[test]
        fn maps_read_back(width in 1..70usize, rows in proptest::collection::vec(any::<u64>(), 1..6)) {
            let grid = BitGrid::from_fn(width, rows.len(), |x, y| rows[y].rotate_left(x as u32) & 1 == 0).unwrap();
            let map = Map::from_grid(&grid);
            let again = parse_map(&print_map(&map), "m").unwrap().value;
            prop_assert_eq!(again.grid(), grid);
            prop_assert_eq!(again, map);
        }
    }
}
