use super::area::{Area, resample_into};
use super::linear::LinearClassifier;
use crate::ParameterError;
use crate::vision::dispatch::vectorised;
use crate::vision::{GrayView, GrayViewMut, GrayWeights, Hog, HogParameters, ImageError, RgbView, gray_into};

/// Number of cells on a side of the window.
const CELLS: usize = 6;
/// Side of a cell (pixels).
const CELL: usize = 4;
/// Number of blocks on a side of the window.
const BLOCKS: usize = CELLS - 1;
/// Number of features of a block.
const BLOCK: usize = 4 * BINS;
/// Number of directions.
const BINS: usize = 9;
/// Ratio of the window to the sign in it.
pub(super) const AROUND: f64 = 1.25;
/// Ratio of the sizes of an image of the pyramid and the next: four an octave.
const STEP: f64 = 1.189_207_115_002_721;

/// A window that may show a sign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Candidate {
    /// The sign's area.
    pub area: Area,
    pub score: f32,
}

/// Looks for signs of any class: a linear classifier of histograms of gradients, at each cell of a pyramid.
#[derive(Debug, Clone)]
pub(super) struct Detector {
    hog: Hog,
    /// The image, then images that are smaller and smaller.
    level: Vec<u8>,
    next: Vec<u8>,
}

impl Default for Detector {
    fn default() -> Self {
        let hog =
            Hog::new(HogParameters { cell: CELL, block: 2, bins: BINS }).expect("parameters are in range");
        Self { hog, level: Vec::new(), next: Vec::new() }
    }
}

impl Detector {
    /// Number of features of a window.
    pub(super) const FEATURES: usize = BLOCKS * BLOCKS * BLOCK;

    /// Describes the window around a sign, scaled to the size of one.
    pub(super) fn describe(&mut self, image: GrayView<'_>, sign: Area) -> Result<&[f32], ImageError> {
        let side = CELLS * CELL;
        resample_into(image, sign.scaled(AROUND), (side, side), &mut self.level);
        self.hog.describe(GrayView::new(&self.level, side, side)?)
    }

    /// Gives each image of the pyramid to `see`.
    fn levels(&mut self, image: GrayView<'_>, mut see: impl FnMut(&Level<'_>)) -> Result<(), ImageError> {
        let side = CELLS * CELL;
        let (mut width, mut height) = image.size();
        self.level.clear();
        (0..height).for_each(|y| self.level.extend_from_slice(image.row(y)));
        let mut scale = 1.0;
        while width >= side && height >= side {
            let level = GrayView::new(&self.level, width, height)?;
            let (across, down) = self.hog.blocks((width, height));
            let (blocks, _) = self.hog.describe(level)?.as_chunks::<BLOCK>();
            see(&Level { blocks, across, down, scale });
            let smaller = |pixels: usize| (pixels as f64 / STEP) as usize;
            let (less_wide, less_high) = (smaller(width), smaller(height));
            if less_wide < side || less_high < side {
                break;
            }
            // Whole pixels of the smaller image are STEP pixels of this one.
            let area = Area::new(0.0, 0.0, less_wide as f64 * STEP, less_high as f64 * STEP);
            resample_into(level, area, (less_wide, less_high), &mut self.next);
            std::mem::swap(&mut self.level, &mut self.next);
            (width, height, scale) = (less_wide, less_high, scale * STEP);
        }
        Ok(())
    }

    /// The windows that may show a sign.
    pub(super) fn candidates(
        &mut self,
        image: GrayView<'_>,
        weights: &WindowWeights,
    ) -> Result<Vec<Candidate>, ImageError> {
        let mut found = Vec::new();
        let mut scoring = Scoring::new(weights);
        let mut row = Vec::new();
        self.levels(image, |level| {
            for y in 0..level.down + 1 - BLOCKS {
                scoring.any(level, y, &mut row);
                for (x, _) in row.iter().enumerate().filter(|&(_, &any)| any > POSSIBLE) {
                    let score = scoring.best(&level.window(x, y));
                    if score > LIKELY {
                        found.push(Candidate { area: level.area(x, y), score });
                    }
                }
            }
        })?;
        Ok(found)
    }
}

/// An image of the pyramid.
struct Level<'a> {
    /// Features of its blocks, row by row.
    blocks: &'a [[f32; BLOCK]],
    across: usize,
    down: usize,
    /// Pixels of the whole image a pixel of it.
    scale: f64,
}

impl<'a> Level<'a> {
    fn window(&self, x: usize, y: usize) -> Window<'a> {
        std::array::from_fn(|line| {
            let row = self.blocks[(y + line) * self.across + x..].first_chunk();
            row.expect("a window inside the image")
        })
    }

    /// The area of the sign in a window.
    fn area(&self, x: usize, y: usize) -> Area {
        let corner = |cell: usize| (cell * CELL) as f64 * self.scale;
        let side = corner(CELLS);
        Area::new(corner(x), corner(y), side, side).scaled(1.0 / AROUND)
    }
}

/// Score as any sign from which a window is compared with each class.
const POSSIBLE: f32 = -0.8;
/// Score as one class from which a window is looked at in detail.
const LIKELY: f32 = -0.4;

