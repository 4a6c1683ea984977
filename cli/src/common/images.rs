use std::io::Cursor;
use std::path::Path;

use image::codecs::pnm::{PnmEncoder, PnmSubtype, SampleEncoding};
use image::{DynamicImage, ImageError, ImageFormat, ImageResult};

/// Writes an image in the format that the name of the file asks for: whole, or an error says why not.
pub(crate) fn write_image(image: &DynamicImage, file: &Path) -> Result<(), ImageError> {
    let bytes = encoded(image, ImageFormat::from_path(file)?)?;
    // A writer with a buffer would lose the errors of its last bytes.
    std::fs::write(file, bytes).map_err(ImageError::IoError)
}

fn encoded(image: &DynamicImage, format: ImageFormat) -> ImageResult<Vec<u8>> {
    let mut bytes = Cursor::new(Vec::new());
    if format == ImageFormat::Pnm {
        // What all programs read: P5 for shades of gray, P6 for colours.
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
