use std::io::Cursor;
use std::path::Path;

use image::codecs::pnm::{PnmEncoder, PnmSubtype, SampleEncoding};
use image::{DynamicImage, ImageError, ImageFormat, ImageResult};
use roverlab::files::write_whole;

/// Writes an image in the format of the file's extension, completely or with an error.
pub(crate) fn write_image(image: &DynamicImage, file: &Path) -> Result<(), ImageError> {
    let bytes = encoded(image, ImageFormat::from_path(file)?)?;
    write_whole(file, &bytes).map_err(ImageError::IoError)
}

fn encoded(image: &DynamicImage, format: ImageFormat) -> ImageResult<Vec<u8>> {
    let mut bytes = Cursor::new(Vec::new());
    if format == ImageFormat::Pnm {
        // Formats that all programs read: P5 for grayscale, P6 for colour.
        let kind = if image.color().has_color() {
            PnmSubtype::Pixmap(SampleEncoding::Binary)
        } else {
            PnmSubtype::Graymap(SampleEncoding::Binary)
        };
        image.write_with_encoder(PnmEncoder::new(&mut bytes).with_subtype(kind))?;
    } else {
        image.write_to(&mut bytes, format)?;
    }
    Ok(bytes.into_inner())
}
