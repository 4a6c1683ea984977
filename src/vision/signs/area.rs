use crate::ParameterError;
use crate::parameter::{require, require_up_to};
use crate::vision::View;
use crate::vision::dispatch::vectorised;

/// A rectangle in an image (pixels), whose edges may lie between pixels and beyond the image.
///
/// ```
/// use roverlab::vision::signs::Area;
/// let (a, b) = (Area::new(0.0, 0.0, 20.0, 20.0), Area::new(0.0, 10.0, 20.0, 20.0));
/// assert!((a.overlap(&b) - 1.0 / 3.0).abs() < 1e-12);
/// assert_eq!(a.overlap(&Area::new(50.0, 0.0, 9.0, 9.0)), 0.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    /// Left edge: 0 is that of the image.
    pub left: f64,
    /// Top edge: 0 is that of the image.
    pub top: f64,
    /// Extent to the right.
    pub width: f64,
    /// Extent downwards.
    pub height: f64,
}

impl Area {
    /// The rectangle of a corner and a size.
    pub const fn new(left: f64, top: f64, width: f64, height: f64) -> Self {
        Self { left, top, width, height }
    }

    /// Intersection over union with another rectangle, 0 to 1.
    pub fn overlap(&self, other: &Self) -> f64 {
        let common = self.common(other);
        let either = self.size() + other.size() - common;
        if either > 0.0 { common / either } else { 0.0 }
    }

    /// Whether much of the smaller one of two rectangles lies in the other: more than of a sign beside
    /// another.
    pub(super) fn shares(&self, other: &Self) -> bool {
        self.common(other) > 0.3 * self.size().min(other.size())
    }

    fn size(&self) -> f64 {
        self.width * self.height
    }

    fn common(&self, other: &Self) -> f64 {
        let along =
            |a: f64, length: f64, b: f64, other: f64| ((a + length).min(b + other) - a.max(b)).max(0.0);
        let across = along(self.left, self.width, other.left, other.width);
        across * along(self.top, self.height, other.top, other.height)
    }

    /// The rectangle about the same middle, `factor` times as large.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let (width, height) = (self.width * factor, self.height * factor);
        Self::new(
            self.left + 0.5 * (self.width - width),
            self.top + 0.5 * (self.height - height),
            width,
            height,
        )
    }

    /// Fails unless both sides are positive, and all numbers those of an image.
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        for (name, side) in [("width of an area", self.width), ("height of an area", self.height)] {
            require_up_to(name, side, MOST)?;
        }
        for (name, place) in [("left edge of an area", self.left), ("top edge of an area", self.top)] {
            require(name, place, place.abs() <= MOST, format!("-{MOST} to {MOST}"))?;
        }
        Ok(())
    }
}

/// Largest coordinate of an area (pixels).
const MOST: f64 = 1e6;
/// Most samples of the image, a side, that a pixel of a patch is the mean of.
const MOST_SAMPLES: f64 = 8.0;

/// Scales a part of an image to a patch of `side` columns and rows: means of bilinear samples about a pixel
/// apart. Beyond the image, its outermost pixels go on.
pub(super) fn resample_into<const C: usize>(
    image: View<'_, C>,
    area: Area,
    side: (usize, usize),
    patch: &mut Vec<u8>,
) {
    let across = Axis::new(area.left, area.width, side.0);
    let down = Axis::new(area.top, area.height, side.1);
    let samples = (across.samples * down.samples) as f32;
    let mut rows = SampledRows::new(image, &across);
    let mut sums = vec![0.0; C * side.0];
    patch.resize(C * side.0 * side.1, 0);
    let taps = down.taps(image.height());
    for (line, taps) in patch.chunks_exact_mut(C * side.0).zip(taps.chunks_exact(down.samples)) {
        sums.fill(0.0);
        for &(y, below, v) in taps {
            let [upper, lower] = [y, below].map(|row| rows.read(row));
            add_between(&rows.values[upper], &rows.values[lower], v, &mut sums);
        }
        round_means(&sums, samples, line);
    }
}

/// Rows of an image, sampled across: the two that were read last.
struct SampledRows<'a, const C: usize> {
    image: View<'a, C>,
    /// The first sample of each pixel of the patch, then the second of each, and so on.
    taps: Vec<Tap>,
    values: [Vec<f32>; 2],
    read: [Option<usize>; 2],
}

impl<'a, const C: usize> SampledRows<'a, C> {
    fn new(image: View<'a, C>, across: &Axis) -> Self {
        let taps = across.taps(image.width());
        let of = |sample| taps.iter().skip(sample).step_by(across.samples).copied();
        let taps: Vec<Tap> = (0..across.samples).flat_map(of).collect();
        let values = [0; 2].map(|_| vec![0.0; C * taps.len()]);
        Self { image, taps, values, read: [None; 2] }
    }

    /// Reads a row, if need be. Returns which of the two it is; the one below is the other.
    fn read(&mut self, y: usize) -> usize {
        let place = y % 2;
        if self.read[place] != Some(y) {
            self.read[place] = Some(y);
            let (pixels, _) = self.image.row(y).as_chunks::<C>();
            let (values, _) = self.values[place].as_chunks_mut::<C>();
            for (value, &(x, right, u)) in values.iter_mut().zip(&self.taps) {
                let (here, next) = (pixels[x].map(f32::from), pixels[right].map(f32::from));
                *value = std::array::from_fn(|channel| here[channel] + u * (next[channel] - here[channel]));
            }
        }
        place
    }
}

vectorised! {
    /// Adds to each pixel its samples between two rows.
    fn add_between(upper: &[f32], lower: &[f32], v: f32, sums: &mut [f32]) {
        let pixels = sums.len();
        for (upper, lower) in upper.chunks_exact(pixels).zip(lower.chunks_exact(pixels)) {
            for ((sum, &top), &bottom) in sums.iter_mut().zip(upper).zip(lower) {
                *sum += top + v * (bottom - top);
            }
        }
    }
}

vectorised! {
    fn round_means(sums: &[f32], samples: f32, bytes: &mut [u8]) {
        for (byte, sum) in bytes.iter_mut().zip(sums) {
            *byte = (sum / samples + 0.5) as u8;
        }
    }
}

/// The pixels before and behind a sample, and its distance from the former.
type Tap = (usize, usize, f32);

/// How the pixels of a patch divide a side of its area.
struct Axis {
    start: f64,
    length: f64,
    pixels: usize,
    /// Samples a pixel.
    samples: usize,
}

impl Axis {
    fn new(start: f64, length: f64, pixels: usize) -> Self {
        let samples = (length / pixels as f64).round().clamp(1.0, MOST_SAMPLES) as usize;
        Self { start, length, pixels, samples }
    }

    /// The tap of each sample.
    fn taps(&self, image: usize) -> Vec<Tap> {
        let last = image - 1;
        let all = self.pixels * self.samples;
        let step = self.length / all as f64;
        let tap = |sample: usize| {
            let place = (self.start + (sample as f64 + 0.5) * step - 0.5).clamp(0.0, last as f64);
            let pixel = place as usize;
            (pixel, (pixel + 1).min(last), (place - pixel as f64) as f32)
        };
        (0..all).map(tap).collect()
    }
}
