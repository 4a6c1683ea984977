//! ESRI ASCII grids (`.asc`): elevations of real terrain, a common format of surveys.
//!
//! ```text
//! ncols 3
//! nrows 2
//! xllcorner 439000
//! yllcorner 5390000
//! cellsize 25
//! NODATA_value -9999
//! 812.5 813.1 814
//! 811.9 -9999 813.2
//! ```
//!
//! The first row of numbers has the largest y. The corner is the lower left corner of the lower left cell, or
//! its centre with `xllcenter` and `yllcenter`. Places without data get the grid's lowest elevation, with a
//! warning.
//!
//! ```
//! use roverlab::world::formats::elevation_grid;
//! let text = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 25\n3 4\n1 2\n";
//! let grid = elevation_grid::parse(text, "hill.asc")?.value;
//! assert_eq!(grid.range(), (1.0, 4.0));
//! let error = elevation_grid::parse("ncols two\n", "hill.asc").unwrap_err();
//! assert!(error.to_string().starts_with("hill.asc:1:7"), "{error}");
//! # Ok::<(), roverlab::world::formats::FormatError>(())
//! ```

use super::error::{FormatError, Location, Notes, Parsed};
use super::lexer::shown;
use super::limits::MAX_GRID_BYTES;
use super::number;
use crate::ParameterError;
use crate::geometry::{Aabb, Point, Vector};
use crate::world::HeightField;

/// Elevations at the centres of square cells (m).
#[derive(Debug, Clone, PartialEq)]
pub struct ElevationGrid {
    /// Number of cells along x.
    pub columns: usize,
    /// Number of cells along y.
    pub rows: usize,
    /// Distance between adjacent cells (m).
    pub cell_size: f64,
    /// Centre of the cell with the smallest x and y, in the survey's coordinates.
    pub origin: Point,
    /// Rows of elevations, starting at the smallest y.
    pub elevations: Vec<f32>,
}

impl ElevationGrid {
    /// Lowest and highest elevation.
    pub fn range(&self) -> (f32, f32) {
        let range = (f32::INFINITY, f32::NEG_INFINITY);
        self.elevations.iter().fold(range, |(low, high), &e| (low.min(e), high.max(e)))
    }

    /// The surface at its true size, with a corner at (0, 0).
    pub fn surface(&self) -> Result<HeightField, ParameterError> {
        let gaps = Vector::new(self.columns.saturating_sub(1) as f64, self.rows.saturating_sub(1) as f64);
        let area = Aabb::new(Point::origin(), Point::origin() + gaps * self.cell_size);
        HeightField::new(self.columns, self.rows, area, self.elevations.clone())
    }

    /// The surface scaled to an area from (0, 0), with elevations from 0 to `top` metres.
    pub fn scaled(&self, width: f64, height: f64, top: f64) -> Result<HeightField, ParameterError> {
        let (low, high) = self.range();
        let scale = if high > low { top / f64::from(high - low) } else { 0.0 };
        let scaled = self.elevations.iter().map(|&e| (f64::from(e - low) * scale) as f32);
        let area = Aabb::new(Point::origin(), Point::new(width, height));
        HeightField::new(self.columns, self.rows, area, scaled.collect())
    }
}

/// Reads a grid. An error states the location in the file.
pub fn parse(text: &str, file: &str) -> Result<Parsed<ElevationGrid>, FormatError> {
    if text.len() as u64 > MAX_GRID_BYTES {
        let expected = format!("a file of at most {} MiB", MAX_GRID_BYTES >> 20);
        return Err(FormatError::new(file, Location::START, "a larger file", expected));
    }
    let mut words = Words::new(text, file);
    let header = Header::read(&mut words)?;
    let mut elevations = vec![f32::NAN; header.columns * header.rows];
    let mut lowest = f32::INFINITY;
    for row in (0..header.rows).rev() {
        for column in 0..header.columns {
            let value = words.number("an elevation")?;
            if Some(value) != header.no_data {
                lowest = lowest.min(value as f32);
                elevations[row * header.columns + column] = value as f32;
            }
        }
    }
    if let Some(word) = words.next() {
        let expected = format!("the end of the file after {} elevations", elevations.len());
        return Err(words.error(&word, expected));
    }
    let mut notes = Notes::new(file);
    let missing = elevations.iter().filter(|e| e.is_nan()).count();
    if missing == elevations.len() {
        return Err(FormatError::new(file, Location::START, "a grid without data", "an elevation at least"));
    }
    if missing > 0 {
        let message = format!("{missing} places without data; they lie as low as the lowest place");
        notes.warn(Location::START, message);
        elevations.iter_mut().filter(|e| e.is_nan()).for_each(|e| *e = lowest);
    }
    let Header { columns, rows, cell_size, origin, .. } = header;
    Ok(notes.finish(ElevationGrid { columns, rows, cell_size, origin, elevations }))
}

