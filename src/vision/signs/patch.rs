use super::area::{Area, resample_into};
use crate::ParameterError;
use crate::geometry::math;
use crate::parameter::require;
use crate::random::Stream;
use crate::vision::{ImageError, RgbView};

/// What a network sees of a sign: a square patch, its light as in the sign's middle.
///
/// ```
/// use roverlab::vision::{RgbView, signs::{Area, SignPatch}};
/// let pixel = |i: usize| if i % 40 < 20 { [90, 10, 10] } else { [40; 3] };
/// let pixels: Vec<u8> = (0..40 * 40).flat_map(pixel).collect();
/// let all = Area::new(0.0, 0.0, 40.0, 40.0);
/// let patch = SignPatch::default().read(RgbView::new(&pixels, 40, 40)?, all)?.to_vec();
/// assert_eq!(patch.len(), 3 * SignPatch::SIDE * SignPatch::SIDE);
/// let darker: Vec<u8> = pixels.iter().map(|byte| byte / 2).collect();
/// let darker = SignPatch::default().read(RgbView::new(&darker, 40, 40)?, all)?.to_vec();
/// assert!(patch.iter().zip(&darker).all(|(a, b)| (a - b).abs() < 0.3));
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct SignPatch {
    bytes: Vec<u8>,
    values: Vec<f32>,
}

impl SignPatch {
    /// Rows and columns.
    pub const SIDE: usize = 32;

    /// Reads an area of an image, which may reach beyond it: red, green and blue of each pixel, row by row.
    ///
    /// # Errors
    ///
    /// If the area is empty, or not finite.
    pub fn read(&mut self, image: RgbView<'_>, area: Area) -> Result<&[f32], ImageError> {
        area.check()?;
        resample_into(image, area, (Self::SIDE, Self::SIDE), &mut self.bytes);
        self.values.resize(self.bytes.len(), 0.0);
        light_into(&self.bytes, &mut self.values);
        Ok(&self.values)
    }
}

/// Part of a side that counts as the sign's middle: behind the rest there may be the bright sky.
const MIDDLE: std::ops::Range<usize> = SignPatch::SIDE / 5..SignPatch::SIDE - SignPatch::SIDE / 5;
/// Deviation of the brightness of what shows nothing (of 255): noise.
const DARK: f32 = 2.5;
/// Largest value, in deviations of the middle.
const MOST: f32 = 2.5;

/// The values of bytes: how far they are from the mean of the middle, in its deviations.
fn light_into(bytes: &[u8], values: &mut [f32]) {
    let (mut count, mut sum, mut squares) = (0.0_f32, 0.0, 0.0);
    for row in bytes.chunks_exact(3 * SignPatch::SIDE).skip(MIDDLE.start).take(MIDDLE.len()) {
        for &byte in &row[3 * MIDDLE.start..3 * MIDDLE.end] {
            let byte = f32::from(byte);
            (count, sum, squares) = (count + 1.0, sum + byte, squares + byte * byte);
        }
    }
    let mean = sum / count;
    let deviation = (squares / count - mean * mean).max(0.0).sqrt() + DARK;
    for (value, &byte) in values.iter_mut().zip(bytes) {
        *value = ((f32::from(byte) - mean) / deviation).clamp(-MOST, MOST);
    }
}

/// Signs that a network learns from, each with some of what is around it.
///
/// They are shown turned, slanted, larger, aside, darker, coarser, and with something before them, each time
/// in another way; rare classes oftener than in proportion.
#[derive(Debug, Clone)]
pub struct SignPatches {
    /// Patches, one after the other.
    bytes: Vec<u8>,
    classes: Vec<usize>,
    /// Sums of the weights of the signs up to each.
    sums: Vec<f64>,
}

/// Rows and columns of a patch that is kept, and the part of it that the sign fills.
const KEPT: usize = 40;
/// Bytes of such a patch.
const BYTES: usize = 3 * KEPT * KEPT;
/// Largest turn (rad).
const TURN: f64 = 0.2;
/// Largest slant: shift for each row.
const SLANT: f64 = 0.1;
/// Largest change of the size, and of the height alone.
const SIZES: [f64; 2] = [0.12, 0.1];
/// Largest shift, in signs.
const SHIFT: f64 = 0.075;
/// Exponents of the brightness.
const LIGHTS: [f64; 2] = [0.6, 1.6];
/// Rows and columns of coarse patches, and the part of the patches that are.
const COARSE: [usize; 4] = [10, 13, 17, 22];
/// How often a patch is coarse.
const OFTEN: f64 = 0.57;

