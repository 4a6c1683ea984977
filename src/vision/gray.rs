use super::dispatch::vectorised_filter;
use super::view::flatten;
use super::{GrayView, GrayViewMut, ImageError, RgbView, RgbViewMut, planes};

/// Weights of the colour channels in the gray level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum GrayWeights {
    /// RoBIOS: `(red + blue) / 4 + green / 2`, both rounded down.
    #[default]
    Robios,
    /// Rec. 601 as in OpenCV: `0.299 red + 0.587 green + 0.114 blue`, in fixed point
    /// `(9798 red + 19235 green + 3735 blue + 16384) / 32768`, rounded down.
    Rec601,
}

/// Converts colour to gray levels.
///
/// ```
/// use roverlab::vision::{GrayViewMut, GrayWeights, RgbView, gray_into};
/// let colours = [255, 0, 0, 0, 255, 0, 0, 0, 255];
/// let mut gray = [0; 3];
/// gray_into(RgbView::new(&colours, 3, 1)?, GrayViewMut::new(&mut gray, 3, 1)?, GrayWeights::Rec601)?;
/// assert_eq!(gray, [76, 150, 29], "green is the brightest to the eye, blue the darkest");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
///
/// # Errors
///
/// If the sizes differ.
pub fn gray_into(
    input: RgbView<'_>,
    output: GrayViewMut<'_>,
    weights: GrayWeights,
) -> Result<(), ImageError> {
    output.require_size(input.size())?;
    let (input, mut output) = flatten(input, output);
    gray(input, &mut output, weights);
    Ok(())
}

/// Converts gray levels to colour: each byte three times.
///
/// ```
/// use roverlab::vision::{GrayView, RgbViewMut, gray_to_rgb_into};
/// let mut colours = [0; 6];
/// gray_to_rgb_into(GrayView::new(&[7, 90], 2, 1)?, RgbViewMut::new(&mut colours, 2, 1)?)?;
/// assert_eq!(colours, [7, 7, 7, 90, 90, 90]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
///
/// # Errors
///
/// If the sizes differ.
pub fn gray_to_rgb_into(input: GrayView<'_>, output: RgbViewMut<'_>) -> Result<(), ImageError> {
    output.require_size(input.size())?;
    let (input, mut output) = flatten(input, output);
    triple(input, &mut output);
    Ok(())
}

#[inline(always)]
pub(super) fn gray_portable(input: RgbView<'_>, output: &mut GrayViewMut<'_>, weights: GrayWeights) {
    for y in 0..input.height() {
        let (row, out) = (input.row(y), output.row_mut(y));
        match weights {
            GrayWeights::Robios => planes::map(row, out, |red, green, blue| {
                ((u16::from(red) + u16::from(blue)) / 4) as u8 + green / 2
            }),
            GrayWeights::Rec601 => planes::map(row, out, |red, green, blue| {
                let (red, green, blue) = (u32::from(red), u32::from(green), u32::from(blue));
                ((9798 * red + 19_235 * green + 3735 * blue + 16_384) >> 15) as u8
            }),
        }
    }
}

#[inline(always)]
pub(super) fn triple_portable(input: GrayView<'_>, output: &mut RgbViewMut<'_>) {
    for y in 0..input.height() {
        triple_row(input.row(y), output.row_mut(y));
    }
}

/// Four pixels become three words, which vectorise better than twelve bytes. The words start at a cache line
/// of the output, because wide stores across two lines take longer.
#[inline(always)]
fn triple_row(row: &[u8], out: &mut [u8]) {
    let first = pixels_to_line(out).min(row.len());
    let ((head, row), (head_out, out)) = (row.split_at(first), out.split_at_mut(3 * first));
    planes::merge(head_out.as_chunks_mut::<3>().0, head, head, head);
    let (fours, last) = row.as_chunks::<4>();
    let (words, last_out) = out.as_chunks_mut::<12>();
    for (&pixels, out) in fours.iter().zip(words) {
        let [a, b, c, d] = pixels.map(u32::from);
        let words =
            [(a * 0x01_01_01) | (b << 24), (b * 0x01_01) | (c * 0x01_01_00_00), c | (d * 0x01_01_01_00)];
        for (out, word) in out.as_chunks_mut::<4>().0.iter_mut().zip(words) {
            *out = word.to_le_bytes();
        }
    }
    planes::merge(last_out.as_chunks_mut::<3>().0, last, last, last);
}

/// Number of three-byte pixels before one that starts at a cache line.
fn pixels_to_line(out: &[u8]) -> usize {
    /// Size of a cache line (bytes).
    const LINE: usize = 64;
    /// Inverse of 3 modulo the line: `3 * THIRD` is 129 = 2 * 64 + 1.
    const THIRD: usize = 43;
    out.as_ptr().align_offset(LINE).wrapping_mul(THIRD) % LINE
}

vectorised_filter! {
    fn gray(input: RgbView<'_>, output: &mut GrayViewMut<'_>, weights: GrayWeights) {
        gray_portable(input, output, weights);
    }
}

vectorised_filter! {
    fn triple(input: GrayView<'_>, output: &mut RgbViewMut<'_>) {
        triple_portable(input, output);
    }
}
