use crate::parameter::{require, require_not_negative, require_positive};
use crate::vision::{GrayView, ImageError, mean_difference, view::require_size};

use super::range::Ranges;

/// What makes motion for a [`MotionDetector`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionParameters {
    /// Pixels on each side of the blocks that are compared.
    pub block: usize,
    /// Standard deviations of the noise by which blocks may change without motion.
    pub threshold: f64,
    /// The least noise, as the standard deviation of a white pixel's change in levels of 255: what an image without any
    /// still owes to its whole levels and pixels.
    pub least_noise: f64,
}

impl Default for MotionParameters {
    /// For a robot that stands.
    fn default() -> Self {
        Self { block: 4, threshold: 6.0, least_noise: 0.8 }
    }
}

/// How much moved from one image to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// The largest change of blocks in each third of the image: left, middle, right. In standard deviations of the
    /// noise.
    pub sectors: [f64; 3],
    /// The mean of the absolute difference over all pixels (Programs 11.12 and 11.13).
    pub mean_difference: f64,
    /// The standard deviation that noise gives to the change of a white pixel, as measured, in levels.
    pub noise: f64,
    /// The sector that changed most, if any changed by more than the threshold.
    pub strongest: Option<usize>,
}

impl Motion {
    /// The largest change of all.
    pub fn largest(&self) -> f64 {
        self.sectors.into_iter().fold(0.0, f64::max)
    }

    /// Whether something moved.
    pub fn is_moving(&self) -> bool {
        self.strongest.is_some()
    }
}

/// Compares two images block by block.
///
/// The book compares the mean of the absolute differences of all pixels with a fixed number. That mean has a floor, the
/// camera's noise in every pixel, that hides whatever is small; and a change of the exposure moves all of it. Here the
/// signed differences are averaged over blocks, where noise cancels and motion does not, after the second image has
/// been brought to the first one's brightness.
///
/// What may change without motion is measured in the same two images: most blocks show nothing that moves, and the
/// median of their changes is the noise. It grows with the square root of the brightness, so the change of a darker block
/// counts for more. Blocks are looked at one by two, two by two and four in a row, where noise cancels further. Where
/// light is too bright for the camera, levels end at white and no longer follow the exposure: then a block may follow it
/// in part, or not at all.
///
/// Compared loosely, a pixel counts only as far as its surroundings in one image have no shade in common with those in
/// the other: an edge that is a little off is no motion, whatever its contrast.
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

/// Sums over the pixels of a block, or of blocks side by side: of both images, of what slack does not explain, of the
/// brightness for the noise, and the pixels' number.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    first: f64,
    second: f64,
    unexplained: f64,
    variance: f64,
    pixels: f64,
}

/// What is known of two images: how the second one is brought to the first one's brightness, the noise of a white pixel,
/// whether edges may be off, and whether there is too much light.
#[derive(Debug, Clone, Copy)]
struct Judge {
    gain: f64,
    noise: f64,
    loose: bool,
    too_bright: bool,
}

/// How many blocks across and down are looked at as one: what moves is no square.
const GROUPS: [(usize, usize); 5] = [(1, 2), (2, 1), (2, 2), (1, 4), (4, 1)];
/// Noise does not fall below that of this level.
const DARKEST: f64 = 10.0;
/// Blocks from this mean on have pixels that noise, or the light, has driven to the end of the levels.
const CLIPPED: f64 = 240.0;
/// The standard deviation of normal numbers over the median of their absolute values.
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

    /// The change in standard deviations of a white pixel's noise, after the second image's levels have been
    /// multiplied by a gain.
    fn change(&self, gain: f64) -> f64 {
        (self.first - gain * self.second) / self.variance.sqrt()
    }
}

impl MotionDetector {
    /// A detector. Fails unless blocks have 2 to 256 pixels a side, the threshold is a number of at least 0 and the least
    /// noise one above 0.
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

    /// What moved between two images of one size, by a camera that stood.
    pub fn compare(&mut self, first: GrayView<'_>, second: GrayView<'_>) -> Result<Motion, ImageError> {
        self.compare_loosely(first, second, 0)
    }

    /// What moved between two images of one size, in either of which edges may be off by so many pixels without motion.
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
        let sectors = self.sectors(first.width(), judge);
        let strongest = (0..3).max_by(|&a, &b| sectors[a].total_cmp(&sectors[b]));
        let strongest = strongest.filter(|&sector| sectors[sector] > self.parameters.threshold);
        Ok(Motion { sectors, mean_difference, noise, strongest })
    }

    /// Sums both images' levels over the blocks.
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

    /// The factor that brings the second image to the first one's brightness: the median over the blocks, which motion
    /// in a few of them does not touch.
    fn gain(&mut self) -> f64 {
        let ratio = |block: &Block| block.first.max(1.0) / block.second.max(1.0);
        self.median(ratio).unwrap_or(1.0)
    }

    /// The standard deviation of a white pixel's change, from the median over the blocks.
    fn noise(&mut self, gain: f64) -> f64 {
        DEVIATION * self.median(|block| block.change(gain).abs()).unwrap_or(0.0)
    }

    /// The median of something over the blocks that are not clipped, if there are any.
    fn median(&mut self, value: impl Fn(&Block) -> f64) -> Option<f64> {
        self.values.clear();
        self.values.extend(self.blocks.iter().filter(|block| !block.is_clipped()).map(value));
        let middle = self.values.len() / 2;
        let values = &mut self.values;
        (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
    }

    /// Sums what slack leaves of the differences.
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

    /// The largest change in each third of the image.
    fn sectors(&self, width: usize, judge: Judge) -> [f64; 3] {
        let size = self.parameters.block;
        let across = width.div_ceil(size);
        let down = self.blocks.len() / across;
        let mut sectors = [0.0_f64; 3];
        for (wide, high) in GROUPS.map(|(wide, high)| (wide.min(across), high.min(down))) {
            let places =
                (0..=down - high).flat_map(|row| (0..=across - wide).map(move |column| (row, column)));
            for (row, column) in places {
                let change = judge.change(&self.group(across, (row, column), (wide, high)));
                // A group belongs to the sector of its middle.
                let middle = ((2 * column + wide) * size / 2).min(width - 1);
                let sector = &mut sectors[3 * middle / width];
                *sector = sector.max(change.abs() / judge.noise);
            }
        }
        sectors
    }

    /// Blocks from one on as a single one.
    fn group(&self, across: usize, (row, column): (usize, usize), (wide, high): (usize, usize)) -> Block {
        let mut group = Block::default();
        for line in self.blocks[row * across..].chunks(across).take(high) {
            line[column..column + wide].iter().for_each(|block| group.add(block));
        }
        group
    }
}

impl Judge {
    /// The change of blocks that is no fault of the camera.
    fn change(&self, group: &Block) -> f64 {
        if self.loose {
            group.unexplained / group.variance.sqrt()
        } else if self.too_bright {
            // Blocks that are clipped in part pull the gain towards 1.
            least(group.change(self.gain * self.gain), group.change(1.0))
        } else {
            group.change(self.gain)
        }
    }
}

/// The number between two that is nearest to 0.
fn least(a: f64, b: f64) -> f64 {
    0.0_f64.clamp(a.min(b), a.max(b))
}
