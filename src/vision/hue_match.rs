use super::dispatch::vectorised_filter;
use super::hue::hue;
use super::view::flatten;
use super::{GrayView, GrayViewMut, HueLimits, HueScale, ImageError, NO_HUE, RgbView, planes};
use crate::ParameterError;

/// A closed range of hues; it wraps around the circle if `low` exceeds `high`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct HueRange {
    /// First hue.
    pub low: u8,
    /// Last hue.
    pub high: u8,
}

impl HueRange {
    /// The hues from `low` to `high`, wrapping around if `low` is larger.
    ///
    /// # Errors
    ///
    /// If a number is not a hue: 255, or 180 and above on the OpenCV scale.
    pub fn new(low: u8, high: u8, scale: HueScale) -> Result<Self, ImageError> {
        for (parameter, hue) in [("low hue", low), ("high hue", high)] {
            require_hue(parameter, hue, scale)?;
        }
        Ok(Self { low, high })
    }

    /// The hues less than `threshold` away from `hue`, on a circle of 255 as in the book's Program 11.9, or
    /// of 180 on the OpenCV scale. A colour has another hue on each scale: red is 42 and 0. For the hue of a
    /// colour use [`like`](Self::like).
    ///
    /// # Errors
    ///
    /// If `hue` is not a hue or `threshold` is 0.
    pub fn around(hue: u8, threshold: u8, scale: HueScale) -> Result<Self, ImageError> {
        require_hue("hue", hue, scale)?;
        let circle = circle(scale);
        let (middle, reach) = (i32::from(hue), i32::from(threshold) - 1);
        if reach < 0 {
            return Err(ParameterError::new("hue threshold", 0.0, "at least 1").into());
        }
        if 2 * reach + 1 >= circle {
            return Ok(Self { low: 0, high: (circle - 1) as u8 });
        }
        let wrap = |hue: i32| hue.rem_euclid(circle) as u8;
        Ok(Self { low: wrap(middle - reach), high: wrap(middle + reach) })
    }

    /// The hues less than `threshold` away from that of a sample: `like([255, 0, 0], 20, scale)` is red on
    /// either scale.
    ///
    /// ```
    /// use roverlab::vision::{HueRange, HueScale};
    /// let red = HueRange::like([200, 30, 20], 20, HueScale::Robios)?;
    /// assert!(red.contains(42) && !red.contains(126));
    /// assert!(HueRange::like([90, 90, 90], 20, HueScale::Robios).is_err());
    /// # Ok::<(), roverlab::vision::ImageError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the sample is gray, which has no hue, or `threshold` is 0.
    pub fn like(sample: [u8; 3], threshold: u8, scale: HueScale) -> Result<Self, ImageError> {
        let [red, green, blue] = sample;
        if red == green && green == blue {
            return Err(
                ParameterError::new("colour of the sample", f64::from(red), "a colour, not a gray").into()
            );
        }
        Self::around(hue(sample, scale, HueLimits::NONE), threshold, scale)
    }

    /// Whether the range contains a hue; never true for [`NO_HUE`].
    #[inline(always)]
    pub fn contains(&self, hue: u8) -> bool {
        let (from, to) = (hue >= self.low, hue <= self.high);
        (hue != NO_HUE) & if self.low <= self.high { from & to } else { from | to }
    }
}

/// Size of the circle around which ranges wrap.
fn circle(scale: HueScale) -> i32 {
    match scale {
        HueScale::Robios => 255,
        HueScale::OpenCv => 180,
    }
}

fn require_hue(parameter: &'static str, hue: u8, scale: HueScale) -> Result<(), ImageError> {
    if i32::from(hue) < circle(scale) {
        return Ok(());
    }
    Err(ParameterError::new(parameter, f64::from(hue), "below 255, or 180 on OpenCV's scale").into())
}

/// 255 where the hue of a pixel is in the range, 0 elsewhere (book, section 11.4). One pass from colours to
/// mask.
///
/// ```
/// use roverlab::vision::{GrayViewMut, HueLimits, HueRange, HueScale, RgbView, hue_match_into};
/// let colours = [200, 10, 10, 10, 200, 10, 90, 90, 90];
/// let red = HueRange::like([255, 0, 0], 10, HueScale::OpenCv)?;
/// let mut mask = [0; 3];
/// let output = GrayViewMut::new(&mut mask, 3, 1)?;
/// hue_match_into(RgbView::new(&colours, 3, 1)?, output, red, HueScale::OpenCv, HueLimits::default())?;
/// assert_eq!(mask, [255, 0, 0]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
///
/// # Errors
///
/// If the sizes differ.
pub fn hue_match_into(
    input: RgbView<'_>,
    output: GrayViewMut<'_>,
    range: HueRange,
    scale: HueScale,
    limits: HueLimits,
) -> Result<(), ImageError> {
    output.require_size(input.size())?;
    let (input, mut output) = flatten(input, output);
    match scale {
        HueScale::Robios => matches(input, &mut output, &Sectors::new(range, limits)),
        HueScale::OpenCv => matches_opencv(input, &mut output, range, limits),
    }
    Ok(())
}

