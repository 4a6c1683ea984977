//! Maps of the ROS navigation stack: a YAML file and an image, one pixel per cell.
//!
//! | key | meaning |
//! |---|---|
//! | `image` | image file (PGM, PNG or BMP), relative to the YAML file's folder |
//! | `resolution` | metres per pixel |
//! | `origin` | x, y (m) and yaw (rad) of the lower left corner of the lower left pixel |
//! | `negate` | 0: black is occupied; 1: white is |
//! | `occupied_thresh`, `free_thresh` | cells are occupied above the former and free below the latter |
//! | `mode` | `trinary` (the default), `scale` or `raw` |
//!
//! A pixel of brightness v (0 to 255) has occupancy p = (255 - v) / 255, or v / 255 if negated. *Trinary*
//! distinguishes free, occupied and unknown. *Scale* converts values between the thresholds to percent, and
//! transparent pixels to unknown. *Raw* interprets v as percent, and more than 100 as unknown. The brightness
//! of a colour is the mean of red, green and blue. (Some map servers count opacity as a fourth channel in
//! mode *trinary*, which brightens opaque pixels; this reader does not.)

use std::fmt::Write as _;
use std::io::Cursor;
use std::path::Path;

use image::{DynamicImage, GrayImage, ImageFormat, LumaA};

use super::error::{FormatError, Location, Notes, Parsed};
use super::image_file::decode_image;
use super::lexer::shown;
use super::limits::{MAX_IMAGE_BYTES, MAX_METRES, MAX_TEXT_BYTES, MAX_WALLS};
use super::number;
use super::source::{DiskFiles, FileSource, check_length, decode, read_limited, unreadable};
use super::yaml::{self, Scalar, Value};
use crate::ParameterError;
use crate::files::write_whole;
use crate::geometry::Pose;
use crate::world::{OccupancyGrid, World};

/// Conversion of pixels to occupancies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mode {
    /// Free, occupied or unknown.
    #[default]
    Trinary,
    /// Percent between the thresholds.
    Scale,
    /// The pixel's value is the percentage.
    Raw,
}

/// A map with the content of its YAML file.
///
/// ```
/// use roverlab::geometry::Pose;
/// use roverlab::world::formats::{MemoryFiles, ros_map};
/// use roverlab::world::{BitGrid, formats::ros_map::RosMap};
/// let grid = BitGrid::from_text("..#\n...")?.to_occupancy(0.05, Pose::default())?;
/// let map = RosMap::new("hall.pgm", grid);
/// let mut files = MemoryFiles::default();
/// files.0.insert("hall.pgm".into(), ros_map::print_image(&map)?);
/// let read = ros_map::parse(&ros_map::print(&map), "hall.yaml", &mut files)?.value;
/// assert_eq!(read, map);
/// // In a folder, the image is beside the YAML file.
/// assert!(ros_map::save(&map, "no such folder/hall.yaml").is_err());
/// assert!(ros_map::load("no such folder/hall.yaml").is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RosMap {
    /// Name of the image as written.
    pub image: String,
    /// Conversion of pixels to occupancies.
    pub mode: Mode,
    /// Whether white is occupied instead of black.
    pub negate: bool,
    /// Occupancy (0 to 1) above which a cell is occupied.
    pub occupied_threshold: f64,
    /// Occupancy (0 to 1) below which a cell is free.
    pub free_threshold: f64,
    /// The cells.
    pub grid: OccupancyGrid,
}

impl RosMap {
    /// A trinary map with the thresholds of files that state none.
    pub fn new(image: impl Into<String>, grid: OccupancyGrid) -> Self {
        Self {
            image: image.into(),
            mode: Mode::Trinary,
            negate: false,
            occupied_threshold: 0.65,
            free_threshold: 0.196,
            grid,
        }
    }

    /// Occupancy of a pixel in percent; `None` if unknown. `brightness` is from 0 to 255.
    fn occupancy(&self, brightness: f64, transparent: bool) -> Option<u8> {
        let paint = if self.negate { brightness } else { 255.0 - brightness };
        let occupied = paint / 255.0;
        let (high, low) = (self.occupied_threshold, self.free_threshold);
        let percent = match self.mode {
            Mode::Raw => brightness.round(),
            Mode::Scale if transparent => return None,
            _ if occupied > high => 100.0,
            _ if occupied < low => 0.0,
            Mode::Trinary => return None,
            Mode::Scale => ((occupied - low) / (high - low) * 100.0).round_ties_even(),
        };
        (0.0..=100.0).contains(&percent).then_some(percent as u8)
    }
}

