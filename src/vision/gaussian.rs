use super::blocks::in_blocks;
use super::border::{Border, mirrored, stencil};
use super::dispatch::{vectorised, vectorised_filter};
use super::{GrayView, GrayViewMut, ImageError};
use crate::ParameterError;
use crate::geometry::math;

/// A symmetric Gaussian filter of 3, 5 or 7 pixels a side.
///
/// The weights are in 256ths and sum to 1. The named kernels have OpenCV's weights: binomial `1 2 1` and
/// `1 4 6 4 1` for 3 and 5 pixels, and `2 7 14 18 14 7 2` (64ths) for 7.
///
/// ```
/// use roverlab::vision::GaussianKernel;
/// assert_eq!(GaussianKernel::THREE.weights(), [128, 64, 0, 0], "1/4 1/2 1/4");
/// let flat = GaussianKernel::new(3, 10.0)?;
/// assert_eq!((flat.size(), flat.weights()), (3, [86, 85, 0, 0]), "a wide bell is almost a mean");
/// assert!(GaussianKernel::new(4, 1.0).is_err());
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GaussianKernel {
    /// Centre weight, then those towards either side.
    weights: [u16; 4],
    size: usize,
}

impl GaussianKernel {
    /// 3 x 3 pixels.
    pub const THREE: Self = Self { weights: [128, 64, 0, 0], size: 3 };
    /// 5 x 5 pixels.
    pub const FIVE: Self = Self { weights: [96, 64, 16, 0], size: 5 };
    /// 7 x 7 pixels.
    pub const SEVEN: Self = Self { weights: [72, 56, 28, 8], size: 7 };

    /// The kernel of a size and a standard deviation `sigma` (pixels). Weights are rounded from the outermost
    /// inwards, each including the rounding error of the one before; the centre weight makes the sum 1.
    ///
    /// # Errors
    ///
    /// If the size is not 3, 5 or 7, or `sigma` is not positive and finite.
    pub fn new(size: usize, sigma: f64) -> Result<Self, ImageError> {
        if ![3, 5, 7].contains(&size) {
            let found = size as f64;
            return Err(ParameterError::new("Gaussian size", found, "3, 5 or 7").into());
        }
        if !(sigma.is_finite() && sigma > 0.0) {
            let expected = "a positive, finite number";
            return Err(ParameterError::new("Gaussian sigma", sigma, expected).into());
        }
        let radius = size / 2;
        let bell = |i: usize| math::exp(-((i * i) as f64) / (2.0 * sigma * sigma));
        let sum = bell(0) + 2.0 * (1..=radius).map(bell).sum::<f64>();
        let mut weights = [0; 4];
        let mut error = 0.0;
        for i in (1..=radius).rev() {
            let exact = 256.0 * bell(i) / sum + error;
            weights[i] = exact.round_ties_even() as u16;
            error = exact - f64::from(weights[i]);
        }
        weights[0] = 256 - 2 * weights.iter().sum::<u16>();
        Ok(Self { weights, size })
    }

    /// Pixels on each side.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Weights from the centre outwards (256ths); 0 beyond the kernel.
    pub fn weights(&self) -> [u16; 4] {
        self.weights
    }
}

/// Smooths an image. Each pixel becomes the weighted sum of its surroundings, rounded to the nearest, halves
/// up. The image is mirrored at the border.
///
/// ```
/// use roverlab::vision::{GaussianKernel, GrayView, GrayViewMut, gaussian_into};
/// let dot = [0, 0, 0, 0, 160, 0, 0, 0, 0];
/// let mut smooth = [0; 9];
/// gaussian_into(GrayView::new(&dot, 3, 3)?, GrayViewMut::new(&mut smooth, 3, 3)?, GaussianKernel::THREE)?;
/// assert_eq!(smooth[4], 40, "the dot keeps a half of a half");
/// assert_eq!(smooth[3..6], [40, 40, 40], "and the mirrored border sees it twice");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
///
/// # Errors
///
/// If the sizes differ.
pub fn gaussian_into(
    input: GrayView<'_>,
    mut output: GrayViewMut<'_>,
    kernel: GaussianKernel,
) -> Result<(), ImageError> {
    output.require_size(input.size())?;
    match kernel {
        GaussianKernel::THREE => smooth_three(input, &mut output),
        GaussianKernel::FIVE => smooth_five(input, &mut output),
        kernel => smooth(input, &mut output, kernel),
    }
    Ok(())
}

