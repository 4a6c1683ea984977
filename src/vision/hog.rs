use crate::parameter::require;
use std::f64::consts::PI;

use super::dispatch::vectorised;
use super::{GrayView, ImageError};
use crate::geometry::math;

/// Parameters of [`Hog`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct HogParameters {
    /// Cell size (pixels a side).
    pub cell: usize,
    /// Block size (cells a side).
    pub block: usize,
    /// Number of orientation bins in half a turn.
    pub bins: usize,
}

impl Default for HogParameters {
    /// Values of the paper: cells of 8 x 8 pixels, blocks of 2 x 2 cells, nine bins.
    fn default() -> Self {
        Self { cell: 8, block: 2, bins: 9 }
    }
}

/// Histograms of oriented gradients, a shape descriptor for classifiers (N. Dalal and B. Triggs, "Histograms
/// of oriented gradients for human detection", CVPR 2005). Its buffers are reused from image to image.
///
/// 1. The gradient of a pixel is `dx = e - w`, `dy = s - n`, the image extended by its outermost pixels. Its
///    magnitude is `8 sqrt(dx² + dy²)`, rounded to the nearest.
/// 2. Orientation is that of a line: a gradient that points up, or straight to the left, counts as its
///    opposite. It falls into the last bin `k` with `c dy >= s dx`, where `c` and `s` are 16384 times the
///    cosine and sine of `k pi / bins`, rounded to the nearest.
/// 3. The magnitudes of a cell's pixels are summed per bin. Pixels beyond the last whole cell are ignored.
/// 4. The histograms of a block's cells, row by row, are divided by `sqrt(|v|² + 1)`, clipped at 0.2, and
///    divided by their norm again unless it is 0. Blocks advance by one cell, row by row.
///
/// ```
/// use roverlab::vision::{GrayView, Hog, HogParameters};
/// let mut hog = Hog::new(HogParameters::default())?;
/// let stripes: Vec<u8> = (0..32 * 16).map(|i| if i % 32 < 12 { 0 } else { 250 }).collect();
/// assert_eq!(hog.blocks((32, 16)), (3, 1));
/// let descriptor = hog.describe(GrayView::new(&stripes, 32, 16)?)?;
/// assert_eq!(descriptor.len(), 3 * 4 * 9, "blocks, cells of a block, directions");
/// assert!(descriptor[9] > 0.5 && descriptor[10] == 0.0, "the second cell has an upright edge");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Hog {
    parameters: HogParameters,
    /// Cosine and sine of the bin boundaries, without the first.
    borders: Vec<[i16; 2]>,
    magnitudes: Vec<u16>,
    bins: Vec<u8>,
    /// For each row of cells and each direction, the sums of the row's cells.
    cells: Vec<u32>,
    /// The numbers of a row of blocks: those of the first cell's first direction, of its second one, ...
    columns: Vec<f32>,
    lengths: Vec<f32>,
    descriptor: Vec<f32>,
}

impl Hog {
    /// A descriptor without buffers; the first image allocates them.
    ///
    /// # Errors
    ///
    /// If cells do not have 2 to 64 pixels a side, blocks 1 to 8 cells a side, or there are not 2 to 36 bins.
    pub fn new(parameters: HogParameters) -> Result<Self, ImageError> {
        let HogParameters { cell, block, bins } = parameters;
        for (parameter, found, range, expected) in [
            ("cell of the histograms", cell, 2..=64, "2 to 64"),
            ("block of the histograms", block, 1..=8, "1 to 8"),
            ("bins", bins, 2..=36, "2 to 36"),
        ] {
            require(parameter, found as f64, range.contains(&found), expected)?;
        }
        let border = |bin: usize| {
            let (sin, cos) = math::sin_cos(bin as f64 * PI / bins as f64);
            [cos, sin].map(|part| (16_384.0 * part).round() as i16)
        };
        Ok(Self {
            parameters,
            borders: (1..bins).map(border).collect(),
            magnitudes: Vec::new(),
            bins: Vec::new(),
            cells: Vec::new(),
            columns: Vec::new(),
            lengths: Vec::new(),
            descriptor: Vec::new(),
        })
    }

    /// Number of blocks across and down in an image of a size.
    pub fn blocks(&self, (width, height): (usize, usize)) -> (usize, usize) {
        let HogParameters { cell, block, .. } = self.parameters;
        let along = |pixels: usize| (pixels / cell + 1).saturating_sub(block);
        (along(width), along(height))
    }

    /// Describes an image: `bins` numbers for each cell of each block. Linear in the number of pixels.
    ///
    /// # Errors
    ///
    /// If the image is smaller than one block.
    pub fn describe(&mut self, input: GrayView<'_>) -> Result<&[f32], ImageError> {
        let blocks = self.blocks(input.size());
        if blocks.0 == 0 || blocks.1 == 0 {
            let side = self.parameters.cell * self.parameters.block;
            return Err(ImageError::Size { what: "image", found: input.size(), expected: (side, side) });
        }
        self.fill_cells(input);
        self.fill_descriptor(input.width() / self.parameters.cell, blocks);
        Ok(&self.descriptor)
    }

    fn fill_cells(&mut self, input: GrayView<'_>) {
        let HogParameters { cell, bins, .. } = self.parameters;
        let (across, down) = (input.width() / cell, input.height() / cell);
        self.cells.clear();
        self.cells.resize(across * down * bins, 0);
        self.magnitudes.resize(input.width(), 0);
        self.bins.resize(input.width(), 0);
        for y in 0..down * cell {
            let above = input.row(y.saturating_sub(1));
            let below = input.row((y + 1).min(input.height() - 1));
            orient(above, input.row(y), below, &self.borders, &mut self.magnitudes, &mut self.bins);
            let row = &mut self.cells[y / cell * across * bins..][..across * bins];
            let pixels = self.magnitudes.chunks_exact(cell).zip(self.bins.chunks_exact(cell));
            for (x, (magnitudes, places)) in pixels.enumerate() {
                for (&magnitude, &place) in magnitudes.iter().zip(places) {
                    row[usize::from(place) * across + x] += u32::from(magnitude);
                }
            }
        }
    }

