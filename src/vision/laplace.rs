use super::border::stencil;
use super::dispatch::vectorised_filter;
use super::{Border, GrayView, GrayViewMut, ImageError};

/// Absolute value of the Laplace operator: `min(255, |4 c - n - s - e - w|)` of a pixel and its four
/// neighbours (book, Program 11.3).
///
/// # Errors
///
/// If the sizes differ.
pub fn laplace_into(
    input: GrayView<'_>,
    mut output: GrayViewMut<'_>,
    border: Border,
) -> Result<(), ImageError> {
    output.require_size(input.size())?;
    absolute(input, &mut output, border);
    Ok(())
}

/// Positive part of the Laplace operator, `n + s + e + w - 4 c` clamped to `0..=255`. It marks the dark side
/// of edges.
///
/// ```
/// use roverlab::vision::{Border, GrayView, GrayViewMut, laplace_saturated_into};
/// let step = [10, 10, 10, 60, 60, 60];
/// let mut edges = [0; 6];
/// let (input, output) = (GrayView::new(&step, 6, 1)?, GrayViewMut::new(&mut edges, 6, 1)?);
/// laplace_saturated_into(input, output, Border::Mirror)?;
/// assert_eq!(edges, [0, 0, 50, 0, 0, 0], "the last dark pixel before the step");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
///
/// # Errors
///
/// If the sizes differ.
pub fn laplace_saturated_into(
    input: GrayView<'_>,
    mut output: GrayViewMut<'_>,
    border: Border,
) -> Result<(), ImageError> {
    output.require_size(input.size())?;
    saturated(input, &mut output, border);
    Ok(())
}

/// Four times the centre, and the sum of the neighbours.
#[inline(always)]
fn terms([[_, n, _], [w, c, e], [_, s, _]]: [[u16; 3]; 3]) -> (u16, u16) {
    (4 * c, n + s + w + e)
}

#[inline(always)]
fn magnitude(pixels: [[u16; 3]; 3]) -> u16 {
    let (centre, neighbours) = terms(pixels);
    centre.abs_diff(neighbours).min(255)
}

#[inline(always)]
fn excess(pixels: [[u16; 3]; 3]) -> u16 {
    let (centre, neighbours) = terms(pixels);
    neighbours.saturating_sub(centre).min(255)
}

#[inline(always)]
pub(super) fn absolute_portable(input: GrayView<'_>, output: &mut GrayViewMut<'_>, border: Border) {
    stencil(input, output, border, magnitude);
}

#[inline(always)]
pub(super) fn saturated_portable(input: GrayView<'_>, output: &mut GrayViewMut<'_>, border: Border) {
    stencil(input, output, border, excess);
}

vectorised_filter! {
    fn absolute(input: GrayView<'_>, output: &mut GrayViewMut<'_>, border: Border) {
        absolute_portable(input, output, border);
    }
}

vectorised_filter! {
    fn saturated(input: GrayView<'_>, output: &mut GrayViewMut<'_>, border: Border) {
        saturated_portable(input, output, border);
    }
}