/// 255 where a hue image is in the range, 0 elsewhere.
///
/// ```
/// use roverlab::vision::{GrayView, GrayViewMut, HueRange, HueScale, NO_HUE, match_hue_image_into};
/// let green = HueRange::around(126, 10, HueScale::Robios)?;
/// let mut mask = [0; 4];
/// let hues = GrayView::new(&[120, 135, 140, NO_HUE], 4, 1)?;
/// match_hue_image_into(hues, GrayViewMut::new(&mut mask, 4, 1)?, green)?;
/// assert_eq!(mask, [255, 255, 0, 0], "less than 10 away from 126");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
///
/// # Errors
///
/// If the sizes differ.
pub fn match_hue_image_into(
    input: GrayView<'_>,
    output: GrayViewMut<'_>,
    range: HueRange,
) -> Result<(), ImageError> {
    output.require_size(input.size())?;
    let (input, mut output) = flatten(input, output);
    matches_hues(input, &mut output, range);
    Ok(())
}

/// A range of RoBIOS hues as conditions without division.
///
/// In the sector of a largest channel, `base + 42 n / d >= hue` is equivalent to `42 n - m d > t` for some
/// `m` and `t`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sectors {
    /// `m` and `t` of the lower bound, for the sectors of red, green and blue.
    first: [(i16, i16); 3],
    /// `m` and `t` of the first hue past the range.
    behind: [(i16, i16); 3],
    /// Whether the range is the complement of these conditions.
    invert: bool,
    limits: HueLimits,
}

impl Sectors {
    pub(super) fn new(range: HueRange, limits: HueLimits) -> Self {
        let HueRange { low, high } = range;
        let (low, high) = (i16::from(low), i16::from(high));
        let invert = low > high;
        let (first, behind) = if invert { (high + 1, low) } else { (low, high + 1) };
        let conditions = |hue: i16| [42, 126, 210].map(|base| condition(hue - base));
        Self { first: conditions(first), behind: conditions(behind), invert, limits }
    }

    /// Whether a pixel's hue is in the range.
    #[inline(always)]
    pub(super) fn contain(&self, [red, green, blue]: [u8; 3]) -> bool {
        let (r, g, b) = (i16::from(red), i16::from(green), i16::from(blue));
        let largest = r.max(g).max(b);
        let d = largest - r.min(g).min(b);
        let (is_red, is_green) = (largest == r, largest == g);
        let n = pick(is_red, is_green, [g - b, b - r, r - g]);
        let reaches = |conditions: &[(i16, i16); 3]| {
            let [red, green, blue] = *conditions;
            let m = pick(is_red, is_green, [red.0, green.0, blue.0]);
            let t = pick(is_red, is_green, [red.1, green.1, blue.1]);
            42 * n - m * d > t
        };
        let within = (reaches(&self.first) & !reaches(&self.behind)) ^ self.invert;
        let colourful = 255 * d as u16 >= u16::from(self.limits.min_saturation) * largest as u16;
        let bright = (r + b) / 4 + g / 2 >= i16::from(self.limits.min_intensity);
        within & (d > 0) & colourful & bright
    }
}

/// `m` and `t` such that `42 n - m d > t` exactly if `42 n / d`, rounded towards zero, is at least `least`.
fn condition(least: i16) -> (i16, i16) {
    // Quotients lie between -42 and 42; limits beyond are equivalent.
    let least = least.clamp(-42, 43);
    if least > 0 { (least, -1) } else { (least - 1, 0) }
}

#[inline(always)]
fn pick(is_red: bool, is_green: bool, [red, green, blue]: [i16; 3]) -> i16 {
    let other = if is_green { green } else { blue };
    if is_red { red } else { other }
}

#[inline(always)]
pub(super) fn matches_portable(input: RgbView<'_>, output: &mut GrayViewMut<'_>, sectors: &Sectors) {
    for y in 0..input.height() {
        planes::map(input.row(y), output.row_mut(y), |red, green, blue| {
            if sectors.contain([red, green, blue]) { 255 } else { 0 }
        });
    }
}

#[inline(always)]
pub(super) fn matches_opencv_portable(
    input: RgbView<'_>,
    output: &mut GrayViewMut<'_>,
    range: HueRange,
    limits: HueLimits,
) {
    for y in 0..input.height() {
        planes::map(input.row(y), output.row_mut(y), |red, green, blue| {
            if range.contains(hue([red, green, blue], HueScale::OpenCv, limits)) { 255 } else { 0 }
        });
    }
}

#[inline(always)]
pub(super) fn matches_hues_portable(input: GrayView<'_>, output: &mut GrayViewMut<'_>, range: HueRange) {
    for y in 0..input.height() {
        for (out, &hue) in output.row_mut(y).iter_mut().zip(input.row(y)) {
            *out = if range.contains(hue) { 255 } else { 0 };
        }
    }
}

vectorised_filter! {
    fn matches(input: RgbView<'_>, output: &mut GrayViewMut<'_>, sectors: &Sectors) {
        matches_portable(input, output, sectors);
    }
}

vectorised_filter! {
    fn matches_opencv(input: RgbView<'_>, output: &mut GrayViewMut<'_>, range: HueRange, limits: HueLimits) {
        matches_opencv_portable(input, output, range, limits);
    }
}

vectorised_filter! {
    fn matches_hues(input: GrayView<'_>, output: &mut GrayViewMut<'_>, range: HueRange) {
        matches_hues_portable(input, output, range);
    }
}
