use super::border::stencil;
use super::dispatch::vectorised;
use super::{Border, Error, GrayView, GrayViewMut};

/// How the magnitude of a gradient becomes a byte.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum SobelScale {
    /// As it is, at most 255.
    #[default]
    Full,
    /// A third of it, at most 255, as RoBIOS has it.
    Third,
}

/// The Sobel gradient's magnitude by sums: `|dx| + |dy|`, or a third of that rounded down, at most 255.
///
/// `dx = (ne + 2 e + se) - (nw + 2 w + sw)` and `dy = (sw + 2 s + se) - (nw + 2 n + ne)`.
pub fn sobel_l1_into(
    input: GrayView<'_>,
    mut output: GrayViewMut<'_>,
    scale: SobelScale,
    border: Border,
) -> Result<(), Error> {
    output.require_size(input.size())?;
    sums(input, &mut output, scale, border);
    Ok(())
}

/// The Sobel gradient's Euclidean magnitude: `sqrt(dx² + dy²)`, or a third of that, rounded to the nearest whole
/// number, at most 255; see [`sobel_l1_into`].
pub fn sobel_l2_into(
    input: GrayView<'_>,
    mut output: GrayViewMut<'_>,
    scale: SobelScale,
    border: Border,
) -> Result<(), Error> {
    output.require_size(input.size())?;
    euclidean(input, &mut output, scale, border);
    Ok(())
}

#[inline(always)]
fn gradient([[nw, n, ne], [w, _, e], [sw, s, se]]: [[u8; 3]; 3]) -> (i16, i16) {
    let (nw, n, ne) = (i16::from(nw), i16::from(n), i16::from(ne));
    let (sw, s, se) = (i16::from(sw), i16::from(s), i16::from(se));
    let (w, e) = (i16::from(w), i16::from(e));
    ((ne - nw) + 2 * (e - w) + (se - sw), (sw - nw) + 2 * (s - n) + (se - ne))
}

#[inline(always)]
fn sum(pixels: [[u8; 3]; 3]) -> u16 {
    let (dx, dy) = gradient(pixels);
    dx.unsigned_abs() + dy.unsigned_abs()
}

#[inline(always)]
fn root(pixels: [[u8; 3]; 3], largest: i32, scale: f32) -> u8 {
    let (dx, dy) = gradient(pixels);
    let (dx, dy) = (i32::from(dx), i32::from(dy));
    let length = ((dx * dx + dy * dy).min(largest * largest) as f32).sqrt() * scale;
    // From 2^23 on, floats are whole numbers: adding that much rounds to the nearest and puts it in the lowest bits.
    // The root of a whole number, or a third of it, never lies halfway between two.
    (length + 8_388_608.0).to_bits() as u8
}

#[inline(always)]
pub(super) fn sums_portable(
    input: GrayView<'_>,
    output: &mut GrayViewMut<'_>,
    scale: SobelScale,
    border: Border,
) {
    match scale {
        SobelScale::Full => stencil(input, output, border, |pixels| sum(pixels).min(255) as u8),
        SobelScale::Third => stencil(input, output, border, |pixels| (sum(pixels) / 3).min(255) as u8),
    }
}

#[inline(always)]
pub(super) fn euclidean_portable(
    input: GrayView<'_>,
    output: &mut GrayViewMut<'_>,
    scale: SobelScale,
    border: Border,
) {
    match scale {
        SobelScale::Full => stencil(input, output, border, |pixels| root(pixels, 255, 1.0)),
        SobelScale::Third => stencil(input, output, border, |pixels| root(pixels, 765, 1.0 / 3.0)),
    }
}

vectorised! {
    fn sums(input: GrayView<'_>, output: &mut GrayViewMut<'_>, scale: SobelScale, border: Border) {
        sums_portable(input, output, scale, border);
    }
}

vectorised! {
    fn euclidean(input: GrayView<'_>, output: &mut GrayViewMut<'_>, scale: SobelScale, border: Border) {
        euclidean_portable(input, output, scale, border);
    }
}
