use crate::parameter::{require, require_not_negative, require_positive};
use crate::vision::{GrayView, ImageError, mean_difference, view::require_size};

use super::range::Ranges;

/// Parameters of [`MotionDetector`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionParameters {
    /// Size of the compared blocks (pixels a side).
    pub block: usize,
    /// Change that counts as motion (standard deviations of the noise).
    pub threshold: f64,
    /// Minimum noise: standard deviation of the change of a white pixel (gray levels). Rounding to levels and
    /// pixels causes that much even in a still image.
    pub least_noise: f64,
}

impl Default for MotionParameters {
    /// Values for a robot that stands.
    fn default() -> Self {
        Self { block: 4, threshold: 6.0, least_noise: 0.8 }
    }
}

/// Motion between two images.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Largest block change in the left, middle and right third of the image (standard deviations of the
    /// noise).
    pub sectors: [f64; 3],
    /// Mean absolute difference of all pixels (Programs 11.12 and 11.13).
    pub mean_difference: f64,
    /// Measured standard deviation of the change of a white pixel (gray levels).
    pub noise: f64,
    /// The third that changed most, if the change exceeds the threshold.
    pub strongest: Option<usize>,
}

impl Motion {
    /// Largest change of the three sectors (standard deviations of the noise).
    pub fn largest(&self) -> f64 {
        self.sectors.into_iter().fold(0.0, f64::max)
    }

    /// Whether a change exceeds the threshold.
    pub fn is_moving(&self) -> bool {
        self.strongest.is_some()
    }
}

/// Detects motion between two images, block by block.
///
/// The book compares the mean absolute difference of all pixels with a constant. The camera's noise gives
/// that mean a floor, which hides small objects, and a change of exposure shifts it. This detector scales the
/// second image to the brightness of the first and averages signed differences over blocks, where noise
/// cancels and motion does not.
///
/// The noise is estimated from the same two images: most blocks show no motion, so the median of their
/// changes is the noise. It grows with the square root of the brightness, so a change of a dark block weighs
/// more. Blocks are also examined in pairs, in squares of four and in rows and columns of four, which reduces
/// noise further. In overexposed images, levels saturate and no longer follow the exposure; a block may then
/// follow it in part or not at all.
///
/// In a comparison with slack, a pixel counts only as far as the ranges of gray levels around it in the two
/// images are disjoint: a slightly displaced edge is no motion, whatever its contrast.
///
/// ```
/// use roverlab::vision::GrayView;
/// use roverlab::vision::motion::{MotionDetector, MotionParameters};
/// let room: Vec<u8> = (0..80 * 60).map(|i| 80 + (i % 7) as u8).collect();
/// let mut later = room.clone();
/// for row in 20..40 {
///     later[80 * row + 60..80 * row + 72].fill(160);
/// }
/// let mut detector = MotionDetector::new(MotionParameters::default())?;
/// let motion = detector.compare(GrayView::new(&room, 80, 60)?, GrayView::new(&later, 80, 60)?)?;
/// assert_eq!(motion.strongest, Some(2), "something came into the right third");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug, Clone)]
pub struct MotionDetector {
    parameters: MotionParameters,
    blocks: Vec<Block>,
    values: Vec<f64>,
    first_ranges: Ranges,
    second_ranges: Ranges,
}

/// Sums over the pixels of a block or a group of blocks: both images, the differences that slack does not
/// explain, the brightness that determines the noise, and the number of pixels.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    first: f64,
    second: f64,
    unexplained: f64,
    variance: f64,
    pixels: f64,
}

/// Properties of an image pair: gain from the second image to the first, noise of a white pixel, whether
/// slack applies, and whether the image is overexposed.
#[derive(Debug, Clone, Copy)]
struct Judge {
    gain: f64,
    noise: f64,
    loose: bool,
    too_bright: bool,
}

/// Sizes of the groups of blocks (across, down) that are examined as one; moving objects are not square.
const GROUPS: [(usize, usize); 5] = [(1, 2), (2, 1), (2, 2), (1, 4), (4, 1)];
/// Gray level below which the noise no longer falls.
const DARKEST: f64 = 10.0;
/// Mean gray level from which on a block contains saturated pixels.
const CLIPPED: f64 = 240.0;
/// Ratio of the standard deviation of a normal distribution to its median absolute deviation.
const DEVIATION: f64 = 1.4826;