impl SignPatches {
    /// Of areas of pictures, and their classes, below a number of `classes`.
    pub(super) fn new<'a>(
        signs: impl Iterator<Item = (RgbView<'a>, Area, usize)>,
        classes: usize,
    ) -> Result<Self, ParameterError> {
        let mut these = Self { bytes: Vec::new(), classes: Vec::new(), sums: Vec::new() };
        let (mut patch, mut counts) = (Vec::new(), vec![0_u32; classes]);
        for (picture, area, class) in signs {
            let wide = area.scaled(KEPT as f64 / SignPatch::SIDE as f64);
            resample_into(picture, wide, (KEPT, KEPT), &mut patch);
            these.bytes.extend_from_slice(&patch);
            these.classes.push(class);
            counts[class] += 1;
        }
        require("number of signs", these.len() as f64, these.len() > 0, "at least 1")?;
        let mut sum = 0.0;
        for &class in &these.classes {
            sum += 1.0 / f64::from(counts[class]).sqrt();
            these.sums.push(sum);
        }
        Ok(these)
    }

    /// Number of signs.
    #[allow(clippy::len_without_is_empty, reason = "there is one")]
    pub fn len(&self) -> usize {
        self.classes.len()
    }

    /// Pixels of all signs, as they are kept.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Class of each sign.
    pub fn classes(&self) -> &[usize] {
        &self.classes
    }

    /// Shows some sign in some way. Returns its class.
    ///
    /// # Panics
    ///
    /// If `values` are not as many as those of a [`SignPatch`].
    pub fn vary(&self, random: &mut Stream, values: &mut [f32]) -> usize {
        assert_eq!(values.len(), 3 * SignPatch::SIDE * SignPatch::SIDE, "values of a patch");
        let place = random.uniform() * self.sums[self.len() - 1];
        let sign = self.sums.partition_point(|&sum| sum <= place).min(self.len() - 1);
        let shown = self.turned(sign, random);
        light_into(&coarser(shown, random), values);
        cover(values, random);
        self.classes[sign]
    }

    /// A sign, turned and in other light.
    fn turned(&self, sign: usize, random: &mut Stream) -> Vec<u8> {
        let exponent = random.between(LIGHTS[0], LIGHTS[1]);
        let lit = |byte: usize| (255.0 * math::pow(byte as f64 / 255.0, exponent)) as f32;
        let light: Vec<f32> = (0..256).map(lit).collect();
        let kept = &self.bytes[BYTES * sign..BYTES * (sign + 1)];
        let at = |x: usize, y: usize, channel: usize| light[usize::from(kept[3 * (KEPT * y + x) + channel])];
        let either = |random: &mut Stream, most: f64| random.between(-most, most);
        let (turn, slant) = (either(random, TURN), either(random, SLANT));
        let width = 1.0 + either(random, SIZES[0]);
        let height = width * (1.0 + either(random, SIZES[1]));
        let side = SignPatch::SIDE as f64;
        let aside = [0; 2].map(|_| side * either(random, SHIFT));
        let (sin, cos) = (math::sin(turn), math::cos(turn));
        let across = [width * cos, width * (slant - sin)];
        let down = [height * sin, height * cos];
        let middle = |index: usize| index as f64 + 0.5 - 0.5 * side;
        let place = |[a, b]: [f64; 2], x: usize, y: usize, aside: f64| {
            let place = a * middle(x) + b * middle(y) + aside + 0.5 * (KEPT - 1) as f64;
            let place = place.clamp(0.0, (KEPT - 1) as f64);
            (place as usize, (place as usize + 1).min(KEPT - 1), place.fract() as f32)
        };
        let mut shown = Vec::with_capacity(3 * SignPatch::SIDE * SignPatch::SIDE);
        for (y, x) in (0..SignPatch::SIDE).flat_map(|y| (0..SignPatch::SIDE).map(move |x| (y, x))) {
            let (left, right, u) = place(across, x, y, aside[0]);
            let (upper, lower, v) = place(down, x, y, aside[1]);
            shown.extend([0, 1, 2].map(|channel| {
                let top = at(left, upper, channel) * (1.0 - u) + at(right, upper, channel) * u;
                let bottom = at(left, lower, channel) * (1.0 - u) + at(right, lower, channel) * u;
                (top * (1.0 - v) + bottom * v + 0.5) as u8
            }));
        }
        shown
    }
}

/// A patch as of a sign that is far away, or the same one.
fn coarser(shown: Vec<u8>, random: &mut Stream) -> Vec<u8> {
    let side = COARSE[random.below(COARSE.len())];
    if random.uniform() >= OFTEN {
        return shown;
    }
    let (mut small, mut again) = (Vec::new(), Vec::new());
    let all = |side: usize| Area::new(0.0, 0.0, side as f64, side as f64);
    let view = |bytes, side| RgbView::new(bytes, side, side).expect("the bytes of its size");
    resample_into(view(&shown, SignPatch::SIDE), all(SignPatch::SIDE), (side, side), &mut small);
    resample_into(view(&small, side), all(side), (SignPatch::SIDE, SignPatch::SIDE), &mut again);
    again
}

/// Covers a rectangle of a patch.
fn cover(values: &mut [f32], random: &mut Stream) {
    let side = SignPatch::SIDE;
    let mut span = || {
        let (middle, half) = (random.below(side), random.below(side / 4));
        middle.saturating_sub(half)..(middle + half).min(side)
    };
    let (columns, rows) = (span(), span());
    for y in rows {
        values[3 * (side * y + columns.start)..3 * (side * y + columns.end)].fill(0.0);
    }
}
