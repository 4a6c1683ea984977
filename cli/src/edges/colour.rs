//! Colour kernels.

use image::{GrayImage, RgbImage};
use roverlab::vision::{
    HueScale, ImageError, NO_HUE, hsi_into, hsi_to_rgb_into, hsv_into, hsv_to_rgb_into, hue as hue_of,
    hue_into, hue_match_into,
};

use super::parameters::Parameters;

/// Hue, saturation and intensity by the book's formulas, or hue, saturation and value as in `OpenCV`.
pub(crate) fn hsi(input: &RgbImage, p: &Parameters) -> Result<RgbImage, ImageError> {
    let mut output = RgbImage::new(input.width(), input.height());
    match p.scale {
        HueScale::Robios => hsi_into(input.try_into()?, (&mut output).try_into()?)?,
        HueScale::OpenCv => hsv_into(input.try_into()?, (&mut output).try_into()?)?,
    }
    Ok(output)
}

/// The inverse conversion.
pub(crate) fn hsi_to_rgb(input: &RgbImage, p: &Parameters) -> Result<RgbImage, ImageError> {
    let mut output = RgbImage::new(input.width(), input.height());
    match p.scale {
        HueScale::Robios => hsi_to_rgb_into(input.try_into()?, (&mut output).try_into()?)?,
        HueScale::OpenCv => hsv_to_rgb_into(input.try_into()?, (&mut output).try_into()?)?,
    }
    Ok(output)
}

/// One of the three channels.
pub(crate) fn channel(input: &RgbImage, p: &Parameters, channel: usize) -> Result<GrayImage, ImageError> {
    let whole = hsi(input, p)?;
    let bytes = whole.pixels().map(|pixel| pixel.0[channel]).collect();
    Ok(GrayImage::from_raw(input.width(), input.height(), bytes).unwrap_or_default())
}

/// Hues by the book's formulas; 0 for pixels with too little saturation or intensity.
pub(crate) fn exact_hue(input: &RgbImage, p: &Parameters) -> Result<GrayImage, ImageError> {
    let mut output = channel(input, p, 0)?;
    for (out, pixel) in output.iter_mut().zip(input.pixels()) {
        if hue_of(pixel.0, p.scale, p.exact_limits) == NO_HUE {
            *out = NO_HUE;
        }
    }
    Ok(output)
}

pub(crate) fn hue(input: &RgbImage, p: &Parameters) -> Result<GrayImage, ImageError> {
    let mut output = GrayImage::new(input.width(), input.height());
    hue_into(input.try_into()?, (&mut output).try_into()?, p.scale, p.limits)?;
    Ok(output)
}

/// White where the hue matches.
pub(crate) fn matches(input: &RgbImage, p: &Parameters) -> Result<GrayImage, ImageError> {
    let mut output = GrayImage::new(input.width(), input.height());
    hue_match_into(input.try_into()?, (&mut output).try_into()?, p.range, p.scale, p.limits)?;
    Ok(output)
}