impl Block {
    fn add(&mut self, other: &Self) {
        self.first += other.first;
        self.second += other.second;
        self.unexplained += other.unexplained;
        self.variance += other.variance;
        self.pixels += other.pixels;
    }

    fn is_clipped(&self) -> bool {
        self.first.max(self.second) > CLIPPED * self.pixels
    }

    /// Change between the images after the second is multiplied by `gain` (standard deviations at white).
    fn change(&self, gain: f64) -> f64 {
        (self.first - gain * self.second) / self.variance.sqrt()
    }
}

impl MotionDetector {
    /// A detector.
    ///
    /// # Errors
    ///
    /// If the block size is not 2 to 256, the threshold is negative or `least_noise` is not positive.
    pub fn new(parameters: MotionParameters) -> Result<Self, ImageError> {
        let MotionParameters { block, threshold, least_noise } = parameters;
        require("motion block", block as f64, (2..=256).contains(&block), "2 to 256")?;
        require_not_negative("motion threshold", threshold)?;
        require_positive("least noise", least_noise)?;
        Ok(Self {
            parameters,
            blocks: Vec::new(),
            values: Vec::new(),
            first_ranges: Ranges::default(),
            second_ranges: Ranges::default(),
        })
    }

    /// Compares two images of equal size from a camera at rest.
    ///
    /// # Errors
    ///
    /// If the sizes differ.
    pub fn compare(&mut self, first: GrayView<'_>, second: GrayView<'_>) -> Result<Motion, ImageError> {
        self.compare_loosely(first, second, 0)
    }

    /// Compares two images of equal size in which edges may be displaced by up to `slack` pixels without
    /// motion.
    ///
    /// # Errors
    ///
    /// If the sizes differ.
    pub fn compare_loosely(
        &mut self,
        first: GrayView<'_>,
        second: GrayView<'_>,
        slack: usize,
    ) -> Result<Motion, ImageError> {
        require_size("second image", second.size(), first.size())?;
        self.sum(first, second);
        let gain = self.gain();
        let noise = self.noise(gain);
        if slack > 0 {
            self.explain(first, second, gain, slack);
        }
        let mean_difference = mean_difference(first, second)?;
        let judge = Judge {
            gain,
            noise: noise.max(self.parameters.least_noise),
            loose: slack > 0,
            too_bright: self.blocks.iter().any(Block::is_clipped),
        };
        let sectors = self.sectors(first.width(), judge, |_, _| ());
        let strongest = self.strongest(sectors);
        Ok(Motion { sectors, mean_difference, noise, strongest })
    }

    /// Gain from the first image to the second.
    pub(super) fn gain_between(&mut self, first: GrayView<'_>, second: GrayView<'_>) -> f64 {
        self.sum(first, second);
        1.0 / self.gain()
    }

    /// Judges two images by the difference of each pixel that nothing explains; the noise is the minimum.
    /// Also returns the place of the largest change (column, row).
    pub(super) fn judge(
        &mut self,
        first: GrayView<'_>,
        second: GrayView<'_>,
        unexplained: &[f64],
    ) -> Result<(Motion, (f64, f64)), ImageError> {
        self.sum(first, second);
        let (width, size) = (first.width(), self.parameters.block);
        let across = width.div_ceil(size);
        for (index, off) in unexplained.iter().enumerate() {
            self.blocks[index / width / size * across + index % width / size].unexplained += off;
        }
        let noise = self.parameters.least_noise;
        let judge = Judge { gain: 1.0, noise, loose: true, too_bright: false };
        let mut largest = (0.0, (0.0, 0.0));
        let sectors = self.sectors(width, judge, |change, place| {
            if change > largest.0 {
                largest = (change, place);
            }
        });
        let mean_difference = mean_difference(first, second)?;
        let strongest = self.strongest(sectors);
        Ok((Motion { sectors, mean_difference, noise, strongest }, largest.1))
    }

    /// The sector with the largest change, if that exceeds the threshold.
    fn strongest(&self, sectors: [f64; 3]) -> Option<usize> {
        let strongest = (0..3).max_by(|&a, &b| sectors[a].total_cmp(&sectors[b]));
        strongest.filter(|&sector| sectors[sector] > self.parameters.threshold)
    }

