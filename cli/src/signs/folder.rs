use std::collections::BTreeSet;
use std::io::{self, BufReader};
use std::path::Path;

use roverlab::files::open_regular;
use roverlab::vision::signs::Area;

use super::Marked;
use crate::common::Failure;

/// Pictures with known signs.
#[derive(Debug)]
pub(super) struct Folder {
    /// The names of the classes.
    pub names: Vec<String>,
    pub pictures: Vec<Marked>,
}

/// Most pixels of a picture.
const MOST_PIXELS: u64 = 16_000_000;
/// Part of a picture that a sign covers, in the mean, from which pictures show little else.
const CROPPED: f64 = 0.25;

impl Folder {
    /// Whether its pictures show more than signs.
    pub(super) fn finds(&self) -> bool {
        let part = |picture: &Marked| {
            let covered: f64 = picture.signs.iter().map(|(_, area)| area.width * area.height).sum();
            covered / (picture.size.0 * picture.size.1) as f64
        };
        self.pictures.iter().map(part).sum::<f64>() < CROPPED * self.pictures.len() as f64
    }
}

/// A line of the table.
struct Row {
    file: String,
    class: String,
    area: Area,
    /// Where it stands.
    line: usize,
}

/// Reads the table of a folder, and its pictures. Classes are those of `names`, or else those that occur, in
/// the order of their numbers or letters.
pub(super) fn read(folder: &Path, names: Option<&[String]>) -> Result<Folder, Failure> {
    let table = folder.join("boxes.csv");
    let fail = |line: usize, what: String| Failure::input(format!("{}:{line}: {what}", table.display()));
    let text = open_regular(&table)
        .and_then(io::read_to_string)
        .map_err(|error| Failure::input(format!("{}: {error}", table.display())))?;
    let rows = rows(&text).map_err(|(line, what)| fail(line, what))?;
    let names = match names {
        Some(names) => names.to_vec(),
        None => classes(&rows),
    };
    let mut pictures: Vec<Marked> = Vec::new();
    for row in rows {
        let known = names.iter().position(|name| *name == row.class);
        let class = known.ok_or_else(|| {
            fail(row.line, format!("found the class {:?}; expected one of {names:?}", row.class))
        })?;
        if pictures.last().is_none_or(|picture| picture.name != row.file) {
            pictures.push(picture(folder, &row.file).map_err(|what| fail(row.line, what))?);
        }
        pictures.last_mut().expect("just added").signs.push((class, row.area));
    }
    if pictures.is_empty() {
        return Err(fail(1, "found no pictures; expected a line for each sign".into()));
    }
    fit_boxes(&mut pictures);
    Ok(Folder { names, pictures })
}

/// The lines below the names of the columns.
fn rows(text: &str) -> Result<Vec<Row>, (usize, String)> {
    let mut lines = text.lines().zip(1..).filter(|(line, _)| !line.trim().is_empty());
    let (head, _) = lines.next().ok_or((1, "found nothing; expected the names of the columns".to_owned()))?;
    let columns: Vec<&str> = head.split(',').map(str::trim).collect();
    let column = |name: &str| columns.iter().position(|column| *column == name);
    let places = |names: [&str; 4]| names.map(column).into_iter().collect::<Option<Vec<_>>>();
    let expected = "file, class, and left, top, width, height or x1, y1, x2, y2";
    let missing = || (1, format!("found the columns {head:?}; expected {expected}"));
    let (file, class) = column("file").zip(column("class")).ok_or_else(missing)?;
    let (sides, corners) = (places(["left", "top", "width", "height"]), places(["x1", "y1", "x2", "y2"]));
    let is_sides = sides.is_some();
    let places = sides.or(corners).ok_or_else(missing)?;
    lines
        .map(|(line, number)| {
            let cells: Vec<&str> = line.split(',').map(str::trim).collect();
            if cells.len() != columns.len() {
                return Err((number, format!("found {} columns; expected {}", cells.len(), columns.len())));
            }
            let read = |&place: &usize| cells[place].parse().ok().filter(|number: &f64| number.is_finite());
            let numbers = places.iter().map(read).collect::<Option<Vec<_>>>();
            let numbers =
                numbers.ok_or_else(|| (number, format!("found {line:?}; expected numbers for the box")))?;
            let [left, top, c, d] = numbers[..] else { unreachable!("there are four columns") };
            let (width, height) = if is_sides { (c, d) } else { (c - left, d - top) };
            if width <= 0.0 || height <= 0.0 {
                return Err((
                    number,
                    format!("found a box of {width} x {height} pixels; expected more than none"),
                ));
            }
            let area = Area::new(left, top, width, height);
            Ok(Row { file: cells[file].to_owned(), class: cells[class].to_owned(), area, line: number })
        })
        .collect()
}

/// The classes that occur.
fn classes(rows: &[Row]) -> Vec<String> {
    let names: BTreeSet<&str> = rows.iter().map(|row| row.class.as_str()).collect();
    let mut names: Vec<String> = names.into_iter().map(String::from).collect();
    names.sort_by_key(|name| name.parse::<u64>().unwrap_or(u64::MAX));
    names
}

fn picture(folder: &Path, name: &str) -> Result<Marked, String> {
    let file = folder.join(name);
    let said = |error: &dyn std::fmt::Display| format!("{}: {error}", file.display());
    let opened = open_regular(&file).map_err(|error| said(&error))?;
    let reader = image::ImageReader::new(BufReader::new(opened));
    let mut reader = reader.with_guessed_format().map_err(|error| said(&error))?;
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(8 * MOST_PIXELS);
    reader.limits(limits);
    let pixels = reader.decode().map_err(|error| said(&error))?.to_rgb8();
    let size = (pixels.width() as usize, pixels.height() as usize);
    if size.0 as u64 * size.1 as u64 > MOST_PIXELS || size.0 * size.1 == 0 {
        return Err(said(&format!(
            "found {} x {} pixels; expected 1 to {MOST_PIXELS} in all",
            size.0, size.1
        )));
    }
    Ok(Marked { name: name.to_owned(), pixels: pixels.into_raw(), size, signs: Vec::new() })
}

/// If boxes end beyond their pictures, all pictures have been scaled since they were marked: boxes are scaled
/// too, by equal margins at both sides.
fn fit_boxes(pictures: &mut [Marked]) {
    /// Pixels by which a box may end beyond its picture.
    const BEYOND: f64 = 1.5;
    let ends = |area: &Area| (area.left + area.width, area.top + area.height);
    let is_beyond = |picture: &Marked| {
        let (width, height) = (picture.size.0 as f64 + BEYOND, picture.size.1 as f64 + BEYOND);
        picture.signs.iter().any(|(_, area)| ends(area).0 > width || ends(area).1 > height)
    };
    if !pictures.iter().any(is_beyond) {
        return;
    }
    for picture in pictures {
        for (_, area) in &mut picture.signs {
            let (right, bottom) = ends(area);
            let across = picture.size.0 as f64 / (area.left + right);
            let down = picture.size.1 as f64 / (area.top + bottom);
            *area = Area::new(area.left * across, area.top * down, area.width * across, area.height * down);
        }
    }
}