/// Number of columns smoothed at a time; their sums fit the L1 cache.
const STRIP: usize = 4096;

/// Sums of a strip, with three more columns on either side.
type Sums = [u16; STRIP + 6];

#[inline(always)]
pub(super) fn three_portable(input: GrayView<'_>, output: &mut GrayViewMut<'_>) {
    stencil(input, output, Border::Mirror, binomial);
}

// Small integer weights keep the sums within 16 bits.

#[inline(always)]
pub(super) fn five_portable(input: GrayView<'_>, output: &mut GrayViewMut<'_>) {
    filter::<2, true>(input, output, [6, 4, 1, 0]);
}

/// The seven-pixel kernel, and kernels with arbitrary weights.
#[inline(always)]
pub(super) fn smooth_portable(input: GrayView<'_>, output: &mut GrayViewMut<'_>, kernel: GaussianKernel) {
    let GaussianKernel { weights, size } = kernel;
    match size {
        _ if kernel == GaussianKernel::SEVEN => filter::<3, true>(input, output, [18, 14, 7, 2]),
        3 => filter::<1, false>(input, output, weights),
        5 => filter::<2, false>(input, output, weights),
        _ => filter::<3, false>(input, output, weights),
    }
}

/// 3 x 3 pixels with weights in 16ths.
#[inline(always)]
fn binomial([[nw, n, ne], [w, c, e], [sw, s, se]]: [[u16; 3]; 3]) -> u16 {
    let (west, middle, east) = (nw + 2 * w + sw, n + 2 * c + s, ne + 2 * e + se);
    // The sum of two adjacent columns also serves the next pixel.
    ((west + middle + 8) + (middle + east)) >> 4
}

/// Sums columns, then rows of those sums, strip by strip. `SMALL` selects the weights of the named kernels.
///
/// No function is passed as an argument: calls through one are not inlined and not compiled for the
/// processor.
#[inline(always)]
fn filter<const R: usize, const SMALL: bool>(
    input: GrayView<'_>,
    output: &mut GrayViewMut<'_>,
    weights: [u16; 4],
) {
    let (width, height) = input.size();
    let mut sums: Sums = [0; STRIP + 6];
    for start in (0..width).step_by(STRIP) {
        let end = (start + STRIP).min(width);
        // Columns that the strip needs and the image has.
        let (from, to) = (start.saturating_sub(R), (end + R).min(width));
        let offset = from + R - start;
        for y in 0..height {
            down::<R>(input, y, (from, to), weights, &mut sums[offset..][..to - from]);
            if start == 0 || end + R > width {
                mirror_columns::<R>(&mut sums, start, end, width);
            }
            let out = &mut output.row_mut(y)[start..end];
            let sums = &sums[..end - start + 2 * R];
            match (SMALL, R) {
                (true, 2) => across_five(sums, out),
                (true, _) => across_seven(sums, out),
                (false, _) => across_32::<R>(sums, out, weights.map(u32::from)),
            }
        }
    }
}

/// A range of columns of the row `dy` below `y`.
#[inline(always)]
fn row(input: GrayView<'_>, y: usize, dy: isize, (from, to): (usize, usize)) -> &[u8] {
    &input.row(mirrored(y as isize + dy, input.height()))[from..to]
}

/// Weighted column sums.
#[inline(always)]
fn down<const R: usize>(
    input: GrayView<'_>,
    y: usize,
    columns: (usize, usize),
    weights: [u16; 4],
    sums: &mut [u16],
) {
    let [w0, w1, w2, w3] = weights;
    let c = row(input, y, 0, columns);
    let (n1, s1) = (row(input, y, -1, columns), row(input, y, 1, columns));
    if R == 1 {
        in_blocks!(sums; c in c, n in n1, s in s1 => w0 * u16::from(c) + w1 * both(n, s));
        return;
    }
    let (n2, s2) = (row(input, y, -2, columns), row(input, y, 2, columns));
    if R == 2 {
        in_blocks!(sums; c in c, n1 in n1, s1 in s1, n2 in n2, s2 in s2 => {
            w0 * u16::from(c) + w1 * both(n1, s1) + w2 * both(n2, s2)
        });
        return;
    }
    let (n3, s3) = (row(input, y, -3, columns), row(input, y, 3, columns));
    in_blocks!(sums; c in c, n1 in n1, s1 in s1, n2 in n2, s2 in s2, n3 in n3, s3 in s3 => {
        w0 * u16::from(c) + w1 * both(n1, s1) + w2 * both(n2, s2) + w3 * both(n3, s3)
    });
}