/// Reads a map from a file.
pub fn load(path: impl AsRef<Path>) -> Result<Parsed<RosMap>, FormatError> {
    let file = path.as_ref().display().to_string();
    let bytes = read_limited(path.as_ref(), MAX_TEXT_BYTES)
        .map_err(|error| unreadable(&error, &file, &file, Location::START, MAX_TEXT_BYTES))?;
    let mut notes = Notes::new(&file);
    let text = decode(bytes, &mut notes)?;
    let parsed = parse(&text, &file, &mut DiskFiles::with_home(None))?;
    notes.extend(parsed.warnings);
    Ok(notes.finish(parsed.value))
}

/// Reads a map; its image comes from `files`.
pub fn parse(text: &str, file: &str, files: &mut dyn FileSource) -> Result<Parsed<RosMap>, FormatError> {
    check_length(text, file)?;
    let mut header = Header { notes: Notes::new(file), entries: yaml::mapping(text, file)? };
    let mut map = header.map()?;
    let (resolution, origin) = (header.resolution()?, header.origin()?);
    let (image, at) = header.image()?;
    header.warn_about_the_rest();
    let limit = MAX_IMAGE_BYTES;
    let source =
        files.read(&image, file, limit).map_err(|error| unreadable(&error, &image, file, at, limit))?;
    let pixels = decode_image(&source)?;
    map.image = image;
    map.grid = OccupancyGrid::unknown(pixels.width() as usize, pixels.height() as usize, resolution, origin)
        .map_err(|error| too_large(&error, file, at))?;
    map.fill(&pixels);
    Ok(header.notes.finish(map))
}

/// The world of a map: outlines of its occupied cells.
pub(super) fn to_world(map: &RosMap, file: &str) -> Result<World, FormatError> {
    grid_to_world(&map.grid, file)
}

/// The world of a grid; fails if it has too many walls.
pub(super) fn grid_to_world(grid: &OccupancyGrid, file: &str) -> Result<World, FormatError> {
    let walls = grid.count_walls();
    if walls <= MAX_WALLS {
        return Ok(grid.to_world());
    }
    let (found, expected) = (format!("a map of {walls} walls"), format!("at most {MAX_WALLS} walls"));
    Err(FormatError::new(file, Location::START, found, expected))
}

fn too_large(error: &ParameterError, file: &str, at: Location) -> FormatError {
    FormatError::new(file, at, error.to_string(), "a map of a size that fits")
}

/// Unread entries of a YAML file.
struct Header<'f> {
    notes: Notes<'f>,
    entries: Vec<(Scalar, Value)>,
}

