use super::area::{Area, resample_into};
use super::linear::{LinearClassifier, dot};
use crate::ParameterError;
use crate::vision::{GrayView, GrayViewMut, GrayWeights, Hog, HogParameters, ImageError, RgbView, gray_into};

/// Number of cells on a side of the window.
const CELLS: usize = 6;
/// Side of a cell (pixels).
const CELL: usize = 4;
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
        let hog = Hog::new(HogParameters { cell: CELL, block: 2, bins: 9 }).expect("parameters are in range");
        Self { hog, level: Vec::new(), next: Vec::new() }
    }
}

impl Detector {
    /// Number of features of a window.
    pub(super) const FEATURES: usize = (CELLS - 1) * (CELLS - 1) * 4 * 9;

    /// Describes the window around a sign, scaled to the size of one.
    pub(super) fn describe(&mut self, image: GrayView<'_>, sign: Area) -> Result<&[f32], ImageError> {
        let side = CELLS * CELL;
        resample_into(image, sign.scaled(AROUND), (side, side), &mut self.level);
        self.hog.describe(GrayView::new(&self.level, side, side)?)
    }

    /// Gives each window to `see`: its features, row by row of its blocks, and the area of its sign.
    pub(super) fn windows(
        &mut self,
        image: GrayView<'_>,
        mut see: impl FnMut(Window<'_>, Area),
    ) -> Result<(), ImageError> {
        let side = CELLS * CELL;
        let (mut width, mut height) = image.size();
        self.level.clear();
        (0..height).for_each(|y| self.level.extend_from_slice(image.row(y)));
        let mut scale = 1.0;
        while width >= side && height >= side {
            let level = GrayView::new(&self.level, width, height)?;
            let (across, down) = self.hog.blocks((width, height));
            let blocks = self.hog.describe(level)?;
            let block = blocks.len() / (across * down);
            for y in 0..=down + 1 - CELLS {
                for x in 0..=across + 1 - CELLS {
                    let row =
                        |line: usize| &blocks[((y + line) * across + x) * block..][..(CELLS - 1) * block];
                    let corner = |cell: usize| (cell * CELL) as f64 * scale;
                    let window = Area::new(corner(x), corner(y), side as f64 * scale, side as f64 * scale);
                    see(std::array::from_fn(row), window.scaled(1.0 / AROUND));
                }
            }
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
        self.windows(image, |rows, area| {
            if weights.any_score(&rows) > POSSIBLE {
                let score = weights.best_score(&rows);
                if score > LIKELY {
                    found.push(Candidate { area, score });
                }
            }
        })?;
        Ok(found)
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

    fn any_score(&self, rows: &Window<'_>) -> f32 {
        score_of(self.any.weights(), rows)
    }

    fn best_score(&self, rows: &Window<'_>) -> f32 {
        let classes = self.each.weights().chunks_exact(Detector::FEATURES + 1);
        classes.map(|weights| score_of(weights, rows)).fold(f32::NEG_INFINITY, f32::max)
    }
}

/// Features of a window, a slice for each row of its blocks.
pub(super) type Window<'a> = [&'a [f32]; CELLS - 1];

fn score_of(weights: &[f32], rows: &Window<'_>) -> f32 {
    let parts = rows.iter().zip(weights.chunks_exact(rows[0].len()));
    weights[Detector::FEATURES] + parts.map(|(row, weights)| dot(row, weights)).sum::<f32>()
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