    /// Sums the levels of both images over the blocks.
    fn sum(&mut self, first: GrayView<'_>, second: GrayView<'_>) {
        let (width, height) = first.size();
        let size = self.parameters.block;
        let across = width.div_ceil(size);
        self.blocks.clear();
        self.blocks.resize(across * height.div_ceil(size), Block::default());
        for y in 0..height {
            let blocks = &mut self.blocks[y / size * across..][..across];
            let rows = first.row(y).chunks(size).zip(second.row(y).chunks(size));
            for (block, (a, b)) in blocks.iter_mut().zip(rows) {
                let sum =
                    |shades: &[u8]| f64::from(shades.iter().map(|&shade| u32::from(shade)).sum::<u32>());
                block.first += sum(a);
                block.second += sum(b);
                block.pixels += a.len() as f64;
            }
        }
        for block in &mut self.blocks {
            block.variance = (0.5 * (block.first + block.second)).max(DARKEST * block.pixels) / 255.0;
        }
    }

    /// Gain from the second image to the first: the median over the blocks, which motion in a few of them
    /// does not affect.
    fn gain(&mut self) -> f64 {
        let ratio = |block: &Block| block.first.max(1.0) / block.second.max(1.0);
        self.median(ratio).unwrap_or(1.0)
    }

    /// Standard deviation of the change of a white pixel, from the median over the blocks.
    fn noise(&mut self, gain: f64) -> f64 {
        DEVIATION * self.median(|block| block.change(gain).abs()).unwrap_or(0.0)
    }

    /// Median over the blocks that are not saturated, if there are any.
    fn median(&mut self, value: impl Fn(&Block) -> f64) -> Option<f64> {
        self.values.clear();
        self.values.extend(self.blocks.iter().filter(|block| !block.is_clipped()).map(value));
        let middle = self.values.len() / 2;
        let values = &mut self.values;
        (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
    }

    /// Sums the differences that slack does not explain.
    fn explain(&mut self, first: GrayView<'_>, second: GrayView<'_>, gain: f64, slack: usize) {
        let size = self.parameters.block;
        self.first_ranges.find(first, slack);
        self.second_ranges.find(second, slack);
        let (width, height) = first.size();
        let across = width.div_ceil(size);
        for y in 0..height {
            let blocks = &mut self.blocks[y / size * across..][..across];
            let rows = self.first_ranges.row(y).zip(self.second_ranges.row(y));
            for (x, ((low, high), (lowest, highest))) in rows.enumerate() {
                let (lowest, highest) = (gain * f64::from(lowest), gain * f64::from(highest));
                let above = (f64::from(low) - highest).max(0.0);
                blocks[x / size].unexplained += above - (lowest - f64::from(high)).max(0.0);
            }
        }
    }

    /// Largest change in each third of the image. `each` takes every group's change and centre.
    fn sectors(&self, width: usize, judge: Judge, mut each: impl FnMut(f64, (f64, f64))) -> [f64; 3] {
        let size = self.parameters.block;
        let across = width.div_ceil(size);
        let down = self.blocks.len() / across;
        let mut sectors = [0.0_f64; 3];
        for (wide, high) in GROUPS.map(|(wide, high)| (wide.min(across), high.min(down))) {
            let places =
                (0..=down - high).flat_map(|row| (0..=across - wide).map(move |column| (row, column)));
            for (row, column) in places {
                let change = judge.change(&self.group(across, (row, column), (wide, high)));
                // A group belongs to the sector of its centre.
                let middle = ((2 * column + wide) * size / 2).min(width - 1);
                let sector = &mut sectors[3 * middle / width];
                let change = change.abs() / judge.noise;
                *sector = sector.max(change);
                each(change, (middle as f64, ((2 * row + high) * size / 2) as f64));
            }
        }
        sectors
    }

    /// Sum of a rectangle of blocks.
    fn group(&self, across: usize, (row, column): (usize, usize), (wide, high): (usize, usize)) -> Block {
        let mut group = Block::default();
        for line in self.blocks[row * across..].chunks(across).take(high) {
            line[column..column + wide].iter().for_each(|block| group.add(block));
        }
        group
    }
}

impl Judge {
    /// Change of a group that the camera does not explain.
    fn change(&self, group: &Block) -> f64 {
        if self.loose {
            group.unexplained / group.variance.sqrt()
        } else if self.too_bright {
            // Partly saturated blocks pull the gain towards 1.
            least(group.change(self.gain * self.gain), group.change(1.0))
        } else {
            group.change(self.gain)
        }
    }
}

/// The number closest to 0 between `a` and `b`.
fn least(a: f64, b: f64) -> f64 {
    0.0_f64.clamp(a.min(b), a.max(b))
}
