//! Images named by other files: PNG, JPEG, BMP, and PGM and related formats.

use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

use image::{DynamicImage, ImageFormat, ImageReader};

use super::error::{FormatError, Location, Notes};
use super::limits::MAX_IMAGE_BYTES;
use super::source::{Files, SourceFile};
use crate::world::{OccupancyGrid, Texture};

/// Finds and reads a texture that a file names. If a missing one is tolerated, `instead` describes the
/// replacement.
pub(super) fn load(
    texture: &mut Texture,
    named: (&str, Location),
    files: &mut Files<'_>,
    notes: &mut Notes<'_>,
    instead: &str,
) -> Result<(), FormatError> {
    let file = texture.file.to_string_lossy().into_owned();
    let image = files.read(&file, named, MAX_IMAGE_BYTES).and_then(|source| decode_image(&source));
    let image = files.get_over(image, instead, notes)?;
    texture.image = image.map(|image| Arc::new(image.into_rgba8()));
    Ok(())
}

/// Memory limit of image decoding (bytes).
const MAX_DECODED_BYTES: u64 = 128 << 20;

pub(super) fn decode_image(source: &SourceFile) -> Result<DynamicImage, FormatError> {
    let error =
        |found: String, expected: &str| FormatError::new(&source.name, Location::START, found, expected);
    let mut reader = ImageReader::new(Cursor::new(&source.bytes));
    let ending = Path::new(&source.name).extension().and_then(|e| e.to_str()).unwrap_or("");
    let by_name = ImageFormat::from_extension(ending);
    if let Some(format) = image::guess_format(&source.bytes).ok().or(by_name) {
        reader.set_format(format);
    }
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(MAX_DECODED_BYTES);
    reader.limits(limits);
    let decoded = reader.decode().map_err(|e| {
        let expected = match &e {
            image::ImageError::Limits(_) => "an image of at most 128 MiB when decoded",
            _ => "a whole PNG, JPEG, BMP or PGM image",
        };
        error(format!("a broken image ({e})"), expected)
    })?;
    if decoded.width() == 0 || decoded.height() == 0 {
        let found = format!("an image of {} by {} pixels", decoded.width(), decoded.height());
        return Err(error(found, "at least one pixel"));
    }
    let cells = u64::from(decoded.width()) * u64::from(decoded.height());
    if cells > OccupancyGrid::MAX_CELLS as u64 {
        return Err(error(format!("an image of {cells} pixels"), "at most 33554432 pixels"));
    }
    Ok(decoded)
}
