use std::f64::consts::{FRAC_PI_3, TAU};

use super::{ImageError, NO_HUE, RgbView, RgbViewMut};
use crate::geometry::math;

/// Hue, saturation and intensity as in the book (section 11.4).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Hsi {
    /// The angle `acos(((R - G) + (R - B)) / 2 / sqrt((R - G)² + (R - B)(G - B)))`, subtracted from a full
    /// turn if blue exceeds green, in 255ths of a turn, rounded to the nearest, halves up: red 0, yellow 43,
    /// green 85, cyan 128, blue 170, magenta 213. [`NO_HUE`] for grays.
    pub hue: u8,
    /// `255 - 255 min(R, G, B) / I` with the unrounded intensity `I`, rounded to the nearest; 0 for black.
    pub saturation: u8,
    /// `(R + G + B) / 3`, rounded to the nearest.
    pub intensity: u8,
}

/// Converts red, green and blue to hue, saturation and intensity.
///
/// ```
/// use roverlab::vision::{Hsi, NO_HUE, rgb_to_hsi};
/// assert_eq!(rgb_to_hsi([0, 255, 0]), Hsi { hue: 85, saturation: 255, intensity: 85 });
/// assert_eq!(rgb_to_hsi([60, 60, 60]), Hsi { hue: NO_HUE, saturation: 0, intensity: 60 });
/// ```
pub fn rgb_to_hsi(pixel: [u8; 3]) -> Hsi {
    let [red, green, blue] = pixel.map(u32::from);
    let sum = red + green + blue;
    let least = red.min(green).min(blue);
    let saturation = if sum == 0 { 0 } else { 255 - (2 * 765 * least + sum - 1) / (2 * sum) };
    Hsi { hue: exact_hue(pixel), saturation: saturation as u8, intensity: ((2 * sum + 3) / 6) as u8 }
}

/// Tie-breaking offset: above the error of the angle, and below the distance of 1e-4 that all other colours
/// keep from a boundary between two hues.
const TIE: f64 = 1e-7;

fn exact_hue(pixel: [u8; 3]) -> u8 {
    let [red, green, blue] = pixel.map(f64::from);
    if red == green && green == blue {
        return NO_HUE;
    }
    let along = 0.5 * ((red - green) + (red - blue));
    let length = ((red - green) * (red - green) + (red - blue) * (green - blue)).sqrt();
    let angle = math::acos((along / length).clamp(-1.0, 1.0));
    let turn = if blue > green { TAU - angle } else { angle };
    // Yellow, cyan and magenta lie exactly between two hues.
    let part = turn * (255.0 / TAU) + TIE;
    // A full turn is red again.
    (part.round() as u32 % 255) as u8
}

/// Converts hue, saturation and intensity to red, green and blue, each rounded to the nearest and at most
/// 255. A pixel without hue becomes gray.
///
/// In the sector that starts at channel `a`, at an angle `h` after it, `a = I (1 + S cos h / cos(pi/3 - h))`;
/// the preceding channel is `I (1 - S)`; the following one makes the mean `I`.
///
/// ```
/// use roverlab::vision::{Hsi, hsi_to_rgb};
/// assert_eq!(hsi_to_rgb(Hsi { hue: 85, saturation: 255, intensity: 85 }), [0, 255, 0]);
/// ```
pub fn hsi_to_rgb(Hsi { hue, saturation, intensity }: Hsi) -> [u8; 3] {
    if hue == NO_HUE || saturation == 0 {
        return [intensity; 3];
    }
    let (saturation, intensity) = (f64::from(saturation) / 255.0, f64::from(intensity));
    let (sector, within) = (hue / 85, hue % 85);
    let angle = f64::from(within) * (TAU / 255.0);
    let lead = intensity * (1.0 + saturation * math::cos(angle) / math::cos(FRAC_PI_3 - angle));
    let least = intensity * (1.0 - saturation);
    let rest = 3.0 * intensity - lead - least;
    let byte = |value: f64| value.round().clamp(0.0, 255.0) as u8;
    let mut pixel = [lead, rest, least].map(byte);
    pixel.rotate_right(usize::from(sector));
    pixel
}

/// Converts an image to hue, saturation and intensity, stored in place of red, green and blue.
///
/// ```
/// use roverlab::vision::{RgbView, RgbViewMut, hsi_into, hsi_to_rgb_into};
/// let colours = [255, 0, 0, 0, 0, 255];
/// let (mut hsi, mut back) = ([0; 6], [0; 6]);
/// hsi_into(RgbView::new(&colours, 2, 1)?, RgbViewMut::new(&mut hsi, 2, 1)?)?;
/// assert_eq!(hsi, [0, 255, 85, 170, 255, 85], "red has hue 0, blue 170 of 255");
/// hsi_to_rgb_into(RgbView::new(&hsi, 2, 1)?, RgbViewMut::new(&mut back, 2, 1)?)?;
/// assert_eq!(back, colours);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
///
/// # Errors
///
/// If the sizes differ.
pub fn hsi_into(input: RgbView<'_>, mut output: RgbViewMut<'_>) -> Result<(), ImageError> {
    output.require_size(input.size())?;
    for y in 0..input.height() {
        let out = output.row_mut(y).as_chunks_mut::<3>().0;
        for (out, &pixel) in out.iter_mut().zip(input.row(y).as_chunks::<3>().0) {
            let Hsi { hue, saturation, intensity } = rgb_to_hsi(pixel);
            *out = [hue, saturation, intensity];
        }
    }
    Ok(())
}

/// Converts an image of hue, saturation and intensity back to colours; see [`hsi_to_rgb`].
///
/// # Errors
///
/// If the sizes differ.
pub fn hsi_to_rgb_into(input: RgbView<'_>, mut output: RgbViewMut<'_>) -> Result<(), ImageError> {
    output.require_size(input.size())?;
    for y in 0..input.height() {
        let out = output.row_mut(y).as_chunks_mut::<3>().0;
        for (out, &[hue, saturation, intensity]) in out.iter_mut().zip(input.row(y).as_chunks::<3>().0) {
            *out = hsi_to_rgb(Hsi { hue, saturation, intensity });
        }
    }
    Ok(())
}