#[inline(always)]
fn both(a: u8, b: u8) -> u16 {
    u16::from(a) + u16::from(b)
}

/// Fills in the sums of mirrored columns outside the image.
fn mirror_columns<const R: usize>(sums: &mut Sums, start: usize, end: usize, width: usize) {
    let column = |x: isize| mirrored(x, width) + R - start;
    if start == 0 {
        for i in 1..=R {
            sums[R - i] = sums[column(-(i as isize))];
        }
    }
    // The strip may end up to `R` columns before the image does.
    for x in width..end + R {
        sums[x + R - start] = sums[column(x as isize)];
    }
}

#[inline(always)]
fn across_five(sums: &[u16], out: &mut [u8]) {
    in_blocks!(out; w2 in sums, w1 in sums[1..], c in sums[2..], e1 in sums[3..], e2 in sums[4..] => {
        ((6 * c + 4 * (w1 + e1) + w2 + e2 + 128) >> 8) as u8
    });
}

/// The sum `T = 18 c + 14 a + 7 b + 2 d` of column sums in 64ths needs 20 bits, but only `(T + 2048) / 4096`
/// is wanted. Because `T = 16 (c + a) + 2 (c + d) - 2 a + 7 b`, the terms that are not multiples of 16 are
/// split into high and low parts; the high part of `T / 16` then fits 16 bits.
#[inline(always)]
fn across_seven(sums: &[u16], out: &mut [u8]) {
    let (c, e1, e2, e3) = (&sums[3..], &sums[4..], &sums[5..], &sums[6..]);
    in_blocks!(out; w3 in sums, w2 in sums[1..], w1 in sums[2..], c in c, e1 in e1, e2 in e2, e3 in e3 => {
        let (a, b, d) = (w1 + e1, w2 + e2, w3 + e3);
        let f = c + d;
        let high = (c + a).wrapping_add(f >> 3).wrapping_sub(a >> 3).wrapping_add(7 * (b >> 4));
        let low = (2 * (f & 7) + 2048 + 7 * (b & 15) - 2 * (a & 7)) >> 4;
        (high.wrapping_add(low) >> 8) as u8
    });
}

#[inline(always)]
fn across_32<const R: usize>(sums: &[u16], out: &mut [u8], weights: [u32; 4]) {
    let n = out.len();
    let column = |i: usize| &sums[i.min(2 * R)..][..n];
    let (c, w1, e1) = (column(R), column(R - 1), column(R + 1));
    let (w2, e2) = (column(R.saturating_sub(2)), column(R + 2));
    let (w3, e3) = (column(R.saturating_sub(3)), column(R + 3));
    let both = |a: u16, b: u16| u32::from(a) + u32::from(b);
    for x in 0..n {
        let mut sum = weights[0] * u32::from(c[x]) + weights[1] * both(w1[x], e1[x]) + (1 << 15);
        if R > 1 {
            sum += weights[2] * both(w2[x], e2[x]);
        }
        if R > 2 {
            sum += weights[3] * both(w3[x], e3[x]);
        }
        out[x] = (sum >> 16) as u8;
    }
}

// One function each: with several loops in one, the compiler keeps pointers and weights in memory.

vectorised_filter! {
    fn smooth_three(input: GrayView<'_>, output: &mut GrayViewMut<'_>) {
        three_portable(input, output);
    }
}

vectorised_filter! {
    fn smooth_five(input: GrayView<'_>, output: &mut GrayViewMut<'_>) {
        five_portable(input, output);
    }
}

// For seven pixels, `vectorised_filter!` is a tenth slower, as measured.
vectorised! {
    fn smooth(input: GrayView<'_>, output: &mut GrayViewMut<'_>, kernel: GaussianKernel) {
        smooth_portable(input, output, kernel);
    }
}
