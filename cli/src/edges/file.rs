//! A kernel on an image file.

use std::io::BufReader;
use std::path::Path;

use image::{DynamicImage, RgbImage};
use roverlab::files::open_regular;

use super::checks::refused;
use super::kernel::Runner;
use super::{Args, Processed};
use crate::common::{Failure, Outcome, Report, Stopwatch, rounded, write_image};

pub(crate) fn work(args: &Args, input: &Path) -> Result<Report, Failure> {
    let image = load("--input", input)?;
    let second = args.second.as_deref().map(|file| load("--second", file)).transpose()?;
    if args.kernel.needs_second() && second.is_none() {
        let kernel = args.kernel.name();
        return Err(Failure::input(format!("--kernel {kernel}: found one image; expected --second FILE")));
    }
    let mut runner = Runner::new(args).map_err(|error| refused(&error))?;
    let (mut result, mut fastest) = (None, f64::INFINITY);
    for _ in 0..args.repeat {
        let stopwatch = Stopwatch::start();
        let processed = runner.run(&image, second.as_ref()).map_err(|error| refused(&error))?;
        fastest = fastest.min(stopwatch.seconds());
        result = Some(processed);
    }
    let Some(Processed { image: output, fields }) = result else {
        return Err(Failure::input("--repeat: found 0; expected at least 1"));
    };
    if let Some(file) = &args.output {
        save(&output, file)?;
    }
    let pixels = f64::from(image.width()) * f64::from(image.height());
    let bytes = output.as_bytes();
    let mean = bytes.iter().map(|&byte| f64::from(byte)).sum::<f64>() / bytes.len().max(1) as f64;
    let report = Report::new(Outcome::verdict("filtered"))
        .field("kernel", args.kernel.name())
        .field("definition", args.definition.name())
        .field("width", image.width())
        .field("height", image.height())
        .field("output", args.output.clone())
        .timing("ns_per_pixel", 1e9 * fastest / pixels)
        .field("mean", rounded(mean));
    Ok(fields.into_iter().fold(report, |report, (name, value)| report.field(name, value)))
}

/// Loads an image file in colour.
fn load(option: &str, file: &Path) -> Result<RgbImage, Failure> {
    let wrong = |error: &dyn std::fmt::Display| {
        Failure::input(format!("{option} {}: {error}; expected a PNG, PNM or BMP image", file.display()))
    };
    let opened = open_regular(file).map_err(|error| wrong(&error))?;
    let reader = image::ImageReader::new(BufReader::new(opened));
    let reader = reader.with_guessed_format().map_err(|error| wrong(&error))?;
    let image = eight_bits(reader.decode().map_err(|error| wrong(&error))?);
    if image.width() == 0 || image.height() == 0 {
        return Err(wrong(&"the image has no pixels"));
    }
    Ok(image)
}

/// Red, green and blue with eight bits each: the upper bits of files with sixteen, as in OpenCV.
fn eight_bits(image: DynamicImage) -> RgbImage {
    let deep = matches!(
        image,
        DynamicImage::ImageLuma16(_)
            | DynamicImage::ImageLumaA16(_)
            | DynamicImage::ImageRgb16(_)
            | DynamicImage::ImageRgba16(_)
    );
    if !deep {
        return image.into_rgb8();
    }
    let deep = image.into_rgb16();
    RgbImage::from_fn(deep.width(), deep.height(), |x, y| {
        image::Rgb(deep.get_pixel(x, y).0.map(|sample| (sample >> 8) as u8))
    })
}

/// Writes an image in the format of its extension.
pub(crate) fn save(image: &DynamicImage, file: &Path) -> Result<(), Failure> {
    write_image(image, file).map_err(|error| {
        Failure::input(format!(
            "--output {}: {error}; expected a file ending in .png, .pgm, .ppm or .bmp that can be written",
            file.display()
        ))
    })
}
