//! The kernels on images of the crate `image` (feature `image`). Each takes images and returns a new one,
//! with the result of the `_into` function named. They fail for images without pixels.
//!
//! From an image to its red regions:
//!
//! ```
//! use image::{Rgb, RgbImage};
//! use roverlab::vision::images;
//!
//! # fn main() -> Result<(), roverlab::vision::ImageError> {
//! let red_box = |x, y| (10..14).contains(&x) && (4..9).contains(&y);
//! let photo = RgbImage::from_fn(20, 12, |x, y| if red_box(x, y) { Rgb([200, 30, 20]) } else { Rgb([90, 90, 90]) });
//! let red = images::colour_match(&photo, [255, 0, 0], 20)?;
//! let blobs = images::blobs(&red, 4)?;
//! assert_eq!((blobs.len(), blobs[0].area, blobs[0].min), (1, 20, (10, 4)));
//! # Ok(())
//! # }
//! ```

use image::{GrayImage, RgbImage};

use super::{
    Blob, Border, Canny, CannyThresholds, Components, GaussianKernel, GrayView, GrayViewMut, GrayWeights,
    HueLimits, HueRange, HueScale, ImageError, RgbView, RgbViewMut, SobelScale, absolute_difference_into,
    gaussian_into, gray_into, gray_to_rgb_into, hsv_into, hsv_to_rgb_into, hue_into, hue_match_into,
    laplace_into, overlay_gray_into, sobel_l1_into, sobel_l2_into, threshold_into,
};

impl<'a> TryFrom<&'a GrayImage> for GrayView<'a> {
    type Error = ImageError;

    fn try_from(image: &'a GrayImage) -> Result<Self, ImageError> {
        Self::new(image.as_raw(), image.width() as usize, image.height() as usize)
    }
}

impl<'a> TryFrom<&'a RgbImage> for RgbView<'a> {
    type Error = ImageError;

    fn try_from(image: &'a RgbImage) -> Result<Self, ImageError> {
        Self::new(image.as_raw(), image.width() as usize, image.height() as usize)
    }
}

impl<'a> TryFrom<&'a mut GrayImage> for GrayViewMut<'a> {
    type Error = ImageError;

    fn try_from(image: &'a mut GrayImage) -> Result<Self, ImageError> {
        let (width, height) = (image.width() as usize, image.height() as usize);
        Self::new(image, width, height)
    }
}

impl<'a> TryFrom<&'a mut RgbImage> for RgbViewMut<'a> {
    type Error = ImageError;

    fn try_from(image: &'a mut RgbImage) -> Result<Self, ImageError> {
        let (width, height) = (image.width() as usize, image.height() as usize);
        Self::new(image, width, height)
    }
}

