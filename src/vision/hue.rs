use super::dispatch::vectorised_filter;
use super::view::flatten;
use super::{GrayViewMut, ImageError, RgbView, planes};

/// Hue of a pixel without a hue.
pub const NO_HUE: u8 = 255;

/// Number scale of hues. Both use integer arithmetic on the largest channel, the smallest, and their
/// difference `d`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum HueScale {
    /// RoBIOS: a circle of 252; red is 42, green 126, blue 210.
    ///
    /// `42 + 42 (green - blue) / d` if red is largest, else `126 + 42 (blue - red) / d` if green is, else
    /// `210 + 42 (red - green) / d`; quotients are rounded towards zero.
    #[default]
    Robios,
    /// OpenCV: a circle of 180; red is 0, green 60, blue 120.
    ///
    /// `30 n / d` with `n` in sixths: `green - blue`, `blue - red + 2 d` or `red - green + 4 d`. In fixed
    /// point: `(n t + 2048) / 4096` rounded down, where `t` is `122880 / d` rounded to the nearest; plus 180
    /// if negative. The hue is 0 where `d` is 0.
    OpenCv,
}

/// Minimum saturation and intensity of pixels that have a hue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct HueLimits {
    /// Minimum HSV saturation, 0 to 255: `255 d >= min_saturation * largest channel`.
    pub min_saturation: u8,
    /// Minimum of `(red + blue) / 4 + green / 2`, each quotient rounded down.
    pub min_intensity: u8,
}

impl HueLimits {
    /// No limits: every pixel that is not gray has a hue.
    pub const NONE: Self = Self { min_saturation: 0, min_intensity: 0 };
}

impl Default for HueLimits {
    /// Values of RoBIOS: more than half of the full saturation, and an intensity above 25.
    fn default() -> Self {
        Self { min_saturation: 128, min_intensity: 26 }
    }
}

/// Hue of a colour; [`NO_HUE`] outside the limits and, on the RoBIOS scale, for grays.
///
/// ```
/// use roverlab::vision::{HueLimits, HueScale, NO_HUE, hue};
/// let red = [200, 10, 10];
/// assert_eq!(hue(red, HueScale::Robios, HueLimits::default()), 42);
/// assert_eq!(hue(red, HueScale::OpenCv, HueLimits::default()), 0);
/// assert_eq!(hue([200, 180, 180], HueScale::Robios, HueLimits::default()), NO_HUE, "too pale");
/// ```
#[inline(always)]
pub fn hue([red, green, blue]: [u8; 3], scale: HueScale, limits: HueLimits) -> u8 {
    let brightest = red.max(green).max(blue);
    let difference = brightest - red.min(green).min(blue);
    let (r, g, b) = (i32::from(red), i32::from(green), i32::from(blue));
    let (largest, d) = (i32::from(brightest), i32::from(difference));
    let value = match scale {
        HueScale::Robios => robios(r, g, b, largest, d),
        HueScale::OpenCv => opencv([red, green, blue], brightest, difference).into(),
    };
    let gray = (scale == HueScale::Robios) & (d == 0);
    let pale = 255 * d < i32::from(limits.min_saturation) * largest;
    let dark = (r + b) / 4 + g / 2 < i32::from(limits.min_intensity);
    if gray | pale | dark { NO_HUE } else { value as u8 }
}

#[inline(always)]
fn robios(r: i32, g: i32, b: i32, largest: i32, d: i32) -> i32 {
    let (n, base) = if largest == r {
        (g - b, 42)
    } else if largest == g {
        (b - r, 126)
    } else {
        (r - g, 210)
    };
    let numerator = 42 * n.abs();
    // The integer stands in the low bits of such a sum.
    let nearest = ((numerator as f32 / d.max(1) as f32 + WHOLE).to_bits() & 0x007f_ffff) as i32;
    let quotient = if nearest * d > numerator { nearest - 1 } else { nearest };
    if n < 0 { base - quotient } else { base + quotient }
}

#[inline(always)]
pub(super) fn opencv([red, green, blue]: [u8; 3], largest: u8, difference: u8) -> u8 {
    let (r, g, b) = (i16::from(red), i16::from(green), i16::from(blue));
    let d = i16::from(difference);
    let n = if largest == red {
        g - b
    } else if largest == green {
        b - r + 2 * d
    } else {
        r - g + 4 * d
    };
    let h = fixed_point(n, 30.0, difference);
    (if h < 0 { h + 180 } else { h }) as u8
}

/// 2^23: from here on, all floats are integers, so adding it rounds a smaller float.
const WHOLE: f32 = 8_388_608.0;

/// `(n t + 2048) / 4096` rounded down, where `t / 4096` is `one / d` rounded to the nearest 4096th; 0 if `n`
/// is 0. Neither `one` nor the result may exceed 255.
///
/// Float multiplication is faster than 32-bit integer multiplication, and exact enough here: `t / 4096` is
/// exact, and the product misses its multiple of 1/4096 by less than 2^-16. Adding 2^-14 therefore rounds
/// halves up and changes nothing else.
#[inline(always)]
pub(super) fn fixed_point(n: i16, one: f32, d: u8) -> i16 {
    // From 2048 on, floats are multiples of 1/4096.
    let quotient = one / f32::from(d.max(1)) + 2048.0 - 2048.0;
    // The integer stands in the low bits, also if negative.
    (f32::from(n) * quotient + 1.0 / 16384.0 + 1.5 * WHOLE).to_bits() as i16
}

/// Hue of each pixel of an image; see [`hue`].
///
/// ```
/// use roverlab::vision::{GrayViewMut, HueLimits, HueScale, NO_HUE, RgbView, hue_into};
/// let colours = [200, 10, 10, 10, 200, 10, 10, 10, 200, 90, 90, 90];
/// let mut hues = [0; 4];
/// let output = GrayViewMut::new(&mut hues, 4, 1)?;
/// hue_into(RgbView::new(&colours, 4, 1)?, output, HueScale::Robios, HueLimits::default())?;
/// assert_eq!(hues, [42, 126, 210, NO_HUE], "red, green, blue, gray");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
///
/// # Errors
///
/// If the sizes differ.
pub fn hue_into(
    input: RgbView<'_>,
    output: GrayViewMut<'_>,
    scale: HueScale,
    limits: HueLimits,
) -> Result<(), ImageError> {
    output.require_size(input.size())?;
    let (input, mut output) = flatten(input, output);
    hues(input, &mut output, scale, limits);
    Ok(())
}

#[inline(always)]
pub(super) fn hues_portable(
    input: RgbView<'_>,
    output: &mut GrayViewMut<'_>,
    scale: HueScale,
    limits: HueLimits,
) {
    for y in 0..input.height() {
        planes::map(input.row(y), output.row_mut(y), |red, green, blue| {
            hue([red, green, blue], scale, limits)
        });
    }
}

vectorised_filter! {
    fn hues(input: RgbView<'_>, output: &mut GrayViewMut<'_>, scale: HueScale, limits: HueLimits) {
        match scale {
            HueScale::Robios => hues_portable(input, output, HueScale::Robios, limits),
            HueScale::OpenCv => hues_portable(input, output, HueScale::OpenCv, limits),
        }
    }
}
