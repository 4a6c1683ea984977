use super::dispatch::vectorised;
use super::view::{flatten, require_size};
use super::{GrayView, GrayViewMut, ImageError};

/// Absolute difference `|first - second|`, pixel by pixel (book, Program 11.13).
///
/// ```
/// use roverlab::vision::{GrayView, GrayViewMut, absolute_difference_into};
/// let (before, after) = (GrayView::new(&[10, 200, 30], 3, 1)?, GrayView::new(&[10, 180, 70], 3, 1)?);
/// let mut change = [0; 3];
/// absolute_difference_into(before, after, GrayViewMut::new(&mut change, 3, 1)?)?;
/// assert_eq!(change, [0, 20, 40]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
///
/// # Errors
///
/// If the sizes differ.
pub fn absolute_difference_into(
    first: GrayView<'_>,
    second: GrayView<'_>,
    output: GrayViewMut<'_>,
) -> Result<(), ImageError> {
    require_size("second image", second.size(), first.size())?;
    output.require_size(first.size())?;
    let (second, mut output) = if first.is_flat() { flatten(second, output) } else { (second, output) };
    // Either all three images as one long row, or none.
    let first = if second.height() == first.height() { first } else { first.flat() };
    subtract(first, second, &mut output);
    Ok(())
}

/// Mean of `|first - second|` over all pixels, in one pass (book, Program 11.13, without rounding).
///
/// ```
/// use roverlab::vision::{GrayView, mean_difference};
/// let (before, after) = (GrayView::new(&[10, 200, 30], 3, 1)?, GrayView::new(&[10, 180, 70], 3, 1)?);
/// assert_eq!(mean_difference(before, after)?, (0.0 + 20.0 + 40.0) / 3.0);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
pub fn mean_difference(first: GrayView<'_>, second: GrayView<'_>) -> Result<f64, ImageError> {
    require_size("second image", second.size(), first.size())?;
    let (width, height) = first.size();
    // Either both images as one long row, or none.
    let (first, second) =
        if first.is_flat() && second.is_flat() { (first.flat(), second.flat()) } else { (first, second) };
    let total = sum(first, second, 0, first.width());
    Ok(total as f64 / (width * height) as f64)
}

/// Mean of `|first - second|` in each of `N` sectors from left to right (book, section 11.5). Sector `i`
/// starts at column `i * width / N`; the mean of an empty sector is 0.
///
/// ```
/// use roverlab::vision::{GrayView, sector_differences};
/// let (before, after) = (GrayView::new(&[0; 6], 6, 1)?, GrayView::new(&[0, 0, 0, 0, 90, 30], 6, 1)?);
/// assert_eq!(sector_differences::<3>(before, after)?, [0.0, 0.0, 60.0], "motion at the right");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
pub fn sector_differences<const N: usize>(
    first: GrayView<'_>,
    second: GrayView<'_>,
) -> Result<[f64; N], ImageError> {
    require_size("second image", second.size(), first.size())?;
    let (width, height) = first.size();
    let mut means = [0.0; N];
    for (i, mean) in means.iter_mut().enumerate() {
        let (from, to) = (i * width / N, (i + 1) * width / N);
        if from < to {
            *mean = sum(first, second, from, to) as f64 / ((to - from) * height) as f64;
        }
    }
    Ok(means)
}

#[inline(always)]
pub(super) fn subtract_portable(first: GrayView<'_>, second: GrayView<'_>, output: &mut GrayViewMut<'_>) {
    for y in 0..first.height() {
        for ((out, a), b) in output.row_mut(y).iter_mut().zip(first.row(y)).zip(second.row(y)) {
            *out = a.abs_diff(*b);
        }
    }
}

/// Number of pixels summed side by side.
const LANES: usize = 256;
/// Number of such blocks whose sums fit 16 bits: 257 * 255 = 65535.
const BLOCKS: usize = 257;

#[inline(always)]
pub(super) fn sum_portable(first: GrayView<'_>, second: GrayView<'_>, from: usize, to: usize) -> u64 {
    let mut total = 0;
    for y in 0..first.height() {
        let (a, rest_a) = first.row(y)[from..to].as_chunks::<LANES>();
        let (b, rest_b) = second.row(y)[from..to].as_chunks::<LANES>();
        for (a, b) in a.chunks(BLOCKS).zip(b.chunks(BLOCKS)) {
            let mut sums = [0_u16; LANES];
            for (a, b) in a.iter().zip(b) {
                for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
                    *sum += u16::from(a.abs_diff(*b));
                }
            }
            total += u64::from(sums.iter().map(|&sum| u32::from(sum)).sum::<u32>());
        }
        total += u64::from(rest_a.iter().zip(rest_b).map(|(a, b)| u32::from(a.abs_diff(*b))).sum::<u32>());
    }
    total
}

vectorised! {
    fn subtract(first: GrayView<'_>, second: GrayView<'_>, output: &mut GrayViewMut<'_>) {
        subtract_portable(first, second, output);
    }
}

vectorised! {
    fn sum(first: GrayView<'_>, second: GrayView<'_>, from: usize, to: usize) -> u64 {
        sum_portable(first, second, from, to)
    }
}