struct Header {
    columns: usize,
    rows: usize,
    cell_size: f64,
    origin: Point,
    no_data: Option<f64>,
}

impl Header {
    /// Reads the keywords, in any order and case, up to the first number without a keyword.
    fn read(words: &mut Words<'_>) -> Result<Self, FormatError> {
        let (mut columns, mut rows, mut cell_size, mut no_data) = (None, None, None, None);
        let (mut corner, mut middle) = ([None; 2], [None; 2]);
        while let Some(word) = words.peek().filter(|word| !number::looks_like_number(word.text)) {
            words.next();
            match word.text.to_ascii_lowercase().as_str() {
                "ncols" => columns = Some(words.count("the number of columns")?),
                "nrows" => rows = Some(words.count("the number of rows")?),
                "cellsize" => cell_size = Some(words.positive("the size of a cell")?),
                "xllcorner" => corner[0] = Some(words.number("the corner's x")?),
                "yllcorner" => corner[1] = Some(words.number("the corner's y")?),
                "xllcenter" => middle[0] = Some(words.number("the middle's x")?),
                "yllcenter" => middle[1] = Some(words.number("the middle's y")?),
                "nodata_value" => no_data = Some(words.number("the number that stands for no data")?),
                _ => return Err(words.error(&word, "ncols, nrows, cellsize, xllcorner or another keyword")),
            }
        }
        let (Some(columns), Some(rows), Some(cell_size)) = (columns, rows, cell_size) else {
            let missing = [(columns.is_none(), "`ncols`"), (rows.is_none(), "`nrows`")];
            let missing = missing.iter().find(|(none, _)| *none).map_or("`cellsize`", |(_, name)| name);
            return Err(words.error_here(format!("{missing} before the elevations")));
        };
        let place = |axis: usize| {
            middle[axis].unwrap_or_else(|| corner[axis].map_or(0.0, |corner: f64| corner + 0.5 * cell_size))
        };
        Ok(Self { columns, rows, cell_size, origin: Point::new(place(0), place(1)), no_data })
    }
}

/// A word of the file with its location.
#[derive(Debug, Clone, Copy)]
struct Word<'a> {
    text: &'a str,
    line: usize,
    /// Byte offset in the line.
    offset: usize,
}

/// Unread words.
struct Words<'a> {
    file: &'a str,
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    /// The present line, its number, and its unread part.
    line: &'a str,
    number: usize,
    rest: &'a str,
}

impl<'a> Words<'a> {
    fn new(text: &'a str, file: &'a str) -> Self {
        Self { file, lines: text.lines().enumerate(), line: "", number: 1, rest: "" }
    }