impl Header<'_> {
    fn map(&mut self) -> Result<RosMap, FormatError> {
        let empty = OccupancyGrid::unknown(0, 0, 1.0, Pose::default());
        let empty = empty.map_err(|error| too_large(&error, self.notes.file, Location::START))?;
        let mut map = RosMap::new("", empty);
        map.mode = self.mode()?;
        map.negate = self.negate()?;
        map.occupied_threshold = self.threshold("occupied_thresh", map.occupied_threshold)?;
        let at = self.find("free_thresh").map_or(Location::START, Value::at);
        map.free_threshold = self.threshold("free_thresh", map.free_threshold)?;
        if map.free_threshold > map.occupied_threshold {
            let found = format!("the threshold {}", map.free_threshold);
            let expected = format!("at most occupied_thresh, which is {}", map.occupied_threshold);
            return Err(FormatError::new(self.notes.file, at, found, expected));
        }
        Ok(map)
    }

    fn mode(&mut self) -> Result<Mode, FormatError> {
        let expected = "the mode `trinary`, `scale` or `raw`";
        let Some(value) = self.take("mode") else { return Ok(Mode::Trinary) };
        let scalar = self.scalar(value, expected)?;
        match scalar.text.to_ascii_lowercase().as_str() {
            "trinary" => Ok(Mode::Trinary),
            "scale" => Ok(Mode::Scale),
            "raw" => Ok(Mode::Raw),
            _ => Err(self.wrong(&scalar, expected)),
        }
    }

    fn negate(&mut self) -> Result<bool, FormatError> {
        let expected = "0 or 1 for negate";
        let Some(value) = self.take_or_warn("negate", "0") else { return Ok(false) };
        let scalar = self.scalar(value, expected)?;
        match scalar.text.to_ascii_lowercase().as_str() {
            "0" | "false" | "no" | "off" => Ok(false),
            "1" | "true" | "yes" | "on" => Ok(true),
            _ => Err(self.wrong(&scalar, expected)),
        }
    }

    fn threshold(&mut self, key: &str, default: f64) -> Result<f64, FormatError> {
        let Some(value) = self.take_or_warn(key, &default.to_string()) else { return Ok(default) };
        let scalar = self.scalar(value, &format!("a number from 0 to 1 for {key}"))?;
        self.number(&scalar, &format!("{key} from 0 to 1"), |value| (0.0..=1.0).contains(&value))
    }

    fn resolution(&mut self) -> Result<f64, FormatError> {
        let value = self.require("resolution")?;
        let expected = "a resolution in metres per pixel, more than 0 and at most 1000";
        let scalar = self.scalar(value, expected)?;
        self.number(&scalar, expected, |value| value > 0.0 && value <= 1000.0)
    }

    fn origin(&mut self) -> Result<Pose, FormatError> {
        let expected = "an origin of three numbers, [x, y, yaw]";
        let list = match self.require("origin")? {
            Value::List(list, at) if list.len() != 3 => {
                let found = format!("a list of {}", list.len());
                return Err(FormatError::new(self.notes.file, at, found, expected));
            }
            Value::List(list, _) => list,
            Value::Scalar(scalar) => return Err(self.wrong(&scalar, expected)),
        };
        let number = |index: usize, what: &str| {
            let expected = format!("the origin's {what}, at most {MAX_METRES} either way");
            self.number(&list[index], &expected, |value: f64| value.abs() <= MAX_METRES)
        };
        Ok(Pose::new(number(0, "x in metres")?, number(1, "y in metres")?, number(2, "yaw in radians")?))
    }

    fn image(&mut self) -> Result<(String, Location), FormatError> {
        let value = self.require("image")?;
        let scalar = self.scalar(value, "the name of an image")?;
        if scalar.text.is_empty() {
            return Err(self.wrong(&scalar, "the name of an image"));
        }
        Ok((scalar.text, scalar.at))
    }

    fn warn_about_the_rest(&mut self) {
        for (key, _) in std::mem::take(&mut self.entries) {
            self.notes.warn(key.at, format!("unknown key {}; ignored", shown(&key.text)));
        }
    }

    fn find(&self, key: &str) -> Option<&Value> {
        self.entries.iter().find(|(k, _)| k.text == key).map(|(_, value)| value)
    }

    fn take(&mut self, key: &str) -> Option<Value> {
        let index = self.entries.iter().position(|(k, _)| k.text == key)?;
        Some(self.entries.remove(index).1)
    }

    fn take_or_warn(&mut self, key: &str, default: &str) -> Option<Value> {
        let value = self.take(key);
        if value.is_none() {
            self.notes.warn(Location::START, format!("no key `{key}`; {default} is taken"));
        }
        value
    }

    fn require(&mut self, key: &str) -> Result<Value, FormatError> {
        self.take(key).ok_or_else(|| {
            FormatError::new(
                self.notes.file,
                Location::START,
                format!("no key `{key}`"),
                format!("`{key}: …`"),
            )
        })
    }

    fn scalar(&self, value: Value, expected: &str) -> Result<Scalar, FormatError> {
        match value {
            Value::Scalar(scalar) => Ok(scalar),
            Value::List(_, at) => Err(FormatError::new(self.notes.file, at, "a list", expected)),
        }
    }

    fn number(
        &self,
        scalar: &Scalar,
        expected: &str,
        fits: impl Fn(f64) -> bool,
    ) -> Result<f64, FormatError> {
        let value = Some(scalar).filter(|s| s.plain).and_then(|s| number::parse(&s.text, 0));
        value.filter(|&value| fits(value)).ok_or_else(|| self.wrong(scalar, expected))
    }

    fn wrong(&self, scalar: &Scalar, expected: &str) -> FormatError {
        FormatError::new(self.notes.file, scalar.at, shown(&scalar.text), expected)
    }
}

impl RosMap {
    fn fill(&mut self, pixels: &DynamicImage) {
        let grays = pixels.as_luma8();
        // A table of all gray values avoids a division per pixel.
        let table: Vec<Option<u8>> = (0..=255u8).map(|v| self.occupancy(f64::from(v), false)).collect();
        let colours = if grays.is_none() { Some(pixels.to_rgba8()) } else { None };
        let height = self.grid.height();
        for row in 0..height {
            let y = (height - 1 - row) as u32;
            for column in 0..self.grid.width() {
                let x = column as u32;
                let percent = match (grays, &colours) {
                    (Some(gray), _) => table[usize::from(gray.get_pixel(x, y)[0])],
                    (None, Some(colours)) => self.colour_occupancy(colours.get_pixel(x, y).0),
                    (None, None) => None,
                };
                self.grid.set_occupancy(column, row, percent);
            }
        }
    }

    fn colour_occupancy(&self, [r, g, b, a]: [u8; 4]) -> Option<u8> {
        self.occupancy((f64::from(r) + f64::from(g) + f64::from(b)) / 3.0, a != 255)
    }
}

