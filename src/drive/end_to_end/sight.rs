use image::RgbImage;

use crate::ParameterError;
use crate::parameter::{require, require_count};
use crate::vision::network::MapSize;

/// Part of an image's height, from above, where a tilted camera sees the road.
const ROAD: [f64; 2] = [0.27, 0.93];
/// Largest side of what a network sees.
const MOST: usize = 4096;
/// Parts of red, green and blue in grey.
const GREY: [f32; 3] = [0.299, 0.587, 0.114];
/// Smallest deviation of pixels that counts, against division by zero in the dark.
const LEAST_DEVIATION: f64 = 1.0;

/// Writes what a network sees of a camera image: the part below the horizon in its number of rows and
/// columns, each the mean of the pixels there, in grey if the network has one channel, with mean 0 and
/// deviation 1, so that the light does not matter.
///
/// # Errors
///
/// If the network has other channels than one or three, the image has fewer pixels than it sees, or there is
/// room for more or fewer values.
pub fn see_road_into(image: &RgbImage, size: MapSize, values: &mut [f32]) -> Result<(), ParameterError> {
    check_sight(size)?;
    require_count("values of an image", values.len(), size.len())?;
    let (width, height) = (image.width() as usize, image.height() as usize);
    let [top, bottom] = ROAD.map(|part| (part * height as f64) as usize);
    let rows = bottom - top;
    require("width of the image", width as f64, width >= size.width, "as many pixels as the network sees")?;
    require("rows with road", rows as f64, rows >= size.height, "as many as the network sees")?;
    for (y, line) in values.chunks_exact_mut(size.width * size.channels).enumerate() {
        let [above, below] = [y, y + 1].map(|y| top + y * rows / size.height);
        for (x, place) in line.chunks_exact_mut(size.channels).enumerate() {
            let [left, right] = [x, x + 1].map(|x| x * width / size.width);
            let mut sums = [0_u64; 3];
            for row in above..below {
                let pixels = &image.as_raw()[3 * (row * width + left)..3 * (row * width + right)];
                for pixel in pixels.chunks_exact(3) {
                    for (sum, value) in sums.iter_mut().zip(pixel) {
                        *sum += u64::from(*value);
                    }
                }
            }
            let count = ((below - above) * (right - left)) as f32;
            let means = sums.map(|sum| sum as f32 / count);
            if let [place] = place {
                *place = GREY[0] * means[0] + GREY[1] * means[1] + GREY[2] * means[2];
            } else {
                place.copy_from_slice(&means);
            }
        }
    }
    normalise(values);
    Ok(())
}

/// An image, redder where a network looked at, by the [attention](crate::vision::network::Network::attention)
/// of places of a size that [`see_road_into`] showed it.
pub(super) fn redder(image: &RgbImage, size: MapSize, attention: &[f64]) -> RgbImage {
    let (width, height) = (image.width() as usize, image.height() as usize);
    let [top, bottom] = ROAD.map(|part| (part * height as f64) as usize);
    let mut shown = image.clone();
    for (x, y, pixel) in shown.enumerate_pixels_mut() {
        let (x, y) = (x as usize, y as usize);
        if (top..bottom).contains(&y) {
            let row = (y - top) * size.height / (bottom - top);
            let part = attention[row * size.width + x * size.width / width];
            for (channel, full) in pixel.0.iter_mut().zip([255.0, 0.0, 0.0]) {
                *channel = (f64::from(*channel) * (1.0 - part) + full * part) as u8;
            }
        }
    }
    shown
}

/// Fails for what no network can see of an image.
pub(super) fn check_sight(size: MapSize) -> Result<(), ParameterError> {
    require("channels of an image", size.channels as f64, matches!(size.channels, 1 | 3), "1 or 3")?;
    for side in [size.height, size.width] {
        require("side of an image", side as f64, (1..=MOST).contains(&side), "1 to 4096")?;
    }
    Ok(())
}

/// Shifts and scales values to mean 0 and deviation 1.
fn normalise(values: &mut [f32]) {
    let count = values.len() as f64;
    let mean = values.iter().map(|value| f64::from(*value)).sum::<f64>() / count;
    let square = |value: &f32| (f64::from(*value) - mean) * (f64::from(*value) - mean);
    let deviation = (values.iter().map(square).sum::<f64>() / count).sqrt().max(LEAST_DEVIATION);
    for value in values {
        *value = ((f64::from(*value) - mean) / deviation) as f32;
    }
}
