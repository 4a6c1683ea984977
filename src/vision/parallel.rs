//! Kernels on several threads (feature `rayon`).

use rayon::prelude::*;

use super::ImageError;
use super::view::{View, ViewMut};

/// Minimum number of rows per band; shorter bands cost more to distribute than they save.
const LEAST_ROWS: usize = 16;

/// Runs a kernel on bands of rows in parallel, with the same result as on the whole image.
///
/// `reach` is the number of rows above and below a pixel that the kernel reads: 0 for gray conversion and
/// thresholds, 1 for Laplace and Sobel, 3 for a Gaussian of 7 x 7. Kernels that need the whole image (Canny,
/// components, Hough) are not suitable.
///
/// ```
/// use roverlab::vision::{Border, GrayView, GrayViewMut, in_bands, laplace_into};
///
/// # fn main() -> Result<(), roverlab::vision::ImageError> {
/// let image: Vec<u8> = (0..640 * 480).map(|i| (i / 97 * 13) as u8).collect();
/// let (mut edges, mut expected) = (vec![0; image.len()], vec![0; image.len()]);
/// let input = GrayView::new(&image, 640, 480)?;
/// in_bands(input, GrayViewMut::new(&mut edges, 640, 480)?, 1, |input, output| {
///     laplace_into(input, output, Border::Mirror)
/// })?;
/// laplace_into(input, GrayViewMut::new(&mut expected, 640, 480)?, Border::Mirror)?;
/// assert_eq!(edges, expected);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// If the sizes differ, or the kernel fails.
pub fn in_bands<const C: usize, const D: usize>(
    input: View<'_, C>,
    output: ViewMut<'_, D>,
    reach: usize,
    kernel: impl Fn(View<'_, C>, ViewMut<'_, D>) -> Result<(), ImageError> + Sync,
) -> Result<(), ImageError> {
    output.require_size(input.size())?;
    let (width, height) = input.size();
    let bands = rayon::current_num_threads().min(height / (LEAST_ROWS + 2 * reach)).max(1);
    if bands == 1 {
        return kernel(input, output);
    }
    let rows = height.div_ceil(bands);
    output.into_bands(rows).into_par_iter().enumerate().try_for_each(|(band, mut output)| {
        let (top, rows) = (band * rows, output.height());
        if reach == 0 {
            return kernel(input.region((0, top), width, rows)?, output);
        }
        // The rows around a band make it equal to the whole image; they themselves differ and are dropped.
        let first = top.saturating_sub(reach);
        let last = (top + rows + reach).min(height);
        let mut whole = vec![0; width * D * (last - first)];
        let part = input.region((0, first), width, last - first)?;
        kernel(part, ViewMut::new(&mut whole, width, last - first)?)?;
        for y in 0..rows {
            output.row_mut(y).copy_from_slice(&whole[(top - first + y) * width * D..][..width * D]);
        }
        Ok(())
    })
}
