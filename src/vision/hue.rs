use super::dispatch::vectorised;
use super::view::flatten;
use super::{Error, GrayViewMut, RgbView, planes};

/// The hue of a pixel that has none.
pub const NO_HUE: u8 = 255;

/// How a hue becomes a number, by whole-number arithmetic from the largest channel, the smallest one and `d`, the
/// difference between them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum HueScale {
    /// RoBIOS: a circle of 252, red at 42, green at 126, blue at 210.
    ///
    /// `42 + 42 (green - blue) / d` if red is largest, else `126 + 42 (blue - red) / d` if green is, else
    /// `210 + 42 (red - green) / d`; quotients are rounded towards zero.
    #[default]
    Robios,
    /// OpenCV: a circle of 180, red at 0, green at 60, blue at 120.
    ///
    /// `30 n / d` with `n` the sixths: `green - blue`, `blue - red + 2 d` or `red - green + 4 d`; in fixed point:
    /// `(n t + 2048) / 4096` rounded down, where `t` is `122880 / d` rounded to the nearest; plus 180 if negative.
    /// Where `d` is 0 the hue is 0.
    OpenCv,
}

/// Which pixels have a hue: those with enough colour and light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct HueLimits {
    /// The smallest saturation in the sense of HSV, 0 to 255: `255 d >= min_saturation * largest channel`.
    pub min_saturation: u8,
    /// The smallest `(red + blue) / 4 + green / 2`, each quotient rounded down.
    pub min_intensity: u8,
}

impl HueLimits {
    /// Every pixel that is not gray has a hue.
    pub const NONE: Self = Self { min_saturation: 0, min_intensity: 0 };
}

impl Default for HueLimits {
    /// RoBIOS's: more than half of the full saturation, and an intensity above 25.
    fn default() -> Self {
        Self { min_saturation: 128, min_intensity: 26 }
    }
}

/// The hue of red, green and blue; [`NO_HUE`] outside the limits and, on RoBIOS's scale, for grays.
#[inline(always)]
pub fn hue([red, green, blue]: [u8; 3], scale: HueScale, limits: HueLimits) -> u8 {
    let (r, g, b) = (i32::from(red), i32::from(green), i32::from(blue));
    let largest = r.max(g).max(b);
    let d = largest - r.min(g).min(b);
    let value = match scale {
        HueScale::Robios => robios(r, g, b, largest, d),
        HueScale::OpenCv => opencv(r, g, b, largest, d),
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
    let nearest = fixed_quotient(numerator as f32, d);
    let quotient = if nearest * d > numerator { nearest - 1 } else { nearest };
    if n < 0 { base - quotient } else { base + quotient }
}

#[inline(always)]
pub(super) fn opencv(r: i32, g: i32, b: i32, largest: i32, d: i32) -> i32 {
    let n = if largest == r {
        g - b
    } else if largest == g {
        b - r + 2 * d
    } else {
        r - g + 4 * d
    };
    let h = (n * fixed_quotient(122_880.0, d) + 2048) >> 12;
    if h < 0 { h + 180 } else { h }
}

/// `n / d` rounded to the nearest whole number, halves to even ones; 0 for a `d` of 0. `n` must be below 2^22.
#[inline(always)]
pub(super) fn fixed_quotient(n: f32, d: i32) -> i32 {
    // Adding 2^23 to a float rounds it to a whole number, which then stands in its lowest bits.
    let rounded = (n / d.max(1) as f32 + 8_388_608.0).to_bits() & 0x007f_ffff;
    if d == 0 { 0 } else { rounded as i32 }
}

/// The hues of an image; see [`hue`].
pub fn hue_into(
    input: RgbView<'_>,
    output: GrayViewMut<'_>,
    scale: HueScale,
    limits: HueLimits,
) -> Result<(), Error> {
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

vectorised! {
    fn hues(input: RgbView<'_>, output: &mut GrayViewMut<'_>, scale: HueScale, limits: HueLimits) {
        match scale {
            HueScale::Robios => hues_portable(input, output, HueScale::Robios, limits),
            HueScale::OpenCv => hues_portable(input, output, HueScale::OpenCv, limits),
        }
    }
}