/// The YAML of a map.
pub fn print(map: &RosMap) -> String {
    let mode = match map.mode {
        Mode::Trinary => "trinary",
        Mode::Scale => "scale",
        Mode::Raw => "raw",
    };
    let number = |value| number::print(value, 0);
    let origin = map.grid.origin();
    let mut text = String::new();
    // Double-quoted YAML strings use the escapes of JSON and of Rust's debug output, for all characters of
    // file names.
    let image = map.image.replace('\\', "\\\\").replace('"', "\\\"").replace(['\n', '\r'], " ");
    let _ = writeln!(text, "image: \"{image}\"\nmode: {mode}\nresolution: {}", number(map.grid.resolution()));
    let (x, y, yaw) = (number(origin.x), number(origin.y), number(origin.heading));
    let _ = writeln!(text, "origin: [{x}, {y}, {yaw}]\nnegate: {}", u8::from(map.negate));
    let (occupied, free) = (number(map.occupied_threshold), number(map.free_threshold));
    let _ = writeln!(text, "occupied_thresh: {occupied}\nfree_thresh: {free}");
    text
}

/// Image of a map, in the format of the image's extension: PGM, PNG or BMP.
///
/// Fails if an occupancy has no pixel value under the map's mode and thresholds, or if an unknown cell in
/// mode *scale* needs a transparent pixel and the format is not PNG.
pub fn print_image(map: &RosMap) -> Result<Vec<u8>, FormatError> {
    let error =
        |found: String, expected: &str| FormatError::new(&map.image, Location::START, found, expected);
    let ending =
        Path::new(&map.image).extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    let (format, name) = match ending.as_str() {
        "pgm" => (ImageFormat::Pnm, "PGM"),
        "png" => (ImageFormat::Png, "PNG"),
        "bmp" => (ImageFormat::Bmp, "BMP"),
        _ => return Err(error(shown(&map.image), "an image name that ends in .pgm, .png or .bmp")),
    };
    let picture = match (map.draw(), name) {
        (Err(percent), _) => {
            let found = percent.map_or("an unknown cell".into(), |p| format!("a cell of {p} %"));
            return Err(error(found, "cells for which the mode and the thresholds have a pixel value"));
        }
        (Ok(DynamicImage::ImageLumaA8(_)), "PGM" | "BMP") => {
            return Err(error("an unknown cell".into(), "a PNG, which can hold transparent pixels"));
        }
        (Ok(picture), _) => picture,
    };
    let mut bytes = Vec::new();
    let written = if format == ImageFormat::Pnm {
        let graymap = image::codecs::pnm::PnmSubtype::Graymap(image::codecs::pnm::SampleEncoding::Binary);
        picture.write_with_encoder(image::codecs::pnm::PnmEncoder::new(&mut bytes).with_subtype(graymap))
    } else {
        picture.write_to(&mut Cursor::new(&mut bytes), format)
    };
    written.map_err(|e| error(format!("an image that cannot be written ({e})"), "a map with cells"))?;
    Ok(bytes)
}

impl RosMap {
    /// Picture of the cells; fails with an occupancy that has no pixel value.
    fn draw(&self) -> Result<DynamicImage, Option<u8>> {
        let transparent = self.mode == Mode::Scale && self.grid.count_unknown() > 0;
        let mut shades = [None; 102];
        // From both ends to the middle, so that black and white take precedence.
        for v in (0..128u8).flat_map(|v| [127 - v, 128 + v]) {
            shades[slot(self.occupancy(f64::from(v), false))] = Some(v);
        }
        let (width, height) = (self.grid.width() as u32, self.grid.height() as u32);
        let mut gray = GrayImage::new(width, height);
        let mut clear = image::GrayAlphaImage::new(if transparent { width } else { 0 }, height);
        for (x, y, pixel) in gray.enumerate_pixels_mut() {
            let percent = self.grid.occupancy(x as usize, (height - 1 - y) as usize);
            let see_through = transparent && percent.is_none();
            let shade = if see_through { Some(0) } else { shades[slot(percent)] };
            pixel[0] = shade.ok_or(percent)?;
            if transparent {
                clear.put_pixel(x, y, LumaA([pixel[0], if see_through { 0 } else { 255 }]));
            }
        }
        Ok(if transparent { DynamicImage::ImageLumaA8(clear) } else { DynamicImage::ImageLuma8(gray) })
    }
}

fn slot(percent: Option<u8>) -> usize {
    percent.map_or(101, usize::from)
}

/// Writes a map to files: the YAML at `path`, the image beside it.
pub fn save(map: &RosMap, path: impl AsRef<Path>) -> Result<(), FormatError> {
    let path = path.as_ref();
    let image = print_image(map)?;
    let write = |path: &Path, bytes: &[u8]| {
        write_whole(path, bytes).map_err(|error| {
            let found = format!("a file that cannot be written ({})", error.kind());
            FormatError::new(&path.display().to_string(), Location::START, found, "a folder to write to")
        })
    };
    write(&path.with_file_name("").join(&map.image), &image)?;
    write(path, print(map).as_bytes())
}

#[cfg(test)]
#[path = "ros_map_tests.rs"]
mod tests;