/// A gray image of a size, filled by a kernel.
fn gray_image(
    (width, height): (u32, u32),
    fill: impl FnOnce(GrayViewMut<'_>) -> Result<(), ImageError>,
) -> Result<GrayImage, ImageError> {
    let mut output = GrayImage::new(width, height);
    fill((&mut output).try_into()?)?;
    Ok(output)
}

/// A colour image of a size, filled by a kernel.
fn rgb_image(
    (width, height): (u32, u32),
    fill: impl FnOnce(RgbViewMut<'_>) -> Result<(), ImageError>,
) -> Result<RgbImage, ImageError> {
    let mut output = RgbImage::new(width, height);
    fill((&mut output).try_into()?)?;
    Ok(output)
}

/// Converts colour to gray; see [`gray_into`].
///
/// ```
/// let photo = image::RgbImage::from_pixel(2, 1, image::Rgb([200, 100, 40]));
/// let gray = roverlab::vision::images::gray(&photo, roverlab::vision::GrayWeights::Robios)?;
/// assert_eq!(gray.into_raw(), [110, 110]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
pub fn gray(image: &RgbImage, weights: GrayWeights) -> Result<GrayImage, ImageError> {
    gray_image(image.dimensions(), |output| gray_into(image.try_into()?, output, weights))
}

/// Converts gray to colour; see [`gray_to_rgb_into`].
///
/// ```
/// let gray = image::GrayImage::from_pixel(1, 1, image::Luma([7]));
/// assert_eq!(roverlab::vision::images::gray_to_rgb(&gray)?.into_raw(), [7, 7, 7]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
pub fn gray_to_rgb(image: &GrayImage) -> Result<RgbImage, ImageError> {
    rgb_image(image.dimensions(), |output| gray_to_rgb_into(image.try_into()?, output))
}

/// Smooths an image; see [`gaussian_into`].
///
/// ```
/// use roverlab::vision::{GaussianKernel, images};
/// let dot = image::GrayImage::from_fn(5, 5, |x, y| image::Luma([if (x, y) == (2, 2) { 160 } else { 0 }]));
/// let smooth = images::gaussian(&dot, GaussianKernel::new(3, 0.85)?)?;
/// assert!(smooth.get_pixel(2, 2).0 < dot.get_pixel(2, 2).0 && smooth.get_pixel(1, 2).0[0] > 0);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
pub fn gaussian(image: &GrayImage, kernel: GaussianKernel) -> Result<GrayImage, ImageError> {
    gray_image(image.dimensions(), |output| gaussian_into(image.try_into()?, output, kernel))
}

/// Sobel gradient, magnitude `|dx| + |dy|`; see [`sobel_l1_into`].
///
/// ```
/// use roverlab::vision::{Border, SobelScale, images};
/// let step = image::GrayImage::from_fn(6, 3, |x, _| image::Luma([if x < 3 { 10 } else { 40 }]));
/// let edges = images::sobel_l1(&step, SobelScale::Full, Border::Mirror)?;
/// assert_eq!(edges.as_raw()[6..12], [0, 0, 120, 120, 0, 0]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
pub fn sobel_l1(image: &GrayImage, scale: SobelScale, border: Border) -> Result<GrayImage, ImageError> {
    gray_image(image.dimensions(), |output| sobel_l1_into(image.try_into()?, output, scale, border))
}

/// Sobel gradient, Euclidean magnitude; see [`sobel_l2_into`].
///
/// ```
/// use roverlab::vision::{Border, SobelScale, images};
/// let step = image::GrayImage::from_fn(6, 3, |x, _| image::Luma([if x < 3 { 10 } else { 40 }]));
/// let edges = images::sobel_l2(&step, SobelScale::Full, Border::Mirror)?;
/// assert_eq!(edges.as_raw()[6..12], [0, 0, 120, 120, 0, 0]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
pub fn sobel_l2(image: &GrayImage, scale: SobelScale, border: Border) -> Result<GrayImage, ImageError> {
    gray_image(image.dimensions(), |output| sobel_l2_into(image.try_into()?, output, scale, border))
}

/// Absolute value of the Laplace operator; see [`laplace_into`].
///
/// ```
/// use roverlab::vision::{Border, images};
/// let dot = image::GrayImage::from_fn(3, 3, |x, y| image::Luma([if (x, y) == (1, 1) { 20 } else { 0 }]));
/// assert_eq!(images::laplace(&dot, Border::Zero)?.get_pixel(1, 1).0, [80]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
pub fn laplace(image: &GrayImage, border: Border) -> Result<GrayImage, ImageError> {
    gray_image(image.dimensions(), |output| laplace_into(image.try_into()?, output, border))
}

/// Canny's edges; see [`Canny::find_into`]. For image sequences, keep a [`Canny`].
///
/// ```
/// use roverlab::vision::{CannyThresholds, images};
/// let step = image::GrayImage::from_fn(8, 5, |x, _| image::Luma([if x < 4 { 10 } else { 200 }]));
/// let edges = images::canny(&step, CannyThresholds::default())?;
/// let columns: Vec<u32> = edges.enumerate_pixels().filter(|(_, _, edge)| edge.0[0] > 0).map(|(x, ..)| x).collect();
/// assert!(!columns.is_empty() && columns.iter().all(|column| (3..5).contains(column)));
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
pub fn canny(image: &GrayImage, thresholds: CannyThresholds) -> Result<GrayImage, ImageError> {
    gray_image(image.dimensions(), |output| Canny::new().find_into(image.try_into()?, output, thresholds))
}

/// Thresholds an image; see [`threshold_into`].
///
/// ```
/// let ramp = image::GrayImage::from_fn(4, 1, |x, _| image::Luma([60 * x as u8]));
/// assert_eq!(roverlab::vision::images::threshold(&ramp, 100)?.into_raw(), [0, 0, 255, 255]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
pub fn threshold(image: &GrayImage, threshold: u8) -> Result<GrayImage, ImageError> {
    gray_image(image.dimensions(), |output| threshold_into(image.try_into()?, output, threshold))
}

/// Absolute difference of two images; see [`absolute_difference_into`].
///
/// ```
/// let [a, b] = [30, 50].map(|gray| image::GrayImage::from_pixel(2, 1, image::Luma([gray])));
/// assert_eq!(roverlab::vision::images::absolute_difference(&a, &b)?.into_raw(), [20, 20]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
pub fn absolute_difference(image: &GrayImage, other: &GrayImage) -> Result<GrayImage, ImageError> {
    gray_image(image.dimensions(), |output| {
        absolute_difference_into(image.try_into()?, other.try_into()?, output)
    })
}

/// Hue of each pixel; see [`hue_into`].
///
/// ```
/// use roverlab::vision::{HueLimits, HueScale, images};
/// let green = image::RgbImage::from_pixel(1, 1, image::Rgb([0, 255, 0]));
/// assert_eq!(images::hues(&green, HueScale::Robios, HueLimits::default())?.into_raw(), [126]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
pub fn hues(image: &RgbImage, scale: HueScale, limits: HueLimits) -> Result<GrayImage, ImageError> {
    gray_image(image.dimensions(), |output| hue_into(image.try_into()?, output, scale, limits))
}

/// 255 where the hue is in a range, 0 elsewhere; see [`hue_match_into`].
///
/// ```
/// use roverlab::vision::{HueLimits, HueRange, HueScale, images};
/// let two = image::RgbImage::from_fn(2, 1, |x, _| image::Rgb(if x == 0 { [200, 20, 20] } else { [20, 20, 200] }));
/// let red = HueRange::like([255, 0, 0], 10, HueScale::Robios)?;
/// let mask = images::hue_match(&two, red, HueScale::Robios, HueLimits::default())?;
/// assert_eq!(mask.into_raw(), [255, 0]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
pub fn hue_match(
    image: &RgbImage,
    range: HueRange,
    scale: HueScale,
    limits: HueLimits,
) -> Result<GrayImage, ImageError> {
    gray_image(image.dimensions(), |output| hue_match_into(image.try_into()?, output, range, scale, limits))
}

/// 255 where the hue is less than `threshold` away from that of a sample, 0 elsewhere; see
/// [`HueRange::like`]. Hues are those of RoBIOS, a circle of 252. Dark and pale pixels have none
/// ([`HueLimits::default`]).
///
/// ```
/// use roverlab::vision::images;
/// let two = image::RgbImage::from_fn(2, 1, |x, _| image::Rgb(if x == 0 { [200, 20, 20] } else { [20, 20, 200] }));
/// assert_eq!(images::colour_match(&two, [255, 0, 0], 20)?.into_raw(), [255, 0]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
pub fn colour_match(image: &RgbImage, sample: [u8; 3], threshold: u8) -> Result<GrayImage, ImageError> {
    let scale = HueScale::Robios;
    hue_match(image, HueRange::like(sample, threshold, scale)?, scale, HueLimits::default())
}

/// Connected groups of at least `min_area` pixels that are not 0; see [`Components::find`]. For image
/// sequences, keep a [`Components`].
///
/// ```
/// let mask = image::GrayImage::from_fn(6, 1, |x, _| image::Luma([if x % 3 < 2 { 255 } else { 0 }]));
/// let blobs = roverlab::vision::images::blobs(&mask, 2)?;
/// assert_eq!(blobs.iter().map(|blob| blob.min).collect::<Vec<_>>(), [(0, 0), (3, 0)]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
pub fn blobs(mask: &GrayImage, min_area: usize) -> Result<Vec<Blob>, ImageError> {
    Ok(Components::new().find(mask.try_into()?, min_area).to_vec())
}

/// Hue, saturation and value of each pixel; see [`hsv_into`].
///
/// ```
/// let blue = image::RgbImage::from_pixel(1, 1, image::Rgb([0, 0, 255]));
/// assert_eq!(roverlab::vision::images::hsv(&blue)?.into_raw(), [120, 255, 255]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
pub fn hsv(image: &RgbImage) -> Result<RgbImage, ImageError> {
    rgb_image(image.dimensions(), |output| hsv_into(image.try_into()?, output))
}

/// Colours from hue, saturation and value; see [`hsv_to_rgb_into`].
///
/// ```
/// use roverlab::vision::images;
/// let blue = image::RgbImage::from_pixel(1, 1, image::Rgb([0, 0, 255]));
/// assert_eq!(images::hsv_to_rgb(&images::hsv(&blue)?)?, blue);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
pub fn hsv_to_rgb(image: &RgbImage) -> Result<RgbImage, ImageError> {
    rgb_image(image.dimensions(), |output| hsv_to_rgb_into(image.try_into()?, output))
}

/// Draws marks over a gray image; see [`overlay_gray_into`].
///
/// ```
/// use image::{GrayImage, Luma};
/// let gray = GrayImage::from_pixel(2, 1, Luma([9]));
/// let marks = GrayImage::from_fn(2, 1, |x, _| Luma([if x == 1 { 255 } else { 0 }]));
/// let image = roverlab::vision::images::overlay(&gray, &marks, [255, 0, 0])?;
/// assert_eq!(image.into_raw(), [9, 9, 9, 255, 0, 0]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
pub fn overlay(image: &GrayImage, marks: &GrayImage, colour: [u8; 3]) -> Result<RgbImage, ImageError> {
    rgb_image(image.dimensions(), |output| {
        overlay_gray_into(image.try_into()?, marks.try_into()?, colour, output)
    })
}