    fn peek(&mut self) -> Option<Word<'a>> {
        loop {
            let rest = self.rest.trim_start();
            if let Some(text) = rest.split_whitespace().next() {
                return Some(Word { text, line: self.number, offset: self.line.len() - rest.len() });
            }
            let (index, line) = self.lines.next()?;
            (self.line, self.rest, self.number) = (line, line, index + 1);
        }
    }

    fn next(&mut self) -> Option<Word<'a>> {
        let word = self.peek()?;
        self.rest = &self.line[word.offset + word.text.len()..];
        Some(word)
    }

    /// A finite number in the range of elevations and coordinates.
    fn number(&mut self, what: &str) -> Result<f64, FormatError> {
        let Some(word) = self.next() else { return Err(self.error_here(what)) };
        let value = number::parse(word.text, 0).filter(|value| value.abs() <= f64::from(f32::MAX));
        value.ok_or_else(|| self.error(&word, format!("{what}, a number")))
    }

    fn positive(&mut self, what: &str) -> Result<f64, FormatError> {
        let word = self.peek();
        let value = self.number(what)?;
        match word {
            Some(word) if value <= 0.0 => Err(self.error(&word, format!("{what}, a positive number"))),
            _ => Ok(value),
        }
    }

    fn count(&mut self, what: &str) -> Result<usize, FormatError> {
        let Some(word) = self.next() else { return Err(self.error_here(what)) };
        let most = HeightField::MAX_SAMPLES;
        let count = word.text.parse().ok().filter(|count| (2..=most).contains(count));
        count.ok_or_else(|| self.error(&word, format!("{what}, 2 to {most}")))
    }

    fn error(&self, word: &Word<'_>, expected: impl Into<String>) -> FormatError {
        let column = self.line.get(..word.offset).map_or(1, |before| before.chars().count() + 1);
        FormatError::new(self.file, Location { line: word.line, column }, shown(word.text), expected)
    }

    /// The error for a missing item at the present location.
    fn error_here(&mut self, expected: impl Into<String>) -> FormatError {
        if let Some(word) = self.peek() {
            return self.error(&word, expected);
        }
        let at = Location { line: self.number, column: self.line.chars().count() + 1 };
        FormatError::new(self.file, at, "the end of the file", expected)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const GRID: &str = "ncols 3\nNROWS 2\nxllcorner 100\nyllcenter 50\ncellsize 10\nNODATA_value -9999\n\
                        1 2 3\n4 -9999\n6.5\n";

    #[test]
    fn rows_come_from_the_north_and_gaps_lie_low() {
        let Parsed { value, warnings } = parse(GRID, "hill.asc").unwrap();
        assert_eq!(value.elevations, [4.0, 1.0, 6.5, 1.0, 2.0, 3.0]);
        assert_eq!((value.origin, value.cell_size), (Point::new(105.0, 50.0), 10.0));
        assert_eq!(warnings.len(), 1);
        assert!(warnings[0].to_string().contains("1 places without data"), "{}", warnings[0]);
        let surface = value.surface().unwrap();
        assert_eq!(surface.area().max, Point::new(20.0, 10.0));
        assert_eq!(surface.height(Point::new(20.0, 0.0)), Some(6.5));
        let scaled = value.scaled(4.0, 2.0, 0.55).unwrap();
        assert_eq!((scaled.lowest(), scaled.area().max), (0.0, Point::new(4.0, 2.0)));
        assert!((scaled.highest() - 0.55).abs() < 1e-7);
    }

    #[test]
    fn errors_name_the_place() {
        let message = |text: &str| parse(text, "hill.asc").unwrap_err().to_string();
        assert_eq!(
            message("nrows 2\ncellsize 3\n 1 2\n"),
            "hill.asc:3:2: found `1`; expected `ncols` before the elevations"
        );
        assert_eq!(
            message("ncols 1\n"),
            "hill.asc:1:7: found `1`; expected the number of columns, 2 to 4097"
        );
        assert_eq!(
            message("ncols 2\nnrows 2\ncellsize 0\n"),
            "hill.asc:3:10: found `0`; expected the size of a cell, a positive number"
        );
        let head = "ncols 2\nnrows 2\ncellsize 1\n";
        assert_eq!(
            message(&format!("{head}1 2\n3 x\n")),
            "hill.asc:5:3: found `x`; expected an elevation, a number"
        );
        assert_eq!(
            message(&format!("{head}1 2\n3")),
            "hill.asc:5:2: found the end of the file; expected an elevation"
        );
        assert_eq!(
            message(&format!("{head}1 2\n3 4 5")),
            "hill.asc:5:5: found `5`; expected the end of the file after 4 elevations"
        );
        assert!(message(&format!("{head}nodata_value 1\n1 1\n1 1")).contains("a grid without data"));
        assert!(message("colour 3").contains("found `colour`"));
        assert!(message("").contains("the end of the file"));
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn no_text_panics(text in "((ncols|nrows|cellsize|NODATA_value|xllcorner|x| |\n|-|1|2|3|1e9|é){1,4} ){0,30}") {
            let _ = parse(&text, "a.asc");
            let _ = parse(&format!("ncols 2\nnrows 2\ncellsize 1\n{text}"), "a.asc");
        }
    }
}
