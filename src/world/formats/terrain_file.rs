//! Terrain files of a world: a gray image or an ESRI ASCII grid.

use image::DynamicImage;

use super::elevation_grid;
use super::error::{FormatError, Location, Notes};
use super::image_file::decode_image;
use super::lexer::shown;
use super::limits::{MAX_GRID_BYTES, MAX_IMAGE_BYTES};
use super::source::{Files, SourceFile, decode};
use crate::ParameterError;
use crate::geometry::{Aabb, Point};
use crate::world::{HeightField, Terrain};

/// Extensions of terrain files.
pub(super) const ENDINGS: &[&str] = &[".png", ".jpg", ".jpeg", ".bmp", ".asc"];

/// Reads the terrain that a file names at a location. If a missing one is tolerated, `instead` describes the
/// replacement.
///
/// Errors of an image are reported where it is named, errors of a grid at their location in the grid.
pub(super) fn load(
    terrain: &mut Terrain,
    named: (&str, Location),
    files: &mut Files<'_>,
    notes: &mut Notes<'_>,
    instead: &str,
) -> Result<(), FormatError> {
    let file = terrain.file.to_string_lossy().into_owned();
    let is_grid = file.to_ascii_lowercase().ends_with(".asc");
    let limit = if is_grid { MAX_GRID_BYTES } else { MAX_IMAGE_BYTES };
    let surface = files.read(&file, named, limit).and_then(|source| {
        if is_grid { from_grid(source, terrain, named, notes) } else { from_image(&source, terrain, named) }
    });
    let surface = files.get_over(surface, instead, notes)?;
    terrain.surface = surface.map(std::sync::Arc::new);
    Ok(())
}

fn from_grid(
    source: SourceFile,
    terrain: &Terrain,
    named: (&str, Location),
    notes: &mut Notes<'_>,
) -> Result<HeightField, FormatError> {
    let name = source.name;
    let mut own = Notes::new(&name);
    let text = decode(source.bytes, &mut own)?;
    let grid = elevation_grid::parse(&text, &name)?;
    notes.extend(own.finish(()).warnings);
    notes.extend(grid.warnings);
    let surface = grid.value.scaled(terrain.width, terrain.height, terrain.max_elevation);
    surface.map_err(|error| misplaced(&error, named))
}

fn from_image(
    source: &SourceFile,
    terrain: &Terrain,
    named: (&str, Location),
) -> Result<HeightField, FormatError> {
    let here = |found: &str, expected: String| {
        FormatError::new(named.0, named.1, format!("{}, {found}", shown(&source.name)), expected)
    };
    let image = decode_image(source).map_err(|error| here(&error.found, error.expected))?;
    let most = HeightField::MAX_SAMPLES;
    let (columns, rows) = (image.width() as usize, image.height() as usize);
    if columns.max(rows) > most {
        let found = format!("an image of {columns} by {rows} pixels");
        return Err(here(&found, format!("at most {most} by {most} pixels")));
    }
    let heights = heights(image, terrain.max_elevation);
    // A single row or column of pixels is extended at constant height.
    let widened: Vec<f32> = match (columns, rows) {
        (1, _) => heights.iter().flat_map(|&height| [height, height]).collect(),
        _ => heights,
    };
    let twice = if rows == 1 { widened.repeat(2) } else { widened };
    let area = Aabb::new(Point::origin(), Point::new(terrain.width, terrain.height));
    let surface = HeightField::new(columns.max(2), rows.max(2), area, twice);
    surface.map_err(|error| misplaced(&error, named))
}

/// Rows of elevations from the smallest y, which is the image's last row.
fn heights(image: DynamicImage, top: f64) -> Vec<f32> {
    let width = image.width() as usize;
    let gray = image.into_luma16();
    let height = |level: &u16| (f64::from(*level) / f64::from(u16::MAX) * top) as f32;
    gray.as_raw().chunks(width).rev().flat_map(|row| row.iter().map(height)).collect()
}

