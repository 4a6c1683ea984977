use super::area::{Area, resample_into};
use crate::vision::{GrayView, GrayViewMut, GrayWeights, Hog, HogParameters, ImageError, RgbView, gray_into};

/// Side of the patch that a sign is scaled to (pixels).
const SIDE: usize = 40;
/// Side of the squares whose colours are described (pixels).
const SQUARE: usize = 8;
/// Side of a cell of the histograms (pixels).
const CELL: usize = 5;
/// Number of directions of the histograms.
const BINS: usize = 9;
/// Ratio of the patch to the sign in it.
const AROUND: f64 = 1.05;
/// Weight of a square's colours beside histograms of gradients.
const COLOUR: f32 = 3.0;

/// Describes what a sign looks like: histograms of oriented gradients of a patch, and the colours of its
/// squares.
///
/// ```
/// use roverlab::vision::{RgbView, signs::{Area, SignDescriptor}};
/// let pixels: Vec<u8> = (0..60 * 60).flat_map(|i| if i % 60 < 30 { [200, 30, 30] } else { [30, 30, 200] }).collect();
/// let mut descriptor = SignDescriptor::default();
/// let features = descriptor.describe(RgbView::new(&pixels, 60, 60)?, Area::new(10.0, 10.0, 40.0, 40.0))?;
/// assert_eq!(features.len(), SignDescriptor::FEATURES);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug, Clone)]
pub struct SignDescriptor {
    hog: Hog,
    patch: Vec<u8>,
    gray: Vec<u8>,
    features: Vec<f32>,
}

impl Default for SignDescriptor {
    fn default() -> Self {
        let parameters = HogParameters { cell: CELL, block: 2, bins: BINS };
        Self {
            hog: Hog::new(parameters).expect("parameters are in range"),
            patch: Vec::new(),
            gray: vec![0; SIDE * SIDE],
            features: Vec::new(),
        }
    }
}

impl SignDescriptor {
    /// Number of features.
    pub const FEATURES: usize =
        (SIDE / CELL - 1) * (SIDE / CELL - 1) * 4 * BINS + 2 * (SIDE / SQUARE) * (SIDE / SQUARE);

    /// Describes an area of an image, which may reach beyond it.
    ///
    /// # Errors
    ///
    /// If the area is empty, or not finite.
    pub fn describe(&mut self, image: RgbView<'_>, area: Area) -> Result<&[f32], ImageError> {
        area.check()?;
        resample_into(image, area.scaled(AROUND), (SIDE, SIDE), &mut self.patch);
        let patch = RgbView::new(&self.patch, SIDE, SIDE)?;
        gray_into(patch, GrayViewMut::new(&mut self.gray, SIDE, SIDE)?, GrayWeights::default())?;
        self.features.clear();
        self.features.extend_from_slice(self.hog.describe(GrayView::new(&self.gray, SIDE, SIDE)?)?);
        // Relative to the whole patch, as lamps and cameras tint everything.
        let whole = colour_of(&patch);
        for y in (0..SIDE).step_by(SQUARE) {
            for x in (0..SIDE).step_by(SQUARE) {
                let square = colour_of(&patch.region((x, y), SQUARE, SQUARE)?);
                self.features.extend([square[0] - whole[0], square[1] - whole[1]]);
            }
        }
        Ok(&self.features)
    }
}

/// Red and blue of a region against green, relative to its brightness.
fn colour_of(region: &RgbView<'_>) -> [f32; 2] {
    let mut sums = [0_u32; 3];
    for y in 0..region.height() {
        for pixel in region.row(y).chunks_exact(3) {
            for (sum, &byte) in sums.iter_mut().zip(pixel) {
                *sum += u32::from(byte);
            }
        }
    }
    let [red, green, blue] = sums.map(|sum| sum as f32);
    // A black region has no colour.
    let all = red + green + blue + 1.0;
    [COLOUR * (red - green) / all, COLOUR * (blue - green) / all]
}
