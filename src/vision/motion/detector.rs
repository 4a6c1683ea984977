use crate::vision::{Error, GrayView, mean_difference, view::require_size};

/// What makes motion for a [`MotionDetector`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionParameters {
    /// Pixels on each side of the blocks that are compared.
    pub block: usize,
    /// Levels, of 255, by which a white block's mean may change without motion.
    pub threshold: f64,
    /// Pixels by which edges may be off without motion: 0 for a robot that stands.
    pub slack: f64,
}

impl Default for MotionParameters {
    /// For a robot that stands and a camera with the noise of the real one.
    fn default() -> Self {
        Self { block: 8, threshold: 2.3, slack: 0.0 }
    }
}

/// How much moved from one image to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// The largest change of a block in each third of the image: left, middle, right. In levels of a white block.
    pub sectors: [f64; 3],
    /// The mean of the absolute difference over all pixels (Programs 11.12 and 11.13).
    pub mean_difference: f64,
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
/// been brought to the first one's brightness. A camera's noise grows with the square root of the brightness, so the
/// change of a darker block counts for more.
#[derive(Debug, Clone)]
pub struct MotionDetector {
    parameters: MotionParameters,
    sums: Vec<Block>,
}

/// Sums over a block's pixels: of both images, of the edges, and their number.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    first: u32,
    second: u32,
    edges: u32,
    pixels: u32,
}

/// Noise does not fall below that of this level.
const DARKEST: f64 = 10.0;

impl MotionDetector {
    /// A detector. Fails unless blocks have 2 to 256 pixels a side and threshold and slack are numbers of at least 0.
    pub fn new(parameters: MotionParameters) -> Result<Self, Error> {
        let MotionParameters { block, threshold, slack } = parameters;
        if !(2..=256).contains(&block) {
            let found = block as f64;
            return Err(Error::Parameter { parameter: "motion block", found, expected: "2 to 256" });
        }
        for (parameter, found) in [("motion threshold", threshold), ("motion slack", slack)] {
            if !(found.is_finite() && found >= 0.0) {
                let expected = "a finite number of at least 0";
                return Err(Error::Parameter { parameter, found, expected });
            }
        }
        Ok(Self { parameters, sums: Vec::new() })
    }

    /// What moved between two images of one size.
    pub fn compare(&mut self, first: GrayView<'_>, second: GrayView<'_>) -> Result<Motion, Error> {
        require_size("second image", second.size(), first.size())?;
        let (width, height) = first.size();
        let size = self.parameters.block;
        let across = width.div_ceil(size);
        self.sums.clear();
        self.sums.resize(across * height.div_ceil(size), Block::default());
        for y in 0..height {
            let sums = &mut self.sums[y / size * across..][..across];
            let rows = first.row(y).chunks(size).zip(second.row(y).chunks(size));
            for (block, (a, b)) in sums.iter_mut().zip(rows) {
                block.first += a.iter().map(|&shade| u32::from(shade)).sum::<u32>();
                block.second += b.iter().map(|&shade| u32::from(shade)).sum::<u32>();
                block.edges += a.windows(2).map(|pair| u32::from(pair[0].abs_diff(pair[1]))).sum::<u32>();
                block.pixels += a.len() as u32;
            }
        }
        let mean_difference = mean_difference(first, second)?;
        Ok(self.judge(across, width, mean_difference))
    }

    fn judge(&self, across: usize, width: usize, mean_difference: f64) -> Motion {
        let MotionParameters { block: size, threshold, slack } = self.parameters;
        let gain = self.gain();
        let mut sectors = [0.0_f64; 3];
        for (index, block) in self.sums.iter().enumerate() {
            let pixels = f64::from(block.pixels);
            let change = (f64::from(block.first) - gain * f64::from(block.second)).abs() / pixels;
            let shade = 0.5 * f64::from(block.first + block.second) / pixels;
            let noise = (shade.max(DARKEST) / 255.0).sqrt();
            let excess = (change - slack * f64::from(block.edges) / pixels) / noise;
            // A block belongs to the sector of its middle.
            let middle = (index % across * size + size / 2).min(width - 1);
            let sector = &mut sectors[3 * middle / width];
            *sector = sector.max(excess);
        }
        let strongest = (0..3).max_by(|&a, &b| sectors[a].total_cmp(&sectors[b]));
        let strongest = strongest.filter(|&sector| sectors[sector] > threshold);
        Motion { sectors, mean_difference, strongest }
    }

    /// The factor that brings the second image to the first one's brightness: the median over the blocks, which motion
    /// in a few of them does not touch.
    fn gain(&self) -> f64 {
        let ratio = |block: &Block| f64::from(block.first.max(1)) / f64::from(block.second.max(1));
        let mut ratios: Vec<f64> = self.sums.iter().map(ratio).collect();
        let middle = ratios.len() / 2;
        *ratios.select_nth_unstable_by(middle, f64::total_cmp).1
    }
}