/// The error for an invalid size, located in the world's file.
fn misplaced(error: &ParameterError, (file, at): (&str, Location)) -> FormatError {
    let found = format!("{} {}", error.name(), error.value());
    FormatError::new(file, at, found, error.expected())
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use image::{ImageBuffer, ImageFormat, Luma, Rgb};

    use super::*;
    use crate::world::World;
    use crate::world::formats::{MemoryFiles, Parsed, wld};

    fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    fn read(line: &str, file: (&str, Vec<u8>), tolerant: bool) -> Result<Parsed<World>, FormatError> {
        let mut memory = MemoryFiles([(file.0.to_owned(), file.1)].into());
        wld::parse_with_images(line, "hills.wld", &mut Files::new(&mut memory, tolerant))
    }

    fn surface(line: &str, file: (&str, Vec<u8>)) -> HeightField {
        let terrain = read(line, file, false).unwrap().value.terrain.unwrap();
        std::sync::Arc::unwrap_or_clone(terrain.surface.unwrap())
    }

    /// The upper left pixel is white: smallest x and largest y.
    #[test]
    fn an_image_lies_as_a_floor_does_whatever_its_format() {
        let gray = ImageBuffer::from_fn(8, 8, |x, y| Luma([if x < 4 && y < 4 { 255_u8 } else { 0 }]));
        let gray = DynamicImage::from(gray);
        let colour = DynamicImage::from(gray.to_rgb8());
        for (name, image, format) in [
            ("a.png", &gray, ImageFormat::Png),
            ("a.png", &colour, ImageFormat::Png),
            ("a.bmp", &colour, ImageFormat::Bmp),
            ("a.jpg", &colour, ImageFormat::Jpeg),
        ] {
            let line = format!("terrain 7000 14000 500 {name}");
            let surface = surface(&line, (name, encoded(image, format)));
            assert_eq!((surface.columns(), surface.rows()), (8, 8));
            assert_eq!(surface.area().max, Point::new(7.0, 14.0));
            // JPEG uses blocks of 8 by 8 pixels, with rounding.
            let near = |x: f64, y: f64, z: f64| (surface.height(Point::new(x, y)).unwrap() - z).abs() < 0.05;
            assert!(near(0.0, 14.0, 0.5) && near(7.0, 14.0, 0.0), "{name}");
            assert!(near(0.0, 0.0, 0.0) && near(7.0, 0.0, 0.0), "{name}");
        }
    }

    #[test]
    fn sixteen_bits_count() {
        let image = ImageBuffer::from_fn(2, 2, |x, _| Luma([if x == 0 { 1_u16 } else { 65_535 }]));
        let surface =
            surface("terrain 1000 1000 65535 a.png", ("a.png", encoded(&image.into(), ImageFormat::Png)));
        assert_eq!(surface.height(Point::new(0.0, 0.5)), Some(f64::from(0.001_f32)));
        assert_eq!(surface.height(Point::new(1.0, 0.5)), Some(f64::from(65.535_f32)));
    }

    #[test]
    fn a_single_row_or_pixel_is_level_across() {
        for (width, height) in [(1, 1), (1, 3), (3, 1)] {
            let image = ImageBuffer::from_pixel(width, height, Rgb([51_u8; 3]));
            let surface =
                surface("terrain 1000 1000 500 a.bmp", ("a.bmp", encoded(&image.into(), ImageFormat::Bmp)));
            assert!((surface.height(Point::new(0.4, 0.9)).unwrap() - 0.1).abs() < 1e-6);
        }
    }

    #[test]
    fn a_grid_is_scaled_to_its_top() {
        let grid = b"ncols 2\nnrows 2\ncellsize 30\n300 200\n250 100\n".to_vec();
        let surface = surface("terrain 2000 3000 400 relief.asc", ("relief.asc", grid));
        assert_eq!((surface.lowest(), surface.height(Point::new(0.0, 3.0))), (0.0, Some(f64::from(0.4_f32))));
    }

    #[test]
    fn what_is_wrong_is_told_at_its_place() {
        let message = |line: &str, name: &str, bytes: &[u8]| {
            read(line, (name, bytes.to_vec()), false).unwrap_err().to_string()
        };
        let broken = message("floor 1 1\nterrain 1000 1000 50 a.png\n", "a.png", b"broken");
        assert!(broken.starts_with("hills.wld:2:22: found `a.png`, a broken image"), "{broken}");
        let missing = message("terrain 1000 1000 50 a.png", "b.png", b"");
        assert!(missing.starts_with("hills.wld:1:22: found `a.png`, which does not exist"), "{missing}");
        let wide = DynamicImage::new_luma8(4098, 2);
        let wide = message("terrain 1000 1000 50 a.png", "a.png", &encoded(&wide, ImageFormat::Png));
        assert_eq!(
            wide,
            "hills.wld:1:22: found `a.png`, an image of 4098 by 2 pixels; expected at most 4097 by 4097 pixels"
        );
        let pixel = encoded(&DynamicImage::new_luma8(1, 1), ImageFormat::Png);
        let flat = message("terrain 0 1000 50 a.png", "a.png", &pixel);
        assert_eq!(flat, "hills.wld:1:19: found terrain width 0; expected more than 0");
        let grid = message("terrain 1000 1000 50 a.asc", "a.asc", b"ncols 2\nnrows x");
        assert!(grid.starts_with("a.asc:2:7: found `x`"), "{grid}");
        let tolerant = read("terrain 1000 1000 50 a.png", ("a.png", b"broken".to_vec()), true).unwrap();
        assert_eq!(tolerant.value.terrain, None);
        let last = tolerant.warnings.last().unwrap().to_string();
        assert!(last.ends_with("the floor is level"), "{last}");
    }
}
