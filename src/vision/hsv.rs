use super::dispatch::vectorised_filter;
use super::hue::{fixed_point, opencv};
use super::planes::{PIECE, merge, split};
use super::view::flatten;
use super::{ImageError, RgbView, RgbViewMut};

/// Hue, saturation and value as in OpenCV.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Hsv {
    /// 0 to 179; see [`HueScale::OpenCv`](super::HueScale::OpenCv).
    pub hue: u8,
    /// `255 d / largest channel`, rounded: `(d t + 2048) / 4096` rounded down, where `d` is the difference
    /// between the largest and smallest channel and `t` is `1044480 / largest`, rounded to the nearest; 0 for
    /// black.
    pub saturation: u8,
    /// Largest channel.
    pub value: u8,
}

/// Converts red, green and blue to hue, saturation and value.
///
/// ```
/// use roverlab::vision::{Hsv, rgb_to_hsv};
/// assert_eq!(rgb_to_hsv([0, 200, 0]), Hsv { hue: 60, saturation: 255, value: 200 });
/// ```
#[inline(always)]
pub fn rgb_to_hsv([red, green, blue]: [u8; 3]) -> Hsv {
    let value = red.max(green).max(blue);
    let difference = value - red.min(green).min(blue);
    let saturation = fixed_point(i16::from(difference), 255.0, value) as u8;
    Hsv { hue: opencv([red, green, blue], value, difference), saturation, value }
}

/// Converts an image to hue, saturation and value, stored in place of red, green and blue.
///
/// ```
/// use roverlab::vision::{RgbView, RgbViewMut, hsv_into, hsv_to_rgb_into};
/// let colours = [255, 0, 0, 0, 0, 255];
/// let (mut hsv, mut back) = ([0; 6], [0; 6]);
/// hsv_into(RgbView::new(&colours, 2, 1)?, RgbViewMut::new(&mut hsv, 2, 1)?)?;
/// assert_eq!(hsv, [0, 255, 255, 120, 255, 255], "red has hue 0, blue 120 of 180");
/// hsv_to_rgb_into(RgbView::new(&hsv, 2, 1)?, RgbViewMut::new(&mut back, 2, 1)?)?;
/// assert_eq!(back, colours);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
///
/// # Errors
///
/// If the sizes differ.
pub fn hsv_into(input: RgbView<'_>, output: RgbViewMut<'_>) -> Result<(), ImageError> {
    output.require_size(input.size())?;
    let (input, mut output) = flatten(input, output);
    convert(input, &mut output);
    Ok(())
}

/// Converts hue, saturation and value to red, green and blue, in single precision as in OpenCV.
///
/// In sector `k` of six, with the fraction `f` of it before the hue, the channels are `V`, `V (1 - S)` and
/// `V (1 - S f)` or `V (1 - S (1 - f))`, rounded down. A product subtracted from 1 is rounded together with
/// the difference. (OpenCV rounds the few pixels at the end of a row that do not fill a register to the
/// nearest.)
///
/// ```
/// use roverlab::vision::{Hsv, hsv_to_rgb};
/// assert_eq!(hsv_to_rgb(Hsv { hue: 60, saturation: 255, value: 255 }), [0, 255, 0]);
/// ```
pub fn hsv_to_rgb(Hsv { hue, saturation, value }: Hsv) -> [u8; 3] {
    let (saturation, value) = (f32::from(saturation) * (1.0 / 255.0), f32::from(value) * (1.0 / 255.0));
    let sixths = f32::from(hue) * (6.0 / 180.0);
    let sector = sixths.floor();
    let within = sixths - sector;
    // The product of two floats is exact in double precision.
    let without = |part: f32| value * (1.0 - f64::from(saturation) * f64::from(part)) as f32;
    let (least, falling, rising) = (without(1.0), without(within), without(1.0 - within));
    let colour = match sector as u8 % 6 {
        0 => [value, rising, least],
        1 => [falling, value, least],
        2 => [least, value, rising],
        3 => [least, falling, value],
        4 => [rising, least, value],
        _ => [value, least, falling],
    };
    colour.map(|channel| (channel * 255.0) as u8)
}

/// Converts an image of hue, saturation and value back to colours; see [`hsv_to_rgb`].
///
/// # Errors
///
/// If the sizes differ.
pub fn hsv_to_rgb_into(input: RgbView<'_>, mut output: RgbViewMut<'_>) -> Result<(), ImageError> {
    output.require_size(input.size())?;
    for y in 0..input.height() {
        let out = output.row_mut(y).as_chunks_mut::<3>().0;
        for (out, &[hue, saturation, value]) in out.iter_mut().zip(input.row(y).as_chunks::<3>().0) {
            *out = hsv_to_rgb(Hsv { hue, saturation, value });
        }
    }
    Ok(())
}

#[inline(always)]
pub(super) fn convert_portable(input: RgbView<'_>, output: &mut RgbViewMut<'_>) {
    let (mut red, mut green, mut blue) = ([0; PIECE], [0; PIECE], [0; PIECE]);
    for y in 0..input.height() {
        let pixels = input.row(y).as_chunks::<3>().0.chunks(PIECE);
        for (pixels, out) in pixels.zip(output.row_mut(y).as_chunks_mut::<3>().0.chunks_mut(PIECE)) {
            split(pixels, &mut red, &mut green, &mut blue);
            for ((red, green), blue) in red.iter_mut().zip(&mut green).zip(&mut blue) {
                let Hsv { hue, saturation, value } = rgb_to_hsv([*red, *green, *blue]);
                (*red, *green, *blue) = (hue, saturation, value);
            }
            merge(out, &red, &green, &blue);
        }
    }
}

vectorised_filter! {
    fn convert(input: RgbView<'_>, output: &mut RgbViewMut<'_>) {
        convert_portable(input, output);
    }
}