/// Classifiers of windows: as any sign, and as one of each class.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct WindowWeights {
    pub any: LinearClassifier,
    pub each: LinearClassifier,
}

impl WindowWeights {
    pub(super) fn new(any: LinearClassifier, each: LinearClassifier) -> Result<Self, ParameterError> {
        any.require("features of a window", 1, Detector::FEATURES)?;
        each.require("features of a window", each.classes(), Detector::FEATURES)?;
        Ok(Self { any, each })
    }
}

/// Weights as products need them.
struct Scoring<'a> {
    any: Window<'a>,
    each: Vec<Window<'a>>,
    weights: &'a WindowWeights,
    products: Vec<f32>,
}

impl<'a> Scoring<'a> {
    fn new(weights: &'a WindowWeights) -> Self {
        let any = rows_of(weights.any.weights());
        let each: Vec<_> = class_rows(&weights.each).map(rows_of).collect();
        let products = vec![0.0; each.len()];
        Self { any, each, weights, products }
    }

    /// Scores as any sign, of all windows of a row.
    fn any(&self, level: &Level<'_>, y: usize, scores: &mut Vec<f32>) {
        let windows: Vec<_> = (0..level.across + 1 - BLOCKS).map(|x| level.window(x, y)).collect();
        scores.resize(windows.len(), 0.0);
        products(&windows, &self.any, scores);
        let constant = self.weights.any.weights()[Detector::FEATURES];
        for score in scores {
            *score += constant;
        }
    }

    /// The best score as one class.
    fn best(&mut self, window: &Window<'_>) -> f32 {
        products(&self.each, window, &mut self.products);
        let rows = self.products.iter().zip(class_rows(&self.weights.each));
        rows.map(|(product, row)| product + row[Detector::FEATURES]).fold(f32::NEG_INFINITY, f32::max)
    }
}

/// The weights of each class.
fn class_rows(classifier: &LinearClassifier) -> impl Iterator<Item = &[f32]> {
    classifier.weights().chunks_exact(Detector::FEATURES + 1)
}

/// Features of the blocks of a window, or their weights, row by row.
pub(super) type Window<'a> = [&'a [[f32; BLOCK]; BLOCKS]; BLOCKS];

/// The weights of a class.
fn rows_of(weights: &[f32]) -> Window<'_> {
    let (blocks, _) = weights.as_chunks::<BLOCK>();
    let (rows, _) = blocks.as_chunks::<BLOCKS>();
    std::array::from_fn(|row| &rows[row])
}

/// Number of scalar products that are computed at a time.
const TOGETHER: usize = 4;
/// Number of sums that a scalar product is divided into.
const LANES: usize = 16;

vectorised! {
    /// Scalar products of many windows with one; the same bits for all processors.
    pub(super) fn products(many: &[Window<'_>], one: &Window<'_>, products: &mut [f32]) {
        let (groups, rest) = many.as_chunks::<TOGETHER>();
        let (results, last) = products.as_chunks_mut::<TOGETHER>();
        for (group, results) in groups.iter().zip(results) {
            *results = product(group, one);
        }
        for (window, result) in rest.iter().zip(last) {
            [*result] = product(&[*window], one);
        }
    }
}

/// The result of a window is the same for any number of them.
#[inline(always)]
fn product<const N: usize>(many: &[Window<'_>; N], one: &Window<'_>) -> [f32; N] {
    let mut sums = [[0.0_f32; LANES]; N];
    for (line, row) in one.iter().enumerate() {
        let (whole, rest) = row.as_flattened().as_chunks::<LANES>();
        let others: [_; N] = std::array::from_fn(|n| many[n][line].as_flattened().as_chunks::<LANES>());
        for (place, values) in whole.iter().enumerate() {
            for (sums, (other, _)) in sums.iter_mut().zip(&others) {
                let other = &other[place];
                // As a new array the sums stay in registers.
                *sums = std::array::from_fn(|lane| sums[lane] + values[lane] * other[lane]);
            }
        }
        for (sums, (_, other)) in sums.iter_mut().zip(others) {
            for ((sum, value), other) in sums.iter_mut().zip(rest).zip(other) {
                *sum += value * other;
            }
        }
    }
    sums.map(|mut lanes| {
        let mut half = LANES / 2;
        while half > 0 {
            (0..half).for_each(|lane| lanes[lane] += lanes[lane + half]);
            half /= 2;
        }
        lanes[0]
    })
}

/// Those that no better one overlaps, the best first. What lies in another is a part of it.
pub(super) fn best_around<T>(mut found: Vec<T>, of: impl Fn(&T) -> (Area, f32)) -> Vec<T> {
    found.sort_by(|a, b| of(b).1.total_cmp(&of(a).1));
    let mut kept: Vec<T> = Vec::new();
    for one in found {
        if kept.iter().all(|better| !of(better).0.shares(&of(&one).0)) {
            kept.push(one);
        }
    }
    kept
}

/// The gray levels of a colour image.
pub(super) fn gray_of(image: RgbView<'_>, gray: &mut Vec<u8>) -> Result<(), ImageError> {
    let (width, height) = image.size();
    gray.resize(width * height, 0);
    gray_into(image, GrayViewMut::new(gray, width, height)?, GrayWeights::default())
}
