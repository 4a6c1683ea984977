//! Pictures as maps (book, section 10.3): dark pixels are obstacles, light ones free. PGM, PNG or BMP.
//!
//! Each pixel is a cell; the upper left one is the first of the first row. It is blocked if its brightness,
//! the mean of red, green and blue, is less than half of white. Transparency is ignored.

use std::path::Path;

use super::error::{FormatError, Location, Notes, Parsed};
use super::image_file::decode_image;
use super::limits::MAX_IMAGE_BYTES;
use super::source::{SourceFile, read_limited, unreadable};
use crate::world::BitGrid;

/// Reads a picture from a file.
pub fn load(path: impl AsRef<Path>) -> Result<Parsed<BitGrid>, FormatError> {
    let name = path.as_ref().display().to_string();
    let bytes = read_limited(path.as_ref(), MAX_IMAGE_BYTES)
        .map_err(|error| unreadable(&error, &name, &name, Location::START, MAX_IMAGE_BYTES))?;
    parse(&SourceFile { name, bytes })
}

/// Reads a picture.
///
/// ```
/// use roverlab::world::GridCell;
/// use roverlab::world::formats::{SourceFile, bitmap};
/// let name = "floor plan.pgm".to_string();
/// let grid = bitmap::parse(&SourceFile { name, bytes: b"P5 3 1 255\n\xff\x00\xff".to_vec() })?.value;
/// assert!(grid.is_free(GridCell::new(0, 0)) && !grid.is_free(GridCell::new(1, 0)), "black is a wall");
/// // From a file:
/// assert!(bitmap::load("no such plan.png").unwrap_err().to_string().contains("no such plan.png"));
/// # Ok::<(), roverlab::world::formats::FormatError>(())
/// ```
pub fn parse(source: &SourceFile) -> Result<Parsed<BitGrid>, FormatError> {
    let picture = decode_image(source)?;
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let grid = if let Some(gray) = picture.as_luma8() {
        BitGrid::from_fn(width, height, |x, y| gray.get_pixel(x as u32, y as u32)[0] >= 128)
    } else {
        let colours = picture.to_rgb8();
        BitGrid::from_fn(width, height, |x, y| {
            let pixel = colours.get_pixel(x as u32, y as u32).0;
            // Three times 127.5, half-way between black and white.
            2 * pixel.map(u32::from).iter().sum::<u32>() >= 765
        })
    };
    let error = |error: crate::world::BitGridError| {
        FormatError::new(&source.name, Location::START, error.to_string(), "a picture of a size that fits")
    };
    Ok(Notes::new(&source.name).finish(grid.map_err(error)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::GridCell;

    fn file(name: &str, bytes: &[u8]) -> SourceFile {
        SourceFile { name: name.into(), bytes: bytes.into() }
    }

    #[test]
    fn dark_pixels_are_blocked() {
        let grid = parse(&file("m.pgm", b"P5 3 2 255\n\x00\x7f\x80\xff\x01\xfe")).unwrap().value;
        let free: Vec<_> = grid.free_cells().collect();
        assert_eq!(free, [GridCell::new(2, 0), GridCell::new(0, 1), GridCell::new(2, 1)]);
        let colours = parse(&file("m.ppm", b"P6 2 1 255\n\xff\xff\x00\xff\x00\x00")).unwrap().value;
        assert_eq!(colours.free_cells().collect::<Vec<_>>(), [GridCell::new(0, 0)]);
    }

    #[test]
    fn what_is_no_picture_is_named() {
        let error = parse(&file("m.png", b"P5 3 2")).unwrap_err().to_string();
        assert!(error.starts_with("m.png:1:1: found a broken image"), "{error}");
        assert!(load("nowhere.png").unwrap_err().to_string().contains("which does not exist"));
    }
}