    /// Row by row of blocks, all blocks of a row at a time.
    fn fill_descriptor(&mut self, across: usize, blocks: (usize, usize)) {
        let HogParameters { block, bins, .. } = self.parameters;
        let numbers = block * block * bins;
        self.columns.resize(numbers * blocks.0, 0.0);
        self.lengths.resize(blocks.0, 0.0);
        self.descriptor.resize(blocks.0 * blocks.1 * numbers, 0.0);
        for (y, descriptor) in self.descriptor.chunks_exact_mut(blocks.0 * numbers).enumerate() {
            for (number, column) in self.columns.chunks_exact_mut(blocks.0).enumerate() {
                let (row, left, bin) = (number / bins / block, number / bins % block, number % bins);
                let sums = &self.cells[((y + row) * bins + bin) * across + left..];
                column.iter_mut().zip(sums).for_each(|(number, &sum)| *number = sum as f32);
            }
            normalise(&mut self.columns, &mut self.lengths);
            for (x, block) in descriptor.chunks_exact_mut(numbers).enumerate() {
                let columns = self.columns.chunks_exact(blocks.0);
                block.iter_mut().zip(columns).for_each(|(number, column)| *number = column[x]);
            }
        }
    }
}

/// Squared norm of each block, summed in order so that the result is reproducible.
#[inline(always)]
fn squared_lengths(columns: &[f32], lengths: &mut [f32]) {
    lengths.fill(0.0);
    for column in columns.chunks_exact(lengths.len()) {
        lengths.iter_mut().zip(column).for_each(|(sum, number)| *sum += number * number);
    }
}

vectorised! {
    /// Normalises the blocks of a row.
    fn normalise(columns: &mut [f32], lengths: &mut [f32]) {
        squared_lengths(columns, lengths);
        for length in &mut *lengths {
            *length = (*length + 1.0).sqrt();
        }
        for column in columns.chunks_exact_mut(lengths.len()) {
            for (number, &length) in column.iter_mut().zip(&*lengths) {
                let share = *number / length;
                *number = if share < 0.2 { share } else { 0.2 };
            }
        }
        squared_lengths(columns, lengths);
        for length in &mut *lengths {
            *length = if *length > 0.0 { length.sqrt() } else { 1.0 };
        }
        for column in columns.chunks_exact_mut(lengths.len()) {
            column.iter_mut().zip(&*lengths).for_each(|(number, &length)| *number /= length);
        }
    }
}

/// Computes the magnitudes and bins of a row.
#[inline(always)]
pub(super) fn orient_portable(
    above: &[u8],
    row: &[u8],
    below: &[u8],
    borders: &[[i16; 2]],
    magnitudes: &mut [u16],
    bins: &mut [u8],
) {
    /// Number of pixels processed at a time.
    const PIECE: usize = 64;
    let width = row.len();
    let mut padded = [0_u8; PIECE + 2];
    let (mut dxs, mut dys) = ([0_i16; PIECE], [0_i16; PIECE]);
    for start in (0..width).step_by(PIECE) {
        let n = PIECE.min(width - start);
        let (dxs, dys) = (&mut dxs[..n], &mut dys[..n]);
        // With the neighbours of its ends, so that the loop has no cases.
        padded[0] = row[start.saturating_sub(1)];
        padded[1..=n].copy_from_slice(&row[start..][..n]);
        padded[n + 1] = row[(start + n).min(width - 1)];
        for ((dx, &w), &e) in dxs.iter_mut().zip(&padded).zip(&padded[2..]) {
            *dx = i16::from(e) - i16::from(w);
        }
        let (above, below) = (&above[start..][..n], &below[start..][..n]);
        for ((dy, &n), &s) in dys.iter_mut().zip(above).zip(below) {
            *dy = i16::from(s) - i16::from(n);
        }
        let magnitudes = &mut magnitudes[start..][..n];
        for ((magnitude, &dx), &dy) in magnitudes.iter_mut().zip(&*dxs).zip(&*dys) {
            let (dx, dy) = (i32::from(dx), i32::from(dy));
            *magnitude = (8.0 * ((dx * dx + dy * dy) as f32).sqrt() + 0.5) as u16;
        }
        for (dx, dy) in dxs.iter_mut().zip(dys.iter_mut()) {
            let turn = (*dy < 0) | ((*dy == 0) & (*dx < 0));
            (*dx, *dy) = if turn { (-*dx, -*dy) } else { (*dx, *dy) };
        }
        let bins = &mut bins[start..][..n];
        bins.fill(0);
        for &[cos, sin] in borders {
            for ((bin, &dx), &dy) in bins.iter_mut().zip(&*dxs).zip(&*dys) {
                let (right, down) = (i32::from(sin) * i32::from(dx), i32::from(cos) * i32::from(dy));
                *bin += u8::from(down >= right);
            }
        }
    }
}

vectorised! {
    fn orient(
        above: &[u8],
        row: &[u8],
        below: &[u8],
        borders: &[[i16; 2]],
        magnitudes: &mut [u16],
        bins: &mut [u8],
    ) {
        orient_portable(above, row, below, borders, magnitudes, bins);
    }
}
