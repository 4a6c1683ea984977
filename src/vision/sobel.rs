use super::border::stencil;
use super::dispatch::vectorised_filter;
use super::{Border, GrayView, GrayViewMut, ImageError};

/// Scale of the gradient magnitude.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum SobelScale {
    /// Full magnitude, at most 255.
    #[default]
    Full,
    /// A third of the magnitude, at most 255, as in RoBIOS.
    Third,
}

/// Sobel gradient: `|dx| + |dy|`, or a third of that rounded down, at most 255.
///
/// `dx = (ne + 2 e + se) - (nw + 2 w + sw)` and `dy = (sw + 2 s + se) - (nw + 2 n + ne)`.
///
/// ```
/// use roverlab::vision::{Border, GrayView, GrayViewMut, SobelScale, sobel_l1_into};
/// let corner = [0, 0, 0, 0, 0, 20, 0, 20, 20];
/// let mut edges = [0; 9];
/// let (input, output) = (GrayView::new(&corner, 3, 3)?, GrayViewMut::new(&mut edges, 3, 3)?);
/// sobel_l1_into(input, output, SobelScale::Full, Border::Zero)?;
/// assert_eq!(edges, [0, 0, 0, 0, 120, 0, 0, 0, 0], "dx = dy = 60");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
///
/// # Errors
///
/// If the sizes differ.
pub fn sobel_l1_into(
    input: GrayView<'_>,
    mut output: GrayViewMut<'_>,
    scale: SobelScale,
    border: Border,
) -> Result<(), ImageError> {
    output.require_size(input.size())?;
    match scale {
        SobelScale::Full => sums_in_full(input, &mut output, border),
        SobelScale::Third => thirds_of_sums(input, &mut output, border),
    }
    Ok(())
}

/// Sobel gradient: `sqrt(dx² + dy²)`, or a third of that, rounded to the nearest, at most 255; see
/// [`sobel_l1_into`].
///
/// ```
/// use roverlab::vision::{Border, GrayView, GrayViewMut, SobelScale, sobel_l2_into};
/// let corner = [0, 0, 0, 0, 0, 20, 0, 20, 20];
/// let mut edges = [0; 9];
/// let (input, output) = (GrayView::new(&corner, 3, 3)?, GrayViewMut::new(&mut edges, 3, 3)?);
/// sobel_l2_into(input, output, SobelScale::Full, Border::Zero)?;
/// assert_eq!(edges[4], 85, "dx = dy = 60, and the root of 60² + 60² is 84.9");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
///
/// # Errors
///
/// If the sizes differ.
pub fn sobel_l2_into(
    input: GrayView<'_>,
    mut output: GrayViewMut<'_>,
    scale: SobelScale,
    border: Border,
) -> Result<(), ImageError> {
    output.require_size(input.size())?;
    match scale {
        SobelScale::Full => roots_in_full(input, &mut output, border),
        SobelScale::Third => thirds_of_roots(input, &mut output, border),
    }
    Ok(())
}

/// Half the sum and half the difference of `dx` and `dy`, which take fewer operations than `dx` and `dy`.
///
/// `|dx| + |dy|` is the larger of `|dx + dy|` and `|dx - dy|`; `dx² + dy²` is half the sum of their squares.
#[inline(always)]
fn diagonals(pixels: [[u16; 3]; 3]) -> (i16, i16) {
    let [[nw, n, ne], [w, _, e], [sw, s, se]] = pixels;
    let (nw, n, ne) = (nw.cast_signed(), n.cast_signed(), ne.cast_signed());
    let (sw, s, se) = (sw.cast_signed(), s.cast_signed(), se.cast_signed());
    let (w, e) = (w.cast_signed(), e.cast_signed());
    let (across, down) = (e - w, s - n);
    ((se - nw) + (across + down), (ne - sw) + (across - down))
}

#[inline(always)]
fn sum(pixels: [[u16; 3]; 3]) -> u16 {
    let (a, b) = diagonals(pixels);
    2 * a.unsigned_abs().max(b.unsigned_abs())
}

#[inline(always)]
fn sum_in_full(pixels: [[u16; 3]; 3]) -> u16 {
    sum(pixels).min(255)
}

#[inline(always)]
fn third_of_sum(pixels: [[u16; 3]; 3]) -> u16 {
    (sum(pixels) / 3).min(255)
}

#[inline(always)]
fn root(pixels: [[u16; 3]; 3], largest: i32, scale: f32) -> u16 {
    let (a, b) = diagonals(pixels);
    let (a, b) = (i32::from(a), i32::from(b));
    let length = ((2 * (a * a + b * b)).min(largest * largest) as f32).sqrt() * scale;
    // From 2^23 on, floats are integers: adding that rounds to the nearest and puts the result in the low
    // bits. The root of an integer, or a third of it, never lies halfway between two integers.
    (length + 8_388_608.0).to_bits() as u16
}

#[inline(always)]
fn root_in_full(pixels: [[u16; 3]; 3]) -> u16 {
    root(pixels, 255, 1.0)
}

#[inline(always)]
fn third_of_root(pixels: [[u16; 3]; 3]) -> u16 {
    root(pixels, 765, 1.0 / 3.0)
}

// One function each: with several loops in one, the compiler keeps the pointers in memory.

vectorised_filter! {
    fn sums_in_full(input: GrayView<'_>, output: &mut GrayViewMut<'_>, border: Border) {
        stencil(input, output, border, sum_in_full);
    }
}

vectorised_filter! {
    fn thirds_of_sums(input: GrayView<'_>, output: &mut GrayViewMut<'_>, border: Border) {
        stencil(input, output, border, third_of_sum);
    }
}

vectorised_filter! {
    fn roots_in_full(input: GrayView<'_>, output: &mut GrayViewMut<'_>, border: Border) {
        stencil(input, output, border, root_in_full);
    }
}

vectorised_filter! {
    fn thirds_of_roots(input: GrayView<'_>, output: &mut GrayViewMut<'_>, border: Border) {
        stencil(input, output, border, third_of_root);
    }
}

/// The same, compiled for any processor.
#[cfg(test)]
pub(super) mod portable {
    use super::*;

    pub(in crate::vision) fn sums(
        input: GrayView<'_>,
        output: &mut GrayViewMut<'_>,
        scale: SobelScale,
        border: Border,
    ) {
        match scale {
            SobelScale::Full => stencil(input, output, border, sum_in_full),
            SobelScale::Third => stencil(input, output, border, third_of_sum),
        }
    }

    pub(in crate::vision) fn roots(
        input: GrayView<'_>,
        output: &mut GrayViewMut<'_>,
        scale: SobelScale,
        border: Border,
    ) {
        match scale {
            SobelScale::Full => stencil(input, output, border, root_in_full),
            SobelScale::Third => stencil(input, output, border, third_of_root),
        }
    }
}
